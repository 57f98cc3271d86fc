//! Domains of formulas: the root of a negative number is undefined, whatever the rest of the formula contains.

use super::{Expression, Function, Op, extended_op};
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;
use std::f64::consts::PI;

/// Operands of roots, logarithms and powers with a fraction.
const NOT_BELOW_ZERO: Interval = Interval {
    lo: 0.0,
    hi: f64::INFINITY,
};

/// Sines and cosines.
const UP_TO_ONE: Interval = Interval { lo: -1.0, hi: 1.0 };

impl Expression {
    /// Contains all values of the formula for members of the slots where it is defined; `None` if it is proved to be
    /// undefined for all of them.
    pub fn range(&self, slots: &[Interval]) -> Option<Interval> {
        let mut values = Vec::with_capacity(self.ops().len());
        for op in self.ops() {
            confine_operands(*op, &mut values)?;
            values.push(all_values(*op, &values, slots));
        }
        Some(values.last().copied().unwrap_or(Interval::ZERO))
    }

    /// Whether a division by zero, the logarithm of zero or the angle of the origin may be among the members of the slots: there
    /// the formula has no value, whatever it makes of it.
    pub fn may_have_pole(&self, slots: &[Interval]) -> bool {
        let mut values = Vec::with_capacity(self.ops().len());
        self.ops().iter().any(|op| {
            if confine_operands(*op, &mut values).is_none() {
                return true;
            }
            let holds = |k: usize| values[k].holds_zero();
            let is_pole = match *op {
                Op::Divide(_, b) | Op::Call(Function::Mod, _, b) => holds(b),
                Op::Call(Function::Ln, a, _) => values[a].lo <= 0.0,
                Op::Call(Function::Atan2, a, b) => holds(a) && holds(b),
                Op::Power(a, b) => values[b].lo < 0.0 && holds(a),
                _ => false,
            };
            values.push(all_values(*op, &values, slots));
            is_pole
        })
    }

    /// The range, sharper over short stretches: also by its values in the middle and its rates (mean value form).
    pub fn sharp_range(&self, slots: &[Interval]) -> Option<Interval> {
        let all = self.range(slots)?;
        let rates = self.gradient(slots);
        // About kinks and jumps there are none.
        if !rates.iter().all(|rate| rate.is_finite()) {
            return Some(all);
        }
        let middles: Vec<Interval> = slots.iter().map(|s| Interval::point(s.middle())).collect();
        let ways = rates.iter().zip(slots.iter().zip(&middles));
        let near = ways.fold(self.range(&middles)?, |sum, (rate, (slot, middle))| {
            sum + *rate * (*slot - *middle)
        });
        Some(Interval::new(all.lo.max(near.lo), all.hi.min(near.hi)))
    }

    /// Whether none of its operations can lack a value.
    pub fn has_value_everywhere(&self) -> bool {
        let constant = |k: usize| match self.ops()[k] {
            Op::Constant(constant) => constant.number(),
            _ => f64::NAN,
        };
        self.ops().iter().all(|op| match *op {
            Op::Divide(_, b) => constant(b).abs() > 0.0,
            Op::Power(_, b) => constant(b) >= 0.0 && constant(b).fract() == 0.0,
            Op::Call(
                Function::Sqrt
                | Function::Ln
                | Function::Asin
                | Function::Acos
                | Function::Atan2
                | Function::Mod,
                ..,
            ) => false,
            _ => true,
        })
    }
}

/// All values of an operation, those on both sides of a jump included.
fn all_values(op: Op, values: &[Interval], slots: &[Interval]) -> Interval {
    let value = extended_op(op, values, slots);
    if value.is_finite() {
        return value;
    }
    let Op::Call(function, a, b) = op else {
        return value;
    };
    let (a, b) = (values[a], values[b]);
    match function {
        Function::Floor => Interval::new(a.lo.floor(), a.hi.floor()),
        // A remainder lies between zero and its divisor.
        Function::Mod => b.hull(Interval::ZERO),
        Function::Atan2 => Interval::around_zero(PI.next_up()),
        _ => value,
    }
}

/// Cuts the operands to where the operation has values; other operations that use them are asked for these only.
fn confine_operands(op: Op, values: &mut [Interval]) -> Option<()> {
    match op {
        Op::Divide(_, b) | Op::Call(Function::Mod, _, b) => refuse_zero(values[b]),
        Op::Call(Function::Sqrt, a, _) => confine_operand(&mut values[a], NOT_BELOW_ZERO),
        Op::Call(Function::Asin | Function::Acos, a, _) => {
            confine_operand(&mut values[a], UP_TO_ONE)
        }
        Op::Call(Function::Ln, a, _) => {
            confine_operand(&mut values[a], NOT_BELOW_ZERO)?;
            refuse_zero(values[a])
        }
        Op::Power(a, b) => {
            // A power with a fractional exponent needs a base of at least zero; a negative exponent, one other than
            // zero.
            let exponent = values[b];
            let whole = exponent.lo.floor();
            let has_fraction = whole < exponent.lo && exponent.hi < whole + 1.0;
            if has_fraction {
                confine_operand(&mut values[a], NOT_BELOW_ZERO)?;
            }
            match exponent.hi < 0.0 {
                true => refuse_zero(values[a]),
                false => Some(()),
            }
        }
        _ => Some(()),
    }
}

