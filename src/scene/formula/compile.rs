//! Compiles expression trees with names to operations on numbered slots.

use super::node::{FormulaNode, NodeKind};
use crate::diag::{Diagnostic, Span};
use crate::model::expression::{Expression, Op};
use crate::numbers::constant::Constant;
use crate::numbers::scalar::Scalar;

/// The meaning of a name.
#[derive(Clone, Debug, PartialEq)]
pub enum CompiledValue {
    /// A number known now.
    Constant(Constant),
    /// A slot of the expression.
    Slot(usize),
    /// A formula over the same slots.
    Formula(Expression),
}

/// The error message for an empty formula.
const ZERO: Op = Op::Constant(Constant::exact(0.0));

/// Compiles `node`; `lookup` resolves names.
pub fn compile_formula(
    node: &FormulaNode,
    lookup: &dyn Fn(&str, &Span) -> Result<CompiledValue, Diagnostic>,
) -> Result<Expression, Diagnostic> {
    let mut ops = Vec::new();
    emit_node(node, lookup, &mut ops)?;
    Ok(Expression::new(ops))
}

/// Appends the operations of `node`; returns the index of its value.
fn emit_node(
    node: &FormulaNode,
    lookup: &dyn Fn(&str, &Span) -> Result<CompiledValue, Diagnostic>,
    ops: &mut Vec<Op>,
) -> Result<usize, Diagnostic> {
    let start = ops.len();
    let op = match &node.kind {
        NodeKind::Number(value) | NodeKind::Radians(value) => Op::Constant(*value),
        NodeKind::Name(name) => match lookup(name, &node.span)? {
            CompiledValue::Constant(value) => Op::Constant(value),
            CompiledValue::Slot(slot) => Op::Slot(slot),
            CompiledValue::Formula(formula) => {
                let (last, before) = formula.ops().split_last().unwrap_or((&ZERO, &[]));
                ops.extend(before.iter().map(|op| op.shifted(start)));
                last.shifted(start)
            }
        },
        NodeKind::Negate(inner) => Op::Negate(emit_node(inner, lookup, ops)?),
        NodeKind::Of(_, inner) => return emit_node(inner, lookup, ops),
        NodeKind::Binary(sign, a, b) => {
            let (a, b) = (emit_node(a, lookup, ops)?, emit_node(b, lookup, ops)?);
            match sign {
                '+' => Op::Add(a, b),
                '-' => Op::Subtract(a, b),
                '*' => Op::Multiply(a, b),
                '/' => Op::Divide(a, b),
                _ => Op::Power(a, b),
            }
        }
        NodeKind::Derivative(_) => {
            return Err(Diagnostic::error("a derivative cannot be used here")
                .at(node.span.clone())
                .hint("derivatives can be used in [outputs], in `of` of measures and in plots, but not in other derivatives"));
        }
        NodeKind::Call(function, args) => {
            // min and max of many arguments become nested calls of two.
            let mut value = emit_node(&args[0], lookup, ops)?;
            let mut last = Op::Call(*function, value, value);
            for (k, arg) in args.iter().enumerate().skip(1) {
                let right = emit_node(arg, lookup, ops)?;
                last = Op::Call(*function, value, right);
                if k + 1 < args.len() {
                    value = append_op(last, start, node, ops)?;
                }
            }
            last
        }
    };
    append_op(op, start, node, ops)
}

/// Appends the last operation of `node`, whose operations begin at `start`. Constants are folded here: an infinite
/// constant is rejected in any position, and the solver does not compute constants again.
fn append_op(
    op: Op,
    start: usize,
    node: &FormulaNode,
    ops: &mut Vec<Op>,
) -> Result<usize, Diagnostic> {
    let op = match constant_value(op, ops) {
        None => op,
        Some((value, _)) if value.is_finite() => {
            ops.truncate(start);
            Op::Constant(value)
        }
        Some((_, value)) => {
            let message = match value {
                _ if value.is_nan() => "this formula has no value".to_owned(),
                _ if value.is_infinite() => format!("this formula has the value {value}"),
                _ => "the value of this formula is not known to enough digits".to_owned(),
            };
            let hint = match value.is_finite() {
                true => "write it with numbers of a more usual size",
                false => "every constant must be a finite number",
            };
            return Err(Diagnostic::error(message).at(node.span.clone()).hint(hint));
        }
    };
    ops.push(op);
    Ok(ops.len() - 1)
}

