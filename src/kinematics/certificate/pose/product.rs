//! The product of a chain with 23 digits: rotation columns and translation as groups of four lanes.
//!
//! Entries of rotations are at most one. Each is a multiple of 2^-26 and a rest: products of the multiples, and sums of a
//! few of them, are exact in f64, and the rests are small enough for plain arithmetic. An entry is off by less than
//! 2^-75 (3e-23) after a step.

use crate::linalg::lanes::all_lanes;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::sin_cos::{GRID, SinCosFactor};
use glam::{DMat3, DVec3};
use wide::f64x4;

/// Entries of a rotation's column; the fourth lane is not used.
#[derive(Clone, Copy, Debug, Default)]
pub struct ProductColumn {
    upper: f64x4,
    lower: f64x4,
}

/// A factor in all lanes.
struct Splat {
    upper: f64x4,
    lower: f64x4,
    whole: f64x4,
}

impl Splat {
    #[inline(always)]
    fn of(factor: &SinCosFactor) -> Self {
        Self {
            upper: all_lanes(factor.upper),
            lower: all_lanes(factor.lower),
            whole: all_lanes(factor.whole),
        }
    }
}

impl ProductColumn {
    fn unit(axis: usize) -> Self {
        let mut upper = [0.0; 4];
        upper[axis] = 1.0;
        Self {
            upper: f64x4::new(upper),
            lower: f64x4::ZERO,
        }
    }

    /// The entries.
    #[inline]
    pub fn entries(&self) -> [DoubleDouble; 3] {
        let (hi, lo) = (self.upper.to_array(), self.lower.to_array());
        [0, 1, 2].map(|k| DoubleDouble::ordered(hi[k], lo[k]))
    }

    /// The entries in f64.
    #[inline]
    pub fn leading(&self) -> DVec3 {
        let [x, y, z, _] = (self.upper + self.lower).to_array();
        DVec3::new(x, y, z)
    }

    /// The product as an exact part and the rest.
    #[inline(always)]
    fn times(&self, factor: &Splat) -> (f64x4, f64x4) {
        (
            self.upper * factor.upper,
            self.upper * factor.lower + self.lower * factor.whole,
        )
    }

    /// From an exact part and the rest.
    #[inline(always)]
    fn new(exact: f64x4, rest: f64x4) -> Self {
        let grid = all_lanes(GRID);
        let upper = (exact + grid) - grid;
        Self {
            upper,
            lower: (exact - upper) + rest,
        }
    }
}

/// A vector as the sum of two f64 an entry.
#[derive(Clone, Copy, Debug, Default)]
pub struct DoubleVector {
    hi: f64x4,
    lo: f64x4,
}

impl DoubleVector {
    /// The leading parts.
    #[inline]
    pub fn leading(&self) -> DVec3 {
        let [x, y, z, _] = self.hi.to_array();
        DVec3::new(x, y, z)
    }

    /// Adds: Knuth's exact sum of the leading parts, then the rests.
    #[inline(always)]
    fn add(&mut self, (b, rest): (f64x4, f64x4)) {
        let a = self.hi;
        let hi = a + b;
        let t = hi - a;
        let lo = ((a - (hi - t)) + (b - t)) + (self.lo + rest);
        self.hi = hi + lo;
        self.lo = lo - (self.hi - hi);
    }
}

/// The frame that a walk along a chain has reached.
#[derive(Clone, Copy, Debug)]
pub struct Product {
    /// Columns of the rotation.
    pub rotation: [ProductColumn; 3],
    /// Origin.
    pub translation: DoubleVector,
}

impl Product {
    /// Where every walk begins.
    pub fn identity() -> Self {
        Self {
            rotation: [0, 1, 2].map(ProductColumn::unit),
            translation: DoubleVector::default(),
        }
    }

    /// Moves along the frame's own axis by a [short](Factor::short) factor.
    #[inline]
    pub fn shift(&mut self, axis: usize, by: &SinCosFactor) {
        self.translation
            .add(self.rotation[axis].times(&Splat::of(by)));
    }

