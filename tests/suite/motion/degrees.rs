//! Scenes in degrees: numbers beside angles are degrees in every place of a scene, however the angle came there. Expected values are
//! written out by hand; nothing is read from another scene.

use crate::program::Workspace;
use mechanim::{CheckOptions, Scene};
use serde_json::Value;

/// Parameters of which some are angles by their use, others by their definition.
const PARAMETERS: &str = "
a = 30
n = 3         # an angle, as its multiple is one
k = 3         # a number
L = 100
step = \"30deg\"
turn = \"pi\"
radian = \"1rad\"
c = \"a - 10\"
e = \"n*15\"
low = \"min(a, 20)\"
";

/// Formulas of angles, and their values in degrees.
const ANGLES: [(&str, f64); 20] = [
    ("a", 30.0),
    ("2*(a - 10)", 40.0),
    ("(a - 10)*2", 40.0),
    ("(a + 2*c - 10)/3", 20.0),
    ("c*2", 40.0),
    ("2*c + 10", 50.0),
    ("k*(10 + a)", 120.0),
    ("k*step", 90.0),
    ("step/2 + 5", 20.0),
    ("turn/4", 45.0),
    ("radian*k - 100", 3.0 * 180.0 / std::f64::consts::PI - 100.0),
    ("max(a, 5) - 10", 20.0),
    ("abs(a - 40)", 10.0),
    ("mod(a + 45, 20)", 15.0),
    ("hypot(a, 40) - 10", 40.0),
    ("-(5 - a)", 25.0),
    ("a + 20*sin(30)", 40.0),
    ("e - a", 15.0),
    ("2*low + c", 60.0),
    ("L*(a - 10)/L", 20.0),
];

fn scene(formula: &str) -> String {
    // The formula as an output, a measure, in a measure of values, in an equation, in a chain, in a drive and as a limit.
    format!(
        r#"
units = {{ length = "mm", angle = "deg" }}
duration = 1
[parameters]{PARAMETERS}f = "{formula}"
[inputs]
q = "{formula}"
[equations]
tie = "u - ({formula})"
also = "0 - 2*({formula}) + w"
[guess]
u = "{formula}"
w = "2*({formula})"
[outputs]
out = "{formula}"
[[bodies]]
name = "told"
frame = "Rz(a) Rz(e) Rz(low) Tx(L) Rx(u) Ry(w) Rx(q)"
[[bodies]]
name = "direct"
frame = "Rz({formula})"
[[bodies]]
name = "named"
frame = "Rz(f)"
[[bodies]]
name = "halves"
frame = "Rz(({formula})/2) Rz(f*0.5)"
[[bodies]]
name = "driven"
frame = "Rz(q)"
[[traces]]
name = "D"
body = "direct"
point = ["L", 0, 0]
[[traces]]
name = "N"
body = "named"
point = ["L", 0, 0]
[[traces]]
name = "H"
body = "halves"
point = ["L", 0, 0]
[[traces]]
name = "Q"
body = "driven"
point = ["L", 0, 0]
[measures]
first = {{ of = "a", take = "first" }}
out_of = {{ of = "out", take = "last" }}
of = {{ of = "{formula}", take = "first" }}
less = {{ of = "({formula}) - 5", take = "first" }}
formula = "{formula}"
plus = "({formula}) + 1"
beside = "first + ({formula}) - 10"
u = {{ of = "u", take = "first" }}
w = {{ of = "w/2", take = "first" }}
below = {{ of = "u", take = "first", max = "({formula}) + 1", min = "({formula}) - 1" }}
dx = {{ of = "D.x", take = "first" }}
nx = {{ of = "N.x", take = "first" }}
hx = {{ of = "H.x", take = "first" }}
qx = {{ of = "Q.x", take = "first" }}
"#
    )
}

/// Names and values of the measures of a check, and whether all limits hold.
fn measured(text: &str) -> Vec<(String, f64, Option<bool>)> {
    let scene = Scene::parse("degrees", text).unwrap();
    let check = scene.check(&CheckOptions::default()).unwrap();
    let report: Value = serde_json::from_str(check.to_json()).unwrap();
    let rows = report["measures"].as_array().unwrap().iter();
    rows.map(|row| {
        let name = row["name"].as_str().unwrap().to_owned();
        (name, row["value"].as_f64().unwrap(), row["holds"].as_bool())
    })
    .collect()
}

