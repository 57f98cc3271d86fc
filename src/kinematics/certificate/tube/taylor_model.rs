//! Taylor models: a polynomial in s with plain numbers, and a bound of the truncation error for -1 ≤ s ≤ 1.
//!
//! Sums and products act on the polynomials; their rounding and truncation errors are added to the bound. Coefficients
//! are numbers, not intervals, so that a product costs only its multiplications.

use crate::model::expression::Affine;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::{GROW, OPERATION};

use crate::numbers::scalar::Scalar;
use crate::numbers::series::Series;

/// Coefficients of a polynomial in s.
pub const TERMS: usize = 8;

/// A function of s as a series of intervals whose last coefficient is taken over the whole stretch (Lagrange's
/// remainder). Two passes give that: one with the coefficients at s = 0, one with those at every place of the stretch at
/// once.
pub type TaylorEnclosure = Series<Interval, TERMS>;

/// Operations that the coefficients of a sine take after each other, at most, each with its rounding.
const SINE_STEPS: f64 = 48.0;

/// Σ cₖ sᵏ.
pub type Polynomial = [f64; TERMS];

/// The same as a series of plain numbers.
type CoefficientBounds = Series<f64, TERMS>;

/// A function of s, -1 ≤ s ≤ 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaylorModel {
    /// Coefficients.
    pub c: Polynomial,
    /// Bound on the distance of the function from the polynomial.
    pub rest: f64,
}

/// A function near a place: value + way u + bend u², for -1 ≤ u ≤ 1, with an error of at most `off`.
#[derive(Clone, Copy, Debug, Default)]
pub struct TaylorCentre {
    /// At the place.
    pub value: f64,
    /// Linear change to the end of the neighbourhood.
    pub way: f64,
    /// Change with the square.
    pub bend: f64,
    /// Bound of everything else.
    pub off: f64,
}

/// Σ |cₖ|: a bound on the polynomial.
pub fn polynomial_size(c: &Polynomial) -> f64 {
    c.iter().map(|c| c.abs()).sum()
}

/// Sums of the last entries: entry m holds Σ over k ≥ m, and zero follows.
pub fn tail_sums(sizes: &Polynomial) -> [f64; TERMS + 1] {
    let mut tails = [0.0; TERMS + 1];
    for k in (0..TERMS).rev() {
        tails[k] = tails[k + 1] + sizes[k];
    }
    tails
}

/// Truncation error of a product of polynomials with coefficients of these sizes, after [`TERMS`] coefficients.
pub fn truncated_part(a: &Polynomial, tails: &[f64; TERMS + 1]) -> f64 {
    (1..TERMS).map(|j| a[j] * tails[TERMS - j]).sum()
}

/// The product, cut off.
pub fn polynomial_product(a: &Polynomial, b: &Polynomial) -> Polynomial {
    let mut c = [0.0; TERMS];
    for j in 0..TERMS {
        for k in 0..TERMS - j {
            c[j + k] += a[j] * b[k];
        }
    }
    c
}

impl TaylorModel {
    /// Zero.
    pub const ZERO: Self = Self {
        c: [0.0; TERMS],
        rest: 0.0,
    };

    /// A constant number.
    pub fn constant(value: f64) -> Self {
        let mut model = Self::ZERO;
        model.c[0] = value;
        model
    }

    /// Its number, if it is constant.
    pub fn as_number(&self) -> Option<f64> {
        let is_number = self.c[1..] == [0.0; TERMS - 1] && self.rest == 0.0;
        is_number.then_some(self.c[0])
    }

    /// A constant number from an interval.
    pub fn standing(value: Interval) -> Self {
        let middle = value.middle();
        Self {
            rest: value.distance(middle) * GROW,
            ..Self::constant(middle)
        }
    }

    /// From the series about the middle and the one about every place at once.
    pub fn of(middle: TaylorEnclosure, everywhere: &TaylorEnclosure) -> Self {
        let series = middle.with_remainder_of(everywhere);
        let c = series.coefficients().map(Interval::middle);
        let wide = series.coefficients().iter().zip(c);
        let wide = wide.map(|(i, c)| i.distance(c));
        Self {
            c,
            rest: wide.sum::<f64>() * GROW,
        }
    }

    /// An affine form of coordinates.
    pub fn of_affine(form: &Affine, coordinates: &[Self]) -> Self {
        let mut sum = Self::constant(form.constant.number());
        sum.rest = form.constant.open();
        let mut all = sum.c[0].abs();
        for &(slot, factor) in &form.terms {
            let (x, c) = (&coordinates[slot], factor.number());
            for (sum, x) in sum.c.iter_mut().zip(&x.c) {
                *sum += c * x;
            }
            let size = polynomial_size(&x.c);
            all += c.abs() * size;
            sum.rest += factor.largest() * x.rest * GROW + factor.open() * size;
        }
        // A coordinate alone, or its opposite, is not rounded.
        let is_plain = form.constant.number() == 0.0
            && matches!(form.terms[..], [(_, c)] if c.number().abs() == 1.0);
        if !is_plain {
            sum.rest += (form.terms.len() + 1) as f64 * OPERATION * all;
        }
        sum
    }

