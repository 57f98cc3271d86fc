//! The reference poses with which routes are compared, solved as accurately as possible, and their accuracy.

use super::observer::{largest_distance, marked_positions};
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::results::certificate::{Certificate, Reason};
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::svd::RANK_TOLERANCE;
use crate::model::actuation::Actuation;

/// The true motion at some instants, as accurately as f64 can represent it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    /// Seconds.
    pub times: Vec<f64>,
    /// Unknowns, then inputs, at these times; `None` where the mechanism cannot be closed.
    pub poses: Vec<Option<Vec<f64>>>,
    /// Worst proved error of an unknown, in the scene's unit (angles times the size); `None` where any has no proof.
    pub bound: Option<f64>,
    /// Largest change of a coordinate by one more Newton step, in the scene's unit: the effect of rounding.
    pub moved: f64,
    /// The same at the last pose.
    pub moved_at_end: f64,
}

impl Reference {
    /// Solves `system` along `actuation` at `times`.
    pub fn new(system: &System, actuation: &Actuation, times: Vec<f64>) -> Self {
        let mechanism = system.mechanism();
        let trajectory = solve_motion(system, actuation, &times);
        let mut reference = Self {
            times,
            bound: Some(0.0),
            ..Self::default()
        };
        for sample in &trajectory.samples {
            let Some(pose) = &sample.pose else {
                reference.poses.push(None);
                continue;
            };
            reference.bound = match (reference.bound, pose.certificate) {
                (
                    Some(worst),
                    Certificate::Certified { error_bound, .. }
                    | Certificate::Consistent { error_bound, .. },
                ) => Some(worst.max(error_bound)),
                _ => None,
            };
            let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
            // At a singular pose a step is meaningless; the missing bound shows this.
            let singular = Certificate::Refused {
                reason: Reason::Singular,
            };
            let next = if pose.certificate == singular {
                coordinates.clone()
            } else {
                newton_step(system, &coordinates)
            };
            let here = marked_positions(mechanism, &coordinates);
            let moved = largest_distance(&here, &marked_positions(mechanism, &next));
            reference.moved = reference.moved.max(moved);
            reference.moved_at_end = moved;
            reference.poses.push(Some(coordinates));
        }
        reference
    }
}

/// The pose after one more step, block by block.
fn newton_step(system: &System, coordinates: &[f64]) -> Vec<f64> {
    let mechanism = system.mechanism();
    let mut coordinates = coordinates.to_vec();
    let (mut workspace, mut qr) = (BlockWorkspace::default(), PivotedQr::default());
    for block in system.blocks() {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        workspace.evaluate(mechanism, block, &coordinates, Want::Jacobian);
        qr.factor(&workspace.jacobian, rows, columns, RANK_TOLERANCE);
        let mut step = vec![0.0; columns];
        let mut right_side: Vec<f64> = workspace.residual.iter().map(|r| -r).collect();
        qr.solve(&mut right_side, &mut step);
        for (unknown, step) in block.unknowns.iter().zip(&step) {
            coordinates[*unknown] += mechanism.scale_of(*unknown) * step;
        }
    }
    coordinates
}
