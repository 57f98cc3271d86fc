//! When bodies are too close: intervals of time outside of which the minimum is proved.
//!
//! Time intervals are halved until one keeps the minimum, violates it throughout, or is short. The others, joined,
//! are the times at which the minimum is violated, to within the shortest interval.

use super::branch_and_bound::split_piece;
use super::excluded::{HALVINGS, place_at, places_of};
use super::look::{LookGoal, Missed, Segment};
use super::motion::ProvedMotion;
use super::sweep::PairSweep;
use crate::distance::bodies::{enclosed_shell, nearest_bodies};
use crate::sorting::{sort_by, sort_by_number};
use std::collections::VecDeque;

/// Maximum number of intervals examined for one pair, ...
const MOST_LOOKS: usize = 6_000;

/// ... and for all pairs together, except that every pair has ...
const MOST_LOOKS_OF_ALL: usize = 30_000;

/// ... at least so many: enough for a few dozens of times.
const LEAST_LOOKS: usize = 500;

/// Maximum number of intervals examined for each of so many pairs.
pub(super) fn looks_of_each(pairs: usize) -> usize {
    (MOST_LOOKS_OF_ALL / pairs.max(1)).clamp(LEAST_LOOKS, MOST_LOOKS)
}

/// Resolution of times, as a fraction of an interval of mean length.
const SHORTEST: f64 = 1.0 / 1024.0;

/// Rounding of times, and uncertainty of those of jumps, as a fraction of the whole motion.
const TIMES: f64 = 1e-10;

/// The way down is sought from the middles of so many pieces of an interval of violation, the lowest ones.
const FEW: usize = 16;

/// An interval in which two bodies are closer than their minimum, or may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// Seconds.
    pub from: f64,
    /// Seconds.
    pub to: f64,
    /// They are closer at some instant of it; otherwise it is only not excluded.
    pub is_seen: bool,
    /// The smallest distance of a closed pose found there, from the samples down, ...
    pub distance: f64,
    /// ... and when.
    pub time: f64,
}

/// The times at which a pair is too near.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Violations {
    /// In order.
    pub list: Vec<Violation>,
    /// That the minimum is kept at all other times is proved.
    pub is_certified: bool,
}

/// A piece that does not keep the minimum.
struct Low {
    violation: Violation,
    /// What it was joined from, with what is known of their distances; samples are not among them.
    pieces: Vec<(f64, Segment)>,
}

