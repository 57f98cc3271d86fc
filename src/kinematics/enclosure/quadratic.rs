//! A function of the dimensions to second order with a bound of the rest, and its range over their intervals.
//!
//! If a derivative has one sign on the whole box, the extremes lie on a face of it, which is examined in turn. The rest
//! is bounded term by term.

use crate::numbers::affine_form::AffineForm;
use crate::numbers::rounding::{GROW, SUMS};

/// A function of δ in [-1, 1]ⁿ.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadraticBound<'r> {
    /// At δ = 0.
    pub value: f64,
    /// Bound of the error of that.
    pub open: f64,
    /// Derivatives by every δ.
    pub rates: Vec<AffineForm<'r>>,
}

/// A range, and approximate positions of its ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// No value is lower.
    pub lo: f64,
    /// No value is higher.
    pub hi: f64,
    /// δ near which the least value lies.
    pub lowest: Vec<f64>,
    /// δ near which the greatest lies.
    pub highest: Vec<f64>,
}

/// The face of the box on which a function has its maximum: dimensions along which it is monotone are at their ends.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxFace {
    /// Its middle: the other dimensions are nominal.
    pub middle: Vec<f64>,
    /// δ near which the greatest value lies.
    pub best: Vec<f64>,
    /// Bound of the function relative to its value in the middle.
    pub beyond: f64,
}

/// Number of passes over all dimensions that improve the position.
const ROUNDS: usize = 6;

