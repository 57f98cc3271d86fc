//! The least distance of two bodies over the whole motion, with a bound below it: branch and bound over stretches of
//! time.
//!
//! Over a stretch the distance cannot fall below what it is in the middle by more than the largest speed of any point
//! times half the length. Between convex elements only the speed along the normal of the plane between them counts, and
//! the gap of that plane stands for the distance: solids that slide along each other keep their bound.

use super::bodies::{BodyProximity, Hull, apart, enclosed, nearest};
use super::core::Element;
use super::motion::Motion;
use super::pair::{Proximity, distance, is_inside};
use super::relative::{RelativeChain, RelativeSpeed};
use crate::kinematics::certificate::flow::POSE_SLACK;
use crate::math::Pose;
use glam::DVec3;

/// Most stretches looked at for one pair.
const MAX_LOOKS: usize = 40_000;

/// Of bodies that overlap the moment of greatest depth is searched, not proved.
const LOOKS_IN_OVERLAP: usize = 400;

/// A distance, in mechanism sizes, below which the bound need not be finer than its share.
const SMALLEST_SCALE: f64 = 1e-4;

/// The least distance of two bodies over the motion.
#[derive(Clone, Debug)]
pub struct Least {
    /// Signed distance, as [`distance`] defines it.
    pub distance: f64,
    /// When, seconds.
    pub time: f64,
    /// The points, in the world.
    pub points: [DVec3; 2],
    /// The shapes, as indices into the bodies' lists.
    pub shapes: [usize; 2],
    /// One lies wholly in the other: the first, the second.
    pub inside: [bool; 2],
    /// The distance never is below this.
    pub bound: f64,
    /// The bound is proved, not estimated.
    pub is_certified: bool,
    /// The bound is as near to the distance as was asked.
    pub is_refined: bool,
}

/// Two bodies over a motion.
pub struct PairSweep<'a> {
    bodies: [usize; 2],
    hulls: [&'a Hull; 2],
    chain: RelativeChain,
    tolerance: f64,
    scale: f64,
}

/// The best so far.
struct Best {
    found: BodyProximity,
    instant: usize,
}