/// The value of an operation on constants, in extended precision and as f64.
fn constant_value(op: Op, ops: &[Op]) -> Option<(Constant, f64)> {
    let known = |index: usize| match ops[index] {
        Op::Constant(value) => Some(value),
        _ => None,
    };
    let (a, b) = match op {
        Op::Constant(_) | Op::Slot(_) => return None,
        Op::Negate(a) => (a, a),
        Op::Add(a, b)
        | Op::Subtract(a, b)
        | Op::Multiply(a, b)
        | Op::Divide(a, b)
        | Op::Power(a, b)
        | Op::Call(_, a, b) => (a, b),
    };
    let operands = [Op::Constant(known(a)?), Op::Constant(known(b)?)];
    let moved = match op {
        Op::Negate(_) => Op::Negate(0),
        Op::Add(..) => Op::Add(0, 1),
        Op::Subtract(..) => Op::Subtract(0, 1),
        Op::Multiply(..) => Op::Multiply(0, 1),
        Op::Divide(..) => Op::Divide(0, 1),
        Op::Power(..) => Op::Power(0, 1),
        Op::Call(function, ..) => Op::Call(function, 0, 1),
        Op::Constant(_) | Op::Slot(_) => return None,
    };
    let expression = Expression::new([&operands[..], &[moved]].concat());
    Some((expression.value(&[]), expression.value(&[])))
}

/// The value of a constant expression in extended precision; it is finite.
pub fn exact_constant(
    node: &FormulaNode,
    lookup: &dyn Fn(&str, &Span) -> Result<CompiledValue, Diagnostic>,
) -> Result<Constant, Diagnostic> {
    Ok(compile_formula(node, lookup)?.value(&[]))
}

/// The same, rounded to f64.
pub fn constant_node(
    node: &FormulaNode,
    lookup: &dyn Fn(&str, &Span) -> Result<CompiledValue, Diagnostic>,
) -> Result<f64, Diagnostic> {
    exact_constant(node, lookup).map(Constant::number)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::expression::parse_expression;
    use super::*;

    fn compiled(text: &str) -> Result<Expression, Diagnostic> {
        compile_formula(&parse_expression(text, 0)?, &|name, _| {
            Ok(match name {
                "x" => CompiledValue::Slot(0),
                _ => CompiledValue::Constant(Constant::exact(3.0)),
            })
        })
    }

    #[test]
    fn constants_are_computed_once() {
        for (text, ops, value) in [
            ("2*n + 1", 1, 7.0),
            ("min(5, n, 4) * x", 3, 6.0),
            ("max(x, n, 4) + 1 - 1", 9, 4.0),
            ("-(2^n)*x", 3, -16.0),
        ] {
            let expression = compiled(text).unwrap();
            assert_eq!(expression.ops().len(), ops, "{text}");
            assert_eq!(expression.value(&[2.0]), value, "{text}");
        }
    }

    #[test]
    fn constants_without_a_value_are_refused_at_their_place() {
        for (text, place) in [
            ("1/0", 0..3),
            ("x + 1/(n - 3)", 4..12),
            ("sqrt(-n) + x", 0..8),
            ("min(x, 0^(-1))", 7..13),
        ] {
            let found = compiled(text).unwrap_err().span.unwrap();
            assert!(
                found.start >= place.start && found.end <= place.end + 1,
                "{text}: {found:?}"
            );
        }
        assert!(compiled("1/x").is_ok());
    }
}
