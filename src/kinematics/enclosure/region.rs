//! Where the coordinates are for all values of some dimensions, and how they change with them.

use crate::numbers::affine_form::AffineForm;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::Scalar;

/// A coordinate that lies within `half_width` of its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Coordinate: an input of the mechanism.
    pub slot: usize,
    /// Half the width of its interval, not negative.
    pub half_width: f64,
}

/// Enclosures of slots (coordinates, then what is computed from them) as functions of δ: dimension k is its value plus
/// δₖ times its half width.
#[derive(Clone, Debug)]
pub struct Region<const N: usize> {
    /// Number of dimensions, at most `N`.
    pub count: usize,
    /// Every slot.
    pub slots: Vec<AffineForm<N>>,
    /// Bound of the difference from [`AffineForm::value`] at δ = 0.
    pub open: Vec<f64>,
    /// Derivatives of every slot by every δ, slot after slot.
    pub rates: Vec<AffineForm<N>>,
}

impl<const N: usize> Region<N> {
    /// Inputs of a pose with their tolerances; the unknowns are not enclosed yet. Input k is meant within `input_open[k]` of
    /// its value.
    pub fn new(pose: &[f64], unknowns: usize, input_open: &[f64], list: &[Tolerance]) -> Self {
        let count = list.len();
        let mut region = Self {
            count,
            slots: pose.iter().map(|v| AffineForm::within(*v, 0.0)).collect(),
            open: vec![0.0; pose.len()],
            rates: vec![AffineForm::ZERO; pose.len() * count],
        };
        for (k, open) in input_open.iter().enumerate() {
            region.open[unknowns + k] = *open;
            region.slots[unknowns + k].error = *open;
        }
        for (k, tolerance) in list.iter().enumerate() {
            let slot = tolerance.slot;
            region.slots[slot] = region.slots[slot].moving(k, tolerance.half_width);
            region.rates[slot * count + k].value = tolerance.half_width;
        }
        region
    }

    /// Derivatives of a slot by every δ.
    pub fn rates_of(&self, slot: usize) -> &[AffineForm<N>] {
        &self.rates[slot * self.count..(slot + 1) * self.count]
    }

    /// All slots at δ = 0.
    pub fn centre(&self) -> Vec<Interval> {
        let pairs = self.slots.iter().zip(&self.open);
        pairs
            .map(|(form, open)| Interval::point(form.value) + Interval::around_zero(*open))
            .collect()
    }

    /// Derivatives by every δ of what changes with slots as `gradient` says.
    pub fn chain(&self, gradient: &[(usize, AffineForm<N>)]) -> Vec<AffineForm<N>> {
        let mut rates = vec![AffineForm::ZERO; self.count];
        for (slot, by_slot) in gradient {
            for (rate, of_slot) in rates.iter_mut().zip(self.rates_of(*slot)) {
                *rate = *rate + *by_slot * *of_slot;
            }
        }
        rates
    }

    /// Appends a slot whose value at δ = 0 is in `centre` and whose derivatives are `rates`.
    pub fn push(&mut self, centre: Interval, rates: Vec<AffineForm<N>>) {
        let value = centre.middle();
        let open = centre.distance(value);
        let mut form = AffineForm::within(value, open + bend_bound(&rates));
        for (slope, rate) in form.slopes.iter_mut().zip(&rates) {
            *slope = rate.value;
        }
        if !centre.is_finite() {
            form = AffineForm::undefined();
        }
        self.slots.push(form);
        self.open.push(open);
        self.rates.extend(rates);
    }
}

/// What a function departs from its tangent by, where its derivatives are `rates`: ∫ of them along the way.
pub fn bend_bound<const N: usize>(rates: &[AffineForm<N>]) -> f64 {
    let parts = rates.iter().map(|rate| 0.5 * rate.radius() + rate.error);
    parts.sum::<f64>() * GROW
}
