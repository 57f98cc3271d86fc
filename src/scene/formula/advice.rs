//! What was probably meant where a formula goes on without an operator.

use super::lexer::{Token, TokenKind};
use crate::model::expression::Function;
use crate::model::mechanism::AngleUnit;

/// Units in which numbers are given elsewhere.
const OTHER_UNITS: [&str; 12] = [
    "um", "µm", "mm", "cm", "m", "km", "in", "ft", "s", "ms", "min", "h",
];

/// Why `found` cannot follow `before`, and what to write instead.
pub fn of_neighbours(before: &Token, found: &Token) -> Option<String> {
    let follows_value = match &before.kind {
        TokenKind::Number(_) | TokenKind::Name(_) => true,
        TokenKind::Sign(sign) => *sign == ')',
        TokenKind::End => false,
    };
    let starts_value = match &found.kind {
        TokenKind::Number(_) | TokenKind::Name(_) => true,
        TokenKind::Sign(sign) => *sign == '(',
        TokenKind::End => false,
    };
    if !follows_value || !starts_value {
        return None;
    }
    Some(match (&before.kind, &found.kind) {
        (TokenKind::Number(_), TokenKind::Name(unit)) if AngleUnit::from_name(unit).is_some() => {
            format!("the unit of an angle follows its number without a space: `90{unit}`")
        }
        (TokenKind::Number(_), TokenKind::Name(unit)) if OTHER_UNITS.contains(&unit.as_str()) => {
            "only angles have a unit in formulas, `deg` or `rad`: lengths are in the scene's unit, times in seconds; \
             a product is written with `*`"
                .to_owned()
        }
        (TokenKind::Name(name), _) if Function::from_name(name).is_some() => {
            format!("the argument of a function stands in parentheses: `{name}(t)`")
        }
        _ => "a product is written with `*`".to_owned(),
    })
}
