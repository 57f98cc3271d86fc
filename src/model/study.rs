//! What a study varies, where it looks and what it asks for. Resolved: no names are looked up any more.

use super::expression::Expression;
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

/// A row of poses along a straight way through the inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Name in the scene.
    pub name: String,
    /// Values of the scene's own inputs, one row per pose.
    pub inputs: Vec<Vec<f64>>,
}

/// How the values of a formula along a track become one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reducer {
    /// At the first pose.
    First,
    /// At the last pose.
    Last,
    /// Sum over the poses.
    Sum,
    /// Mean over the poses.
    Mean,
    /// Largest value.
    Largest,
    /// Smallest value.
    Smallest,
    /// (Σ |v|ᵖ)^(1/p).
    Norm(f64),
    /// Of a plane path x, y: the signed distance from the chord, where it is largest.
    Bow,
}

/// A derivative of a coordinate, trace or output by an input, used inside a reduction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    /// Slot that is derived: coordinates, then x, y, z of the traces, then outputs.
    pub slot: usize,
    /// Input it is derived by.
    pub input: usize,
}

/// A reduction of formulas along a track.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduction {
    /// Index of the track.
    pub track: usize,
    /// What is done with the values.
    pub reducer: Reducer,
    /// One formula, two for [`Reducer::Bow`]. Slots: coordinates, traces, outputs, then the study's rates.
    pub arguments: Vec<Expression>,
}

/// A named number of the whole study.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Name in the scene.
    pub name: String,
    /// Slots: the study's reductions, then earlier measures.
    pub expression: Expression,
    /// What it measures.
    pub kind: Kind,
}

/// A bound on a measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Name in the scene.
    pub name: String,
    /// Index of the measure.
    pub measure: usize,
    /// Largest value allowed.
    pub at_most: Option<f64>,
    /// Smallest value allowed.
    pub at_least: Option<f64>,
}

impl Limit {
    /// How far `value` is beyond the bounds; zero or less inside. NaN if the value is none.
    pub fn violation(&self, value: f64) -> f64 {
        let above = self.at_most.map(|limit| value - limit);
        let below = self.at_least.map(|limit| limit - value);
        let parts = [above, below].into_iter().flatten();
        parts.fold(f64::NEG_INFINITY, |worst, v| {
            if v > worst || v.is_nan() { v } else { worst }
        })
    }
}

/// A study of a mechanism whose variables are its last inputs.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Study {
    /// What may change.
    pub variables: Vec<Variable>,
    /// Where poses are taken.
    pub tracks: Vec<Track>,
    /// Derivatives that reductions use.
    pub rates: Vec<Rate>,
    /// Reductions that measures use.
    pub reductions: Vec<Reduction>,
    /// Named numbers.
    pub measures: Vec<Measure>,
    /// Index of the measure to be made small.
    pub objective: Option<usize>,
    /// What an optimum must keep.
    pub constraints: Vec<Limit>,
    /// What a built piece must keep to be counted as good.
    pub requirements: Vec<Limit>,
}
