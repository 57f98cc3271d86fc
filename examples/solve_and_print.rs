//! Solves a motion and prints values with their proofs: `cargo run --release --example solve_and_print`.

use mechanim::{Certificate, Error, Samples, Scene};

fn main() -> Result<(), Error> {
    let scene = Scene::builtin("slider-crank")?.with_parameter("L", 120)?;
    let motion = scene.solve(Samples::Even(12))?;
    for pose in motion.poses() {
        let (time, h) = (pose.time(), pose.value("h")?);
        match pose.certificate() {
            Certificate::Certified { error_bound, .. } => {
                println!("{time:.3} s   h = {h:.12} mm, off by at most {error_bound:.0e} mm");
            }
            other => println!("{time:.3} s   h = {h:.12} mm, {other:?}"),
        }
    }
    Ok(())
}
