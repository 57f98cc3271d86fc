//! Quadratic forms: value + Σ slopesₖ δₖ + Σ bendsₖₗ δₖ δₗ ± error encloses a function of δ in [-1, 1]ᴺ, as
//! [`AffineForm`] does to first order. Products and sines are of second order, other functions of first order. A
//! product takes N² operations, which pays if shared terms of second order cancel.
//!
//! Second-order coefficients of the δ that occur are packed in a [`FormRoom`], row after row from the diagonal on: a
//! form itself is small and cheap to copy.

use super::affine_form::{AffineForm, sum_of_magnitudes};
use super::form_room::FormRoom;
use super::interval::Interval;
use super::rounding::{GROW, OPERATION, UNDERFLOW};

/// An enclosure of a function of δ in [-1, 1]ᴺ.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticForm<'r, const N: usize> {
    /// Value at δ = 0, slope along each δ, and a bound of everything that is not of first or second order.
    pub line: AffineForm<N>,
    /// Factors of δₖ δₗ for k ≤ l; empty if all are zero.
    bends: &'r [f64],
    /// Bound of the quadratic part.
    bend: f64,
    /// Storage for the second-order coefficients of results; a plain number needs none.
    room: Option<&'r FormRoom>,
}

/// Roundings in a coefficient of a product, generously: four products and their sum.
const OF_PRODUCT: f64 = 8.0 * OPERATION;

/// A value below this share of a form's slopes does not multiply second-order coefficients one by one.
const NEGLIGIBLE: f64 = 1e-6;

/// A sum under construction: its second-order coefficients are changed in place.
struct QuadraticSum<'r, const N: usize> {
    line: AffineForm<N>,
    bends: Vec<f64>,
    room: Option<&'r FormRoom>,
    /// Terms, and the sum of their magnitudes: no partial sum is larger.
    count: f64,
    size: f64,
}

impl<'r, const N: usize> QuadraticSum<'r, N> {
    fn new(start: f64) -> Self {
        Self {
            line: AffineForm::within(start, 0.0),
            bends: Vec::new(),
            room: None,
            count: 1.0,
            size: start.abs(),
        }
    }

    /// The second-order coefficients, if there is space for them.
    fn unfold(&mut self) {
        if let (true, Some(room)) = (self.bends.is_empty(), self.room) {
            self.bends = room.zeros();
        }
    }

    fn add_scaled(&mut self, factor: f64, form: &QuadraticForm<'r, N>) {
        self.room = self.room.or(form.room);
        let line = &form.line;
        if factor == 0.0 || line.is_zero() && form.bend == 0.0 {
            // An unknown number stays unknown.
            let open = line.error + form.bend;
            self.line.error += if open.is_finite() { 0.0 } else { f64::INFINITY };
            return;
        }
        self.line.value += factor * line.value;
        for (s, slope) in self.line.slopes.iter_mut().zip(&line.slopes) {
            *s += factor * slope;
        }
        if !form.bends.is_empty() {
            self.unfold();
            for (bend, added) in self.bends.iter_mut().zip(form.bends) {
                *bend += factor * added;
            }
        }
        self.count += 1.0;
        self.size += factor.abs() * (line.value.abs() + line.radius() + form.bend);
        self.line.error += factor.abs() * line.error;
    }

