//! A work-precision study as a table for people, as CSV and as JSON.

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
fn row_setting(row: &PrecisionRow) -> [String; 3] {
    match row.route {
        Some(Route::Position {
            predictor,
            tolerance,
            form,
        }) => [
            predictor.to_string(),
            format!("{tolerance:e}"),
            match form {
                RotationForm::Log => "log",
                RotationForm::Skew => "skew",
            }
            .to_owned(),
        ],
        Some(Route::Ode { .. }) | None => [const { String::new() }; 3],
    }
}

fn row_cells(row: &PrecisionRow) -> [String; 11] {
    let [predictor, tolerance, form] = row_setting(row);
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
            format!("The true poses are those of `mechanim solve`, proved to {bound:.1e} {unit}.\n")
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
    let mut lines = vec![HEADER.join(",")];
    for row in &study.rows {
        let [predictor, tolerance, form] = row_setting(row);
        let numbers = [
            row.time,
            row.iterations,
            row.end_error,
            row.error,
            row.closure,
        ];
        let numbers = numbers.map(|v| {
            if v.is_finite() {
                format!("{v:e}")
            } else {
                String::new()
            }
        });
        let steps = row.steps.to_string();
        let mut cells = vec![row.family.to_owned(), predictor, tolerance, form, steps];
        cells.extend(numbers);
        cells.push(row.lost.to_string());
        lines.push(cells.join(","));
    }
    lines.join("\n") + "\n"
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
                "error": finite_number(d.error),
                "closure_error": finite_number(d.closure),
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
    let (predictor, tolerance, form) = match row.route {
        Some(Route::Position {
            predictor,
            tolerance,
            ..
        }) => (
            json!(predictor),
            json!(tolerance),
            json!(row_setting(row)[2]),
        ),
        Some(Route::Ode { .. }) | None => (Value::Null, Value::Null, Value::Null),
    };
    json!({
        "route": row.family,
        "predictor": predictor,
        "tolerance": tolerance,
        "residual": form,
        "steps": row.steps,
        "us_per_pose": finite_number(row.time),
        "newton_per_pose": finite_number(row.iterations),
        "end_error": finite_number(row.end_error),
        "error": finite_number(row.error),
        "closure_error": finite_number(row.closure),
        "lost": row.lost,
    })
}

/// A number that JSON cannot represent is omitted: the route found no pose.
fn finite_number(value: f64) -> Value {
    if value.is_finite() {
        json!(value)
    } else {
        Value::Null
    }
}
