//! Microseconds of CPU for a random piece of a study: its poses one by one, and eight pieces side by side, in one run.
//!
//! `cargo bench --bench pieces [-- SCENE TOLERANCE PIECES]`. The pieces and their numbers are those of `mechanim tolerance`.

use mechanim::analysis::study::{AT_A_TIME, Evaluator, LaneEvaluator, LoadedStudy, PoseAnchors};
use mechanim::analysis::tolerance::{Distribution, SampleBatch, values_of};
use mechanim::scene::{Overrides, builtin, load_scene};
use std::time::Instant;

/// Repetitions; the machine is rarely quiet.
const REPETITIONS: usize = 7;

/// Seconds of CPU of this thread where Linux says so, else of a clock.
fn seconds(begun: Instant) -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split(' ').next().and_then(|n| n.parse::<f64>().ok());
    nanoseconds.map_or_else(|| begun.elapsed().as_secs_f64(), |n| n * 1e-9)
}

/// The best of all repetitions in microseconds a piece, and what the last one gave.
fn timed<T>(count: usize, mut work: impl FnMut() -> T) -> (f64, T) {
    let begun = Instant::now();
    let mut best = f64::INFINITY;
    let mut once = || {
        let before = seconds(begun);
        let result = work();
        best = best.min((seconds(begun) - before) * 1e6 / count as f64);
        result
    };
    let mut result = once();
    for _ in 1..REPETITIONS {
        result = once();
    }
    (best, result)
}

fn measure(name: &str, tolerance: f64, count: usize) -> Option<()> {
    let source = builtin::find_builtin(name)?;
    let dimensions = load_scene(&source, &Overrides::default()).ok()?.dimensions;
    let loaded = LoadedStudy::new(source, Overrides::default(), &dimensions).ok()?;
    let tolerances = loaded.tolerances(Some(tolerance)).ok()?;
    let stand = loaded.nominal().ok()?.poses;
    let batch = SampleBatch {
        samples: count,
        first: 0,
        seed: 1,
        distribution: Distribution::Uniform,
        threads: 1,
    };
    let draw = |item| values_of(&stand, &tolerances, batch, item);
    let designs: Vec<Vec<f64>> = (0..count).map(draw).collect();
    let mut plain = Evaluator::new(&loaded.family);
    let (alone, one_by_one) = timed(count, || {
        let one = |values: &Vec<f64>| {
            let there = plain.approach(&stand, values).ok()?;
            Some(plain.measure(&there).ok()?.measures)
        };
        designs.iter().map(one).collect::<Vec<_>>()
    });
    let anchors = PoseAnchors::new(&Evaluator::new(&loaded.family), &stand);
    let mut lanes = LaneEvaluator::new(Evaluator::new(&loaded.family), &anchors);
    let (together, side_by_side) = timed(count, || {
        let groups = designs.chunks(AT_A_TIME);
        let found = groups.flat_map(|group| lanes.measure(group));
        found.map(|f| Some(f.ok()?.measures)).collect::<Vec<_>>()
    });
    let pairs = one_by_one
        .iter()
        .flatten()
        .zip(side_by_side.iter().flatten());
    let apart = pairs.flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).abs()));
    let apart = apart.fold(0.0, f64::max);
    println!(
        "| {name}, ±{tolerance}, {} poses | {alone:.0} | {together:.0} | {:.1} | {} of {} | {apart:.0e} |",
        stand.poses.len(),
        alone / together,
        lanes.alone / REPETITIONS,
        count
    );
    Some(())
}

fn main() {
    let given: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    println!(
        "| pieces | one by one, µs | eight at a time, µs | ratio | left their lanes | apart |"
    );
    println!("|---|---|---|---|---|---|");
    let number = |k: usize, other: f64| given.get(k).and_then(|a| a.parse().ok()).unwrap_or(other);
    let names = given
        .first()
        .map_or(vec!["gearshift", "gearshift-optimised"], |n| vec![n]);
    for name in names {
        if measure(name, number(1, 0.1), number(2, 4000.0) as usize).is_none() {
            println!("| {name} | cannot be studied |");
        }
    }
}
