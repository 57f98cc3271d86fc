//! Enclosures of functions of the dimensions, to the first or the second order.

use crate::numbers::affine_form::AffineForm;
use crate::numbers::form_room::{FormRoom, packed_length};
use crate::numbers::form_sum::SummedForm;
use crate::numbers::quadratic_form::QuadraticForm;
use crate::numbers::rounding::{GROW, OPERATION};
use crate::numbers::scalar::Scalar;

/// The number type of enclosures.
pub trait DimensionForm: Scalar + SummedForm {
    /// Whether it has a second order.
    const BENT: bool;

    /// Change along the first δ; that along all others is zero.
    fn slopes(&self) -> &[f64];

    /// How many of the first δ it depends on.
    fn span(&self) -> usize;

    /// Bound of everything except its value and its slopes.
    fn beyond(&self) -> f64;

    /// The same with another value and a wider error.
    fn opened(self, by: f64) -> Self;

    /// The same with its error as the change along a number of its own, `index`, if there is room for it.
    fn marked(self, index: usize) -> Self;

    /// The same with everything that depends on numbers from `first` on moved into the error.
    fn folded(self, first: usize) -> Self;

    /// Bound of the linear part.
    fn radius(&self) -> f64;

    /// Bound of the difference from its value.
    fn deviation(&self) -> f64 {
        (self.radius() + self.beyond()) * GROW
    }

    /// Bound of the magnitude.
    fn magnitude(&self) -> f64 {
        (self.nominal().abs() + self.deviation()) * GROW
    }
}

/// Forms whose coefficients lie in a room.
pub trait StoredForm<'r>: DimensionForm {
    /// A number within `error` of `value`, with the given slopes by the dimensions.
    fn linear(room: &'r FormRoom, value: f64, slopes: &[f64], error: f64) -> Self;

    /// A function whose value at δ = 0 is within `open` of `value` and whose derivatives by every δ are `rates`.
    fn integral(room: &'r FormRoom, value: f64, open: f64, rates: &[Self]) -> Self;
}

impl DimensionForm for AffineForm<'_> {
    const BENT: bool = false;

    fn slopes(&self) -> &[f64] {
        Self::slopes(self)
    }

    fn span(&self) -> usize {
        Self::slopes(self).len()
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

    fn marked(self, index: usize) -> Self {
        self.marked(index)
    }

    fn folded(self, first: usize) -> Self {
        self.folded(first)
    }
}

impl<'r> StoredForm<'r> for AffineForm<'r> {
    fn linear(room: &'r FormRoom, value: f64, slopes: &[f64], error: f64) -> Self {
        Self::linear(room, value, slopes, error)
    }

    /// ∫ of the derivatives: half of their change is beyond the tangent.
    fn integral(room: &'r FormRoom, value: f64, open: f64, rates: &[Self]) -> Self {
        let bend = rates.iter().map(|rate| 0.5 * rate.radius() + rate.error);
        let error = (open + bend.sum::<f64>() * GROW) * GROW;
        let slopes: Vec<f64> = rates.iter().map(|rate| rate.value).collect();
        Self::linear(room, value, &slopes, error)
    }
}

impl DimensionForm for QuadraticForm<'_> {
    const BENT: bool = true;

    fn slopes(&self) -> &[f64] {
        self.line.slopes()
    }

    fn span(&self) -> usize {
        self.span()
    }

    fn radius(&self) -> f64 {
        self.line.radius()
    }

    fn beyond(&self) -> f64 {
        (self.line.error + self.bend()) * GROW
    }

    fn opened(mut self, by: f64) -> Self {
        self.line = self.line.opened(by);
        self
    }

    fn marked(mut self, index: usize) -> Self {
        self.line = self.line.marked(index);
        self
    }

    fn folded(self, first: usize) -> Self {
        self.folded(first)
    }
}

impl<'r> StoredForm<'r> for QuadraticForm<'r> {
    fn linear(room: &'r FormRoom, value: f64, slopes: &[f64], error: f64) -> Self {
        AffineForm::linear(room, value, slopes, error).into()
    }

    /// Half of the slopes are second-order coefficients; of those a third remains.
    fn integral(room: &'r FormRoom, value: f64, open: f64, rates: &[Self]) -> Self {
        let rest = rates.iter().map(|rate| rate.line.error + rate.bend() / 3.0);
        let slopes: Vec<f64> = rates.iter().map(|rate| rate.line.value).collect();
        let mut bends = room.bends().blank();
        let mut size = 0.0;
        for (k, rate) in rates.iter().enumerate() {
            let list = rate.line.slopes();
            // Of a rate that is constant nothing comes.
            if !list.is_empty() {
                let span = list.len().max(k + 1);
                bends.resize(bends.len().max(packed_length(span)), 0.0);
            }
            for (l, slope) in list.iter().enumerate() {
                // ∂²f/∂k∂l comes from both rates: half from each.
                bends[FormRoom::place(k.min(l), k.max(l))] += 0.5 * slope;
            }
            size += rate.line.radius();
        }
        let rounding = OPERATION * size;
        let error = (open + rest.sum::<f64>() * GROW + rounding) * GROW;
        Self::from(AffineForm::linear(room, value, &slopes, error)).bent(bends)
    }
}
