//! Checks whether an optimised mechanism keeps the clearances of its scene; if not, finds the last candidate that does.

use super::family_error::FamilyError;
use super::loaded::LoadedStudy;
use super::optimum::Improvement;
use super::track_poses::Evaluator;
use crate::analysis::optimise::Minimum;
use crate::clearance::check::{ClearanceEffort, check_clearance};
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::motion::sampling::{frame_times, knot_times};
use crate::kinematics::structure::system::System;
use std::sync::Arc;

/// Accuracy of the bound if the times between the samples matter only roughly.
const COARSE: f64 = 1.0;

/// Bisection steps between the last candidate that keeps the clearances and the next.
const HALVINGS: usize = 6;

/// Two bodies, their distance, and their minimum.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestPair {
    /// Names of the bodies.
    pub bodies: [String; 2],
    /// At the worst moment of the drive, in the scene's length unit.
    pub distance: f64,
    /// Least distance allowed; none of bodies that must touch.
    pub minimum: Option<f64>,
}

/// The clearances over the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearances {
    /// All pairs keep their minimum.
    pub kept: bool,
    /// The worst pair.
    pub worst: NearestPair,
    /// The iteration of the candidate that replaced the optimum, which violates a minimum.
    pub instead: Option<usize>,
}

/// Judges the values; `None` if the scene has no section `[clearance]`, or no pair is judged.
fn judge_clearances(
    study: &LoadedStudy,
    values: &[f64],
) -> Result<Option<Clearances>, FamilyError> {
    // The scene is read again, since the shapes of the bodies depend on these values.
    let scene = study.scene_at(values)?;
    let Some(rules) = &scene.clearance else {
        return Ok(None);
    };
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    let system = System::new(Arc::clone(mechanism), actuation)?;
    let times = frame_times(mechanism, actuation, scene.view.fps);
    // At the frames and the keys of the drive; the bounds cover the times between them.
    let trajectory = solve_motion(
        &system,
        actuation,
        &knot_times(system.mechanism(), actuation, &times),
    );
    let report = check_clearance(
        &system,
        actuation,
        rules,
        &trajectory,
        ClearanceEffort::to(COARSE),
        &|_, _| {},
    );
    Ok(report.worst().map(|pair| {
        let name = |body: usize| mechanism.bodies[body].name.clone();
        Clearances {
            kept: report.is_kept(),
            worst: NearestPair {
                bodies: pair.pair.map(name),
                distance: pair.worst_moment().distance,
                minimum: pair.touching.is_none().then_some(pair.minimum),
            },
            instead: None,
        }
    }))
}

/// The last points of a search, which are judged one by one.
const AT_THE_END: usize = 12;

/// Judges an optimum. If it violates a minimum, it is replaced by an earlier point of the search that does not; if there
/// is none it stays and counts as a violation.
pub fn settle_clearances(
    study: &LoadedStudy,
    minimum: &mut Minimum,
    improvements: &[Improvement],
) -> Result<Option<Clearances>, FamilyError> {
    let Some(found) = judge_clearances(study, &minimum.x)? else {
        return Ok(None);
    };
    if found.kept {
        return Ok(Some(found));
    }
    let mut best = None;
    let (mut low, mut high) = (0, improvements.len().saturating_sub(AT_THE_END));
    for index in (high..improvements.len()).rev() {
        let clearances = judge_clearances(study, &improvements[index].values)?;
        if let Some(clearances) = clearances.filter(|found| found.kept) {
            best = Some((index, clearances));
            break;
        }
    }
    // Before these by bisection: usually clearances are lost once on the way.
    let mut before = None;
    while best.is_none() && low < high {
        let middle = (low + high) / 2;
        match judge_clearances(study, &improvements[middle].values)? {
            Some(clearances) if clearances.kept => {
                before = Some((middle, clearances));
                low = middle + 1;
            }
            _ => high = middle,
        }
    }
    let Some((index, mut clearances)) = best.or(before) else {
        return Ok(Some(found));
    };
    let taken = &improvements[index];
    clearances.instead = Some(taken.iteration);
    let end = improvements
        .get(index + 1)
        .map_or(&minimum.x, |i| &i.values);
    let further = search_further(study, taken, end)?;
    (minimum.x, minimum.value) = (taken.values.clone(), taken.objective);
    if let Some((values, value, nearer)) = further {
        (minimum.x, minimum.value) = (values, value);
        clearances.worst = nearer.worst;
    }
    Ok(Some(clearances))
}

/// The last point that keeps the clearances between a candidate that does and the next, which does not: its values, its
/// objective, and its clearances. `None` if it is no improvement.
fn search_further(
    study: &LoadedStudy,
    from: &Improvement,
    to: &[f64],
) -> Result<Option<(Vec<f64>, f64, Clearances)>, FamilyError> {
    let (mut low, mut high) = (0.0, 1.0);
    let mut best = None;
    for _ in 0..HALVINGS {
        let share = 0.5 * (low + high);
        let ends = from.values.iter().zip(to);
        let values: Vec<f64> = ends.map(|(a, b)| a + share * (b - a)).collect();
        // Bisection: the bodies are judged in the middle of the remaining interval.
        match judge_clearances(study, &values)? {
            Some(clearances) if clearances.kept => {
                best = Some((values, clearances));
                low = share;
            }
            _ => high = share,
        }
    }
    let Some((values, clearances)) = best else {
        return Ok(None);
    };
    let value = kept_objective(study, &values)?.filter(|v| *v < from.objective);
    Ok(value.map(|value| (values, value, clearances)))
}

/// The objective at other values; `None` where they cannot be reached.
fn kept_objective(study: &LoadedStudy, values: &[f64]) -> Result<Option<f64>, FamilyError> {
    let family = &study.family;
    let mut evaluator = Evaluator::new(family);
    let start = evaluator.nominal(family.nominal()?.poses);
    let measured = evaluator.approach(&start, values);
    let measured = measured.and_then(|track_poses| evaluator.measure_sought(&track_poses));
    let index = family.study.objective;
    Ok(measured.ok().zip(index).map(|(found, k)| found.measures[k]))
}
