//! Poses of bodies, traced points and outputs from coordinates, and the closure as a plain product.
//!
//! The closure here is the proof beside every pose: it shares no code with the residual that Newton drives to
//! zero but the elementary steps themselves.

use crate::math::{Pose, rotation_log};
use crate::model::chain::{ArgumentValue, ChainStep};
use crate::model::mechanism::{Closes, Loop, Mechanism};
use glam::DVec3;

/// Rotation angle (radians) and distance (scene's unit) by which a loop's product differs from the identity; a loop
/// that closes in a point may turn.
pub fn loop_gap(item: &Loop, arguments: &[ArgumentValue]) -> (f64, f64) {
    let product = item.chain.pose(arguments);
    let angle = match item.closes {
        Closes::Frame => rotation_log(&product.rotation).length(),
        Closes::Point => 0.0,
    };
    (angle, product.translation.length())
}

/// The largest gap over all loops and equations, relative to the loop's size; NaN if anything is not a number.
pub fn closure_error(mechanism: &Mechanism, coordinates: &[f64]) -> f64 {
    let arguments = loop_arguments(mechanism, coordinates);
    let mut largest = 0.0_f64;
    let mut note = |value: f64| {
        // NaN stays the largest once it is met.
        if value.is_nan() || value > largest {
            largest = value;
        }
    };
    for item in &mechanism.loops {
        let (angle, distance) = loop_gap(item, &arguments);
        note(angle);
        note(distance / item.size);
    }
    for (index, equation) in mechanism.equations.iter().enumerate() {
        let scale = mechanism.weight_of(index);
        note((equation.expression.value(coordinates) * scale).abs());
    }
    largest
}

/// Values of the arguments that stand in loops; the others stay zero.
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
    let arguments = mechanism.argument_values(coordinates);
    mechanism
        .bodies
        .iter()
        .map(|body| body.world_from_body.pose(&arguments))
        .collect()
}

/// World positions of the traced points.
pub fn trace_points(mechanism: &Mechanism, poses: &[Pose]) -> Vec<DVec3> {
    mechanism
        .traces
        .iter()
        .map(|trace| poses[trace.body].transform_point(trace.point))
        .collect()
}

/// Values of the outputs, angles in radians.
pub fn trace_positions(mechanism: &Mechanism, coordinates: &[f64], traces: &[DVec3]) -> Vec<f64> {
    let mut slots = coordinates.to_vec();
    slots.extend(traces.iter().flat_map(|p| p.to_array()));
    let mut values = Vec::new();
    for output in &mechanism.outputs {
        let value = output.value_with(mechanism, &slots, &mut values);
        slots.push(value);
    }
    slots.split_off(coordinates.len() + 3 * traces.len())
}
