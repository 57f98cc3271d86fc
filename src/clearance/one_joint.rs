//! Two bodies whose relative position depends on one joint: a proof for a range of the joint holds whenever the joint is in
//! it, and solids of revolution about the joint's axis keep their distance from the other body.

use super::relative::RelativeChain;
use crate::distance::bodies::BodyElements;
use crate::distance::pair::Proximity;
use crate::distance::primitive::{Element, Primitive};
use crate::kinematics::certificate::tube::TaylorModel;
use crate::math::Pose;
use crate::model::chain::{ChainStep, ElementaryMotion};
use crate::model::walk::walk_chain;
use crate::numbers::rounding::CHAIN_FACTOR;
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// An element counts as round about an axis to within this fraction of the radius of its ball.
const ROUND: f64 = 1e-9;

/// A line: a point of it, and its direction.
type AxisLine = [DVec3; 2];

/// Ranges of a joint with what the distance is not below there.
pub(super) struct ProvedRanges {
    argument: usize,
    /// It turns: whole turns change nothing.
    is_turn: bool,
    /// Length of the chain and the bodies: an angle off by one moves no point farther.
    extent: f64,
    /// From the key of the lower end: both ends, and the bound. No two overlap.
    list: BTreeMap<i64, [f64; 3]>,
}

