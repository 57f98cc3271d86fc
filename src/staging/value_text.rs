//! Values of inputs as they stand in pictures.

use crate::model::mechanism::{Coordinate, Kind, Mechanism};
use crate::numbers::decimal::{MINUS, with_minus};

/// Height of a line of values as a fraction of the picture's height.
pub const VALUE_SIZE: f64 = 0.030;

/// `+17.0 mm` or `−17.0 mm`, with a fixed number of digits so that the text does not jump.
pub fn value_text(mechanism: &Mechanism, input: &Coordinate, value: f64) -> String {
    let text = amount_text(mechanism, input.kind, value, None);
    // As wide as a minus, so that nothing jumps at zero.
    match text.starts_with(MINUS) {
        true => text,
        false => format!("+{text}"),
    }
}

/// The same without a plus, with `digits` behind the point if given.
pub fn amount_text(mechanism: &Mechanism, kind: Kind, value: f64, digits: Option<usize>) -> String {
    let in_degrees = mechanism.angle_unit.name == "deg";
    let (usual, unit) = match kind {
        Kind::Angle if in_degrees => (1, "°".to_owned()),
        Kind::Angle => (3, " rad".to_owned()),
        Kind::Length => (
            length_digits(mechanism.size),
            format!(" {}", mechanism.length_unit),
        ),
        Kind::Number => (3, String::new()),
    };
    let digits = digits.unwrap_or(usual);
    let in_file = value * mechanism.file_units(kind);
    // Half a unit of the last digit must not show as a negative zero.
    let last = 10f64.powi(digits as i32);
    let tidy = (in_file * last).round() / last + 0.0;
    with_minus(&format!("{tidy:.digits$}")) + &unit
}

/// Digits behind the point that show a length to a thousandth of the mechanism's `size`, or to a few; at least one.
fn length_digits(size: f64) -> usize {
    let digits = (DIGITS_OF_SIZE - libm::log10(size)).ceil();
    digits.clamp(1.0, MOST_DIGITS) as usize
}

/// Digits of the mechanism's size in its lengths: one behind the point from 25 on.
const DIGITS_OF_SIZE: f64 = 2.4;

/// Most digits behind the point: more are not read.
const MOST_DIGITS: f64 = 9.0;
