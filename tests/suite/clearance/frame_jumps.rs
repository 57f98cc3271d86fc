//! Formulas of inputs in the frames of bodies, with kinks and jumps: located, and proved on both sides.

use crate::program::Workspace;
use crate::solids::{BOX_TRIANGLES, box_corner, stl_text};

/// A drive, the frame of a ball of radius 1, the places of a post like it, and whether 0.5 is kept there.
type Row = (&'static str, &'static str, &'static [(f64, f64, bool)]);

const ROWS: [Row; 10] = [
    // Places 50, 20 and -10.
    (
        "\"1.3*t\"",
        "Tx(50 - 30*floor(u))",
        &[(22.6, 0.0, true), (22.4, 0.0, false), (35.0, 0.0, true)],
    ),
    // From 0 up to 4, over keys.
    (
        "{ keys = [[0, 0], [0.7, 1.1], [2, 0.2]], ease = \"linear\" }",
        "Tx(8*mod(u, 0.5))",
        &[
            (6.6, 0.0, true),
            (-2.6, 0.0, true),
            (-2.4, 0.0, false),
            (6.3, 0.0, false),
        ],
    ),
    // Every nine from -45 to 36.
    (
        "\"1.1*sin(3*t)\"",
        "Tx(9*floor(4*u))",
        &[
            (4.5, 0.0, true),
            (38.6, 0.0, true),
            (38.4, 0.0, false),
            (-47.4, 0.0, false),
        ],
    ),
    (
        "{ keys = [[0, 0], [0.5, 1], [1.5, 2]], ease = \"step\" }",
        "Tx(20*abs(u - 1))",
        &[(10.0, 0.0, true), (0.0, 2.4, false), (22.4, 0.0, false)],
    ),
    // Two joints that jump together, told in two ways.
    (
        "\"t\"",
        "Tx(6*floor(u/0.3)) Ty(6*floor(10*u/3))",
        &[
            (6.0, 0.0, true),
            (0.0, 6.0, true),
            (18.0, 12.0, true),
            (18.0, 18.0, false),
        ],
    ),
    // Half of an angle that jumps by a turn: from above to below.
    (
        "\"2*t\"",
        "Rz(0.5*atan2(sin(u), cos(u))) Tx(20)",
        &[
            (-2.4, 20.0, false),
            (-2.6, 20.0, true),
            (-2.4, -20.0, false),
            (-2.6, -20.0, true),
            (-20.0, 0.0, true),
        ],
    ),
    // The angle itself turns on.
    (
        "\"2*t\"",
        "Rz(atan2(sin(u), cos(u))) Tx(20)",
        &[(-22.4, 0.0, false), (-22.6, 0.0, true)],
    ),
    // From 10 π to -10 π, and back to 40 - 20 π.
    (
        "\"2*t\"",
        "Tx(10*atan2(sin(u), cos(u)))",
        &[
            (33.9, 0.0, false),
            (33.95, 0.0, true),
            (-33.9, 0.0, false),
            (-33.95, 0.0, true),
            (-20.4, 0.0, false),
            (-20.2, 0.0, true),
        ],
    ),
    // At 9 for a thousandth of a second.
    (
        "\"t + 0.3\"",
        "Tx(9*(floor(u) - floor(u - 0.001)))",
        &[(9.0, 2.4, false), (9.0, 2.6, true), (4.5, 0.0, true)],
    ),
    // A kink over keys, whose tip is 3.
    (
        "{ keys = [[0, -0.7], [1.1, 0.9], [2, -0.2]], ease = \"smooth\" }",
        "Tx(3 + 4*abs(u - 0.2))",
        &[(0.49, 0.0, true), (0.51, 0.0, false)],
    ),
];

fn scene(drive: &str, frame: &str, post: &str) -> String {
    format!(
        "duration = 2\n[inputs]\nu = {drive}\n\
         [[bodies]]\nname = \"ball\"\nframe = \"{frame}\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
         [[bodies]]\nname = \"post\"\nshapes = [{{ {post} }}]\n\
         [clearance]\nminimum = 0.5\npairs = [{{ pair = [\"ball\", \"post\"], minimum = 0.5 }}]\n"
    )
}

#[test]
fn jumps_of_formulas_in_frames_are_met() {
    let w = Workspace::new();
    for (drive, frame, posts) in ROWS {
        for (x, y, is_kept) in posts {
            let post = format!("sphere = {{ center = [{x}, {y}, 0], radius = 1 }}");
            w.write("scene.toml", scene(drive, frame, &post));
            for samples in ["2", "7", "40"] {
                let said = w.run(&["check", "scene.toml", "--samples", samples]);
                let text = said.text();
                let told =
                    format!("{frame} of {drive}, post at {x}, {y}, {samples} samples: {text}");
                assert_eq!(said.code, i32::from(!is_kept), "{told}");
                assert_eq!(text.contains("  failed "), !is_kept, "{told}");
            }
        }
    }
}

/// A ball that is in a closed mesh between two jumps of its frame has never touched it.
#[test]
fn what_a_frame_jumps_into_is_noticed() {
    let w = Workspace::new();
    w.write(
        "room.stl",
        stl_text(BOX_TRIANGLES.map(|t| t.map(|k| box_corner(k) * 4.0))),
    );
    for (drive, frame, is_kept) in [
        ("\"0.9*t + 0.5\"", "Tx(20 - 20*floor(u))", false),
        ("\"0.9*t + 0.5\"", "Tx(20 - 5*floor(u))", true),
        (
            "\"t + 0.3\"",
            "Tx(20 - 20*(floor(u) - floor(u - 0.001)))",
            false,
        ),
        ("\"1.3 - t\"", "Tx(20*floor(u + 0.5))", false),
        (
            "{ keys = [[0, 0], [0.8, 1.2], [2, 0.3]], ease = \"linear\" }",
            "Tx(20 - 20*floor(u))",
            false,
        ),
    ] {
        w.write(
            "scene.toml",
            scene(drive, frame, "stl = { file = \"room.stl\" }"),
        );
        for samples in ["2", "7", "40"] {
            let said = w.run(&["check", "scene.toml", "--samples", samples]);
            assert_eq!(
                said.code,
                i32::from(!is_kept),
                "{frame} {samples}: {}",
                said.text()
            );
        }
    }
}

/// Over a box of inputs the time does not tell where a kink is: it is passed with what its other side is off.
#[test]
fn kinks_are_passed_in_boxes_of_inputs() {
    let w = Workspace::new();
    let post = "sphere = { radius = 1 }";
    w.write(
        "scene.toml",
        scene("\"t - 1\"", "Tx(3 + 4*abs(u))", post).replace("0.5", "0.9"),
    );
    w.run(&["check", "scene.toml", "--inputs-box", "u=-1:1"])
        .exits(0);
    w.write(
        "scene.toml",
        scene("\"t - 1\"", "Tx(3 + 4*abs(u))", post).replace("0.5", "1.1"),
    );
    w.run(&["check", "scene.toml", "--inputs-box", "u=-1:1"])
        .exits(1);
}
