//! A closer look where nothing is proved between two samples: the motion is solved again with samples ever nearer to the place,
//! until all is proved, the motion is found to end there, or the rest is as short as times can be told apart.
//!
//! Steps alone do not see everything between them: two driven quantities may cancel but for a peak. No tube is proved over such
//! a place, which shows where to look.

use super::motion::{MotionStretch, ProvedMotion};
use crate::kinematics::motion::continuation::{solve_closer, solve_until};
use crate::kinematics::results::certificate::{Certificate, Reason};
use crate::kinematics::results::trajectory::{Ending, Sample, Trajectory};
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::printed::InputReading;
use crate::sorting::{sort_by, sort_by_number};

/// Most rounds: each is nearer by [`HALVINGS`].
const ROUNDS: usize = 6;

/// Samples on either side of an interval that is not proved: its halves, quarters and so on from both ends; ...
const HALVINGS: usize = 10;

/// ... fewer where there are many such intervals, and none if there is no room for that many.
const LEAST_HALVINGS: usize = 3;

/// Most samples that are added in all rounds together, and in the first one.
const MOST_ADDED: usize = 6_000;
const FIRST_ADDED: usize = 2_000;

/// A round must leave less than this fraction of what was not proved before, ...
const LEFT: f64 = 0.7;

/// ... or the next one must, which is tried for at most so many places.
const MOST_IN_VAIN: usize = 20;

/// Steps that a closer look may take: so many times those of the motion, and so many for every sample.
const TIMES_THE_STEPS: usize = 4;
const STEPS_OF_SAMPLE: usize = 200;

/// Most samples without a pose from which one is sought by descent, of a closer look that took too many steps: the first ones are
/// those that were reached.
const MOST_DESCENTS: usize = 200;

/// A motion is examined once more only if it has at most this many stretches, and so many more for every sample: nobody asked
/// for that, so it must not cost far more than the motion.
const MOST_STRETCHES: usize = 20_000;
const STRETCHES_OF_SAMPLE: usize = 20;

/// Parts of a gap that steps did not get over: a pose is sought between them.
const OF_GAP: usize = 16;

/// An interval so short is not examined, as a fraction of the motion: times are known to 1e-12 of it.
const SHORTEST: f64 = 1e-11;

/// Most work on tubes that nobody asked for: intervals between samples times the cost of a step.
const MOST_COST: usize = 60_000;

/// Intervals of a motion in which nothing is proved, in the order of time; neighbours are one.
pub fn unproved(motion: &ProvedMotion) -> Vec<[f64; 2]> {
    let stretches = motion.stretches[..motion.roots].iter();
    let estimated = stretches.filter(|stretch| !stretch.is_certified);
    let estimated = estimated.map(|MotionStretch { start, end, .. }| [*start, *end]);
    let mut all: Vec<[f64; 2]> = estimated.chain(motion.gaps.iter().copied()).collect();
    sort_by_number(&mut all, |a| a[0]);
    let mut merged: Vec<[f64; 2]> = Vec::new();
    for interval in all {
        match merged.last_mut() {
            Some(last) if last[1] >= interval[0] => last[1] = last[1].max(interval[1]),
            _ => merged.push(interval),
        }
    }
    merged
}

/// Whether the proofs between so many samples cost little beside the motion.
pub fn is_cheap(system: &System, samples: usize) -> bool {
    system.step_cost().saturating_mul(samples) <= MOST_COST
}

/// The motion at `times`, and what is proved of it with more samples between them where it is not proved with these. If the
/// motion is found to end at one of those, they are part of it.
pub fn solve_closely<'m>(
    system: &'m System,
    actuation: &Actuation,
    times: &[f64],
    reading: InputReading,
    cancelled: &dyn Fn() -> bool,
) -> (Trajectory, ProvedMotion<'m>) {
    let trajectory = solve_until(system, actuation, times, Some(reading), cancelled);
    let mut motion = ProvedMotion::new(system, actuation, &trajectory);
    // What is known to end, or not to close, needs no closer look.
    if !trajectory.is_whole() || trajectory.samples.iter().any(is_open) {
        return (trajectory, motion);
    }
    let mut all = times.to_vec();
    let mut room = FIRST_ADDED;
    let mut was_in_vain = false;
    let most_stretches = MOST_STRETCHES + STRETCHES_OF_SAMPLE * times.len();
    for round in 0..ROUNDS {
        if motion.roots > most_stretches {
            break;
        }
        let Some(more) = closer_times(&motion, &all, room).filter(|_| !cancelled()) else {
            break;
        };
        let added = more.len() - all.len();
        all = more;
        let steps = TIMES_THE_STEPS * trajectory.steps + STEPS_OF_SAMPLE * all.len();
        let closer = solve_closer(system, actuation, (&all, steps), reading, cancelled);
        // What takes too many steps tells nothing but that one instant has no pose, if that is so.
        let closer = match closer.is_spent {
            true => {
                let alone = instant_without_pose(&closer, &mut motion, MOST_DESCENTS)
                    .map(|time| joined(times, [time].into_iter(), shortest(&motion)));
                let Some(alone) = alone else {
                    break;
                };
                solve_closer(system, actuation, (&alone, steps), reading, cancelled)
            }
            false => closer,
        };
        let gapes = closer.samples.iter().any(is_open);
        if closer.is_spent && closer.is_whole()
            || !closer.is_whole() && !gapes && !is_end(&closer, &mut motion)
        {
            break;
        }
        let before = unproved_seconds(&motion);
        motion = ProvedMotion::new(system, actuation, &closer);
        if !closer.is_whole() || gapes {
            return (closer, motion);
        }
        // Where nothing can be proved more samples do not help.
        let is_in_vain = unproved_seconds(&motion) > LEFT * before;
        if is_in_vain && (was_in_vain || unproved(&motion).len() > MOST_IN_VAIN) {
            break;
        }
        was_in_vain = is_in_vain;
        room = if round == 0 { MOST_ADDED } else { room };
        room = room.saturating_sub(added);
    }
    (trajectory, motion)
}

