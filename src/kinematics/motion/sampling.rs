//! The sampling times of a drive. Times are computed from their index, never summed up.

use crate::kinematics::results::trajectory::{SAME_INPUT, Sample, Trajectory};
use crate::limits::{LimitExceeded, Resource, allow_memory, current_limits};
use crate::model::actuation::Actuation;
use crate::model::drive::Drive;
use crate::model::measure::Measures;
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::timed_argument::TimedArgument;
use crate::sorting::sort_by;
use std::f64::consts::TAU;

/// Most samples in one run: ten thousand seconds at 100 frames a second.
pub const MAX_SAMPLES: usize = 1_000_000;

/// Numbers stored per sample in addition to those of its mechanism: time, proof, condition, names.
const NUMBERS_OF_SAMPLE: usize = 60;

/// Numbers of the pose of a body.
const NUMBERS_OF_BODY: usize = 12;

/// Rejects a motion with so many samples that it would exceed the limits of the run.
pub fn allow_samples(mechanism: &Mechanism, count: usize) -> Result<(), LimitExceeded> {
    let coordinates = 2 * mechanism.unknowns.len() + mechanism.inputs.len();
    let observed = NUMBERS_OF_BODY * mechanism.bodies.len()
        + 3 * mechanism.traces.len()
        + mechanism.outputs.len();
    let numbers = count as f64 * (coordinates + observed) as f64;
    let who = format!("a motion of {count} samples");
    current_limits().allow(Resource::Samples, numbers, &who)?;
    let kept = numbers + (count * NUMBERS_OF_SAMPLE) as f64;
    allow_memory(kept * std::mem::size_of::<f64>() as f64, &who)
}

/// Times nearer than this (relative to the duration) are one.
const SAME_TIME: f64 = 1e-12;

/// Jumps nearer than this (relative to the duration) differ by rounding.
const ROUNDED_TIME: f64 = 1e-15;

/// Whether the drive ends where it began, angles up to whole turns: a cyclic animation then needs no last frame.
pub fn is_cyclic(mechanism: &Mechanism, actuation: &Actuation) -> bool {
    let (start, end) = (
        actuation.inputs_at(0.0),
        actuation.inputs_at(actuation.duration),
    );
    let slots = mechanism.unknowns.len()..;
    slots.zip(start.iter().zip(&end)).all(|(slot, (a, b))| {
        // Whole turns of an angle end where they began.
        let difference = match mechanism.kind_of(slot) {
            Kind::Angle => (b - a) - TAU * ((b - a) / TAU).round(),
            Kind::Length => (b - a) / mechanism.scale_of(slot),
            Kind::Number => b - a,
        };
        difference.abs() <= SAME_INPUT
    })
}

/// Frames a second, fewer than `fps` where a motion would have more than [`MAX_SAMPLES`] of them.
pub fn frame_rate(actuation: &Actuation, fps: f64) -> f64 {
    fps.min(MAX_SAMPLES as f64 / actuation.duration)
}

/// Times of frames at `fps` from 0 on: the end of the drive is a frame of its own unless the drive is cyclic. A motion that is
/// too long for that has [`MAX_SAMPLES`] frames, up to its end.
pub fn frame_times(mechanism: &Mechanism, actuation: &Actuation, fps: f64) -> Vec<f64> {
    let intervals = (actuation.duration * fps).round().max(1.0);
    if intervals > MAX_SAMPLES as f64 {
        return even_times(mechanism, actuation, MAX_SAMPLES);
    }
    let intervals = intervals as usize;
    // The end of a cycle is its beginning.
    let count = if is_cyclic(mechanism, actuation) {
        intervals
    } else {
        intervals + 1
    };
    (0..count)
        .map(|k| (k as f64 / fps).min(actuation.duration))
        .collect()
}

/// `count` equal steps over the drive; both ends are included unless the drive is cyclic.
pub fn even_times(mechanism: &Mechanism, actuation: &Actuation, count: usize) -> Vec<f64> {
    let intervals = if is_cyclic(mechanism, actuation) {
        count
    } else {
        count.saturating_sub(1)
    }
    .max(1);
    (0..count)
        .map(|k| actuation.duration * (k as f64 / intervals as f64))
        .collect()
}

