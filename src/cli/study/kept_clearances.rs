//! Whether a found mechanism keeps the clearances that its scene asks for; if not, the last candidate that does.

use super::search_film::Improvement;
use crate::analysis::optimise::Minimum;
use crate::analysis::study::Evaluator;
use crate::clearance::check::{Closely, check_clearance};
use crate::cli::open::study::Opened;
use crate::cli::term::outcome::Failure;
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::motion::sampling::{frame_times, knot_times};
use crate::kinematics::structure::system::System;
use crate::report::cells::six_digits;
use crate::scene::{Overrides, load_scene};
use std::sync::Arc;

/// Nearness of the bound where the instants between the samples count only roughly.
const COARSE: f64 = 1.0;

/// Halvings of the way from the last candidate that keeps the clearances to the next.
const HALVINGS: usize = 6;

/// What the bodies do over the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearances {
    /// All pairs keep their minimum.
    pub kept: bool,
    /// The worst pair with its distance.
    pub worst: String,
    /// The candidate that was taken in place of the optimum, which comes too near: its iteration.
    pub instead: Option<usize>,
}

/// Judges the values; `None` if the scene asks for no clearances, or no pair is judged.
fn judge_clearances(opened: &Opened, values: &[f64]) -> Result<Option<Clearances>, Failure> {
    let overrides = Overrides {
        parameters: opened.parameters(values),
        ..opened.overrides.clone()
    };
    let scene = load_scene(&opened.source, &overrides).map_err(Box::new)?;
    let Some(rules) = &scene.clearance else {
        return Ok(None);
    };
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    let system = System::new(Arc::clone(mechanism), actuation)?;
    let times = frame_times(mechanism, actuation, scene.view.fps);
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
        let [a, b] = pair.pair.map(|k| mechanism.bodies[k].name.as_str());
        let (distance, unit) = (six_digits(pair.least.distance), &mechanism.length_unit);
        Clearances {
            kept: report.is_kept(),
            worst: format!("{a} / {b}, {distance} {unit} ({} asked for)", pair.minimum),
            instead: None,
        }
    }))
}

/// Judges a minimum. Where it comes too near, the last point found on the way that does not takes its place; if there is
/// none it stays, as one that does not keep them.
pub fn settle_clearances(
    opened: &Opened,
    minimum: &mut Minimum,
    improvements: &[Improvement],
) -> Result<Option<Clearances>, Failure> {
    let Some(found) = judge_clearances(opened, &minimum.x)? else {
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
        match judge_clearances(opened, &improvements[middle].values)? {
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
    let further = search_further(opened, taken, end)?;
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
    opened: &Opened,
    from: &Improvement,
    to: &[f64],
) -> Result<Option<(Vec<f64>, f64, Clearances)>, Failure> {
    let (mut low, mut high) = (0.0, 1.0);
    let mut best = None;
    for _ in 0..HALVINGS {
        let share = 0.5 * (low + high);
        let ends = from.values.iter().zip(to);
        let values: Vec<f64> = ends.map(|(a, b)| a + share * (b - a)).collect();
        match judge_clearances(opened, &values)? {
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
    let value = kept_objective(opened, &values)?.filter(|v| *v < from.objective);
    Ok(value.map(|value| (values, value, clearances)))
}

/// The objective at other values; `None` where they cannot be reached.
fn kept_objective(opened: &Opened, values: &[f64]) -> Result<Option<f64>, Failure> {
    let family = &opened.family;
    let mut evaluator = Evaluator::new(family);
    let start = evaluator.nominal(family.nominal()?.poses);
    let measured = evaluator.approach(&start, values);
    let measured = measured.and_then(|stand| evaluator.measure(&stand));
    let index = family.study.objective;
    Ok(measured.ok().zip(index).map(|(found, k)| found.measures[k]))
}

impl Clearances {
    /// As a line of a report.
    pub fn line(&self) -> String {
        let verdict = match (self.kept, self.instead) {
            (true, None) => "Clearances are kept".to_owned(),
            (true, Some(iteration)) => format!(
                "The optimum comes too near: the search is followed only to where clearances are kept, after iteration {iteration}"
            ),
            (false, _) => "Clearances are not kept".to_owned(),
        };
        format!("{verdict}; nearest: {}.\n", self.worst)
    }
}
