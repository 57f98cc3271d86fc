//! Sweeps a dimension, keeps what is proved, draws the best: `cargo run --release --example sweep_parameter`.

use mechanim::{Certificate, Error, Samples, Scene};

fn main() -> Result<(), Error> {
    let scene = Scene::builtin("slider-crank")?;
    let mut best: Option<(f64, f64)> = None;
    for length in (90..=180).step_by(10).map(f64::from) {
        let motion = scene
            .with_parameter("L", length)?
            .solve(Samples::Even(72))?;
        let is_proved = motion.poses().all(|pose| {
            matches!(pose.certificate(), Certificate::Certified { error_bound, .. } if error_bound < 1e-9)
        });
        // How far the piston's stroke is from symmetric: its mid-position against the crank's axis.
        let travel = motion.values("h")?;
        let middle = travel.iter().sum::<f64>() / travel.len() as f64;
        let skew = (middle - length).abs();
        println!(
            "L = {length:3} mm: mean travel off by {skew:.6} mm, whole {}, proved {is_proved}",
            motion.is_whole()
        );
        if motion.is_whole() && is_proved && best.is_none_or(|(least, _)| skew < least) {
            best = Some((skew, length));
        }
    }
    if let Some((_, length)) = best {
        let motion = scene
            .with_parameter("L", length)?
            .solve(Samples::Even(40))?;
        motion.film().size(320, 240).write("best.gif")?;
        println!("best.gif: L = {length} mm");
    }
    Ok(())
}
