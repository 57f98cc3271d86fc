//! Drives that jump at one instant do so together: no pose is judged at which one of them has jumped and the other has not.

use crate::program::Workspace;

/// A ball at the angle `u`, farther out by `v`, beside a post.
fn open_chain([u, v]: [&str; 2], [x, y]: [f64; 2]) -> String {
    let drive = |text: &str| match text.starts_with('{') {
        true => text.to_owned(),
        false => format!("\"{text}\""),
    };
    format!(
        r#"
duration = 2
[inputs]
u = {}
v = {}
[[bodies]]
name = "ball"
frame = "Rz(u) Tx(1 + v)"
shapes = [{{ sphere = {{ radius = 0.1 }} }}]
[[bodies]]
name = "post"
shapes = [{{ sphere = {{ center = [{x}, {y}, 0], radius = 0.1 }} }}]
[clearance]
minimum = 0.1
pairs = [{{ pair = ["ball", "post"], minimum = 0.1 }}]
"#,
        drive(u),
        drive(v)
    )
}

/// The same ball at the end of two long links, which the arm moves.
fn closed_loop(drives: [&str; 2], post: [f64; 2]) -> String {
    let links = "Tx(5) Ty(-20) Rz(al) Tx(30) Rz(ga - al) Tx(30)";
    let section = format!(
        "[loops]\nl = \"Rz(u) Tx(1 + v) Rz(ga - u) inv({links})\"\n[guess]\nal = 2\nga = 0.5\n[[bodies]]"
    );
    open_chain(drives, post)
        .replacen("[[bodies]]", &section, 1)
        .replace("Rz(u) Tx(1 + v)\"\nshapes", &format!("{links}\"\nshapes"))
}

/// Where the ball is.
fn place([u, v]: [f64; 2]) -> [f64; 2] {
    [(1.0 + v) * u.cos(), (1.0 + v) * u.sin()]
}

/// Two drives, values that they have at one time, and values that they never have together.
struct JointJump {
    drives: [&'static str; 2],
    there: &'static [[f64; 2]],
    never: &'static [[f64; 2]],
}

const JUMPS: [JointJump; 9] = [
    // One quotient, written in two ways, and rounded in two ways.
    JointJump {
        drives: ["0.5*floor(t/0.3)", "2*floor(10*t/3)"],
        there: &[[0.0, 0.0], [0.5, 2.0], [1.0, 4.0], [3.0, 12.0]],
        never: &[
            [0.5, 0.0],
            [0.0, 2.0],
            [1.0, 2.0],
            [1.5, 4.0],
            [2.5, 12.0],
            [3.0, 10.0],
        ],
    },
    JointJump {
        drives: ["0.5*floor(t/0.1)", "floor(t*10)"],
        there: &[[0.5, 1.0], [1.5, 3.0], [3.5, 7.0]],
        never: &[
            [1.5, 2.0],
            [1.0, 3.0],
            [3.0, 7.0],
            [3.5, 6.0],
            [7.0, 15.0],
            [8.5, 18.0],
        ],
    },
    // A formula of the other one.
    JointJump {
        drives: ["0.5*floor((0.1 + 0.2)*t/0.09)", "2*mod(floor(t/0.3), 3)"],
        there: &[[0.5, 2.0], [1.0, 4.0], [1.5, 0.0]],
        never: &[[0.5, 0.0], [0.0, 2.0], [1.0, 2.0], [1.5, 4.0], [1.0, 0.0]],
    },
    // Steps beside a formula, and steps that differ by a rounding.
    JointJump {
        drives: [
            "{ keys = [[0, 0], [0.3, 0.5], [1.2, 1]], ease = \"step\" }",
            "2*floor(t/0.3)",
        ],
        there: &[[0.0, 0.0], [0.5, 2.0], [0.5, 6.0], [1.0, 8.0]],
        never: &[[0.5, 0.0], [0.0, 2.0], [1.0, 6.0], [0.5, 8.0]],
    },
    JointJump {
        drives: [
            "{ keys = [[0, 0], [0.3, 0.5], [1.1, 1]], ease = \"step\" }",
            "{ keys = [[0, 0], [0.30000000000000004, 2], [1.1, 4]], ease = \"step\" }",
        ],
        there: &[[0.0, 0.0], [0.5, 2.0], [1.0, 4.0]],
        never: &[[0.5, 0.0], [0.0, 2.0], [1.0, 2.0], [0.5, 4.0]],
    },
    JointJump {
        drives: [
            "0.5*floor(t/0.3)",
            "{ keys = [[0, 0], [0.30000000000000004, 2], [\"0.1 + 0.5\", 4]], ease = \"step\" }",
        ],
        there: &[[0.0, 0.0], [0.5, 2.0], [1.0, 4.0], [2.0, 4.0]],
        never: &[[0.5, 0.0], [0.0, 2.0], [1.0, 2.0], [0.5, 4.0]],
    },
    // Saws of other phases and lengths, which fall together at 0.3 s and 1.5 s.
    JointJump {
        drives: ["6*mod(t, 0.3)", "12*mod(t + 0.1, 0.4)"],
        there: &[[0.0, 1.2], [1.7994, 4.7988], [0.0, 0.0]],
        never: &[[1.8, 0.0], [0.0, 4.8]],
    },
    // One jumps where the other kinks.
    JointJump {
        drives: ["abs(t - 0.3)", "floor(t/0.1)"],
        there: &[[0.3, 0.0], [0.0001, 2.0], [0.0, 3.0]],
        never: &[[0.25, 2.0], [0.2, 3.0]],
    },
    JointJump {
        drives: [
            "{ keys = [[0, 0.6], [0.30000000000000004, 0], [2, 1.7]], ease = \"linear\" }",
            "2*floor(t/0.3)",
        ],
        there: &[[0.6, 0.0], [0.0001, 0.0], [0.0, 2.0], [0.2999, 2.0]],
        never: &[[0.5, 2.0], [0.2, 4.0]],
    },
];

#[test]
fn drives_that_jump_at_one_instant_jump_together() {
    let w = Workspace::new();
    for JointJump {
        drives,
        there,
        never,
    } in &JUMPS
    {
        for scene in [open_chain, closed_loop] {
            let cases = there.iter().map(|values| (values, 1));
            for (values, code) in cases.chain(never.iter().map(|values| (values, 0))) {
                w.write("scene.toml", scene(*drives, place(*values)));
                for samples in ["2", "7", "21", "40"] {
                    let said = w.run(&["check", "scene.toml", "--samples", samples]);
                    let text = said.text();
                    assert_eq!(
                        said.code, code,
                        "{drives:?} at {values:?}, {samples} samples: {text}"
                    );
                    // What is there fails, which is more than not to be proved.
                    assert_eq!(text.contains("  failed "), code == 1, "{text}");
                }
            }
        }
    }
}
