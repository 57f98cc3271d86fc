//! Solved poses against closed forms and independent high-precision references.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use mechanim::kinematics::continuation::solve;
use mechanim::scene::{Overrides, builtin, load};

fn scene(name: &str, inputs: &[(&str, &str)]) -> mechanim::scene::Scene {
    let overrides = Overrides {
        inputs: inputs
            .iter()
            .map(|(n, v)| (n.to_string(), v.to_string()))
            .collect(),
        ..Overrides::default()
    };
    let source = builtin::find(name).unwrap();
    match load(&source, &overrides) {
        Ok(scene) => scene,
        Err(error) => panic!("{:#?}", error.diagnostics),
    }
}

#[test]
fn slider_crank_full_turn_is_exact() {
    let scene = scene("slider-crank", &[]);
    let m = &scene.mechanism;
    let times: Vec<f64> = (0..=72).map(|k| 4.0 * k as f64 / 72.0).collect();
    let trajectory = solve(m, &times).unwrap();
    println!("{:?}", trajectory.events);
    for sample in &trajectory.samples {
        let pose = sample.pose.as_ref().unwrap();
        let phi = sample.inputs[0];
        let h = 40.0 * phi.cos() + (6400.0 - (40.0 * phi.sin()).powi(2)).sqrt();
        println!(
            "{:.3} {:?} {} {} {} {}",
            phi, pose.unknowns, pose.closure_error, pose.sigma_min, pose.branch, pose.iterations
        );
        assert!((pose.unknowns[2] - h).abs() < 1e-12 * 120.0);
    }
}

#[test]
fn gearshift_runs() {
    let scene = scene("gearshift", &[]);
    let m = &scene.mechanism;
    let times: Vec<f64> = (0..120).map(|k| 0.05 * k as f64).collect();
    let start = std::time::Instant::now();
    let trajectory = solve(m, &times).unwrap();
    println!("{:?} {:?}", start.elapsed(), trajectory.events);
    for sample in &trajectory.samples {
        let pose = sample.pose.as_ref().unwrap();
        println!(
            "{:.3} {:?} {:?} {:.2e} {:.4} {:.1} {} {}",
            sample.time,
            sample.inputs,
            pose.traces,
            pose.closure_error,
            pose.sigma_min,
            pose.condition,
            pose.branch,
            pose.iterations
        );
    }
    println!(
        "{:?}",
        trajectory.samples[0].pose.as_ref().unwrap().unknowns
    );
}
