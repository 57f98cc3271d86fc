//! Bounds on the printed traced points and outputs relative to those of the exact pose.
//!
//! The exact pose is within the error bound of the unknowns: each of them is a number of 31 digits with a radius, and
//! so is everything computed from them by one traversal of the chains and formulas.

use crate::kinematics::loops::observed::observed_values;
use crate::kinematics::results::certificate::Certificate;
use crate::kinematics::results::trajectory::{ClosedPose, Sample};
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::printed::printing_unit;
use crate::numbers::constant::Constant;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::rounding::{DECIMAL, GROW};

/// Bounds of the printed x, y, z of every trace and of every output: lengths in the scene's unit, angles in radians.
/// `None` if nothing was proved about the angles, or a formula may be undefined.
pub fn printed_bounds(mechanism: &Mechanism, sample: &Sample) -> Vec<Option<f64>> {
    let count = 3 * mechanism.traces.len() + mechanism.outputs.len();
    let Some((pose, error)) = sample.pose.as_ref().and_then(proved_pose) else {
        return vec![None; count];
    };
    let coordinates = enclose_observed(mechanism, sample, pose, error);
    let enclosures = observed_values(mechanism, &coordinates);
    let traced = pose.traces.iter().flat_map(|p| p.to_array());
    let traced = traced.map(|value| (value, Kind::Length));
    let outputs = mechanism.outputs.iter().zip(&pose.outputs);
    let shown = traced.chain(outputs.map(|(output, value)| (*value, output.kind)));
    let bound = |((value, kind), exact): ((f64, Kind), &Constant)| {
        let off = (exact.value() - DoubleDouble::from(value)).hi.abs();
        let apart = off + exact.error() + printing_unit(value, mechanism.unit_of(kind));
        (value.is_finite() && apart.is_finite()).then_some(apart * GROW)
    };
    let enclosures = enclosures.iter().skip(mechanism.unknowns.len());
    shown.zip(enclosures).map(bound).collect()
}

/// A pose whose unknowns are proved individually, and its error bound; for locked angles only their rotation is proved.
fn proved_pose(pose: &ClosedPose) -> Option<(&ClosedPose, f64)> {
    match pose.certificate {
        Certificate::Certified { error_bound, .. }
        | Certificate::Consistent { error_bound, .. } => Some((pose, error_bound)),
        Certificate::Locked { .. } | Certificate::Refused { .. } => None,
    }
}

/// The coordinates of the exact pose; inputs are the printed decimals.
fn enclose_observed(
    mechanism: &Mechanism,
    sample: &Sample,
    pose: &ClosedPose,
    error: f64,
) -> Vec<Constant> {
    let radius = |kind| match kind {
        Kind::Angle => error / mechanism.size * GROW,
        Kind::Length | Kind::Number => error,
    };
    let unknowns = mechanism.unknowns.iter().zip(&pose.unknowns);
    let mut all: Vec<Constant> = unknowns
        .map(|(unknown, value)| Constant::within(*value, radius(unknown.kind)))
        .collect();
    let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
    let rests = mechanism.printed_rests(&coordinates);
    let inputs = coordinates.iter().zip(rests).skip(all.len());
    let decimals = inputs.map(|(value, rest)| {
        Constant::exact(*value) + Constant::within(rest, DECIMAL * rest.abs())
    });
    all.extend(decimals);
    all
}