    /// Adds a product, its terms up to the second order multiplied out in place.
    fn add_product(&mut self, a: &QuadraticForm<'r, N>, b: &QuadraticForm<'r, N>) {
        for (number, other) in [(a, b), (b, a)] {
            if number.is_number() {
                return self.add_scaled(number.line.value, other);
            }
        }
        self.room = self.room.or(a.room).or(b.room);
        let (u, v) = (a.line.value, b.line.value);
        let (x, y) = (&a.line.slopes, &b.line.slopes);
        let (rx, ry) = (a.line.radius(), b.line.radius());
        let mut lost = 0.0;
        if rx > 0.0 && ry > 0.0 {
            self.unfold();
            match self.room {
                // Without space the product of the slopes goes into the error.
                None => lost = rx * ry,
                Some(room) => {
                    // So does that of slopes along δ without storage.
                    let outside = |slopes: &[f64]| sum_of_magnitudes(&slopes[room.count()..]);
                    lost = outside(x) * ry + rx * outside(y);
                    let mut rows = &mut self.bends[..];
                    for k in 0..room.count() {
                        let (row, rest) = rows.split_at_mut(room.count() - k);
                        let (p, q) = (x[k], y[k]);
                        row[0] += p * q;
                        let slopes = x[k + 1..].iter().zip(&y[k + 1..]);
                        for (bend, (x, y)) in row[1..].iter_mut().zip(slopes) {
                            *bend += p * y + x * q;
                        }
                        rows = rest;
                    }
                }
            }
        }
        for (factor, reach, form) in [(u, rx, b), (v, ry, a)] {
            let bends = form.bends;
            // Beside its slopes such a value is nothing, and their product with the second order is an error below.
            if factor.abs() <= NEGLIGIBLE * reach {
                lost += factor.abs() * form.bend;
            } else if !bends.is_empty() {
                self.unfold();
                for (bend, added) in self.bends.iter_mut().zip(bends) {
                    *bend += factor * added;
                }
            }
        }
        let line = &mut self.line;
        for (k, slope) in line.slopes.iter_mut().enumerate() {
            *slope += u * y[k] + v * x[k];
        }
        line.value += u * v;
        let (qx, qy) = (a.bend, b.bend);
        let (ex, ey) = (a.line.error, b.line.error);
        let (far, wide) = (u.abs() + rx + qx, v.abs() + ry + qy);
        // Errors times values, all products of third and fourth order, rounding, underflow.
        let open = [
            u.abs() * ey + v.abs() * ex,
            rx * (qy + ey) + ry * (qx + ex),
            (qx + ex) * (qy + ey),
            OF_PRODUCT * far * wide,
            lost,
            UNDERFLOW,
        ];
        line.error += open.iter().sum::<f64>();
        // Three sums for a coefficient.
        self.count += 3.0;
        self.size += far * wide;
    }

    fn finish(self) -> QuadraticForm<'r, N> {
        let Self {
            mut line,
            bends,
            room,
            count,
            size,
        } = self;
        // A sum of products loses at most this many roundings of the sum of their magnitudes; errors are summed with as
        // many roundings.
        if count > 1.0 {
            let grown = 1.0 + count * GROWN;
            line.error =
                (line.error * grown + count * (OPERATION * size * GROW + UNDERFLOW)) * GROW;
        }
        QuadraticForm::from(line).bent(bends, room)
    }
}

/// Rounding of an addition to an error, generously.
const GROWN: f64 = 8.0 * OPERATION;

impl<const N: usize> From<AffineForm<N>> for QuadraticForm<'_, N> {
    fn from(line: AffineForm<N>) -> Self {
        Self {
            line,
            bends: &[],
            bend: 0.0,
            room: None,
        }
    }
}

impl<const N: usize> PartialEq for QuadraticForm<'_, N> {
    fn eq(&self, b: &Self) -> bool {
        self.line == b.line && self.bend == b.bend && (self.bend == 0.0 || self.bends == b.bends)
    }
}

impl<'r, const N: usize> QuadraticForm<'r, N> {
    /// Exactly zero.
    pub const ZERO: Self = Self {
        line: AffineForm::ZERO,
        bends: &[],
        bend: 0.0,
        room: None,
    };

    /// A form without second-order coefficients; those of products with it go into the storage. Its slopes are those of
    /// the storage.
    pub fn within(line: AffineForm<N>, room: &'r FormRoom) -> Self {
        Self {
            room: Some(room),
            ..Self::from(line)
        }
    }

