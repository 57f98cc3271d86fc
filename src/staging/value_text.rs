//! Values of inputs as they stand in pictures.

use crate::model::mechanism::{Coordinate, Kind, Mechanism};

/// Height of a line of values as a fraction of the picture's height.
pub const VALUE_SIZE: f64 = 0.030;

/// `-17.0 mm`, with a fixed number of digits so that the text does not jump.
pub fn value_text(mechanism: &Mechanism, input: &Coordinate, value: f64) -> String {
    let in_file = value * mechanism.file_units(input.kind);
    // Half a unit of the last digit must not show as a negative zero.
    let tidy = |digits: i32| {
        let unit = 10f64.powi(digits);
        (in_file * unit).round() / unit + 0.0
    };
    let text = match input.kind {
        Kind::Angle if mechanism.angle_unit.name == "deg" => format!("{:+.1}°", tidy(1)),
        Kind::Angle => format!("{:+.3} rad", tidy(3)),
        Kind::Length => format!("{:+.1} {}", tidy(1), mechanism.length_unit),
        Kind::Number => format!("{:+.3}", tidy(3)),
    };
    // As wide as a plus, so that nothing jumps at zero.
    match text.strip_prefix('-') {
        Some(amount) => format!("−{amount}"),
        None => text,
    }
}