/// Farthest that an input may move between two points of a drawn path, as an angle or a share of the mechanism's size: the arc
/// of 5 degrees leaves its chord by a thousandth of its radius.
const PATH_STEP: f64 = 0.0873;

/// Most samples of a drawn path, beside its frames.
const PATH_SAMPLES: usize = 2000;

/// Places between two frames at which the way of a drive is measured.
const WAY_PARTS: usize = 8;

/// `times` with others between them, and the number of steps into which each interval is divided: paths through them show
/// the motion, however few the frames are. After the last frame of a cyclic motion they go on to its end.
pub fn path_times(
    mechanism: &Mechanism,
    actuation: &Actuation,
    times: &[f64],
) -> (Vec<f64>, usize) {
    let slots = mechanism.unknowns.len()..;
    let scales: Vec<f64> = slots
        .zip(&actuation.drives)
        .map(|(slot, _)| mechanism.scale_of(slot))
        .collect();
    let way = |from: f64, until: f64| {
        let at = |k: usize| from + (until - from) * (k as f64 / WAY_PARTS as f64);
        let parts = (0..WAY_PARTS).map(|k| {
            let ends = [at(k), at(k + 1)].map(|time| actuation.inputs_at(time));
            let moved = scales.iter().zip(&ends[0]).zip(&ends[1]);
            let moved = moved.map(|((scale, a), b)| (b - a).abs() / scale);
            moved.filter(|m| m.is_finite()).fold(0.0, f64::max)
        });
        parts.sum::<f64>()
    };
    let last = times.last().copied().unwrap_or_default();
    let goes_on = last < actuation.duration && is_cyclic(mechanism, actuation);
    let end = goes_on.then_some(actuation.duration);
    let all: Vec<f64> = times.iter().copied().chain(end).collect();
    let farthest = all.windows(2).map(|w| way(w[0], w[1])).fold(0.0, f64::max);
    let most = (PATH_SAMPLES / times.len().max(1)).max(1);
    let steps = ((farthest / PATH_STEP).ceil() as usize).clamp(1, most);
    let within = |from: f64, until: f64| {
        (0..steps).map(move |k| from + (until - from) * (k as f64 / steps as f64))
    };
    let mut finer: Vec<f64> = all.windows(2).flat_map(|w| within(w[0], w[1])).collect();
    if !goes_on {
        finer.extend(times.last());
    }
    (finer, steps)
}

/// The same for measures: and then the end of a cyclic motion, if some depend on it.
pub fn measured_times(
    mechanism: &Mechanism,
    actuation: &Actuation,
    measures: &Measures,
    count: usize,
) -> Vec<f64> {
    let mut times = even_times(mechanism, actuation, count);
    times.extend(end_apart(mechanism, actuation, measures));
    times
}

/// The end of the motion, if measures depend on it and it is none of the even times.
pub fn end_apart(mechanism: &Mechanism, actuation: &Actuation, measures: &Measures) -> Option<f64> {
    let is_apart = measures.look_at_end() && is_cyclic(mechanism, actuation);
    is_apart.then_some(actuation.duration)
}

/// The given times with both ends of the drive and every time at which an input has a key, a kink or a jump, or the formula
/// of a joint jumps, ascending: the samples needed for a statement about the whole motion.
pub fn knot_times(mechanism: &Mechanism, actuation: &Actuation, times: &[f64]) -> Vec<f64> {
    let last = actuation.duration;
    let breaks = |drive: &Drive| drive.breaks(0.0, last);
    let own = actuation.drives.iter().flat_map(breaks);
    let timed = TimedArgument::of_all(mechanism, actuation);
    let timed = timed.iter().flatten().filter(|timed| timed.may_jump());
    let own = own.chain(timed.clone().flat_map(|timed| timed.breaks(0.0, last)));
    let jumps = |time: f64| {
        let mut drives = actuation.drives.iter();
        let mut timed = timed.clone();
        drives.any(|drive| drive.steps_at(time)) || timed.any(|t| t.piece(time).jumps_at(time))
    };
    let own = own.map(|time| match jumps(time) {
        true => (time, KnotWeight::Pose),
        false => (time, KnotWeight::Piece),
    });
    let own = own.chain([0.0, last].map(|time| (time, KnotWeight::Pose)));
    let asked = times.iter().map(|time| (*time, KnotWeight::Sample));
    let mut all: Vec<(f64, KnotWeight)> = own.chain(asked).collect();
    sort_by(&mut all, |(p, _), (q, _)| p.total_cmp(q));
    // Different pieces of a drive meet only at these times. Of those that are nearly one, a jump counts more than a kink, and that
    // more than a sample; two jumps are two, but for rounding.
    all.dedup_by(|(b, weight), (a, known)| {
        let is_same = *b - *a <= SAME_TIME * last;
        if is_same && *known == KnotWeight::Pose && *weight == KnotWeight::Pose {
            let is_one = *b - *a <= ROUNDED_TIME * last;
            // The end is the end, even if a jump is just before.
            if is_one && *b == last {
                *a = last;
            }
            return is_one;
        }
        if is_same && *weight > *known {
            (*a, *known) = (*b, *weight);
        }
        is_same
    });
    all.into_iter().map(|(time, _)| time).collect()
}

