//! Microseconds per pose of the solver, stage by stage, and the closure error and certified bound that they buy.
//!
//! Plain timing: the best and the median of interleaved repetitions, printed as tables. The stages of one pose are run
//! through the same calls as `solve` makes: prediction and Newton's method; rank, singular values and branch sign; the
//! certificate. The last column is `solve` itself, with bodies, traces, outputs and rates of every sample.

use mechanim::diag::Source;
use mechanim::kinematics::certificate::Certifier;
use mechanim::kinematics::loops::forward::closure_error;
use mechanim::kinematics::motion::continuation::solve_motion;

use mechanim::kinematics::results::trajectory::Trajectory;
use mechanim::kinematics::solve::branch::BranchWatch;
use mechanim::kinematics::solve::newton::{Corrector, Pace};
use mechanim::kinematics::solve::predictor::{HIGHEST_ORDER, Predictor};
use mechanim::kinematics::structure::system::System;

use mechanim::model::actuation::Actuation;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;

/// Repetitions; the machine is rarely quiet.
const REPETITIONS: usize = 31;

/// The mechanisms that other programs were measured on, with the names and numbers of poses of that comparison.
const COMPARED: [(&str, &str, usize); 3] = [
    (
        "compared: slider crank",
        include_str!("scenes/slider-crank.toml"),
        360,
    ),
    ("compared: RSSR", include_str!("scenes/rssr.toml"), 360),
    (
        "compared: three loops",
        include_str!("scenes/three-loops.toml"),
        300,
    ),
];

/// Four-bars in series: the rocker of each is the crank of the next, so that every one is a block of its own.
fn four_bars(count: usize) -> Source {
    let mut text =
        String::from("duration = 1\n[inputs]\ny0 = \"0.6 + 0.4*sin(2*pi*t)\"\n[loops]\n");
    for k in 1..=count {
        let before = k - 1;
        let _ = writeln!(
            text,
            "L{k} = \"Rz(y{before}) Tx(40) Rz(a{k}) Tx(100) Rz(b{k}) inv(Tx(90) Rz(y{k}) Tx(70))\""
        );
    }
    text.push_str("[guess]\n");
    for k in 1..=count {
        let _ = writeln!(text, "y{k} = 1.3");
    }
    Source {
        name: format!("{count} four-bars"),
        text,
    }
}

/// What is run of every pose.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Depth {
    Newton,
    Branch,
    Certificate,
}

const DEPTHS: [Depth; 3] = [Depth::Newton, Depth::Branch, Depth::Certificate];

/// A drive to follow: the first pose and all inputs.
struct Course<'m> {
    system: &'m System,
    first: Vec<f64>,
    inputs: Vec<Vec<f64>>,
}

/// What one pass along the drive found.
#[derive(Default)]
struct Pass {
    micros: f64,
    iterations: u32,
    poses: Vec<Vec<f64>>,
    worst_bound: f64,
}

impl Course<'_> {
    fn run(&self, depth: Depth) -> Pass {
        let mut corrector = Corrector::new(self.system);
        let mut predictor = Predictor::default();
        let mut watch = BranchWatch::default();
        let mut certifier = Certifier::new(self.system);
        let mut here = self.first.clone();
        let mut state = watch.observe(self.system, &mut corrector, &here);
        let mut pass = Pass {
            poses: vec![here.clone(); self.inputs.len()],
            ..Pass::default()
        };
        let start = Instant::now();
        for (inputs, kept) in self.inputs.iter().zip(&mut pass.poses) {
            let system = self.system;
            let order = HIGHEST_ORDER;
            predictor.predict(system, &mut corrector, &mut here, inputs, order);
            let correction = corrector.correct(system, &mut here, Pace::Brisk);
            assert!(correction.converged);
            pass.iterations += correction.iterations;
            if depth >= Depth::Branch {
                watch.observe_into(system, &mut corrector, &here, &mut state);
                std::hint::black_box(&state);
            }
            kept.copy_from_slice(&here);
            if depth >= Depth::Certificate {
                let certificate = certifier.polish(kept, &[], watch.bases(), &corrector);
                let [error_bound, _] = certificate.bounds().unwrap_or([f64::INFINITY; 2]);
                pass.worst_bound = pass.worst_bound.max(error_bound);
            }
        }
        pass.micros = start.elapsed().as_secs_f64() * 1e6 / self.inputs.len() as f64;
        pass
    }
}

/// Best and median.
fn summary(mut micros: Vec<f64>) -> (f64, f64) {
    micros.sort_by(f64::total_cmp);
    let middle = micros.get(micros.len() / 2).copied().unwrap_or(f64::NAN);
    (micros.first().copied().unwrap_or(f64::NAN), middle)
}

fn timed(system: &System, actuation: &Actuation, times: &[f64]) -> (f64, Trajectory) {
    let start = Instant::now();
    let trajectory = solve_motion(system, actuation, times);
    let micros = start.elapsed().as_secs_f64() * 1e6 / times.len() as f64;
    (micros, trajectory)
}

