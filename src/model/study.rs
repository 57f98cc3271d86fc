//! What a study varies and what it makes small; measures and their limits are the mechanism's own.

use super::mechanism::Kind;

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
    /// What the study asks of measures beside their own limits: index, smallest and largest value.
    pub limits: Vec<(usize, [Option<f64>; 2])>,
    /// What a source prints of measures, by their indices, in internal units.
    pub printed: Vec<(usize, f64)>,
    /// One line about what is studied.
    pub note: Option<String>,
}
