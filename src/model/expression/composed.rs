//! Formulas in place of slots, and angles beyond the cut of `atan2`.

use super::{Expression, Function, Op, operand_places};
use crate::numbers::constant::Constant;

/// Longer formulas are not made.
const MOST_OPERATIONS: usize = 100_000;

impl Expression {
    /// The formula with other formulas in place of its slots; `None` where one has none, and of what would be too long.
    pub fn with_formulas<'e>(&self, of_slot: impl Fn(usize) -> Option<&'e Self>) -> Option<Self> {
        let mut ops: Vec<Op> = Vec::new();
        let mut places = Vec::with_capacity(self.ops().len());
        for op in self.ops() {
            match op {
                Op::Slot(slot) => {
                    let (formula, by) = (of_slot(*slot)?, ops.len());
                    ops.extend(formula.ops().iter().map(|op| op.mapped(|k| k + by)));
                }
                op => ops.push(op.mapped(|k| places[k])),
            }
            places.push(ops.len().checked_sub(1)?);
            if ops.len() > MOST_OPERATIONS {
                return None;
            }
        }
        Some(Self::new(ops))
    }

    /// Its largest parts that depend on slots which are `chosen`, and on no others, each with the sum of which it is a term, or
    /// with itself.
    pub fn parts_of(&self, chosen: impl Fn(usize) -> bool) -> Vec<[Self; 2]> {
        // Whether an operation depends on slots at all, and only on chosen ones; and an operation that uses it.
        let mut uses: Vec<(bool, bool)> = Vec::with_capacity(self.ops().len());
        let mut parents = vec![None; self.ops().len()];
        for (k, op) in self.ops().iter().enumerate() {
            let operands = operand_places(*op).into_iter().flatten();
            uses.push(match op {
                Op::Slot(slot) => (true, chosen(*slot)),
                _ => operands.clone().fold((false, true), |all, operand| {
                    (all.0 || uses[operand].0, all.1 && uses[operand].1)
                }),
            });
            operands.for_each(|operand| parents[operand] = Some(k));
        }
        let is_whole = |k: &usize| uses[*k] == (true, true);
        let is_largest = |k: &usize| is_whole(k) && parents[*k].is_none_or(|p| !is_whole(&p));
        let is_sum = |k: usize| {
            matches!(
                self.ops()[k],
                Op::Add(..) | Op::Subtract(..) | Op::Negate(_)
            )
        };
        let sum_of = |k: usize| {
            std::iter::successors(Some(k), |k| parents[*k].filter(|p| is_sum(*p)))
                .last()
                .unwrap_or(k)
        };
        let places = (0..self.ops().len()).filter(is_largest);
        places
            .map(|k| [k, sum_of(k)].map(|k| self.part_at(k)))
            .collect()
    }

    /// The largest magnitude of the terms that it is the sum of.
    pub fn largest_term(&self, slots: &[f64]) -> f64 {
        let mut values = Vec::with_capacity(self.ops().len());
        self.value_with(slots, &mut values);
        let mut open = Vec::from_iter(self.ops().len().checked_sub(1));
        let mut largest = 0.0;
        while let Some(k) = open.pop() {
            match self.ops()[k] {
                Op::Add(a, b) | Op::Subtract(a, b) => open.extend([a, b]),
                Op::Negate(a) => open.push(a),
                _ => largest = f64::max(largest, values[k].abs()),
            }
        }
        largest
    }

    /// The formula that ends in an operation.
    fn part_at(&self, end: usize) -> Self {
        let mut is_needed = vec![false; end + 1];
        is_needed[end] = true;
        for k in (0..=end).rev() {
            if is_needed[k] {
                let operands = operand_places(self.ops()[k]).into_iter().flatten();
                operands.for_each(|operand| is_needed[operand] = true);
            }
        }
        let (mut ops, mut places) = (Vec::new(), vec![0; end + 1]);
        for k in (0..=end).filter(|k| is_needed[*k]) {
            places[k] = ops.len();
            ops.push(self.ops()[k].mapped(|operand| places[operand]));
        }
        Self::new(ops)
    }

    /// The formula of the same direction whose cut is on the other side, if it is one `atan2` with terms beside it: no sum of both
    /// is other than a whole turn.
    pub fn turned(&self) -> Option<Self> {
        // A single `atan2`, which enters the sum as a term.
        let is_angle = |op: &Op| matches!(op, Op::Call(Function::Atan2, ..));
        let angle = self.ops().iter().position(is_angle)?;
        let only = self.ops().iter().filter(|op| is_angle(op)).count() == 1;
        (only && self.is_term(angle)).then(|| {
            let mut ops = Vec::with_capacity(self.ops().len() + 4);
            let mut places = Vec::with_capacity(self.ops().len());
            for (k, op) in self.ops().iter().enumerate() {
                match op.mapped(|k| places[k]) {
                    Op::Call(Function::Atan2, y, x) if k == angle => {
                        let at = ops.len();
                        // atan2(y, x) = atan2(-y, -x) ± π: the cut moves to the positive side of x.
                        ops.extend([
                            Op::Negate(y),
                            Op::Negate(x),
                            Op::Call(Function::Atan2, at, at + 1),
                            Op::Constant(Constant::PI),
                            Op::Add(at + 2, at + 3),
                        ]);
                    }
                    op => ops.push(op),
                }
                places.push(ops.len() - 1);
            }
            Self::new(ops)
        })
    }

    /// Whether an operation is a term of the whole sum, or its opposite is, and nothing else.
    fn is_term(&self, mut place: usize) -> bool {
        let ops = self.ops();
        while place + 1 < ops.len() {
            // The only operation that uses this one must be a sum or a change of sign.
            let mut users = ops.iter().enumerate().filter(|(_, op)| {
                let mut uses = false;
                op.mapped(|k| {
                    uses |= k == place;
                    k
                });
                uses
            });
            let (Some((user, op)), None) = (users.next(), users.next()) else {
                return false;
            };
            match op {
                Op::Add(a, b) | Op::Subtract(a, b) if a != b => {}
                Op::Negate(_) => {}
                _ => return false,
            }
            place = user;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::panic)]
    use super::*;
    use std::f64::consts::TAU;

    /// `s - atan2(y, x)` of two slots, and its double.
    fn angles() -> [Expression; 2] {
        let ops = vec![
            Op::Slot(0),
            Op::Slot(1),
            Op::Call(Function::Atan2, 0, 1),
            Op::Subtract(1, 2),
        ];
        let double = [&ops[..], &[Op::Add(3, 3)]].concat();
        [ops, double].map(Expression::new)
    }

    #[test]
    fn a_turned_angle_is_the_same_but_for_whole_turns() {
        let [angle, double] = angles();
        assert!(double.turned().is_none());
        let Some(turned) = angle.turned() else {
            panic!("{angle:?}");
        };
        for k in 0..50 {
            let (sin, cos) = (0.3 + 0.4 * f64::from(k)).sin_cos();
            let turns = (turned.value(&[sin, cos]) - angle.value(&[sin, cos])) / TAU;
            assert!((turns - turns.round()).abs() < 1e-14, "{k}: {turns}");
        }
    }

    #[test]
    fn a_formula_of_inputs_is_one_of_the_time() {
        let [angle, _] = angles();
        let drives = [
            vec![Op::Slot(0), Op::Call(Function::Sin, 0, 0)],
            vec![Op::Slot(0), Op::Multiply(0, 0), Op::Add(1, 0)],
        ]
        .map(Expression::new);
        let Some(whole) = angle.with_formulas(|slot| drives.get(slot)) else {
            panic!("{angle:?}");
        };
        for time in [0.1_f64, 0.7, 2.9] {
            let inputs = [time.sin(), time * time + time];
            let off = whole.value(&[time]) - angle.value(&inputs);
            assert!(off.abs() < 1e-15, "{time}: {off}");
        }
        assert!(angle.with_formulas(|slot| drives.get(slot + 1)).is_none());
    }
}
