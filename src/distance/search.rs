//! Minimisation of functions of one variable with known slope: convex ones, and all others by bracketing with a bound
//! of the slope.

use crate::math::sin_cos;
use std::f64::consts::TAU;
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

/// Maximum number of evaluations of one root search: bisection, every fourth of them, needs 53 to exhaust f64.
const MAX_STEPS: usize = 220;

/// Fraction of the value's resolution that may remain down a parabola, so that the place is accurate, too: a thousandth
/// of the distance that the value can resolve.
const NEARER: f64 = 1e-6;

/// Steps after which the bracket must be half as wide.
const PATIENCE: usize = 4;

/// Values that differ by more than this fraction of the first ones differ truly, not by rounding.
const TELLS: f64 = 64.0 * f64::EPSILON;

/// A slope that predicts a decrease below this fraction of the value over the whole bracket predicts nothing.
const REMAINS: f64 = 0.1 * f64::EPSILON;

/// Equal pieces into which a range is first divided.
const PIECES: usize = 8;

/// Maximum number of evaluations of one search, apart from those in valleys. A nearly constant function may hide
/// something in every piece wider than the square root of what could be hidden.
pub const MOST_SPOTS: usize = 256;

/// The same where it is to be proved that nothing is lower than requested: a function that hardly changes is below its tangents
/// by the second power of the pieces' width.
pub const MOST_PROVING_SPOTS: usize = 8192;

/// How near a search comes.
#[derive(Clone, Copy, Debug)]
pub struct Nearness {
    /// Nothing that is lower by more than this is missed.
    pub tolerance: f64,
    /// It need not be told what is above this, but proved as far as that goes.
    pub enough: f64,
    /// Maximum number of evaluations where nothing below that is found.
    pub most: usize,
}

impl From<f64> for Nearness {
    fn from(tolerance: f64) -> Self {
        Self {
            tolerance,
            enough: f64::INFINITY,
            most: MOST_SPOTS,
        }
    }
}

/// Parts of a turn for which sine and cosine are tabulated.
pub const FINEST: usize = 128;

/// Minimum of a convex function on [low, high].
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

/// Factor beyond the estimated zero of the slope at which the other side of a minimum is sought.
const BEYOND: f64 = 1.5;

/// The minimum towards which a function falls from a point, searched in steps that begin with `step`; `None` if it is
/// not within `farthest`.
pub fn least_near(
    start: CurveSpot,
    step: f64,
    farthest: f64,
    f: impl Fn(f64) -> CurveSpot,
) -> Option<CurveSpot> {
    let mut here = start;
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
        let is_near = (here.at - start.at).abs() + step <= farthest;
        if !is_near {
            return None;
        }
    }
    Some(here)
}

/// Samples a curve with bounded curvature: returns the minimum found, and a lower bound everywhere else.
#[derive(Clone, Copy, Debug)]
pub struct LeastFound {
    /// The minimum found.
    pub spot: CurveSpot,
    /// Lower bound of the function everywhere.
    pub floor: f64,
    /// Whether the search ended before it was known that nothing is lower by more than the tolerance.
    pub is_cut_off: bool,
}

impl LeastFound {
    /// By how much more than the tolerance the function may be lower somewhere.
    pub fn missed(&self) -> f64 {
        match self.is_cut_off {
            true => self.spot.value - self.floor,
            false => 0.0,
        }
    }
}

/// A point of a curve, with what a bound between two of them needs.
pub trait Spot: Copy {
    /// The value of the function there.
    fn place(&self) -> CurveSpot;
}

impl Spot for CurveSpot {
    fn place(&self) -> CurveSpot {
        *self
    }
}

/// Lower bound between two points of a function whose slope never exceeds `steepest`.
pub fn lowest_of_steep(steepest: f64, a: &CurveSpot, b: &CurveSpot) -> f64 {
    0.5 * (a.value + b.value - steepest * (b.at - a.at))
}

/// Lower bound, between two places, of a function that becomes convex when half of `bends` times the square of the
/// variable is added: the tangents of that sum are least at an end, or where they intersect. Slopes are those of any
/// supporting planes.
pub fn lowest_of_bent(bends: f64, a: &CurveSpot, b: &CurveSpot) -> f64 {
    let wide = b.at - a.at;
    let steepens = b.slope - a.slope + bends * wide;
    let crossing = (a.value - b.value + wide * (b.slope + 0.5 * bends * wide)) / steepens;
    let ends = a.value.min(b.value);
    match crossing > 0.0 && crossing < wide {
        true => ends.min(a.value + crossing * (a.slope - 0.5 * bends * crossing)),
        false => ends,
    }
}

