//! Sums of quadratic forms under construction: their coefficients are changed in place.

use super::{OF_PRODUCT, QuadraticForm};
use crate::numbers::affine_form::AffineForm;
use crate::numbers::affine_form::sum::AffineSum;
use crate::numbers::form_room::packed_length;
use crate::numbers::form_sum::{FormSum, SummedForm};
use crate::numbers::lists::{
    FactorLists, add_combinations, add_long_list, add_symmetric_product, add_symmetric_products,
    in_lanes, set_to_two,
};
use crate::numbers::rounding::UNDERFLOW;
use crate::numbers::scalar::Sign;

/// A value below this share of a form's slopes does not multiply second-order coefficients one by one.
const NEGLIGIBLE: f64 = 1e-6;

/// Values that are nothing but rounding, as a share of their forms' slopes.
const INVISIBLE: f64 = 1e-13;

/// A sum so far.
pub struct QuadraticSum<'r> {
    line: AffineSum<'r>,
    bends: Vec<f64>,
}

/// Factors of several products with the lists of their slopes.
pub struct QuadraticFactors<'r> {
    forms: Vec<QuadraticForm<'r>>,
    slopes: FactorLists,
}

impl<'r> QuadraticSum<'r> {
    fn add_bends(&mut self, factor: f64, form: &QuadraticForm<'r>) {
        match form.room() {
            Some(room) if self.bends.capacity() == 0 => {
                self.bends = room.bends().unset(form.bends.len());
                set_to_two(&mut self.bends, (factor, form.bends), (0.0, &[]));
            }
            _ => add_long_list(&mut self.bends, factor, form.bends),
        }
    }

    /// Makes space for so many coefficients; `None` if there is no room.
    fn widen(&mut self, length: usize) -> Option<&mut [f64]> {
        if self.bends.len() < length {
            if self.bends.capacity() == 0 {
                self.bends = self.line.room()?.bends().unset(0);
            }
            self.bends.resize(length, 0.0);
        }
        Some(&mut self.bends)
    }

    /// So many coefficients, which mean nothing yet; `None` if there is no room.
    fn unset(&mut self, length: usize) -> Option<&mut [f64]> {
        self.bends = self.line.room()?.bends().unset(length);
        Some(&mut self.bends)
    }

    /// Adds the terms of second order from the slopes of both factors; returns a bound of what finds no space.
    fn add_product_of_slopes(&mut self, sign: Sign, a: &AffineForm<'r>, b: &AffineForm<'r>) -> f64 {
        let (x, y) = (a.slopes(), b.slopes());
        if x.is_empty() || y.is_empty() {
            return 0.0;
        }
        let span = x.len().max(y.len());
        match self.widen(packed_length(span)) {
            Some(bends) => {
                let (x, y) = (in_lanes(x, 1.0, span), in_lanes(y, sign.factor(), span));
                add_symmetric_product(bends, &x, &y, span);
                0.0
            }
            None => a.radius() * b.radius(),
        }
    }

    /// Adds the values of both factors times the terms of second order of the other; returns a bound of what is negligible.
    fn add_products_with_bends(
        &mut self,
        sign: Sign,
        a: &QuadraticForm<'r>,
        b: &QuadraticForm<'r>,
    ) -> f64 {
        let mut lost = 0.0;
        let both = [(&a.line, b), (&b.line, a)].map(|(line, form)| {
            // Beside its slopes such a value is nothing, and their product with the second order is an error.
            match line.value.abs() <= NEGLIGIBLE * line.radius() {
                true => {
                    lost += line.value.abs() * form.bend;
                    (0.0, &[][..])
                }
                false => (sign.factor() * line.value, form.bends),
            }
        });
        let [p, q] = both;
        match self.line.room() {
            Some(room) if self.bends.capacity() == 0 => {
                let spans = a.line.slopes().len().max(b.line.slopes().len());
                let length = packed_length(spans).max(p.1.len()).max(q.1.len());
                if length > 0 {
                    self.bends = room.bends().unset(length);
                    set_to_two(&mut self.bends, p, q);
                }
            }
            _ => {
                for ((factor, bends), form) in [p, q].into_iter().zip([b, a]) {
                    if !bends.is_empty() {
                        self.add_bends(factor, form);
                    }
                }
            }
        }
        lost
    }

