//! Lower bound of the distance of two bodies over a part of a time interval, element by element.

use super::meeting::Meeting;
use super::motion::ProvedMotion;
use super::near_part::in_parts;
use super::one_joint::{ProvedRanges, RoundPair, round_pairs};
use super::sweep::PairSweep;
use crate::distance::bodies::{ball_separation, separation_along};
use crate::distance::pair::{signed_distance, signed_distance_below};
use crate::distance::primitive::{Element, Primitive};
use glam::DVec3;
use std::rc::Rc;

/// A part of a time interval of the motion.
#[derive(Clone)]
pub(super) struct Segment {
    pub(super) stretch: usize,
    pub(super) middle: f64,
    pub(super) half: f64,
    /// A distance that both ends keep.
    pub(super) ends: f64,
    /// Lower bound from a longer part or for another goal.
    pub(super) known: f64,
    pub(super) near: NearElements,
}

/// Pairs of elements that may be near; all, if nothing is known.
#[derive(Clone)]
pub(super) struct NearElements {
    list: Option<Rc<[[usize; 2]]>>,
    /// Lower bound for all others.
    others: f64,
}

impl NearElements {
    /// Nothing is known.
    pub(super) const ALL: Self = Self {
        list: None,
        others: f64::INFINITY,
    };

    fn has(&self, pair: &[usize; 2]) -> bool {
        self.list.as_ref().is_none_or(|list| list.contains(pair))
    }
}

impl Segment {
    /// A whole interval about which nothing is known.
    pub(super) fn whole(stretch: usize) -> Self {
        Self::part(stretch, 0.0, 1.0)
    }

    /// A part of an interval.
    pub(super) fn part(stretch: usize, middle: f64, half: f64) -> Self {
        Self {
            stretch,
            middle,
            half,
            ends: f64::NEG_INFINITY,
            known: f64::NEG_INFINITY,
            near: NearElements::ALL,
        }
    }

    /// Where it begins and ends on its stretch.
    pub(super) fn ends_of(&self) -> [f64; 2] {
        [self.middle - self.half, self.middle + self.half]
    }
}

/// What is asked of a look at a piece.
#[derive(Clone, Copy)]
pub(super) struct LookGoal {
    /// The distance that all of the piece is to keep, ...
    pub(super) asked: f64,
    /// ... and one that only pairs of elements that keep it, too, need not reach again.
    pub(super) kept: f64,
    /// What is wanted where the goal is missed.
    pub(super) missed: Missed,
}

/// What a look tells of a piece that misses its goal.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Missed {
    /// The bound.
    Bound,
    /// The distance in the middle; the bound is less sharp.
    Distance,
    /// Neither: of bodies that overlap the distance is a rough one, below the true one.
    Nothing,
}

/// The bound found for a part.
pub(super) struct BoundGoal {
    /// The goal of the search.
    pub(super) asked: f64,
    /// No distance of the piece is lower.
    pub(super) lowest: f64,
    /// No pose of the motion in the middle of the piece is farther apart than this.
    pub(super) middle: f64,
    /// The same if the distances in the middle had missed nothing: what shorter pieces can reach at best.
    pub(super) at_best: f64,
    /// Narrower bounds of the motion would help more than shorter pieces.
    pub(super) is_blurred: bool,
    pub(super) near: NearElements,
}

impl BoundGoal {
    /// For a part that is not examined.
    pub(super) fn known_of(piece: &Segment) -> Self {
        Self::reached(f64::NEG_INFINITY, piece.known, piece)
    }

    /// The bound without examining elements, if it reaches the goal.
    fn reached(asked: f64, lowest: f64, piece: &Segment) -> Self {
        Self {
            asked,
            lowest,
            middle: f64::INFINITY,
            at_best: lowest,
            is_blurred: false,
            near: piece.near.clone(),
        }
    }

    /// Whether shorter pieces may reach a goal that this one misses.
    pub(super) fn falls_short_of(&self, goal: f64) -> bool {
        self.lowest < goal && self.at_best < goal
    }
}

