//! The least distance of two bodies over the whole motion, with a bound below it: branch and bound over stretches of
//! time.
//!
//! Over a short time the distance cannot fall below what it is in the middle by more than any point moves. Between convex
//! elements only the motion across the plane between them counts, point by point: then the bound is as near as the second
//! power of the time, and solids that slide along each other keep it.

use super::bodies::{BodyProximity, Hull, apart, enclosed, nearest};
use super::core::{Core, Element};
use super::meeting::Meeting;
use super::motion::Motion;
use super::pair::is_inside;
use super::relative::RelativeChain;
use super::track::Track;
use crate::math::Pose;
use glam::DVec3;
use std::rc::Rc;

/// No point of a body is farther from its exact place than this for rounding, in sizes: a hundred of them away, the
/// products of a chain are good to 1e-13.
pub const POSE_SLACK: f64 = 1e-10;

/// Most pieces of time looked at for one pair.
const MAX_LOOKS: usize = 40_000;

/// Of bodies that overlap the moment of greatest depth is searched, not proved.
const LOOKS_IN_OVERLAP: usize = 400;

/// A threshold, in mechanism sizes, below which the bound need not be finer than its share.
const SMALLEST_SCALE: f64 = 1e-4;

/// Shortest piece of a stretch that is looked at, as a part of it.
const SHORTEST: f64 = 1.0 / 65_536.0;

/// The least distance of two bodies over the motion.
#[derive(Clone, Debug)]
pub struct Least {
    /// Signed distance, as [`distance`](super::pair::distance) defines it.
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
    pub(super) bodies: [usize; 2],
    pub(super) hulls: [&'a Hull; 2],
    pub(super) chain: RelativeChain,
    /// How the first body moves as seen from the second: for elements of the second one that have no end.
    back: Option<RelativeChain>,
    tolerance: f64,
    threshold: f64,
    /// No bound need be finer than this share of it.
    least_scale: f64,
}

/// The best so far.
struct Best {
    found: BodyProximity,
    moment: Moment,
}

#[derive(Clone, Copy)]
enum Moment {
    Instant(usize),
    /// Place of a stretch.
    Within(usize, f64),
}

/// A piece of a stretch.
#[derive(Clone)]
struct Piece {
    stretch: usize,
    middle: f64,
    half: f64,
    /// A distance that both ends keep.
    ends: f64,
    /// Pairs of elements that may be near; all, if nothing is known.
    near: Option<Rc<[[usize; 2]]>>,
}

/// What a look at a piece found.
struct Look {
    /// No distance of the piece is lower.
    lowest: f64,
    /// Narrower bounds of the motion would help more than shorter pieces.
    is_blurred: bool,
    near: Option<Rc<[[usize; 2]]>>,
}

impl<'a> PairSweep<'a> {
    /// Bodies by index with their hulls. `tolerance` is relative to the threshold, or to the distance where
    /// that is zero.
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
        let hulls = if swap { [hulls[1], hulls[0]] } else { hulls };
        let chain = |k: usize| &motion.system.mechanism().bodies[bodies[k]].world_from_body;
        let is_endless = |e: &Element| matches!(e.core, Core::HalfSpace(_));
        let back = hulls[1].elements.iter().any(is_endless);
        Self {
            bodies,
            hulls,
            chain: RelativeChain::new(chain(0), chain(1)),
            back: back.then(|| RelativeChain::new(chain(1), chain(0))),
            tolerance,
            threshold: threshold.abs(),
            least_scale: SMALLEST_SCALE * motion.system.mechanism().size,
        }
    }

    fn relative(&self, motion: &Motion, instant: usize) -> Pose {
        self.chain.pose(&motion.instants[instant].arguments)
    }

    /// The least distance of the given poses, without a bound; fills `distances` with all of them, and
    /// is quicker if they are not asked for.
    pub fn sampled(
        &self,
        motion: &mut Motion,
        instants: &[usize],
        distances: Option<&mut Vec<f64>>,
    ) -> Option<Least> {
        let best = self.best_of(motion, instants, distances)?;
        let bound = best.found.proximity.distance;
        self.least(motion, &best, bound, false, false)
    }

