//! Kaucher arithmetic: intervals whose ends may be in reverse order, so that sums and most products have inverses.
//!
//! Every operation is rounded outwards, lower ends down and upper ends up, and is exact where possible. Products after
//! Lakeyev: each end is a difference of two maxima of which one is zero.

use crate::numbers::double_double::DoubleDouble;
use crate::numbers::interval::Interval;
use std::ops::{Add, Mul, Neg, Sub};

/// An interval [lo, hi]; improper where lo > hi.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kaucher {
    /// The first end.
    pub lo: f64,
    /// The second end.
    pub hi: f64,
}

/// The direction of rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RoundingSide {
    Down,
    Up,
}

impl RoundingSide {
    /// A rounded value whose exact value is `value + rest`.
    fn rounded(self, value: f64, rest: f64) -> f64 {
        match self {
            // Without the exact rest the neighbour is the bound.
            Self::Down if rest < 0.0 || rest.is_nan() => value.next_down(),
            Self::Up if rest > 0.0 || rest.is_nan() => value.next_up(),
            _ => value,
        }
    }

    fn sum(self, a: f64, b: f64) -> f64 {
        let sum = DoubleDouble::sum(a, b);
        self.rounded(sum.hi, sum.lo)
    }

    fn product(self, a: f64, b: f64) -> f64 {
        /// The rest of a product below this is not exact.
        const SMALL: f64 = 1e-280;
        if a == 0.0 || b == 0.0 {
            return 0.0;
        }
        let product = DoubleDouble::product(a, b);
        match product.hi.abs() < SMALL {
            true => self.rounded(product.hi, f64::NAN),
            false => self.rounded(product.hi, product.lo),
        }
    }

    fn quotient(self, a: f64, b: f64) -> f64 {
        let quotient = a / b;
        // a - q b has the sign of the rest times b.
        let back = DoubleDouble::product(quotient, b);
        let rest = (DoubleDouble::from(a) - back).hi * b.signum();
        self.rounded(quotient, rest)
    }
}

fn positive_part(x: f64) -> f64 {
    x.max(0.0)
}

fn negative_part(x: f64) -> f64 {
    (-x).max(0.0)
}

impl Kaucher {
    /// Both ends, unchanged.
    pub const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// A number.
    pub const fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// The ends are in order.
    pub fn is_proper(self) -> bool {
        self.lo <= self.hi
    }

    /// The ends exchanged.
    pub const fn dual(self) -> Self {
        Self::new(self.hi, self.lo)
    }

    /// The additive inverse.
    pub const fn opposite(self) -> Self {
        Self::new(-self.lo, -self.hi)
    }

    /// The multiplicative inverse; `None` if zero lies between its ends.
    pub fn inverse(self) -> Option<Self> {
        self.holds_no_zero().then(|| {
            Self::new(
                RoundingSide::Down.quotient(1.0, self.lo),
                RoundingSide::Up.quotient(1.0, self.hi),
            )
        })
    }

    /// The ends in order.
    pub fn proper(self) -> Self {
        Self::new(self.lo.min(self.hi), self.lo.max(self.hi))
    }

    /// Half the sum of the ends.
    pub fn middle(self) -> f64 {
        0.5 * self.lo + 0.5 * self.hi
    }

    /// Half the difference of the ends: negative for improper ones.
    pub fn radius(self) -> f64 {
        0.5 * self.hi - 0.5 * self.lo
    }

    /// The larger magnitude of the ends.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// Inclusion of Kaucher intervals.
    pub fn is_in(self, other: Self) -> bool {
        self.lo >= other.lo && self.hi <= other.hi
    }

    /// The least upper bound by inclusion.
    pub fn join(self, other: Self) -> Self {
        Self::new(self.lo.min(other.lo), self.hi.max(other.hi))
    }

    /// The greatest lower bound by inclusion.
    pub fn meet(self, other: Self) -> Self {
        Self::new(self.lo.max(other.lo), self.hi.min(other.hi))
    }

    /// Zero does not lie between the ends.
    pub fn holds_no_zero(self) -> bool {
        let ends = self.proper();
        ends.lo > 0.0 || ends.hi < 0.0
    }

    /// The quotient by `other`: the product with 1/`other`; `None` if zero lies between the ends of that.
    pub fn over(self, other: Self) -> Option<Self> {
        // 1/[b, c] is [1/c, 1/b]: the inverse for products is its dual.
        Some(
            self * Self::new(
                RoundingSide::Down.quotient(1.0, other.holds_no_zero().then_some(other.hi)?),
                RoundingSide::Up.quotient(1.0, other.lo),
            ),
        )
    }

    /// The same numbers as an interval for proofs; for an improper one, the numbers between the ends.
    pub fn interval(self) -> Interval {
        let ends = self.proper();
        Interval::new(ends.lo, ends.hi)
    }
}

impl From<Interval> for Kaucher {
    fn from(interval: Interval) -> Self {
        Self::new(interval.lo, interval.hi)
    }
}

impl Neg for Kaucher {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.hi, -self.lo)
    }
}

impl Add for Kaucher {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self::new(
            RoundingSide::Down.sum(self.lo, b.lo),
            RoundingSide::Up.sum(self.hi, b.hi),
        )
    }
}

