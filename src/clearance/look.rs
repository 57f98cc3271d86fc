//! A part of a time interval, what is asked of a look at it, what the look tells, and what is kept for the next one.

use super::one_joint::{ProvedRanges, RoundPair, round_pairs};
use super::sweep::PairSweep;
use crate::distance::primitive::Element;
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
    pub(super) list: Option<Rc<[[usize; 2]]>>,
    /// Lower bound for all others.
    pub(super) others: f64,
}

impl NearElements {
    /// Nothing is known.
    pub(super) const ALL: Self = Self {
        list: None,
        others: f64::INFINITY,
    };

    pub(super) fn has(&self, pair: &[usize; 2]) -> bool {
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
    pub(super) fn reached(asked: f64, lowest: f64, piece: &Segment) -> Self {
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
    pub(super) columns: usize,
    /// From the first to the second of every pair of elements, where they were nearest when they were last looked at: planes
    /// square to it part most of them for a long time. Zero if not known.
    pub(super) normals: Vec<DVec3>,
    /// Around the elements of either body, in its frame.
    pub(super) balls: [Vec<(DVec3, f64)>; 2],
    /// Elements of the second body in the middle of the piece.
    pub(super) placed: Vec<Option<PlacedElement>>,
    /// What is proved of one joint that places the bodies.
    pub(super) ranges: Option<ProvedRanges>,
    /// Elements that keep their distance, whatever that joint does.
    pub(super) round: Vec<Option<RoundPair>>,
    /// The nearest elements of the last look, where the next one begins.
    pub(super) nearest_pair: Option<[usize; 2]>,
}

/// An element of the second body as the first one sees it, its ball, and how far it moves from there.
pub(super) struct PlacedElement {
    pub(super) element: Element,
    pub(super) ball: (DVec3, f64),
    pub(super) way: f64,
}

/// The lower of two lower bounds. NaN means that nothing is known, which is a bound of minus infinity; `f64::min` would ignore
/// it.
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
}
