//! Why a formula has no value: the first operation that makes none of numbers that are some.

use super::{Expression, Op, apply_op};
use crate::numbers::decimal::{significant, trimmed};

impl Expression {
    /// The first operation without a finite value, in words with its operands (`sqrt of -2`); `None` if the formula has
    /// a value.
    pub fn fault(&self, slots: &[f64]) -> Option<String> {
        let mut values = Vec::with_capacity(self.ops().len());
        for op in self.ops() {
            let value = apply_op(*op, &values, slots);
            if !value.is_finite() {
                return Some(fault_words(*op, &values));
            }
            values.push(value);
        }
        None
    }
}

fn fault_words(op: Op, values: &[f64]) -> String {
    let v = |k: usize| operand_text(values[k]);
    match op {
        Op::Constant(_) | Op::Slot(_) => "what it is made of has none".to_owned(),
        Op::Negate(a) => format!("- {}", v(a)),
        Op::Add(a, b) => format!("{} + {}", v(a), v(b)),
        Op::Subtract(a, b) => format!("{} - {}", v(a), v(b)),
        Op::Multiply(a, b) => format!("{} * {}", v(a), v(b)),
        Op::Divide(a, b) => format!("{} / {}", v(a), v(b)),
        Op::Power(a, b) => format!("{} ^ {}", v(a), v(b)),
        Op::Call(function, a, b) if function.accepts(1) || a == b => {
            format!("{} of {}", function.name(), v(a))
        }
        Op::Call(function, a, b) => format!("{} of {} and {}", function.name(), v(a), v(b)),
    }
}

/// An operand with at most six decimals, or with six digits if it is small or large.
fn operand_text(value: f64) -> String {
    match (1e-3..1e6).contains(&value.abs()) {
        true => trimmed(value, 6),
        false => significant(value, 6),
    }
}
