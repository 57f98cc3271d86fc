//! Enclosures of functions of the dimensions, to the first or the second order.

use crate::numbers::affine_form::AffineForm;
use crate::numbers::form_room::FormRoom;
use crate::numbers::quadratic_form::QuadraticForm;
use crate::numbers::rounding::{GROW, OPERATION};
use crate::numbers::scalar::{Ring, Scalar};

/// The number type of enclosures.
pub trait DimensionForm: Scalar {
    /// Whether it has a second order.
    const BENT: bool;

    /// The storage of its coefficients.
    type Room: Copy;

    /// A number within `error` of `value`, with the given slopes by the dimensions.
    fn linear(room: Self::Room, value: f64, slopes: &[f64], error: f64) -> Self;

    /// A function whose value at δ = 0 is within `open` of `value` and whose derivatives by every δ are `rates`.
    fn integral(room: Self::Room, value: f64, open: f64, rates: &[Self]) -> Self;

    /// Adds `factor` times `b`.
    fn add_scaled(&mut self, factor: f64, b: &Self);

    /// The sum of products.
    fn sum_of_products<'f>(terms: impl Iterator<Item = (&'f Self, &'f Self)>) -> Self
    where
        Self: 'f,
    {
        let mut sum = Self::number(0.0);
        for (a, b) in terms {
            match (a.as_number(), b.as_number()) {
                (_, Some(number)) => sum.add_scaled(number, a),
                (Some(number), _) => sum.add_scaled(number, b),
                _ => sum = sum + *a * *b,
            }
        }
        sum
    }

    /// `start` and the sum of all forms times their factors.
    fn combination<'f>(start: f64, terms: impl Iterator<Item = (f64, &'f Self)>) -> Self
    where
        Self: 'f,
    {
        let mut sum = Self::number(start);
        terms.for_each(|(factor, form)| sum.add_scaled(factor, form));
        sum
    }

    /// Change along each δ.
    fn slopes(&self) -> &[f64];

    /// Bound of everything except its value and its slopes.
    fn beyond(&self) -> f64;

    /// The same with another value and a wider error.
    fn opened(self, by: f64) -> Self;

    /// The same with its error as the change along a number of its own, `index`, if there is space for it.
    fn marked(self, index: usize) -> Self;

    /// The same with everything that depends on numbers from `first` on moved into the error.
    fn folded(self, first: usize) -> Self;

    /// Bound of the linear part.
    fn radius(&self) -> f64 {
        self.slopes().iter().map(|s| s.abs()).sum::<f64>() * GROW
    }

    /// Bound of the difference from its value.
    fn deviation(&self) -> f64 {
        (self.radius() + self.beyond()) * GROW
    }

    /// Bound of the magnitude.
    fn magnitude(&self) -> f64 {
        (self.nominal().abs() + self.deviation()) * GROW
    }
}

impl<const N: usize> DimensionForm for AffineForm<N> {
    const BENT: bool = false;

    type Room = ();

    fn linear(_: (), value: f64, slopes: &[f64], error: f64) -> Self {
        let mut form = Self::within(value, error);
        form.slopes[..slopes.len()].copy_from_slice(slopes);
        form
    }

    /// ∫ of the derivatives: half of their change is beyond the tangent.
    fn integral(_: (), value: f64, open: f64, rates: &[Self]) -> Self {
        let bend = rates.iter().map(|rate| 0.5 * rate.radius() + rate.error);
        let mut form = Self::within(value, (open + bend.sum::<f64>() * GROW) * GROW);
        for (slope, rate) in form.slopes.iter_mut().zip(rates) {
            *slope = rate.value;
        }
        form
    }

    fn add_scaled(&mut self, factor: f64, b: &Self) {
        Self::add_scaled(self, factor, b);
    }

