//! Writes formulas as text, as short as possible.

use super::node::{FormulaNode, NodeKind};
use crate::numbers::constant::Constant;
use std::f64::consts::PI;

/// The precedence of an operation.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Precedence {
    Sum,
    Product,
    Sign,
    Power,
    Atom,
}

/// The text of a formula.
pub fn written_formula(node: &FormulaNode) -> String {
    written_node(node).0
}

fn written_node(node: &FormulaNode) -> (String, Precedence) {
    match &node.kind {
        NodeKind::Number(value) => written_number(value.number()),
        NodeKind::Radians(value) => written_angle(*value),
        NodeKind::Name(name) => (name.clone(), Precedence::Atom),
        NodeKind::Of(_, inner) => written_node(inner),
        NodeKind::Negate(inner) => (
            format!("-{}", held_in(inner, Precedence::Sign)),
            Precedence::Sign,
        ),
        NodeKind::Binary(sign, a, b) => written_operation(*sign, a, b),
        NodeKind::Derivative(parts) => {
            let of = written_formula(&parts.of);
            let text = match parts.order {
                1 => format!("d({of}, {})", parts.by),
                order => format!("d({of}, {}, {order})", parts.by),
            };
            (text, Precedence::Atom)
        }
        NodeKind::Call(function, args) => {
            let args: Vec<String> = args.iter().map(written_formula).collect();
            (
                format!("{}({})", function.name(), args.join(", ")),
                Precedence::Atom,
            )
        }
    }
}

fn written_operation(sign: char, a: &FormulaNode, b: &FormulaNode) -> (String, Precedence) {
    // Sums, products and quotients group to the left, powers to the right: the other side needs a higher precedence.
    match sign {
        '+' => (
            format!(
                "{} + {}",
                held_in(a, Precedence::Sum),
                held_in(b, Precedence::Product)
            ),
            Precedence::Sum,
        ),
        '-' => (
            format!(
                "{} - {}",
                held_in(a, Precedence::Sum),
                held_in(b, Precedence::Product)
            ),
            Precedence::Sum,
        ),
        '^' => (
            format!(
                "{}^{}",
                held_in(a, Precedence::Atom),
                held_in(b, Precedence::Power)
            ),
            Precedence::Power,
        ),
        _ => {
            let text = format!(
                "{}{sign}{}",
                held_in(a, Precedence::Product),
                held_in(b, Precedence::Sign)
            );
            (text, Precedence::Product)
        }
    }
}

/// In parentheses if the position requires a higher precedence.
fn held_in(node: &FormulaNode, place: Precedence) -> String {
    let (text, hold) = written_node(node);
    match hold < place {
        true => format!("({text})"),
        false => text,
    }
}

fn written_number(value: f64) -> (String, Precedence) {
    let hold = if value < 0.0 {
        Precedence::Sign
    } else {
        Precedence::Atom
    };
    (format!("{value}"), hold)
}

/// An angle with its unit: in degrees if that is a short number.
fn written_angle(value: Constant) -> (String, Precedence) {
    let radians = value.number();
    if radians == PI {
        return ("pi".to_owned(), Precedence::Atom);
    }
    let degrees = radians.to_degrees();
    let round = (degrees * 1e6).round() / 1e6;
    let text = match (round.to_radians() - radians).abs() <= 1e-15 * radians.abs() {
        true => format!("{round}deg"),
        false => format!("{radians}rad"),
    };
    (
        text,
        if radians < 0.0 {
            Precedence::Sign
        } else {
            Precedence::Atom
        },
    )
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::expression::parse_expression;
    use super::*;

    #[test]
    fn formulas_are_written_so_that_they_read_the_same() {
        for (text, written) in [
            ("a", "a"),
            ("-L4", "-L4"),
            ("gamma-phi", "gamma - phi"),
            ("-(a+b)", "-(a + b)"),
            ("a-(b-c)", "a - (b - c)"),
            ("(a-b)-c", "a - b - c"),
            ("2*(a+b)/c", "2*(a + b)/c"),
            ("a/(b*c)", "a/(b*c)"),
            ("(-a)^2", "(-a)^2"),
            ("-a^2", "-a^2"),
            ("2^-b", "2^(-b)"),
            ("30deg", "30deg"),
            ("pi/2", "pi/2"),
            ("atan2(y, x + 1)", "atan2(y, x + 1)"),
        ] {
            let node = parse_expression(text, 0).unwrap();
            let again = written_formula(&node);
            assert_eq!(again, written);
            assert!(
                parse_expression(&again, 0).unwrap().is_alike(&node),
                "{text}"
            );
        }
    }
}
