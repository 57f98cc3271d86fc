//! Fits from many starts: the scene's own values, random ones, random ones near the best so far. Random numbers depend
//! only on seed, start and draw.

use super::asked::{FreeInput, Target};
use super::fit::{Fit, Fitting};
use super::phases::ordered_phases;
use crate::analysis::optimise::least_squares::minimise_squares;
use crate::analysis::optimise::{StopReason, VariableBounds};
use crate::analysis::random::Random;
use crate::analysis::study::{FamilyError, ParametricMechanism};
use crate::analysis::synthesis::plan::{From, SearchPlan};
use crate::analysis::synthesis::starts::StartOrigin;
use crate::jobs::share_work;
use crate::kinematics::motion::continuation::solve_unproved;
use crate::kinematics::results::trajectory::Sample;
use crate::kinematics::solve::turns::WholeTurns;
use crate::model::actuation::Actuation;
use crate::model::drive::{Drive, Ease};
use std::time::Instant;

/// Number of starts that are searched independently of each other.
const BATCH: usize = 8;

/// Most draws for one start.
const MOST_DRAWS: usize = 200;

/// A random start is the best of this many draws that can move.
const CANDIDATES: usize = 8;

/// Distance of a start from the best one, as a fraction of the ranges: drawn log-uniformly between these.
const NEAREST: f64 = 0.003;
const FARTHEST: f64 = 0.3;

/// The search ends at a fit that deviates by less than this fraction of the targets' spread at every row: that is
/// rounding.
const ENOUGH: f64 = 1e-13;

/// Poses that differ by less, in the sizes of their coordinates, are equal.
const SAME: f64 = 1e-6;

/// Number of poses along the drive from which free inputs are first chosen.
const LOOKS: usize = 144;

/// What is searched.
pub struct TargetSearch<'f> {
    /// The scene with its variables.
    pub family: &'f ParametricMechanism,
    /// What it is to do.
    pub target: &'f Target,
    /// How.
    pub plan: SearchPlan,
    /// Whether to go on.
    pub goes_on: &'f (dyn Fn() -> bool + Sync),
    /// A start is done: its number and what it found.
    pub done: &'f (dyn Fn(usize, &StartResult) + Sync),
}