/// Seconds in which nothing is proved.
fn unproved_seconds(motion: &ProvedMotion) -> f64 {
    let places = unproved(motion);
    places.iter().map(|[from, to]| to - from).sum()
}

/// Whether a motion that was looked at closely ends, of which `motion` is known with fewer samples: it does unless steps only got
/// stuck between poses that exist, as among the poses about a flat singular one, which are all nearly singular.
fn is_end(closer: &Trajectory, motion: &mut ProvedMotion) -> bool {
    let is_stuck = |ending: &Ending| matches!(ending, Ending::GivenUp { .. } | Ending::NotFound);
    let mut endings = closer
        .gaps
        .iter()
        .flat_map(|gap| [&gap.ending, &gap.beginning]);
    !endings.all(|ending| ending.as_ref().is_none_or(is_stuck))
        || instant_without_pose(closer, motion, usize::MAX).is_some()
}

/// The first instant without a pose near those of `motion`: of at most so many samples of a closer look that have none, or inside
/// its gaps.
fn instant_without_pose(
    closer: &Trajectory,
    motion: &mut ProvedMotion,
    most: usize,
) -> Option<f64> {
    let lacking = closer.samples.iter().filter(|sample| sample.pose.is_none());
    let samples = lacking.map(|sample| sample.time).take(most);
    // Between two samples with poses a gap may be too narrow for any of them.
    let gaps = closer.gaps.iter().filter_map(|gap| {
        let ends = [gap.from.as_ref()?, gap.until.as_ref()?];
        Some(ends.map(|instant| instant.time))
    });
    let inside = gaps.take(most).flat_map(|[from, until]| {
        let places = (1..OF_GAP).map(binary_fraction);
        places.map(move |part| from + part * (until - from))
    });
    samples.chain(inside).find(|time| !motion.has_pose(*time))
}

/// The k-th of 1/2, 1/4, 3/4, 1/8, 3/8 and so on.
fn binary_fraction(k: usize) -> f64 {
    let bits = usize::BITS - k.leading_zeros();
    let size = (1 << bits) as f64;
    (2 * k + 1) as f64 / size - 1.0
}

/// Whether redundant equations are proved not to hold at a sample.
fn is_open(sample: &Sample) -> bool {
    let open = Certificate::Refused {
        reason: Reason::Open,
    };
    sample
        .pose
        .as_ref()
        .is_some_and(|pose| pose.certificate == open)
}

/// The times and those around the places where nothing is proved, with room for so many; `None` if these are too short for a
/// closer look, or too many.
fn closer_times(motion: &ProvedMotion, times: &[f64], room: usize) -> Option<Vec<f64>> {
    let shortest = shortest(motion);
    let mut places = unproved(motion);
    places.retain(|[from, to]| to - from > shortest);
    let of_place = room / places.len().max(1);
    let halvings = (of_place.saturating_sub(2) / 2).min(HALVINGS);
    if halvings < LEAST_HALVINGS {
        return None;
    }
    let mut added = Vec::new();
    for [from, to] in places {
        added.extend([from, to]);
        let ways = (1..=halvings).map(|k| (to - from) * 0.5_f64.powi(k as i32));
        added.extend(ways.flat_map(|way| [from + way, to - way]));
    }
    let all = joined(times, added.into_iter(), shortest);
    (all.len() > times.len()).then_some(all)
}

/// The shortest interval that is examined, in seconds.
fn shortest(motion: &ProvedMotion) -> f64 {
    let [first, last] = motion.span();
    SHORTEST * (last - first)
}

/// Times and more of them. Those that were asked for stay as they are; the others are a tenth of the shortest interval from the
/// next.
fn joined(times: &[f64], added: impl Iterator<Item = f64>, shortest: f64) -> Vec<f64> {
    let mut all: Vec<(f64, bool)> = times.iter().map(|time| (*time, true)).collect();
    all.extend(added.map(|time| (time, false)));
    sort_by(&mut all, |(a, _), (b, _)| a.total_cmp(b));
    all.dedup_by(|(b, is_asked), (a, was_asked)| {
        let is_near = *b - *a < 0.1 * shortest && !(*is_asked && *was_asked);
        if is_near && *is_asked {
            (*a, *was_asked) = (*b, true);
        }
        is_near
    });
    all.into_iter().map(|(time, _)| time).collect()
}
