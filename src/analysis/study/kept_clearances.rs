//! Whether a found mechanism keeps the clearances that its scene asks for; if not, the last candidate that does.

use super::family::FamilyError;
use super::loaded::LoadedStudy;
use super::optimum::Improvement;
use super::track_poses::Evaluator;
use crate::analysis::optimise::Minimum;
use crate::clearance::check::{Closely, check_clearance};
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::motion::sampling::{frame_times, knot_times};
use crate::kinematics::structure::system::System;
use std::sync::Arc;

/// Nearness of the bound where the instants between the samples count only roughly.
const COARSE: f64 = 1.0;

/// Halvings of the way from the last candidate that keeps the clearances to the next.
const HALVINGS: usize = 6;

/// Two bodies, how near they come, and how near they may.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestPair {
    /// Names of the bodies.
    pub bodies: [String; 2],
    /// Least distance over the drive, in the scene's length unit.
    pub distance: f64,
    /// Least distance allowed.
    pub minimum: f64,
}

/// What the bodies do over the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearances {
    /// All pairs keep their minimum.
    pub kept: bool,
    /// The worst pair.
    pub worst: NearestPair,
    /// The candidate that was taken in place of the optimum, which comes too near: its iteration.
    pub instead: Option<usize>,
}

/// Judges the values; `None` if the scene has no section `[clearance]`, or no pair is judged.
fn judge_clearances(
    study: &LoadedStudy,
    values: &[f64],
) -> Result<Option<Clearances>, FamilyError> {
    // The scene is read anew, since bodies have the shapes of these values.
    let scene = study.scene_at(values)?;
    let Some(rules) = &scene.clearance else {
        return Ok(None);
    };
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    let system = System::new(Arc::clone(mechanism), actuation)?;
    let times = frame_times(mechanism, actuation, scene.view.fps);
    // At the frames and the keys of the drive; the bounds cover what lies between.
    let trajectory = solve_motion(&system, actuation, &knot_times(actuation, &times));
    let report = check_clearance(
        &system,
        actuation,
        rules,
        &trajectory,
        Closely::to(COARSE),
        &|_, _| {},
    );
    Ok(report.worst().map(|pair| {
        let name = |body: usize| mechanism.bodies[body].name.clone();
        Clearances {
            kept: report.is_kept(),
            worst: NearestPair {
                bodies: pair.pair.map(name),
                distance: pair.least.distance,
                minimum: pair.minimum,
            },
            instead: None,
        }
    }))
}

/// Judges a minimum. Where it comes too near, the last point found on the way that does not takes its place; if there is
/// none it stays, as one that does not keep them.
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
    // Halving: as a rule clearances are lost once on the way.
    let (mut low, mut high) = (0, improvements.len());
    let mut best = None;
    while low < high {
        let middle = (low + high) / 2;
        match judge_clearances(study, &improvements[middle].values)? {
            Some(clearances) if clearances.kept => {
                best = Some((middle, clearances));
                low = middle + 1;
            }
            _ => high = middle,
        }
    }
    let Some((index, mut clearances)) = best else {
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

/// How far one can go from a candidate that keeps the clearances towards the next, which does not: the values there,
/// their objective, and what the bodies do. `None` if that is no gain.
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
        // Bisection: the bodies are judged in the middle of what is open.
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
    let measured = measured.and_then(|stand| evaluator.measure(&stand));
    let index = family.study.objective;
    Ok(measured.ok().zip(index).map(|(found, k)| found.measures[k]))
}
