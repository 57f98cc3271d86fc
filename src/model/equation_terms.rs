//! The magnitude of an equation's terms at a pose: what its value is to be compared with.

use super::expression::{Function, Op};
use super::mechanism::Equation;

/// Magnitudes that differ by more than this factor are not of one kind: it is more than any low power makes of a factor of two.
pub const FAR: f64 = 64.0;

/// Rounding of a summand is an error of 1e-9 of this fraction of it: in x + 0.1 + 0.2 - 0.3, nothing else is left at the solution.
const ROUNDED: f64 = 1e-6;

impl Equation {
    /// The magnitude of its terms: its value, or the change when one of its coordinates is set to zero; half-way to it if there is a
    /// pole there, or nearly. At least [`ROUNDED`] of its largest summand. The pose is restored afterwards.
    pub fn terms(&self, pose: &mut [f64]) -> f64 {
        let value = self.expression.value(pose);
        // Beside a pole nothing is known of its summands either.
        let rounded = if value.is_finite() {
            ROUNDED * self.summand(pose)
        } else {
            0.0
        };
        let mut reach = finite_or_zero(value).max(rounded);
        for slot in self.expression.slots() {
            let [whole, half] =
                [1.0, 0.5].map(|share| self.change(pose, slot, -share * pose[slot]));
            let is_far = whole == 0.0 || whole > FAR * half;
            reach = reach.max(if is_far { half } else { whole });
        }
        reach
    }

    /// The magnitude of its largest summand, constants among them, or of its terms if that is more.
    pub fn largest_summand(&self, pose: &mut [f64]) -> f64 {
        self.summand(pose).max(self.terms(pose))
    }

    /// The magnitudes of all intermediate results, each times the rate at which the value follows it: times the relative error of
    /// numbers, how much rounding can change the value.
    pub fn sensitive_terms(&self, pose: &[f64]) -> f64 {
        let (mut values, mut rates) = (Vec::new(), Vec::new());
        let mut gradient = vec![0.0; pose.len()];
        let formula = &self.expression;
        formula.add_gradient(pose, 1.0, &mut gradient, &mut values, &mut rates);
        let terms = values.iter().zip(&rates);
        terms
            .map(|(value, rate)| finite_or_zero(value * rate))
            .sum()
    }

    /// Whether a product, quotient, power or exponential at a pose is too small for a number.
    pub fn sinks(&self, pose: &[f64]) -> bool {
        let mut values = Vec::new();
        self.expression.value_with(pose, &mut values);
        let ops = self.expression.ops().iter();
        ops.zip(&values).any(|(op, value)| {
            let from: &[usize] = match op {
                Op::Multiply(a, b) => &[*a, *b],
                Op::Divide(a, _) | Op::Power(a, _) => &[*a],
                Op::Call(Function::Exp, ..) => &[],
                _ => return false,
            };
            !value.is_normal() && value.is_finite() && from.iter().all(|k| values[*k] != 0.0)
        })
    }

    /// The magnitude of its largest summand at a pose, constants among them.
    pub fn summand(&self, pose: &[f64]) -> f64 {
        let mut values = Vec::new();
        self.expression.value_with(pose, &mut values);
        let mut largest = 0.0;
        // Sums inside products and above fraction bars are sums of the whole, with the other factor.
        let mut open = vec![(values.len().saturating_sub(1), 1.0)];
        while let Some((place, factor)) = open.pop() {
            let value = |k: usize| f64::abs(values[k]);
            match self.expression.ops().get(place) {
                Some(Op::Negate(a)) => open.push((*a, factor)),
                Some(Op::Add(a, b) | Op::Subtract(a, b)) => {
                    open.extend([(*a, factor), (*b, factor)]);
                }
                Some(Op::Multiply(a, b)) => {
                    open.extend([(*a, factor * value(*b)), (*b, factor * value(*a))]);
                }
                Some(Op::Divide(a, b)) => open.push((*a, factor / value(*b))),
                Some(_) => largest = f64::max(largest, finite_or_zero(factor * value(place))),
                None => {}
            }
        }
        largest
    }

    /// Change of its value when one coordinate changes; zero where it has none. The pose is restored afterwards.
    pub fn change(&self, pose: &mut [f64], slot: usize, by: f64) -> f64 {
        let (before, here) = (pose[slot], self.expression.value(pose));
        pose[slot] += by;
        let there = self.expression.value(pose);
        pose[slot] = before;
        finite_or_zero(there - here)
    }
}

/// The magnitude of a number, zero of what is none.
pub fn finite_or_zero(value: f64) -> f64 {
    if value.is_finite() { value.abs() } else { 0.0 }
}