/// The expected value of a measure.
fn expected(name: &str, angle: f64) -> f64 {
    match name {
        "first" => 30.0,
        "less" => angle - 5.0,
        "plus" => angle + 1.0,
        "beside" => 30.0 + angle - 10.0,
        "dx" | "nx" | "hx" | "qx" => 100.0 * angle.to_radians().cos(),
        _ => angle,
    }
}

#[test]
fn numbers_beside_angles_are_degrees_everywhere() {
    for (formula, angle) in ANGLES {
        for (name, value, holds) in measured(&scene(formula)) {
            let expected = expected(&name, angle);
            assert!(
                (value - expected).abs() < 1e-9,
                "{formula}: {name} is {value}, not {expected}"
            );
            assert_ne!(holds, Some(false), "{formula}: {name}");
        }
    }
}

/// Studies write parameters that are computed from their variables out: the nominal values are those of the check, and a sweep to
/// another value agrees with a check there.
#[test]
fn studies_see_the_angles_that_a_check_sees() {
    let w = Workspace::new();
    // Drives cannot be followed by a study.
    let studied = |formula: &str| {
        let text = scene(formula).replace(&format!("q = \"{formula}\""), "q = \"10*t\"");
        text.replace("qx = { of = \"Q.x\"", "qx = { of = \"0*Q.x + D.x\"")
            .replace(
                &format!(", max = \"({formula}) + 1\", min = \"({formula}) - 1\""),
                "",
            )
    };
    for (formula, _) in ANGLES {
        let text = studied(formula);
        w.write("studied.toml", &text);
        for a in ["30", "33"] {
            let known = measured(&text.replace("a = 30", &format!("a = {a}")));
            let design = format!("grid:a={a}..40:2");
            let run = w.run(&["sweep", "studied.toml", "--design", &design, "--out", "-"]);
            let table = run.exits(0).text();
            let mut lines = table
                .lines()
                .map(|line| line.split(',').collect::<Vec<_>>());
            let (heads, row) = (lines.next().unwrap(), lines.next().unwrap());
            for (name, value, _) in known {
                let place = heads.iter().position(|head| *head == name).unwrap();
                let swept: f64 = row[place].parse().unwrap();
                assert!(
                    (swept - value).abs() < 1e-8,
                    "{formula} at a = {a}: {name} is {swept}, not {value}"
                );
            }
        }
    }
}

/// Shares of the way and derivatives are no angles.
#[test]
fn shares_and_derivatives_are_numbers() {
    let text = r#"
units = { length = "mm", angle = "deg" }
duration = 1
[inputs]
phi = "360*t"
s = "50 + 10*t"
[equations]
e = "s - 100*sin(b)"
[guess]
b = 30
[outputs]
rate = "d(b, s)"
[[bodies]]
name = "arm"
frame = "Rz(b) Tx(s) Rx(phi)"
[measures]
share = { of = "phi - 90", take = "positive" }
per = { of = "b", per = "s", take = "first" }
of = { of = "d(b, s)", take = "first" }
out = { of = "rate", take = "first" }
"#;
    let rate = 1.0 / (100.0 * 0.75_f64.sqrt());
    for (name, value, _) in measured(text) {
        let expected = if name == "share" { 0.75 } else { rate };
        assert!(
            (value - expected).abs() < 1e-9,
            "{name}: {value} {expected}"
        );
    }
}

/// Keys without an easing are joined by straight lines, as the table of keys in the documents says.
#[test]
fn keys_are_joined_by_straight_lines() {
    let text = "units = { length = \"mm\" }\n[inputs]\nx = { keys = [[0, 0], [1, 10], [3, 0]] }\n\
                [[bodies]]\nname = \"a\"\nframe = \"Tx(x)\"\n";
    let w = Workspace::new();
    w.write("keys.toml", text);
    for (time, x) in [("0.25", 2.5), ("0.9", 9.0), ("2.5", 2.5)] {
        let run = w.run(&["solve", "keys.toml", "--at", time, "--out", "-"]);
        let row = run.exits(0).text();
        let row: Vec<&str> = row.lines().nth(1).unwrap().split(',').collect();
        assert!(
            (row[1].parse::<f64>().unwrap() - x).abs() < 1e-12,
            "{row:?}"
        );
    }
}
