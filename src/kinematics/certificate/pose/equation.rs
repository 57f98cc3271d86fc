//! An equation of second degree at a pose: its value with 31 digits, and its derivatives by its forms.

use super::chain::affine_value;
use crate::model::expression::Affine;
use crate::model::expression::quadratic::QuadraticFormula;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::rounding::{DECIMAL, LONG_OPERATION, SLOPE};

/// Operations with sums of two f64 on the way from a term to a value, and one for their own rounding.
const OPERATIONS: f64 = 6.0;

/// Buffers of one equation.
#[derive(Clone, Debug, Default)]
pub struct EquationAtPose {
    /// Value of every factor, its uncertainty, and the sum of its terms' magnitudes.
    factors: Vec<(DoubleDouble, [f64; 2])>,
    /// Derivatives by the affine part, then by every factor, and their uncertainties.
    pub slopes: Vec<[f64; 2]>,
}

impl EquationAtPose {
    /// The value at coordinates and their rests, and its uncertainty from rounding and constants.
    pub fn evaluate(
        &mut self,
        formula: &QuadraticFormula,
        [coordinates, rests]: [&[f64]; 2],
    ) -> (DoubleDouble, f64) {
        let form = |form: &Affine| {
            let (value, open) = affine_value(form, coordinates, rests);
            let size = form_size(form, coordinates);
            let count = OPERATIONS + form.terms.len() as f64;
            (value, [open + count * LONG_OPERATION * size, size])
        };
        self.factors.clear();
        self.factors.extend(formula.factors.iter().map(form));
        self.slopes.clear();
        self.slopes.resize(1 + formula.factors.len(), [0.0; 2]);
        self.slopes[0] = [1.0, 0.0];
        let (mut value, [mut open, mut size]) = form(&formula.rest);
        for (factor, [a, b]) in &formula.products {
            let ((x, [open_x, size_x]), (y, [open_y, size_y])) =
                (self.factors[*a], self.factors[*b]);
            value = value + x * y * factor.value();
            let (largest, open_factor) = (factor.largest(), factor.error());
            open += largest * (open_x * (size_y + open_y) + size_x * open_y)
                + open_factor * size_x * size_y;
            size += largest * size_x * size_y;
            // The derivative of a product by each of its factors is the other one.
            let slope = factor.number();
            for (by, other, open_other) in [(a, y, open_y), (b, x, open_x)] {
                let [sum, open] = &mut self.slopes[1 + by];
                *sum += slope * other.hi;
                // In addition to the uncertainty: omitted second parts, and the rounding of a short sum.
                *open += largest * (open_other + SLOPE * other.hi.abs());
            }
        }
        let count = OPERATIONS + formula.products.len() as f64;
        (value, open + count * LONG_OPERATION * size)
    }

    /// Largest change of the value if every constant that f64 cannot represent differs by a unit in its last place;
    /// after an evaluation.
    pub fn last_units(&self, formula: &QuadraticFormula, coordinates: &[f64]) -> f64 {
        let units = |form: &Affine| {
            let terms = form.terms.iter();
            let terms = terms.map(|(slot, c)| (*c, coordinates[*slot]));
            let all = terms.chain([(form.constant, 1.0)]);
            let sizes = all
                .filter(|(c, _)| !c.is_exact())
                .map(|(c, x)| DECIMAL * c.largest() * x.abs());
            sizes.sum::<f64>()
        };
        let products = formula.products.iter().map(|(factor, [a, b])| {
            let size = |place: usize| self.factors[place].0.hi.abs();
            let own = if factor.is_exact() { 0.0 } else { DECIMAL };
            let (of_a, of_b) = (units(&formula.factors[*a]), units(&formula.factors[*b]));
            factor.largest() * (of_a * size(*b) + of_b * size(*a) + own * size(*a) * size(*b))
        });
        units(&formula.rest) + products.sum::<f64>()
    }
}

/// The sum of the sizes of a form's terms.
fn form_size(form: &Affine, coordinates: &[f64]) -> f64 {
    let terms = form.terms.iter();
    let sizes = terms.map(|(slot, c)| c.largest() * coordinates[*slot].abs());
    form.constant.largest() + sizes.sum::<f64>()
}