    fn best_of(
        &self,
        motion: &Motion,
        instants: &[usize],
        mut distances: Option<&mut Vec<f64>>,
    ) -> Option<Best> {
        let mut best: Option<Best> = None;
        let mut track = Track::new(self.hulls);
        for &instant in instants {
            let least = best.as_ref().map(|b| b.found.proximity.distance);
            let limit = match (&distances, least) {
                (None, Some(least)) => least - POSE_SLACK * motion.system.mechanism().size,
                _ => f64::INFINITY,
            };
            let Some(found) = track.at(&self.relative(motion, instant), limit) else {
                continue;
            };
            let distance = found.proximity.distance;
            if let Some(list) = &mut distances {
                list.push(distance);
            }
            if least.is_none_or(|least| distance < least) {
                let moment = Moment::Instant(instant);
                best = Some(Best { found, moment });
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
            best.moment = Moment::Instant(first);
        }
        best
    }

    /// What the bound must reach.
    fn target(&self, best: &Best) -> f64 {
        let near = best.found.proximity.distance;
        let scale = if self.threshold > 0.0 {
            self.threshold
        } else {
            near.abs()
        };
        near - self.tolerance * scale.max(self.least_scale)
    }

    /// The least distance over the whole motion with its bound; fills `distances` with those of the samples.
    pub fn least_over(&self, motion: &mut Motion, distances: &mut Vec<f64>) -> Option<Least> {
        let samples = motion.samples.clone();
        let mut best = self.best_of(motion, &samples, Some(distances))?;
        let mut bound = best.found.proximity.distance;
        let (mut is_certified, mut is_refined) = (true, true);
        let value =
            |place: Option<usize>| place.map_or(f64::NEG_INFINITY, |place| distances[place]);
        let mut open: Vec<Piece> = (0..motion.roots)
            .map(|root| {
                let ends = motion.stretches[root].ends;
                Piece {
                    stretch: root,
                    middle: 0.0,
                    half: 1.0,
                    ends: value(ends[0]).min(value(ends[1])),
                    near: None,
                }
            })
            .collect();
        open.sort_by(|p, q| q.ends.total_cmp(&p.ends));
        let mut looks = 0;
        while let Some(piece) = open.pop() {
            looks += 1;
            let overlaps = best.found.proximity.distance < 0.0;
            let most = if overlaps {
                LOOKS_IN_OVERLAP
            } else {
                MAX_LOOKS
            };
            let mut look = self.look(motion, &piece, &mut best);
            if look.lowest.is_nan() {
                look.lowest = f64::NEG_INFINITY;
            }
            if look.lowest < self.target(&best)
                && look.lowest > f64::NEG_INFINITY
                && looks < most
                && let Some(parts) = parts(motion, &piece, &look)
            {
                open.extend(parts);
                continue;
            }
            is_certified &= motion.stretches[piece.stretch].is_certified;
            is_refined &= look.lowest >= self.target(&best);
            bound = bound.min(look.lowest);
        }
        let least = self.least(motion, &best, bound, is_certified, is_refined)?;
        Some(Least {
            bound: bound.min(least.distance) - POSE_SLACK * motion.system.mechanism().size,
            // A depth is a measure, not a distance: what is proved then is that the bodies overlap.
            is_certified: is_certified && least.distance > 0.0 && motion.gaps.is_empty(),
            ..least
        })
    }

    /// Lower bound over a piece; the pose in its middle may become the best.
    fn look(&self, motion: &Motion, piece: &Piece, best: &mut Best) -> Look {
        let stretch = &motion.stretches[piece.stretch];
        let (arguments, s, half) = (&stretch.arguments, piece.middle, piece.half);
        let moved = self.chain.around(arguments, s, half);
        let fastest = moved.distance(self.hulls[1].ball);
        let near = piece.near.clone();
        // From both ends, each for the half that is nearer to it.
        let ball = self.hulls[1].ball;
        let from_ends = piece.ends - fastest - moved.bending(ball) - moved.deviation(ball);
        let far = self.hulls[0].apart(self.hulls[1], &moved.pose) - fastest;
        let lowest = from_ends.max(far);
        if lowest >= self.target(best) {
            let is_blurred = false;
            return Look {
                lowest,
                is_blurred,
                near,
            };
        }
        let back = self.back.as_ref().map(|b| b.around(arguments, s, half));
        let (mut lowest, mut nearest) = (f64::INFINITY, f64::INFINITY);
        let mut left: Vec<[usize; 2]> = Vec::new();
        let mut placed: Vec<Option<Element>> = vec![None; self.hulls[1].elements.len()];
        let mut visit = |[i, j]: [usize; 2]| {
            let first = &self.hulls[0].elements[i];
            let mine = &self.hulls[1].elements[j];
            let second = placed[j].get_or_insert_with(|| mine.moved(&moved.pose));
            let way = match (&back, &mine.core) {
                (Some(back), Core::HalfSpace(_)) => back.distance(first.bounds()),
                _ => moved.distance(mine.bounds()),
            };
            let far = apart(first, second) - way;
            if far >= self.target(best) {
                lowest = lowest.min(far);
                return;
            }
            let meeting = Meeting::new(first, second, mine, &moved);
            let proximity = meeting.found;
            nearest = nearest.min(proximity.distance);
            if proximity.distance < best.found.proximity.distance {
                *best = Best {
                    found: BodyProximity {
                        proximity,
                        elements: [i, j],
                    },
                    moment: Moment::Within(piece.stretch, s),
                };
            }
            let below = match (&back, &mine.core) {
                (Some(back), Core::HalfSpace(_)) => {
                    Meeting::new(mine, &first.moved(&back.pose), first, back).below()
                }
                _ => meeting.below(),
            };
            lowest = lowest.min(below);
            left.push([i, j]);
        };
        match &near {
            Some(near) => near.iter().for_each(|pair| visit(*pair)),
            None => {
                for i in 0..self.hulls[0].elements.len() {
                    (0..self.hulls[1].elements.len()).for_each(|j| visit([i, j]));
                }
            }
        }
        let blur = self.chain.blur(arguments, self.hulls[1].ball);
        Look {
            lowest,
            is_blurred: nearest - 2.0 * blur < self.target(best),
            near: Some(left.into()),
        }
    }

    fn least(
        &self,
        motion: &mut Motion,
        best: &Best,
        bound: f64,
        is_certified: bool,
        is_refined: bool,
    ) -> Option<Least> {
        let mut found = best.found;
        let instant = match best.moment {
            Moment::Instant(instant) => instant,
            Moment::Within(stretch, s) => {
                let instant = motion.pose_at(stretch, s)?;
                let pose = self.relative(motion, instant);
                found = nearest(self.hulls[0], self.hulls[1], &pose)?;
                instant
            }
        };
        let a_from_b = self.relative(motion, instant);
        let instant = &motion.instants[instant];
        let world_from_a = instant.bodies[self.bodies[0]];
        let [i, j] = found.elements;
        let (first, second) = (
            &self.hulls[0].elements[i],
            self.hulls[1].elements[j].moved(&a_from_b),
        );
        let distance = found.proximity.distance;
        let mut inside = [false; 2];
        if distance < 0.0 {
            inside = [is_inside(first, &second), is_inside(&second, first)];
        }
        let points = found
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
        Some(least)
    }

    /// Both bodies go on for ever.
    pub fn is_endless(&self) -> bool {
        self.hulls.iter().all(|hull| hull.ball.1 == f64::INFINITY)
    }

    /// The bodies in the order of the report.
    pub fn bodies(&self) -> [usize; 2] {
        let [a, b] = self.bodies;
        [a.min(b), a.max(b)]
    }
}

/// The two halves of a piece; of a stretch with narrower bounds where that is what is missing.
fn parts(motion: &mut Motion, piece: &Piece, look: &Look) -> Option<[Piece; 2]> {
    let part = |stretch: usize, middle: f64, half: f64| Piece {
        stretch,
        middle,
        half,
        ends: f64::NEG_INFINITY,
        near: look.near.clone(),
    };
    let is_certified = motion.stretches[piece.stretch].is_certified;
    if (look.is_blurred || !is_certified)
        && let Some([first, second]) = motion.halves(piece.stretch)
    {
        // The same times as seen from the halves.
        let (from, to) = (piece.middle - piece.half, piece.middle + piece.half);
        let (low, high) = (2.0 * from + 1.0, 2.0 * to + 1.0);
        let over = |stretch: usize, low: f64, high: f64| {
            part(stretch, 0.5 * (low + high), 0.5 * (high - low))
        };
        return Some(if to <= 0.0 {
            let middle = 0.5 * (low + high);
            [over(first, low, middle), over(first, middle, high)]
        } else if from >= 0.0 {
            let (low, high) = (low - 2.0, high - 2.0);
            let middle = 0.5 * (low + high);
            [over(second, low, middle), over(second, middle, high)]
        } else {
            [over(first, low, 1.0), over(second, -1.0, high - 2.0)]
        });
    }
    let half = 0.5 * piece.half;
    (is_certified && half >= SHORTEST).then(|| {
        [
            part(piece.stretch, piece.middle - half, half),
            part(piece.stretch, piece.middle + half, half),
        ]
    })
}
