//! Drives that turn so far from sample to sample that curves through the samples show something else.

use crate::kinematics::results::trajectory::Trajectory;
use crate::model::mechanism::{Kind, Mechanism};
use crate::numbers::decimal::shortened;
use std::f64::consts::TAU;

/// A circle through fewer samples a turn is not one to the eye.
const FEWEST_OF_A_TURN: f64 = 12.0;

/// Samples of a turn through which curves look smooth.
const SMOOTH: f64 = 72.0;

/// Which input turns farthest from one sample to the next, and how many samples would be enough; `None` if these are.
pub(super) fn coarse_note(mechanism: &Mechanism, trajectory: &Trajectory) -> Option<String> {
    let samples = &trajectory.samples;
    let step_of = |input: usize| {
        let steps = samples.windows(2).filter_map(|pair| {
            let value = |k: usize| pair[k].inputs.get(input).copied();
            Some((value(1)? - value(0)?).abs())
        });
        steps.fold(0.0, f64::max)
    };
    let inputs = mechanism.inputs.iter().enumerate();
    let angles = inputs.filter(|(_, input)| input.kind == Kind::Angle);
    let steps = angles.map(|(k, input)| (step_of(k), input));
    let (step, input) = steps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    if !(step.is_finite() && step * FEWEST_OF_A_TURN > TAU) {
        return None;
    }
    let shown = step * mechanism.file_units(Kind::Angle);
    let enough = (samples.len() as f64 * step / TAU * SMOOTH).ceil();
    Some(format!(
        "{} turns by up to {} {} between two samples: what is between them is not drawn; --samples {enough} shows it",
        input.name,
        shortened(shown, 4),
        mechanism.unit_name(Kind::Angle)
    ))
}
