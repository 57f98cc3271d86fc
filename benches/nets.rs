//! Nets of k by k quadrilaterals that can only be solved as a whole: the set-up, a certified pose, and how both grow.
//!
//! Times on the clock. The nets are those of the tests.

use mechanim::diag::Source;
use mechanim::kinematics::motion::proved::{Proofs, solve_proved};
use mechanim::kinematics::structure::system::System;
use mechanim::scene::{Overrides, load_scene};
use std::sync::Arc;
use std::time::Instant;

// The tests draw more than the nets do.
#[allow(dead_code)]
#[path = "../tests/suite/draws/mod.rs"]
mod draws;
#[allow(clippy::unwrap_used)]
#[path = "../tests/suite/nets/mod.rs"]
mod nets;

/// Cells along a side.
const SIDES: [usize; 6] = [4, 7, 10, 13, 18, 22];

/// Poses of a motion: a twentieth of a unit of length apart, 0.2 of them in all.
const POSES: usize = 5;

fn seconds_and<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let begun = Instant::now();
    let done = work();
    (begun.elapsed().as_secs_f64(), done)
}

fn main() {
    println!(
        "| k | unknowns in one block | read, ms | set-up, ms | a certified pose, ms | per pose, growth by unknowns^ | worst bound |"
    );
    println!("|---|---|---|---|---|---|---|");
    let mut before: Option<[f64; 2]> = None;
    for k in SIDES {
        let source = Source {
            name: "net".to_owned(),
            text: nets::net(k),
        };
        let (reading, scene) = seconds_and(|| load_scene(&source, &Overrides::default()));
        let Ok(scene) = scene else { continue };
        let (setting_up, system) =
            seconds_and(|| System::new(Arc::clone(&scene.mechanism), &scene.actuation));
        let Ok(system) = system else { continue };
        let times: Vec<f64> = (0..=POSES).map(|j| j as f64 / POSES as f64).collect();
        let solve = |times: &[f64]| {
            let solved =
                || solve_proved(&system, &scene.actuation, times, Proofs::Poses, &|| false);
            seconds_and(solved)
        };
        let (first, _) = solve(&times[..1]);
        let (all, motion) = solve(&times);
        let pose = 1e3 * (all - first) / POSES as f64;
        let unknowns = scene.mechanism.unknowns.len() as f64;
        let growth = before.map_or("-".to_owned(), |[count, time]| {
            format!("{:.1}", (pose / time).ln() / (unknowns / count).ln())
        });
        let bounds = motion
            .poses()
            .map(|p| p.certificate.bounds().map_or(f64::NAN, |b| b[0]));
        let worst = bounds.fold(0.0, f64::max);
        let missing = motion.missing();
        assert_eq!(missing, 0, "every pose is met");
        println!(
            "| {k} | {unknowns} | {:.1} | {:.0} | {pose:.1} | {growth} | {worst:.0e} |",
            1e3 * reading,
            1e3 * setting_up
        );
        before = Some([unknowns, pose]);
    }
}