    fn combination<'f>(start: f64, terms: impl Iterator<Item = (f64, &'f Self)>) -> Self {
        Self::combination(start, terms)
    }

    fn slopes(&self) -> &[f64] {
        &self.slopes
    }

    fn radius(&self) -> f64 {
        Self::radius(self)
    }

    fn beyond(&self) -> f64 {
        self.error
    }

    fn opened(mut self, by: f64) -> Self {
        self.error = (self.error + self.value.abs() + by) * GROW;
        self.value = 0.0;
        self
    }

    fn marked(mut self, index: usize) -> Self {
        if let Some(slope) = self.slopes.get_mut(index) {
            *slope = std::mem::take(&mut self.error);
        }
        self
    }

    fn folded(mut self, first: usize) -> Self {
        let marks = self.slopes.iter_mut().skip(first);
        let sum: f64 = marks.map(|slope| std::mem::take(slope).abs()).sum();
        self.error = (self.error + sum * GROW) * GROW;
        self
    }
}

impl<'r, const N: usize> DimensionForm for QuadraticForm<'r, N> {
    const BENT: bool = true;

    type Room = &'r FormRoom;

    fn linear(room: &'r FormRoom, value: f64, slopes: &[f64], error: f64) -> Self {
        Self::within(AffineForm::linear((), value, slopes, error), room)
    }

    /// Half of the slopes are second-order coefficients; of those a third remains.
    fn integral(room: &'r FormRoom, value: f64, open: f64, rates: &[Self]) -> Self {
        let rest = rates.iter().map(|rate| rate.line.error + rate.bend() / 3.0);
        let mut line = AffineForm::number(value);
        let mut bends = room.zeros();
        let (mut size, mut outside) = (0.0, 0.0);
        for (k, rate) in rates.iter().enumerate() {
            line.slopes[k] = rate.line.value;
            for (l, slope) in rate.line.slopes.iter().enumerate() {
                // ∂²f/∂k∂l comes from both rates: half from each.
                match k.max(l) < room.count() {
                    true => bends[room.place(k.min(l), k.max(l))] += 0.5 * slope,
                    false => outside += 0.5 * slope.abs(),
                }
                size += slope.abs();
            }
        }
        let rounding = OPERATION * size;
        line.error = (open + outside + rest.sum::<f64>() * GROW + rounding) * GROW;
        Self::within(line, room).bent(bends, None)
    }

    fn add_scaled(&mut self, factor: f64, b: &Self) {
        Self::add_scaled(self, factor, b);
    }

    fn sum_of_products<'f>(terms: impl Iterator<Item = (&'f Self, &'f Self)>) -> Self
    where
        Self: 'f,
    {
        Self::sum_of_products(terms)
    }

    fn combination<'f>(start: f64, terms: impl Iterator<Item = (f64, &'f Self)>) -> Self
    where
        Self: 'f,
    {
        Self::combination(start, terms)
    }

    fn slopes(&self) -> &[f64] {
        &self.line.slopes
    }

    fn beyond(&self) -> f64 {
        (self.line.error + self.bend()) * GROW
    }

    fn opened(mut self, by: f64) -> Self {
        self.line = self.line.opened(by);
        self
    }

    fn marked(mut self, index: usize) -> Self {
        if index < self.span() {
            self.line = self.line.marked(index);
        }
        self
    }

    fn folded(mut self, first: usize) -> Self {
        self.line = self.line.folded(first);
        let span = self.span();
        if first >= span || self.bends().is_empty() {
            return self;
        }
        let mut bends = self.room().map_or(Vec::new(), FormRoom::blank);
        bends.extend_from_slice(self.bends());
        let mut sum = 0.0;
        let mut rows = &mut bends[..];
        for k in 0..span {
            let (row, rest) = rows.split_at_mut(span - k);
            for bend in row.iter_mut().skip(first.saturating_sub(k)) {
                sum += std::mem::take(bend).abs();
            }
            rows = rest;
        }
        self.line.error = (self.line.error + sum * GROW) * GROW;
        self.bent(bends, None)
    }
}
