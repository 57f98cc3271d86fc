//! One arithmetic for searching and one for deciding: f64, and sums of two f64 with about 31 digits.

use mechanim::numbers::double_double::DoubleDouble;
use std::ops::{Add, Mul, Neg, Sub};

/// What the reference computes with.
pub trait Number:
    Copy + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    fn over(self, divisor: Self) -> Self;
    /// Square root; of what rounding has made negative, zero.
    fn root(self) -> Self;
    fn rounded(self) -> f64;

    fn is_below(self, other: Self) -> bool {
        (self - other).rounded() < 0.0
    }

    fn lesser(self, other: Self) -> Self {
        if other.is_below(self) { other } else { self }
    }

    fn greater(self, other: Self) -> Self {
        if self.is_below(other) { other } else { self }
    }

    fn size(self) -> Self {
        if self.rounded() < 0.0 { -self } else { self }
    }
}

impl Number for f64 {
    fn over(self, divisor: Self) -> Self {
        self / divisor
    }

    fn root(self) -> Self {
        self.max(0.0).sqrt()
    }

    fn rounded(self) -> f64 {
        self
    }
}

impl Number for DoubleDouble {
    fn over(self, divisor: Self) -> Self {
        // Long division, three digits of 53 bits.
        let first = self.hi / divisor.hi;
        let rest = self - divisor * first;
        let second = rest.hi / divisor.hi;
        let rest = rest - divisor * second;
        DoubleDouble::sum(first, second) + DoubleDouble::from(rest.hi / divisor.hi)
    }

    fn root(self) -> Self {
        if self.hi <= 0.0 {
            return Self::default();
        }
        // One Newton step squares the error of the f64 root.
        let near = self.hi.sqrt();
        let rest = self - DoubleDouble::product(near, near);
        DoubleDouble::from(near) + rest.over(DoubleDouble::from(2.0 * near))
    }

    fn rounded(self) -> f64 {
        self.hi + self.lo
    }
}

/// A vector.
#[derive(Clone, Copy)]
pub struct Vector<N>(pub [N; 3]);

impl<N: Number> Vector<N> {
    pub fn of(v: glam::DVec3) -> Self {
        Self(v.to_array().map(N::from))
    }

    pub fn dot(self, other: Self) -> N {
        let [a, b, c] = self.0;
        let [d, e, f] = other.0;
        a * d + b * e + c * f
    }

    pub fn length(self) -> N {
        self.dot(self).root()
    }

    pub fn unit(self) -> Self {
        let length = self.length();
        Self(self.0.map(|x| x.over(length)))
    }

    pub fn cross(self, other: Self) -> Self {
        let [a, b, c] = self.0;
        let [d, e, f] = other.0;
        Self([b * f - c * e, c * d - a * f, a * e - b * d])
    }

    pub fn rounded(self) -> glam::DVec3 {
        glam::DVec3::from_array(self.0.map(N::rounded))
    }
}

impl<N: Number> Add for Vector<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl<N: Number> Sub for Vector<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl<N: Number> Neg for Vector<N> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(N::neg))
    }
}

impl<N: Number> Mul<N> for Vector<N> {
    type Output = Self;
    fn mul(self, by: N) -> Self {
        Self(self.0.map(|x| x * by))
    }
}
