//! Trajectories as tables: CSV with a header row, or one JSON object, with all digits.

use super::csv::{TableCell, push_header, push_row};
use super::events::{event_list, gap_list};
use crate::export::error::ExportError;
use crate::export::target::Output;
use crate::kinematics::certificate::observed;
use crate::kinematics::rates::columns::RateColumns;
use crate::kinematics::results::certificate::{CONSISTENT, Certificate, Reason};
use crate::kinematics::results::printed::printed_certificate;
use crate::kinematics::results::trajectory::{Sample, Trajectory};
use crate::model::mechanism::{Kind, Mechanism};
use crate::numbers::rounding::GROW;
use crate::scene::columns;
use serde_json::{Map, Value, json};

/// The optional columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TableColumns {
    /// Rates of the unknowns per second, named `d(NAME)/dt`.
    pub rates: bool,
    /// Rates up to an order of unknowns, traced points and outputs.
    pub derivatives: Option<RateColumns>,
    /// The proof of the motion up to the next sample.
    pub motion: bool,
    /// Bounds on the closure errors of redundant equations.
    pub redundant: bool,
    /// Bounds of traced points and outputs, named `bound(NAME)`.
    pub bounds: bool,
}

/// Writes CSV. Angles are in the scene's unit; a sample without a pose has empty cells and the status `no-pose`.
pub fn write_csv(
    mechanism: &Mechanism,
    trajectory: &Trajectory,
    columns: TableColumns,
    output: &mut dyn Output,
) -> Result<(), ExportError> {
    let mut line = String::new();
    push_header(&mut line, &table_header(mechanism, columns));
    for (index, sample) in trajectory.samples.iter().enumerate() {
        output.emit(line.as_bytes())?;
        line.clear();
        let cells = sample_cells(mechanism, sample, columns).into_iter();
        let cells = cells.chain(motion_cells(trajectory, index, columns));
        push_row(&mut line, cells);
    }
    output.emit(line.as_bytes())
}

/// Writes one JSON object: schema, units, columns, samples as objects, events.
pub fn write_json(
    mechanism: &Mechanism,
    trajectory: &Trajectory,
    columns: TableColumns,
    output: &mut dyn Output,
) -> Result<(), ExportError> {
    let names = table_header(mechanism, columns);
    let document = json!({
        "schema": "mechanim-trajectory/1",
        "title": mechanism.title,
        "units": { "length": mechanism.length_unit, "angle": mechanism.angle_unit.name, "time": "s" },
        "size": mechanism.size,
        "columns": names,
        "column_units": column_units(mechanism, columns),
        "missing": trajectory.missing(),
        "samples": [],
        "events": event_list(mechanism, trajectory),
        "gaps": gap_list(mechanism, trajectory),
    });
    let text = format!("{document:#}\n");
    // Row by row: a whole motion as one document would take many times its memory.
    let Some((before, after)) = text.split_once(NO_SAMPLES) else {
        return output.emit(text.as_bytes());
    };
    output.emit(before.as_bytes())?;
    let mut line = NO_SAMPLES.trim_end_matches(']').to_owned();
    for (index, sample) in trajectory.samples.iter().enumerate() {
        let cells = sample_cells(mechanism, sample, columns).into_iter();
        let values = cells.chain(motion_cells(trajectory, index, columns));
        let row: Map<_, _> = names
            .iter()
            .cloned()
            .zip(values.map(TableCell::json))
            .collect();
        let comma = if index == 0 { "" } else { "," };
        line += &format!("{comma}\n{:#}", Value::Object(row)).replace('\n', "\n    ");
        output.emit(line.as_bytes())?;
        line.clear();
    }
    let end = if trajectory.samples.is_empty() {
        "]"
    } else {
        "\n  ]"
    };
    output.emit(format!("{line}{end}{after}").as_bytes())
}

/// The position of the rows in the document, which contains no other line break.
const NO_SAMPLES: &str = "\n  \"samples\": []";

