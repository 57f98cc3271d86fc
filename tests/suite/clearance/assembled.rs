//! What touches at a joint is what touches near it where the bodies are put together: nothing else of them is left out, along
//! a motion or over a box of inputs; and where a motion has no pose, nothing passes.

use crate::program::Workspace;

const HEAD: &str = "title = \"t\"\nduration = 2\nunits = { length = \"mm\", angle = \"deg\" }\n";

/// Two bodies with a frame and a shape each, and spheres far away, so that something is judged.
fn two(drives: &str, first: [&str; 2], second: [&str; 2], minimum: f64) -> String {
    let body = |name: &str, [frame, shape]: [&str; 2], height: f64| {
        format!(
            "[[bodies]]\nname = \"{name}\"\nframe = \"{frame}\"\nshapes = [{shape}, {{ sphere = {{ center = [0, 0, {height}], radius = 1 }} }}]\n"
        )
    };
    format!(
        "{HEAD}[inputs]\n{drives}\n{}{}[clearance]\nminimum = {minimum}\n",
        body("first", first, 180.0),
        body("second", second, 90.0)
    )
}

fn capsule(from: &str, to: &str) -> String {
    format!("{{ capsule = {{ from = {from}, to = {to}, radius = 1 }} }}")
}

#[test]
fn contacts_far_from_a_joint_are_judged() {
    let arm = capsule("[0, 0, 0]", "[25, 0, 0]");
    let offset = capsule("[-3, 0, 0]", "[22, 0, 0]");
    let post = |x: f64| capsule(&format!("[{x}, 0, -30]"), &format!("[{x}, 0, 30]"));
    let plate = "{ box = { center = [130, 0, 0], size = [210, 210, 4] } }";
    let rail = "{ box = { center = [100, 0, 0], size = [600, 20, 10] } }";
    let carriage = |z: f64| format!("{{ box = {{ center = [0, 0, {z}], size = [30, 30, 20] }} }}");
    let turn = "u = \"360*t\"\nh = \"10*t\"";
    let rows = [
        (
            "post through the arm's end",
            two(turn, ["E", &post(24.0)], ["Rz(u)", &arm], 0.1),
            1,
        ),
        (
            "post through its middle",
            two(turn, ["E", &post(12.0)], ["Rz(u)", &arm], 0.1),
            1,
        ),
        (
            "post next to the joint",
            two(turn, ["E", &post(8.0)], ["Rz(u)", &arm], 0.1),
            1,
        ),
        (
            "post at the joint",
            two(turn, ["E", &post(0.0)], ["Rz(u)", &arm], 0.1),
            0,
        ),
        (
            "post beyond the arm",
            two(turn, ["E", &post(28.0)], ["Rz(u)", &arm], 0.1),
            0,
        ),
        (
            "offset parallel axes",
            two(
                turn,
                ["E", &post(24.0)],
                ["Rz(u) Tx(3) Tz(h)", &offset],
                0.1,
            ),
            1,
        ),
        (
            "plate at the arm's end",
            two(
                turn,
                ["E", plate],
                ["Rz(u)", &capsule("[0, 0, 0]", "[30, 0, 0]")],
                0.1,
            ),
            1,
        ),
        (
            "carriage too near its rail",
            two(turn, ["E", rail], ["Tx(h)", &carriage(15.2)], 0.5),
            1,
        ),
        (
            "carriage clear of its rail",
            two(turn, ["E", rail], ["Tx(h)", &carriage(15.6)], 0.5),
            0,
        ),
        (
            "carriage on its rail",
            two(turn, ["E", rail], ["Tx(h)", &carriage(15.0)], 0.5),
            0,
        ),
    ];
    for (name, text, code) in rows {
        let w = Workspace::new();
        w.write("two.toml", text);
        let run = w.run(&["check", "two.toml"]);
        println!("{name}: {}", run.text());
        run.exits(code);
    }
}

/// An elbow whose lower arm folds onto the upper one.
fn elbow() -> String {
    format!(
        "{HEAD}[inputs]\nu = \"30+15*t\"\nv = \"-20+20*t\"\n[[bodies]]\nname = \"upper\"\nframe = \"Rz(u)\"\nshapes = [{}]\n[[bodies]]\nname = \"lower\"\nframe = \"Rz(u) Tx(50) Rz(v)\"\nshapes = [{}]\n[clearance]\nminimum = 0.5\n",
        capsule("[0, 0, 0]", "[50, 0, 0]"),
        capsule("[3, 0, 0]", "[40, 0, 0]")
    )
}

#[test]
fn strips_of_a_box_have_the_joints_of_the_assembled_pose() {
    let rows = [
        (["u=0:90", "v=170:179"], 1),
        (["v=170:179", "u=0:90"], 1),
        (["u=0:90", "v=178:179"], 1),
        (["v=178:179", "u=0:90"], 1),
        (["u=0:90", "v=-40:40"], 0),
        (["v=-40:40", "u=0:90"], 0),
    ];
    for ([first, second], code) in rows {
        let w = Workspace::new();
        w.write("elbow.toml", elbow());
        let run = w.run(&[
            "check",
            "elbow.toml",
            "--inputs-box",
            first,
            "--inputs-box",
            second,
        ]);
        println!("{first} {second}: {}", run.text());
        run.exits(code);
    }
}

#[test]
fn a_box_in_which_nothing_is_judged_passes_if_allowed() {
    let w = Workspace::new();
    w.write(
        "elbow.toml",
        elbow() + "ignore = [{ pair = [\"upper\", \"lower\"], reason = \"elbow\" }]\n",
    );
    let sides = ["check", "elbow.toml", "--inputs-box", "u=0:90"];
    w.run(&sides).exits(1);
    w.run(&[&sides[..], &["--allow-empty"]].concat()).exits(0);
}

/// Drives without a value for two thousandths of a second, a measure, and a joint's own formula.
#[test]
fn short_gaps_of_drives_are_unchecked() {
    let root = "sqrt((t-1.0112)^2 - 1e-6)";
    let ball = "{ sphere = { radius = 1 } }";
    let wall = "{ box = { center = [0, 0, 40], size = [40, 40, 10] } }";
    let pair = two(
        &format!("z = \"{root}\""),
        ["E", wall],
        ["Tz(z)", ball],
        0.5,
    );
    let own = two(
        "z = \"t\"",
        ["E", wall],
        ["Tz(sqrt((z-1.0112)^2 - 1e-6))", ball],
        0.5,
    );
    // That a drive has no value is proved, so that the motion is known to end.
    for (name, text, code) in [("drive", pair, 4), ("joint", own, 1)] {
        for samples in ["10", "41", "100"] {
            let w = Workspace::new();
            w.write("gap.toml", &text);
            let run = w.run(&[
                "check",
                "gap.toml",
                "--samples",
                samples,
                "--allow-estimates",
                "--json",
                "gap.json",
            ]);
            println!("{name} {samples}: {}", run.text());
            run.exits(code);
            let found: serde_json::Value = serde_json::from_slice(&w.read("gap.json")).unwrap();
            let gaps = found["clearance"]["unchecked"].as_array().unwrap();
            let holds = |gap: &serde_json::Value| {
                gap[0].as_f64().unwrap() <= 1.010_21 && gap[1].as_f64().unwrap() >= 1.012_19
            };
            assert!(gaps.iter().any(holds), "{name} {samples}: {gaps:?}");
        }
    }
}
