//! Least values of functions of one variable whose slope is known: convex ones, and all others by bracketing with a
//! bound of the slope.

use crate::math::sin_cos;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::OnceLock;

/// A place with the function's value and slope.
#[derive(Clone, Copy, Debug, Default)]
pub struct CurveSpot {
    /// The variable.
    pub at: f64,
    /// The value.
    pub value: f64,
    /// The derivative.
    pub slope: f64,
}

/// Most evaluations of one root search: bisection, every fourth of them, needs 53 to exhaust f64.
const MAX_STEPS: usize = 220;

/// How much less than the value feels is left down a parabola, so that the place is known well, too: a thousandth of the
/// distance that the value can tell.
const NEARER: f64 = 1e-6;

/// Steps after which the bracket must be half as wide.
const PATIENCE: usize = 4;

/// Values that differ by more than this part of the first ones differ indeed, not by rounding.
const TELLS: f64 = 64.0 * f64::EPSILON;

/// A slope that promises less than this part of the value over the whole bracket promises nothing.
const REMAINS: f64 = 0.1 * f64::EPSILON;

/// Even pieces into which a range is cut first. The squared distance of two circles has at most eight stationary
/// points, four of them minima.
const PIECES: usize = 16;

/// Parts into which pieces are halved that could hide a smaller value.
const FINEST: usize = 128;

/// How often a piece is halved in which a minimum is looked for that is not the least.
const HALVINGS: usize = 7;

/// Least spot of a convex function on [low, high].
pub fn least_convex(low: f64, high: f64, f: impl Fn(f64) -> CurveSpot) -> CurveSpot {
    let (a, b) = (f(low), f(high));
    if a.slope >= 0.0 {
        return a;
    }
    if b.slope <= 0.0 {
        return b;
    }
    refine_valley(a, b, &f)
}

/// How much farther than where the slope seems to vanish is looked for the other side of a minimum.
const BEYOND: f64 = 1.5;

/// The minimum that a function of an angle falls to from `start`, looked for in steps that begin with `step`; `None` if a
/// quarter of a turn does not lead to it.
pub fn least_near(start: f64, step: f64, f: impl Fn(f64) -> CurveSpot) -> Option<CurveSpot> {
    let mut here = f(start);
    let direction = -here.slope.signum();
    let mut step = step;
    while here.slope != 0.0 {
        let next = f(here.at + direction * step);
        if next.slope * direction >= 0.0 {
            let [a, b] = if direction > 0.0 {
                [here, next]
            } else {
                [next, here]
            };
            return Some(refine_valley(a, b, &f));
        }
        // A little beyond where the slope would vanish.
        let vanishes = next.slope * (next.at - here.at) / (here.slope - next.slope);
        step = (BEYOND * vanishes.abs()).clamp(step, 8.0 * step);
        here = next;
        let is_near = (here.at - start).abs() + step <= FRAC_PI_2;
        if !is_near {
            return None;
        }
    }
    Some(here)
}

/// Least spot of any function of an angle over a whole turn whose slope never exceeds `steepest`. The function is given the
/// angle's sine and cosine too.
///
/// Exact when no two minima of very different depth share a piece of 1/128 of the turn that a bound of the slope
/// cannot rule out.
pub fn least_on_circle(steepest: f64, f: impl Fn(f64, (f64, f64)) -> CurveSpot) -> CurveSpot {
    let grid = angle_grid();
    let at = |k: usize| f(TAU * (k as f64 / FINEST as f64), grid[k]);
    least_of(steepest, at, |angle| f(angle, sin_cos(angle)))
}