/// What a time is needed for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum KnotWeight {
    /// It was asked for.
    Sample,
    /// Pieces of a drive meet there.
    Piece,
    /// The pose there may be on neither side: where a drive jumps, and where the motion ends.
    Pose,
}

/// The samples of a trajectory at the given times, one each, ascending: of those that are nearly one, the nearest.
pub fn samples_at(actuation: &Actuation, trajectory: &Trajectory, times: &[f64]) -> Vec<Sample> {
    let (slack, all) = (SAME_TIME * actuation.duration, &trajectory.samples);
    let at = |time: &f64| {
        let after = all.partition_point(|sample| sample.time < *time);
        let near = all[after.saturating_sub(1)..].iter().take(2);
        let off = |sample: &&Sample| (sample.time - time).abs();
        near.min_by(|a, b| off(a).total_cmp(&off(b)))
            .filter(|sample| off(sample) <= slack)
    };
    times.iter().filter_map(at).cloned().collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::diag::Source;
    use crate::scene::{Overrides, load_scene};

    /// Twenty turns in forty frames: a path through the frames would be a line.
    #[test]
    fn paths_have_poses_every_few_degrees() {
        let text = "duration = 2\n[inputs]\na = \"20*pi*t\"\n[[bodies]]\nname = \"b\"\nframe = \"Rz(a)\"\n";
        let source = Source {
            name: "spin".to_owned(),
            text: text.to_owned(),
        };
        let scene = load_scene(&source, &Overrides::default()).unwrap();
        let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
        let frames = frame_times(mechanism, actuation, 20.0);
        assert_eq!(frames.len(), 40);
        let (times, steps) = path_times(mechanism, actuation, &frames);
        // The last frame is followed by others up to the end of the cycle.
        assert_eq!(times.len(), 40 * steps);
        assert!(
            frames
                .iter()
                .enumerate()
                .all(|(k, frame)| times[k * steps] == *frame)
        );
        let angle = |time: &f64| actuation.inputs_at(*time)[0];
        let turns = times.windows(2).map(|w| angle(&w[1]) - angle(&w[0]));
        assert!(turns.fold(0.0, f64::max) <= PATH_STEP * (1.0 + 1e-9));
        // A slow drive needs no more than its frames.
        let fine = even_times(mechanism, actuation, 2000);
        assert_eq!(path_times(mechanism, actuation, &fine).1, 1);
    }

    #[test]
    fn every_time_has_one_sample() {
        let actuation = Actuation {
            duration: 2.0,
            ..Actuation::default()
        };
        let sample = |time: f64| Sample {
            time,
            inputs: Vec::new(),
            pose: None,
        };
        let rounded = 3.0 * 0.1;
        assert!(rounded > 0.3);
        let trajectory = Trajectory {
            samples: [0.0, 0.3, rounded, 1.0].map(sample).to_vec(),
            ..Trajectory::default()
        };
        let found = |times: &[f64]| -> Vec<f64> {
            let samples = samples_at(&actuation, &trajectory, times);
            samples.iter().map(|sample| sample.time).collect()
        };
        for times in [vec![0.3, rounded], vec![rounded], vec![0.0, 0.0, 0.3, 1.0]] {
            assert_eq!(found(&times), times);
        }
        // One that was not solved has no sample.
        assert_eq!(found(&[0.5, 1.0 + 1e-13]), [1.0]);
    }
}
