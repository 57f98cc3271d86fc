//! Trees of names to operations over slots.

use super::expression::{Node, NodeKind};
use crate::diag::{Diagnostic, Span};
use crate::model::expression::{Expression, Op};

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number known now.
    Constant(f64),
    /// A slot of the expression.
    Slot(usize),
}

/// Compiles `node`, asking `lookup` for every name.
pub fn compile(
    node: &Node,
    lookup: &dyn Fn(&str, &Span) -> Result<Value, Diagnostic>,
) -> Result<Expression, Diagnostic> {
    let mut ops = Vec::new();
    emit(node, lookup, &mut ops)?;
    Ok(Expression::new(ops))
}

/// Appends the operations of `node`; returns the index of its value.
fn emit(
    node: &Node,
    lookup: &dyn Fn(&str, &Span) -> Result<Value, Diagnostic>,
    ops: &mut Vec<Op>,
) -> Result<usize, Diagnostic> {
    let op = match &node.kind {
        NodeKind::Number(value) | NodeKind::Radians(value) => Op::Constant(*value),
        NodeKind::Name(name) => match lookup(name, &node.span)? {
            Value::Constant(value) => Op::Constant(value),
            Value::Slot(slot) => Op::Slot(slot),
        },
        NodeKind::Negate(inner) => Op::Negate(emit(inner, lookup, ops)?),
        NodeKind::Binary(sign, a, b) => {
            let (a, b) = (emit(a, lookup, ops)?, emit(b, lookup, ops)?);
            match sign {
                '+' => Op::Add(a, b),
                '-' => Op::Subtract(a, b),
                '*' => Op::Multiply(a, b),
                '/' => Op::Divide(a, b),
                _ => Op::Power(a, b),
            }
        }
        NodeKind::Call(function, args) => {
            // min and max of many are a row of calls of two.
            let mut value = emit(&args[0], lookup, ops)?;
            let mut last = Op::Call(*function, value, value);
            for (k, arg) in args.iter().enumerate().skip(1) {
                let right = emit(arg, lookup, ops)?;
                last = Op::Call(*function, value, right);
                if k + 1 < args.len() {
                    ops.push(last);
                    value = ops.len() - 1;
                }
            }
            last
        }
    };
    ops.push(op);
    Ok(ops.len() - 1)
}

/// The value of a constant expression, refused if it is not finite.
pub fn constant(
    node: &Node,
    lookup: &dyn Fn(&str, &Span) -> Result<Value, Diagnostic>,
) -> Result<f64, Diagnostic> {
    let value = compile(node, lookup)?.value(&[]);
    if value.is_finite() {
        return Ok(value);
    }
    Err(
        Diagnostic::error(format!("this formula has the value {value}"))
            .at(node.span.clone())
            .hint("every constant must be a finite number"),
    )
}
