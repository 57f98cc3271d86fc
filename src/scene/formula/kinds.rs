//! Infers the kinds (length, angle, number) of the parts of a formula, and converts its numbers from the file's angle
//! unit to radians.
//!
//! Rule: in a position where an angle is expected, a part that contains no angle itself (`Ry(180)`, `beta + 30`) is in
//! the file's angle unit. In a file in radians nothing is converted.

use super::node::{FormulaNode, NodeKind};
use crate::diag::Span;
use crate::model::expression::Function;
use crate::model::mechanism::Kind;
use crate::numbers::constant::Constant;

/// Reports to `note` the kind of each name in `node`, if the position requires the kind `wanted`.
pub fn infer_kind(
    node: &FormulaNode,
    wanted: Option<Kind>,
    note: &mut dyn FnMut(&str, Kind, &Span),
) {
    match &node.kind {
        NodeKind::Number(_) | NodeKind::Radians(_) => {}
        NodeKind::Name(name) => {
            if let Some(kind) = wanted {
                note(name, kind, &node.span);
            }
        }
        NodeKind::Negate(inner) => infer_kind(inner, wanted, note),
        NodeKind::Angle(inner) => infer_kind(inner, Some(Kind::Angle), note),
        NodeKind::Binary('+' | '-', a, b) => {
            infer_kind(a, wanted, note);
            infer_kind(b, wanted, note);
        }
        NodeKind::Binary(sign, a, b) => {
            // A literal factor leaves the kind to the other factor; any other product determines nothing.
            let keeps_a = is_literal(b) && *sign != '^';
            let keeps_b = is_literal(a) && *sign == '*';
            infer_kind(a, wanted.filter(|_| keeps_a), note);
            infer_kind(b, wanted.filter(|_| keeps_b), note);
        }
        NodeKind::Derivative(parts) => infer_kind(&parts.of, None, note),
        NodeKind::Call(function, args) => {
            let inner = argument_kind(*function, wanted);
            args.iter().for_each(|arg| infer_kind(arg, inner, note));
        }
    }
}

/// The kinds of a function's arguments if its own position requires `wanted`.
fn argument_kind(function: Function, wanted: Option<Kind>) -> Option<Kind> {
    match function {
        Function::Sin | Function::Cos | Function::Tan => Some(Kind::Angle),
        Function::Abs | Function::Min | Function::Max | Function::Mod | Function::Hypot => wanted,
        _ => None,
    }
}

fn is_literal(node: &FormulaNode) -> bool {
    match &node.kind {
        NodeKind::Number(_) => true,
        NodeKind::Negate(inner) => is_literal(inner),
        NodeKind::Binary(_, a, b) => is_literal(a) && is_literal(b),
        _ => false,
    }
}

/// Converts angles from the file's unit to radians: `radians` is the size of one unit, `is_angle` recognises names of
/// angles.
pub fn to_radians(
    node: FormulaNode,
    wanted: Option<Kind>,
    radians: Constant,
    is_angle: &dyn Fn(&str) -> bool,
) -> FormulaNode {
    if radians == Constant::exact(1.0) {
        return node;
    }
    convert_kind(node, wanted, radians, is_angle)
}

fn convert_kind(
    node: FormulaNode,
    wanted: Option<Kind>,
    radians: Constant,
    is_angle: &dyn Fn(&str) -> bool,
) -> FormulaNode {
    let recurse = |n: Box<FormulaNode>, kind: Option<Kind>| {
        Box::new(convert_kind(*n, kind, radians, is_angle))
    };
    let wants_angle = wanted == Some(Kind::Angle);
    // An angle is wanted and a plain number found: it is in the file's unit, and is multiplied once, as a whole.
    if wants_angle && !is_sum(&node.kind) && !holds_angle(&node, is_angle) {
        let span = node.span.clone();
        let factor = Box::new(FormulaNode::number(radians, span.clone()));
        let inner = Box::new(convert_kind(node, None, radians, is_angle));
        return FormulaNode {
            kind: NodeKind::Binary('*', inner, factor),
            span,
        };
    }
    let span = node.span;
    // Terms of a sum are of the kind of the sum, and factors are plain.
    let kind = match node.kind {
        NodeKind::Negate(inner) => NodeKind::Negate(recurse(inner, wanted)),
        NodeKind::Angle(inner) => NodeKind::Angle(recurse(inner, Some(Kind::Angle))),
        NodeKind::Binary(sign @ ('+' | '-'), a, b) => {
            NodeKind::Binary(sign, recurse(a, wanted), recurse(b, wanted))
        }
        NodeKind::Binary(sign, a, b) => NodeKind::Binary(sign, recurse(a, None), recurse(b, None)),
        NodeKind::Call(function, args) => {
            let inner = argument_kind(function, wanted);
            NodeKind::Call(
                function,
                args.into_iter()
                    .map(|a| convert_kind(a, inner, radians, is_angle))
                    .collect(),
            )
        }
        leaf => leaf,
    };
    FormulaNode { kind, span }
}

