//! Writes formulas as text, as short as possible.

use super::node::{FormulaNode, NodeKind};
use crate::numbers::constant::Constant;
use std::f64::consts::PI;

/// The precedence of an operation.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Hold {
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

fn written_node(node: &FormulaNode) -> (String, Hold) {
    match &node.kind {
        NodeKind::Number(value) => written_number(value.number()),
        NodeKind::Radians(value) => written_angle(*value),
        NodeKind::Name(name) => (name.clone(), Hold::Atom),
        NodeKind::Angle(inner) => written_node(inner),
        NodeKind::Negate(inner) => (format!("-{}", held_in(inner, Hold::Sign)), Hold::Sign),
        NodeKind::Binary(sign, a, b) => written_operation(*sign, a, b),
        NodeKind::Derivative(parts) => {
            let of = written_formula(&parts.of);
            let text = match parts.order {
                1 => format!("d({of}, {})", parts.by),
                order => format!("d({of}, {}, {order})", parts.by),
            };
            (text, Hold::Atom)
        }
        NodeKind::Call(function, args) => {
            let args: Vec<String> = args.iter().map(written_formula).collect();
            (
                format!("{}({})", function.name(), args.join(", ")),
                Hold::Atom,
            )
        }
    }
}

fn written_operation(sign: char, a: &FormulaNode, b: &FormulaNode) -> (String, Hold) {
    match sign {
        '+' => (
            format!("{} + {}", held_in(a, Hold::Sum), held_in(b, Hold::Product)),
            Hold::Sum,
        ),
        '-' => (
            format!("{} - {}", held_in(a, Hold::Sum), held_in(b, Hold::Product)),
            Hold::Sum,
        ),
        '^' => (
            format!("{}^{}", held_in(a, Hold::Atom), held_in(b, Hold::Power)),
            Hold::Power,
        ),
        _ => {
            let text = format!(
                "{}{sign}{}",
                held_in(a, Hold::Product),
                held_in(b, Hold::Sign)
            );
            (text, Hold::Product)
        }
    }
}

/// In parentheses if the position requires a higher precedence.
fn held_in(node: &FormulaNode, place: Hold) -> String {
    let (text, hold) = written_node(node);
    match hold < place {
        true => format!("({text})"),
        false => text,
    }
}

fn written_number(value: f64) -> (String, Hold) {
    let hold = if value < 0.0 { Hold::Sign } else { Hold::Atom };
    (format!("{value}"), hold)
}

/// An angle with its unit: in degrees if that is a short number.
fn written_angle(value: Constant) -> (String, Hold) {
    let radians = value.number();
    if radians == PI {
        return ("pi".to_owned(), Hold::Atom);
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
            Hold::Sign
        } else {
            Hold::Atom
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