/// Least spot of a function of an angle over a whole turn that is nowhere between two spots below `lowest` of them. The
/// function is given the angle's sine and cosine too.
///
/// Nothing that is lower by more than the tolerance is missed unless [`MOST_SPOTS`] do not tell, which are enough but for
/// functions that hardly change over the turn. The floor of the result holds in any case.
pub fn least_on_circle<S: Spot>(
    lowest: impl Fn(&S, &S) -> f64,
    nearness: impl Into<Nearness>,
    f: impl Fn(f64, (f64, f64)) -> S,
) -> LeastFound {
    let grid = angle_grid();
    let at = |k: usize, parts: usize| {
        let angle = TAU * (k as f64 / parts as f64);
        match FINEST.checked_rem(parts) {
            Some(0) => f(angle, grid[k * (FINEST / parts)]),
            _ => f(angle, sin_cos(angle)),
        }
    };
    let spot = |angle: f64| f(angle, sin_cos(angle)).place();
    least_of(&lowest, nearness.into(), at, spot)
}

/// The same of a function on [low, high].
pub fn least_between<S: Spot>(
    [low, high]: [f64; 2],
    lowest: impl Fn(&S, &S) -> f64,
    nearness: impl Into<Nearness>,
    f: impl Fn(f64) -> S,
) -> LeastFound {
    let at = |k: usize, parts: usize| f(low + (high - low) * (k as f64 / parts as f64));
    least_of(&lowest, nearness.into(), at, |t| f(t).place())
}

/// Sines and cosines of equal parts of a turn, both ends included: of all points that halving visits.
pub fn angle_grid() -> &'static [(f64, f64); FINEST + 1] {
    static GRID: OnceLock<[(f64, f64); FINEST + 1]> = OnceLock::new();
    GRID.get_or_init(|| std::array::from_fn(|k| sin_cos(TAU * (k as f64 / FINEST as f64))))
}

/// The search, with `at` for equal parts of the range: pieces that could hide something lower are halved, all of one
/// width before any narrower ones.
fn least_of<S: Spot>(
    lowest: &impl Fn(&S, &S) -> f64,
    Nearness {
        tolerance,
        enough,
        most,
    }: Nearness,
    at: impl Fn(usize, usize) -> S,
    f: impl Fn(f64) -> CurveSpot,
) -> LeastFound {
    let mut parts = PIECES;
    let spots: [S; PIECES + 1] = std::array::from_fn(|k| at(k, parts));
    let values = spots.map(|spot| spot.place().value);
    let first = (0..PIECES).fold(0, |k, j| if values[j] < values[k] { j } else { k });
    let mut best = lower(spots[first].place(), spots[PIECES].place());
    // Starting at the lowest point: the minimum found there leaves little to search in the others.
    let turned = (0..PIECES).map(|j| (first + j) % PIECES);
    let mut open: Vec<(usize, [S; 2])> = turned.map(|k| (k, [spots[k], spots[k + 1]])).collect();
    let (mut looks, mut floor) = (PIECES, f64::INFINITY);
    loop {
        open.retain(|(_, [p, q])| {
            let low = lowest(p, q);
            let hides = low < enough.min(best.value - tolerance);
            if hides {
                best = lower(best, lowest_valley([p.place(), q.place()], &best, &f));
            } else {
                floor = floor.min(low);
            }
            hides
        });
        let most = match best.value >= enough {
            true => most,
            false => MOST_SPOTS,
        };
        if open.is_empty() || looks + open.len() > most {
            let left = open.iter().map(|(_, [p, q])| lowest(p, q));
            return LeastFound {
                spot: best,
                floor: left.fold(floor.min(best.value), f64::min),
                is_cut_off: !open.is_empty(),
            };
        }
        looks += open.len();
        let mut halves = Vec::with_capacity(2 * open.len());
        for (k, [p, q]) in open {
            let middle = at(2 * k + 1, 2 * parts);
            best = lower(best, middle.place());
            halves.extend([(2 * k, [p, middle]), (2 * k + 1, [middle, q])]);
        }
        (open, parts) = (halves, 2 * parts);
    }
}