/// Shared by the searches over all parts of one pair.
pub(super) struct LookMemory {
    columns: usize,
    /// From the first to the second of every pair of elements, where they were nearest when they were last looked at: planes
    /// square to it part most of them for a long time. Zero if not known.
    normals: Vec<DVec3>,
    /// Around the elements of either body, in its frame.
    balls: [Vec<(DVec3, f64)>; 2],
    /// Elements of the second body in the middle of the piece.
    placed: Vec<Option<PlacedElement>>,
    /// What is proved of one joint that places the bodies.
    ranges: Option<ProvedRanges>,
    /// Elements that keep their distance, whatever that joint does.
    round: Vec<Option<RoundPair>>,
    /// The nearest elements of the last look, where the next one begins.
    nearest_pair: Option<[usize; 2]>,
}

/// An element of the second body as the first one sees it, its ball, and how far it moves from there.
struct PlacedElement {
    element: Element,
    ball: (DVec3, f64),
    way: f64,
}

/// The lower of two lower bounds: no number is no bound, which `f64::min` would pass over.
pub(super) fn lower_of(known: f64, bound: f64) -> f64 {
    match bound.is_nan() {
        true => f64::NEG_INFINITY,
        false => known.min(bound),
    }
}

impl PairSweep<'_> {
    /// Nothing is known of any pair of elements.
    pub(super) fn look_memory(&self) -> LookMemory {
        let balls = self
            .hulls
            .map(|hull| hull.elements.iter().map(Element::bounds).collect());
        let [rows, columns] = self.hulls.map(|hull| hull.elements.len());
        LookMemory {
            columns,
            normals: vec![DVec3::ZERO; rows * columns],
            balls,
            placed: (0..columns).map(|_| None).collect(),
            ranges: ProvedRanges::of(&self.chain, self.extent),
            round: round_pairs(&self.chain, self.hulls),
            nearest_pair: None,
        }
    }

    /// Lower bound over a piece, as far as the goal needs it. Pairs of elements are near unless they reach the last goal, too.
    pub(super) fn look(
        &self,
        motion: &ProvedMotion,
        piece: &Segment,
        goals: LookGoal,
        memory: &mut LookMemory,
    ) -> BoundGoal {
        let (goal, last) = (goals.asked, goals.kept);
        let stretch = &motion.stretches[piece.stretch];
        // The pose in the middle, with what the bodies can move within the piece.
        let (arguments, s, half) = (&stretch.arguments, piece.middle, piece.half);
        // Where the one joint between them has been before, that is known.
        let before = memory.ranges.as_ref().filter(|_| stretch.is_certified);
        if let Some(lowest) = before.and_then(|r| r.known(arguments, [s, half], goal)) {
            return BoundGoal::reached(goal, lowest, piece);
        }
        let moved = self.chain.around(arguments, s, half);
        let ball = self.hulls[1].ball;
        let fastest = moved.distance(ball);
        // From both ends, each for the half that is nearer to it.
        let from_ends = piece.ends - fastest - moved.bending(ball) - moved.deviation(ball);
        // Bounding balls; enough for pairs that are far apart.
        let far = self.hulls[0].apart(self.hulls[1], &moved.pose) - fastest;
        let lowest = from_ends.max(far);
        if lowest >= goal {
            return BoundGoal::reached(goal, lowest, piece);
        }
        // Element by element: only those that could come below `last` are kept for the halves.
        let back = self.back.as_ref().map(|b| b.around(arguments, s, half));
        let mut others = piece.near.others;
        let (mut lowest, mut nearest, mut at_best) = (others, f64::INFINITY, others);
        let mut left: Vec<[usize; 2]> = Vec::new();
        let LookMemory {
            columns,
            normals,
            balls,
            placed,
            ranges,
            round,
            nearest_pair,
        } = memory;
        let begin = nearest_pair.filter(|pair| piece.near.has(pair));
        placed.iter_mut().for_each(|placed| *placed = None);
        let mut visit = |[i, j]: [usize; 2]| {
            if self.left_out.contains(&[i, j]) {
                return;
            }
            let first = &self.hulls[0].elements[i];
            let mine = &self.hulls[1].elements[j];
            let PlacedElement {
                element: second,
                ball,
                way,
            } = placed[j].get_or_insert_with(|| {
                let (centre, radius) = balls[1][j];
                PlacedElement {
                    element: mine.moved(&moved.pose),
                    ball: (moved.pose.transform_point(centre), radius),
                    way: moved.distance(balls[1][j]),
                }
            });
            let place = i * *columns + j;
            if let Some(Some(pair)) = round.get_mut(place) {
                let found = *pair
                    .found
                    .get_or_insert_with(|| signed_distance(first, second));
                let low = found.lowest() - pair.wobble;
                at_best = lower_of(at_best, low + found.missed);
                nearest = nearest.min(found.distance);
                lowest = lower_of(lowest, low);
                match low < last {
                    true => left.push([i, j]),
                    false => others = others.min(low),
                }
                return;
            }
            let way = match (&back, &mine.core) {
                (Some(back), Primitive::HalfSpace(_)) => back.distance(balls[0][i]),
                _ => *way,
            };
            // What is cheap comes first: the balls, the plane that parted them before, one's ball from the other.
            let normal = &mut normals[place];
            let (centre, radius) = balls[0][i];
            let mut far = centre.distance(ball.0) - radius - ball.1 - way;
            if far < goal && *normal != DVec3::ZERO {
                far = far.max(separation_along(first, second, *normal) - way);
            }
            if far < goal {
                let pair = [(first, balls[0][i]), (&*second, *ball)];
                far = far.max(ball_separation(pair, goal + way) - way);
            }
            if far < goal {
                let parts = in_parts([first, second, mine], &moved, goal);
                far = parts.map_or(far, |low| far.max(low));
            }
            if far >= goal {
                lowest = lower_of(lowest, far);
                at_best = lower_of(at_best, far);
                match far < last {
                    true => left.push([i, j]),
                    false => others = others.min(far),
                }
                return;
            }
            // Once the goal is missed, only what comes nearer in the middle may count.
            let limit = match goals.missed {
                Missed::Nothing => f64::NEG_INFINITY,
                Missed::Distance if lowest < goal => nearest,
                _ => f64::INFINITY,
            };
            let mut found = signed_distance_below(first, second, limit);
            if found.distance >= limit {
                if found.distance < goal || lowest < goal {
                    nearest = nearest.min(found.distance);
                    lowest = lower_of(lowest, found.lowest() - way);
                    at_best = lower_of(at_best, found.distance - way);
                    left.push([i, j]);
                    return;
                }
                // A rough depth is no ground for a bound.
                if found.distance <= -(first.radius + second.radius) {
                    found = signed_distance(first, second);
                }
            }
            // The distance in the middle, and a bound of the second order over the piece.
            let missed = found.missed;
            let meeting = Meeting::with(found, [first, second, mine], &moved);
            if meeting.found.distance < nearest {
                (nearest, *nearest_pair) = (meeting.found.distance, Some([i, j]));
            }
            *normal = meeting.found.normal;
            let below = match (&back, &mine.core) {
                (Some(back), Primitive::HalfSpace(_)) => {
                    Meeting::new(mine, &first.moved(&back.pose), first, back).below([goal, last])
                }
                _ => meeting.below([goal, last]),
            };
            // Where a mesh is met nothing is known of the depth.
            let below = match self.meets([i, j], meeting.found.distance) {
                true => self.deepest(),
                false => below,
            };
            lowest = lower_of(lowest, below);
            at_best = lower_of(at_best, below + missed);
            left.push([i, j]);
        };
        begin.into_iter().for_each(&mut visit);
        let mut visit_other = |pair| match begin == Some(pair) {
            true => {}
            false => visit(pair),
        };
        match &piece.near.list {
            Some(near) => near.iter().for_each(|pair| visit_other(*pair)),
            None => {
                for i in 0..self.hulls[0].elements.len() {
                    (0..self.hulls[1].elements.len()).for_each(|j| visit_other([i, j]));
                }
            }
        }
        let is_proved = lowest >= goal && stretch.is_certified;
        if let Some(ranges) = ranges.as_mut().filter(|_| is_proved) {
            ranges.prove(arguments, [s, half], lowest);
        }
        let blur = self.chain.blur(arguments, s, ball);
        BoundGoal {
            asked: goal,
            lowest,
            middle: nearest + blur,
            at_best,
            // No number is no bound of the motion.
            is_blurred: blur.is_nan() || nearest - 2.0 * blur < goal,
            near: NearElements {
                list: Some(left.into()),
                others,
            },
        }
    }
}
