//! Newton's iterates as a table: CSV without the polygons, or JSON with them.

use super::csv::{TableCell, push_header, push_row};
use crate::export::error::ExportError;
use crate::export::target::Output;
use crate::kinematics::solve::iterates::Iterate;
use crate::model::mechanism::Mechanism;
use serde_json::{Map, Value, json};

/// Names of the columns in their order.
fn iterate_header(mechanism: &Mechanism) -> Vec<String> {
    let unknowns = || mechanism.unknowns.iter().map(|c| c.name.as_str());
    let mut names = vec!["block".to_owned(), "iteration".to_owned()];
    names.extend(unknowns().map(str::to_owned));
    names.extend(unknowns().map(|name| format!("correction({name})")));
    for item in &mechanism.loops {
        names.extend(
            ["gap.x", "gap.y", "gap.z", "turn"].map(|what| format!("{}.{what}", item.name)),
        );
    }
    names.extend(
        mechanism
            .equations
            .iter()
            .map(|e| format!("{}.gap", e.name)),
    );
    names
}

/// The numbers of an iterate in the file's units.
fn iterate_cells(mechanism: &Mechanism, iterate: &Iterate) -> Vec<f64> {
    let scaled = |values: &[f64]| -> Vec<f64> {
        let pairs = mechanism.unknowns.iter().zip(values);
        pairs
            .map(|(c, v)| v * mechanism.file_units(c.kind))
            .collect()
    };
    let mut cells = vec![iterate.block as f64, iterate.iteration as f64];
    cells.extend(scaled(&iterate.unknowns));
    cells.extend(scaled(&iterate.corrections));
    for item in &iterate.loops {
        cells.extend(item.gap.to_array());
        cells.push(item.turn / mechanism.angle_unit.radians.number());
    }
    cells.extend(&iterate.equations);
    cells
}

/// Writes CSV.
pub fn write_csv(
    mechanism: &Mechanism,
    iterates: &[Iterate],
    output: &mut dyn Output,
) -> Result<(), ExportError> {
    let mut text = String::new();
    push_header(&mut text, &iterate_header(mechanism));
    for iterate in iterates {
        let numbers = iterate_cells(mechanism, iterate).into_iter();
        push_row(&mut text, numbers.map(TableCell::Number));
    }
    output.emit(text.as_bytes())
}

/// Writes one JSON object: the same columns, and the opened polygon of every loop.
pub fn write_json(
    mechanism: &Mechanism,
    iterates: &[Iterate],
    closed: bool,
    output: &mut dyn Output,
) -> Result<(), ExportError> {
    let names = iterate_header(mechanism);
    let rows = iterates.iter().map(|iterate| {
        let values = iterate_cells(mechanism, iterate)
            .into_iter()
            .map(|v| json!(v));
        let mut row: Map<String, Value> = names.iter().cloned().zip(values).collect();
        row.insert("block".to_owned(), json!(iterate.block));
        row.insert("iteration".to_owned(), json!(iterate.iteration));
        let loops = mechanism.loops.iter().zip(&iterate.loops);
        let polygons: Map<String, Value> = loops
            .map(|(item, open)| {
                let corners: Vec<[f64; 3]> = open.polygon.iter().map(|p| p.to_array()).collect();
                (item.name.clone(), json!(corners))
            })
            .collect();
        row.insert("polygons".to_owned(), Value::Object(polygons));
        Value::Object(row)
    });
    let document = json!({
        "schema": "mechanim-iterates/1",
        "title": mechanism.title,
        "units": { "length": mechanism.length_unit, "angle": mechanism.angle_unit.name },
        "closed": closed,
        "iterates": rows.collect::<Vec<_>>(),
    });
    output.emit(format!("{document:#}\n").as_bytes())
}
