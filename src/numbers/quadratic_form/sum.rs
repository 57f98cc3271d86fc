//! Sums of quadratic forms under construction: their coefficients are changed in place.

use super::{OF_PRODUCT, QuadraticForm};
use crate::numbers::affine_form::sum::AffineSum;
use crate::numbers::affine_form::{AffineForm, add_list};
use crate::numbers::form_room::pair_count;
use crate::numbers::form_sum::{FormSum, SummedForm};
use crate::numbers::rounding::UNDERFLOW;

/// A value below this share of a form's slopes does not multiply second-order coefficients one by one.
const NEGLIGIBLE: f64 = 1e-6;

/// A sum so far.
pub struct QuadraticSum<'r> {
    line: AffineSum<'r>,
    bends: Vec<f64>,
}

impl<'r> QuadraticSum<'r> {
    fn add_bends(&mut self, factor: f64, form: &QuadraticForm<'r>) {
        if self.bends.capacity() == 0 {
            self.bends = form.blank();
        }
        add_list(&mut self.bends, factor, form.bends);
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
        if self.bends.capacity() == 0 {
            self.bends = room.bends().blank();
        }
        let (x, y) = (NonZeros::of(x), NonZeros::of(y));
        let span = x.slopes.len().max(y.slopes.len());
        if self.bends.len() < pair_count(span) {
            self.bends.resize(pair_count(span), 0.0);
        }
        for l in x.first.min(y.first)..span {
            let column = &mut self.bends[pair_count(l)..=pair_count(l) + l];
            let (p, q) = (x.at(l), y.at(l));
            column[l] += p * q;
            x.add_to(&mut column[..l], q);
            y.add_to(&mut column[..l], p);
        }
        0.0
    }
}

impl<'r> FormSum for QuadraticSum<'r> {
    type Form = QuadraticForm<'r>;

    fn new(start: f64) -> Self {
        Self {
            line: AffineSum::new(start),
            bends: Vec::new(),
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

    fn finish(self) -> QuadraticForm<'r> {
        QuadraticForm::from(self.line.finish()).bent(self.bends)
    }
}

/// Slopes from the first that is not zero.
struct NonZeros<'a> {
    slopes: &'a [f64],
    first: usize,
}

impl<'a> NonZeros<'a> {
    fn of(slopes: &'a [f64]) -> Self {
        let first = slopes.iter().position(|slope| *slope != 0.0);
        Self {
            slopes,
            first: first.unwrap_or(slopes.len()),
        }
    }

    fn at(&self, index: usize) -> f64 {
        self.slopes.get(index).copied().unwrap_or(0.0)
    }

    /// Adds `factor` times the slopes to a column.
    #[inline]
    fn add_to(&self, column: &mut [f64], factor: f64) {
        let end = column.len().min(self.slopes.len());
        if factor == 0.0 || self.first >= end {
            return;
        }
        let pairs = column[self.first..end]
            .iter_mut()
            .zip(&self.slopes[self.first..end]);
        pairs.for_each(|(sum, slope)| *sum += factor * slope);
    }
}

impl<'r> SummedForm for QuadraticForm<'r> {
    type Sum = QuadraticSum<'r>;
}