impl QuadraticBound<'_> {
    /// Its range.
    pub fn range(&self) -> Range {
        let (above, highest) = self.greatest(1.0);
        let (below, lowest) = self.greatest(-1.0);
        let known = |bound: f64| if bound.is_nan() { f64::INFINITY } else { bound };
        Range {
            lo: -known(below),
            hi: known(above),
            lowest,
            highest,
        }
    }

    /// The face on which `sign` times the function is greatest.
    pub fn face(&self, sign: f64) -> BoxFace {
        let mut fixed = self.monotone_ends(sign);
        let middle: Vec<f64> = fixed.iter().map(|d| d.unwrap_or(0.0)).collect();
        let beyond = self.beyond(sign, &fixed, &middle);
        let mut best = middle.clone();
        if fixed.contains(&None) {
            self.climb(sign, &mut fixed);
            let places = best.iter_mut().zip(fixed);
            places.for_each(|(place, d)| *place = d.unwrap_or(0.0));
        }
        BoxFace {
            middle,
            best,
            beyond: if beyond.is_nan() {
                f64::INFINITY
            } else {
                beyond
            },
        }
    }

    /// Bound of `sign` times the function relative to its value in the middle of a face: the mean of its derivatives
    /// from there.
    fn beyond(&self, sign: f64, fixed: &[Option<f64>], middle: &[f64]) -> f64 {
        let (mut sum, mut rest, mut size) = (0.0, 0.0, 0.0);
        let open = |j: usize| fixed[j].is_none();
        for (k, rate) in self.rates.iter().enumerate().filter(|(k, _)| open(*k)) {
            let moved = rate.slopes().iter().zip(middle);
            let linear = moved.fold(rate.value, |sum, (slope, at)| sum + slope * at);
            sum += greatest_of(sign * linear, 0.5 * sign * rate.slope(k));
            let others = (0..fixed.len()).filter(|j| *j != k && open(*j));
            rest += rate.error + others.map(|j| 0.5 * rate.slope(j).abs()).sum::<f64>();
            size += rate.value.abs() + rate.radius();
        }
        (sum + rest + SUMS * size) * GROW
    }

    /// A bound of `sign` times the function, and its approximate position.
    fn greatest(&self, sign: f64) -> (f64, Vec<f64>) {
        let mut fixed = self.monotone_ends(sign);
        let bound = self.bound(sign, &fixed);
        self.climb(sign, &mut fixed);
        let place = fixed.into_iter().map(|d| d.unwrap_or(0.0));
        (bound, place.collect())
    }

    /// Ends at which dimensions must be where the function is greatest; `None` if undecided.
    fn monotone_ends(&self, sign: f64) -> Vec<Option<f64>> {
        let slack = |rate: &AffineForm| SUMS * (rate.value.abs() + rate.radius());
        // Most derivatives have one sign on the whole box.
        let on_all = |rate: &AffineForm| {
            let open = rate.radius() + rate.error + slack(rate);
            (rate.value.abs() > open * GROW).then(|| (sign * rate.value).signum())
        };
        let mut fixed: Vec<Option<f64>> = self.rates.iter().map(on_all).collect();
        loop {
            let before = fixed.clone();
            for (k, rate) in self.rates.iter().enumerate() {
                if before[k].is_some() {
                    continue;
                }
                let (mut middle, mut open) = (rate.value, rate.error);
                // Derivative by dimension k over the rest of the box: fixed dimensions move its middle, open ones
                // widen it.
                for (slope, at) in rate.slopes().iter().zip(&fixed) {
                    middle += slope * at.unwrap_or(0.0);
                    open += if at.is_none() { slope.abs() } else { 0.0 };
                }
                if middle.abs() > (open + slack(rate)) * GROW {
                    fixed[k] = Some((sign * middle).signum());
                }
            }
            if fixed == before {
                return fixed;
            }
        }
    }

    /// Bounds `sign` times the function on a face given by the fixed dimensions.
    fn bound(&self, sign: f64, fixed: &[Option<f64>]) -> f64 {
        let (mut sum, mut size) = (sign * self.value, self.value.abs());
        let mut rest = self.open;
        for (k, rate) in self.rates.iter().enumerate() {
            size += rate.value.abs() + rate.radius();
            rest += rate.error;
            let half = |j: usize| 0.5 * sign * rate.slope(j);
            let Some(here) = fixed[k] else {
                // Both halves of what this one shares with the fixed ones.
                let (linear, square) = (self.along(sign, k, fixed), half(k));
                sum += greatest_of(linear, square);
                let others = (0..fixed.len()).filter(|j| *j != k && fixed[*j].is_none());
                rest += others.map(|j| half(j).abs()).sum::<f64>();
                continue;
            };
            sum += sign * rate.value * here;
            let known = fixed.iter().enumerate();
            sum += known
                .filter_map(|(j, at)| Some(half(j) * here * (*at)?))
                .sum::<f64>();
        }
        (sum + (rest + SUMS * size) * GROW).next_up()
    }

    /// Derivative of `sign` times the function by δₖ at δₖ = 0, other open dimensions at zero.
    fn along(&self, sign: f64, k: usize, at: &[Option<f64>]) -> f64 {
        let mut slope = self.rates[k].value;
        for (j, place) in at.iter().enumerate() {
            if j != k {
                let both = 0.5 * (self.rates[k].slope(j) + self.rates[j].slope(k));
                slope += both * place.unwrap_or(0.0);
            }
        }
        sign * slope
    }

    /// Moves the open dimensions one after the other to the maximum of the function without the rest.
    fn climb(&self, sign: f64, at: &mut [Option<f64>]) {
        let open: Vec<usize> = (0..at.len()).filter(|k| at[*k].is_none()).collect();
        for _ in 0..ROUNDS {
            let mut is_moved = false;
            for &k in &open {
                let (linear, square) = (self.along(sign, k, at), sign * self.rates[k].slope(k));
                let end = if linear < 0.0 { -1.0 } else { 1.0 };
                // Along one axis the function is a parabola: its vertex, or the better end.
                let inside = -linear / square;
                let best = Some(match square < 0.0 && inside.abs() < 1.0 {
                    true => inside,
                    false => end,
                });
                is_moved |= at[k] != best;
                at[k] = best;
            }
            if !is_moved {
                return;
            }
        }
    }
}

/// The greatest value of `linear` δ + `square` δ² for |δ| ≤ 1.
fn greatest_of(linear: f64, square: f64) -> f64 {
    let top = -0.5 * linear / square;
    if square < 0.0 && top.abs() < 1.0 {
        0.5 * linear * top
    } else {
        linear.abs() + square
    }
}
