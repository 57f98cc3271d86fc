//! Sweeps a dimension, keeps what is proved, draws the best: `cargo run --release --example sweep_parameter`.

use mechanim::{Certificate, Error, Samples, Scene};

fn main() -> Result<(), Error> {
    let scene = Scene::builtin("slider-crank")?;
    let mut best = (f64::INFINITY, None);
    for length in (90..=180).step_by(10) {
        let scene = scene.with_parameter("L", length)?;
        let motion = scene.solve(Samples::Even(72))?;
        let is_certified = |c| matches!(c, Certificate::Certified { .. });
        let is_proved = motion.poses().all(|pose| is_certified(pose.certificate()));
        let travel = motion.values("h")?;
        let skew = travel.iter().sum::<f64>() / travel.len() as f64 - f64::from(length);
        println!("L = {length:3} mm: proved {is_proved}, mean travel off by {skew:.6} mm");
        if is_proved && skew.abs() < best.0 {
            best = (skew.abs(), Some(motion));
        }
    }
    let Some(motion) = best.1 else { return Ok(()) };
    motion.film().size(320, 240).write("best.gif")?;
    println!("best.gif: {} frames", motion.len());
    Ok(())
}
