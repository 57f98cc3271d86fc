//! Records Newton's method: the iterates from the start values, with residuals, corrections and the opened polygon of
//! every loop. Plain Newton on every block in order, without the safeguards of the solver.

use super::closure::is_closed;
use crate::kinematics::loops::forward::Observation;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::results::certificate::{Certificate, Reason};
use crate::kinematics::results::trajectory::{ClosedPose, Sample, Trajectory};
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::svd::RANK_TOLERANCE;
use crate::math::{Pose, rotation_log};
use crate::model::mechanism::{Closes, Mechanism};
use glam::DVec3;

/// Number of iterations after which Newton's method is considered divergent: from a usable start it needs fewer than
/// ten.
const MOST_ITERATIONS: usize = 50;

/// One iterate.
#[derive(Clone, Debug, PartialEq)]
pub struct Iterate {
    /// Number of the block that is being closed.
    pub block: usize,
    /// Iterations in this block so far.
    pub iteration: usize,
    /// Unknowns: radians, or the scene's length unit.
    pub unknowns: Vec<f64>,
    /// What is added to them next; zero outside the block.
    pub corrections: Vec<f64>,
    /// The closure error of every loop.
    pub loops: Vec<OpenLoop>,
    /// Values of the scalar equations.
    pub equations: Vec<f64>,
}

/// A loop at an iterate.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenLoop {
    /// From the start of its chain to the end: zero if it is closed.
    pub gap: DVec3,
    /// Rotation of the end relative to the start, radians; zero if the loop closes in a point.
    pub turn: f64,
    /// Vertices of the chain from its start on; the first is the origin, and so is the last of a closed loop.
    pub polygon: Vec<DVec3>,
}

/// The iterates as a sequence of open poses, one per second, for pictures: only the last can be proved.
pub fn iterate_film(mechanism: &Mechanism, inputs: &[f64], list: &[Iterate]) -> Trajectory {
    let frame = |(second, iterate): (usize, &Iterate)| {
        let coordinates = [iterate.unknowns.as_slice(), inputs].concat();
        // An open pose: every body where its own chain puts it.
        let seen = Observation::new(mechanism, &coordinates);
        // Rates, rank and condition belong to closed poses; an iterate has none.
        let pose = ClosedPose {
            unknowns: iterate.unknowns.clone(),
            outputs: seen.outputs,
            bodies: seen.bodies,
            traces: seen.traces,
            rates: vec![0.0; iterate.unknowns.len()],
            derivatives: Vec::new(),
            closure_error: seen.closure_error,
            sigma_min: f64::NAN,
            condition: f64::NAN,
            rank: 0,
            branch: String::new(),
            certificate: Certificate::Refused {
                reason: Reason::Open,
            },
            iterations: iterate.iteration as u32,
        };
        Sample {
            time: second as f64,
            inputs: inputs.to_vec(),
            pose: Some(pose),
        }
    };
    // Iterates of a divergence to infinity cannot be drawn.
    let finite = |i: &&Iterate| i.unknowns.iter().all(|v| v.is_finite());
    let shown = list.iter().filter(finite).enumerate();
    Trajectory {
        samples: shown.map(frame).collect(),
        ..Trajectory::default()
    }
}

/// The iterates from `start` (unknowns, then inputs), and whether they end at a closed pose. The last iterate of every
/// block is the one whose correction is below rounding.
pub fn record_iterates(system: &System, start: &[f64]) -> (Vec<Iterate>, bool) {
    let mechanism = system.mechanism();
    let structure = system.structure();
    let mut coordinates = start.to_vec();
    let mut list = Vec::new();
    let (mut workspace, mut qr) = (BlockWorkspace::default(), PivotedQr::default());
    for (block_index, block) in structure.blocks.iter().enumerate() {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let mut step = vec![0.0; columns];
        let mut closed = false;
        // Newton's method without any safeguard: what a lecture would do.
        for iteration in 0..MOST_ITERATIONS {
            workspace.evaluate(mechanism, block, &coordinates, Want::Jacobian);
            qr.factor(&workspace.jacobian, rows, columns, RANK_TOLERANCE);
            let mut right_side: Vec<f64> = workspace.residual.iter().map(|r| -r).collect();
            qr.solve(&mut right_side, &mut step);
            let mut corrections = vec![0.0; mechanism.unknowns.len()];
            for (unknown, step) in block.unknowns.iter().zip(&step) {
                corrections[*unknown] = mechanism.scale_of(*unknown) * step;
            }
            list.push(observed_iterate(
                mechanism,
                &coordinates,
                block_index,
                iteration,
                corrections.clone(),
            ));
            let size = step.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
            if !size.is_finite() || step.iter().any(|s| s.is_nan()) {
                return (list, false);
            }
            let is_small = size <= f64::EPSILON * 4.0;
            closed = is_closed(mechanism, block, &coordinates, &workspace);
            if closed && is_small {
                break;
            }
            let n = mechanism.unknowns.len();
            for (value, correction) in coordinates[..n].iter_mut().zip(&corrections) {
                *value += correction;
            }
        }
        if !closed {
            return (list, false);
        }
    }
    (list, true)
}

fn observed_iterate(
    mechanism: &Mechanism,
    coordinates: &[f64],
    block: usize,
    iteration: usize,
    corrections: Vec<f64>,
) -> Iterate {
    let arguments = mechanism.argument_values(coordinates);
    let loops = mechanism.loops.iter().map(|item| {
        let mut pose = Pose::IDENTITY;
        let mut polygon = vec![DVec3::ZERO];
        for step in &item.chain.steps {
            step.advance(&mut pose, &arguments);
            // Rotations leave the corner where it is.
            if polygon
                .last()
                .is_none_or(|corner| *corner != pose.translation)
            {
                polygon.push(pose.translation);
            }
        }
        let turn = match item.closes {
            Closes::Frame => rotation_log(&pose.rotation).length(),
            Closes::Point => 0.0,
        };
        OpenLoop {
            gap: pose.translation,
            turn,
            polygon,
        }
    });
    let equations = mechanism
        .equations
        .iter()
        .map(|e| e.expression.value(coordinates));
    Iterate {
        block,
        iteration,
        unknowns: coordinates[..mechanism.unknowns.len()].to_vec(),
        corrections,
        loops: loops.collect(),
        equations: equations.collect(),
    }
}
