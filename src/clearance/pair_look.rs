//! Lower bound of the distance of two bodies over a part of a time interval, element by element.

use super::look::{
    BoundGoal, LookGoal, LookMemory, Missed, NearElements, PlacedElement, Segment, lower_of,
};
use super::meeting::Meeting;
use super::motion::ProvedMotion;
use super::near_part::in_parts;
use super::one_joint::RoundPair;
use super::relative::RelativeMove;
use super::sweep::PairSweep;
use crate::distance::bodies::{ball_separation, separation_along};
use crate::distance::pair::{Proximity, signed_distance, signed_distance_below};
use crate::distance::primitive::{Element, Primitive};
use glam::DVec3;

/// A look at the elements of two bodies: what it works with, and what it has found so far.
struct PairLook<'l> {
    sweep: &'l PairSweep<'l>,
    goals: LookGoal,
    /// How the second body moves as seen from the first, and the other way round.
    moved: &'l RelativeMove,
    back: Option<RelativeMove>,
    /// What other looks have left.
    balls: &'l [Vec<(DVec3, f64)>; 2],
    normals: &'l mut [DVec3],
    round: &'l mut [Option<RoundPair>],
    nearest_pair: &'l mut Option<[usize; 2]>,
    /// No distance is lower, ...
    lowest: f64,
    /// ... and none would be if the distances in the middle had missed nothing.
    at_best: f64,
    /// The least distance in the middle.
    nearest: f64,
    /// Pairs that come below the last goal, and a lower bound for all others.
    left: Vec<[usize; 2]>,
    others: f64,
}

/// Two elements, the second of which moves by `way` at most.
struct ElementPair<'e> {
    index: [usize; 2],
    /// Its place in the lists of all pairs.
    place: usize,
    first: &'e Element,
    /// The other one in the middle, and in its own frame.
    second: &'e Element,
    mine: &'e Element,
    balls: [(DVec3, f64); 2],
    way: f64,
}

impl PairSweep<'_> {
    /// Lower bound over a piece, as far as the goal needs it. Pairs of elements are near unless they reach the last goal, too.
    pub(super) fn look(
        &self,
        motion: &ProvedMotion,
        piece: &Segment,
        goals: LookGoal,
        memory: &mut LookMemory,
    ) -> BoundGoal {
        let goal = goals.asked;
        let stretch = &motion.stretches[piece.stretch];
        // The pose in the middle, with what the bodies can move within the piece.
        let (arguments, s, half) = (&stretch.arguments, piece.middle, piece.half);
        // Where the one joint between them has been before, that is known.
        let before = memory.ranges.as_ref().filter(|_| stretch.is_certified);
        if let Some(lowest) = before.and_then(|r| r.known(arguments, [s, half], goal)) {
            return BoundGoal::reached(goal, lowest, piece);
        }
        let moved = self.chain.around(arguments, s, half);
        let lowest = self.without_elements(&moved, piece.ends);
        if lowest >= goal {
            return BoundGoal::reached(goal, lowest, piece);
        }
        let back = self.back.as_ref().map(|b| b.around(arguments, s, half));
        let blur = self.chain.blur(arguments, s, self.hulls[1].ball);
        let found = self.by_elements((&moved, back), &piece.near, goals, memory);
        let found = found.told(goal, blur);
        let is_proved = found.lowest >= goal && stretch.is_certified;
        if let Some(ranges) = memory.ranges.as_mut().filter(|_| is_proved) {
            ranges.prove(arguments, [s, half], found.lowest);
        }
        found
    }

    /// Lower bound from the distance at both ends of a piece, and from the balls around the bodies: enough for pairs that are
    /// far apart.
    fn without_elements(&self, moved: &RelativeMove, ends: f64) -> f64 {
        let ball = self.hulls[1].ball;
        let fastest = moved.distance(ball);
        // From both ends, each for the half that is nearer to it.
        let from_ends = ends - fastest - moved.bending(ball) - moved.deviation(ball);
        let far = self.hulls[0].apart(self.hulls[1], &moved.pose) - fastest;
        from_ends.max(far)
    }

    /// Looks at all pairs of elements that may be near, beginning with the one that was nearest before.
    fn by_elements<'l>(
        &'l self,
        (moved, back): (&'l RelativeMove, Option<RelativeMove>),
        near: &NearElements,
        goals: LookGoal,
        memory: &'l mut LookMemory,
    ) -> PairLook<'l> {
        let LookMemory {
            columns,
            normals,
            balls,
            placed,
            round,
            nearest_pair,
            ..
        } = memory;
        let columns = *columns;
        let begin = nearest_pair.filter(|pair| near.has(pair));
        placed.iter_mut().for_each(|placed| *placed = None);
        let mut look = PairLook {
            sweep: self,
            goals,
            moved,
            back,
            balls,
            normals,
            round,
            nearest_pair,
            lowest: near.others,
            at_best: near.others,
            nearest: f64::INFINITY,
            left: Vec::new(),
            others: near.others,
        };
        let mut visit = |[i, j]: [usize; 2]| look.visit([i, j], i * columns + j, &mut placed[j]);
        begin.into_iter().for_each(&mut visit);
        let mut visit_other = |pair| match begin == Some(pair) {
            true => {}
            false => visit(pair),
        };
        match &near.list {
            Some(near) => near.iter().for_each(|pair| visit_other(*pair)),
            None => {
                for i in 0..self.hulls[0].elements.len() {
                    (0..columns).for_each(|j| visit_other([i, j]));
                }
            }
        }
        look
    }
}

