//! Matrices on the board: entries with symbols are those of the numeric product.

use mechanim::kinematics::motion::continuation::solve_motion;
use mechanim::kinematics::structure::system::System;
use mechanim::report::matrices::product::symbolic_product;
use mechanim::scene::{Overrides, builtin, load_scene};
use std::sync::Arc;

/// Every chain and loop of every scene whose product is short enough to be written out.
#[test]
fn entries_with_symbols_have_the_values_of_the_product() {
    let overrides = Overrides {
        notation: true,
        ..Overrides::default()
    };
    let mut compared = 0;
    for item in builtin::ALL {
        let scene = load_scene(&builtin::find_builtin(item.name).unwrap(), &overrides).unwrap();
        let (mechanism, notation) = (&scene.mechanism, scene.notation.as_ref().unwrap());
        let system = System::new(Arc::clone(mechanism), &scene.actuation).unwrap();
        let at = 0.37 * scene.actuation.duration;
        let motion = solve_motion(&system, &scene.actuation, &[0.0, 0.5 * at, at]);
        let sample = motion.samples.iter().rfind(|s| s.pose.is_some()).unwrap();
        let coordinates = [
            sample.pose.as_ref().unwrap().unknowns.as_slice(),
            &sample.inputs,
        ]
        .concat();
        let (values, terms) = (
            notation.values(&coordinates),
            notation.term_values(&coordinates),
        );
        assert_eq!(notation.loops.len(), mechanism.loops.len());
        for chain in notation.chains.iter().chain(&notation.loops) {
            let numeric = chain.pose(&values);
            let Some(matrix) = symbolic_product(chain) else {
                continue;
            };
            compared += 1;
            for (row, entries) in matrix.entries.iter().enumerate() {
                for (column, entry) in entries.iter().enumerate() {
                    let wanted = match column {
                        3 => numeric.translation[row],
                        column => numeric.rotation.col(column)[row],
                    };
                    let off = (entry.value(&terms) - wanted).abs();
                    assert!(
                        off < 1e-11 * mechanism.size.max(1.0),
                        "{} {}: {off:e}",
                        item.name,
                        chain.name
                    );
                }
            }
        }
        for (written, item) in notation.loops.iter().zip(&mechanism.loops) {
            assert_eq!(written.name, item.name);
            if item.closes == mechanim::model::mechanism::Closes::Frame {
                let gap = written.pose(&values);
                assert!(
                    gap.translation.length() < 1e-9 * mechanism.size,
                    "{}",
                    item.name
                );
            }
        }
    }
    assert!(compared > 60, "{compared}");
}

/// What the lecture writes for its first example.
#[test]
fn planar_chains_are_as_short_as_on_a_board() {
    let workspace = crate::program::Workspace::new();
    let run = workspace.run(&["show", "slider-crank", "--chain", "A"]);
    let text = run.exits(0).text();
    for part in [
        "A = T12 T23 T34 T41",
        "= Rz(phi) Tx(r) Rz(alpha) Tx(L) Rz(beta) Tx(-h)",
        "cos(phi + alpha + beta)",
        "r*cos(phi)",
        "[ 1   0   0   0 ]",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
}
