//! Three siblings of each kind of scene that a review found judged wrongly: cuts that passed, clear carriages that failed, joints
//! that hid what is on them. Every least distance is known in closed form.

use crate::solids::{BOX_TRIANGLES, box_corner, stl_text};
use glam::DVec3;
use mechanim::{CheckOptions, Samples, Scene};
use std::path::Path;

/// A kind, and siblings with what the check must say of each: whether it passes.
struct Kind {
    name: &'static str,
    siblings: Vec<(String, bool)>,
}

fn kind(name: &'static str, siblings: impl IntoIterator<Item = (String, bool)>) -> Kind {
    let siblings = siblings.into_iter().collect();
    Kind { name, siblings }
}

/// Drives, two bodies with a frame and shapes each, and what is asked.
fn scene(drives: &str, mover: [&str; 2], wall: [&str; 2], asked: &str) -> String {
    let body = |name: &str, [frame, shapes]: [&str; 2]| {
        format!("[[bodies]]\nname = \"{name}\"\nframe = \"{frame}\"\nshapes = [{shapes}]\n")
    };
    let [mover, wall] = [body("mover", mover), body("wall", wall)];
    format!("duration = 2\n[inputs]\n{drives}\n{mover}{wall}[clearance]\n{asked}\n")
}

/// A shape that moves up and down over a wall, and aside.
fn lift(shape: &str, height: &str, wall: &str, minimum: f64) -> String {
    let drives = format!("x = \"0.2*t\"\nz = {height}");
    let asked = format!("minimum = {minimum}");
    scene(&drives, ["Tx(x) Tz(z)", shape], ["E", wall], &asked)
}

fn ball(centre: [f64; 3], radius: f64) -> String {
    format!("{{ sphere = {{ center = {centre:?}, radius = {radius} }} }}")
}

fn rod(from: [f64; 3], to: [f64; 3], radius: f64) -> String {
    format!("{{ capsule = {{ from = {from:?}, to = {to:?}, radius = {radius} }} }}")
}

fn block(centre: [f64; 3], size: [f64; 3]) -> String {
    format!("{{ box = {{ center = {centre:?}, size = {size:?} }} }}")
}

fn stl(name: &str) -> String {
    format!("{{ stl = {{ file = \"{name}.stl\" }} }}")
}

/// A floor whose top is at zero.
fn floor() -> String {
    block([0.0, 0.0, -2.0], [90.0, 90.0, 4.0])
}

/// Strokes above the floor, by the lowest point of a shape below its frame.
fn strokes() -> Vec<Kind> {
    let at = |shape: &str, low: f64, text: &str, spare: f64, minimum: f64| {
        let height = format!("\"{} + {text}\"", low + minimum + spare);
        lift(shape, &height, &floor(), minimum)
    };
    let needle = rod([0.0; 3], [0.0, 0.0, 30.0], 0.5);
    let cone = "{ cone = { from = [0, 0, 0], to = [0, 0, 9], radius_from = 0.1, radius_to = 2 } }";
    let cube = stl("cube");
    let sine = |a: f64, w: f64, p: f64| format!("{a} + {a}*sin({w}*t + {p})");
    let fast = [
        sine(12.0, 69.1, 1.0),
        sine(80.0, 131.7, 2.2),
        sine(5.0, 211.3, 0.4),
    ];
    let kinked = [
        "30*min(1, 5000*abs(t - 0.7013))",
        "2*abs(mod(7*t + 0.31, 2) - 1)",
        "max(0, 9*(1.3 - t)*(1.3 - t) - 0.4)",
    ];
    let jumping = [
        "4 - 4*(floor(t - 0.313) - floor(t - 0.3145))",
        "3*mod(floor(5*t), 3)",
        "6*abs(floor(3*t) - 2)",
    ];
    let lacking = [
        "9 + 0*sqrt(abs(t - 0.4713) - 2e-4)",
        "9 + ln((t - 1.03)^2 - 1e-7)/50",
        "9 + (t - 0.55)*sqrt((t - 0.55)*(t - 0.56))",
    ];
    let shapes = [(needle.as_str(), 0.5), (cone, 0.0), (cube.as_str(), 1.0)];
    let row = |texts: &[String], spare: f64, minimum: f64| {
        let pairs = texts.iter().zip(shapes);
        let row = pairs.map(|(text, (shape, low))| at(shape, low, text, spare, minimum));
        row.map(|text| (text, spare >= 0.0)).collect::<Vec<_>>()
    };
    let texts = |list: [&str; 3]| list.map(str::to_owned);
    let lacking = texts(lacking).map(|text| (at(&needle, 0.5, &text, 0.0, 0.1), false));
    vec![
        kind("a needle that cuts", row(&fast, -0.04, 0.0)),
        kind("a fast stroke that is clear", row(&fast, 0.02, 0.01)),
        kind("kinks that cut", row(&texts(kinked), -0.02, 0.3)),
        kind("kinks that are clear", row(&texts(kinked), 0.02, 0.3)),
        kind("jumps that cut", row(&texts(jumping), -0.5, 0.1)),
        kind("jumps that are clear", row(&texts(jumping), 0.5, 0.1)),
        kind("no pose for a while", lacking),
    ]
}

