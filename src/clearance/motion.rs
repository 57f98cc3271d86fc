//! The motion between the samples, in time intervals ("stretches") in which every joint is known to within a bound.
//!
//! A stretch is a tube of the [certificate](crate::kinematics::certificate::tube): polynomials and a bound on the deviation
//! of the motion. Where nothing can be proved (singular poses, kinks of formulas) a parabola through three poses is used,
//! and its bound is reported as an estimate.

use crate::kinematics::certificate::tube::{Prover, TaylorModel, Tube};
use crate::kinematics::loops::observed::formula_value;
use crate::kinematics::results::passed::PassedPoses;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::kinematics::structure::system::System;
use crate::limits::{Deadline, search_deadline};
use crate::math::Pose;
use crate::model::actuation::Actuation;
use crate::model::chain::ArgumentValue;
use crate::model::expression::Expression;
use crate::model::mechanism::Kind;
use crate::numbers::interval::Interval;
use std::collections::HashSet;
use std::sync::Arc;

/// Shortest stretch that a proof is first tried for, as a fraction of the whole motion: proofs must not depend on the number
/// of samples. With play, which does not shrink with the stretch, this limit alone counts.
const SHORTEST: f64 = 1.0 / 262_144.0;

/// Maximum number of stretches of one motion, ...
const MAX_STRETCHES: usize = 60_000;

/// ... of one with play, ...
const STRETCHES_WITH_PLAY: usize = 1_000;

/// ... and of arguments of joints in all of them together (about 100 MB); beyond it bounds are not refined.
const MAX_ARGUMENTS: usize = 1_200_000;

/// A search that finds more than this share of them begins without those of the searches before it.
const CROWDED: f64 = 0.5;

/// An estimated motion may deviate from a line by this fraction of its length.
pub(super) const ESTIMATE_SHARE: f64 = 0.1;

/// A pose at a time.
#[derive(Clone, Debug)]
pub struct SampledInstant {
    /// Seconds.
    pub time: f64,
    /// Unknowns, then inputs.
    pub coordinates: Vec<f64>,
    /// Values of all arguments.
    pub arguments: Vec<ArgumentValue>,
}

/// A stretch of time.
#[derive(Clone, Debug)]
pub struct MotionStretch {
    /// Seconds.
    pub start: f64,
    /// Seconds.
    pub end: f64,
    /// Samples at its ends: places in [`ProvedMotion::samples`].
    pub ends: [Option<usize>; 2],
    /// All arguments of joints over the stretch, which goes from -1 to 1.
    pub arguments: Vec<TaylorModel>,
    /// The arguments' bounds are proved.
    pub is_certified: bool,
    pub(super) way: StretchMotion,
    /// First of its two halves, once requested; `Some(None)` if there are none.
    pub(super) halves: Option<Option<usize>>,
}

#[derive(Clone, Debug)]
pub(super) enum StretchMotion {
    Proved(Box<Tube>),
    /// Between two instants.
    Estimated([usize; 2]),
}

/// Largest closure error of an uncertified pose, in sizes of the loop.
const UNPROVED: f64 = 1e-10;

/// Largest deviation of any unknown of the samples from the exact pose.
fn pose_error(size: f64, trajectory: &Trajectory) -> f64 {
    let errors = trajectory.poses().map(|pose| {
        let bounds = pose.certificate.bounds();
        bounds.map_or(UNPROVED * size, |[error, _]| error)
    });
    errors.fold(0.0, f64::max)
}

/// The motion of a mechanism over its drive.
pub struct ProvedMotion<'m> {
    /// The mechanism that moves.
    pub system: &'m System,
    pub(super) actuation: Actuation,
    pub(super) solver: PoseSolver<'m>,
    pub(super) prover: Prover<'m>,
    pub(super) passed: Arc<PassedPoses>,
    /// All poses solved.
    pub instants: Vec<SampledInstant>,
    /// Indices of the poses at the sampled times.
    pub samples: Vec<usize>,
    /// All stretches; the first ones cover the motion.
    pub stretches: Vec<MotionStretch>,
    /// Number of these.
    pub roots: usize,
    /// Times between samples that could not be followed.
    pub gaps: Vec<[f64; 2]>,
    /// Samples from or to which the drive jumps, seconds: what is proved of the motion on both sides is not connected there.
    pub jumps: Vec<f64>,
    /// Whether all sampled poses are.
    has_certified_poses: bool,
    /// Bound on the deviation of the samples' unknowns from the exact pose: lengths, and angles times the size.
    pub pose_error: f64,
    /// Maximum number of stretches, ...
    most_stretches: usize,
    /// ... and the shortest at first, seconds.
    pub(super) shortest: f64,
    /// Poses at the beginning of a part of the motion that is not proved to be connected to the previous one.
    pub(super) anew: HashSet<usize>,
    /// The pose at which the bodies are assembled, if it is not the first sample.
    assembled: Option<usize>,
    /// When searches end, with what is proved so far.
    pub(super) until: Deadline,
    /// Whether a search has ended that way.
    pub(super) is_cut_off: bool,
}

