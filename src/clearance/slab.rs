//! A plane between two hulls that move for a short time, and the gap that it leaves.

use glam::DVec3;

/// How often the time is halved at most before the gap counts as it is known: each time what is lost falls to a quarter.
const HALVINGS: u32 = 4;

/// A bound along a direction n + u t for two hulls of which only their supports are needed.
///
/// The points x of b are at x + u X + u² Y. Of the least of (n + u t) · (x + u X + u² Y) over all x, less what a reaches
/// along n + u t and less both radii times its length, the terms up to u² are a concave function of u and w = u². The curve
/// (u, u²) lies between p and q in the hull of its points there and of (p/2 + q/2, p q), where its tangents meet, so that the
/// function is nowhere less than the least of its values at these three. With D the distance in the middle, or any other
/// that is not below zero, D u² t²/2 is taken off before, because the length of n + u t grows by no more than that: a gap
/// of D along it stays one.
pub(super) struct Slab {
    /// n.
    pub(super) normal: DVec3,
    /// t.
    pub(super) turn: DVec3,
    /// Along n + u t the points x of b are n + u `first` + w `second` high, ...
    pub(super) first: DVec3,
    /// ... in these directions, ...
    pub(super) second: DVec3,
    /// ... and what is the same for all of them comes to it: times u, ...
    pub(super) across: f64,
    /// ... and times w.
    pub(super) bend: f64,
    /// Both radii.
    pub(super) radii: f64,
    /// No gap is said to be larger: D.
    pub(super) most: f64,
    /// What the terms that are left out may take away.
    pub(super) lost: f64,
}

impl Slab {
    /// Lower bound of the distance of two hulls, whose supports are given in two directions together. It is looked at more
    /// closely as long as it may reach `goal`.
    pub(super) fn gap(
        &self,
        goal: f64,
        supports: impl Fn([DVec3; 2]) -> Option<f64>,
    ) -> Option<f64> {
        let value = |u: f64, w: f64| {
            // The plane turns with time; both hulls are seen along it, each from its own side.
            let plane = self.normal + self.turn * u;
            let directions = [plane, -(self.normal + self.first * u + self.second * w)];
            let rest = u * self.across + w * self.bend - self.radii * plane.length();
            Some(rest - supports(directions)?)
        };
        let goal = match self.most - self.lost >= goal {
            true => goal + self.lost,
            false => f64::INFINITY,
        };
        let ends = [value(-1.0, 1.0)?, value(1.0, 1.0)?];
        let gap = least_on_arc([-1.0, 1.0], ends, goal, HALVINGS, &value)?;
        Some(gap.min(self.most) - self.lost)
    }
}

/// Lower bound of a concave function of (u, u²) between two places where its values are known.
fn least_on_arc(
    [from, to]: [f64; 2],
    ends: [f64; 2],
    goal: f64,
    halvings: u32,
    value: &impl Fn(f64, f64) -> Option<f64>,
) -> Option<f64> {
    let middle = 0.5 * (from + to);
    let lower_end = ends[0].min(ends[1]);
    let lowest = lower_end.min(value(middle, from * to)?);
    // The ends are values of the curve itself: where they are too low nothing can be gained.
    if lowest >= goal || lower_end < goal || halvings == 0 {
        return Some(lowest);
    }
    let there = value(middle, middle * middle)?;
    if there < goal {
        return Some(lowest);
    }
    let halves = [
        ([from, middle], [ends[0], there]),
        ([middle, to], [there, ends[1]]),
    ];
    let mut least = f64::INFINITY;
    for (range, ends) in halves {
        least = least.min(least_on_arc(range, ends, goal, halvings - 1, value)?);
        if least < goal {
            return Some(lowest);
        }
    }
    Some(least)
}
