//! Least values of functions of one variable whose slope is known: convex ones, and all others by bracketing with a
//! bound of the slope.

/// A place with the function's value and slope.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spot {
    /// The variable.
    pub at: f64,
    /// The value.
    pub value: f64,
    /// The derivative.
    pub slope: f64,
}

/// Most evaluations of one root search: bisection, every third of them, needs 53 to exhaust f64.
const MAX_STEPS: usize = 160;

/// A slope that promises less than this part of the value over the whole bracket promises nothing.
const REMAINS: f64 = 0.1 * f64::EPSILON;

/// Even pieces into which a range is cut first. The squared distance of two circles has at most eight stationary
/// points, four of them minima.
const PIECES: usize = 16;

/// How often a piece is halved that could hide a smaller value.
const HALVINGS: u32 = 3;

/// Least spot of a convex function on [low, high].
pub fn least_convex(low: f64, high: f64, f: impl Fn(f64) -> Spot) -> Spot {
    let (a, b) = (f(low), f(high));
    if a.slope >= 0.0 {
        return a;
    }
    if b.slope <= 0.0 {
        return b;
    }
    valley(a, b, &f)
}

/// Least spot of any function on [low, high] whose slope never exceeds `steepest`.
///
/// Exact when no two minima of very different depth share a piece of 1/128 of the range that a bound of the slope
/// cannot rule out.
pub fn least(low: f64, high: f64, steepest: f64, f: impl Fn(f64) -> Spot) -> Spot {
    let place = |k: usize| low + (high - low) * (k as f64 / PIECES as f64);
    let mut spots: Vec<Spot> = (0..=PIECES).map(|k| f(place(k))).collect();
    let far = Spot {
        value: f64::INFINITY,
        ..Spot::default()
    };
    let mut best = spots
        .iter()
        .fold(far, |best, s| if s.value < best.value { *s } else { best });
    let hides = |a: &Spot, b: &Spot, best: &Spot| {
        let lowest = 0.5 * (a.value + b.value - steepest * (b.at - a.at));
        lowest < best.value
    };
    for _ in 0..HALVINGS {
        best = valleys(&spots, best, &hides, &f);
        let mut finer = Vec::with_capacity(2 * spots.len());
        for pair in spots.windows(2) {
            finer.push(pair[0]);
            if hides(&pair[0], &pair[1], &best) {
                finer.push(f(0.5 * (pair[0].at + pair[1].at)));
            }
        }
        finer.extend(spots.last());
        if finer.len() == spots.len() {
            return best;
        }
        spots = finer;
    }
    valleys(&spots, best, &hides, &f)
}

/// The best of all bracketed minima.
fn valleys(
    spots: &[Spot],
    mut best: Spot,
    hides: &impl Fn(&Spot, &Spot, &Spot) -> bool,
    f: &impl Fn(f64) -> Spot,
) -> Spot {
    for pair in spots.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        for end in [a, b] {
            if end.value < best.value {
                best = end;
            }
        }
        let known = best.at > a.at && best.at < b.at;
        if a.slope < 0.0 && b.slope > 0.0 && !known && hides(&a, &b, &best) {
            let found = valley(a, b, f);
            if found.value < best.value {
                best = found;
            }
        }
    }
    best
}

/// The minimum between a falling and a rising spot: the root of the slope by the Illinois rule, with a bisection
/// whenever that does not halve the bracket.
fn valley(mut a: Spot, mut b: Spot, f: &impl Fn(f64) -> Spot) -> Spot {
    let mut best = if a.value < b.value { a } else { b };
    let (mut weight_a, mut weight_b) = (a.slope, b.slope);
    let mut side = 0;
    for step in 0..MAX_STEPS {
        let width = b.at - a.at;
        let secant = a.at - weight_a * width / (weight_b - weight_a);
        let inside = secant > a.at && secant < b.at;
        let at = if step % 3 == 2 || !inside {
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
        if spot.slope < 0.0 {
            // The Illinois rule: an end that stays counts half.
            weight_b = if side == 1 { 0.5 * weight_b } else { b.slope };
            (a, weight_a, side) = (spot, spot.slope, 1);
        } else {
            weight_a = if side == 2 { 0.5 * weight_a } else { a.slope };
            (b, weight_b, side) = (spot, spot.slope, 2);
        }
        // Near the minimum the value no longer feels the slope.
        if spot.slope.abs() * (b.at - a.at) <= REMAINS * best.value.abs() {
            return best;
        }
    }
    best
}