    /// Adds a product of forms that are no numbers except for their terms of second order, of which `lost` is unknown. Values up to the
    /// share `ignored` of their slopes count as errors.
    fn add_rest_of_product(
        &mut self,
        sign: Sign,
        a: &QuadraticForm<'r>,
        b: &QuadraticForm<'r>,
        [lost, ignored]: [f64; 2],
    ) {
        let (u, v) = (a.line.value, b.line.value);
        let (rx, ry) = (a.line.radius(), b.line.radius());
        let line = &mut self.line;
        line.add_line(sign, (&a.line, &b.line), ignored);
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

    /// Counts `factor` times a form without the lists of its coefficients.
    fn add_scaled_value(&mut self, factor: f64, form: &QuadraticForm<'r>) {
        // An unknown number stays unknown.
        if factor == 0.0 && !form.bend.is_finite() {
            self.line.error = f64::INFINITY;
        }
        if factor != 0.0 && form.bend != 0.0 {
            self.line.count(1.0, factor.abs() * form.bend);
        }
    }

    /// Adds the product if one factor is a number.
    fn has_added_number(
        &mut self,
        sign: Sign,
        a: &QuadraticForm<'r>,
        b: &QuadraticForm<'r>,
    ) -> bool {
        for (number, other) in [(a, b), (b, a)] {
            if number.is_number() {
                self.add_scaled(sign.factor() * number.line.value, other);
                return true;
            }
        }
        self.line.note_room(&a.line);
        self.line.note_room(&b.line);
        false
    }
}

impl<'r> FormSum for QuadraticSum<'r> {
    type Form = QuadraticForm<'r>;
    type Factors = QuadraticFactors<'r>;

    fn new(start: f64) -> Self {
        Self {
            line: AffineSum::new(start),
            bends: Vec::new(),
        }
    }

    fn factors(forms: Vec<QuadraticForm<'r>>, span: usize) -> QuadraticFactors<'r> {
        let slopes = forms.iter().map(|form| form.line.slopes());
        let longest = slopes.clone().map(<[f64]>::len).max().unwrap_or(0);
        QuadraticFactors {
            slopes: FactorLists::new(slopes, span.max(longest)),
            forms,
        }
    }

    fn add_scaled(&mut self, factor: f64, form: &QuadraticForm<'r>) {
        self.line.add_scaled(factor, &form.line);
        self.add_scaled_value(factor, form);
        if factor != 0.0 && form.bend != 0.0 {
            self.add_bends(factor, form);
        }
    }

    fn add_scaled_to_all(sums: &mut [&mut Self], factors: &[f64], forms: &[&QuadraticForm<'r>]) {
        let lines: Vec<&AffineForm<'r>> = forms.iter().map(|form| &form.line).collect();
        let mut of_lines: Vec<&mut AffineSum<'r>> =
            sums.iter_mut().map(|sum| &mut sum.line).collect();
        AffineSum::add_scaled_to_all(&mut of_lines, factors, &lines);
        for (sum, factors) in sums
            .iter_mut()
            .zip(factors.chunks_exact(forms.len().max(1)))
        {
            let terms = factors.iter().zip(forms);
            terms.for_each(|(factor, form)| sum.add_scaled_value(*factor, form));
        }
        // Lists of those that have some.
        let bent = || {
            forms
                .iter()
                .enumerate()
                .filter(|(_, form)| form.bend != 0.0)
        };
        let lists: Vec<&[f64]> = bent().map(|(_, form)| form.bends).collect();
        let length = lists.iter().map(|list| list.len()).max().unwrap_or(0);
        if length == 0 {
            return;
        }
        let rows = factors.chunks_exact(forms.len().max(1));
        let factors: Vec<f64> = rows.flat_map(|row| bent().map(|(k, _)| row[k])).collect();
        let are_unset = sums.iter().all(|sum| sum.bends.capacity() == 0);
        let bends = sums.iter_mut().map(|sum| match are_unset {
            true => sum.unset(length),
            false => sum.widen(length),
        });
        // Bends have a room, which the sums know now.
        let bends: Option<Vec<&mut [f64]>> = bends.collect();
        if let Some(mut bends) = bends {
            add_combinations(&mut bends, &factors, &lists, are_unset);
        }
    }

    /// Adds a product, its terms up to the second order multiplied out in place.
    fn add_signed_product(&mut self, sign: Sign, a: &QuadraticForm<'r>, b: &QuadraticForm<'r>) {
        if !self.has_added_number(sign, a, b) {
            let lost = self.add_products_with_bends(sign, a, b)
                + self.add_product_of_slopes(sign, &a.line, &b.line);
            self.add_rest_of_product(sign, a, b, [lost, 0.0]);
        }
    }

    fn add_products(&mut self, a: &QuadraticFactors<'r>, b: &QuadraticFactors<'r>) {
        let pairs = || a.forms.iter().zip(&b.forms);
        let span = a.slopes.span();
        for (a, b) in pairs() {
            self.line.note_room(&a.line);
            self.line.note_room(&b.line);
        }
        let bends = match b.slopes.span() == span {
            true => self.widen(packed_length(span)),
            false => None,
        };
        let Some(bends) = bends else {
            pairs().for_each(|(a, b)| self.add_product(a, b));
            return;
        };
        // All products of slopes together; numbers have none.
        add_symmetric_products(bends, &a.slopes, &b.slopes);
        for (a, b) in pairs() {
            if !self.has_added_number(Sign::Plus, a, b) {
                let lost = self.add_products_with_bends(Sign::Plus, a, b);
                self.add_rest_of_product(Sign::Plus, a, b, [lost, INVISIBLE]);
            }
        }
    }

    fn finish(self) -> QuadraticForm<'r> {
        QuadraticForm::from(self.line.finish()).bent(self.bends)
    }
}

impl<'r> SummedForm for QuadraticForm<'r> {
    type Sum = QuadraticSum<'r>;
}
