//! `mechanim optimise --plot` and `--history`: the paths before and after a search, and the points that it visited.

use crate::analysis::study::LoadedStudy;
use crate::analysis::study::optimum::Improvement;
use crate::charts::motion::motion_chart;
use crate::charts::search::{name_places, start_and_result};
use crate::cli::files::chart::{PlotFormat, write_chart};
use crate::cli::interrupt::{is_interrupted, refuse_interrupted};
use crate::cli::io;
use crate::cli::term::outcome::Failure;
use crate::kinematics::motion::continuation::solve_with_ends;
use crate::kinematics::motion::sampling::even_times;
use crate::kinematics::structure::system::System;
use crate::model::plot::Plot;
use crate::model::theme::Theme;
use crate::model::view::LabelPlace;
use crate::plot::Chart;
use crate::report::csv::{TableCell, push_header, push_row};
use crate::scene::Scene;
use std::path::Path;
use std::sync::Arc;

/// Samples of a path.
const SAMPLES: usize = 721;

/// Refuses a chart of paths for a scene without such plots, before the search.
pub fn refuse_without_paths(study: &LoadedStudy) -> Result<(), Failure> {
    match path_plots(&study.scene_at(&study.family.start())?).is_empty() {
        false => Ok(()),
        true => Err(Failure::usage(
            "the scene has no plot of a path, with `equal = true`",
            vec!["write one in [[plots]]: x = \"M.x\", y = [\"M.y\"], equal = true".to_owned()],
        )),
    }
}

/// Plots with the same scale on both axes.
fn path_plots(scene: &Scene) -> Vec<Plot> {
    scene
        .plots
        .iter()
        .filter(|plot| plot.equal)
        .cloned()
        .collect()
}

/// Draws the paths of the first and the last improvement.
pub fn write_paths(
    path: &Path,
    format: PlotFormat,
    study: &LoadedStudy,
    improvements: &[Improvement],
) -> Result<(), Failure> {
    let [Some(first), Some(last)] = [improvements.first(), improvements.last()] else {
        return Ok(());
    };
    let (start, _, _) = improvement_chart(study, first)?;
    let (result, times, words) = improvement_chart(study, last)?;
    let mut chart = start_and_result(start, result);
    chart
        .panels
        .iter_mut()
        .for_each(|panel| name_places(panel, &times, &words));
    let mut output = io::open_output(path)?;
    let written = write_chart(&chart, format, None, Theme::Light, output.as_mut());
    io::unless_reader_left(written.and_then(|()| Ok(output.commit()?)))
}

/// A chart, the times of its samples, and the labels at some of them.
type TimedChart = (Chart, Vec<f64>, Vec<(f64, String)>);

/// The paths with the values of an improvement, and the scene's labels on them.
fn improvement_chart(
    study: &LoadedStudy,
    improvement: &Improvement,
) -> Result<TimedChart, Failure> {
    let scene = study.scene_at(&improvement.values)?;
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation)?;
    let times = even_times(&scene.mechanism, &scene.actuation, SAMPLES);
    let trajectory = solve_with_ends(&system, &scene.actuation, &times, &is_interrupted);
    refuse_interrupted()?;
    let chart = motion_chart(&system, &scene.actuation, &path_plots(&scene), &trajectory);
    let times = trajectory.samples.iter().map(|s| s.time).collect();
    let words = scene
        .view
        .labels
        .iter()
        .filter_map(|label| match label.place {
            LabelPlace::OnTrace { time, .. } => Some((time, label.text.clone())),
            LabelPlace::OnBody { .. } => None,
        });
    Ok((chart, times, words.collect()))
}

/// The points that a search visited, one per row, in the units of the scene.
pub fn search_history(study: &LoadedStudy, improvements: &[Improvement]) -> String {
    let unit = study.objective_unit();
    let variables = &study.family.study.variables;
    let mut heads = vec!["iteration", study.objective_name()];
    heads.extend(variables.iter().map(|variable| variable.name.as_str()));
    let mut text = String::new();
    push_header(&mut text, &heads);
    for improvement in improvements {
        let values = variables.iter().zip(&improvement.values);
        let values = values.map(|(variable, v)| v * study.family.units(variable.kind));
        let numbers = std::iter::once(improvement.objective * unit).chain(values);
        let number = TableCell::Whole(improvement.iteration as u64);
        push_row(
            &mut text,
            std::iter::once(number).chain(numbers.map(TableCell::Number)),
        );
    }
    text
}
