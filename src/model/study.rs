//! The variables and the objective of a study; measures and their limits belong to the mechanism.

use super::measure::Measures;
use super::mechanism::Kind;

/// Share of a range by which a value may be outside: units are converted back and forth.
pub const RANGE_ROUNDING: f64 = 1e-12;

/// A parameter that may change.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name of the parameter.
    pub name: String,
    /// What it measures.
    pub kind: Kind,
    /// The file's value, in radians for angles.
    pub start: f64,
    /// Smallest value allowed.
    pub lower: f64,
    /// Largest value allowed.
    pub upper: f64,
    /// What a number in the file's unit needs behind it to be read as the same: the unit, where only the definition tells it.
    pub suffix: &'static str,
    /// Half the width of its tolerance, if the scene states one.
    pub tolerance: Option<f64>,
}

/// A study of a mechanism whose variables are its last inputs.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Study {
    /// What may change.
    pub variables: Vec<Variable>,
    /// Index of the measure that is to be made small.
    pub objective: Option<usize>,
    /// Further limits of measures from the study: index, smallest and largest value.
    pub limits: Vec<(usize, [Option<f64>; 2])>,
    /// Values of measures printed in a source, by their indices, in internal units.
    pub printed: Vec<(usize, f64)>,
    /// One line about what is studied.
    pub note: Option<String>,
}

impl Study {
    /// Puts its limits in place of the measures' own.
    pub fn limit(&self, measures: &mut Measures) {
        for (index, [min, max]) in &self.limits {
            let measure = &mut measures.list[*index];
            measure.min = min.or(measure.min);
            measure.max = max.or(measure.max);
        }
    }
}
