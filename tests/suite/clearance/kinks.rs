//! What closed loops keep at a kink or jump of their drive, and what they do beside it: the verdict is that of the motion, however
//! many samples there are.

use crate::program::Workspace;
use serde_json::Value;

/// The drives' duration.
const DURATION: f64 = 2.0;

/// Crank, coupler, rocker and ground of the four-bar.
const BARS: [f64; 4] = [0.6, 2.0, 1.6, 1.8];

/// Radius of the two balls.
const RADIUS: f64 = 0.1;

/// The place of the crank's end at an angle.
fn crank_end(phi: f64) -> [f64; 2] {
    [BARS[0] * phi.cos(), BARS[0] * phi.sin()]
}

/// A point of the coupler, by the angle of the crank.
fn coupler_point(phi: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let [_, coupler, rocker, ground] = BARS;
    let end = crank_end(phi);
    let (dx, dy) = (ground - end[0], -end[1]);
    let d = dx.hypot(dy);
    let inner = (coupler * coupler + d * d - rocker * rocker) / (2.0 * coupler * d);
    let (sin, cos) = (dy.atan2(dx) + inner.acos()).sin_cos();
    [end[0] + x * cos - y * sin, end[1] + x * sin + y * cos]
}

/// The distance of two balls about these points.
fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1]) - 2.0 * RADIUS
}

/// A four-bar with a ball on its coupler and a fixed one; `inputs` are lines of drives, `phi` among them.
fn four_bar(inputs: &str, ball: [f64; 2], post: [f64; 2], minimum: f64) -> String {
    let [crank, coupler, rocker, ground] = BARS;
    let (x, y) = (ball[0], ball[1]);
    format!(
        r#"
duration = {DURATION}
[inputs]
{inputs}
[loops]
l = "Rz(phi) Tx({crank}) Rz(al - phi) Tx({coupler}) inv(Tx({ground}) Rz(psi) Tx({rocker}) Rz(al - psi))"
[guess]
al = 0.5
psi = 1.5
[[bodies]]
name = "coupler"
frame = "Rz(phi) Tx({crank}) Rz(al - phi)"
shapes = [{{ sphere = {{ center = [{x}, {y}, 0], radius = {RADIUS} }} }}]
[[bodies]]
name = "post"
shapes = [{{ sphere = {{ center = [{}, {}, 0], radius = {RADIUS} }} }}]
[clearance]
minimum = {minimum}
pairs = [{{ pair = ["coupler", "post"], minimum = {minimum} }}]
"#,
        post[0], post[1]
    )
}

/// What is said of the pair at so many samples, and the whole text.
fn judged(w: &Workspace, scene: &str, samples: &str) -> (Value, String) {
    w.write("scene.toml", scene);
    let said = w.run(&[
        "check",
        "scene.toml",
        "--samples",
        samples,
        "--json",
        "r.json",
    ]);
    let json: Value = serde_json::from_slice(&w.read("r.json")).expect("JSON");
    (json["clearance"]["pairs"][0].clone(), said.text())
}

/// The verdict of the pair at so many samples.
fn verdict(w: &Workspace, scene: &str, samples: &str) -> String {
    let (pair, _) = judged(w, scene, samples);
    pair["verdict"].as_str().expect("a word").to_owned()
}