/// An arm of a length about z that passes a post by a distance, and the angle as text.
fn passing(angle: &str, length: f64, apart: f64, asked: &str) -> String {
    let arm = rod([0.3 * length, 0.0, 0.0], [length, 0.0, 0.0], 0.2);
    let post = rod(
        [0.0, length + 0.5 + apart, -3.0],
        [0.0, length + 0.5 + apart, 3.0],
        0.3,
    );
    scene(
        &format!("u = \"{angle}\""),
        ["Rz(u)", &arm],
        ["E", &post],
        asked,
    )
}

fn turning() -> Vec<Kind> {
    let near = [1e-7, 2.3e-6, 4e-5].map(|off| {
        let text = passing(
            "2.9*t - 0.4",
            3.0,
            0.25,
            &format!("minimum = {}", 0.25 + off),
        );
        (text, false)
    });
    let turns = [
        "mod(9*t, 2*pi)",
        "mod(3.3*pi*t + 2, 2*pi) - pi",
        "8*t - 2*pi*floor(4*t/pi)",
    ];
    let turns = turns.map(|angle| (passing(angle, 5.0, 2.0, "minimum = 0.5"), true));
    let own = [
        "minimum = 0\npairs = [{ pair = [\"mover\", \"wall\"], minimum = 0.5 }]",
        "minimum = 0\npairs = [{ pair = [\"mov*\", \"wall\"], minimum = 0.5 }]",
        "minimum = 0.5",
    ];
    let own = own.map(|asked| (passing("3*t", 7.0, -0.6, asked), false));
    let far = [1e5, 1e7, 1e9].map(|far| {
        let text = passing("3*t", 2.0, 0.05, "minimum = 0.1");
        let body = format!(
            "[[bodies]]\nname = \"far\"\nframe = \"Ty({far})\"\nshapes = [{}]\n[clearance]",
            ball([0.0; 3], 1.0)
        );
        (text.replace("[clearance]", &body), false)
    });
    vec![
        kind("a minimum just above the least distance", near),
        kind("cranks that begin anew every turn", turns),
        kind("a post in the way of what turns on it", own),
        kind("a body far away", far),
    ]
}

/// Two driven bodies on one axis or point.
fn on_joints() -> Vec<Kind> {
    let pair = |drives: &str, first: [&str; 2], second: [&str; 2]| {
        scene(drives, first, second, "minimum = 0.2")
    };
    let drives = "u = \"2*t\"\nv = \"1 - t\"";
    let arm = |z: f64| rod([1.0, 0.0, z], [6.0, 0.0, z], 0.4);
    let shaft = [0.0, 0.7, 1.1].map(|z| {
        let text = pair(
            drives,
            ["Rx(u) Ry(pi/2)", &arm(0.0)],
            ["Rx(v) Ry(pi/2)", &arm(z)],
        );
        // The arms sweep about x, one of them z farther along it, and meet after a third of a second.
        (text, z > 1.0)
    });
    let wrists = [1.9, 1.2, 0.5].map(|most: f64| {
        let drives = format!("u = \"{most}*sin(2*t)\"\nv = \"0.1*t\"\nw = \"0.3*t\"");
        let hand = rod([0.0, 0.0, 2.0], [0.0, 0.0, 6.0], 0.5);
        let forearm = rod([0.0, -9.0, -2.0], [0.0, 9.0, -2.0], 0.5);
        let text = pair(&drives, ["Rx(u) Ry(v) Rz(w)", &hand], ["E", &forearm]);
        // At 1.9 rad the hand reaches 6 cos 1.9 = -1.94, at 1.2 rad nothing comes below 0.7 of 2.
        (text, most < 1.5)
    });
    let lifts = [0.0, 2.0, 5.0].map(|high: f64| {
        let drives = "u = \"pi*t\"\nv = \"2*t\"";
        let post = ball([-5.0, 0.0, high], 0.5);
        // Half a turn lifts by 2: the arm is at the post's place after 1 s.
        let text = pair(drives, ["Rz(u) Tz(v)", &arm(0.0)], ["E", &post]);
        (text, (high - 2.0).abs() > 1.0)
    });
    vec![
        kind("arms on one shaft", shaft),
        kind("a hand that folds back", wrists),
        kind("an arm that turns and lifts", lifts),
    ]
}