/// Operations whose operands all have the kind of the result.
fn is_sum(kind: &NodeKind) -> bool {
    match kind {
        NodeKind::Negate(_) | NodeKind::Binary('+' | '-', ..) => true,
        NodeKind::Call(function, _) => {
            argument_kind(*function, Some(Kind::Length)) == Some(Kind::Length)
        }
        _ => false,
    }
}

fn holds_angle(node: &FormulaNode, is_angle: &dyn Fn(&str) -> bool) -> bool {
    match &node.kind {
        NodeKind::Number(_) => false,
        NodeKind::Radians(_) | NodeKind::Angle(_) => true,
        NodeKind::Name(name) => is_angle(name),
        NodeKind::Negate(inner) => holds_angle(inner, is_angle),
        NodeKind::Binary(_, a, b) => holds_angle(a, is_angle) || holds_angle(b, is_angle),
        NodeKind::Derivative(_) => false,
        NodeKind::Call(function, args) => match function {
            Function::Asin | Function::Acos | Function::Atan | Function::Atan2 => true,
            Function::Sin | Function::Cos | Function::Tan => false,
            _ => args.iter().any(|a| holds_angle(a, is_angle)),
        },
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::compile::{CompiledValue, compile_formula};
    use super::super::expression::parse_expression;
    use super::*;

    /// Value of `text` in the position of an angle, in a file in degrees, where `a` is an angle of 1 rad and `n` is 3.
    fn in_degrees(text: &str) -> f64 {
        let node = to_radians(
            parse_expression(text, 0).unwrap(),
            Some(Kind::Angle),
            Constant::PI / Constant::exact(180.0),
            &|n| n == "a",
        );
        let lookup = |name: &str, _: &Span| {
            Ok(CompiledValue::Constant(Constant::exact(if name == "a" {
                1.0
            } else {
                3.0
            })))
        };
        compile_formula(&node, &lookup).unwrap().value(&[])
    }

    #[test]
    fn numbers_in_angle_places_are_degrees_and_others_are_not() {
        let degree = std::f64::consts::PI / 180.0;
        for (text, radians) in [
            ("90", 90.0 * degree),
            ("180 - a", 180.0 * degree - 1.0),
            ("2*a", 2.0),
            ("n*15", 45.0 * degree),
            ("pi/2", 90.0 * degree),
            ("30rad", 30.0),
            ("atan2(1, 1)", 45.0 * degree),
            ("2*sin(30)", 2.0 * 0.5 * degree),
            ("-(n + 10)", -13.0 * degree),
        ] {
            assert!(
                (in_degrees(text) - radians).abs() < 1e-12,
                "{text}: {} {radians}",
                in_degrees(text)
            );
        }
    }

    #[test]
    fn kinds_follow_from_places() {
        let mut seen = Vec::new();
        infer_kind(
            &parse_expression("a + 2*b - c*d + sin(e)", 0).unwrap(),
            Some(Kind::Length),
            &mut |n, k, _| seen.push((n.to_owned(), k)),
        );
        let want = [("a", Kind::Length), ("b", Kind::Length), ("e", Kind::Angle)];
        assert_eq!(seen, want.map(|(n, k)| (n.to_owned(), k)));
    }
}
