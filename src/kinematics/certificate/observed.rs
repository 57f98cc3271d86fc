//! How far what a row prints beside the unknowns, traced points and outputs, may be from that of the exact pose.
//!
//! The exact pose is within the error bound of the printed unknowns, so every unknown is an interval, and so is what is
//! computed from them: one walk of the chains and formulas, whose rounding is inside.

use crate::kinematics::loops::observed::observed;
use crate::kinematics::results::certificate::Certificate;
use crate::kinematics::results::trajectory::{ClosedPose, Sample};
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::printed::rounding;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;

/// Bounds of the printed x, y, z of every trace and of every output: lengths in the scene's unit, angles in radians. `None`
/// where nothing was proved of the angles, or a formula has no value, a kink or a jump in reach.
pub fn printed_bounds(mechanism: &Mechanism, sample: &Sample) -> Vec<Option<f64>> {
    let count = 3 * mechanism.traces.len() + mechanism.outputs.len();
    let Some((pose, error)) = sample.pose.as_ref().and_then(proved) else {
        return vec![None; count];
    };
    let coordinates = enclosed(mechanism, sample, pose, error);
    let enclosures = observed(mechanism, &coordinates);
    let traced = pose.traces.iter().flat_map(|p| p.to_array());
    let traced = traced.map(|value| (value, Kind::Length));
    let outputs = mechanism.outputs.iter().zip(&pose.outputs);
    let shown = traced.chain(outputs.map(|(output, value)| (*value, output.kind)));
    let bound = |((value, kind), exact): ((f64, Kind), &Interval)| {
        let apart = exact.distance(value) + rounding(value, mechanism.unit_of(kind));
        (value.is_finite() && apart.is_finite()).then_some(apart * GROW)
    };
    let enclosures = enclosures.iter().skip(mechanism.unknowns.len());
    shown.zip(enclosures).map(bound).collect()
}

/// A pose whose unknowns are proved one by one, and its error bound; of locked angles only their rotation is.
fn proved(pose: &ClosedPose) -> Option<(&ClosedPose, f64)> {
    match pose.certificate {
        Certificate::Certified { error_bound, .. }
        | Certificate::Consistent { error_bound, .. } => Some((pose, error_bound)),
        Certificate::Locked { .. } | Certificate::Refused { .. } => None,
    }
}

/// All coordinates that the exact pose may have. Inputs are the decimals that are printed, or the numbers of the sample.
fn enclosed(
    mechanism: &Mechanism,
    sample: &Sample,
    pose: &ClosedPose,
    error: f64,
) -> Vec<Interval> {
    let radius = |kind| match kind {
        Kind::Angle => error / mechanism.size * GROW,
        Kind::Length | Kind::Number => error,
    };
    let unknowns = mechanism.unknowns.iter().zip(&pose.unknowns);
    let mut all: Vec<Interval> = unknowns
        .map(|(u, value)| Interval::point(*value) + Interval::around_zero(radius(u.kind)))
        .collect();
    let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
    let rests = mechanism.printed_rests(&coordinates);
    let inputs = sample.inputs.iter().zip(rests);
    all.extend(inputs.map(|(v, rest)| Interval::point(*v).hull(Interval::sum_of(*v, rest))));
    all
}