/// A number as one that is ordered as it is.
fn key(value: f64) -> i64 {
    let bits = value.to_bits() as i64;
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

impl ProvedRanges {
    /// Of a chain whose joints all move by one argument.
    pub(super) fn of(chain: &RelativeChain, extent: f64) -> Option<Self> {
        let mut arguments = chain.arguments();
        let argument = arguments.next()?;
        let turns = |step: &ChainStep| {
            step.joint()
                .is_none_or(|joint| joint.motion == ElementaryMotion::Rotation)
        };
        arguments.all(|other| other == argument).then(|| Self {
            argument,
            is_turn: chain.steps().iter().all(turns),
            extent,
            list: BTreeMap::new(),
        })
    }

    /// Where the joint is around the place `s` of a stretch: the range that it surely passes, by as much more as its bound
    /// allows, and all that it may pass.
    fn ranges(&self, arguments: &[TaylorModel], s: f64, half: f64) -> Option<[[f64; 2]; 2]> {
        let at = arguments[self.argument].around(s, half);
        let ends = [at.value + at.bend - at.way, at.value + at.bend + at.way];
        let passed = [ends[0].min(ends[1]) - at.off, ends[0].max(ends[1]) + at.off];
        // Rounding of the value, of its remainder after whole turns, and of sums of both.
        let off = at.off + CHAIN_FACTOR * (1.0 + at.value.abs());
        // A parabola exceeds the range of its ends by at most its second-order term.
        let bend = at.bend.abs();
        let all = [
            passed[0].min(passed[1]) - bend - off,
            passed[1] + bend + off,
        ];
        all.iter().all(|v| v.is_finite()).then_some([passed, all])
    }

    /// The same range within the first turn and the second one.
    fn reduced(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        match self.is_turn {
            true if high - low >= TAU => [0.0, TAU],
            true => {
                let first = low.rem_euclid(TAU);
                [first, first + (high - low)]
            }
            false => [low, high],
        }
    }

    /// A bound over a piece that is as high as the goal, if one is proved.
    pub(super) fn known(
        &self,
        arguments: &[TaylorModel],
        [s, half]: [f64; 2],
        goal: f64,
    ) -> Option<f64> {
        if self.list.is_empty() {
            return None;
        }
        let [_, all] = self.ranges(arguments, s, half)?;
        let [low, high] = self.reduced(all);
        // A range across the full turn is looked up in two parts.
        match self.is_turn && high > TAU {
            true => {
                let first = self.covered([low, TAU], goal)?;
                Some(first.min(self.covered([0.0, high - TAU], goal)?))
            }
            false => self.covered([low, high], goal),
        }
    }

    /// The lowest bound of the ranges that cover this one, if all of them are as high as the goal.
    fn covered(&self, [low, high]: [f64; 2], goal: f64) -> Option<f64> {
        let (mut at, mut least) = (low, f64::INFINITY);
        loop {
            // The range that begins last before the place.
            let (_, &[_, end, bound]) = self.list.range(..=key(at)).next_back()?;
            if end < at || bound < goal || (end == at && at < high) {
                return None;
            }
            least = least.min(bound);
            if end >= high {
                return Some(least);
            }
            at = end;
        }
    }

    /// Keeps what was proved of a piece.
    pub(super) fn prove(&mut self, arguments: &[TaylorModel], [s, half]: [f64; 2], bound: f64) {
        let Some([passed, _]) = self.ranges(arguments, s, half) else {
            return;
        };
        let value = passed[0].abs().max(passed[1].abs());
        // Rounding of the range displaces the points.
        let off = CHAIN_FACTOR * (1.0 + value);
        let bound = bound - 4.0 * off * if self.is_turn { self.extent } else { 1.0 };
        let [low, high] = self.reduced([passed[0] - off, passed[1] + off]);
        if self.is_turn && high > TAU {
            self.insert([low, TAU], bound);
            self.insert([0.0, high - TAU], bound);
        } else {
            self.insert([low, high], bound);
        }
    }

    /// Takes a range in where nothing better is known.
    fn insert(&mut self, [low, high]: [f64; 2], bound: f64) {
        // All ranges that overlap the new one; at most one begins before it.
        let before = self.list.range(..key(low)).next_back();
        let before = before.map(|(_, range)| *range).filter(|r| r[1] > low);
        let within = self.list.range(key(low)..key(high)).map(|(_, r)| *r);
        let met: Vec<[f64; 3]> = before.into_iter().chain(within).collect();
        // From the lower end up: `at` is the first place that may still need the new bound.
        let mut at = low;
        for [start, end, known] in met {
            // A better bound stays, and the new one fills the space before it.
            if known >= bound {
                if start > at {
                    self.list.insert(key(at), [at, start, bound]);
                }
                at = at.max(end);
                continue;
            }
            // A worse one keeps only what lies outside the new range.
            self.list.remove(&key(start));
            if start < low {
                self.list.insert(key(start), [start, low, known]);
            }
            if end > high {
                self.list.insert(key(high), [high, end, known]);
            }
        }
        if at < high {
            self.list.insert(key(at), [at, high, bound]);
        }
    }
}

/// The axis of the only joint between two bodies, if it turns, as each of them sees it.
fn axis_of(chain: &RelativeChain) -> Option<[AxisLine; 2]> {
    let place = chain.steps().iter().position(|s| s.joint().is_some())?;
    let joint = chain.steps()[place].joint()?;
    if chain.joints() != 1 || joint.motion != ElementaryMotion::Rotation {
        return None;
    }
    let part = |steps: &[ChainStep]| {
        let mut pose = Pose::IDENTITY;
        walk_chain(steps, &mut pose, &[], |_, _| {});
        pose
    };
    let [before, after] = [
        part(&chain.steps()[..place]),
        part(&chain.steps()[place + 1..]).inverse(),
    ];
    Some([before, after].map(|pose| [pose.translation, pose.rotation.col(joint.axis)]))
}

/// How far a turn about a line can move the surface of an element; `None` if it is not round about it.
fn wobble(element: &Element, [origin, direction]: AxisLine) -> Option<f64> {
    let (axis, ends, radius) = match &element.core {
        Primitive::Point(p) => (None, [*p; 2], 0.0),
        Primitive::Segment([a, b]) => ((*b - *a).try_normalize(), [*a, *b], 0.0),
        Primitive::Frustum(f) => {
            let [from, to] = f.spine();
            (Some(f.axis), [from, to], f.radii[0].max(f.radii[1]))
        }
        Primitive::Circle(c) => (Some(c.axis), [c.centre; 2], c.radius),
        _ => return None,
    };
    let off_axis = |p: DVec3| {
        let arm = p - origin;
        (arm - direction * arm.dot(direction)).length()
    };
    let tilted = axis.map_or(0.0, |axis| axis.cross(direction).length());
    let off = 2.0 * (off_axis(ends[0]).max(off_axis(ends[1])) + tilted * radius);
    (off <= ROUND * element.bounds().1).then_some(off)
}

/// A pair of elements, one of which is a solid of revolution about the joint's axis.
#[derive(Clone, Copy)]
pub(super) struct RoundPair {
    /// Their distance is the same at all times but for this.
    pub(super) wobble: f64,
    /// Where they are nearest, once it was asked for.
    pub(super) found: Option<Proximity>,
}

/// Of every pair of elements, row by row, what is known of its roundness; nothing where no two elements are known to keep their
/// distance.
pub(super) fn round_pairs(
    chain: &RelativeChain,
    hulls: [&BodyElements; 2],
) -> Vec<Option<RoundPair>> {
    let Some(axes) = axis_of(chain) else {
        return Vec::new();
    };
    let of = |side: usize| -> Vec<Option<f64>> {
        let elements = hulls[side].elements.iter();
        elements.map(|e| wobble(e, axes[side])).collect()
    };
    let [first, second] = [of(0), of(1)];
    let pair = |a: Option<f64>, b: Option<f64>| {
        let wobble = match (a, b) {
            (Some(a), Some(b)) => a.min(b),
            (a, b) => a.or(b)?,
        };
        Some(RoundPair {
            wobble,
            found: None,
        })
    };
    let rows = first.iter();
    rows.flat_map(|a| second.iter().map(|b| pair(*a, *b)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ranges(is_turn: bool) -> ProvedRanges {
        ProvedRanges {
            argument: 0,
            is_turn,
            extent: 1.0,
            list: BTreeMap::new(),
        }
    }

    /// A joint that goes from one value to another one.
    fn way(from: f64, to: f64) -> [TaylorModel; 1] {
        let mut model = TaylorModel::constant(0.5 * (from + to));
        model.c[1] = 0.5 * (to - from);
        [model]
    }

    #[test]
    fn what_is_proved_holds_wherever_the_joint_comes_back_to() {
        let mut known = ranges(true);
        for k in 0..8 {
            let from = 0.25 * f64::from(k) * TAU / 2.0 - 1.0;
            known.prove(&way(from, from + TAU / 8.0), [0.0, 1.0], f64::from(k));
        }
        // All of the turn, many turns later, forth and back.
        for (from, to) in [(0.1, 6.0), (40.0, 43.0), (-20.0, -23.0), (100.0, 107.0)] {
            let found = known.known(&way(from, to), [0.0, 1.0], -1.0);
            assert!(found.is_some_and(|b| b > -0.1), "{from} {to}: {found:?}");
            assert_eq!(known.known(&way(from, to), [0.0, 1.0], 8.0), None);
        }
        // A part of it that keeps more; a part of a piece.
        let found = known.known(&way(3.8, 4.0), [0.0, 1.0], 5.5);
        assert!(found.is_some_and(|b| (b - 6.0).abs() < 1e-12), "{found:?}");
        assert!(known.known(&way(2.0, 4.0), [0.95, 0.04], 5.5).is_some());
        // What slides does not come back.
        let mut slider = ranges(false);
        slider.prove(&way(-1.0, 1.0), [0.0, 1.0], 2.0);
        slider.prove(&way(1.0, 3.0), [0.0, 1.0], 1.0);
        assert_eq!(slider.known(&way(7.0, 8.0), [0.0, 1.0], 0.0), None);
        assert!(slider.known(&way(-0.9, 2.9), [0.0, 1.0], 0.9).is_some());
        assert_eq!(slider.known(&way(-0.9, 3.1), [0.0, 1.0], 0.9), None);
        assert_eq!(slider.known(&way(-0.9, 2.9), [0.0, 1.0], 1.5), None);
    }

    #[test]
    fn a_better_bound_replaces_a_worse_one_where_it_holds() {
        let mut known = ranges(false);
        for (from, to, bound) in [(0.0, 10.0, 1.0), (2.0, 4.0, 3.0), (3.0, 6.0, 2.0)] {
            known.insert([from, to], bound);
        }
        for (at, bound) in [(1.0, 1.0), (2.5, 3.0), (3.5, 3.0), (5.0, 2.0), (8.0, 1.0)] {
            assert_eq!(known.covered([at, at + 0.1], 0.0), Some(bound), "{at}");
        }
        assert_eq!(known.covered([0.0, 10.0], 0.0), Some(1.0));
        assert_eq!(known.covered([2.0, 6.0], 1.5), Some(2.0));
    }
}
