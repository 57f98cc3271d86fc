//! A work-precision study as a table for people, as CSV and as JSON.

use super::csv::{TableCell, push_header, push_row};
use super::rounded::at_most;
use crate::analysis::routes::{RotationForm, Route};
use crate::analysis::work_precision::{PrecisionRow, PrecisionStudy};
use crate::model::mechanism::Mechanism;
use serde_json::{Value, json};

/// Columns of the table and of the CSV file.
const HEADER: [&str; 11] = [
    "route",
    "predictor",
    "tolerance",
    "residual",
    "steps",
    "us_per_pose",
    "newton_per_pose",
    "end_error",
    "error",
    "closure_error",
    "lost",
];

/// The setting of a row: predictor order, closure tolerance, residual form; empty if not applicable.
fn setting_cells(row: &PrecisionRow) -> [TableCell; 3] {
    match row.route {
        Some(Route::Position {
            predictor,
            tolerance,
            form,
        }) => [
            TableCell::Whole(predictor as u64),
            TableCell::Number(tolerance),
            TableCell::text(match form {
                RotationForm::Log => "log",
                RotationForm::Skew => "skew",
            }),
        ],
        Some(Route::Ode { .. }) | None => [const { TableCell::Empty }; 3],
    }
}

/// A setting in the table for people.
fn setting_text(cell: TableCell) -> String {
    match cell {
        TableCell::Number(tolerance) => format!("{tolerance:e}"),
        TableCell::Whole(order) => order.to_string(),
        TableCell::Text(word) => word,
        TableCell::Empty => String::new(),
    }
}

fn row_cells(row: &PrecisionRow) -> [String; 11] {
    let [predictor, tolerance, form] = setting_cells(row).map(setting_text);
    [
        row.family.to_owned(),
        predictor,
        tolerance,
        form,
        row.steps.to_string(),
        format!("{:.2}", row.time),
        format!("{:.2}", row.iterations),
        error_text(row.end_error),
        error_text(row.error),
        format!("{:.1e}", row.closure),
        row.lost.to_string(),
    ]
}

/// An error; a route that is lost has none at its end.
fn error_text(error: f64) -> String {
    match error.is_nan() {
        true => "-".to_owned(),
        false => format!("{error:.2e}"),
    }
}

/// Aligned columns, with what they mean.
pub fn precision_text(mechanism: &Mechanism, study: &PrecisionStudy) -> String {
    let mut rows = vec![HEADER.map(str::to_owned)];
    rows.extend(study.rows.iter().map(row_cells));
    let unit = &mechanism.length_unit;
    let mut text = format!(
        "{}: {} unknowns, {} poses\n",
        mechanism.title, study.unknowns, study.poses
    );
    text.push_str(&aligned_table(&rows));
    text.push_str(&format!(
        "\nerror: largest difference of a coordinate to the true pose in {unit}; end_error: at the last pose.\n"
    ));
    text.push_str(&match study.reference_bound {
        Some(bound) => {
            let bound = at_most(bound);
            format!("The true poses are those of `mechanim solve`, proved to {bound} {unit}.\n")
        }
        None => {
            "The true poses are those of `mechanim solve`; there is no proof for this mechanism.\n"
                .to_owned()
        }
    });
    if !study.drift.is_empty() {
        let mut rows = vec![["route", "turns", "error", "closure_error"].map(str::to_owned)];
        rows.extend(study.drift.iter().map(|d| {
            [
                d.name.to_owned(),
                d.turns.to_string(),
                format!("{:.2e}", d.error),
                format!("{:.1e}", d.closure),
            ]
        }));
        let steps = crate::analysis::work_precision::DRIFT_STEPS;
        text.push_str(&format!(
            "\nDrift, {steps} steps a turn, against the pose at the start:\n"
        ));
        text.push_str(&aligned_table(&rows));
    }
    text
}

/// The first column to the left, the others to the right.
fn aligned_table<const N: usize>(rows: &[[String; N]]) -> String {
    let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..N).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = format!("{:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            line.push_str(&format!("  {cell:>width$}"));
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// The rows as CSV; drift is in the JSON and in the table.
pub fn precision_csv(study: &PrecisionStudy) -> String {
    let mut text = String::new();
    push_header(&mut text, &HEADER);
    for row in &study.rows {
        let numbers = [
            row.time,
            row.iterations,
            row.end_error,
            row.error,
            row.closure,
        ];
        let mut cells = vec![TableCell::text(row.family)];
        cells.extend(setting_cells(row));
        cells.push(TableCell::Whole(row.steps as u64));
        cells.extend(numbers.map(TableCell::Number));
        cells.push(TableCell::Whole(row.lost as u64));
        push_row(&mut text, cells);
    }
    text
}

/// The study as one JSON object.
pub fn precision_json(mechanism: &Mechanism, study: &PrecisionStudy) -> Value {
    let rows: Vec<Value> = study.rows.iter().map(row_json).collect();
    let drift: Vec<Value> = study
        .drift
        .iter()
        .map(|d| {
            json!({
                "route": d.name,
                "turns": d.turns,
                "error": d.error,
                "closure_error": d.closure,
            })
        })
        .collect();
    json!({
        "schema": "mechanim-accuracy/1",
        "title": mechanism.title,
        "units": { "length": mechanism.length_unit, "time_per_pose": "us" },
        "size": mechanism.size,
        "unknowns": study.unknowns,
        "poses": study.poses,
        "reference_bound": study.reference_bound,
        "rows": rows,
        "drift_steps_per_turn": crate::analysis::work_precision::DRIFT_STEPS,
        "drift": drift,
    })
}

fn row_json(row: &PrecisionRow) -> Value {
    let [predictor, tolerance, form] = setting_cells(row).map(TableCell::json);
    json!({
        "route": row.family,
        "predictor": predictor,
        "tolerance": tolerance,
        "residual": form,
        "steps": row.steps,
        "us_per_pose": row.time,
        "newton_per_pose": row.iterations,
        "end_error": row.end_error,
        "error": row.error,
        "closure_error": row.closure,
        "lost": row.lost,
    })
}
