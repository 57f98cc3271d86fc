//! The product of a chain with 31 digits: rotation columns and translation as groups of four lanes.

use super::circle::Factor;
use super::double::{Double, SPLITTER};
use glam::{DMat3, DVec3};
use wide::f64x4;

/// A vector of [`Double`]s; the fourth lane is not used.
#[derive(Clone, Copy, Debug, Default)]
pub struct DoubleVector {
    hi: f64x4,
    lo: f64x4,
}

impl DoubleVector {
    fn unit(axis: usize) -> Self {
        let mut hi = [0.0; 4];
        hi[axis] = 1.0;
        Self {
            hi: f64x4::new(hi),
            lo: f64x4::ZERO,
        }
    }

    /// The entries.
    #[inline]
    pub fn entries(&self) -> [Double; 3] {
        let (hi, lo) = (self.hi.to_array(), self.lo.to_array());
        [0, 1, 2].map(|k| Double {
            hi: hi[k],
            lo: lo[k],
        })
    }

    /// The leading parts.
    #[inline]
    pub fn leading(&self) -> DVec3 {
        let [x, y, z, _] = self.hi.to_array();
        DVec3::new(x, y, z)
    }

    /// The sum of parts in any order: Knuth's exact one, then the rests.
    #[inline(always)]
    fn sum(a: f64x4, b: f64x4, rest: f64x4) -> Self {
        let hi = a + b;
        let t = hi - a;
        let lo = ((a - (hi - t)) + (b - t)) + rest;
        let sum = hi + lo;
        Self {
            hi: sum,
            lo: lo - (sum - hi),
        }
    }

    /// `self + other · factor`.
    #[inline]
    fn plus_times(&self, other: &Self, factor: &Factor) -> Self {
        let (p, p_lo) = other.times(factor, &other.halves());
        Self::sum(self.hi, p, self.lo + p_lo)
    }

    /// `a · x + b · y`.
    #[inline(always)]
    fn combination(a: (f64x4, f64x4), b: (f64x4, f64x4)) -> Self {
        Self::sum(a.0, b.0, a.1 + b.1)
    }

    /// Two halves of at most 26 bits of the leading parts.
    #[inline(always)]
    fn halves(&self) -> (f64x4, f64x4) {
        let c = f64x4::splat(SPLITTER) * self.hi;
        let upper = c - (c - self.hi);
        (upper, self.hi - upper)
    }

    /// The product as leading part and rest, not brought into order.
    #[inline(always)]
    fn times(&self, factor: &Factor, halves: &(f64x4, f64x4)) -> (f64x4, f64x4) {
        let (upper, lower) = (f64x4::splat(factor.upper), f64x4::splat(factor.lower));
        let (hi, lo) = (f64x4::splat(factor.hi), f64x4::splat(factor.lo));
        let p = self.hi * hi;
        let error =
            ((halves.0 * upper - p) + halves.0 * lower + halves.1 * upper) + halves.1 * lower;
        (p, error + (self.hi * lo + self.lo * hi))
    }
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
        let (of_x, of_y) = (x.halves(), y.halves());
        let (p, p_lo) = x.times(sin, &of_x);
        self.rotation[b] = DoubleVector::combination(x.times(cos, &of_x), y.times(sin, &of_y));
        self.rotation[c] = DoubleVector::combination(y.times(cos, &of_y), (-p, -p_lo));
    }

    /// Turns by a fixed rotation.
    pub fn turn(&mut self, by: &DMat3) {
        let old = self.rotation;
        let factor = |v: f64| Factor::new(Double::from(v));
        for (j, column) in self.rotation.iter_mut().enumerate() {
            let m = by.col(j);
            let first = old[0].times(&factor(m.x), &old[0].halves());
            let second = old[1].times(&factor(m.y), &old[1].halves());
            let two = DoubleVector::combination(first, second);
            *column = two.plus_times(&old[2], &factor(m.z));
        }
    }
}
