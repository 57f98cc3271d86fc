//! Taylor coefficients as intervals: the value and the first derivatives of everything over a stretch of motion.
//!
//! A quantity f over -1 ≤ s ≤ 1 is held as f(s) = c₀ + c₁ s + … up to a last term whose coefficient is taken over the
//! whole stretch (Lagrange's remainder). Two passes give that: one with the coefficients at s = 0, one with those at
//! every place of the stretch at once. The recurrences are those of [`taylor`](crate::numbers::series); here the
//! length is fixed and a kink inside an interval is no value.

use crate::model::expression::{Expression, Function, Op};
use crate::numbers::interval::Interval;
use std::ops::{Add, Mul, Neg, Sub};

/// Coefficients of a series: the last one bounds the remainder.
pub const TERMS: usize = 8;

/// Whole exponents up to this are products, as in values.
const LARGEST_PRODUCT: f64 = 16.0;

/// Coefficients c₀ … of Σ cₖ sᵏ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Series(pub [Interval; TERMS]);

impl Series {
    /// Zero.
    pub const ZERO: Self = Self([Interval::ZERO; TERMS]);
    /// Nothing is known.
    pub const ENTIRE: Self = Self([Interval::ENTIRE; TERMS]);

    /// What does not change.
    pub fn constant(value: Interval) -> Self {
        let mut series = Self::ZERO;
        series.0[0] = value;
        series
    }

    /// Every coefficient times a constant.
    pub fn scale(&self, factor: Interval) -> Self {
        Self(self.0.map(|c| c * factor))
    }

