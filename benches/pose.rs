//! Microseconds per pose and closure error of the solver, for three mechanisms of growing size.
//!
//! Plain timing: minimum and median of interleaved repetitions, printed as a table.

use mechanim::diag::Source;
use mechanim::kinematics::continuation::solve;
use mechanim::scene::{Overrides, Scene, builtin, load};
use std::time::Instant;

/// Repetitions; the machine is rarely quiet.
const REPETITIONS: usize = 15;

const RSSR: &str = r#"
duration = 1
[parameters]
a = 40
b = 130
c = 90
[inputs]
phi = "2*pi*t"
[chains]
ground = "Tx(110) Ty(25) Tz(40) Rx(pi/2) Ry(0.35)"
[loops]
A = "Rz(phi) Tx(a) Ry(q1) Rz(q2) Tx(b) Rx(q3) Ry(q4) Rz(q5) inv(ground Rz(q6) Tx(c))"
[guess]
q6 = 1.5
"#;

fn scene(source: &Source) -> Option<Scene> {
    load(source, &Overrides::default()).ok()
}

fn main() {
    let rssr = Source {
        name: "rssr".into(),
        text: RSSR.into(),
    };
    let cases = [
        ("slider-crank", builtin::find("slider-crank"), 360),
        ("RSSR four-bar", Some(rssr), 360),
        ("gearshift", builtin::find("gearshift"), 300),
    ];
    println!(
        "| mechanism | unknowns | poses | µs/pose (min) | µs/pose (median) | closure error | iterations/pose |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, source, count) in cases {
        let Some(scene) = source.as_ref().and_then(scene) else {
            println!("| {name} | could not be read |");
            continue;
        };
        let mechanism = &scene.mechanism;
        let times: Vec<f64> = (0..count)
            .map(|k| mechanism.duration * k as f64 / count as f64)
            .collect();
        let mut micros = Vec::new();
        let mut line = String::new();
        for _ in 0..REPETITIONS {
            let start = Instant::now();
            match solve(mechanism, &times) {
                Ok(trajectory) => {
                    micros.push(start.elapsed().as_secs_f64() * 1e6 / count as f64);
                    let iterations: u32 = trajectory.poses().map(|p| p.iterations).sum();
                    line = format!(
                        "{:.1e} | {:.2}{}",
                        trajectory.closure_error(),
                        f64::from(iterations) / count as f64,
                        if trajectory.missing() > 0 {
                            " (poses missing)"
                        } else {
                            ""
                        }
                    );
                }
                Err(error) => line = error.to_string(),
            }
        }
        micros.sort_by(f64::total_cmp);
        let median = micros.get(micros.len() / 2).copied().unwrap_or(f64::NAN);
        let least = micros.first().copied().unwrap_or(f64::NAN);
        println!(
            "| {name} | {} | {count} | {least:.1} | {median:.1} | {line} |",
            mechanism.unknowns.len()
        );
    }
}