impl Sub for Kaucher {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for Kaucher {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let end = |side: RoundingSide, up: [[f64; 2]; 2], down: [[f64; 2]; 2]| {
            let other = if side == RoundingSide::Down {
                RoundingSide::Up
            } else {
                RoundingSide::Down
            };
            let largest = |side: RoundingSide, [p, q]: [[f64; 2]; 2]| {
                side.product(p[0], p[1]).max(side.product(q[0], q[1]))
            };
            // One of both is zero.
            largest(side, up) - largest(other, down)
        };
        let (a1, a2, b1, b2) = (self.lo, self.hi, b.lo, b.hi);
        Self::new(
            end(
                RoundingSide::Down,
                [
                    [positive_part(a1), positive_part(b1)],
                    [negative_part(a2), negative_part(b2)],
                ],
                [
                    [positive_part(a2), negative_part(b1)],
                    [negative_part(a1), positive_part(b2)],
                ],
            ),
            end(
                RoundingSide::Up,
                [
                    [positive_part(a2), positive_part(b2)],
                    [negative_part(a1), negative_part(b1)],
                ],
                [
                    [positive_part(a1), negative_part(b2)],
                    [negative_part(a2), positive_part(b1)],
                ],
            ),
        )
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn k(lo: f64, hi: f64) -> Kaucher {
        Kaucher::new(lo, hi)
    }

    #[test]
    fn products_are_those_of_the_literature() {
        for (a, b, product) in [
            (k(2.0, 4.0), k(-1.0, 3.0), k(-4.0, 12.0)),
            (k(4.0, 2.0), k(-1.0, 3.0), k(-2.0, 6.0)),
            (k(1.0, -2.0), k(-1.0, 1.0), k(0.0, 0.0)),
            (k(1.0, -2.0), k(3.0, -4.0), k(8.0, -6.0)),
            (k(-1.0, 2.0), k(-3.0, 4.0), k(-6.0, 8.0)),
            (k(3.0, 5.0), k(5.0, 3.0), k(15.0, 15.0)),
            (k(-2.0, -4.0), k(1.0, 2.0), k(-4.0, -4.0)),
            (k(2.0, -1.0), k(5.0, 4.0), k(10.0, -5.0)),
        ] {
            assert_eq!(a * b, product, "{a:?} {b:?}");
            assert_eq!(b * a, product, "{b:?} {a:?}");
        }
    }

    /// The product by its definition: for every member of a proper interval, or some member of an improper one, extreme
    /// over extreme.
    fn defined(a: Kaucher, b: Kaucher) -> Kaucher {
        let all = |x: Kaucher, take: &dyn Fn(f64) -> Kaucher| {
            let (p, q) = (take(x.lo), take(x.hi));
            let zero = take(0.0);
            let mut list = vec![p, q];
            if !x.holds_no_zero() {
                list.push(zero);
            }
            list.into_iter()
                .reduce(|s, t| if x.is_proper() { s.join(t) } else { s.meet(t) })
                .unwrap()
        };
        let by = |x: f64, y: Kaucher| {
            if x >= 0.0 {
                k(x * y.lo, x * y.hi)
            } else {
                k(x * y.hi, x * y.lo)
            }
        };
        match (a.is_proper(), b.is_proper()) {
            // Joins come before meets where kinds differ, as the sign pattern decides; zero then gives zero.
            _ if a.holds_no_zero() => {
                // All of a has one sign: ends of b by the ends of a.
                let (p, q) = (by(a.lo, b), by(a.hi, b));
                if a.is_proper() { p.join(q) } else { p.meet(q) }
            }
            _ if b.holds_no_zero() => {
                let (p, q) = (by(b.lo, a), by(b.hi, a));
                if b.is_proper() { p.join(q) } else { p.meet(q) }
            }
            (true, true) => all(a, &|x| by(x, b)),
            (false, false) => all(a, &|x| by(x, b)),
            _ => k(0.0, 0.0),
        }
    }

    #[test]
    fn a_million_random_products_agree_with_the_definition() {
        let mut state = 0x5eed_u64;
        let mut random = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            ((state >> 11) as f64 / (1u64 << 52) as f64 - 1.0) * 4.0
        };
        for _ in 0..1_000_000 {
            let (a, b) = (k(random(), random()), k(random(), random()));
            let (found, exact) = (a * b, defined(a, b));
            let near = |p: f64, q: f64| (p - q).abs() <= 4e-15;
            assert!(
                near(found.lo, exact.lo) && near(found.hi, exact.hi),
                "{a:?} {b:?} {found:?} {exact:?}"
            );
            // Outwards: never inside the result of f64 rounded to nearest.
            assert!(found.lo <= exact.lo && found.hi >= exact.hi);
        }
    }

    #[test]
    fn what_is_done_can_be_undone() {
        let (a, b) = (k(2.0, 5.0), k(-1.0, 3.0));
        assert_eq!(a + a.opposite(), k(0.0, 0.0));
        let one = a * a.inverse().unwrap();
        assert!(one.lo <= 1.0 && one.hi >= 1.0 && one.hi - one.lo < 1e-15);
        assert_eq!(b.inverse(), None);
        assert_eq!(a.over(b), None);
        assert_eq!(k(2.0, 4.0).over(k(1.0, 2.0)), Some(k(1.0, 4.0)));
        assert_eq!(a - b, k(-1.0, 6.0));
        assert_eq!(a.meet(b), k(2.0, 3.0));
        assert_eq!(a.join(b), k(-1.0, 5.0));
        assert_eq!(
            (a.dual().proper(), a.dual().radius(), a.middle()),
            (a, -1.5, 3.5)
        );
        assert!(a.dual().is_in(a) && !a.is_in(b) && b.magnitude() == 3.0);
        // 0.1 + 0.2 lies above the nearest f64.
        let sum = k(0.1, 0.1) + k(0.2, 0.2);
        assert_eq!((sum.lo.next_up(), sum.hi), (sum.hi, 0.1 + 0.2));
    }
}
