//! A plane that separates two hulls during a short motion, and the gap at it.

use super::look::lower_of;
use glam::DVec3;

/// Maximum number of halvings of the time before the gap counts as known: each reduces the loss to a quarter.
const HALVINGS: u32 = 4;

/// A bound along a direction n + u t for two hulls, from their support functions only.
///
/// The points x of b are at x + u X + u² Y. In the minimum of (n + u t) · (x + u X + u² Y) over all x, minus the support of a
/// along n + u t and both radii times its length, the terms up to u² are a concave function of u and w = u². The curve
/// (u, u²) between p and q lies in the hull of its end points and of (p/2 + q/2, p q), where the tangents meet. The
/// function is therefore at least the smallest of its values at these three points. With D the distance in the middle, or any
/// other nonnegative number, D u² t²/2 is subtracted first, since the length of n + u t grows by no more: a gap
/// of D remains a gap of D.
pub(super) struct Slab {
    /// n.
    pub(super) normal: DVec3,
    /// t.
    pub(super) turn: DVec3,
    /// Along n + u t the points x of b are n + u `first` + w `second` high, ...
    pub(super) first: DVec3,
    /// ... in these directions, ...
    pub(super) second: DVec3,
    /// ... plus the same for all of them: times u, ...
    pub(super) across: f64,
    /// ... and times w.
    pub(super) bend: f64,
    /// Both radii.
    pub(super) radii: f64,
    /// The largest gap that is claimed: D.
    pub(super) most: f64,
    /// Bound on the neglected terms.
    pub(super) lost: f64,
}

impl Slab {
    /// Lower bound of the distance of two hulls, from the sum of their supports in two directions. The time is halved
    /// while the bound may still reach `goal`.
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
    let lower_end = lower_of(ends[0], ends[1]);
    let lowest = lower_of(lower_end, value(middle, from * to)?);
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
        let part = least_on_arc(range, ends, goal, halvings - 1, value)?;
        least = lower_of(least, part);
        if least < goal {
            return Some(lowest);
        }
    }
    Some(least)
}
