//! Independent verification of a fit: the scene is read again with the values found, and the motion solver follows it
//! from the start of its drive through all rows of the table.

use super::asked::{Target, slot_of};
use super::fit::Fit;
use crate::analysis::study::FamilyError;
use crate::diag::Source;
use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::drive::{Drive, Ease};
use crate::scene::{Overrides, load_scene};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// What was found out.
#[derive(Clone, Debug, PartialEq)]
pub struct VerifiedRows {
    /// Deviation at each row, without weights: the root of the sum of squares over its columns.
    pub missed: Vec<Option<f64>>,
    /// Poses without a certificate.
    pub unproved: usize,
    /// Largest certified error of a coordinate.
    pub error_bound: f64,
    /// Determinant signs are the same at all rows.
    pub one_branch: bool,
    /// Free inputs ascend or descend with the rows.
    pub in_order: bool,
}

impl VerifiedRows {
    /// Every row is met on one motion, and proved.
    pub fn holds(&self) -> bool {
        self.unproved == 0 && self.one_branch && self.missed.iter().all(Option::is_some)
    }
}

/// Follows the scene with the values in `overrides` through the rows. `begins` states that these lead to the start of
/// the drive; otherwise the motion begins with the first row.
///
/// # Errors
/// A scene that cannot be read with these values.
pub fn verify_target(
    (source, overrides): (&Source, &Overrides),
    target: &Target,
    fit: &Fit,
    begins: bool,
) -> Result<VerifiedRows, FamilyError> {
    let scene = load_scene(source, overrides).map_err(Box::new)?;
    let mechanism = &scene.mechanism;
    let own = mechanism.inputs.len();
    let unknowns = mechanism.unknowns.len();
    // One key per row, after the start of the drive.
    let rows = fit
        .poses
        .iter()
        .map(|pose| pose[unknowns..unknowns + own].to_vec());
    let start = begins.then(|| scene.actuation.inputs_at(0.0));
    let keys: Vec<Vec<f64>> = start.into_iter().chain(rows).collect();
    let times: Vec<f64> = (0..keys.len()).map(|k| k as f64).collect();
    let drive = |input: usize| Drive::Keys {
        times: times.clone(),
        values: keys.iter().map(|key| key[input]).collect(),
        ease: Ease::Linear,
    };
    let actuation = Actuation {
        drives: (0..own).map(drive).collect(),
        duration: times.last().copied().unwrap_or(0.0).max(1.0),
        ..scene.actuation.clone()
    };
    let system = System::new(Arc::clone(mechanism), &actuation)?;
    let trajectory = solve_motion(&system, &actuation, &times);
    let skipped = usize::from(begins);
    let mut found = VerifiedRows {
        missed: Vec::new(),
        unproved: 0,
        error_bound: 0.0,
        one_branch: true,
        in_order: in_order(target, fit),
    };
    let mut branch: Option<&str> = None;
    for (sample, row) in trajectory.samples.iter().skip(skipped).zip(&target.rows) {
        let Some(pose) = &sample.pose else {
            found.missed.push(None);
            continue;
        };
        match pose.certificate.bounds() {
            Some([error_bound, _]) => found.error_bound = found.error_bound.max(error_bound),
            None => found.unproved += 1,
        }
        found.one_branch &= *branch.get_or_insert(&pose.branch) == pose.branch;
        let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
        let slots = observed_slots(mechanism, &coordinates);
        let pairs = target.columns.iter().zip(&row.values);
        let sum: Option<f64> = pairs
            .map(|(column, value)| {
                let off = slots[slot_of(mechanism, &column.name)?] - value;
                let off = match column.is_angle {
                    true => libm::remainder(off, 2.0 * PI),
                    false => off,
                };
                Some((column.reach * off).powi(2))
            })
            .sum();
        found.missed.push(sum.map(f64::sqrt));
    }
    Ok(found)
}

/// Whether free inputs ascend or descend with the rows; inputs of the table follow the table.
fn in_order(target: &Target, fit: &Fit) -> bool {
    let free = target.free_input.as_ref();
    free.is_none_or(|free| {
        let phases = &fit.x[fit.x.len() - target.rows.len()..];
        is_one_way(phases, free.is_cyclic)
    })
}

/// A curve that ends where it began has gone a whole turn, to within this angle: fits leave less.
const WHOLE_TURN: f64 = 1e-6;

/// Whether numbers ascend or descend; angles that go round, by no more than a turn in all.
fn is_one_way(phases: &[f64], is_cyclic: bool) -> bool {
    let steps = || phases.windows(2).map(|pair| pair[1] - pair[0]);
    if is_cyclic {
        let way = |sign: f64| {
            steps()
                .map(|step| (sign * step).rem_euclid(TAU))
                .sum::<f64>()
        };
        return way(1.0).min(way(-1.0)) < TAU + WHOLE_TURN;
    }
    steps().all(|step| step >= 0.0) || steps().all(|step| step <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_pass_the_end_of_a_turn_are_in_order() {
        let rows: [(&[f64], [bool; 2]); 8] = [
            (&[5.0, 5.6, 6.2, 0.517, 1.117], [true, false]),
            (&[1.117, 0.517, 6.2, 5.6, 5.0], [true, false]),
            (&[0.1, 0.2, 4.0], [true, true]),
            (&[0.1, 2.0, 4.0, 0.1], [true, false]),
            (&[0.1, 4.0, 2.0, 0.1 + 1e-9], [true, false]),
            (&[0.1, 2.0, 4.0, 0.2], [false, false]),
            (&[0.1, 4.0, 2.0, 3.0], [false, false]),
            (&[5.0, 0.5, 4.9, 0.4, 4.8], [false, false]),
        ];
        for (phases, known) in rows {
            assert_eq!(
                [true, false].map(|cyclic| is_one_way(phases, cyclic)),
                known,
                "{phases:?}"
            );
        }
    }
}