impl<'m> ProvedMotion<'m> {
    /// Covers a motion with stretches. Poses without a certificate may be too far from the motion for its tubes,
    /// which then take much longer to prove.
    pub fn new(system: &'m System, actuation: &Actuation, trajectory: &Trajectory) -> Self {
        Self::with_play(system, actuation, trajectory, Vec::new())
    }

    /// The same where every input may deviate from its drive by its play at every instant: proofs then hold for all of
    /// these motions. The poses are those of the drive. An empty `play` means no play.
    pub fn with_play(
        system: &'m System,
        actuation: &Actuation,
        trajectory: &Trajectory,
        play: Vec<f64>,
    ) -> Self {
        let mechanism = system.mechanism();
        let has_play = play.iter().any(|play| *play > 0.0);
        let ends = [trajectory.samples.first(), trajectory.samples.last()];
        let [start, end] = ends.map(|sample| sample.map_or(0.0, |sample| sample.time));
        let (most_stretches, shortest) = match has_play {
            true => (STRETCHES_WITH_PLAY, f64::INFINITY),
            false => (MAX_STRETCHES, SHORTEST * (end - start)),
        };
        let mut motion = Self {
            system,
            actuation: actuation.clone(),
            solver: PoseSolver::new(system),
            most_stretches,
            shortest,
            prover: Prover::new(system, actuation)
                .through(&trajectory.passed)
                .up_to_jumps()
                .with_play(play),
            passed: Arc::clone(&trajectory.passed),
            instants: Vec::new(),
            samples: Vec::new(),
            stretches: Vec::new(),
            roots: 0,
            gaps: Vec::new(),
            jumps: Vec::new(),
            has_certified_poses: trajectory.poses().all(|p| p.certificate.bounds().is_some()),
            pose_error: pose_error(mechanism.size, trajectory),
            anew: HashSet::new(),
            assembled: None,
            until: search_deadline(),
            is_cut_off: false,
        };
        // Samples with poses in a row are joined by proved stretches; anything else begins anew.
        let of_loops = trajectory.gaps.iter();
        let of_loops =
            of_loops.filter_map(|gap| Some([gap.from.as_ref()?.time, gap.until.as_ref()?.time]));
        let lacking: Vec<[f64; 2]> = of_loops.collect();
        let mut last: Option<usize> = None;
        for (k, sample) in trajectory.samples.iter().enumerate() {
            let here = sample.pose.as_ref().map(|pose| {
                let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
                motion.instant(sample.time, coordinates)
            });
            match (last, here) {
                (Some(_), Some(_)) => {
                    let place = motion.samples.len();
                    motion.samples.extend(here);
                    let pair = &trajectory.samples[k - 1..=k];
                    motion.note_jumps(pair[0].time, pair[1].time);
                    let is_joined = if motion.is_late() {
                        motion.leave_out(pair[0].time, pair[1].time);
                        false
                    } else {
                        motion.cover(pair, [place - 1, place], &lacking)
                    };
                    motion.anew.extend(here.filter(|_| !is_joined));
                }
                _ => {
                    motion.samples.extend(here);
                    motion.anew.extend(here);
                    if let Some(before) = k.checked_sub(1).map(|k| &trajectory.samples[k]) {
                        motion.leave_out(before.time, sample.time);
                    }
                }
            }
            last = here;
        }
        motion.roots = motion.stretches.len();
        motion
    }

    /// The same motion as a part of a larger one, whose bodies were assembled at another pose: unknowns, then inputs. It
    /// has no time.
    pub fn assembled_at(mut self, coordinates: Vec<f64>) -> Self {
        self.assembled = Some(self.instant(f64::NAN, coordinates));
        self
    }

    /// The pose at which the bodies are assembled: shapes that touch at a joint there are meant to. The first sample, unless
    /// another one was given.
    pub fn assembled(&self) -> Option<usize> {
        self.assembled.or_else(|| self.samples.first().copied())
    }

