//! A design gate for CI: checks every scene that it is given and writes JUnit beside it.
//! `cargo run --release --example check_in_ci -- scenes/slider-crank.toml scenes/four-bar.toml`

use mechanim::{Error, Scene};
use std::process::ExitCode;

fn main() -> Result<ExitCode, Error> {
    let mut all_passed = true;
    for path in std::env::args().skip(1) {
        let check = Scene::open(&path)?.check(&Default::default())?;
        all_passed &= check.passed();
        println!("{}", check.text());
        for pair in check.pairs().iter().filter(|pair| !pair.passed) {
            let [a, b] = &pair.bodies;
            println!(
                "{a} / {b}: {:.4} at {:.3} s, minimum {}",
                pair.distance, pair.time, pair.minimum
            );
        }
        let report = std::path::Path::new(&path).with_extension("junit.xml");
        if let Err(error) = std::fs::write(&report, check.to_junit()) {
            eprintln!("{}: {error}", report.display());
            all_passed = false;
        }
    }
    Ok(if all_passed {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