    /// Whether all coefficients are bounded.
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|c| c.is_finite())
    }

    fn is_constant(&self) -> bool {
        self.0[1..].iter().all(|c| *c == Interval::ZERO)
    }

    /// Coefficients of the same polynomial about every place -1 ≤ s ≤ 1.
    pub fn over_the_stretch(&self) -> Self {
        let place = Interval::new(-1.0, 1.0);
        let mut result = *self;
        // Horner's scheme, one order after the other: the coefficients about s are divided differences.
        for k in 0..TERMS {
            for j in (k..TERMS - 1).rev() {
                result.0[j] = result.0[j] + result.0[j + 1] * place;
            }
        }
        result
    }

    /// The last coefficient from `stretch`, the others from here.
    pub fn with_remainder_of(&self, stretch: &Self) -> Self {
        let mut series = *self;
        series.0[TERMS - 1] = stretch.0[TERMS - 1];
        series
    }

    /// Value at `s`.
    pub fn value_at(&self, s: Interval) -> Interval {
        let terms = self.0.iter().rev();
        terms.fold(Interval::ZERO, |sum, c| sum * s + *c)
    }

    /// Σ from j = `from` to k of j aⱼ bₖ₋ⱼ / k: the coefficient of ∫ a' b.
    fn integral(a: &Self, b: &[Interval; TERMS], k: usize) -> Interval {
        let terms = (1..=k).map(|j| (a.0[j] * b[k - j]).scale(j as f64));
        let sum = terms.fold(Interval::ZERO, |sum, term| sum + term);
        sum / Interval::point(k as f64)
    }

    /// The series that starts at `value` and whose derivative is `self' · factor`.
    fn integrated(&self, factor: &Self, value: Interval) -> Self {
        let mut result = Self::constant(value);
        for k in 1..TERMS {
            result.0[k] = Self::integral(self, &factor.0, k);
        }
        result
    }

    /// Sine and cosine.
    pub fn sin_cos(&self) -> (Self, Self) {
        let (sin, cos) = self.0[0].sin_cos();
        let (mut s, mut c) = (Self::constant(sin), Self::constant(cos));
        for k in 1..TERMS {
            let next = Self::integral(self, &c.0, k);
            c.0[k] = -Self::integral(self, &s.0, k);
            s.0[k] = next;
        }
        (s, c)
    }

    fn exp(&self) -> Self {
        let mut result = Self::constant(self.0[0].exp());
        for k in 1..TERMS {
            result.0[k] = Self::integral(self, &result.0, k);
        }
        result
    }

    /// Square: its value is never negative.
    pub fn square(&self) -> Self {
        let mut product = *self * *self;
        product.0[0] = self.0[0].square();
        product
    }

    /// Square root.
    pub fn sqrt(&self) -> Self {
        let mut result = Self::constant(self.0[0].sqrt());
        let twice = result.0[0].scale(2.0);
        for k in 1..TERMS {
            let known = (1..k).map(|j| result.0[j] * result.0[k - j]);
            let known = known.fold(Interval::ZERO, |sum, term| sum + term);
            result.0[k] = (self.0[k] - known) / twice;
        }
        result
    }

    /// Quotient.
    pub fn divided(&self, divisor: &Self) -> Self {
        let mut quotient = Self::ZERO;
        for k in 0..TERMS {
            let known = (0..k).map(|j| quotient.0[j] * divisor.0[k - j]);
            let known = known.fold(Interval::ZERO, |sum, term| sum + term);
            quotient.0[k] = (self.0[k] - known) / divisor.0[0];
        }
        quotient
    }

    fn one() -> Self {
        Self::constant(Interval::ONE)
    }

    /// Natural logarithm.
    pub fn ln(&self) -> Self {
        let rate = Self::one().divided(self);
        self.integrated(&rate, self.0[0].ln())
    }

    /// Power; whole exponents are products.
    pub fn power(&self, exponent: &Self) -> Self {
        let e = exponent.0[0];
        let whole = exponent.is_constant() && e.lo == e.hi && e.lo.fract() == 0.0;
        if !whole || e.lo.abs() > LARGEST_PRODUCT {
            return (self.ln() * *exponent).exp();
        }
        let count = e.lo.abs() as u32;
        let (base, count) = if count.is_multiple_of(2) {
            (self.square(), count / 2)
        } else {
            (*self, count)
        };
        let product = (0..count).fold(Self::one(), |product, _| product * base);
        if e.lo < 0.0 {
            Self::one().divided(&product)
        } else {
            product
        }
    }

    fn asin(&self) -> Self {
        let root = (Self::one() - self.square()).sqrt();
        self.integrated(&Self::one().divided(&root), self.0[0].asin())
    }

    fn atan2(y: &Self, x: &Self) -> Self {
        let square = x.square() + y.square();
        let angle = y.0[0].atan2(x.0[0]);
        let from_y = y.integrated(&x.divided(&square), angle);
        let from_x = x.integrated(&y.divided(&square), Interval::ZERO);
        from_y - from_x
    }

    /// `Some(true)` where it is nowhere negative, `Some(false)` where nowhere positive.
    fn is_positive(&self) -> Option<bool> {
        let value = self.0[0];
        if value.lo >= 0.0 {
            Some(true)
        } else if value.hi <= 0.0 {
            Some(false)
        } else {
            None
        }
    }

    /// `yes` or `no`, as the sign of `self` says; nothing where the sign changes.
    pub fn choose(&self, yes: &Self, no: &Self) -> Self {
        match self.is_positive() {
            Some(true) => *yes,
            Some(false) => *no,
            None => Self::ENTIRE,
        }
    }

    /// Largest whole number below, where it is the same everywhere.
    pub fn floor(&self) -> Self {
        let (lo, hi) = (self.0[0].lo.floor(), self.0[0].hi.floor());
        if lo == hi {
            Self::constant(Interval::point(lo))
        } else {
            Self::ENTIRE
        }
    }

    fn call(function: Function, a: &Self, b: &Self) -> Self {
        match function {
            Function::Sin => a.sin_cos().0,
            Function::Cos => a.sin_cos().1,
            Function::Tan => {
                let (sin, cos) = a.sin_cos();
                sin.divided(&cos)
            }
            Function::Asin => a.asin(),
            Function::Acos => {
                let quarter = Interval::ONE.atan2(Interval::ZERO);
                Self::constant(quarter) - a.asin()
            }
            Function::Atan => Self::atan2(a, &Self::one()),
            Function::Atan2 => Self::atan2(a, b),
            Function::Sqrt => a.sqrt(),
            Function::Exp => a.exp(),
            Function::Ln => a.ln(),
            Function::Abs => a.choose(a, &-*a),
            Function::Min => (*b - *a).choose(a, b),
            Function::Max => (*a - *b).choose(a, b),
            Function::Hypot => (a.square() + b.square()).sqrt(),
            Function::Mod => *a - *b * a.divided(b).floor(),
            Function::Floor => a.floor(),
        }
    }

    /// Values of all operations of an expression, `slots` being those of its variables.
    pub fn all(expression: &Expression, slots: &[Self]) -> Vec<Self> {
        let mut v: Vec<Self> = Vec::with_capacity(expression.ops().len());
        for op in expression.ops() {
            v.push(match *op {
                Op::Constant(c) => Self::constant(Interval::decimal(c)),
                Op::Slot(i) => slots[i],
                Op::Negate(a) => -v[a],
                Op::Add(a, b) => v[a] + v[b],
                Op::Subtract(a, b) => v[a] - v[b],
                Op::Multiply(a, b) if a == b => v[a].square(),
                Op::Multiply(a, b) => v[a] * v[b],
                Op::Divide(a, b) => v[a].divided(&v[b]),
                Op::Power(a, b) => v[a].power(&v[b]),
                Op::Call(f, a, b) => Self::call(f, &v[a], &v[b]),
            });
        }
        v
    }

    /// Value of an expression.
    pub fn of(expression: &Expression, slots: &[Self]) -> Self {
        Self::all(expression, slots).pop().unwrap_or(Self::ZERO)
    }
}

impl Neg for Series {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|c| -c))
    }
}

impl Add for Series {
    type Output = Self;
    fn add(mut self, b: Self) -> Self {
        self.0.iter_mut().zip(&b.0).for_each(|(a, b)| *a = *a + *b);
        self
    }
}

impl Sub for Series {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for Series {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let mut product = Self::ZERO;
        for (j, a) in self.0.iter().enumerate() {
            if *a == Interval::ZERO && b.is_finite() {
                continue;
            }
            for (k, b) in b.0[..TERMS - j].iter().enumerate() {
                product.0[j + k] = product.0[j + k] + *a * *b;
            }
        }
        product
    }
}