/// All minima below `limit` of a function of an angle over a whole turn whose slope never exceeds `steepest`, but those
/// that share 1/16384 of the turn with a maximum. The function is given the angle's sine and cosine too.
pub fn minima_on_circle(
    steepest: f64,
    limit: f64,
    f: impl Fn(f64, (f64, f64)) -> CurveSpot,
) -> Vec<CurveSpot> {
    let spot = |k: usize| f(TAU * (k as f64 / FINEST as f64), angle_grid()[k]);
    let spots: Vec<CurveSpot> = (0..=FINEST).map(spot).collect();
    let mut pieces: Vec<[CurveSpot; 2]> = spots.windows(2).map(|two| [two[0], two[1]]).collect();
    let f = |angle: f64| f(angle, sin_cos(angle));
    // Lipschitz: between two spots the value cannot fall below this.
    let hides = |[a, b]: &[CurveSpot; 2]| {
        let lowest = 0.5 * (a.value + b.value - steepest * (b.at - a.at));
        lowest < limit
    };
    pieces.retain(hides);
    for _ in 0..HALVINGS {
        let halves = pieces.into_iter().flat_map(|[a, b]| {
            let middle = f(0.5 * (a.at + b.at));
            [[a, middle], [middle, b]]
        });
        pieces = halves.filter(hides).collect();
    }
    // A slope that changes its sign has a minimum between.
    let dips = pieces
        .into_iter()
        .filter(|[a, b]| a.slope <= 0.0 && b.slope > 0.0);
    dips.map(|[a, b]| perpendicular_foot(a, b, &f)).collect()
}

/// The place between a falling and a rising spot where the slope vanishes. By bisection: next to a least value of zero the
/// values are rounding long before the slopes are.
fn perpendicular_foot(
    mut a: CurveSpot,
    mut b: CurveSpot,
    f: &impl Fn(f64) -> CurveSpot,
) -> CurveSpot {
    loop {
        let spot = f(0.5 * (a.at + b.at));
        if spot.at <= a.at || spot.at >= b.at {
            return spot;
        }
        if spot.slope <= 0.0 {
            a = spot;
        } else {
            b = spot;
        }
    }
}

/// Least spot of any function on [low, high] whose slope never exceeds `steepest`; as exact as
/// [`least_on_circle`].
pub fn least_spot(low: f64, high: f64, steepest: f64, f: impl Fn(f64) -> CurveSpot) -> CurveSpot {
    let at = |k: usize| f(low + (high - low) * (k as f64 / FINEST as f64));
    least_of(steepest, at, &f)
}

/// Sines and cosines of even parts of a turn, both ends included: of all places that halving comes to.
pub fn angle_grid() -> &'static [(f64, f64); FINEST + 1] {
    static GRID: OnceLock<[(f64, f64); FINEST + 1]> = OnceLock::new();
    GRID.get_or_init(|| std::array::from_fn(|k| sin_cos(TAU * (k as f64 / FINEST as f64))))
}

/// The search, with `at` for the places of the grid.
fn least_of(
    steepest: f64,
    at: impl Fn(usize) -> CurveSpot,
    f: impl Fn(f64) -> CurveSpot,
) -> CurveSpot {
    let mut stride = FINEST / PIECES;
    let mut spots: Vec<(usize, CurveSpot)> = Vec::with_capacity(2 * PIECES + 1);
    spots.extend((0..=PIECES).map(|k| (k * stride, at(k * stride))));
    let far = CurveSpot {
        value: f64::INFINITY,
        ..CurveSpot::default()
    };
    let mut best = spots.iter().fold(
        far,
        |best, (_, s)| if s.value < best.value { *s } else { best },
    );
    let hides = |a: &CurveSpot, b: &CurveSpot, best: &CurveSpot| {
        let lowest = 0.5 * (a.value + b.value - steepest * (b.at - a.at));
        lowest < best.value
    };
    while stride > 1 {
        best = find_valleys(&spots, best, &hides, &f);
        stride /= 2;
        let mut finer = Vec::with_capacity(2 * spots.len());
        for pair in spots.windows(2) {
            let [(k, a), (next, b)] = [pair[0], pair[1]];
            finer.push((k, a));
            // Pieces that were not halved before hide nothing.
            if next - k == 2 * stride && hides(&a, &b, &best) {
                finer.push((k + stride, at(k + stride)));
            }
        }
        finer.extend(spots.last());
        if finer.len() == spots.len() {
            return best;
        }
        spots = finer;
    }
    find_valleys(&spots, best, &hides, &f)
}