    /// Nowhere larger than this.
    pub fn size(&self) -> f64 {
        (polynomial_size(&self.c) + self.rest) * GROW
    }

    /// Bound on the distance from the constant coefficient.
    pub fn size_of_change(&self) -> f64 {
        (self.c[1..].iter().map(|c| c.abs()).sum::<f64>() + self.rest) * GROW
    }

    /// Whether all numbers are bounded.
    pub fn is_finite(&self) -> bool {
        self.rest.is_finite() && self.c.iter().all(|c| c.is_finite())
    }

    /// Product with a number.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            c: self.c.map(|c| c * factor),
            rest: factor.abs() * (self.rest + OPERATION * polynomial_size(&self.c)),
        }
    }

    /// Sum.
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        sum.c.iter_mut().zip(&other.c).for_each(|(a, b)| *a += b);
        sum.rest += other.rest + OPERATION * polynomial_size(&sum.c);
        sum
    }

    /// Product.
    pub fn times(&self, other: &Self) -> Self {
        let (a, b) = (self.c.map(f64::abs), other.c.map(f64::abs));
        let (whole, tails) = (polynomial_size(&a), tail_sums(&b));
        Self {
            c: polynomial_product(&self.c, &other.c),
            rest: truncated_part(&a, &tails)
                + self.rest * (tails[0] + other.rest)
                + whole * other.rest
                + (TERMS + 1) as f64 * OPERATION * whole * tails[0],
        }
    }

    /// The same function with its last coefficients moved into the bound, so that `terms` of them remain.
    pub fn shortened(mut self, terms: usize) -> Self {
        let lost = self.c.iter_mut().skip(terms);
        self.rest += lost.map(|c| std::mem::take(c).abs()).sum::<f64>() * GROW;
        self
    }

    /// All values.
    pub fn range(&self) -> Interval {
        Interval::point(self.c[0]) + Interval::around_zero(self.size_of_change())
    }

    /// Coefficients about the place `s`, with `half` as the new unit.
    pub fn about(&self, s: f64, half: f64) -> Polynomial {
        let mut c = self.c;
        // Taylor shift by repeated synthetic division, then scaling.
        for k in 0..TERMS {
            for j in (k..TERMS - 1).rev() {
                c[j] += c[j + 1] * s;
            }
        }
        let mut unit = 1.0;
        for c in &mut c {
            *c *= unit;
            unit *= half;
        }
        c
    }

    /// The function near the place `s`, within a distance of `half`.
    pub fn around(&self, s: f64, half: f64) -> TaylorCentre {
        let c = self.about(s, half);
        let rest: f64 = c[3..].iter().map(|c| c.abs()).sum();
        // The shift takes two operations a step on numbers no larger than the sizes of the coefficients.
        let rounding = (2 * TERMS * TERMS) as f64 * OPERATION * polynomial_size(&self.c);
        TaylorCentre {
            value: c[0],
            way: c[1],
            bend: c[2],
            off: (rest + self.rest + rounding) * GROW,
        }
    }

    /// All values at the places in `s`.
    pub fn value_at(&self, s: Interval) -> Interval {
        let terms = self.c.iter().rev();
        let value = terms.fold(Interval::ZERO, |sum, c| sum * s + Interval::point(*c));
        value + Interval::around_zero(self.rest)
    }
}

/// A rotation by a variable angle: its sine and cosine as one pair.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// Coefficients.
    pub sin: Polynomial,
    /// Coefficients.
    pub cos: Polynomial,
    /// Bounds of the coefficients of the pair.
    pub sizes: Polynomial,
    /// Bound on the distance of the pair from the true one.
    pub rest: f64,
}

impl Turn {
    /// About an angle.
    ///
    /// The coefficients of the pair are bounded by those of exp(Σ |aₖ| sᵏ), and so is the tail that is cut off.
    pub fn new(angle: &TaylorModel) -> Self {
        let a = &angle.c;
        let (sin, cos) = CoefficientBounds::from(*a).sin_cos();
        let mut sizes = a.map(f64::abs);
        sizes[0] = 0.0;
        let major = *CoefficientBounds::from(sizes).exp().coefficients();
        let growth = libm::expm1(a[1..].iter().map(|a| a.abs()).sum());
        let known: f64 = major[1..].iter().sum();
        let rounding = 1.5 * OPERATION + SINE_STEPS * OPERATION * growth;
        Self {
            sin: *sin.coefficients(),
            cos: *cos.coefficients(),
            sizes: major.map(|m| m * GROW),
            rest: ((growth - known).max(0.0) + rounding + angle.rest) * GROW,
        }
    }
}