/// The result of one start.
#[derive(Clone, Debug, PartialEq)]
pub struct StartResult {
    /// Where it was.
    pub origin: StartOrigin,
    /// Sum of the squares at the start; NaN if no draw can be followed through all rows.
    pub first: f64,
    /// The same at the end.
    pub sum: f64,
    /// Steps tried.
    pub steps: usize,
    /// Why it ended.
    pub ended: StopReason,
    /// Poses asked for.
    pub poses: usize,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetSynthesis {
    /// The best fit.
    pub fit: Fit,
    /// Sum of its weighted squares.
    pub sum: f64,
    /// Unknowns at the start of the drive with it, if it leads there.
    pub unknowns: Option<Vec<f64>>,
    /// All starts.
    pub starts: Vec<StartResult>,
    /// Whether it was cancelled, or ran out of time.
    pub stopped: bool,
    /// Wall time.
    pub seconds: f64,
}

/// Searches values of the study's variables that minimise the sum of squared deviations from the targets.
///
/// # Errors
/// Variables without a range; no start that moves through all rows.
pub fn fit_target(search: &TargetSearch) -> Result<TargetSynthesis, FamilyError> {
    // Random starts are drawn from a box, so every variable needs a range.
    let variables = &search.family.study.variables;
    if let Some(v) = variables.iter().find(|v| !(v.upper - v.lower).is_finite()) {
        let message = format!("synthesis searches a box: give `{}` a range", v.name);
        return Err(FamilyError::Lacks(message));
    }
    let begun = Instant::now();
    let limit = search.plan.limit.unwrap_or(f64::INFINITY);
    let goes_on = || begun.elapsed().as_secs_f64() < limit && (search.goes_on)();
    let enough = ENOUGH * search.target.spread();
    let mut starts: Vec<StartResult> = Vec::new();
    let mut best: Option<(f64, Fit)> = None;
    // Batches have a fixed size, so that the result does not depend on the number of threads.
    while starts.len() < search.plan.starts && (starts.is_empty() || goes_on()) {
        let first = starts.len();
        let count = (search.plan.starts - first).min(BATCH);
        let near = best
            .as_ref()
            .map(|(_, fit)| fit.x[..variables.len()].to_vec());
        let work = |_: &mut (), index: usize| {
            let found = search.start(first + index, near.as_deref(), &goes_on);
            (search.done)(first + index, &found.0);
            Some(found)
        };
        let batch = share_work(count, search.plan.threads, || (), work);
        for (_, (tried, fit)) in batch {
            if let Some(fit) = fit
                && best.as_ref().is_none_or(|(sum, _)| tried.sum < *sum)
            {
                best = Some((tried.sum, fit));
            }
            starts.push(tried);
        }
        // A fit with only rounding errors cannot be improved.
        let rows = search.target.rows.len() as f64;
        if best
            .as_ref()
            .is_some_and(|(sum, _)| sum.sqrt() <= enough * rows.sqrt())
        {
            break;
        }
    }
    let Some((sum, fit)) = best else {
        let message = "no start moves through all rows of the table".to_owned();
        return Err(FamilyError::Lacks(message));
    };
    Ok(TargetSynthesis {
        unknowns: search.at_start(&fit),
        fit,
        sum,
        stopped: !goes_on(),
        starts,
        seconds: begun.elapsed().as_secs_f64(),
    })
}

impl TargetSearch<'_> {
    /// Where start `index` begins; every other time near the best one, if there is one.
    fn origin(&self, index: usize, near: Option<&[f64]>) -> StartOrigin {
        match (self.plan.from, near) {
            (From::Everywhere | From::Scene, _) if index == 0 => StartOrigin::Scene,
            (From::Scene, Some(_)) => StartOrigin::Near(0),
            (_, Some(_)) if index % 2 == 1 => StartOrigin::Near(0),
            _ => StartOrigin::Random,
        }
    }

    fn draw(&self, origin: StartOrigin, random: &mut Random, near: Option<&[f64]>) -> Vec<f64> {
        let reach = NEAREST * libm::pow(FARTHEST / NEAREST, random.unit());
        let variables = self.family.study.variables.iter().enumerate();
        let values = variables.map(|(k, v)| {
            let range = v.upper - v.lower;
            match (origin, near) {
                (StartOrigin::Scene, _) => v.start.clamp(v.lower, v.upper),
                (StartOrigin::Near(_), Some(near)) => {
                    (near[k] + reach * range * random.normal()).clamp(v.lower, v.upper)
                }
                _ => v.lower + random.unit() * range,
            }
        });
        values.collect()
    }