impl PairSweep<'_> {
    /// Times below the minimum, found in at most `most_looks` intervals. Empty if bodies enclose each other without
    /// touching: no distance shows when that began.
    pub(super) fn violations(
        &self,
        motion: &mut ProvedMotion,
        is_enclosed: bool,
        most_looks: usize,
    ) -> Violations {
        if is_enclosed {
            return Violations::default();
        }
        let is_certified = motion.is_certified() && motion.roots > 0;
        let goal = self.enough() + self.pose_slack();
        let mut found = self.low_pieces(motion, goal, most_looks);
        found.extend(self.low_samples(motion, goal));
        sort_by_number(&mut found, |p| p.violation.from);
        // Between two places where a mesh is met a body may be in it, and far from its surface.
        let is_solid = !self.hulls.iter().any(|hull| hull.has_mesh());
        let mut list: Vec<Low> = Vec::new();
        for next in found {
            match list.last_mut() {
                Some(last) if !is_solid || next.violation.from <= last.violation.to => {
                    last.join(next)
                }
                _ => list.push(next),
            }
        }
        for low in &mut list {
            self.measure_low(motion, low, goal);
        }
        if !is_solid && self.is_enclosed_outside(motion, list.first()) {
            return Violations::default();
        }
        Violations {
            list: list.into_iter().map(|low| low.violation).collect(),
            is_certified,
        }
    }

    /// Pieces that are not known to keep the minimum.
    fn low_pieces(&self, motion: &mut ProvedMotion, goal: f64, most_looks: usize) -> Vec<Low> {
        // Long intervals first, so that all are about as short when the looks end.
        let mut open: VecDeque<Segment> = (0..motion.roots).map(Segment::whole).collect();
        let (mut low, mut looks) = (Vec::new(), 0);
        let mut memory = self.look_memory();
        let [start, end] = motion.span();
        let shortest = SHORTEST * (end - start) / motion.roots.max(1) as f64;
        while let Some(piece) = open.pop_front() {
            looks += 1;
            if motion.is_late() {
                low.push(Low::new(motion, piece, f64::INFINITY));
                continue;
            }
            // A piece that is not halved any more need not be known better.
            let is_last = looks >= most_looks;
            let goals = LookGoal {
                asked: goal,
                kept: goal,
                missed: match is_last {
                    true => Missed::Nothing,
                    false => Missed::Distance,
                },
            };
            let look = self.look(motion, &piece, goals, &mut memory);
            if look.lowest >= goal {
                continue;
            }
            let moved = self.chain.around(
                &motion.stretches[piece.stretch].arguments,
                piece.middle,
                piece.half,
            );
            let highest = look.middle + moved.distance(self.hulls[1].ball);
            // In time, since narrower bounds are had by halving the stretch, not the piece.
            let [from, to] = motion.times(piece.stretch, piece.ends_of());
            let is_short = to - from <= shortest || is_last || !look.falls_short_of(goal);
            let halves = match is_short || highest < goal {
                true => None,
                false => split_piece(motion, &piece, &look),
            };
            match halves {
                Some(halves) => open.extend(halves),
                None => low.push(Low::new(motion, piece, look.middle)),
            }
        }
        low
    }

    /// Samples that belong to no stretch, and do not keep the minimum.
    fn low_samples(&self, motion: &ProvedMotion, goal: f64) -> Vec<Low> {
        let mut low = Vec::new();
        for instant in motion.alone() {
            let pose = self.relative(motion, instant);
            let found = nearest_bodies(self.hulls[0], self.hulls[1], &pose, &self.left_out);
            let time = motion.instants[instant].time;
            let near = found.map(|f| f.proximity).filter(|p| p.lowest() < goal);
            low.extend(near.map(|p| Low::over(motion, [time; 2], p.distance, None)));
        }
        low
    }

    /// Whether a mesh encloses a body somewhere before or after it is met, or that cannot be told: the ends of all stretches
    /// that reach over these times tell, since nothing changes without a meeting or a jump.
    fn is_enclosed_outside(&self, motion: &mut ProvedMotion, met: Option<&Low>) -> bool {
        let [from, to] = met.map_or([f64::INFINITY, f64::NEG_INFINITY], |low| {
            [low.violation.from, low.violation.to]
        });
        for stretch in 0..motion.roots {
            let ends = motion.times(stretch, [-1.0, 1.0]);
            let outside = [(-1.0, ends[0] < from), (1.0, ends[1] > to)];
            for (s, _) in outside.into_iter().filter(|(_, is_outside)| *is_outside) {
                let Some(instant) = motion.pose_at(stretch, s) else {
                    return true;
                };
                let pose = self.relative(motion, instant);
                if enclosed_shell(self.hulls[0], self.hulls[1], &pose, &self.left_out).is_some() {
                    return true;
                }
            }
        }
        false
    }

    /// The lowest distance of a closed pose that is found in an interval: among the samples and the middles of its lowest
    /// pieces, and then down from the lowest sample and from these middles.
    fn measure_low(&self, motion: &mut ProvedMotion, low: &mut Low, goal: f64) {
        let violation = &mut low.violation;
        let within = violation.from..=violation.to;
        let samples = motion.samples.iter().copied();
        let mut instants: Vec<usize> = samples
            .filter(|k| within.contains(&motion.instants[*k].time))
            .collect();
        sort_by(&mut low.pieces, |(p, _), (q, _)| p.total_cmp(q));
        low.pieces.truncate(FEW);
        for (_, piece) in &low.pieces {
            instants.extend(motion.pose_at(piece.stretch, piece.middle));
        }
        violation.distance = f64::INFINITY;
        let Some(mut best) = self.best_of(motion, &instants, None) else {
            return;
        };
        let pieces = low.pieces.iter().map(|(_, p)| (p.stretch, p.middle));
        let places = places_of(motion, best.instant).into_iter().chain(pieces);
        for place in places.collect::<Vec<_>>() {
            let ends = [violation.from, violation.to].map(|time| place_at(motion, place.0, time));
            self.descend(motion, place, ends, HALVINGS, &mut best);
        }
        violation.distance = best.found.proximity.distance;
        violation.time = motion.instants[best.instant].time;
        violation.is_seen = violation.distance < goal - self.pose_slack();
    }
}

impl Low {
    fn new(motion: &ProvedMotion, piece: Segment, middle: f64) -> Self {
        let ends = motion.times(piece.stretch, piece.ends_of());
        Self::over(motion, ends, middle, Some(piece))
    }

    fn over(
        motion: &ProvedMotion,
        [from, to]: [f64; 2],
        distance: f64,
        piece: Option<Segment>,
    ) -> Self {
        let [start, end] = motion.span();
        let rounding = TIMES * (end - start);
        Self {
            violation: Violation {
                from: (from - rounding).max(start),
                to: (to + rounding).min(end),
                is_seen: false,
                distance,
                time: 0.5 * (from + to),
            },
            pieces: piece.map(|piece| (distance, piece)).into_iter().collect(),
        }
    }

    /// Takes in what follows.
    fn join(&mut self, next: Self) {
        self.violation.to = self.violation.to.max(next.violation.to);
        self.pieces.extend(next.pieces);
    }
}
