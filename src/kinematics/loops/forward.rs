//! Poses of bodies, traced points and outputs from coordinates, and the closure error as a plain product.
//!
//! This closure error is an independent check of every pose: it shares only the elementary steps with the residual that
//! Newton's method reduces to zero.

use crate::math::{Pose, rotation_log};
use crate::model::chain::{ArgumentValue, ChainStep};
use crate::model::mechanism::{Closes, Loop, Mechanism};
use crate::numbers::rounding::largest_or_nan;
use glam::DVec3;

/// Rotation angle (radians) and distance (scene's unit) by which a loop's product differs from the identity; a loop
/// that closes in a point has no rotation.
pub fn loop_gap(item: &Loop, arguments: &[ArgumentValue]) -> (f64, f64) {
    let product = item.chain.pose(arguments);
    let angle = match item.closes {
        Closes::Frame => rotation_log(&product.rotation).length(),
        Closes::Point => 0.0,
    };
    (angle, product.translation.length())
}

/// The largest closure error over all loops and equations, relative to the loop's size; NaN if anything is not a
/// number.
pub fn closure_error(mechanism: &Mechanism, coordinates: &[f64]) -> f64 {
    gap_of_all(
        mechanism,
        coordinates,
        &loop_arguments(mechanism, coordinates),
    )
}

fn gap_of_all(mechanism: &Mechanism, coordinates: &[f64], arguments: &[ArgumentValue]) -> f64 {
    let loops = mechanism.loops.iter().flat_map(|item| {
        let (angle, distance) = loop_gap(item, arguments);
        [angle, distance / item.size]
    });
    let mut scratch = Vec::new();
    let equations = mechanism.equations.iter().map(|equation| {
        let value = equation.expression.value_with(coordinates, &mut scratch);
        (value * equation.weight).abs()
    });
    largest_or_nan(loops.chain(equations))
}

/// Values of the arguments of loops; the others stay zero.
fn loop_arguments(mechanism: &Mechanism, coordinates: &[f64]) -> Vec<ArgumentValue> {
    let (mut values, mut scratch) = (Vec::new(), Vec::new());
    values.resize(mechanism.arguments.len(), None);
    let steps = mechanism.loops.iter().flat_map(|item| &item.chain.steps);
    for joint in steps.filter_map(ChainStep::joint) {
        values[joint.argument].get_or_insert_with(|| {
            let argument = &mechanism.arguments[joint.argument];
            ArgumentValue::new(argument.value(coordinates, &mut scratch))
        });
    }
    values.into_iter().map(Option::unwrap_or_default).collect()
}

/// `world_from_body` of every body.
pub fn body_poses(mechanism: &Mechanism, coordinates: &[f64]) -> Vec<Pose> {
    poses_of(mechanism, &mechanism.argument_values(coordinates))
}

fn poses_of(mechanism: &Mechanism, arguments: &[ArgumentValue]) -> Vec<Pose> {
    let bodies = mechanism.bodies.iter();
    let poses = bodies.map(|body| body.world_from_body.pose(arguments));
    poses.collect()
}

/// World positions of the traced points.
pub fn trace_points(mechanism: &Mechanism, poses: &[Pose]) -> Vec<DVec3> {
    mechanism
        .traces
        .iter()
        .map(|trace| poses[trace.body].transform_point(trace.point))
        .collect()
}

/// The positions and outputs of a mechanism at one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// `world_from_body` of every body.
    pub bodies: Vec<Pose>,
    /// World positions of the traced points.
    pub traces: Vec<DVec3>,
    /// Values of the outputs, angles in radians; those of rates are not known yet.
    pub outputs: Vec<f64>,
    /// As [`closure_error`] has it.
    pub closure_error: f64,
}

impl Observation {
    /// At coordinates (unknowns, then inputs): every argument is evaluated once.
    pub fn new(mechanism: &Mechanism, coordinates: &[f64]) -> Self {
        let arguments = mechanism.argument_values(coordinates);
        let bodies = poses_of(mechanism, &arguments);
        let traces = trace_points(mechanism, &bodies);
        Self {
            outputs: output_values(mechanism, coordinates, &traces),
            closure_error: gap_of_all(mechanism, coordinates, &arguments),
            bodies,
            traces,
        }
    }
}

/// Values of the outputs except rates: each may use earlier ones.
fn output_values(mechanism: &Mechanism, coordinates: &[f64], traces: &[DVec3]) -> Vec<f64> {
    if mechanism.outputs.is_empty() {
        return Vec::new();
    }
    let known = coordinates.len() + 3 * traces.len();
    let mut slots = Vec::with_capacity(known + mechanism.outputs.len());
    slots.extend_from_slice(coordinates);
    slots.extend(traces.iter().flat_map(|p| p.to_array()));
    let mut values = Vec::new();
    for output in &mechanism.outputs {
        let value = output.value_with(mechanism, &slots, &mut values);
        slots.push(value);
    }
    slots.split_off(known)
}