/// The ball is nearest where the drive is at its least, 0.5, which it only touches, jumps to or rests at.
#[test]
fn a_minimum_that_a_loop_keeps_exactly_at_a_kink_is_proved_at_any_samples() {
    let w = Workspace::new();
    let (ball, post) = ([0.7, 0.3], [2.0, 0.0]);
    let distance = |phi: f64| apart(coupler_point(phi, ball), post);
    let rises =
        |k: u32| distance(0.5 + f64::from(k) / 100.0) < distance(0.51 + f64::from(k) / 100.0);
    assert!((0..100).all(rises));
    for drive in [
        "0.5 + min(1, abs(t - 1.2994))",
        "0.5 + min(1, 300*abs(t - 1.2994))",
        "1.2 - min(0.7, 300*abs(t - 1.2994))",
        "0.5 + max(0, t - 1.2123)",
        "0.5 + abs(abs(t - 1) - 0.4)",
        "0.5 + abs(exp(t) - 2)/6",
        "1.5 - 0.25*floor(2.3*t)",
        "0.5 + mod(2.3*t, 0.7)",
        "0.5 + 0.3*abs(atan2(0.3*sin(4*t), 0.2 + cos(4*t)))",
        "0.5 + 0.3*(pi - abs(atan2(t - 1.2994, -0.3 - 0.1*t)))",
    ] {
        for (off, expected) in [(0.0, "passed"), (1e-6, "failed"), (-1e-6, "passed")] {
            let minimum = distance(0.5) + off;
            let scene = four_bar(&format!("phi = \"{drive}\""), ball, post, minimum);
            for samples in ["2", "3", "9", "30"] {
                let found = verdict(&w, &scene, samples);
                assert_eq!(found, expected, "{drive}, {off:e}, {samples} samples");
            }
        }
    }
    for ease in ["linear", "step"] {
        let keys = "keys = [[0, 1.1], [0.37, 0.5], [0.9, 1], [1.31, 0.5], [2, 1.2]]";
        for (off, expected) in [(0.0, "passed"), (1e-6, "failed")] {
            let inputs = format!("phi = {{ {keys}, ease = \"{ease}\" }}");
            let scene = four_bar(&inputs, ball, post, distance(0.5) + off);
            for samples in ["2", "9"] {
                let found = verdict(&w, &scene, samples);
                assert_eq!(found, expected, "{ease}, {off:e}, {samples} samples");
            }
        }
    }
}

/// The crank goes there and back in some milliseconds or a ten-thousandth of a second, right before, on or after a jump.
#[test]
fn a_pulse_beside_a_jump_is_proved_at_any_samples() {
    const JUMP: f64 = 1.1307;
    let w = Workspace::new();
    for (jump, level) in [
        ("1.2 - 0.4*floor(t - 0.1307)", [1.2, 0.8]),
        ("0.8 + 0.4*floor(t - 0.1307)", [0.8, 1.2]),
    ] {
        for quick in [300.0, 1e4] {
            for off in [-4.0, -0.5, 0.0, 0.5, 4.0] {
                let at = JUMP + off / quick;
                let pulse = |t: f64| (-(quick * (t - at)).powi(2)).exp();
                // The farthest angle, on either side of the jump.
                let [before, after] = [at.min(JUMP), at.max(JUMP)].map(pulse);
                let farthest = (level[0] + before).max(level[1] + after);
                for (gap, expected) in [(0.31, "passed"), (0.29, "failed")] {
                    let post = crank_end(farthest + 2.0 * f64::asin(gap / (2.0 * BARS[0])));
                    let phi = format!("phi = \"{jump} + exp(-({quick}*(t - {at}))^2)\"");
                    let one = four_bar(&phi, [0.0; 2], post, 0.1);
                    // A second drive that is as quick and jumps with it.
                    let second = format!(
                        "{phi}\nv = \"0.3*floor(t - 0.1307) + exp(-({quick}*(t - {at}))^2)\""
                    );
                    let two = four_bar(&second, [0.0; 2], post, 0.1)
                        .replace("frame = \"Rz(phi)", "frame = \"Tz(0.001*v) Rz(phi)");
                    for (scene, samples) in [(&one, "2"), (&one, "3"), (&one, "40"), (&two, "3")] {
                        let found = verdict(&w, scene, samples);
                        assert_eq!(
                            found, expected,
                            "{jump}, {quick}, {off}, {gap}, {samples} samples"
                        );
                    }
                }
            }
        }
    }
}

