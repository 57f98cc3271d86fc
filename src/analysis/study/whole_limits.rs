//! Checks whether values keep the limits of the measures over the whole motion, not only at the poses used by a search:
//! with the bounds of `check`.

use super::family_error::FamilyError;
use crate::clearance::check::ClearanceEffort;
use crate::clearance::closer::solve_closely;
use crate::clearance::measured::{BoundedMeasure, is_of_whole_motion, known};
use crate::kinematics::motion::sampling::{frame_times, knot_times};
use crate::kinematics::structure::system::System;
use crate::model::measure::Measure;
use crate::model::printed::InputReading;
use crate::scene::Scene;
use std::sync::Arc;

/// Violation of a constraint that counts as kept: searches accept a ten-millionth.
pub const KEPT: f64 = 1e-6;

/// A limited measure of the drive over the whole motion.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeLimit {
    /// Its index among the measures.
    pub measure: usize,
    /// As found, in internal units; `None` where it has no value.
    pub value: Option<f64>,
    /// Largest violation of its limits, as a fraction of them: zero or less if it keeps them.
    pub missed: f64,
    /// Whether it is proved that the violation is not larger.
    pub is_proved: bool,
}

impl WholeLimit {
    /// Whether it is proved that the limits are kept to the accuracy of searches.
    pub fn is_kept(&self) -> bool {
        self.is_proved && self.missed <= KEPT
    }
}

/// The limited measures of the drive.
///
/// # Errors
/// A mechanism that is not determined.
pub fn whole_limits(scene: &Scene) -> Result<Vec<WholeLimit>, FamilyError> {
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    let list = scene.measures.list.iter().enumerate();
    let limited = list.filter(|(_, measure)| {
        let is_limited = measure.min.is_some() || measure.max.is_some();
        // A measure along a track has poses of its own and is not affected.
        is_limited && measure.source.track().is_none() && is_of_whole_motion(mechanism, measure)
    });
    let limited: Vec<(usize, &Measure)> = limited.collect();
    if limited.is_empty() {
        return Ok(Vec::new());
    }
    let system = System::new(Arc::clone(mechanism), actuation)?;
    let times = frame_times(mechanism, actuation, scene.view.fps);
    let times = knot_times(system.mechanism(), actuation, &times);
    let reading = InputReading::Numbers;
    let (_, mut motion) = solve_closely(&system, actuation, &times, reading, &|| false);
    let judged = limited.into_iter().map(|(index, measure)| {
        let found = known(&mut motion, measure, ClearanceEffort::TOLERANCE);
        let (missed, is_proved) = found.map_or((f64::INFINITY, false), |k| missed(measure, &k));
        WholeLimit {
            measure: index,
            value: found.map(|found| found.value),
            missed,
            is_proved,
        }
    });
    Ok(judged.collect())
}

/// The largest violation of limits, and whether it is proved.
fn missed(measure: &Measure, found: &BoundedMeasure) -> (f64, bool) {
    if found.is_enclosed {
        return (f64::INFINITY, true);
    }
    let ends = [found.value, found.bound].map(|value| measure.violation(value));
    (ends[0].max(ends[1]), found.is_certified)
}
