//! Quadratic forms: value + Σ slopesₖ δₖ + Σ bendsₖₗ δₖ δₗ ± error encloses a function of δ in [-1, 1]ⁿ, as
//! [`AffineForm`] does to first order. Products and sines are of second order, other functions of first order. A
//! product takes n² operations, which pays if shared terms of second order cancel.
//!
//! Second-order coefficients are packed in a [`FormRoom`], row after row from the diagonal on.

use super::affine_form::sum::AffineSum;
use super::affine_form::{AffineForm, sum_of_magnitudes};
use super::form_room::FormRoom;
use super::interval::Interval;
use super::rounding::{GROW, OPERATION, UNDERFLOW};
use super::scalar::Scalar;

/// An enclosure of a function of δ in [-1, 1]ⁿ.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticForm<'r> {
    /// Value at δ = 0, slope along each δ, and a bound of everything that is not of first or second order. Its room is
    /// where results keep their coefficients of second order, too.
    pub line: AffineForm<'r>,
    /// Factors of δₖ δₗ for k ≤ l; empty if all are zero.
    bends: &'r [f64],
    /// Bound of the quadratic part.
    bend: f64,
}

/// Roundings in a coefficient of a product, generously: four products and their sum.
const OF_PRODUCT: f64 = 8.0 * OPERATION;

/// A value below this share of a form's slopes does not multiply second-order coefficients one by one.
const NEGLIGIBLE: f64 = 1e-6;

/// A sum under construction: its coefficients are changed in place.
struct QuadraticSum<'r> {
    line: AffineSum<'r>,
    bends: Vec<f64>,
}

impl<'r> QuadraticSum<'r> {
    fn new(start: f64) -> Self {
        Self {
            line: AffineSum::new(start),
            bends: Vec::new(),
        }
    }

    fn add_bends(&mut self, factor: f64, form: &QuadraticForm<'r>) {
        if self.bends.is_empty() {
            self.bends = form.blank();
            self.bends
                .extend(form.bends.iter().map(|added| factor * added));
            return;
        }
        for (bend, added) in self.bends.iter_mut().zip(form.bends) {
            *bend += factor * added;
        }
    }

    fn add_scaled(&mut self, factor: f64, form: &QuadraticForm<'r>) {
        // An unknown number stays unknown.
        if factor == 0.0 && !form.bend.is_finite() {
            self.line.error = f64::INFINITY;
        }
        self.line.add_scaled(factor, &form.line);
        if factor != 0.0 && form.bend != 0.0 {
            self.add_bends(factor, form);
            self.line.count(1.0, factor.abs() * form.bend);
        }
    }

    /// Adds a product, its terms up to the second order multiplied out in place.
    fn add_product(&mut self, a: &QuadraticForm<'r>, b: &QuadraticForm<'r>) {
        for (number, other) in [(a, b), (b, a)] {
            if number.is_number() {
                return self.add_scaled(number.line.value, other);
            }
        }
        self.line.note_room(&a.line);
        self.line.note_room(&b.line);
        let (u, v) = (a.line.value, b.line.value);
        let (rx, ry) = (a.line.radius(), b.line.radius());
        let mut lost = self.add_product_of_slopes(&a.line, &b.line);
        for (factor, reach, form) in [(u, rx, b), (v, ry, a)] {
            // Beside its slopes such a value is nothing, and their product with the second order is an error below.
            match factor.abs() <= NEGLIGIBLE * reach {
                true => lost += factor.abs() * form.bend,
                false => self.add_bends(factor, form),
            }
        }
        let line = &mut self.line;
        line.add_line(&a.line, &b.line);
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
        line.count(3.0, far * wide);
    }

    /// Adds the terms of second order from the slopes of both factors; returns a bound of what finds no space.
    fn add_product_of_slopes(&mut self, a: &AffineForm<'r>, b: &AffineForm<'r>) -> f64 {
        let (x, y) = (a.slopes(), b.slopes());
        if x.is_empty() || y.is_empty() {
            return 0.0;
        }
        let Some(room) = self.line.room() else {
            return a.radius() * b.radius();
        };
        let after = |k: usize| x[k + 1..].iter().zip(&y[k + 1..]);
        if self.bends.is_empty() {
            self.bends = room.bends().blank();
            for (k, (p, q)) in x.iter().zip(y).enumerate() {
                self.bends.push(p * q);
                self.bends.extend(after(k).map(|(x, y)| p * y + x * q));
            }
            return 0.0;
        }
        let mut rows = &mut self.bends[..];
        for (k, (p, q)) in x.iter().zip(y).enumerate() {
            let (row, rest) = rows.split_at_mut(x.len() - k);
            row[0] += p * q;
            for (bend, (x, y)) in row[1..].iter_mut().zip(after(k)) {
                *bend += p * y + x * q;
            }
            rows = rest;
        }
        0.0
    }

    fn finish(self) -> QuadraticForm<'r> {
        QuadraticForm::from(self.line.finish()).bent(self.bends)
    }
}

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
        let bend = sum_of_magnitudes(&bends) * GROW;
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
        let place = self.room().map_or(0, |room| room.place(k, l));
        self.bends.get(place).copied().unwrap_or(0.0)
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
        let Some(span) = self
            .room()
            .map(FormRoom::count)
            .filter(|span| first < *span)
        else {
            return Self { line, ..self };
        };
        let mut bends = self.blank();
        bends.extend_from_slice(self.bends);
        let mut folded = Self::from(line);
        let (mut sum, mut rows) = (0.0, &mut bends[..]);
        for k in 0..span {
            let Some((row, rest)) = rows.split_at_mut_checked(span - k) else {
                break;
            };
            for bend in row.iter_mut().skip(first.saturating_sub(k)) {
                sum += std::mem::take(bend).abs();
            }
            rows = rest;
        }
        folded.line.error = (folded.line.error + sum * GROW) * GROW;
        folded.bent(bends)
    }

    /// The same to first order: the quadratic part goes into the error.
    pub fn affine(&self) -> AffineForm<'r> {
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
                for (k, slope) in line.slopes().iter().enumerate() {
                    bends.push(-0.5 * here * slope * slope);
                    let others = &line.slopes()[k + 1..];
                    bends.extend(others.iter().map(|other| -here * slope * other));
                }
                for (bend, own) in bends.iter_mut().zip(self.bends) {
                    *bend += rate * own;
                }
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
#[cfg(test)]
mod tests;
