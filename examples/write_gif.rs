//! A GIF in ten lines: `cargo run --release --example write_gif -- gearshift gearshift.gif`.

use mechanim::{Error, Samples, Scene};

fn main() -> Result<(), Error> {
    let mut words = std::env::args().skip(1);
    let scene = words.next().unwrap_or_else(|| "gearshift".to_owned());
    let path = words.next().unwrap_or_else(|| format!("{scene}.gif"));
    let motion = Scene::builtin(&scene)?.solve(Samples::Frames)?;
    let bytes = motion.film().size(480, 360).write(&path)?;
    println!("{path}: {} frames, {bytes} bytes", motion.len());
    Ok(())
}