    /// Values of all arguments at the sampled times.
    pub fn poses(&self) -> impl Iterator<Item = &Vec<ArgumentValue>> + Clone {
        let samples = self.samples.iter();
        samples.map(|k| &self.instants[*k].arguments)
    }

    /// `world_from_body` of one body at a solved pose.
    pub fn body_pose(&self, instant: usize, body: usize) -> Pose {
        let chain = &self.system.mechanism().bodies[body].world_from_body;
        chain.pose(&self.instants[instant].arguments)
    }

    /// The first and the last sampled time.
    pub fn span(&self) -> [f64; 2] {
        let time = |k: Option<&usize>| k.map_or(0.0, |k| self.instants[*k].time);
        [time(self.samples.first()), time(self.samples.last())]
    }

    /// Indices of the poses at sampled times that are at the end of no stretch.
    pub fn alone(&self) -> Vec<usize> {
        let roots = self.stretches[..self.roots].iter();
        let ends: HashSet<usize> = roots.flat_map(|s| s.ends).flatten().collect();
        let places = (0..self.samples.len()).filter(|place| !ends.contains(place));
        places.map(|place| self.samples[place]).collect()
    }

    /// Forgets poses that were solved for one pair only: those of many bodies are large. Estimated stretches refer to theirs.
    pub fn forget(&mut self, from: usize) {
        if self.stretches.iter().all(|s| s.is_certified) {
            self.instants.truncate(from);
        }
    }

    /// Forgets the halves of stretches if another search would lack its own: it does not depend on those before it.
    pub fn make_room(&mut self) {
        let halves = self.stretches.len() - self.roots;
        if halves as f64 > CROWDED * self.most_stretches() as f64 {
            self.stretches.truncate(self.roots);
            self.stretches.iter_mut().for_each(|s| s.halves = None);
        }
    }

    /// Memory limits the number of stretches: each keeps a Taylor model of every argument.
    fn most_stretches(&self) -> usize {
        let arguments = self.stretches.first().map_or(1, |s| s.arguments.len());
        (MAX_ARGUMENTS / arguments.max(1)).min(self.most_stretches)
    }

    /// Leaves all but one of this many equal shares of its time to others.
    pub fn share_time(&mut self, shares: usize) {
        self.until = self.until.share(shares);
    }

    /// Whether a search has to end with what it has proved so far; this is remembered.
    pub fn is_late(&mut self) -> bool {
        let is_late = self.until.is_over();
        self.is_cut_off |= is_late;
        is_late
    }

    /// Whether all of it is proved.
    pub fn is_certified(&self) -> bool {
        let mut roots = self.stretches[..self.roots].iter();
        self.gaps.is_empty()
            && roots.all(|s| s.is_certified)
            && (self.has_certified_poses || self.alone().is_empty())
    }

    /// All values of a formula at poses that are at the end of no stretch.
    pub fn formula_ranges_alone(&self, formula: (&Expression, &[bool])) -> Vec<Interval> {
        let mechanism = self.system.mechanism();
        let count = mechanism.unknowns.len();
        let of_pose = |instant: usize| {
            let SampledInstant {
                time, coordinates, ..
            } = &self.instants[instant];
            let unknowns = coordinates[..count]
                .iter()
                .enumerate()
                .map(|(slot, value)| {
                    // A number has the scale of its own magnitude.
                    let share = self.pose_error / mechanism.size;
                    let error = match mechanism.kind_of(slot) {
                        Kind::Angle => share,
                        Kind::Length => self.pose_error,
                        Kind::Number => self.pose_error.max(share * mechanism.scale_of(slot)),
                    };
                    Interval::point(*value) + Interval::around_zero(error)
                });
            // With play an input may be elsewhere.
            let drives = self
                .actuation
                .drives
                .iter()
                .map(|drive| match self.prover.has_play() {
                    true => Interval::ENTIRE,
                    false => drive.range_at(*time),
                });
            let known: Vec<Interval> = unknowns.chain(drives).collect();
            formula_value(mechanism, &known, formula)
        };
        self.alone().into_iter().map(of_pose).collect()
    }

    /// How well redundant equations are proved to close where the motion is, in the scene's unit; `None` without any of them.
    pub fn closes_to(&self) -> Option<f64> {
        let roots = self.stretches[..self.roots].iter();
        self.prover
            .closes_to(roots.filter_map(|stretch| match &stretch.way {
                StretchMotion::Proved(tube) => Some(&**tube),
                StretchMotion::Estimated(_) => None,
            }))
    }