    fn start(
        &self,
        index: usize,
        near: Option<&[f64]>,
        goes_on: &(dyn Fn() -> bool + Sync),
    ) -> (StartResult, Option<Fit>) {
        let origin = self.origin(index, near);
        let mut fitting = Fitting::new(self.family, self.target, goes_on);
        let (mut wanted, draws) = match origin {
            StartOrigin::Scene => (1, 1),
            StartOrigin::Near(_) => (1, MOST_DRAWS),
            StartOrigin::Random => (CANDIDATES, MOST_DRAWS),
        };
        let mut best: Option<(f64, Fit)> = None;
        for draw in 0..draws {
            if wanted == 0 || (draw > 0 && !goes_on()) {
                break;
            }
            let mut random = Random::new(self.plan.seed, index as u64, draw as u64);
            let values = self.draw(origin, &mut random, near);
            let Some(fit) = self.begin(&mut fitting, values) else {
                continue;
            };
            wanted -= 1;
            let sum: f64 = fit.missed.iter().map(|v| v * v).sum();
            if best.as_ref().is_none_or(|(least, _)| sum < *least) {
                best = Some((sum, fit));
            }
        }
        let Some((first, fit)) = best else {
            let none = StartResult {
                origin,
                first: f64::NAN,
                sum: f64::INFINITY,
                steps: 0,
                ended: StopReason::Stalled,
                poses: fitting.poses,
            };
            return (none, None);
        };
        let bounds = self.bounds();
        let found = minimise_squares(&mut fitting, fit, &bounds, self.plan.iterations);
        // Rows on both sides of a gap that steps have jumped over do not belong to one motion.
        let is_joined = self.is_joined(&mut fitting, &found.place);
        let tried = StartResult {
            origin,
            first,
            sum: if is_joined { found.sum } else { f64::INFINITY },
            steps: found.steps,
            ended: found.ended,
            poses: fitting.poses,
        };
        (tried, is_joined.then_some(found.place))
    }

    /// Whether the tracker, which also checks between its steps, passes through all rows along the fit's poses.
    fn is_joined(&self, fitting: &mut Fitting, fit: &Fit) -> bool {
        let mechanism = self.family.mechanism();
        let unknowns = mechanism.unknowns.len();
        // The rows become a drive, one second apart, which the tracker follows.
        let times: Vec<f64> = (0..fit.poses.len()).map(|k| k as f64).collect();
        let drive = |slot: usize| Drive::Keys {
            times: times.clone(),
            values: fit.poses.iter().map(|pose| pose[slot]).collect(),
            ease: Ease::Linear,
        };
        let actuation = Actuation {
            drives: (unknowns..mechanism.coordinate_count())
                .map(drive)
                .collect(),
            duration: times.last().copied().unwrap_or(0.0).max(1.0),
            guess: fit.poses[0][..unknowns].to_vec(),
            ..self.family.actuation.clone()
        };
        let motion = solve_unproved(self.family.system(), &actuation, &times);
        let found = |sample: &Sample| {
            let pose = sample.pose.as_ref()?;
            Some([pose.unknowns.as_slice(), &sample.inputs].concat())
        };
        // The first pose is assembled anew, maybe whole turns away, and keeps them.
        let Some(first) = motion.samples.first().and_then(found) else {
            return false;
        };
        let turns = WholeTurns::between(mechanism, &fit.poses[0], &first);
        let mut pairs = motion.samples.iter().zip(&fit.poses);
        pairs.all(|(sample, pose)| {
            let Some(mut here) = found(sample) else {
                return false;
            };
            here.iter_mut().zip(&turns).for_each(|(q, turn)| *q -= turn);
            fitting.group.solver.apart(&here, pose) < SAME
        })
    }

    /// Ranges of the variables and of free inputs.
    fn bounds(&self) -> VariableBounds {
        let variables = &self.family.study.variables;
        let free = self.target.free_input.map(|free| match free.is_cyclic {
            true => [f64::NEG_INFINITY, f64::INFINITY],
            false => free.range,
        });
        let rows = free
            .into_iter()
            .flat_map(|range| vec![range; self.target.rows.len()]);
        let all: Vec<[f64; 2]> = variables
            .iter()
            .map(|v| [v.lower, v.upper])
            .chain(rows)
            .collect();
        VariableBounds {
            lower: all.iter().map(|range| range[0]).collect(),
            upper: all.iter().map(|range| range[1]).collect(),
        }
    }

