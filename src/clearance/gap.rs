//! Bounds of the distance of two elements while one of them moves for a short time.

use super::core::Element;
use super::pair::Proximity;
use super::relative::RelativeMove;
use glam::DVec3;

/// Lower bound of the distance of two elements while the second one moves; `mine` is that one in its own frame.
pub fn below(
    a: &Element,
    b: &Element,
    mine: &Element,
    found: &Proximity,
    moved: &RelativeMove,
) -> f64 {
    let ball = mine.bounds();
    let plain = found.distance - moved.distance(ball);
    let n = found.normal;
    let apart = found.distance + a.radius + b.radius;
    if apart <= 0.0 || n == DVec3::ZERO {
        return plain;
    }
    // The plane between them stands still, or turns as the line between the nearest points does.
    let point = found.points[1] + n * b.radius;
    let rate = moved.shift + moved.spin.cross(point);
    let turn = (rate - n * n.dot(rate)) / apart;
    let still = gap(a, b, found, moved, DVec3::ZERO);
    let turning = || gap(a, b, found, moved, turn);
    let Some(gap) = still.into_iter().chain(turning()).reduce(f64::max) else {
        return plain;
    };
    let third = turn.length() * moved.bending(ball);
    let length = (1.0 + turn.length_squared()).sqrt();
    plain.max(gap - third - length * moved.deviation(ball))
}

/// Upper bound of the distance of two elements while the second one moves: that of the points that were nearest.
pub fn above(
    a: &Element,
    b: &Element,
    mine: &Element,
    found: &Proximity,
    moved: &RelativeMove,
) -> f64 {
    let [from, to] = [
        found.points[0] - found.normal * a.radius,
        found.points[1] + found.normal * b.radius,
    ];
    let rate = moved.shift + moved.spin.cross(to);
    let linear = (to - from + rate).length().max((to - from - rate).length());
    let ball = mine.bounds();
    linear + moved.bending(ball) + moved.deviation(ball) - a.radius - b.radius
}

/// Lower bound of the gap between two convex hulls along n + u t, of terms up to u².
///
/// The points x of b are at x + u X + u² Y. Of the least of (n + u t) · (x + u X + u² Y) over all x, less what a reaches
/// along n + u t and less both radii times its length, the terms up to u² are a concave function of a curve
/// of second order in u. Such a curve lies in the hull of three control points, so that the function is nowhere less than
/// the least of its values there. With D the distance in the middle, D u² t²/2 is taken off before, because the length of
/// n + u t grows by no more than that: a gap of D along it stays one.
fn gap(a: &Element, b: &Element, found: &Proximity, moved: &RelativeMove, t: DVec3) -> Option<f64> {
    let n = found.normal;
    let first = n.cross(moved.spin) + t;
    let second = moved.twist.transpose() * n + t.cross(moved.spin);
    let (across, bend) = (
        n.dot(moved.shift),
        n.dot(moved.bend) + t.dot(moved.shift) - 0.5 * found.distance.max(0.0) * t.length_squared(),
    );
    let radii = a.radius + b.radius;
    let control = |u: f64, square: f64| {
        let support = b.core.support(-(n + first * u + second * square))?;
        let plane = n + t * u;
        let reached = a.core.support(plane)?;
        Some(u * across + square * bend - support - reached - radii * plane.length())
    };
    let ends = control(-1.0, 1.0)?.min(control(1.0, 1.0)?);
    Some(ends.min(control(0.0, -1.0)?).min(found.distance))
}
