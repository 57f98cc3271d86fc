//! Scenes in degrees: numbers beside angles are degrees in every place of a scene, however the angle came there. Expected values are
//! written out by hand; nothing is read from another scene.

use crate::program::Workspace;
use mechanim::diag::Source;
use mechanim::scene::{Overrides, load_scene};
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
    ("3*radian - 100", 3.0 * 180.0 / std::f64::consts::PI - 100.0),
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
    for (index, (formula, _)) in ANGLES.into_iter().enumerate().filter(|(k, _)| k % 3 != 2) {
        let text = studied(formula);
        w.write("studied.toml", &text);
        // The file's own value, and another one.
        for a in [["30", "33"][index % 2]] {
            let known = measured(&text.replace("a = 30", &format!("a = {a}")));
            let design = format!("grid:a={a}..39:2");
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

/// Constants of shapes, points, directions, contacts and clearances are read as chains are; the same mechanism in radians has the
/// same numbers.
#[test]
fn constants_of_bodies_are_in_degrees() {
    let scene = |unit: &str, of: &dyn Fn(f64) -> String| {
        format!(
            r#"
units = {{ length = "mm", angle = "{unit}" }}
duration = 1
[parameters]
R = 20
alpha = {alpha}
[inputs]
u = "t"
[outputs]
far = {{ distance = ["ball", "wall"] }}
[[bodies]]
name = "ball"
frame = "Tz(u)"
shapes = [{{ sphere = {{ center = ["R*cos({sixty})", "R*sin(alpha)", 0], radius = "R*sin({thirty})/10" }} }}]
[[bodies]]
name = "wall"
frame = "R(cos({sixty}), sin({sixty}), 0, {ninety})"
shapes = [{{ box = {{ center = [60, 0, 0], size = [2, 400, 400] }} }}]
[[traces]]
name = "M"
body = "ball"
point = ["R*cos({sixty})", "R*tan(alpha - {thirty})", "{ten}/{five}"]
[measures]
x = {{ of = "M.x", take = "first" }}
y = {{ of = "M.y", take = "first" }}
z = {{ of = "M.z", take = "first" }}
gap = {{ of = "far", take = "first" }}
[clearance]
minimum = "R*sin({thirty})/100"
"#,
            alpha = of(60.0),
            sixty = of(60.0),
            thirty = of(30.0),
            ninety = of(90.0),
            ten = of(10.0),
            five = of(5.0),
        )
    };
    let degrees = measured(&scene("deg", &|angle| format!("{angle}")));
    let radians = measured(&scene("rad", &|angle| format!("{:?}", angle.to_radians())));
    for ((name, a, _), (_, b, _)) in degrees.iter().zip(&radians) {
        assert!(
            (a - b).abs() < 1e-9,
            "{name}: {a} in degrees, {b} in radians"
        );
    }
    assert!((degrees[0].1 - 10.0).abs() < 1e-12 && degrees.len() == 4);
}

/// Outputs that hold an angle in a product or a power, and sums of lengths and angles in any order.
#[test]
fn angles_inside_other_quantities_keep_their_unit() {
    let text = r#"
units = { length = "mm", angle = "deg" }
duration = 1
[parameters]
L = 20
dia = 10
circ = "pi*dia + 3"
[inputs]
phi = "50*t"
s = "7 + t"
[outputs]
arc = "L*phi"
of_arc = "arc/L"
square = "phi^2"
of_square = "sqrt(square)"
sum = "s - 4*phi + 5"
same_sum = "5 - 4*phi + s"
[[bodies]]
name = "arm"
frame = "Rz(phi) Tx(L) Tx(2*circ) Ty(s)"
[[traces]]
name = "M"
body = "arm"
[measures]
back = { of = "of_arc", take = "last" }
root = { of = "of_square", take = "last" }
late = { of = "arc/L - 20", take = "positive" }
length = { of = "arc", take = "last" }
turns = "length/L + 1"
one = { of = "sum", take = "last" }
other = { of = "same_sum", take = "last" }
far = { of = "sqrt(M.x^2 + M.y^2 - s^2)", take = "first" }
"#;
    let mixed = 8.0 - 4.0 * 50.0_f64.to_radians() + 5.0;
    let far = 20.0 + 2.0 * (10.0 * std::f64::consts::PI + 3.0);
    let expected = [
        50.0,
        50.0,
        0.6,
        20.0 * 50.0_f64.to_radians(),
        51.0,
        mixed,
        mixed,
        far,
    ];
    for ((name, value, _), expected) in measured(text).iter().zip(expected) {
        assert!(
            (value - expected).abs() < 1e-8,
            "{name}: {value} {expected}"
        );
    }
}

/// An angle that only its definition tells stays one in every study, on the command line and in the files that are written.
#[test]
fn angles_that_their_definition_tells_stay_angles() {
    let text = r#"
units = { length = "mm", angle = "deg" }
duration = 1
[parameters]
al = "30deg"
LL = 10
[inputs]
phi = "40*t"
[[bodies]]
name = "B"
frame = "Rz(phi) Tx(LL) Ty(LL*al)"
[[traces]]
name = "M"
body = "B"
[measures]
p = { of = "M.y", take = "first", min = 3, max = 10 }
[study]
minimise = "p"
[study.variables]
al = { range = [20, 40], tolerance = 1 }
"#;
    let w = Workspace::new();
    w.write("told.toml", text);
    let at = |al: f64| 10.0 * al.to_radians();
    for (values, al) in [
        (&[][..], 30.0),
        (&["--param", "al=20"], 20.0),
        (&["--param", "al=20deg"], 20.0),
    ] {
        let run = w.run(&[&["check", "told.toml", "--json", "c.json"], values].concat());
        run.exits(0);
        let report: Value = serde_json::from_slice(&w.read("c.json")).unwrap();
        let value = report["measures"][0]["value"].as_f64().unwrap();
        assert!((value - at(al)).abs() < 1e-9, "{values:?}: {value}");
    }
    for more in [&[][..], &["--unproved"]] {
        let sweep = [
            "sweep",
            "told.toml",
            "--design",
            "grid:al=20..40:3",
            "--out",
            "-",
        ];
        let table = w.run(&[&sweep, more].concat()).exits(0).text();
        for (line, al) in table.lines().skip(1).zip([20.0, 30.0, 40.0]) {
            let cells: Vec<&str> = line.split(',').collect();
            assert!(
                (cells[4].parse::<f64>().unwrap() - at(al)).abs() < 1e-9,
                "{line}"
            );
        }
    }
    w.run(&["optimise", "told.toml", "--out", "best.toml"])
        .exits(0);
    let report = w.run(&["check", "best.toml", "--json", "b.json"]);
    report.exits(0);
    let report: Value = serde_json::from_slice(&w.read("b.json")).unwrap();
    let value = report["measures"][0]["value"].as_f64().unwrap();
    assert!((value - at(20.0)).abs() < 1e-6, "{value}");
    for asked in [&[][..], &["--param", "al=30+-1"]] {
        let enclose = ["enclose", "told.toml", "--samples", "2", "--out", "e.json"];
        w.run(&[&enclose, asked].concat()).exits(0);
        let report = String::from_utf8(w.read("e.json")).unwrap();
        let report: Value = serde_json::from_str(&report).unwrap();
        let band = &report["measures"]["p"];
        let ends = ["lo", "hi"].map(|end| band[end].as_f64().unwrap());
        assert!(ends[0] <= at(29.0) && at(31.0) <= ends[1], "{band}");
        assert!(ends[1] - ends[0] < 1.01 * (at(31.0) - at(29.0)), "{band}");
    }
}

/// Functions and ratios beside angles are in radians, and nothing in a length becomes an angle: cycloids, involutes, arcs and Kepler's
/// equation, against their formulas.
#[test]
fn functions_and_ratios_are_in_radians() {
    let text = r#"
units = { length = "mm", angle = "deg" }
duration = "0.5*(pi - 1.1415926535897931)"
[parameters]
r = 10
R = 20
h = 30
beta = 120
wrap = 90
m = 2
k = 3
ecc = 0.5
line = "8*pi + 5"
ring = "pi*k + 5"
tooth = "pi*m/2 - 0.5"
al = "20deg"
iv = "tan(al) - al"
[inputs]
phi = "90*t"
s = "7 + t"
[equations]
kepler = "E1 - ecc*sin(E1) - phi"
rolls = "turn - s/r"
[guess]
E1 = 90
[bars]
bb = { from = [0, 0, 0], to = "Tx(s) Ty(yy)", length = "8*pi + 5" }
[[bodies]]
name = "wheel"
frame = "Tx(r*(phi - sin(phi))) Ty(r*(1 - cos(phi))) Tz(r*iv)"
[[bodies]]
name = "follower"
frame = "Rz(beta - 120) Tz(h/(2*pi)*(2*pi*phi/beta - sin(2*pi*phi/beta))) Tx(m*line) Ty(2*(8*pi + 5))"
[[bodies]]
name = "involute"
frame = "Tx(r*(cos(phi) + phi*sin(phi))) Ty(r*(sin(phi) - phi*cos(phi))) Tz(m*ring)"
[[bodies]]
name = "told"
frame = "Rz(E1) Rx(turn) Ry(wrap)"
shapes = [{ sphere = { center = [300, 0, 0], radius = "R*wrap + 16 + tooth" } }]
[[bodies]]
name = "far"
shapes = [{ sphere = { center = [400, 0, 0], radius = "3 + 2*pi*m" } }]
[[traces]]
name = "C"
body = "wheel"
[[traces]]
name = "F"
body = "follower"
[[traces]]
name = "I"
body = "involute"
[[traces]]
name = "P"
body = "far"
point = ["2*pi*10 + 5", "pi + 1", "R*wrap + 1"]
[measures]
C_x = { of = "C.x", take = "last" }
C_y = { of = "C.y", take = "last" }
C_z = { of = "C.z", take = "last" }
F_x = { of = "F.x", take = "last" }
F_y = { of = "F.y", take = "last" }
F_z = { of = "F.z", take = "last" }
I_x = { of = "I.x", take = "last" }
I_y = { of = "I.y", take = "last" }
I_z = { of = "I.z", take = "last" }
P_x = { of = "P.x", take = "last" }
P_y = { of = "P.y", take = "last" }
P_z = { of = "P.z", take = "last" }
kepler = { of = "E1", take = "last", max = "2*(50 + pi)" }
turn = { of = "turn", take = "last" }
bar = { of = "yy", take = "last" }
"#;
    use std::f64::consts::PI;
    let (phi, beta, line) = (PI / 2.0, PI / 1.5, 8.0 * PI + 5.0);
    let al = 20.0_f64.to_radians();
    let cycloid = 10.0 * (phi - phi.sin());
    let share = 2.0 * PI * phi / beta;
    // Newton's method for the anomaly.
    let anomaly = (0..50).fold(2.0_f64, |e, _| {
        e - (e - 0.5 * e.sin() - phi) / (1.0 - 0.5 * e.cos())
    });
    let expected = [
        cycloid,
        10.0,
        10.0 * (al.tan() - al),
        2.0 * line,
        2.0 * line,
        30.0 / (2.0 * PI) * (share - share.sin()),
        10.0 * phi,
        10.0,
        2.0 * (3.0 * PI + 5.0),
        20.0 * PI + 5.0,
        PI + 1.0,
        20.0 * phi + 1.0,
        anomaly.to_degrees(),
        0.8_f64.to_degrees(),
        (line * line - 64.0).sqrt(),
    ];
    for ((name, value, _), expected) in measured(text).iter().zip(expected) {
        assert!(
            (value - expected).abs() < 1e-8,
            "{name}: {value} {expected}"
        );
    }
    let radians = text
        .replace("\"deg\"", "\"rad\"")
        .replace("beta - 120", "beta - 2*pi/3");
    let radians = radians
        .replace("90*t", "pi/2*t")
        .replace("beta = 120", "beta = \"2*pi/3\"");
    let radians = radians
        .replace("wrap = 90", "wrap = \"pi/2\"")
        .replace("E1 = 90", "E1 = 1.5");
    for ((name, value, _), expected) in measured(&radians).iter().zip(expected) {
        let expected = match name.as_str() {
            "kepler" | "turn" => expected.to_radians(),
            _ => expected,
        };
        assert!(
            (value - expected).abs() < 1e-8,
            "{name} in radians: {value} {expected}"
        );
    }
}

/// Numbers in a view are degrees in every file; what is an angle has its own unit.
#[test]
fn views_are_in_degrees_and_take_angles_as_they_are() {
    let mut wrong = Vec::new();
    for (unit, angle) in [("deg", 30.0), ("rad", 30.0_f64.to_radians())] {
        for (text, degrees) in [
            ("30", 30.0),
            ("\"3*k\"", 30.0),
            ("\"30deg\"", 30.0),
            ("\"pi/6\"", 30.0),
            ("\"a\"", 30.0),
            ("\"2*a - 0.5*a\"", 45.0),
            ("\"0.5rad\"", 0.5_f64.to_degrees()),
            ("\"acos(0.5)\"", 60.0),
            ("\"pi/6+10\"", 40.0),
            ("\"a+15\"", 45.0),
            ("\"min(a, 20)\"", 20.0),
            ("\"2*asin(0.5)-30\"", 30.0),
        ] {
            let text_of_scene = format!(
                "units = {{ angle = \"{unit}\" }}\nduration = 1\n[parameters]\na = {angle:?}\nk = 10\n\
                 [[bodies]]\nname = \"b\"\nframe = \"Rz(a) Tx(1)\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
                 [view]\nazimuth = {text}\nelevation = {text}\norbit = {text}\nprojection = \"perspective\"\nfov = {text}\n"
            );
            let source = Source {
                name: "view".to_owned(),
                text: text_of_scene,
            };
            let loaded = load_scene(&source, &Overrides::default()).unwrap();
            let view = &loaded.view;
            let found = [view.azimuth, view.elevation, view.camera_path.orbit];
            if found
                .iter()
                .any(|found| (found.to_degrees() - degrees).abs() > 1e-12)
            {
                wrong.push((unit, text, found));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Formulas of sums of angles inside products, powers, roots and quotients, and the same in radians by hand; `phi` is 90 degrees, `a`
/// 30, and the length `R` is 20.
type Nested = (&'static str, fn(f64, f64, f64) -> f64);

const D: f64 = std::f64::consts::PI / 180.0;

const NESTED: [Nested; 17] = [
    ("(phi - 30)*(phi - 60)", |p, _, _| {
        (p - 30.0 * D) * (p - 60.0 * D)
    }),
    ("(phi - 30)*(phi - 60) + 0", |p, _, _| {
        (p - 30.0 * D) * (p - 60.0 * D)
    }),
    ("k*(phi - 30)^2/2 + 0.1", |p, _, _| {
        (p - 30.0 * D).powi(2) + 0.1
    }),
    ("exp(phi - 30) + (phi - 30)^2", |p, _, _| {
        (p - 30.0 * D).exp() + (p - 30.0 * D).powi(2)
    }),
    ("1/(phi - 30) + 0", |p, _, _| 1.0 / (p - 30.0 * D)),
    ("R*(1 + (phi - 30)/(phi + 30))", |p, _, r| {
        r * (1.0 + (p - 30.0 * D) / (p + 30.0 * D))
    }),
    ("R*(phi - 30)", |p, _, r| r * (p - 30.0 * D)),
    ("R*(phi - 30) + R", |p, _, r| r * (p - 30.0 * D) + r),
    ("R - (10 + a)*R/2", |_, a, r| r - (10.0 * D + a) * r / 2.0),
    ("R*min(phi, 30)", |p, _, r| r * p.min(30.0 * D)),
    ("mod(phi, 40)*R", |p, _, r| r * p.rem_euclid(40.0 * D)),
    ("hypot((phi - 30)*R, 3)", |p, _, r| {
        (r * (p - 30.0 * D)).hypot(3.0)
    }),
    ("sqrt(R^2 + (R*(phi - 30))^2)", |p, _, r| {
        r.hypot(r * (p - 30.0 * D))
    }),
    ("R*sqrt((phi - 30)^2 + (a - 60)^2)", |p, a, r| {
        r * (p - 30.0 * D).hypot(a - 60.0 * D)
    }),
    ("-(R*(abs(a - 80) - 20))", |_, a, r| {
        -r * ((a - 80.0 * D).abs() - 20.0 * D)
    }),
    ("R*(phi - sin(phi))", |p, _, r| r * (p - p.sin())),
    ("R*(a + 2*(phi - 30))", |p, a, r| {
        r * (a + 2.0 * (p - 30.0 * D))
    }),
];

/// In outputs, measures, equations, lengths of chains, and in measures of traced points: a sum inside a product is looked at by
/// itself, whatever else there is in the scene.
#[test]
fn sums_of_angles_inside_products_are_in_degrees() {
    let mut wrong = Vec::new();
    for (formula, exact) in NESTED {
        let expected = exact(90.0 * D, 30.0 * D, 20.0);
        let text = format!(
            r#"
units = {{ length = "mm", angle = "deg" }}
duration = 1
[parameters]
R = 20
k = 2
a = 30
[inputs]
phi = "90*t"
[equations]
e = "u - ({formula})"
twice = "0 - 2*({formula}) + w"
[guess]
u = {start}
w = {twice}
[outputs]
out = "{formula}"
[[bodies]]
name = "b"
frame = "Rz(phi) Rx(a) Tx(R)"
[[bodies]]
name = "slide"
frame = "Tx({formula})"
[[traces]]
name = "K"
body = "slide"
[measures]
u = {{ of = "u", take = "last" }}
w = {{ of = "w/2", take = "last" }}
out_of = {{ of = "out", take = "last" }}
of = {{ of = "{formula}", take = "last" }}
x = {{ of = "K.x", take = "last" }}
"#,
            start = exact(0.0, 30.0 * D, 20.0),
            twice = 2.0 * exact(0.0, 30.0 * D, 20.0),
        );
        for (name, value, _) in measured(&text) {
            if (value - expected).abs() > 1e-9 * expected.abs().max(1.0) {
                wrong.push((formula, name, value, expected));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Numbers beside an angle are degrees in every sum that has one, whatever else is added: products of angles, ratios, powers. Ratios
/// of lengths are radians, also in a sine.
#[test]
fn sums_with_an_angle_hold_degrees_whatever_else_they_hold() {
    let degree = std::f64::consts::PI / 180.0;
    let [phi, psi, thirty] = [60.0 * degree, 25.0 * degree, 30.0 * degree];
    let square = (phi - thirty).powi(2);
    let cases = [
        ("(phi-30)^2 + (phi-30)", square + phi - thirty),
        ("(phi-30) + (phi-30)^2", square + phi - thirty),
        ("(phi-30)^2 + phi - 30", square + phi - thirty),
        ("(phi-30)^2 + 1*(phi-30)", square + phi - thirty),
        ("(phi-30)^2 - (30-phi)", square + phi - thirty),
        ("(phi-30)^2 + abs(phi-90)", square + thirty),
        ("(phi-30)^2 + max(phi-90, 10)", square + 10.0 * degree),
        ("1/(phi-30) + (phi-30)", 1.0 / (phi - thirty) + phi - thirty),
        (
            "(phi-30)*psi + (phi-30)",
            (phi - thirty) * psi + phi - thirty,
        ),
        ("S/R - (phi-30)", 0.7 - (phi - thirty)),
        ("sin(phi - L/R)", (phi - 0.3).sin()),
        ("sin(L/R)", 0.3_f64.sin()),
        ("cos(2*L/R + phi - 30)", (0.6 + phi - thirty).cos()),
        ("tan(k*15)", (45.0 * degree).tan()),
    ];
    for (formula, expected) in cases {
        let text = format!(
            r#"
units = {{ length = "mm", angle = "deg" }}
duration = 1
[parameters]
R = 10
L = 3
S = 7
k = 3
[inputs]
phi = 60
psi = 25
[equations]
tie = "u - ({formula})"
[outputs]
q = "phi - L/R"
[[bodies]]
name = "b"
frame = "Rz(phi) Rx(psi) Tx(R) Ty(L)"
[measures]
m = {{ of = "1*({formula}) + 0*u^2", take = "first" }}
tied = {{ of = "1*u + 0*phi^2", take = "first" }}
"#
        );
        for (name, value, _) in measured(&text) {
            // Whether a sum is shown as an angle is another question.
            let mut fits = [1.0, 1.0 / degree].into_iter();
            let is_right = fits.any(|unit| (value - expected * unit).abs() < 1e-9);
            assert!(is_right, "{formula}: {name} = {value}, {expected}");
        }
    }
}

/// Neither the order of the terms of a sum nor a factor of one changes what it is.
#[test]
fn sums_are_the_same_in_any_order() {
    let value = |formula: &str| {
        let text = format!(
            r#"
units = {{ length = "mm", angle = "deg" }}
duration = 1
[parameters]
R = 10
S = 5
[inputs]
phi = 58
psi = 40
[[bodies]]
name = "b"
frame = "Rz(phi) Rx(psi) Tx(R) Ty(S)"
[[bodies]]
name = "turned"
frame = "Rz({formula}) Tx(R)"
[[traces]]
name = "T"
body = "turned"
[measures]
m = {{ of = "{formula}", take = "first" }}
x = {{ of = "T.x", take = "first" }}
"#
        );
        measured(&text).iter().map(|m| m.1).collect::<Vec<f64>>()
    };
    for alike in [
        &[
            "phi - psi - 1/phi",
            "phi - 1/phi - psi",
            "-1/phi - psi + phi",
            "phi - (psi + 1/phi)",
        ][..],
        &[
            "phi*psi - 30 + phi + psi",
            "phi + psi + phi*psi - 30",
            "-30 + phi*psi + (psi + phi)",
        ],
        &[
            "phi + 30*sin(phi)",
            "1*(phi + 30*sin(phi))",
            "(phi + 30*sin(phi))*1",
            "2*(phi + 30*sin(phi))/2",
        ],
        &["phi + (S/R + 10)", "phi + 1*(S/R + 10)", "phi + S/R + 10"],
    ] {
        let first = value(alike[0]);
        for other in &alike[1..] {
            let found = value(other);
            let fits = first.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-9);
            assert!(fits, "{}: {first:?}, {other}: {found:?}", alike[0]);
        }
    }
}

/// `R*phi` is an arc wherever it stands: the only unknown name in a product that is a length is a length.
#[test]
fn a_radius_beside_an_angle_is_a_length() {
    let scene = |radius: &str, more: &str| {
        format!(
            "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 1\n[parameters]\nR = {radius}\nn = 3\n[inputs]\nphi = \"90*t\"\n\
             [chains]\npinion = \"Rz(phi)\"\nrack = \"Tx(R*phi)\"\nslow = \"Tx(R*phi/n)\"\n[outputs]\narc = \"R*phi\"\n\
             half = \"R*phi/2 + 1\"\n{more}[[bodies]]\nname = \"pinion\"\nframe = \"pinion\"\n[[bodies]]\nname = \"rack\"\nframe = \"rack\"\n\
             [[traces]]\nname = \"T\"\nbody = \"rack\"\n"
        )
    };
    for (radius, length) in [("20", 20.0), ("2.5", 2.5)] {
        let scene = mechanim::Scene::parse("rack", &scene(radius, "")).unwrap();
        let motion = scene.solve(mechanim::Samples::At(vec![1.0])).unwrap();
        let arc = length * std::f64::consts::FRAC_PI_2;
        for (name, expected) in [("T.x", arc), ("arc", arc), ("half", 0.5 * arc + 1.0)] {
            let value = motion.values(name).unwrap()[0];
            assert!(
                (value - expected).abs() < 1e-12,
                "{name}: {value} {expected}"
            );
        }
        let units = scene.quantities();
        assert_eq!(units.iter().find(|q| q.name == "arc").unwrap().unit, "mm");
    }
}

/// Beside a number that may be the length, and where it is computed, a name may be a ratio: nothing is taken for a length.
#[test]
fn ratios_beside_lengths_stay_numbers() {
    let head = "units = { length = \"mm\", angle = \"deg\" }\nduration = 1\n";
    let body = |frame: &str| format!("[[bodies]]\nname = \"b\"\nframe = \"{frame}\"\n");
    let driven = "[inputs]\nphi = \"90*t\"\n";
    let equation = format!(
        "{head}[parameters]\ni = 0.5\n{driven}[equations]\ne = \"psi - i*(phi - 30) - 10\"\n{}",
        body("Rz(phi) Tx(20*i*phi) Rz(psi)")
    );
    let quotient = format!(
        "{head}[parameters]\nL = 10\nR = 5\ni = \"L/R\"\n{driven}[outputs]\no = \"i*phi\"\ns = \"i*phi + 10\"\n{}",
        body("Rz(phi) Tx(L) Ty(R) Tx(20*i*phi)")
    );
    let bare = format!(
        "{head}[parameters]\ni = \"20/40\"\n{driven}[outputs]\no = \"i*phi\"\n{}",
        body("Rz(phi) Tx(i*phi)")
    );
    let cases: [(&str, &[(&str, f64)]); 3] = [
        (&equation, &[("psi", 17.5)]),
        (&quotient, &[("o", 90.0), ("s", 100.0)]),
        (&bare, &[("o", 22.5)]),
    ];
    for (text, values) in cases {
        let scene = mechanim::Scene::parse("ratio", text).unwrap();
        let motion = scene.solve(mechanim::Samples::At(vec![0.5])).unwrap();
        for (name, expected) in values {
            let value = motion.values(name).unwrap()[0];
            assert!(
                (value - expected).abs() < 1e-9,
                "{name}: {value} {expected}"
            );
        }
    }
}
