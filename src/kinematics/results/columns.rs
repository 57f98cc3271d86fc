//! Values of a motion by name: inputs, unknowns, coordinates of traced points, outputs.

use super::trajectory::{ClosedPose, Sample};
use crate::model::mechanism::{Kind, Mechanism};

/// The source of a named value in a sample.
#[derive(Clone, Copy, Debug)]
pub enum ValueColumn {
    /// An input.
    Input(usize),
    /// An unknown.
    Unknown(usize),
    /// A traced point, and which of its coordinates.
    Trace(usize, usize),
    /// An output.
    Output(usize),
}

/// Endings of a traced point's name.
const AXES: [&str; 3] = [".x", ".y", ".z"];

impl ValueColumn {
    /// The column of that name; otherwise all names that exist.
    pub fn find(mechanism: &Mechanism, name: &str) -> Result<Self, Vec<String>> {
        let all = columns(mechanism);
        match all.iter().find(|(other, _, _)| other == name) {
            Some((_, column, _)) => Ok(*column),
            None => Err(all.into_iter().map(|(name, _, _)| name).collect()),
        }
    }

    /// Its index among the slots that formulas of a pose may use.
    pub fn slot(self, mechanism: &Mechanism) -> usize {
        let unknowns = mechanism.unknowns.len();
        let coordinates = unknowns + mechanism.inputs.len();
        match self {
            Self::Unknown(k) => k,
            Self::Input(k) => unknowns + k,
            Self::Trace(k, axis) => coordinates + 3 * k + axis,
            Self::Output(k) => coordinates + 3 * mechanism.traces.len() + k,
        }
    }

    /// What it measures.
    pub fn kind(self, mechanism: &Mechanism) -> Kind {
        match self {
            Self::Input(k) => mechanism.inputs[k].kind,
            Self::Unknown(k) => mechanism.unknowns[k].kind,
            Self::Trace(..) => Kind::Length,
            Self::Output(k) => mechanism.outputs[k].kind,
        }
    }

    /// The value in the scene's units.
    pub fn value(self, mechanism: &Mechanism, sample: &Sample, pose: &ClosedPose) -> f64 {
        let kind = self.kind(mechanism);
        let inside = match self {
            Self::Input(k) => return mechanism.file_value(kind, sample.inputs[k]),
            Self::Unknown(k) => pose.unknowns[k],
            Self::Trace(k, axis) => pose.traces[k][axis],
            Self::Output(k) => pose.outputs[k],
        };
        inside * mechanism.file_units(kind)
    }
}

/// All named values of a sample with their kinds, in the order of a table's columns.
pub fn columns(mechanism: &Mechanism) -> Vec<(String, ValueColumn, Kind)> {
    let inputs = mechanism.inputs.iter().enumerate();
    let inputs = inputs.map(|(k, c)| (c.name.clone(), ValueColumn::Input(k)));
    let unknowns = mechanism.unknowns.iter().enumerate();
    let unknowns = unknowns.map(|(k, c)| (c.name.clone(), ValueColumn::Unknown(k)));
    let traces = mechanism.traces.iter().enumerate().flat_map(|(k, trace)| {
        let axes = AXES.iter().enumerate();
        axes.map(move |(axis, end)| (trace.name.clone() + end, ValueColumn::Trace(k, axis)))
    });
    let outputs = mechanism.outputs.iter().enumerate();
    let outputs = outputs.map(|(k, o)| (o.name.clone(), ValueColumn::Output(k)));
    let all = inputs.chain(unknowns).chain(traces).chain(outputs);
    all.map(|(name, column)| (name, column, column.kind(mechanism)))
        .collect()
}