    /// The mechanism with these dimensions at all rows, followed from the start of its drive; `None` if that fails.
    fn begin(&self, fitting: &mut Fitting, values: Vec<f64>) -> Option<Fit> {
        let family = self.family.with_start(&values).assembled()?;
        let start = [
            family.actuation.guess.as_slice(),
            &family.actuation.inputs_at(0.0),
        ]
        .concat();
        let Some(free) = self.target.free_input else {
            let mut here = start;
            let mut poses = Vec::with_capacity(self.target.rows.len());
            for row in 0..self.target.rows.len() {
                let inputs = fitting.inputs(&values, row);
                here = fitting.follow(&here, &inputs)?;
                poses.push(here.clone());
            }
            return Some(fitting.fit(values, poses));
        };
        // Free inputs: first those of poses along the drive that deviate least, in the order of the table.
        let path = drive_path(fitting, &start, free);
        let costs: Vec<Vec<f64>> = (0..self.target.rows.len())
            .map(|row| {
                let cost = |pose: &Vec<f64>| {
                    let missed = fitting.missed(pose, row);
                    missed.iter().map(|v| v * v).sum::<f64>()
                };
                path.iter().map(cost).collect()
            })
            .collect();
        let goes_round = free.is_cyclic && path.len() > LOOKS;
        let chosen = ordered_phases(&costs, goes_round)?;
        let slot = family.mechanism().unknowns.len() + free.input;
        let poses: Vec<Vec<f64>> = chosen.iter().map(|k| path[*k].clone()).collect();
        let mut x = values;
        x.extend(poses.iter().map(|pose| pose[slot]));
        Some(fitting.fit(x, poses))
    }

    /// Unknowns at the start of the drive, followed from the first row.
    fn at_start(&self, fit: &Fit) -> Option<Vec<f64>> {
        let mut fitting = Fitting::new(self.family, self.target, self.goes_on);
        let own = self.family.own_inputs();
        let mut inputs = self.family.actuation.inputs_at(0.0);
        let count = inputs.len() - own;
        inputs[own..].copy_from_slice(&fit.x[..count]);
        let mut pose = fitting.follow(fit.poses.first()?, &inputs)?;
        pose.truncate(self.family.mechanism().unknowns.len());
        Some(pose)
    }
}

/// Poses along the range of an input, from a pose on; for an input that goes round, a full turn if possible.
fn drive_path(fitting: &mut Fitting, start: &[f64], free: FreeInput) -> Vec<Vec<f64>> {
    let slot = fitting.family.mechanism().unknowns.len() + free.input;
    let unknowns = fitting.family.mechanism().unknowns.len();
    let [low, high] = free.range;
    let step = (high - low) / LOOKS as f64;
    // From the start, steps of equal size until the end of the range or of the motion.
    let mut walk = |until: f64, by: f64| {
        let mut list = vec![start.to_vec()];
        let count = ((until - start[slot]) / by).round().max(0.0) as usize;
        for k in 1..=count {
            let here = &list[list.len() - 1];
            let mut inputs = here[unknowns..].to_vec();
            inputs[free.input] = start[slot] + by * k as f64;
            let Some(next) = fitting.follow(here, &inputs) else {
                break;
            };
            list.push(next);
        }
        list
    };
    // A crank: a full turn forwards, or, if that is blocked, both ways as far as possible.
    if free.is_cyclic {
        let forth = walk(start[slot] + (high - low), step);
        if forth.len() > LOOKS {
            return forth;
        }
        let mut back = walk(start[slot] - (high - low), -step);
        back.reverse();
        back.extend(forth.into_iter().skip(1));
        return back;
    }
    let mut back = walk(low, -step);
    back.reverse();
    back.extend(walk(high, step).into_iter().skip(1));
    back
}

impl Target {
    /// Spread of the targets about their means: the root of the weighted mean square.
    pub fn spread(&self) -> f64 {
        let count = self.rows.len().max(1) as f64;
        let mut sum = 0.0;
        for (k, column) in self.columns.iter().enumerate() {
            let mean = self.rows.iter().map(|row| row.values[k]).sum::<f64>() / count;
            for row in &self.rows {
                sum += row.weight * (column.reach * (row.values[k] - mean)).powi(2);
            }
        }
        (sum / count).sqrt()
    }
}
