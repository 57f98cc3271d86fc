//! Numbers of things, inputs and values with their units, as sentences contain them.

use super::rounded::at_most;
use crate::diag::decimals_of;
use crate::model::mechanism::{Kind, Mechanism};

/// A number of things: `1 mode`, `3 modes`.
pub fn counted_things(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// What a reader of a scene in degrees must know of the value of an equation.
pub fn angles_note(mechanism: &Mechanism) -> &'static str {
    match mechanism.angle_unit.radians.number() == 1.0 {
        true => "",
        false => ", angles in radians",
    }
}

/// `p = -17 mm, phi = 0.2 rad`.
pub fn input_sentence(mechanism: &Mechanism, values: &[f64]) -> String {
    let pairs = mechanism.inputs.iter().zip(values);
    let texts = pairs.map(|(input, value)| {
        let value = with_unit(mechanism, input.kind, *value);
        format!("{} = {value}", input.name)
    });
    let list = texts.collect::<Vec<_>>().join(", ");
    if list.is_empty() {
        "no inputs".to_owned()
    } else {
        list
    }
}

/// A value with its unit: `-17.000000000 mm`.
pub fn with_unit(mechanism: &Mechanism, kind: Kind, value: f64) -> String {
    let text = decimals_of(value * mechanism.file_units(kind), 9);
    beside_unit(text, mechanism.unit_name(kind))
}

/// A number and its unit, if it has one.
pub fn beside_unit(text: String, unit: &str) -> String {
    match unit {
        "" => text,
        unit => format!("{text} {unit}"),
    }
}

/// `1 of 41 samples has no pose`.
pub fn samples_without_pose(missing: usize, samples: usize) -> String {
    let verb = if missing == 1 { "has" } else { "have" };
    format!("{missing} of {samples} samples {verb} no pose")
}

/// The largest certified error of so many poses, some of them without a certificate.
pub fn certified_error([poses, unproved]: [usize; 2], bound: f64, unit: &str) -> String {
    match unproved {
        0 => format!("error at most {}", beside_unit(at_most(bound), unit)),
        _ if unproved >= poses => "no certified error".to_owned(),
        _ => format!(
            "error of the others at most {}",
            beside_unit(at_most(bound), unit)
        ),
    }
}