/// A turn about z by an angle whose bounds overflow between two samples: its kink lies in an `atan2`.
const TURNS: [&str; 5] = [
    "atan2(sin(u)*abs(cos(u)), cos(u)+0.01)",
    "atan2(abs(u-1)-0.01, u-1)",
    "atan2(abs(cos(u)), cos(u)+0.1)",
    "atan2(sin(u)*abs(cos(u)), cos(u)+0.3)",
    "atan2(abs(cos(u)), sin(u)-0.7)",
];

/// A ball that turns above a plane: it keeps its height, whatever the angle. `pairs` is the rest of the section.
fn turning_ball(turn: &str, clearance: &str) -> String {
    format!(
        r#"
units = {{ length = "mm" }}
duration = 3
[inputs]
u = "t"
[[bodies]]
name = "arm"
frame = "Rz({turn})"
shapes = [{{ sphere = {{ center = [-0.5, 1.313, 0.75], radius = 0.25 }} }}]
[[bodies]]
name = "floor"
shapes = [{{ half_space = {{ point = [0, 0, 0], size = 10 }} }}]
[clearance]
{clearance}
"#
    )
}

/// Where nothing is known of a motion, nothing is said of it: a distance that is below its minimum all the time is so in the report,
/// and bodies in contact all the time are never said to part.
#[test]
fn what_is_not_known_of_a_motion_is_not_told_of_it() {
    let w = Workspace::new();
    for turn in TURNS {
        for samples in ["2", "4", "5", "7", "20", "61"] {
            let case = format!("{turn}, {samples} samples");
            // Half a millimetre above the plane, at all times.
            let (pair, _) = judged(&w, &turning_ball(turn, "minimum = 0.51"), samples);
            assert_eq!(pair["verdict"], "failed", "{case}");
            let violations = &pair["violations"];
            let told: f64 = violations["intervals"]
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(|one| Some(one["to"].as_f64()? - one["from"].as_f64()?))
                .sum();
            let is_all = (told - 3.0).abs() < 1e-6;
            assert!(
                is_all || violations["certified"] == false,
                "{case}: {violations}"
            );
            let clear = turning_ball(turn, "minimum = 0.49");
            assert_ne!(verdict(&w, &clear, samples), "failed", "{case}");
            // In contact, at all times.
            let touching = turning_ball(turn, "touching = [{ pair = [\"arm\", \"floor\"] }]");
            let touching = touching.replace("0.75]", "0.25]");
            let (pair, text) = judged(&w, &touching, samples);
            assert_ne!(pair["verdict"], "failed", "{case}: {pair}");
            assert!(!text.contains("inf "), "{case}: {text}");
        }
    }
}

/// Bodies that go beyond all numbers between or at samples: nothing is proved there, and nothing ends the program.
#[test]
fn bodies_beyond_all_numbers_are_no_reason_to_stop() {
    let w = Workspace::new();
    for frame in [
        "Tx(1/((u-0.5)^2+1e-200))",
        "Tx(exp(800*u))",
        "Rz(u) Tx(1/((u-0.5)^2+1e-300))",
        "Tz(tan(3*u))",
    ] {
        let scene = format!(
            "units = {{ length = \"m\" }}\nduration = 1\n[inputs]\nu = \"t\"\n\
             [[bodies]]\nname = \"a\"\nshapes = [{{ sphere = {{ radius = 0.1 }} }}]\n\
             [[bodies]]\nname = \"b\"\nframe = \"{frame}\"\nshapes = [{{ sphere = {{ radius = 0.1 }} }}]\n\
             [clearance]\nminimum = 0\n"
        );
        w.write("scene.toml", scene);
        for samples in ["2", "3", "4", "5", "24"] {
            let said = w.run(&["check", "scene.toml", "--samples", samples]);
            assert!(
                matches!(said.code, 1 | 4),
                "{frame} {samples}: {}",
                said.text()
            );
        }
    }
}
