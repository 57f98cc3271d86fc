//! Poses at single instants, between two jumps or at the ends of the motion: they count as much as all others.

use crate::program::Workspace;
use serde_json::Value;

/// A ball that a drive moves by 5 towards another one, 3.55 apart.
fn scene(duration: f64, drive: &str, beside: &str) -> String {
    format!(
        r#"
duration = {duration}
[inputs]
w = "{drive}"
v = "{beside}"
[chains]
C = "T(10, 5.55 - 5*w, 0)"
[clearance]
minimum = 0.5
[[bodies]]
name = "a"
shapes = [{{ sphere = {{ center = [10, 0, 0], radius = 1 }} }}]
[[bodies]]
name = "b"
frame = "C"
shapes = [{{ sphere = {{ radius = 1 }} }}]
[[traces]]
name = "K"
body = "b"
[measures]
least = {{ of = "K.y", take = "min", min = 2.5 }}
most = {{ of = "w", take = "max", max = 0.5 }}
"#
    )
}

/// What a check says: the code, and the report.
fn checked(text: &str, samples: &str) -> (i32, Value) {
    let w = Workspace::new();
    w.write("scene.toml", text);
    let run = w.run(&[
        "check",
        "scene.toml",
        "--samples",
        samples,
        "--json",
        "report.json",
    ]);
    let report = serde_json::from_slice(&w.read("report.json")).unwrap();
    (run.code, report)
}

/// Each is one at one instant of two seconds and zero at all others, with T for the time.
const PULSES: [(&str, f64); 9] = [
    ("floor(T)*floor(2 - T)", 1.0),
    ("(floor(T) + floor(-T) + 1)*T*(2 - T)", 1.0),
    ("(1 - mod(T, 1) - mod(-T, 1))*T*(2 - T)", 1.0),
    ("min(floor(T), floor(2 - T))", 1.0),
    ("1 + floor(-abs(T - 1))", 1.0),
    ("floor(1 - (T - 1)^2)", 1.0),
    ("floor(T/2)", 2.0),
    ("floor(1 - T/2)", 0.0),
    ("floor(T)*(1 + floor(1 - T)*0.9)", 1.0),
];

fn is_whole(number: f64) -> bool {
    number.fract() == 0.0
}

#[test]
fn a_pose_between_two_jumps_counts() {
    for (pulse, place) in PULSES {
        for scale in [1.0, 0.3, 0.7, 1e-3, 40.0] {
            // The same over another time.
            let drive = pulse.replace('T', &format!("(t/{scale})"));
            for samples in ["2", "7", "41"] {
                let name = format!("{drive}, {samples} samples");
                let (code, report) = checked(&scene(2.0 * scale, &drive, "t"), samples);
                let time = place * scale;
                assert_eq!(code, 1, "{name}: {report}");
                // Of a quotient that turns back where it is whole nothing is proved, nor of one at an instant that is no number.
                let is_known = !drive.contains('^') && (!drive.contains("abs") || is_whole(scale));
                if !is_known {
                    continue;
                }
                for measure in report["measures"].as_array().unwrap() {
                    assert_eq!(measure["holds"], false, "{name}: {measure}");
                }
                // Bodies that meet at the first pose count as joined there.
                if place == 0.0 {
                    continue;
                }
                let pair = &report["clearance"]["pairs"][0];
                let violations = pair["violations"]["intervals"].as_array().unwrap();
                let holds = |v: &&Value| {
                    let [from, to] = ["from", "to"].map(|end| v[end].as_f64().unwrap());
                    from <= time && time <= to && to - from < 0.01 * scale
                };
                assert!(violations.iter().any(|v| holds(&v)), "{name}: {pair}");
            }
        }
    }
}

/// A kink or another jump so near the end that both are one time, but for the pose at the end.
#[test]
fn a_jump_at_the_end_counts_beside_what_is_near_the_end() {
    for (duration, drive, beside) in [
        ("1", "floor(t)", "max(0, t - 0.9999999999995)"),
        ("1", "floor(t)", "max(0, t - 0.9999999999999)"),
        (
            "0.30000000000000004",
            "floor(t/0.30000000000000004)",
            "abs(t - 0.3)",
        ),
        (
            "0.7000000000000001",
            "floor(t/0.7000000000000001)",
            "min(t, 0.7)",
        ),
    ] {
        let text =
            scene(1.0, drive, beside).replace("duration = 1", &format!("duration = {duration}"));
        let (code, report) = checked(&text, "10");
        assert_eq!(code, 1, "{drive} {beside}: {report}");
        assert_eq!(
            report["measures"][1]["value"], 1.0,
            "{drive} {beside}: {report}"
        );
    }
    // Two steps of a table within the same time: both poses count.
    let keys = "{ keys = [[0, 0], [0.9999999999995, 1], [1, 0.2]], ease = \"step\" }";
    let text = scene(1.0, "KEYS", "t").replace("\"KEYS\"", keys);
    let (code, report) = checked(&text, "10");
    assert_eq!(code, 1, "{report}");
    assert_eq!(report["measures"][1]["value"], 1.0, "{report}");
}
