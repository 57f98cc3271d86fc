//! Numbers with a derivative, for the judge's Jacobians.

use super::number::{Number, Precise};

/// A value and its derivative in one direction.
#[derive(Clone, Copy, Debug)]
pub struct Dual {
    pub value: f64,
    pub slope: f64,
}

impl Dual {
    fn with(value: f64, slope: f64) -> Self {
        Self { value, slope }
    }
}

impl Number for Dual {
    fn of_precise(value: &Precise) -> Self {
        Self::with(value.rounded(), 0.0)
    }

    fn plus(&self, other: &Self) -> Self {
        Self::with(self.value + other.value, self.slope + other.slope)
    }

    fn times(&self, other: &Self) -> Self {
        let slope = self.value * other.slope + self.slope * other.value;
        Self::with(self.value * other.value, slope)
    }

    fn over(&self, other: &Self) -> Self {
        let quotient = self.value / other.value;
        Self::with(
            quotient,
            (self.slope - quotient * other.slope) / other.value,
        )
    }

    fn negative(&self) -> Self {
        Self::with(-self.value, -self.slope)
    }

    fn sin_cos(&self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        let slopes = [cosine * self.slope, -sine * self.slope];
        (Self::with(sine, slopes[0]), Self::with(cosine, slopes[1]))
    }

    fn atan2(&self, x: &Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        let slope = (x.value * self.slope - self.value * x.slope) / square;
        Self::with(self.value.atan2(x.value), slope)
    }

    fn root(&self) -> Self {
        let root = self.value.sqrt();
        Self::with(root, self.slope / (2.0 * root))
    }

    fn exp(&self) -> Self {
        let exp = self.value.exp();
        Self::with(exp, exp * self.slope)
    }

    fn ln(&self) -> Self {
        Self::with(self.value.ln(), self.slope / self.value)
    }

    fn floor(&self) -> Self {
        Self::with(self.value.floor(), 0.0)
    }

    fn is_below(&self, other: &Self) -> bool {
        self.value < other.value
    }

    fn is_negative(&self) -> bool {
        self.value < 0.0
    }
}