fn confine_operand(value: &mut Interval, domain: Interval) -> Option<()> {
    let (lo, hi) = (value.lo.max(domain.lo), value.hi.min(domain.hi));
    *value = Interval::new(lo, hi);
    (lo <= hi).then_some(())
}

fn refuse_zero(value: Interval) -> Option<()> {
    (value != Interval::ZERO).then_some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::constant::Constant;

    fn number(value: f64) -> Op {
        Op::Constant(Constant::exact(value))
    }

    fn called(function: Function) -> Expression {
        Expression::new(vec![Op::Slot(0), Op::Call(function, 0, 0)])
    }

    fn power(exponent: f64) -> Expression {
        Expression::new(vec![Op::Slot(0), number(exponent), Op::Power(0, 1)])
    }

    #[test]
    fn a_formula_has_no_value_where_its_operands_are_out_of_range() {
        let [sqrt, asin, ln] = [Function::Sqrt, Function::Asin, Function::Ln].map(called);
        let [root, inverse] = [0.5, -1.0].map(power);
        let over = Expression::new(vec![number(1.0), Op::Slot(0), Op::Divide(0, 1)]);
        // A formula, where it has no value, where it has some.
        let cases = [
            (&sqrt, [-2.0, -1e-300], [-2.0, 0.0]),
            (&asin, [1.0_f64.next_up(), 3.0], [1.0, 3.0]),
            (&ln, [-1.0, 0.0], [-1.0, 1e-300]),
            (&root, [-3.0, -1.0], [-3.0, 0.0]),
            (&inverse, [0.0, 0.0], [0.0, 1e-300]),
            (&over, [0.0, 0.0], [-1.0, 1.0]),
        ];
        for (formula, none, some) in cases {
            let [none, some] = [none, some].map(|[lo, hi]| Interval::new(lo, hi));
            assert_eq!(formula.range(&[none]), None, "{formula:?}");
            assert!(formula.range(&[some]).is_some(), "{formula:?}");
        }
        for formula in [&sqrt, &asin, &ln, &root, &inverse, &over] {
            assert!(!formula.has_value_everywhere(), "{formula:?}");
        }
        assert!(power(2.0).has_value_everywhere());
        // Whole powers and a third of a negative number in f64 have values or are not judged.
        assert!(power(3.0).range(&[Interval::point(-2.0)]).is_some());
        assert!(sqrt.range(&[Interval::ENTIRE]).is_some());
    }

    /// sqrt(1 - x^2) is between zero and one where it is a number at all.
    #[test]
    fn values_are_those_of_operands_in_range() {
        let formula = Expression::new(vec![
            number(1.0),
            Op::Slot(0),
            Op::Multiply(1, 1),
            Op::Subtract(0, 2),
            Op::Call(Function::Sqrt, 3, 3),
        ]);
        let range = formula.range(&[Interval::ENTIRE]);
        let is_right = |v: Interval| v.lo <= 0.0 && v.lo > -1e-12 && v.hi >= 1.0 && v.hi < 1.1;
        assert!(range.is_some_and(is_right), "{range:?}");
        let half = formula.range(&[Interval::point(0.6)]);
        let is_right = |v: Interval| v.lo <= 0.8 && v.hi >= 0.8 && v.hi - v.lo < 1e-12;
        assert!(half.is_some_and(is_right), "{half:?}");
    }

    /// |x| - floor(x) about kink and jump, sampled; and sin(x) - x sharper than its parts.
    #[test]
    fn values_on_both_sides_of_kinks_and_jumps_are_in_range() {
        let formula = Expression::new(vec![
            Op::Slot(0),
            Op::Call(Function::Abs, 0, 0),
            Op::Call(Function::Floor, 0, 0),
            Op::Subtract(1, 2),
        ]);
        for (from, to) in [(-0.5, 0.25), (-2.5, 1.5), (0.0, 1.0), (0.25, 0.75)] {
            let times = Interval::new(from, to);
            for range in [formula.range(&[times]), formula.sharp_range(&[times])] {
                let holds = |v: f64| range.is_some_and(|r| r.lo <= v && v <= r.hi);
                for k in 0..=64 {
                    let value = formula.value(&[from + (to - from) * f64::from(k) / 64.0]);
                    assert!(holds(value), "{from} {to} {value}");
                }
                assert!(!holds(-2.1) && !holds(5.6), "{range:?}");
            }
        }
        let bent = Expression::new(vec![
            Op::Slot(0),
            Op::Call(Function::Sin, 0, 0),
            Op::Subtract(1, 0),
        ]);
        let range = bent.sharp_range(&[Interval::new(0.0, 1e-3)]);
        let is_right =
            |r: Interval| (-1e-9..=-1.6e-10).contains(&r.lo) && (0.0..1e-9).contains(&r.hi);
        assert!(range.is_some_and(is_right), "{range:?}");
    }
}
