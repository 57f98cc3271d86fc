//! How names and values are written, and in which colour.

use super::scheme::{QuantitySource, SchemeAngle, SchemeLength};
use crate::numbers::decimal::{trimmed, with_minus};
use crate::plot::theme::{ChartTheme, Colour};
use crate::staging::quantity_names::written_names;

/// How names are written.
pub struct QuantityLettering {
    /// Height of capitals in pixels.
    pub size: f64,
    pub values: bool,
    pub length_unit: String,
    pub angle_unit: (String, f64),
}

impl QuantityLettering {
    /// A formula with its names set as in handwriting.
    pub fn symbol(&self, text: &str) -> String {
        written_names(text)
    }

    /// Name of a length, with its value if requested.
    pub fn length(&self, length: &SchemeLength) -> String {
        self.named(&length.name, length.value, &self.length_unit)
    }

    /// Name of an angle, likewise.
    pub fn angle(&self, angle: &SchemeAngle) -> String {
        let (unit, radians) = &self.angle_unit;
        let unit = if unit == "deg" { "°" } else { unit };
        self.named(&angle.name, angle.value / radians, unit)
    }

    fn named(&self, name: &str, value: f64, unit: &str) -> String {
        match self.values {
            true => valued_name(name, value, unit),
            false => written_names(name),
        }
    }
}

/// Smaller values are zero beside those of any mechanism.
const LEAST_SHOWN: f64 = 1e-9;

/// A name with its value.
pub fn valued_name(name: &str, value: f64, unit: &str) -> String {
    // Four decimals, of small values four digits; what is smaller is rounding.
    let size = value.abs();
    let places = match size >= LEAST_SHOWN {
        true => (3.0 - libm::log10(size).floor()).max(4.0) as usize,
        false => 4,
    };
    let short = with_minus(&trimmed(value, places));
    let gap = if unit == "°" || unit.is_empty() {
        ""
    } else {
        " "
    };
    format!("{} = {short}{gap}{unit}", written_names(name))
}

/// Colour of a quantity: dimensions are pale; driven and dependent quantities stand out.
pub fn source_colour(source: QuantitySource, theme: &ChartTheme) -> Colour {
    match source {
        QuantitySource::Constant => theme.faint_text,
        QuantitySource::Input => theme.series[1],
        QuantitySource::Unknown => theme.series[0],
    }
}