/// The best of all bracketed minima.
fn find_valleys(
    spots: &[(usize, CurveSpot)],
    mut best: CurveSpot,
    hides: &impl Fn(&CurveSpot, &CurveSpot, &CurveSpot) -> bool,
    f: &impl Fn(f64) -> CurveSpot,
) -> CurveSpot {
    for pair in spots.windows(2) {
        let [(_, a), (_, b)] = [pair[0], pair[1]];
        for end in [a, b] {
            if end.value < best.value {
                best = end;
            }
        }
        let known = best.at > a.at && best.at < b.at;
        if a.slope < 0.0 && b.slope > 0.0 && !known && hides(&a, &b, &best) {
            let found = refine_valley(a, b, f);
            if found.value < best.value {
                best = found;
            }
        }
    }
    best
}

/// The minimum between a falling and a rising spot: the root of the slope by secants through the last two spots, with a
/// bisection whenever they leave the bracket or do not halve it.
fn refine_valley(mut a: CurveSpot, mut b: CurveSpot, f: &impl Fn(f64) -> CurveSpot) -> CurveSpot {
    let mut best = if a.value < b.value { a } else { b };
    let (mut last, mut before) = if a.slope.abs() < b.slope.abs() {
        (a, b)
    } else {
        (b, a)
    };
    let mut width_before = f64::INFINITY;
    let tells = TELLS * a.value.abs().max(b.value.abs());
    for step in 0..MAX_STEPS {
        let width = b.at - a.at;
        let mut is_slow = false;
        if step % PATIENCE == PATIENCE - 1 {
            is_slow = width > 0.5 * width_before;
            width_before = width;
        }
        // Secant of the slope; bisection where it leaves the bracket or the bracket shrinks too slowly.
        let curvature = (last.slope - before.slope) / (last.at - before.at);
        let secant = last.at - last.slope / curvature;
        let inside = secant > a.at && secant < b.at;
        let at = if is_slow || !inside {
            0.5 * (a.at + b.at)
        } else {
            secant
        };
        let spot = f(at);
        if spot.value < best.value {
            best = spot;
        }
        let done = spot.slope == 0.0 || at <= a.at || at >= b.at;
        if done || width <= 4.0 * f64::EPSILON * (a.at.abs() + b.at.abs()) {
            return if spot.value <= best.value { spot } else { best };
        }
        // The sign of the slope says on which side a minimum is; beside a lower spot there is one towards that.
        let is_left = match spot.value > best.value + tells {
            true => spot.at < best.at,
            false => spot.slope < 0.0,
        };
        if is_left {
            a = spot;
        } else {
            b = spot;
        }
        (before, last) = (last, spot);
        // Near the minimum the value no longer feels the slope: over the bracket, or down a parabola.
        let remains = REMAINS * best.value.abs();
        let curvature = (last.slope - before.slope) / (last.at - before.at);
        if spot.slope.abs() * (b.at - a.at) <= remains
            || (curvature > 0.0 && spot.slope * spot.slope <= NEARER * remains * curvature)
        {
            return best;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bracket with two valleys: one of them is found to its bottom, and it is not a side of it.
    #[test]
    fn a_valley_beside_another_is_followed_to_its_bottom() {
        for round in 0..400 {
            let tilt = 0.002 * f64::from(round) - 0.4;
            let f = |at: f64| CurveSpot {
                at,
                value: (at * at - 1.0).powi(2) + tilt * at + 5.0,
                slope: 4.0 * at * (at * at - 1.0) + tilt,
            };
            let off = 0.01 * f64::from(round % 37);
            let found = refine_valley(f(-2.0 - off), f(1.7 + off), &f);
            assert!(found.slope.abs() < 1e-6, "{tilt}: {found:?}");
            assert!(found.value <= f(0.0).value, "{tilt}: {found:?}");
        }
    }
}
