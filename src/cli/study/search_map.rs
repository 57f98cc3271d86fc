//! `mechanim optimise --map`: the objective over two variables, and the points that a search visited.

use crate::analysis::optimise::Objective;
use crate::analysis::study::LoadedStudy;
use crate::analysis::study::optimum::Improvement;
use crate::analysis::study::search::StudySearch;
use crate::charts::contours::{ValueGrid, search_map};
use crate::cli::files::chart::{PlotFormat, write_chart};
use crate::cli::interrupt::refuse_interrupted;
use crate::cli::io;
use crate::cli::term::outcome::Failure;
use crate::model::theme::Theme;
use crate::plot::Axis;
use crate::staging::quantity_names::written_label;
use std::path::Path;

/// Grid values along each variable.
const PLACES: usize = 25;

/// Margin around the points of a search, as a fraction of their span, and at least as a fraction of the largest value.
const ROOM: [f64; 2] = [0.6, 0.02];

/// Refuses a map unless there are two variables, before the search.
pub fn refuse_other_count(study: &LoadedStudy) -> Result<(), Failure> {
    match study.family.study.variables.len() {
        2 => Ok(()),
        count => Err(Failure::usage(
            format!("a map has two variables, this study {count}"),
            vec!["choose two with --vary NAME,NAME".to_owned()],
        )),
    }
}

/// Draws the map around the points of a search.
pub fn write_map(
    path: &Path,
    format: PlotFormat,
    study: &LoadedStudy,
    improvements: &[Improvement],
) -> Result<(), Failure> {
    let places = [0, 1].map(|k| variable_places(study, improvements, k));
    let mut search = StudySearch::new(&study.family, Box::new(|_, _, _| true))?;
    let mut values = Vec::new();
    for x in &places[0] {
        let row = places[1]
            .iter()
            .map(|y| Objective::value(&mut search, &[*x, *y]) * study.objective_unit());
        values.push(row.collect());
        refuse_interrupted()?;
    }
    let units = [0, 1].map(|k| study.family.units(study.family.study.variables[k].kind));
    let shown = |k: usize| places[k].iter().map(|v| v * units[k]).collect();
    let grid = ValueGrid {
        places: [shown(0), shown(1)],
        values,
    };
    let points: Vec<[f64; 2]> = improvements
        .iter()
        .map(|i| [0, 1].map(|k| i.values[k] * units[k]))
        .collect();
    let mechanism = study.family.mechanism();
    let axes = [0, 1].map(|k| {
        let variable = &study.family.study.variables[k];
        Axis {
            label: written_label(&variable.name),
            unit: mechanism.unit_name(variable.kind).to_owned(),
            ..Axis::default()
        }
    });
    let title = format!("{} of {}", study.objective_name(), mechanism.title);
    let chart = search_map(&title, axes, &grid, &points);
    let mut output = io::open_output(path)?;
    let size = Some([900, 720]);
    let written = write_chart(&chart, format, size, Theme::Light, output.as_mut());
    io::unless_reader_left(written.and_then(|()| Ok(output.commit()?)))
}

/// Grid values of a variable: around the points of the search, within its range.
fn variable_places(study: &LoadedStudy, improvements: &[Improvement], k: usize) -> Vec<f64> {
    let variable = &study.family.study.variables[k];
    let values = improvements.iter().map(|i| i.values[k]);
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    let largest = low.abs().max(high.abs());
    let room = (ROOM[0] * (high - low)).max(ROOM[1] * largest);
    let (low, high) = (
        (low - room).max(variable.lower),
        (high + room).min(variable.upper),
    );
    let share = |i: usize| low + (high - low) * i as f64 / (PLACES - 1) as f64;
    (0..PLACES).map(share).collect()
}
