//! Sums of affine forms under construction: their slopes are changed in place, and rounding is counted once.

use super::AffineForm;
use crate::numbers::form_room::FormRoom;
use crate::numbers::form_sum::{FormSum, SummedForm};
use crate::numbers::lists::{add_combinations, add_list};
use crate::numbers::rounding::{GROW, OPERATION, UNDERFLOW};
use crate::numbers::scalar::Sign;

/// Rounding of an addition to an error, generously.
const GROWN: f64 = 8.0 * OPERATION;

/// A sum so far.
pub struct AffineSum<'r> {
    pub value: f64,
    pub error: f64,
    slopes: Vec<f64>,
    room: Option<&'r FormRoom>,
    /// Terms, and the sum of their magnitudes: no partial sum is larger.
    count: f64,
    size: f64,
}

impl<'r> AffineSum<'r> {
    /// Where the result is kept.
    pub fn room(&self) -> Option<&'r FormRoom> {
        self.room
    }

    /// Notes where the result may be kept.
    pub fn note_room(&mut self, form: &AffineForm<'r>) {
        self.room = self.room.or(form.room);
    }

    /// Counts terms and their magnitude.
    pub fn count(&mut self, terms: f64, size: f64) {
        self.count += terms;
        self.size += size;
    }

    /// Adds value and slopes of a product. A value that is at most the share `ignored` of its form's slopes does not multiply those of
    /// the other one by one.
    pub fn add_line(
        &mut self,
        sign: Sign,
        (a, b): (&AffineForm<'r>, &AffineForm<'r>),
        ignored: f64,
    ) {
        let sign = sign.factor();
        self.value += sign * a.value * b.value;
        for (by, form) in [(a, b), (b, a)] {
            match by.value.abs() <= ignored * by.radius {
                true => self.error += by.value.abs() * form.radius,
                false => self.add_slopes(sign * by.value, form),
            }
        }
    }

    /// Makes space for so many slopes; `None` if there is no room.
    fn widen(&mut self, length: usize) -> Option<&mut [f64]> {
        if self.slopes.len() < length {
            if self.slopes.capacity() == 0 {
                self.slopes = self.room?.slopes().unset(0);
            }
            self.slopes.resize(length, 0.0);
        }
        Some(&mut self.slopes)
    }

    /// As many slopes, which mean nothing yet; `None` if there is no room.
    fn unset(&mut self, length: usize) -> Option<&mut [f64]> {
        self.slopes = self.room?.slopes().unset(length);
        Some(&mut self.slopes)
    }

    /// Counts `factor` times a form without its slopes.
    pub fn add_scaled_value(&mut self, factor: f64, b: &AffineForm<'r>) {
        self.note_room(b);
        if factor == 0.0 || b.is_zero() {
            // An unknown number stays unknown.
            self.error += if b.error.is_finite() { 0.0 } else { b.error };
            return;
        }
        self.value += factor * b.value;
        self.count(1.0, factor.abs() * (b.value.abs() + b.radius));
        self.error += factor.abs() * b.error;
    }

    fn add_slopes(&mut self, factor: f64, b: &AffineForm<'r>) {
        if self.slopes.capacity() == 0 {
            self.slopes = b.blank();
        }
        add_list(&mut self.slopes, factor, b.slopes);
    }
}

impl<'r> FormSum for AffineSum<'r> {
    type Form = AffineForm<'r>;
    type Factors = Vec<AffineForm<'r>>;

    fn factors(forms: Vec<AffineForm<'r>>, _: usize) -> Self::Factors {
        forms
    }

    fn add_products(&mut self, a: &Self::Factors, b: &Self::Factors) {
        a.iter().zip(b).for_each(|(a, b)| self.add_product(a, b));
    }

    fn new(start: f64) -> Self {
        Self {
            value: start,
            error: 0.0,
            slopes: Vec::new(),
            room: None,
            count: 1.0,
            size: start.abs(),
        }
    }

    fn add_scaled(&mut self, factor: f64, b: &AffineForm<'r>) {
        self.add_scaled_value(factor, b);
        if factor != 0.0 {
            self.add_slopes(factor, b);
        }
    }

    fn add_scaled_to_all(sums: &mut [&mut Self], factors: &[f64], forms: &[&AffineForm<'r>]) {
        for (sum, factors) in sums
            .iter_mut()
            .zip(factors.chunks_exact(forms.len().max(1)))
        {
            let terms = factors.iter().zip(forms);
            terms.for_each(|(factor, form)| sum.add_scaled_value(*factor, form));
        }
        let slopes: Vec<&[f64]> = forms.iter().map(|form| form.slopes).collect();
        let length = slopes.iter().map(|list| list.len()).max().unwrap_or(0);
        if length == 0 {
            return;
        }
        let are_unset = sums.iter().all(|sum| sum.slopes.capacity() == 0);
        let lists = sums.iter_mut().map(|sum| match are_unset {
            true => sum.unset(length),
            false => sum.widen(length),
        });
        // Slopes have a room, which the sums know now.
        let lists: Option<Vec<&mut [f64]>> = lists.collect();
        if let Some(mut lists) = lists {
            add_combinations(&mut lists, factors, &slopes, are_unset);
        }
    }

    fn add_signed_product(&mut self, sign: Sign, a: &AffineForm<'r>, b: &AffineForm<'r>) {
        for (number, other) in [(a, b), (b, a)] {
            if number.is_number() {
                return self.add_scaled(sign.factor() * number.value, other);
            }
        }
        self.note_room(a);
        self.note_room(b);
        self.add_line(sign, (a, b), 0.0);
        // Errors times values, what is of second order, underflow.
        let (far, wide) = (a.radius + a.error, b.radius + b.error);
        let (u, v) = (a.value.abs(), b.value.abs());
        self.error += u * b.error + v * a.error + far * wide + UNDERFLOW;
        // Three sums for a slope.
        self.count(3.0, (u + a.radius) * (v + b.radius));
    }

    fn finish(self) -> AffineForm<'r> {
        let (count, mut error) = (self.count, self.error);
        // A sum of products loses at most this many roundings of the sum of their magnitudes; errors are summed with as
        // many roundings.
        if count > 1.0 {
            let grown = 1.0 + count * GROWN;
            error = (error * grown + count * (OPERATION * self.size * GROW + UNDERFLOW)) * GROW;
        }
        AffineForm::within(self.value, error).sloped(self.slopes, self.room)
    }
}

impl<'r> SummedForm for AffineForm<'r> {
    type Sum = AffineSum<'r>;
}