fn lower(a: CurveSpot, b: CurveSpot) -> CurveSpot {
    if b.value < a.value { b } else { a }
}

/// The minimum that lies between a falling and a rising spot, unless it is known; else the lowest one so far.
fn lowest_valley(
    [a, b]: [CurveSpot; 2],
    best: &CurveSpot,
    f: &impl Fn(f64) -> CurveSpot,
) -> CurveSpot {
    let is_known = best.at > a.at && best.at < b.at;
    match a.slope < 0.0 && b.slope > 0.0 && !is_known {
        true => refine_valley(a, b, f),
        false => *best,
    }
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
    let (mut width_before, mut was_bisected) = (f64::INFINITY, true);
    let tells = TELLS * a.value.abs().max(b.value.abs());
    for step in 0..MAX_STEPS {
        let width = b.at - a.at;
        let mut is_slow = false;
        if step % PATIENCE == PATIENCE - 1 {
            is_slow = width > 0.5 * width_before;
            width_before = width;
        }
        // Secant of the slope. Where it leaves the bracket or the bracket shrinks too slowly, in turn the place where the
        // tangents at the ends meet, which is next to a kink, and bisection.
        let curvature = (last.slope - before.slope) / (last.at - before.at);
        let secant = last.at - last.slope / curvature;
        let inside = secant > a.at && secant < b.at;
        let at = if is_slow || !inside {
            let meet = a.at + (a.value - b.value + width * b.slope) / (b.slope - a.slope);
            let is_usable = was_bisected && meet > a.at && meet < b.at;
            was_bisected = !is_usable;
            match is_usable {
                true => meet,
                false => 0.5 * (a.at + b.at),
            }
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
        // Near the minimum the value no longer changes with the slope: over the bracket, or down a parabola.
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
    use glam::DVec3;

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

    /// Numbers in -1..1 that are the same in every run.
    fn draw(state: &mut u32) -> f64 {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(*state >> 8) / f64::from(1_u32 << 23) - 1.0
    }

    /// The largest of a few heights over planes is convex, and has kinks; some planes are the two sides of thin sheets.
    #[test]
    fn least_values_of_convex_functions_on_circles_are_found() {
        let (mut state, mut proved) = (5, 0);
        for round in 0..3000 {
            let mut vector = |size: f64| DVec3::from_array([0; 3].map(|_| size * draw(&mut state)));
            let mut planes: Vec<(DVec3, f64)> = (0..1 + round % 5)
                .map(|_| (vector(1.0).normalize_or_zero(), vector(1.0).x))
                .collect();
            let (centre, axis, radius) = (vector(2.0), vector(1.0), 0.1 + vector(1.0).x.abs());
            let (x, y) = axis.normalize_or(DVec3::Z).any_orthonormal_pair();
            if round % 3 == 0 {
                // Nearly a tangent plane of the circle.
                let off = x.dot(centre) + radius * (1.0 - 1e-3 * vector(1.0).x.abs());
                planes.extend([(x, off), (-x, 1e-4 - off)]);
            }
            let f = |at: f64, (sin, cos): (f64, f64)| {
                let point = centre + (x * cos + y * sin) * radius;
                let higher = |best: (f64, DVec3), (n, off): &(DVec3, f64)| {
                    let height = n.dot(point) - off;
                    if height > best.0 { (height, *n) } else { best }
                };
                let (value, n) = planes.iter().fold((f64::NEG_INFINITY, DVec3::ZERO), higher);
                let slope = n.dot(y * cos - x * sin) * radius;
                CurveSpot { at, value, slope }
            };
            let dense = (0..20_000).map(|k| {
                let angle = TAU * f64::from(k) / 20_000.0;
                f(angle, sin_cos(angle)).value
            });
            let dense = dense.fold(f64::INFINITY, f64::min);
            let lowest = |a: &CurveSpot, b: &CurveSpot| lowest_of_bent(radius, a, b);
            let LeastFound { spot, floor, .. } = least_on_circle(lowest, 1e-12, f);
            assert!(
                (spot.value - dense).abs() < 1e-3 * radius,
                "{round}: {spot:?} {dense}"
            );
            assert!(spot.value <= dense + 1e-11, "{round}: {spot:?} {dense}");
            assert!(floor <= spot.value, "{round}: {spot:?} {floor}");
            proved += usize::from(floor > spot.value - 1e-11);
        }
        assert!(proved > 2800, "{proved}");
    }
}