impl PairLook<'_> {
    /// Looks at one pair: what is cheap comes first.
    fn visit(&mut self, index: [usize; 2], place: usize, placed: &mut Option<PlacedElement>) {
        let (sweep, [i, j]) = (self.sweep, index);
        if sweep.left_out.contains(&index) {
            return;
        }
        let first = &sweep.hulls[0].elements[i];
        let mine = &sweep.hulls[1].elements[j];
        let placed = placed.get_or_insert_with(|| self.placed(mine, self.balls[1][j]));
        let mut pair = ElementPair {
            index,
            place,
            first,
            second: &placed.element,
            mine,
            balls: [self.balls[0][i], placed.ball],
            way: placed.way,
        };
        if self.keeps_distance(&pair) {
            return;
        }
        if let Some(back) = self.back_of(mine) {
            pair.way = back.distance(self.balls[0][i]);
        }
        let far = self.cheap_bound(&pair);
        if far >= self.goals.asked {
            self.note(index, [far, far], far < self.goals.kept);
            return;
        }
        if let Some(found) = self.measured(&pair) {
            self.bound_from(&pair, found);
        }
    }

    /// An element of the second body in the middle of the piece.
    fn placed(&self, mine: &Element, ball: (DVec3, f64)) -> PlacedElement {
        PlacedElement {
            element: mine.moved(&self.moved.pose),
            ball: (self.moved.pose.transform_point(ball.0), ball.1),
            way: self.moved.distance(ball),
        }
    }

    /// How the first body moves as seen from an element of the second one that has no end.
    fn back_of(&self, mine: &Element) -> Option<&RelativeMove> {
        let back = self.back.as_ref();
        back.filter(|_| matches!(mine.core, Primitive::HalfSpace(_)))
    }

    /// Notes two lower bounds of a pair: that of its distance, and the best that shorter pieces can reach.
    fn note(&mut self, index: [usize; 2], [low, at_best]: [f64; 2], is_near: bool) {
        self.lowest = lower_of(self.lowest, low);
        self.at_best = lower_of(self.at_best, at_best);
        match is_near {
            true => self.left.push(index),
            false => self.others = self.others.min(low),
        }
    }

    /// Whether a pair keeps its distance, whatever the joint does; it is noted then.
    fn keeps_distance(&mut self, pair: &ElementPair) -> bool {
        let Some(Some(round)) = self.round.get_mut(pair.place) else {
            return false;
        };
        let measure = || signed_distance(pair.first, pair.second);
        let found = *round.found.get_or_insert_with(measure);
        let low = found.lowest() - round.wobble;
        self.nearest = self.nearest.min(found.distance);
        self.note(pair.index, [low, low + found.missed], low < self.goals.kept);
        true
    }

    /// A lower bound, as far as the goal needs it: from the balls, the plane that parted the pair before, one's ball from the
    /// other, parts of a rod.
    fn cheap_bound(&self, pair: &ElementPair) -> f64 {
        let (goal, way) = (self.goals.asked, pair.way);
        let [(centre, radius), ball] = pair.balls;
        let normal = self.normals[pair.place];
        let mut far = centre.distance(ball.0) - radius - ball.1 - way;
        if far < goal && normal != DVec3::ZERO {
            far = far.max(separation_along(pair.first, pair.second, normal) - way);
        }
        if far < goal {
            let spheres = [(pair.first, pair.balls[0]), (pair.second, ball)];
            far = far.max(ball_separation(spheres, goal + way) - way);
        }
        if far < goal {
            let parts = in_parts([pair.first, pair.second, pair.mine], self.moved, goal);
            far = parts.map_or(far, |low| far.max(low));
        }
        far
    }

    /// The distance in the middle; `None` if less than that was needed and is noted.
    fn measured(&mut self, pair: &ElementPair) -> Option<Proximity> {
        let goal = self.goals.asked;
        // Once the goal is missed, only what comes nearer in the middle may count.
        let limit = match self.goals.missed {
            Missed::Nothing => f64::NEG_INFINITY,
            Missed::Distance if self.lowest < goal => self.nearest,
            _ => f64::INFINITY,
        };
        let found = signed_distance_below(pair.first, pair.second, limit);
        if found.distance >= limit {
            if found.distance < goal || self.lowest < goal {
                self.nearest = self.nearest.min(found.distance);
                let bounds = [found.lowest() - pair.way, found.distance - pair.way];
                self.note(pair.index, bounds, true);
                return None;
            }
            // A rough depth is no ground for a bound.
            if found.distance <= -(pair.first.radius + pair.second.radius) {
                return Some(signed_distance(pair.first, pair.second));
            }
        }
        Some(found)
    }

    /// Notes the distance in the middle, and a bound of the second order over the piece.
    fn bound_from(&mut self, pair: &ElementPair, found: Proximity) {
        let goals = [self.goals.asked, self.goals.kept];
        let ElementPair {
            first,
            second,
            mine,
            ..
        } = *pair;
        if found.distance < self.nearest {
            (self.nearest, *self.nearest_pair) = (found.distance, Some(pair.index));
        }
        self.normals[pair.place] = found.normal;
        // Where a mesh is met nothing is known of the depth.
        let below = if self.sweep.meets(pair.index, found.distance) {
            self.sweep.deepest()
        } else if let Some(back) = self.back_of(mine) {
            Meeting::new(mine, &first.moved(&back.pose), first, back).below(goals)
        } else {
            Meeting::with(found, [first, second, mine], self.moved).below(goals)
        };
        self.note(pair.index, [below, below + found.missed], true);
    }

    /// What the look tells; no bound of the motion is narrower than `blur`.
    fn told(self, goal: f64, blur: f64) -> BoundGoal {
        BoundGoal {
            asked: goal,
            lowest: self.lowest,
            middle: self.nearest + blur,
            at_best: self.at_best,
            // No number is no bound of the motion.
            is_blurred: blur.is_nan() || self.nearest - 2.0 * blur < goal,
            near: NearElements {
                list: Some(self.left.into()),
                others: self.others,
            },
        }
    }
}