impl<'a> PairSweep<'a> {
    /// Bodies by index with their hulls. `tolerance` is relative to the larger of the threshold and the distance.
    pub fn new(
        motion: &Motion,
        bodies: [usize; 2],
        hulls: [&'a Hull; 2],
        tolerance: f64,
        threshold: f64,
    ) -> Self {
        // The smaller body is the one that is seen to move: turning carries its points less far.
        let swap = hulls[0].ball.1 < hulls[1].ball.1;
        let order = |pair: [usize; 2]| if swap { [pair[1], pair[0]] } else { pair };
        let bodies = order(bodies);
        let chain = |k: usize| &motion.mechanism.bodies[bodies[k]].world_from_body;
        Self {
            bodies,
            hulls: if swap { [hulls[1], hulls[0]] } else { hulls },
            chain: RelativeChain::new(chain(0), chain(1)),
            tolerance,
            scale: threshold.abs().max(SMALLEST_SCALE * motion.mechanism.size),
        }
    }

    fn relative(&self, motion: &Motion, instant: usize) -> Pose {
        self.chain.pose(&motion.instants[instant].arguments)
    }

    /// Distance at one pose.
    pub fn at(&self, motion: &Motion, instant: usize) -> Option<BodyProximity> {
        nearest(
            self.hulls[0],
            self.hulls[1],
            &self.relative(motion, instant),
        )
    }

    /// The least distance of the given poses, without a bound; fills `distances` with all of them.
    pub fn sampled(
        &self,
        motion: &Motion,
        instants: &[usize],
        distances: &mut Vec<f64>,
    ) -> Option<Least> {
        let best = self.best_of(motion, instants, distances)?;
        let bound = best.found.proximity.distance;
        Some(self.least(motion, &best, bound, false, false))
    }

    fn best_of(
        &self,
        motion: &Motion,
        instants: &[usize],
        distances: &mut Vec<f64>,
    ) -> Option<Best> {
        let mut best: Option<Best> = None;
        for &instant in instants {
            let found = self.at(motion, instant)?;
            let distance = found.proximity.distance;
            distances.push(distance);
            if best
                .as_ref()
                .is_none_or(|b| distance < b.found.proximity.distance)
            {
                best = Some(Best { found, instant });
            }
        }
        // Surfaces that never touch stay inside or outside of each other: the first pose tells.
        if let (Some(best), Some(&first)) = (&mut best, instants.first())
            && best.found.proximity.distance > 0.0
            && let Some(elements) =
                enclosed(self.hulls[0], self.hulls[1], &self.relative(motion, first))
        {
            best.found.elements = elements;
            best.found.proximity.distance = 0.0;
            best.instant = first;
        }
        best
    }

    /// The least distance over the whole motion with its bound; fills `distances` with those of the samples.
    pub fn least_over(&self, motion: &mut Motion, distances: &mut Vec<f64>) -> Option<Least> {
        let samples = motion.samples.clone();
        let mut best = self.best_of(motion, &samples, distances)?;
        let mut bound = best.found.proximity.distance;
        let (mut is_certified, mut is_refined) = (true, true);
        let at_samples: Vec<(usize, f64)> = samples
            .iter()
            .copied()
            .zip(distances.iter().copied())
            .collect();
        let value = |instant: usize| {
            let place = at_samples.binary_search_by(|(k, _)| k.cmp(&instant));
            place.map_or(f64::NEG_INFINITY, |k| at_samples[k].1)
        };
        let mut open: Vec<(f64, usize)> = (0..motion.roots)
            .map(|root| {
                let span = &motion.spans[root];
                (value(span.start).min(value(span.end)), root)
            })
            .collect();
        open.sort_by(|p, q| q.0.total_cmp(&p.0));
        let mut looks = 0;
        while let Some((ends, index)) = open.pop() {
            looks += 1;
            // Where nothing is proved a look is wasted.
            if motion.spans[index].wants_halving
                && let Some(halves) = motion.halves(index)
            {
                open.extend(halves.map(|half| (f64::NEG_INFINITY, half)));
                continue;
            }
            let overlaps = best.found.proximity.distance < 0.0;
            let most = if overlaps {
                LOOKS_IN_OVERLAP
            } else {
                MAX_LOOKS
            };
            let lowest = self.look(motion, index, ends, &mut best);
            let near = best.found.proximity.distance;
            let target = near - self.tolerance * self.scale.max(near.abs());
            let is_fine = lowest >= target;
            if !is_fine
                && looks < most
                && let Some(halves) = motion.halves(index)
            {
                open.extend(halves.map(|half| (f64::NEG_INFINITY, half)));
                continue;
            }
            is_certified &= motion.spans[index].is_certified;
            is_refined &= lowest >= target;
            bound = bound.min(lowest);
        }
        bound = bound.min(best.found.proximity.distance) - POSE_SLACK * motion.mechanism.size;
        // A depth is a measure, not a distance: what is proved then is that the bodies overlap.
        is_certified &= best.found.proximity.distance > 0.0;
        is_certified &= motion.gaps.is_empty();
        Some(self.least(motion, &best, bound, is_certified, is_refined))
    }

    /// Lower bound over a stretch; the pose in its middle may become the best. `ends` is a distance that both ends keep.
    fn look(&self, motion: &Motion, index: usize, ends: f64, best: &mut Best) -> f64 {
        let span = &motion.spans[index];
        let here = &motion.instants[span.middle];
        let speed = self.chain.speed(span, &here.arguments, self.hulls[1].ball);
        let fastest = speed.speed();
        let target = |best: &Best| {
            let near = best.found.proximity.distance;
            near - self.tolerance * self.scale.max(near.abs())
        };
        // From both ends, each for the half that is nearer to it.
        let from_ends = ends - fastest * span.half;
        if from_ends >= target(best) {
            return from_ends;
        }
        let a_from_b = self.relative(motion, span.middle);
        let far = self.hulls[0].apart(self.hulls[1], &a_from_b) - fastest * span.half;
        if far >= target(best) {
            return far;
        }
        let mut lowest = f64::INFINITY;
        for (j, second) in self.hulls[1].elements.iter().enumerate() {
            let second = second.moved(&a_from_b);
            for (i, first) in self.hulls[0].elements.iter().enumerate() {
                let far = apart(first, &second) - fastest * span.half;
                if far >= target(best) {
                    lowest = lowest.min(far);
                    continue;
                }
                let proximity = distance(first, &second);
                if proximity.distance < best.found.proximity.distance {
                    *best = Best {
                        found: BodyProximity {
                            proximity,
                            elements: [i, j],
                        },
                        instant: span.middle,
                    };
                }
                lowest = lowest.min(below(first, &second, &proximity, &speed, span.half));
            }
        }
        lowest
    }

    fn least(
        &self,
        motion: &Motion,
        best: &Best,
        bound: f64,
        is_certified: bool,
        is_refined: bool,
    ) -> Least {
        let instant = &motion.instants[best.instant];
        let world_from_a = instant.bodies[self.bodies[0]];
        let a_from_b = self.relative(motion, best.instant);
        let [i, j] = best.found.elements;
        let (first, second) = (
            &self.hulls[0].elements[i],
            self.hulls[1].elements[j].moved(&a_from_b),
        );
        let distance = best.found.proximity.distance;
        let mut inside = [false; 2];
        if distance < 0.0 {
            inside = [is_inside(first, &second), is_inside(&second, first)];
        }
        let points = best
            .found
            .proximity
            .points
            .map(|p| world_from_a.transform_point(p));
        let mut least = Least {
            distance,
            time: instant.time,
            points,
            shapes: [first.shape, second.shape],
            inside,
            bound,
            is_certified,
            is_refined,
        };
        if self.bodies[0] > self.bodies[1] {
            least.points.swap(0, 1);
            least.shapes.swap(0, 1);
            least.inside.swap(0, 1);
        }
        least
    }

    /// Both bodies go on for ever: no speed bounds their points.
    pub fn is_endless(&self) -> bool {
        self.hulls.iter().all(|hull| hull.ball.1 == f64::INFINITY)
    }

    /// The bodies in the order of the report.
    pub fn bodies(&self) -> [usize; 2] {
        let [a, b] = self.bodies;
        [a.min(b), a.max(b)]
    }
}

/// Lower bound of the distance of two elements over `half` seconds before and after.
fn below(a: &Element, b: &Element, found: &Proximity, speed: &RelativeSpeed, half: f64) -> f64 {
    let plain = found.distance - speed.speed() * half;
    let n = found.normal;
    let (Some(left), Some(right)) = (a.core.support(n), b.core.support(-n)) else {
        return plain;
    };
    if found.distance <= 0.0 || n == DVec3::ZERO {
        return plain;
    }
    let gap = -left - right - a.radius - b.radius;
    plain.max(gap - speed.along(n) * half)
}
