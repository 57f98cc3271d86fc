//! Rows for which the scene is read again: its bodies, drives and measures are those of the design.

use super::posing::{DesignStart, Proved};
use super::row::{Row, RowStatus};
use super::swept_scene::{Posed, RequestedValues, Sweep, motion_status};
use crate::clearance::check::{ClearanceEffort, ClearanceReport, PairReport};
use crate::kinematics::motion::sampling::frame_times;
use crate::kinematics::structure::system::System;
use crate::report::motion_check::MotionCheck;
use crate::report::verdict::{CheckRequirements, Status};
use crate::scene::{Overrides, Scene};
use std::sync::Arc;

/// The row of a design, given its values in the file's units and in internal units.
pub(super) fn row(sweep: &Sweep, design: &[f64], internal: &[f64]) -> Row {
    let refused = || sweep.empty_row(RowStatus::Refused);
    let Some(mut scene) = scene_with(sweep, design) else {
        return refused();
    };
    let Ok(system) = System::new(Arc::clone(&scene.mechanism), &scene.actuation) else {
        return refused();
    };
    let mut inputs = scene.actuation.inputs_at(0.0);
    inputs.extend_from_slice(internal);
    let start = match sweep.origin.start_at(&sweep.family, &inputs) {
        Ok(start) => start,
        Err(status) => return sweep.empty_row(status),
    };
    let Some(guess) = guess_of(sweep, &scene, &start) else {
        return refused();
    };
    scene.actuation.guess = guess;
    scene.actuation.named.clear();
    if sweep.asked == RequestedValues::Check {
        return checked_row(sweep, &scene, &system, start.status);
    }
    let mut measures = (*scene.measures).clone();
    if let Some(study) = &scene.study {
        study.limit(&mut measures);
    }
    let posed = Posed {
        system: &system,
        actuation: &scene.actuation,
        measures: &measures,
    };
    sweep.answer(&posed, start.status)
}

fn scene_with(sweep: &Sweep, design: &[f64]) -> Option<Scene> {
    let mut parameters = sweep.overrides.parameters.clone();
    for (axis, value) in sweep.design.axes.iter().zip(design) {
        parameters.retain(|(name, _)| *name != axis.name);
        parameters.push((axis.name.clone(), format!("{value:?}")));
    }
    let overrides = Overrides {
        parameters,
        outside_ranges: true,
        ..sweep.overrides.clone()
    };
    sweep.text.resolved(&overrides).ok()
}

/// The first pose by the names of the unknowns; `None` if the scene has others.
fn guess_of(sweep: &Sweep, scene: &Scene, start: &DesignStart) -> Option<Vec<f64>> {
    let known = &sweep.family.mechanism().unknowns;
    let value = |name: &str| {
        let place = known.iter().position(|other| other.name == name)?;
        start.unknowns.get(place).copied()
    };
    let unknowns = scene.mechanism.unknowns.iter();
    unknowns.map(|unknown| value(&unknown.name)).collect()
}

/// Everything that `mechanim check` tests in the scene, at its frames and between them.
fn checked_row(sweep: &Sweep, scene: &Scene, system: &System, start: RowStatus) -> Row {
    let times = frame_times(&scene.mechanism, &scene.actuation, scene.view.fps);
    let check = MotionCheck {
        scene,
        system,
        times: &times,
        asked: CheckRequirements {
            closure: CheckRequirements::CLOSURE,
            poses: true,
            motion: false,
            estimates: false,
            empty: false,
            band: None,
        },
        closely: ClearanceEffort::to(ClearanceEffort::TOLERANCE),
        is_swept: false,
        worst: 0,
    };
    // A design that is too large to be checked has not failed the check.
    let Ok((motion, proved)) = check.solve(&|| false) else {
        return sweep.empty_row(RowStatus::Refused);
    };
    let status = motion_status(&motion, start);
    if motion.poses().next().is_none() {
        return sweep.empty_row(status);
    }
    let mut covered = check.cover(&motion, proved);
    let Ok(found) = check.clearances(&mut covered, &|_, _| {}) else {
        return sweep.empty_row(RowStatus::Refused);
    };
    let answer = check.answer(&motion, &mut covered, found.as_ref(), 0.0);
    let is_passed = matches!(answer.verdict.result(), Status::Passed | Status::Skipped);
    let mut proved = Proved::default();
    proved.add(system.mechanism(), motion.poses());
    let [margin, bound] = clearance_margins(found.as_ref());
    Row {
        status,
        is_feasible: is_passed && status == RowStatus::Ok,
        values: vec![f64::from(u8::from(is_passed)), margin, bound],
        closure_error: proved.closure_error,
        error_bound: proved.error_bound,
        unproved: proved.unproved,
    }
}

/// Margin of the nearest pair above its minimum: the value found, and the proved lower bound. NaN without pairs, or
/// without a proof.
fn clearance_margins(found: Option<&ClearanceReport>) -> [f64; 2] {
    let pairs = found.map_or(&[][..], |found| &found.judged);
    if pairs.is_empty() {
        return [f64::NAN; 2];
    }
    let least = |value: &dyn Fn(&PairReport) -> f64| {
        let values = pairs.iter().map(value);
        values.fold(f64::INFINITY, |least, v| match v < least || v.is_nan() {
            true => v,
            false => least,
        })
    };
    let bound = |p: &PairReport| p.proved_margin().unwrap_or(f64::NAN);
    [least(&PairReport::margin), least(&bound)]
}
