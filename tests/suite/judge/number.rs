//! Numbers of the judge: 320 bits. Formulas and chains are written once, for these and for those of `dual`.

use astro_float_num::{BigFloat, Consts, Radix, RoundingMode};
use std::cell::RefCell;

/// Bits of a `Precise`: 96 digits. The correction that ends a closing is 1e-40.
const BITS: usize = 320;
/// Rounding does not matter: 56 digits are to spare.
const CUT: RoundingMode = RoundingMode::None;

thread_local! {
    /// Pi and its like, computed once a thread.
    static CONSTANTS: RefCell<Consts> = RefCell::new(Consts::new().unwrap());
    static HALF_PI: Precise = Precise(CONSTANTS.with_borrow_mut(|c| c.pi(BITS, CUT))).times(&Precise::of(0.5));
}

/// What a formula or a chain is computed with.
pub trait Number: Clone {
    fn of_precise(value: &Precise) -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    fn over(&self, other: &Self) -> Self;
    fn negative(&self) -> Self;
    fn sin_cos(&self) -> (Self, Self);
    /// The angle of the point (`x`, `self`).
    fn atan2(&self, x: &Self) -> Self;
    fn root(&self) -> Self;
    fn exp(&self) -> Self;
    fn ln(&self) -> Self;
    fn floor(&self) -> Self;
    fn is_below(&self, other: &Self) -> bool;
    fn is_negative(&self) -> bool;

    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negative())
    }

    /// A power with a whole exponent.
    fn raised(&self, exponent: i64) -> Self {
        let one = Self::of_precise(&Precise::of(1.0));
        let power = (0..exponent.unsigned_abs()).fold(one.clone(), |p, _| p.times(self));
        if exponent < 0 {
            one.over(&power)
        } else {
            power
        }
    }
}

/// A number of 320 bits.
#[derive(Clone, Debug)]
pub struct Precise(BigFloat);

impl Precise {
    pub fn of(value: f64) -> Self {
        Self(BigFloat::from_f64(value, BITS))
    }

    /// The number that a decimal text means.
    pub fn of_decimal(text: &str) -> Self {
        let plain = text.trim().trim_start_matches('+').replace('_', "");
        let value =
            CONSTANTS.with_borrow_mut(|c| BigFloat::parse(&plain, Radix::Dec, BITS, CUT, c));
        assert!(
            !value.is_nan() && !value.is_inf(),
            "`{text}` is not a number"
        );
        Self(value)
    }

    pub fn pi() -> Self {
        HALF_PI.with(|half| half.times(&Self::of(2.0)))
    }

    /// The nearest f64, to within two units in the last place.
    pub fn rounded(&self) -> f64 {
        let Some((words, _, sign, exponent, _)) = self.0.as_raw_parts() else {
            return f64::NAN;
        };
        // The mantissa is a fraction, its last word first; zero may have none.
        let fraction = words
            .iter()
            .fold(0.0, |rest, word| (*word as f64 + rest) / 2f64.powi(64));
        let size = fraction * 2f64.powi(exponent.max(-1000));
        if sign.is_negative() { -size } else { size }
    }

    pub fn size(&self) -> Self {
        Self(self.0.abs())
    }
}

impl Number for Precise {
    fn of_precise(value: &Precise) -> Self {
        value.clone()
    }

    fn plus(&self, other: &Self) -> Self {
        Self(self.0.add(&other.0, BITS, CUT))
    }

    fn times(&self, other: &Self) -> Self {
        Self(self.0.mul(&other.0, BITS, CUT))
    }

    fn over(&self, other: &Self) -> Self {
        Self(self.0.div(&other.0, BITS, CUT))
    }

    fn negative(&self) -> Self {
        Self(self.0.neg())
    }

