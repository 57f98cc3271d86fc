//! The ranges of the coordinates for all values of some dimensions, and their dependence on them.

use super::block_box::BlockBox;
use super::form::{DimensionForm, StoredForm};
use crate::numbers::form_room::FormRoom;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;

/// A coordinate with an interval around its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToleranceInterval {
    /// Coordinate: an input of the mechanism.
    pub slot: usize,
    /// Half the width of its interval, not negative.
    pub half_width: f64,
}

/// Enclosures of slots (coordinates, then what is computed from them) as functions of δ: dimension k is its value plus
/// δₖ times its half width.
#[derive(Clone, Debug)]
pub struct Region<'r, F> {
    /// The storage of the forms' coefficients.
    pub room: &'r FormRoom,
    /// Number of dimensions.
    pub count: usize,
    /// Every slot.
    pub slots: Vec<F>,
    /// Bound of the difference from [`Scalar::nominal`] at δ = 0.
    pub open: Vec<f64>,
    /// Derivatives of every slot by every δ, slot after slot.
    pub rates: Vec<F>,
    /// Results of the blocks that are enclosed.
    pub boxes: Vec<BlockBox>,
}

impl<'r, F: StoredForm<'r>> Region<'r, F> {
    /// Inputs of a pose with their tolerances; the unknowns are not enclosed yet. Input k as written is within
    /// `input_open[k]` of its value.
    pub fn new(
        room: &'r FormRoom,
        pose: &[f64],
        unknowns: usize,
        input_open: &[f64],
        list: &[ToleranceInterval],
    ) -> Self {
        let count = list.len();
        let mut region = Self {
            room,
            count,
            slots: pose.iter().map(|v| F::number(*v)).collect(),
            open: vec![0.0; pose.len()],
            rates: vec![F::number(0.0); pose.len() * count],
            boxes: Vec::new(),
        };
        for (k, open) in input_open.iter().enumerate() {
            region.open[unknowns + k] = *open;
        }
        for (slot, open) in region.open.iter().enumerate().skip(unknowns) {
            region.slots[slot] = F::linear(room, pose[slot], &[], *open);
        }
        for (k, tolerance) in list.iter().enumerate() {
            let slot = tolerance.slot;
            // A dimension is its nominal value plus its half width times a variable in -1..1.
            let mut slopes = vec![0.0; count];
            slopes[k] = tolerance.half_width;
            region.slots[slot] = F::linear(room, pose[slot], &slopes, region.open[slot]);
            region.rates[slot * count + k] = F::number(tolerance.half_width);
        }
        region
    }

    /// Appends a slot whose value at δ = 0 is in `centre` and whose derivatives are `rates`.
    pub fn push(&mut self, centre: Interval, rates: Vec<F>) {
        let value = centre.middle();
        let open = centre.distance(value);
        self.slots.push(match centre.is_finite() {
            true => F::integral(self.room, value, open, &rates),
            false => F::undefined(),
        });
        self.open.push(open);
        self.rates.extend(rates);
    }
}

impl<F: DimensionForm> Region<'_, F> {
    /// Derivatives of a slot by every δ.
    pub fn rates_of(&self, slot: usize) -> &[F] {
        &self.rates[slot * self.count..(slot + 1) * self.count]
    }

    /// How many of the first δ slots and their derivatives depend on.
    pub fn span_of(&self, slots: &[usize]) -> usize {
        let zero = F::number(0.0);
        let of_slot = |slot: &usize| {
            let rates = self.rates_of(*slot);
            let moved = rates.iter().rposition(|rate| *rate != zero);
            let spans = rates.iter().chain(std::iter::once(&self.slots[*slot]));
            let forms = spans.map(F::span).max().unwrap_or(0);
            forms.max(moved.map_or(0, |last| last + 1))
        };
        slots.iter().map(of_slot).max().unwrap_or(0)
    }

    /// All slots at δ = 0.
    pub fn centre(&self) -> Vec<Interval> {
        let pairs = self.slots.iter().zip(&self.open);
        pairs
            .map(|(form, open)| Interval::point(form.nominal()) + Interval::around_zero(*open))
            .collect()
    }

    /// Derivatives by every δ of a function of slots with this `gradient`.
    pub fn chain(&self, gradient: &[(usize, F)]) -> Vec<F> {
        let is_known: Vec<bool> = gradient.iter().map(|(_, by)| by.is_finite()).collect();
        let along = |k: usize| {
            let terms = gradient.iter().zip(&is_known);
            let terms = terms.map(|((slot, by), known)| (by, &self.rates_of(*slot)[k], *known));
            // What does not change with this one adds nothing.
            let moved = terms.filter(|(_, rate, known)| !*known || rate.as_number() != Some(0.0));
            F::sum_of_products(moved.map(|(by, rate, _)| (by, rate)))
        };
        (0..self.count).map(along).collect()
    }
}
