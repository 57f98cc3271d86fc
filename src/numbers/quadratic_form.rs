//! Quadratic forms: value + Σ slopesₖ δₖ + Σ bendsₖₗ δₖ δₗ ± error encloses a function of δ in [-1, 1]ⁿ, as
//! [`AffineForm`] does to first order. Products and sines are of second order, other functions of first order. A
//! product takes n² operations, which pays if shared terms of second order cancel.
//!
//! Second-order coefficients are packed in a [`FormRoom`], column after column down to the diagonal, so that a form that
//! depends on the first numbers only has a short list.

use super::affine_form::AffineForm;
use super::form_room::{FormRoom, packed_length};
use super::interval::Interval;
use super::lists::{add_long_list, long_sum_of_magnitudes};
use super::rounding::{GROW, OPERATION, UNDERFLOW};
use super::scalar::Scalar;

/// An enclosure of a function of δ in [-1, 1]ⁿ.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticForm<'r> {
    /// Value at δ = 0, slope along each δ, and a bound of everything that is not of first or second order. Its room is
    /// where results keep their coefficients of second order, too.
    pub line: AffineForm<'r>,
    /// Factors of δₖ δₗ for k ≤ l, for the first l; those of all others are zero.
    bends: &'r [f64],
    /// Bound of the quadratic part.
    bend: f64,
}

/// Roundings in a coefficient of a product, generously: four products and their sum.
const OF_PRODUCT: f64 = 8.0 * OPERATION;

impl<'r> From<AffineForm<'r>> for QuadraticForm<'r> {
    fn from(line: AffineForm<'r>) -> Self {
        Self {
            line,
            bends: &[],
            bend: 0.0,
        }
    }
}

impl PartialEq for QuadraticForm<'_> {
    fn eq(&self, b: &Self) -> bool {
        self.line == b.line && self.bend == b.bend && self.bends == b.bends
    }
}

impl<'r> QuadraticForm<'r> {
    /// Exactly zero.
    pub const ZERO: Self = Self {
        line: AffineForm::ZERO,
        bends: &[],
        bend: 0.0,
    };

    /// The same with these second-order coefficients, packed; without space they go into the error.
    pub fn bent(self, bends: Vec<f64>) -> Self {
        let mut line = self.line;
        let bend = long_sum_of_magnitudes(&bends) * GROW;
        if bend == 0.0 {
            if let Some(room) = line.room() {
                room.bends().give_back(bends);
            }
            return Self::from(line);
        }
        match line.room().and_then(|room| room.bends().keep(bends)) {
            Some(bends) => Self { line, bends, bend },
            None => {
                line.error = (line.error + bend) * GROW;
                Self::from(line)
            }
        }
    }

    /// Bound of the quadratic part.
    pub fn bend(&self) -> f64 {
        self.bend
    }

    /// Factor of δₖ δₗ for k ≤ l.
    pub fn bend_of(&self, k: usize, l: usize) -> f64 {
        self.bends
            .get(FormRoom::place(k, l))
            .copied()
            .unwrap_or(0.0)
    }

    /// Where coefficients are stored.
    pub fn room(&self) -> Option<&'r FormRoom> {
        self.line.room()
    }

    /// A list for coefficients of second order, if there are some.
    fn blank(&self) -> Vec<f64> {
        match (self.bends, self.room()) {
            ([], _) | (_, None) => Vec::new(),
            (_, Some(room)) => room.bends().blank(),
        }
    }

    /// All bends, packed.
    pub fn bends(&self) -> &'r [f64] {
        self.bends
    }

    /// The same with everything that depends on numbers from `first` on moved into the error.
    pub fn folded(self, first: usize) -> Self {
        let line = self.line.folded(first);
        let Some((kept, moved)) = self.bends.split_at_checked(packed_length(first)) else {
            return Self { line, ..self };
        };
        let mut folded = Self {
            line,
            bends: kept,
            bend: long_sum_of_magnitudes(kept) * GROW,
        };
        let beyond = long_sum_of_magnitudes(moved) * GROW;
        folded.line.error = (folded.line.error + beyond) * GROW;
        folded
    }

    /// How many of the first numbers it depends on.
    pub fn span(&self) -> usize {
        let bent = (0..).find(|span| packed_length(*span) >= self.bends.len());
        self.line.slopes().len().max(bent.unwrap_or(0))
    }

    /// The same to first order: the quadratic part goes into the error.
    pub fn affine(&self) -> AffineForm<'r> {
        let mut line = self.line;
        line.error = (line.error + self.bend) * GROW;
        line
    }

    /// Whether it is a number without an error.
    fn is_number(&self) -> bool {
        self.bend == 0.0 && self.line.as_number().is_some()
    }

    /// A function that is known to the first order.
    fn by_line(self, of: impl Fn(AffineForm<'r>) -> AffineForm<'r>) -> Self {
        Self::from(of(self.affine()))
    }

    /// value + slope y - ½ (that function) y² and a third-order remainder: sine or cosine, whose second derivative is
    /// minus itself.
    fn wave_form(self, value: Interval, slope: Interval) -> Self {
        let (here, rate) = (value.middle(), slope.middle());
        let line = &self.line;
        let (radius, beyond) = (line.radius(), self.bend + line.error);
        let wide = (radius + beyond) * GROW;
        let (mut bends, mut lost) = (Vec::new(), 0.0);
        match self.room() {
            None => lost = 0.5 * here.abs() * radius * radius,
            Some(room) if !line.slopes().is_empty() => {
                bends = room.bends().blank();
                for (l, slope) in line.slopes().iter().enumerate() {
                    let others = &line.slopes()[..l];
                    bends.extend(others.iter().map(|other| -here * slope * other));
                    bends.push(-0.5 * here * slope * slope);
                    bends.resize(packed_length(l + 1), 0.0);
                }
                add_long_list(&mut bends, rate, self.bends);
            }
            Some(_) => {
                bends = self.blank();
                bends.extend(self.bends.iter().map(|own| rate * own));
            }
        }
        let open = [
            value.distance(here) * (1.0 + wide * wide),
            slope.distance(rate) * wide,
            rate.abs() * line.error,
            0.5 * here.abs() * beyond * (2.0 * radius + beyond),
            // No derivative is above one.
            wide * wide * wide / 6.0,
            OF_PRODUCT * (rate.abs() * wide + here.abs() * radius * radius),
            lost,
            UNDERFLOW,
        ];
        let error = open.iter().sum::<f64>() * GROW;
        let line = line.with_each_slope(|slope| rate * slope, here, error);
        Self::from(line).bent(bends)
    }
}

mod operations;
mod sum;
#[cfg(test)]
mod tests;
