//! The library's derivatives through closed loops, against Taylor series along every parameter by another factorisation.

use mechanim::kinematics::measures::values_along;
use mechanim::kinematics::motion::continuation::solve_motion;
use mechanim::kinematics::results::columns::ValueColumn;
use mechanim::kinematics::structure::system::System;
use mechanim::scene::{Overrides, builtin, load_scene};
use mechanim::{Samples, Scene};
use std::sync::Arc;

/// Scenes with parameters to vary: planar and spatial, one block and several, loops of frames, of points, equations.
const CASES: [(&str, &[&str]); 10] = [
    ("slider-crank", &["r", "L"]),
    ("four-bar", &["crank", "coupler", "rocker", "ground", "ex"]),
    ("gearshift", &["L4", "L6s", "ZR1"]),
    ("seven-r", &["b1", "c1", "gamma1", "c2"]),
    ("torus-torus", &["r1", "gamma1", "q2", "c2"]),
    ("sphere-torus", &["b1", "c2", "gamma2", "s2"]),
    ("sphere-sphere", &["b1", "c2"]),
    ("rsur", &["b1", "c1", "c2", "s"]),
    ("rrsrr", &["b1", "gamma1", "r1", "c2"]),
    ("twin-steer", &["L2a", "L3", "YP"]),
];

/// Two correct ways round differ by their roundings, a few dozen times 2e-16.
const TOLERANCE: f64 = 1e-12;

#[test]
fn derivatives_are_the_first_coefficients_of_series() {
    let mut compared = 0;
    for (name, parameters) in CASES {
        let scene = Scene::builtin(name).unwrap();
        let overrides = Overrides {
            vary: parameters.iter().map(|p| (*p).to_owned()).collect(),
            ..Overrides::default()
        };
        let varied = load_scene(&builtin::find_builtin(name).unwrap(), &overrides).unwrap();
        let system = System::new(Arc::clone(&varied.mechanism), &varied.actuation).unwrap();
        let mechanism = system.mechanism();
        let own = mechanism.inputs.len() - parameters.len();
        let times = [0.0, 0.13, 0.48, 0.77].map(|share| share * varied.actuation.duration);
        let names: Vec<String> = scene.quantities().into_iter().map(|q| q.name).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let motion = scene.solve(Samples::At(times.to_vec())).unwrap();
        let slopes = motion.jacobian(&names, parameters).unwrap();
        let trajectory = solve_motion(&system, &varied.actuation, &times);
        let rows = slopes.chunks(names.len() * parameters.len());
        for (row, sample) in rows.zip(&trajectory.samples) {
            let pose = sample.pose.as_ref().unwrap();
            let place = [pose.unknowns.as_slice(), &sample.inputs].concat();
            for (k, parameter) in parameters.iter().enumerate() {
                let series = values_along(&system, &place, &[own + k], 1).unwrap();
                let per = mechanism.file_units(mechanism.inputs[own + k].kind);
                for (j, value) in names.iter().enumerate() {
                    let column = ValueColumn::find(mechanism, value).unwrap();
                    let unit = mechanism.file_units(column.kind(mechanism)) / per;
                    let expected = series[column.slot(mechanism)].coefficients()[1] * unit;
                    let found = row[j * parameters.len() + k];
                    let size = 1.0 + series[column.slot(mechanism)].coefficients()[0].abs() * unit;
                    assert!(
                        (found - expected).abs() <= TOLERANCE * size.max(expected.abs()),
                        "{name}, {value} by {parameter}: {found} and {expected}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 1000, "{compared} derivatives");
}