    /// Turns about the frame's own axis; sine and cosine are on the grid.
    #[inline]
    pub fn rotate(&mut self, axis: usize, sin: &SinCosFactor, cos: &SinCosFactor) {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let (x, y) = (self.rotation[b], self.rotation[c]);
        let (sin, cos) = (Splat::of(sin), Splat::of(cos));
        let (x_sin, y_sin) = (x.times(&sin), y.times(&sin));
        let (x_cos, y_cos) = (x.times(&cos), y.times(&cos));
        self.rotation[b] = ProductColumn::new(x_cos.0 + y_sin.0, x_cos.1 + y_sin.1);
        self.rotation[c] = ProductColumn::new(y_cos.0 - x_sin.0, y_cos.1 - x_sin.1);
    }

    /// Rotates by a fixed rotation.
    pub fn turn(&mut self, by: &DMat3) {
        let old = self.rotation;
        let factor = |v: f64| Splat::of(&SinCosFactor::on_grid(DoubleDouble::from(v)));
        for (j, column) in self.rotation.iter_mut().enumerate() {
            let m = by.col(j);
            let [x, y, z] = [
                old[0].times(&factor(m.x)),
                old[1].times(&factor(m.y)),
                old[2].times(&factor(m.z)),
            ];
            *column = ProductColumn::new(x.0 + y.0 + z.0, x.1 + y.1 + z.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::sin_cos::sin_cos;

    /// A chain and then its inverse, step by step: the identity, but for what rounding leaves.
    #[test]
    fn there_and_back_again_is_the_identity_to_23_digits() {
        let steps: Vec<(usize, f64)> = (0..60_u32)
            .map(|k| ((k * 7 % 3) as usize, 2.9 * f64::from(k * k % 17) - 20.0))
            .collect();
        let mut product = Product::identity();
        let pass = |product: &mut Product, (axis, value): (usize, f64), back: bool| {
            let sign = if back { -1.0 } else { 1.0 };
            let (sin, cos) = sin_cos(DoubleDouble::from(value));
            let length = SinCosFactor::short(DoubleDouble::from(sign * 0.1 * value));
            if back {
                product.shift((axis + 1) % 3, &length);
            }
            product.rotate(axis, &sin.signed(sign), &cos);
            if !back {
                product.shift((axis + 1) % 3, &length);
            }
        };
        steps.iter().for_each(|s| pass(&mut product, *s, false));
        steps
            .iter()
            .rev()
            .for_each(|s| pass(&mut product, *s, true));
        for (j, column) in product.rotation.iter().enumerate() {
            for (i, entry) in column.entries().into_iter().enumerate() {
                let rest = (entry - DoubleDouble::from(f64::from(i == j))).hi.abs();
                // Sines and cosines are accurate to 4e-21: sin² + cos² differs from one by as much.
                assert!(rest < 120.0 * (1e-22 + 2.0 * 4e-21), "{i} {j}: {rest:e}");
            }
        }
        assert!(product.translation.leading().length() < 120.0 * 130.0 * 1e-20);
    }

    /// A rational rotation, whose powers are known exactly: (3 + 4i)/5 by whole numbers.
    #[test]
    fn powers_of_a_rational_rotation_are_exact_to_23_digits() {
        let quotient = |a: f64| {
            let hi = a / 5.0;
            let back = DoubleDouble::product(hi, 5.0);
            DoubleDouble::ordered(hi, ((a - back.hi) - back.lo) / 5.0)
        };
        let (sin, cos) = (
            SinCosFactor::on_grid(quotient(4.0)),
            SinCosFactor::on_grid(quotient(3.0)),
        );
        let mut product = Product::identity();
        let (mut re, mut im, mut scale) = (1_i64, 0_i64, 1_i64);
        for _ in 0..20 {
            product.rotate(2, &sin, &cos);
            (re, im, scale) = (3 * re - 4 * im, 4 * re + 3 * im, 5 * scale);
        }
        let [x, y, _] = product.rotation[0].entries();
        for (entry, exact) in [(x, re), (y, im)] {
            // Both products are whole numbers below 2^53 times a power of five below 2^47.
            let back = entry * DoubleDouble::sum(scale as f64, 0.0);
            let rest = (back - DoubleDouble::from(exact as f64)).hi.abs() / scale as f64;
            assert!(rest < 20.0 * 1e-22, "{rest:e}");
        }
    }
}