/// One line of the table.
fn measure(name: &str, scene: &Scene, count: usize, repetitions: usize) -> Option<()> {
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    let step = actuation.duration / count as f64;
    let times: Vec<f64> = (0..=count).map(|k| step * k as f64).collect();
    let system = System::new(Arc::clone(mechanism), actuation).ok()?;
    let (_, trajectory) = timed(&system, actuation, &times);
    if trajectory.missing() > 0 {
        return None;
    }
    let first = &trajectory.samples[0];
    let course = Course {
        system: &system,
        first: [&first.pose.as_ref()?.unknowns[..], &first.inputs].concat(),
        inputs: trajectory.samples[1..]
            .iter()
            .map(|s| s.inputs.clone())
            .collect(),
    };
    let mut micros: [Vec<f64>; 4] = Default::default();
    let mut last = Pass::default();
    let mut newton = Pass::default();
    for _ in 0..repetitions {
        for (depth, micros) in DEPTHS.into_iter().zip(&mut micros) {
            last = course.run(depth);
            micros.push(last.micros);
            if depth == Depth::Newton {
                newton = std::mem::take(&mut last);
            }
        }
        micros[3].push(timed(&system, actuation, &times).0);
    }
    let stages = micros.map(|m| {
        let (least, middle) = summary(m);
        format!("{least:.2} / {middle:.2}")
    });
    let closure = |pass: &Pass| {
        let gaps = pass.poses.iter().map(|pose| closure_error(mechanism, pose));
        gaps.fold(0.0, f64::max) * mechanism.size
    };
    let iterations = f64::from(newton.iterations) / count as f64;
    println!(
        "| {name} | {} | {count} | {} | {iterations:.2} | {:.1e} | {:.1e} | {:.1e} |",
        mechanism.unknowns.len(),
        stages.join(" | "),
        closure(&newton),
        closure(&last),
        last.worst_bound,
    );
    Some(())
}

/// Calls of `solve` for a single pose, best of several hundred: with the system made for each, with one system from the
/// scene's start values, and with one system from the pose itself.
fn single_poses(name: &str) -> Option<[f64; 3]> {
    let scene = load_scene(&builtin::find_builtin(name)?, &Overrides::default()).ok()?;
    let make = || System::new(Arc::clone(&scene.mechanism), &scene.actuation).ok();
    let system = make()?;
    let pose = solve_motion(&system, &scene.actuation, &[0.0])
        .samples
        .pop()?
        .pose?;
    let near = Actuation {
        guess: pose.unknowns,
        ..scene.actuation.clone()
    };
    let best = |call: &mut dyn FnMut() -> Trajectory| {
        let micros = (0..400).map(|_| {
            let start = Instant::now();
            std::hint::black_box(call());
            start.elapsed().as_secs_f64() * 1e6
        });
        micros.fold(f64::INFINITY, f64::min)
    };
    let anew = best(&mut || {
        make().map_or_else(Trajectory::default, |s| {
            solve_motion(&s, &scene.actuation, &[0.0])
        })
    });
    let from_guess = best(&mut || solve_motion(&system, &scene.actuation, &[0.0]));
    let from_pose = best(&mut || solve_motion(&system, &near, &[0.0]));
    Some([anew, from_guess, from_pose])
}

fn main() {
    let read =
        |source: &Source| -> Option<Scene> { load_scene(source, &Overrides::default()).ok() };
    println!(
        "µs per pose: best / median. Lengths in the scene's unit; bounds of angles times the mechanism's size."
    );
    println!(
        "| mechanism | unknowns | poses | Newton | + rank, branch | + certificate | solve | iterations | closure, Newton | closure, certified | worst bound |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let mut cases: Vec<(String, Option<Source>, usize, usize)> = Vec::new();
    for (name, text, count) in COMPARED {
        let source = Source {
            name: name.into(),
            text: text.into(),
        };
        cases.push((name.to_owned(), Some(source), count, REPETITIONS));
    }
    for (name, count) in [("slider-crank", 360), ("seven-r", 360), ("gearshift", 300)] {
        cases.push((
            name.to_owned(),
            builtin::find_builtin(name),
            count,
            REPETITIONS,
        ));
    }
    for count in [1, 10, 100] {
        let repetitions = REPETITIONS.min(310 / count).max(5);
        cases.push((
            format!("{count} four-bars"),
            Some(four_bars(count)),
            100,
            repetitions,
        ));
    }
    // Words on the command line choose mechanisms by parts of their names.
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    cases.retain(|case| wanted.is_empty() || wanted.iter().any(|w| case.0.contains(w.as_str())));
    for (name, source, count, repetitions) in cases {
        let scene = source.as_ref().and_then(read);
        let line = scene.and_then(|s| measure(&name, &s, count, repetitions));
        if line.is_none() {
            println!("| {name} | could not be read or solved |");
        }
    }
    if wanted.is_empty() {
        println!("\nµs for one pose by itself, certified: best of 400.");
        println!(
            "| mechanism | system made anew | one system, start values | one system, from the pose |"
        );
        println!("|---|---|---|---|");
        for name in ["slider-crank", "seven-r", "gearshift"] {
            if let Some([anew, from_guess, from_pose]) = single_poses(name) {
                println!("| {name} | {anew:.1} | {from_guess:.1} | {from_pose:.1} |");
            }
        }
    }
}