/// Names of the columns in their order.
fn table_header(mechanism: &Mechanism, shows: TableColumns) -> Vec<String> {
    let mut names = vec![columns::TIME.to_owned()];
    names.extend(
        mechanism
            .inputs
            .iter()
            .chain(&mechanism.unknowns)
            .map(|c| c.name.clone()),
    );
    let shown = shown_columns(mechanism);
    names.extend(shown.iter().map(|(name, _)| name.clone()));
    if shows.rates {
        names.extend(
            mechanism
                .unknowns
                .iter()
                .map(|c| format!("d({})/dt", c.name)),
        );
    }
    if let Some(derivatives) = shows.derivatives {
        let headings = derivatives.headings(mechanism).into_iter();
        names.extend(headings.map(|(name, _)| name));
    }
    if shows.bounds {
        names.extend(shown.iter().map(|(name, _)| bound_of(name)));
    }
    let redundant = |name: &'static str| shows.redundant.then_some(name);
    let mut own: Vec<&str> = columns::PROOF.to_vec();
    own.extend(redundant(columns::CLOSES_TO));
    own.extend(columns::SOLVING);
    if shows.motion {
        own.extend(columns::MOTION);
        own.extend(redundant(columns::MOTION_CLOSES_TO));
        own.push(columns::MOTION_STATUS);
    }
    names.extend(own.into_iter().map(str::to_owned));
    names
}

/// Which outputs have columns without any rate, and why; of tables with rates up to this order.
pub fn empty_rates(mechanism: &Mechanism, order: usize) -> Vec<String> {
    let orders = mechanism.output_rate_orders();
    let of = |known: usize| -> Vec<String> {
        let outputs = mechanism.outputs.iter().zip(&orders);
        let these = outputs.filter(|(_, own)| **own == known && known < order);
        these.map(|(o, _)| format!("`{}`", o.name)).collect()
    };
    let told = [
        (
            of(0),
            "rates of",
            "outputs that contain derivatives have no computed rates; a higher one is written as an output, such as d(h, phi, 2)",
        ),
        (
            of(1),
            "second and higher rates of",
            "of distances between bodies only the first is computed",
        ),
    ];
    let told = told.into_iter().filter(|(names, ..)| !names.is_empty());
    told.map(|(names, what, why)| {
        format!(
            "the columns with {what} {} stay empty: {why}",
            names.join(", ")
        )
    })
    .collect()
}

/// Traced points and outputs: their formulas and kinds.
fn shown_columns(mechanism: &Mechanism) -> Vec<(String, Kind)> {
    let places = |name: &str| ["x", "y", "z"].map(|axis| (format!("{name}.{axis}"), Kind::Length));
    let mut all: Vec<_> = mechanism
        .traces
        .iter()
        .flat_map(|t| places(&t.name))
        .collect();
    let outputs = mechanism.outputs.iter();
    all.extend(outputs.map(|o| (o.name.clone(), o.kind)));
    all
}

fn bound_of(name: &str) -> String {
    format!("bound({name})")
}

/// Units of the columns that have one, by name: rates of angles in degrees are per degree, per degree squared and so on.
fn column_units(mechanism: &Mechanism, shows: TableColumns) -> Map<String, Value> {
    let mut list = vec![(columns::TIME.to_owned(), "s".to_owned())];
    let unit = |kind| mechanism.unit_name(kind).to_owned();
    let coordinates = mechanism.inputs.iter().chain(&mechanism.unknowns);
    list.extend(coordinates.map(|c| (c.name.clone(), unit(c.kind))));
    for (name, kind) in shown_columns(mechanism) {
        if shows.bounds {
            list.push((bound_of(&name), unit(kind)));
        }
        list.push((name, unit(kind)));
    }
    let products = mechanism.outputs.iter().filter(|o| o.kind == Kind::Number);
    list.extend(products.map(|o| (o.name.clone(), mechanism.table_unit(o.kind, o.dimension))));
    if shows.rates {
        let unknowns = mechanism.unknowns.iter();
        let rate = |kind| match mechanism.unit_name(kind) {
            "" => "1/s".to_owned(),
            unit => format!("{unit}/s"),
        };
        list.extend(unknowns.map(|c| (format!("d({})/dt", c.name), rate(c.kind))));
    }
    if let Some(derivatives) = shows.derivatives {
        let names = derivatives.headings(mechanism).into_iter().map(|h| h.0);
        list.extend(names.zip(derivatives.units(mechanism)));
    }
    let with_unit = list.into_iter().filter(|(_, unit)| !unit.is_empty());
    with_unit.map(|(name, unit)| (name, json!(unit))).collect()
}

