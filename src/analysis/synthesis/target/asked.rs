//! The targets of a mechanism: quantities with target values, row by row.

use crate::model::mechanism::Mechanism;

/// A quantity that has a target.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetColumn {
    /// As in the table.
    pub name: String,
    /// Its index among coordinates, x, y, z of every trace, and outputs.
    pub slot: usize,
    /// An angle counts as the path of a point at this distance, modulo full turns; 1 for lengths.
    pub reach: f64,
    /// Whether it is an angle.
    pub is_angle: bool,
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetRow {
    /// Its line in the table, for messages.
    pub line: usize,
    /// The scene's own inputs; empty if they are to be found.
    pub inputs: Option<Vec<f64>>,
    /// A value a column.
    pub values: Vec<f64>,
    /// The weight of its squares.
    pub weight: f64,
}

/// The targets of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// What has targets.
    pub columns: Vec<TargetColumn>,
    /// The rows, in the order in which they must be met.
    pub rows: Vec<TargetRow>,
    /// The input that is free in every row, if the table has no inputs.
    pub free_input: Option<FreeInput>,
}

/// An input whose value at a row is to be found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeInput {
    /// Index among the inputs.
    pub input: usize,
    /// Its least and greatest value; a full turn for an input that goes round.
    pub range: [f64; 2],
    /// It goes round.
    pub is_cyclic: bool,
}

/// The slot of an unknown, a coordinate of a traced point (`P.x`) or an output, among coordinates, traces and outputs.
pub fn slot_of(mechanism: &Mechanism, name: &str) -> Option<usize> {
    // Slots in their order: coordinates, traced points, outputs.
    let unknown = mechanism.unknowns.iter().position(|u| u.name == name);
    let first = mechanism.coordinate_count();
    let traces = mechanism.traces.iter().enumerate();
    let mut traced = traces.filter_map(|(k, trace)| {
        let axis = name.strip_prefix(trace.name.as_str())?.strip_prefix('.')?;
        let axis = ["x", "y", "z"].iter().position(|a| *a == axis)?;
        Some(first + 3 * k + axis)
    });
    let behind = first + 3 * mechanism.traces.len();
    let mut outputs = mechanism.outputs.iter();
    let output = outputs.position(|o| o.name == name).map(|k| behind + k);
    unknown.or(traced.next()).or(output)
}