    /// The same with these second-order coefficients, packed; without space they go into the error.
    pub fn bent(mut self, bends: Vec<f64>, room: Option<&'r FormRoom>) -> Self {
        self.room = self.room.or(room);
        self.bend = sum_of_magnitudes(&bends) * GROW;
        if self.bend == 0.0 {
            (self.bends, self.bend) = (&[], 0.0);
            if let Some(room) = self.room {
                room.give_back(bends);
            }
            return self;
        }
        match self.room.and_then(|room| room.keep(bends)) {
            Some(bends) => self.bends = bends,
            None => {
                self.line.error = (self.line.error + self.bend) * GROW;
                (self.bends, self.bend) = (&[], 0.0);
            }
        }
        self
    }

    /// Bound of the quadratic part.
    pub fn bend(&self) -> f64 {
        self.bend
    }

    /// Factor of δₖ δₗ for k ≤ l.
    pub fn bend_of(&self, k: usize, l: usize) -> f64 {
        let place = self.room.map_or(0, |room| room.place(k, l));
        self.bends.get(place).copied().unwrap_or(0.0)
    }

    /// Number of δ for which it has second-order coefficients.
    pub fn span(&self) -> usize {
        self.room.map_or(0, FormRoom::count)
    }

    /// Where second-order coefficients are stored.
    pub fn room(&self) -> Option<&'r FormRoom> {
        self.room
    }

    /// All bends, packed.
    pub fn bends(&self) -> &'r [f64] {
        self.bends
    }

    /// The same to first order: the quadratic part goes into the error.
    pub fn affine(&self) -> AffineForm<N> {
        let mut line = self.line;
        line.error = (line.error + self.bend) * GROW;
        line
    }

    /// Adds `factor` times `b`.
    pub fn add_scaled(&mut self, factor: f64, b: &Self) {
        *self = Self::combination(0.0, [(1.0, &*self), (factor, b)].into_iter());
    }

    /// `start` and the sum of all forms times their factors, rounded as a whole.
    pub fn combination<'f>(start: f64, terms: impl Iterator<Item = (f64, &'f Self)>) -> Self
    where
        'r: 'f,
    {
        let mut sum = QuadraticSum::new(start);
        terms.for_each(|(factor, form)| sum.add_scaled(factor, form));
        sum.finish()
    }

    /// The sum of products.
    pub fn sum_of_products<'f>(terms: impl Iterator<Item = (&'f Self, &'f Self)>) -> Self
    where
        'r: 'f,
    {
        let mut sum = QuadraticSum::new(0.0);
        terms.for_each(|(a, b)| sum.add_product(a, b));
        sum.finish()
    }

    /// Whether it is a number without an error.
    fn is_number(&self) -> bool {
        self.bend == 0.0 && self.line == AffineForm::within(self.line.value, 0.0)
    }

    /// A function that is known to the first order.
    fn by_line(self, of: impl Fn(AffineForm<N>) -> AffineForm<N>) -> Self {
        Self {
            room: self.room,
            ..Self::from(of(self.affine()))
        }
    }

    /// value + slope y - ½ (that function) y² and a third-order remainder: sine or cosine, whose second derivative is
    /// minus itself.
    fn wave_form(self, value: Interval, slope: Interval) -> Self {
        let (here, rate) = (value.middle(), slope.middle());
        let line = &self.line;
        let (radius, beyond) = (line.radius(), self.bend + line.error);
        let wide = (radius + beyond) * GROW;
        let mut bends = Vec::new();
        let lost = match self.room {
            None => 0.5 * here.abs() * radius * radius,
            Some(room) => {
                bends = room.blank();
                for k in 0..room.count() {
                    let slope = line.slopes[k];
                    bends.push(-0.5 * here * slope * slope);
                    let others = &line.slopes[k + 1..room.count()];
                    bends.extend(others.iter().map(|other| -here * slope * other));
                }
                for (bend, own) in bends.iter_mut().zip(self.bends) {
                    *bend += rate * own;
                }
                let outside = sum_of_magnitudes(&line.slopes[room.count()..]);
                here.abs() * radius * outside
            }
        };
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
        let line = AffineForm {
            value: here,
            slopes: line.slopes.map(|s| rate * s),
            error: open.iter().sum::<f64>() * GROW,
        };
        Self::from(line).bent(bends, self.room)
    }
}

mod operations;
#[cfg(test)]
mod tests;