fn sample_cells(mechanism: &Mechanism, sample: &Sample, columns: TableColumns) -> Vec<TableCell> {
    let mut cells = vec![TableCell::Number(sample.time)];
    let inputs = mechanism.inputs.iter().zip(&sample.inputs);
    cells.extend(inputs.map(|(c, v)| TableCell::Number(mechanism.file_value(c.kind, *v))));
    let Some(pose) = &sample.pose else {
        let before_the_motion = TableColumns {
            motion: false,
            ..columns
        };
        let missing = table_header(mechanism, before_the_motion).len() - cells.len() - 1;
        cells.extend((0..missing).map(|_| TableCell::Empty));
        cells.push(TableCell::Text("no-pose".to_owned()));
        return cells;
    };
    let in_file = |values: &[f64]| -> Vec<TableCell> {
        let values = mechanism.unknowns.iter().zip(values);
        values
            .map(|(c, v)| TableCell::Number(v * mechanism.file_units(c.kind)))
            .collect()
    };
    cells.extend(in_file(&pose.unknowns));
    cells.extend(
        pose.traces
            .iter()
            .flat_map(|p| p.to_array())
            .map(TableCell::Number),
    );
    let outputs = mechanism.outputs.iter().zip(&pose.outputs);
    cells.extend(outputs.map(|(o, v)| TableCell::Number(v * mechanism.file_units(o.kind))));
    if columns.rates {
        cells.extend(in_file(&pose.rates));
    }
    if let Some(derivatives) = columns.derivatives {
        let headings = derivatives.headings(mechanism).into_iter().enumerate();
        // A singular pose has no rates, except that a fold has the finite ones.
        cells.extend(headings.map(|(k, (_, factor))| {
            let value = pose.derivatives.get(k).filter(|v| v.is_finite());
            value.map_or(TableCell::Empty, |v| TableCell::Number(v * factor))
        }));
    }
    if columns.bounds {
        let kinds = shown_columns(mechanism).into_iter().map(|(_, kind)| kind);
        let bounds = observed::printed_bounds(mechanism, sample)
            .into_iter()
            .zip(kinds);
        cells.extend(bounds.map(|(bound, kind)| {
            TableCell::of(bound.map(|b| b * mechanism.file_units(kind) * GROW))
        }));
    }
    cells.extend([pose.closure_error, pose.sigma_min, pose.condition].map(TableCell::Number));
    cells.push(TableCell::Whole(pose.rank as u64));
    cells.push(TableCell::Text(pose.branch.clone()));
    let bounds = printed_certificate(mechanism, pose).bounds();
    cells.extend([0, 1].map(|k| TableCell::of(bounds.map(|b| b[k]))));
    if columns.redundant {
        cells.push(TableCell::of(pose.certificate.closes_to()));
    }
    cells.push(TableCell::Whole(u64::from(pose.iterations)));
    cells.push(TableCell::Text(
        certificate_word(&pose.certificate).to_owned(),
    ));
    cells
}

/// The status of a pose in one word: if it is proved not to close it is `open`, whatever its closure error.
fn certificate_word(certificate: &Certificate) -> &'static str {
    match certificate {
        Certificate::Refused {
            reason: reason @ Reason::Open,
        } => reason.word(),
        _ if certificate.closes_to().is_some() => CONSISTENT,
        _ => "ok",
    }
}

/// The certificate of the motion from sample `index` to the next one; empty after the last.
fn motion_cells(trajectory: &Trajectory, index: usize, columns: TableColumns) -> Vec<TableCell> {
    if !columns.motion {
        return Vec::new();
    }
    let Some(interval) = trajectory.intervals.get(index) else {
        let count = 4 + usize::from(columns.redundant);
        return (0..count).map(|_| TableCell::Empty).collect();
    };
    let bound = |value| TableCell::of((interval.tubes > 0).then_some(value));
    let mut cells = vec![TableCell::Whole(interval.tubes as u64)];
    cells.extend([interval.radius, interval.unique_radius].map(bound));
    if columns.redundant {
        cells.push(TableCell::of(interval.closes_to));
    }
    cells.push(TableCell::Text(interval.word().to_owned()));
    cells
}
