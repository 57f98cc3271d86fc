//! The position of a mechanism as a list of lengths, for comparing two poses.

use crate::kinematics::loops::forward;
use crate::math::sin_cos;
use crate::model::mechanism::{Kind, Mechanism};

/// Coordinates of all body frames and traced points in the scene's unit. A scene without bodies is compared by its
/// unknowns; an angle then counts as a point of a circle with the mechanism's size as radius, so that a full turn is none.
pub fn marked_positions(mechanism: &Mechanism, coordinates: &[f64]) -> Vec<f64> {
    if mechanism.bodies.is_empty() {
        let unknowns = mechanism.unknowns.iter().zip(coordinates);
        return unknowns
            .flat_map(|(unknown, value)| match unknown.kind {
                Kind::Length | Kind::Number => vec![*value],
                Kind::Angle => {
                    let (sin, cos) = sin_cos(*value);
                    vec![cos * mechanism.size, sin * mechanism.size]
                }
            })
            .collect();
    }
    let poses = forward::body_poses(mechanism, coordinates);
    let traces = forward::trace_points(mechanism, &poses);
    let origins = poses.iter().map(|pose| pose.translation);
    origins.chain(traces).flat_map(|p| p.to_array()).collect()
}

/// Largest difference of two lists of positions; infinite if any entry is not a number.
pub fn largest_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest: f64, (a, b)| {
        let difference = (a - b).abs();
        if difference.is_nan() {
            f64::INFINITY
        } else {
            largest.max(difference)
        }
    })
}
