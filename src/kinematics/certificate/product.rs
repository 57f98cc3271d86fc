//! The product of a chain with 31 digits: rotation columns and translation as groups of four lanes.

use super::circle::Factor;
use super::double::{Double, split};
use crate::kinematics::lanes::Lanes;
use glam::{DMat3, DVec3};

/// A vector of [`Double`]s; the fourth lane is not used.
#[derive(Clone, Copy, Debug, Default)]
pub struct DoubleVector {
    hi: Lanes,
    lo: Lanes,
}

impl DoubleVector {
    fn unit(axis: usize) -> Self {
        let mut vector = Self::default();
        vector.hi[axis] = 1.0;
        vector
    }

    /// An entry.
    #[inline]
    pub fn at(&self, k: usize) -> Double {
        Double {
            hi: self.hi[k],
            lo: self.lo[k],
        }
    }

    /// The leading parts.
    #[inline]
    pub fn leading(&self) -> DVec3 {
        DVec3::new(self.hi[0], self.hi[1], self.hi[2])
    }

    /// `self + other · factor`.
    #[inline]
    fn plus_times(&self, other: &Self, factor: &Factor) -> Self {
        let mut sum = Self::default();
        for k in 0..4 {
            let (p, p_lo) = product(other.hi[k], other.lo[k], factor);
            let s = Double::sum(self.hi[k], p);
            let s = Double::ordered(s.hi, s.lo + (self.lo[k] + p_lo));
            (sum.hi[k], sum.lo[k]) = (s.hi, s.lo);
        }
        sum
    }

    /// `a · x + b · y`.
    #[inline]
    fn combination(a: &Self, x: &Factor, b: &Self, y: &Factor) -> Self {
        let mut sum = Self::default();
        for k in 0..4 {
            let (p, p_lo) = product(a.hi[k], a.lo[k], x);
            let (q, q_lo) = product(b.hi[k], b.lo[k], y);
            let s = Double::sum(p, q);
            let s = Double::ordered(s.hi, s.lo + (p_lo + q_lo));
            (sum.hi[k], sum.lo[k]) = (s.hi, s.lo);
        }
        sum
    }
}

/// The product as leading part and rest, not brought into order.
#[inline(always)]
fn product(hi: f64, lo: f64, factor: &Factor) -> (f64, f64) {
    let p = hi * factor.hi;
    let (upper, lower) = split(hi);
    let error = ((upper * factor.upper - p) + upper * factor.lower + lower * factor.upper)
        + lower * factor.lower;
    (p, error + (hi * factor.lo + lo * factor.hi))
}

/// The frame that a walk along a chain has reached.
#[derive(Clone, Copy, Debug)]
pub struct Product {
    /// Columns of the rotation.
    pub rotation: [DoubleVector; 3],
    /// Origin.
    pub translation: DoubleVector,
}

impl Product {
    /// Where every walk begins.
    pub fn identity() -> Self {
        Self {
            rotation: [0, 1, 2].map(DoubleVector::unit),
            translation: DoubleVector::default(),
        }
    }

    /// Moves along the frame's own axis.
    #[inline]
    pub fn shift(&mut self, axis: usize, by: &Factor) {
        self.translation = self.translation.plus_times(&self.rotation[axis], by);
    }

    /// Turns about the frame's own axis.
    #[inline]
    pub fn rotate(&mut self, axis: usize, sin: &Factor, cos: &Factor) {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let (x, y) = (self.rotation[b], self.rotation[c]);
        self.rotation[b] = DoubleVector::combination(&x, cos, &y, sin);
        self.rotation[c] = DoubleVector::combination(&y, cos, &x, &sin.signed(-1.0));
    }

    /// Turns by a fixed rotation.
    pub fn turn(&mut self, by: &DMat3) {
        let old = self.rotation;
        let factor = |v: f64| Factor::new(Double::from(v));
        for (j, column) in self.rotation.iter_mut().enumerate() {
            let m = by.col(j);
            let two = DoubleVector::combination(&old[0], &factor(m.x), &old[1], &factor(m.y));
            *column = two.plus_times(&old[2], &factor(m.z));
        }
    }
}
