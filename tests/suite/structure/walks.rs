//! The three products of a chain against each other: the generic one in f64 and with derivatives, the one that solving
//! uses (four joints at a time), and the one that proofs use (two f64 a number). They share no code.

use crate::draws::Draws;
use glam::DVec3;
use mechanim::diag::Source;
use mechanim::kinematics::certificate::pose::chain::{ArgumentDouble, LoopAtPose};
use mechanim::kinematics::loops::residual::{BlockWorkspace, Want, residual_of};
use mechanim::kinematics::structure::proof_chain::LoopPlan;
use mechanim::kinematics::structure::system::System;
use mechanim::math::{left_jacobian_inverse, rotation_log};
use mechanim::model::chain::{Argument, ArgumentValue};
use mechanim::model::walk::WalkFrame;
use mechanim::numbers::hyper_dual::HyperDual;
use mechanim::scene::{Overrides, Scene, load_scene};

impl Draws {
    /// A loop of six joints in any order and direction, with constants and a driven motion between them.
    fn scene(&mut self) -> Scene {
        let mut chain = String::from("Rz(drive)");
        let mut guess = String::new();
        for k in 0..6 {
            let axis = ["x", "y", "z"][self.below(3)];
            let other = ["x", "y", "z"][self.below(3)];
            let (length, angle) = (90.0 * self.number(), 3.0 * self.number());
            // At most two translations keep the loop of full rank.
            let joint = match self.below(4) {
                0 if k < 2 => format!("T{axis}(20*q{k})"),
                1 => format!("inv(R{axis}(q{k}))"),
                2 => format!("R{axis}(0.5 - 2*q{k})"),
                _ => format!("R{axis}(q{k})"),
            };
            chain += &format!(" T{other}({length}) R{other}({angle}) {joint}");
            guess += &format!("q{k} = {}\n", self.number());
        }
        let text = format!(
            "units = {{ angle = \"rad\" }}\nduration = 1\n[inputs]\ndrive = \"0.3 + t\"\n[loops]\nL = \"{chain} Ty(7.5)\"\n\
             [guess]\n{guess}"
        );
        let name = "a random loop".into();
        load_scene(&Source { name, text }, &Overrides::default()).unwrap()
    }
}

#[test]
fn lanes_and_long_numbers_walk_as_the_generic_product_does() {
    let mut draws = Draws(3);
    let (mut looked_at, mut rotations) = (0, 0.0_f64);
    for _ in 0..60 {
        let scene = draws.scene();
        let mechanism = &scene.mechanism;
        let Ok(system) = System::new(mechanism.clone(), &scene.actuation) else {
            continue;
        };
        let n = mechanism.unknowns.len();
        let mut workspace = BlockWorkspace::default();
        for _ in 0..5 {
            let pose: Vec<f64> = (0..=n).map(|_| 1.5 * draws.number()).collect();
            let steps = &mechanism.loops[0].chain.steps;
            let end = mechanism.loops[0]
                .chain
                .pose(&mechanism.argument_values(&pose));

            let plan = LoopPlan::new(steps, |a| a);
            let arguments = mechanism.arguments.iter().map(|argument| match argument {
                Argument::Affine(affine) => ArgumentDouble::new(affine, &pose, &[]),
                Argument::Formula(_) => panic!("all arguments are affine here"),
            });
            let arguments: Vec<ArgumentDouble> = arguments.collect();
            let mut long = LoopAtPose::default();
            long.evaluate(&plan, &arguments, |_| 0.0, mechanism.size);
            let [x, y, z] = end.rotation.to_cols_array_2d();
            let skew = DVec3::new(y[2] - z[1], z[0] - x[2], x[1] - y[0]) * 0.5;
            let plain = residual_of(skew, end.translation, mechanism.size);
            for k in 0..6 {
                assert!(
                    (plain[k] - long.residual[k]).abs() < 1e-13,
                    "{plain:?} {long:?}"
                );
            }
            assert!((long.trace - (x[0] + y[1] + z[2])).abs() < 1e-13);

            let turn = rotation_log(&end.rotation);
            let logarithm = residual_of(turn, end.translation, mechanism.size);
            rotations = rotations.max(turn.length());
            let to_rate = left_jacobian_inverse(turn);
            for block in system.blocks() {
                workspace.evaluate(mechanism, block, &pose, Want::Jacobian);
                let [part] = &block.loops[..] else {
                    panic!("one loop")
                };
                let rows = part.components.len();
                for (row, k) in part.components.iter().enumerate() {
                    let off = workspace.residual[row] - logarithm[*k];
                    assert!(off.abs() < 1e-12, "{row}: {off:e}");
                }
                for (column, unknown) in block.unknowns.iter().enumerate() {
                    let scale = mechanism.scale_of(*unknown);
                    let moved = derivative(&scene, &pose, *unknown, scale);
                    let spin = moved.spin(&end.rotation.to_cols_array_2d());
                    let exact = residual_of(to_rate * spin, moved.origin, mechanism.size);
                    for (row, k) in part.components.iter().enumerate() {
                        let off = workspace.jacobian[column * rows + row] - exact[*k];
                        // Next to a half turn the map from spins to rates grows.
                        assert!(off.abs() < 1e-11 || turn.length() > 3.0, "{off:e}");
                        looked_at += 1;
                    }
                }
            }
        }
    }
    assert!(
        looked_at > 3000 && rotations > 2.5,
        "{looked_at} {rotations}"
    );
}

/// Derivatives of the loop's product by one unknown, carried along the generic walk.
struct Moved {
    axes: [[f64; 3]; 3],
    origin: DVec3,
}

fn derivative(scene: &Scene, pose: &[f64], unknown: usize, scale: f64) -> Moved {
    let mechanism = &scene.mechanism;
    let mut slots: Vec<HyperDual> = pose.iter().map(|q| HyperDual::constant(*q)).collect();
    slots[unknown].first = scale;
    let values = mechanism.arguments.iter();
    let values = values.map(|a| ArgumentValue::new(a.value(&slots, &mut Vec::new())));
    let values: Vec<ArgumentValue<HyperDual>> = values.collect();
    let end = WalkFrame::at_end_of(&mechanism.loops[0].chain.steps, &values).map(|c| c.first);
    Moved {
        axes: end.axes,
        origin: end.origin.into(),
    }
}

impl Moved {
    /// The spin w with R' = [w]× R.
    fn spin(&self, rotation: &[[f64; 3]; 3]) -> DVec3 {
        let entry =
            |i: usize, j: usize| -> f64 { (0..3).map(|k| self.axes[k][i] * rotation[k][j]).sum() };
        DVec3::new(
            0.5 * (entry(2, 1) - entry(1, 2)),
            0.5 * (entry(0, 2) - entry(2, 0)),
            0.5 * (entry(1, 0) - entry(0, 1)),
        )
    }
}