/// Meshes: what is inside, beside, or not closed.
fn meshes() -> Vec<Kind> {
    let steps = [
        "{ keys = [[0, 9], [0.71, 0], [0.72, 9], [2, 9]], ease = \"step\" }",
        "\"9 - 9*(floor(t - 0.41) - floor(t - 0.412))\"",
        "\"9*floor(2.5*t)\"",
    ];
    let into = steps.map(|height| (lift(&ball([0.0; 3], 0.3), height, &stl("room"), 0.1), false));
    let shells = [
        block([0.0; 3], [8.0, 8.0, 8.0]),
        stl("room"),
        "{ cylinder = { from = [0, 0, -5], to = [0, 0, 5], radius = 6 } }".into(),
    ];
    let shells = shells.map(|wall| (lift(&stl("two"), "\"0.1*t\"", &wall, 0.1), false));
    let rails = [
        stl("rail"),
        block([0.0, 0.0, -2.0], [400.0, 6.0, 2.0]),
        "{ half_space = { point = [0, 0, -1], normal = [0, 0, 1], size = 9 } }".into(),
    ];
    let rails = rails.map(|rail| {
        let text = lift(&stl("cube"), "\"0.75 + 0.1*t\"", &rail, 0.5);
        (text.replace("0.2*t", "150*t - 150"), true)
    });
    let beside = [
        stl("room"),
        block([0.0; 3], [8.0, 8.0, 8.0]),
        "{ capsule = { from = [0, 0, -9], to = [0, 0, 3], radius = 1 } }".into(),
    ];
    let beside = beside.map(|wall| {
        (
            lift(&stl("cube"), "\"5.335 + 0.01*t\"", &wall, 0.0017),
            true,
        )
    });
    let open = ["flipped", "cracked", "flap"];
    let open = open.map(|name| {
        (
            lift(&ball([0.0; 3], 0.3), "\"0.1*t\"", &stl(name), 0.1),
            false,
        )
    });
    vec![
        kind("a ball that jumps into a mesh", into),
        kind("a second shell inside", shells),
        kind("carriages of triangles", rails),
        kind("a mesh beside a block", beside),
        kind("a ball in a mesh that is not closed", open),
    ]
}

fn write_meshes(folder: &Path) {
    let boxes = |list: &[([f64; 3], [f64; 3])]| {
        let of_box = |&(centre, half): &([f64; 3], [f64; 3])| {
            let corner = move |k| DVec3::from(centre) + DVec3::from(half) * box_corner(k);
            BOX_TRIANGLES.map(|t| t.map(corner))
        };
        stl_text(list.iter().flat_map(of_box))
    };
    let room = boxes(&[([0.0; 3], [4.0; 3])]);
    let mut lines: Vec<&str> = room.lines().collect();
    lines.swap(3, 4);
    let flap = "facet normal 0 0 0\nouter loop\nvertex 4 4 4\nvertex 4 4 -4\nvertex 7 7 1\nendloop\nendfacet\nendsolid";
    for (name, text) in [
        ("cube", boxes(&[([0.0; 3], [1.0; 3])])),
        ("rail", boxes(&[([0.0, 0.0, -2.0], [200.0, 3.0, 1.0])])),
        (
            "two",
            boxes(&[([30.0, 0.0, 0.0], [1.0; 3]), ([0.0; 3], [0.5; 3])]),
        ),
        ("flipped", lines.join("\n") + "\n"),
        (
            "cracked",
            room.replacen("vertex -4 -4 -4", "vertex -4.0000007 -4 -4", 1),
        ),
        ("flap", room.replace("endsolid", flap)),
        ("room", room),
    ] {
        std::fs::write(folder.join(format!("{name}.stl")), text).unwrap();
    }
}

/// The same verdict at few samples and at many.
#[test]
fn siblings_of_the_reviewed_scenes_are_judged_rightly() {
    let folder = tempfile::tempdir().unwrap();
    write_meshes(folder.path());
    let mut count = 0;
    for kind in [strokes(), turning(), on_joints(), meshes()]
        .into_iter()
        .flatten()
    {
        assert_eq!(kind.siblings.len(), 3, "{}", kind.name);
        for (text, passes) in kind.siblings {
            let scene = Scene::parse_in(folder.path(), kind.name, &text);
            let scene = scene.unwrap_or_else(|e| panic!("{}: {e}\n{text}", kind.name));
            for samples in [7, 40] {
                let options = CheckOptions {
                    samples: Samples::Even(samples),
                    ..CheckOptions::default()
                };
                let told = |said: &str| format!("{}, {samples} samples: {said}\n{text}", kind.name);
                let check = scene
                    .check(&options)
                    .unwrap_or_else(|e| panic!("{}", told(&e.to_string())));
                assert_eq!(check.passed(), passes, "{}", told(check.text()));
                // The report that people open says the same as the exit code.
                let is_red =
                    check.to_junit().contains("<failure") || check.to_junit().contains("<error");
                assert_eq!(is_red, !passes, "{}", told(check.text()));
            }
            count += 1;
        }
    }
    assert_eq!(count, 57);
}