    /// Notes a stretch that is not examined, together with the one before it.
    pub(super) fn leave_out(&mut self, from: f64, to: f64) {
        match self.gaps.last_mut() {
            Some(gap) if gap[1] == from => gap[1] = to,
            _ => self.gaps.push([from, to]),
        }
    }

    /// Times of places of a stretch.
    pub fn times<const N: usize>(&self, stretch: usize, places: [f64; N]) -> [f64; N] {
        let MotionStretch { start, end, .. } = self.stretches[stretch];
        places.map(|s| (0.5 * (start + end) + 0.5 * (end - start) * s).clamp(start, end))
    }

    /// The closed pose at place `s` of a stretch.
    pub fn pose_at(&mut self, stretch: usize, s: f64) -> Option<usize> {
        let [time] = self.times(stretch, [s]);
        match &self.stretches[stretch].way {
            StretchMotion::Estimated([a, b]) => {
                let (a, b) = (*a, *b);
                self.between(a, b, time)
            }
            StretchMotion::Proved(tube) => {
                let count = self.system.mechanism().unknowns.len();
                let mut coordinates: Vec<f64> = (0..count).map(|k| tube.centre(k, time)).collect();
                coordinates.extend(self.actuation.inputs_at(time));
                let closed = self.solver.closed(&mut coordinates, Pace::Brisk);
                closed.then(|| self.instant(time, coordinates))
            }
        }
    }

    /// A formula of coordinates, traced points and outputs over a stretch; with its dependencies.
    pub fn formula(&self, stretch: usize, formula: (&Expression, &[bool])) -> TaylorModel {
        let mechanism = self.system.mechanism();
        match &self.stretches[stretch].way {
            StretchMotion::Proved(tube) => tube.formula(mechanism, formula),
            StretchMotion::Estimated(ends) => {
                let [a, b] =
                    ends.map(|k| formula_value(mechanism, &self.instants[k].coordinates, formula));
                let mut model = TaylorModel::constant(0.5 * (a + b));
                model.c[1] = 0.5 * (b - a);
                model.rest = ESTIMATE_SHARE * (b - a).abs();
                model
            }
        }
    }

    /// All values of a formula over a stretch, from the ranges of the coordinates: it holds where a polynomial does not suit the
    /// formula.
    pub fn formula_range(&self, stretch: usize, formula: (&Expression, &[bool])) -> Interval {
        match &self.stretches[stretch].way {
            StretchMotion::Proved(tube) => tube.formula_range(self.system.mechanism(), formula),
            StretchMotion::Estimated(_) => Interval::ENTIRE,
        }
    }

    /// Whether a stretch is long enough to be halved for its own sake.
    pub fn may_be_halved(&self, stretch: usize) -> bool {
        let MotionStretch { start, end, .. } = self.stretches[stretch];
        end - start > self.shortest
    }

    /// The halves of a stretch, whose bounds are narrower; `None` when there are too many stretches, or they cannot be
    /// had.
    pub fn halves(&mut self, stretch: usize) -> Option<[usize; 2]> {
        if let Some(known) = self.stretches[stretch].halves {
            return known.map(|first| [first, first + 1]);
        }
        let first = self.halve(stretch);
        self.stretches[stretch].halves = Some(first);
        first.map(|first| [first, first + 1])
    }

    fn halve(&mut self, stretch: usize) -> Option<usize> {
        if self.stretches.len() >= self.most_stretches() {
            return None;
        }
        let ends = self.stretches[stretch].ends;
        match self.stretches[stretch].way.clone() {
            StretchMotion::Proved(tube) => {
                // Two thinner tubes, proved anew. Both are needed, with finite bounds of all arguments.
                let [first, second] = self.prover.halves(&tube)?;
                let arguments = [&first, &second].map(|tube| self.prover.arguments(tube));
                if !arguments.iter().flatten().all(TaylorModel::is_finite) {
                    return None;
                }
                let [of_first, of_second] = arguments;
                let first = self.add_tube(first, of_first, [ends[0], None]);
                self.add_tube(second, of_second, [None, ends[1]]);
                Some(first)
            }
            StretchMotion::Estimated([start, end]) => {
                // An estimate is halved at a solved pose; each half has a parabola of its own.
                let time = 0.5 * (self.instants[start].time + self.instants[end].time);
                let middle = self.between(start, end, time)?;
                let first = self.add_estimate([start, middle], [ends[0], None])?;
                let second = self.add_estimate([middle, end], [None, ends[1]]);
                // Halves have adjacent indices: without the second the first is removed again.
                if second.is_none() {
                    self.stretches.truncate(first);
                }
                second.map(|_| first)
            }
        }
    }
}