    /// Taylor series of an angle below pi/256, doubled six times.
    fn sin_cos(&self) -> (Self, Self) {
        const HALVINGS: i32 = 6;
        let half_pi = HALF_PI.with(Clone::clone);
        let quarters = self.over(&half_pi).plus(&Self::of(0.5)).floor();
        let rest = self.minus(&quarters.times(&half_pi));
        let small = rest.times(&Self::of(0.5f64.powi(HALVINGS)));
        let square = small.times(&small).negative();
        let (mut sine, mut versed) = (small.clone(), Self::of(0.0));
        let mut term = small;
        // Terms x^n/n!, those of the sine and those of 1 - cos in turn; below 1e-97 from n = 30 on.
        let mut even = square.times(&Self::of(-0.5));
        for n in 1..18 {
            versed = versed.plus(&even);
            let (a, b) = (2.0 * f64::from(n), 2.0 * f64::from(n) + 1.0);
            term = term.times(&square).over(&Self::of(a * b));
            sine = sine.plus(&term);
            even = even.times(&square).over(&Self::of(b * (b + 1.0)));
        }
        for _ in 0..HALVINGS {
            // 1 - cos 2x = 2 sin² x keeps its digits where the cosine would lose them.
            let cosine = Self::of(1.0).minus(&versed);
            versed = Self::of(2.0).times(&sine).times(&sine);
            sine = Self::of(2.0).times(&sine).times(&cosine);
        }
        let cosine = Self::of(1.0).minus(&versed);
        let turns = quarters.times(&Self::of(0.25)).floor();
        match quarters.minus(&turns.times(&Self::of(4.0))).rounded() as i32 {
            0 => (sine, cosine),
            1 => (cosine, sine.negative()),
            2 => (sine.negative(), cosine.negative()),
            _ => (cosine.negative(), sine),
        }
    }

    fn atan2(&self, x: &Self) -> Self {
        let arctan = |v: Self| Self(CONSTANTS.with_borrow_mut(|c| v.0.atan(BITS, CUT, c)));
        let half_pi = HALF_PI.with(Clone::clone);
        let right = if self.is_negative() {
            half_pi.negative()
        } else {
            half_pi
        };
        if x.0.is_zero() && self.0.is_zero() {
            Self::of(0.0)
        } else if x.size().is_below(&self.size()) {
            right.minus(&arctan(x.over(self)))
        } else if x.is_negative() {
            arctan(self.over(x)).plus(&right.times(&Self::of(2.0)))
        } else {
            arctan(self.over(x))
        }
    }

    fn root(&self) -> Self {
        Self(self.0.sqrt(BITS, CUT))
    }

    fn exp(&self) -> Self {
        Self(CONSTANTS.with_borrow_mut(|c| self.0.exp(BITS, CUT, c)))
    }

    fn ln(&self) -> Self {
        Self(CONSTANTS.with_borrow_mut(|c| self.0.ln(BITS, CUT, c)))
    }

    fn floor(&self) -> Self {
        Self(self.0.floor())
    }

    fn is_below(&self, other: &Self) -> bool {
        self.0.cmp(&other.0).is_some_and(|order| order < 0)
    }

    fn is_negative(&self) -> bool {
        self.0.is_negative() && !self.0.is_zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_96_digits() {
        for text in ["0", "0.3", "-1.7e-9", "4.1e22", "12345.678", "3", "1e-30"] {
            let x = Precise::of_decimal(text);
            let near: f64 = text.parse().unwrap();
            assert!(
                (x.rounded() - near).abs() <= 4e-16 * near.abs(),
                "{text} {}",
                x.rounded()
            );
            assert_eq!(Precise::of(near).rounded(), near);
        }
        let tenth = Precise::of_decimal("0.1");
        let rest = tenth
            .times(&Precise::of(10.0))
            .minus(&Precise::of(1.0))
            .rounded();
        assert!(rest.abs() < 1e-95, "{rest}");
    }

    #[test]
    fn sines_are_those_of_the_library() {
        for text in [
            "0.3",
            "-1.7",
            "0",
            "1e-9",
            "101.25",
            "6283185.807",
            "-3.141592653589793",
            "1.5707963267948966",
        ] {
            let x = Precise::of_decimal(text);
            let (sine, cosine) = x.sin_cos();
            let library = |f: fn(&BigFloat, usize, RoundingMode, &mut Consts) -> BigFloat| {
                Precise(CONSTANTS.with_borrow_mut(|c| f(&x.0, BITS, CUT, c)))
            };
            let off = [
                sine.minus(&library(BigFloat::sin)),
                cosine.minus(&library(BigFloat::cos)),
            ];
            for off in off {
                assert!(off.rounded().abs() < 1e-85, "{text}: {}", off.rounded());
            }
            let back = sine.atan2(&cosine).sin_cos().0.minus(&sine);
            assert!(back.rounded().abs() < 1e-85, "{text}: {}", back.rounded());
        }
    }
}
