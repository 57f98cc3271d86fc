//! The eight-link mechanism against its reference positions, over a hundred turns, and its assemblies.

use crate::driven::{Driven, Model, solve, solve_unproved};
use mechanim::kinematics::loops::forward::{body_poses, trace_points};

use mechanim::kinematics::assemblies::{DEFAULT_STARTS, find_modes};
use mechanim::model::drive::{Drive, Ease};

use crate::reference::Table;
use mechanim::model::mechanism::Mechanism;
use mechanim::scene::{Overrides, builtin, load_scene};
use std::f64::consts::TAU;

fn dyads() -> Model {
    let source = builtin::find_builtin("dyads").unwrap();
    Model::from(load_scene(&source, &Overrides::default()).unwrap())
}

/// Index of the trace of point `k`.
fn point(mechanism: &Mechanism, k: usize) -> usize {
    let name = format!("p{k}");
    mechanism
        .traces
        .iter()
        .position(|t| t.name == name)
        .unwrap()
}

#[test]
fn positions_are_those_of_the_reference() {
    let mechanism = dyads();
    let table = Table::read("interval_mech10_path");
    let degrees = table.column("phi_deg");
    let times: Vec<f64> = degrees.iter().map(|d| d / 90.0).collect();
    let trajectory = solve(&mechanism, &times).unwrap();
    assert_eq!(trajectory.missing(), 0);
    let mut compared = 0;
    for (row, pose) in trajectory.poses().enumerate() {
        for k in 0..9 {
            let p = pose.traces[point(&mechanism, k)];
            for (axis, value) in [("x", p.x), ("y", p.y)] {
                let expected = table.column(&format!("{axis}{k}"))[row];
                assert!(
                    (value - expected).abs() < 1e-9,
                    "{axis}{k} at {}",
                    degrees[row]
                );
                compared += 1;
            }
            assert_eq!(p.z, 0.0);
        }
    }
    assert!(compared >= 37 * 18, "{compared}");
}

#[test]
fn hundred_turns_end_where_they_began() {
    let mut mechanism = dyads();
    mechanism.actuation.drives = vec![Drive::Keys {
        times: vec![0.0, 100.0],
        values: vec![0.0, 100.0 * TAU],
        ease: Ease::Linear,
    }];
    mechanism.actuation.duration = 100.0;
    let times: Vec<f64> = (0..=36_000).map(|k| f64::from(k) / 360.0).collect();
    let trajectory = solve_unproved(&mechanism, &times).unwrap();
    assert_eq!((trajectory.missing(), trajectory.events.len()), (0, 0));
    let first = trajectory.samples[0].pose.as_ref().unwrap();
    for turn in 1..=100 {
        let pose = trajectory.samples[360 * turn].pose.as_ref().unwrap();
        for (a, b) in first.traces.iter().zip(&pose.traces) {
            let off = a.distance(*b);
            assert!(off < 1e-11, "turn {turn}: {off:e}");
        }
    }
}

/// The assemblies whose triangles are not turned over, as a set of positions.
#[test]
fn four_assemblies_are_found_at_the_start() {
    let mechanism = dyads();
    let system = mechanism.system().unwrap();
    let modes = find_modes(
        &system,
        &mechanism.actuation.start_at(0.0),
        &[],
        DEFAULT_STARTS,
        &|| false,
    );
    let table = Table::read("hard_mech10_modes");
    let points = [0, 1, 2, 5, 6, 7, 8];
    assert_eq!((modes.list.len(), table.len()), (4, 4));
    for row in 0..table.len() {
        let agrees = modes.list.iter().any(|mode| {
            let bodies = body_poses(&mechanism, &mode.coordinates);
            let traces = trace_points(&mechanism, &bodies);
            points.iter().all(|k| {
                let p = traces[point(&mechanism, *k)];
                let expected = |axis: &str| table.column(&format!("{axis}{k}"))[row];
                (p.x - expected("x")).hypot(p.y - expected("y")) < 1e-9
            })
        });
        assert!(agrees, "row {row} was not found");
    }
}
