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
use std::f64::consts::PI;
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

    /// The farthest row.
    pub fn worst(&self) -> f64 {
        let missed = self.missed.iter().map(|m| m.unwrap_or(f64::INFINITY));
        missed.fold(0.0, f64::max)
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
    if target.free_input.is_none() {
        return true;
    }
    let phases = &fit.x[fit.x.len() - target.rows.len()..];
    let mut steps = phases.windows(2).map(|pair| pair[1] - pair[0]);
    steps.clone().all(|step| step >= 0.0) || steps.all(|step| step <= 0.0)
}
