//! `mechanim plot`: curves of the motion as SVG or PNG.

use super::event_messages;
use crate::charts::motion::{default_plot, motion_chart};
use crate::cli::args::charts::PlotArgs;
use crate::cli::files::chart::{PlotFormat, write_chart};
use crate::cli::interrupt::{is_interrupted, refuse_interrupted};
use crate::cli::io;
use crate::cli::open::scene as open_scene;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::kinematics::motion::continuation::solve_with_ends;
use crate::kinematics::motion::sampling;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::plot::Plot;
use crate::plot::chart::Chart;
use crate::plot::companion::Companion;
use crate::scene::{Overrides, PlotText, Scene};

/// Default number of samples of a plot: one per degree of a turn.
const USUAL_SAMPLES: usize = 361;

/// Runs the verb.
pub fn run_plot(args: &PlotArgs, term: &Term) -> Result<Outcome, Failure> {
    let format = PlotFormat::of(&args.out)?;
    io::refuse_input(&args.scene, &args.out)?;
    let asked = asked_plot(args)?;
    let change = |overrides: &mut Overrides| overrides.plot = asked;
    let OpenScene { scene, system, .. } = open_scene::open_changed(&args.scene, change, term)?;
    let actuation = &scene.actuation;
    let plots = chosen_plots(args.only.as_deref(), &scene)?;
    let times = plot_times(args, actuation);
    sampling::allow_samples(&scene.mechanism, times.len())?;
    let mut output = io::open_output(&args.out)?;
    let mut trajectory = solve_with_ends(&system, actuation, &times, &is_interrupted);
    refuse_interrupted()?;
    event_messages::note_moved_start(&system, actuation, &mut trajectory)?;
    let outcome = event_messages::tell_events(&system, actuation, &trajectory, term)?;
    let chart = motion_chart(&system, actuation, &plots, &trajectory);
    tell_bare(&chart, term);
    let written = write_chart(&chart, format, args.size, args.theme, output.as_mut());
    io::unless_reader_left(written.and_then(|()| Ok(output.commit()?)))?;
    Ok(outcome)
}

/// Warns of a chart without curves, and of curves without a value.
fn tell_bare(chart: &Chart, term: &Term) {
    let all = chart.panels.iter().flat_map(|panel| &panel.series);
    if chart.is_bare() && all.clone().next().is_none() {
        term.warning(
            "nothing is drawn: the scene has no outputs, traced points or unknowns (--y names curves)",
        );
    }
    for series in all.filter(|series| series.is_empty()) {
        let name = &series.name;
        term.warning(&format!(
            "the curve `{name}` is not drawn: it has no value at any sample"
        ));
    }
}

/// The plot requested on the command line, if any.
fn asked_plot(args: &PlotArgs) -> Result<Option<PlotText>, Failure> {
    let mut y: Vec<String> = args.y.iter().flat_map(|list| split_list(list)).collect();
    if y.is_empty() {
        if args.x.is_some() || args.order.is_some() || args.equal {
            let hint = "name them: --y NAME,NAME";
            return Err(Failure::usage("no curves are given", vec![hint.to_owned()]));
        }
        return Ok(None);
    }
    let per = args.per.as_deref().unwrap_or("t");
    let values = y.clone();
    for order in 1..=args.order.unwrap_or(0) {
        y.extend(
            values
                .iter()
                .map(|value| format!("d({value}, {per}, {order})")),
        );
    }
    Ok(Some(PlotText {
        x: args.x.clone(),
        y,
        equal: args.equal,
    }))
}

/// Splits a list at the commas outside of parentheses.
fn split_list(list: &str) -> Vec<String> {
    let (mut depth, mut parts) = (0_i32, vec![String::new()]);
    for character in list.chars() {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        match parts.last_mut() {
            Some(part) if character != ',' || depth > 0 => part.push(character),
            _ => parts.push(String::new()),
        }
    }
    let trimmed = parts.iter().map(|p| p.trim().to_owned());
    trimmed.filter(|p| !p.is_empty()).collect()
}

/// The plots to draw: the scene's, the one with the given title, or the default.
pub fn chosen_plots(title: Option<&str>, scene: &Scene) -> Result<Vec<Plot>, Failure> {
    let Some(title) = title else {
        return Ok(match &*scene.plots {
            [] => vec![default_plot(&scene.mechanism, &scene.actuation)],
            plots => plots.to_vec(),
        });
    };
    let found = scene.plots.iter().find(|plot| plot.title == title);
    found.map(|plot| vec![plot.clone()]).ok_or_else(|| {
        if scene.plots.is_empty() {
            let hint = "it has no [[plots]]; leave the title out for its outputs";
            let message = format!("the scene has no plot `{title}`");
            return Failure::usage(message, vec![hint.to_owned()]);
        }
        let titles = scene.plots.iter().map(|plot| plot.title.as_str());
        Failure::unknown_name("plot", title, titles)
    })
}

/// The chart of `--panel`: the scene's first plot or that with the given title, at even samples and at those of the
/// frames in `trajectory`.
pub fn companion_film(
    title: &str,
    (scene, system): (&Scene, &System),
    trajectory: &Trajectory,
    size: [u32; 2],
) -> Result<Companion, Failure> {
    let mut plots = chosen_plots(Some(title).filter(|t| !t.is_empty()), scene)?;
    plots.truncate(1);
    let actuation = &scene.actuation;
    let times = even_times(actuation.duration, USUAL_SAMPLES);
    let fine = solve_with_ends(system, actuation, &times, &is_interrupted);
    refuse_interrupted()?;
    let mut whole = motion_chart(system, actuation, &plots, &fine);
    // The animation already has the title.
    whole.title.clear();
    let frames = motion_chart(system, actuation, &plots, trajectory);
    Ok(Companion::new(&whole, frames, size, scene.view.background))
}

/// Evenly over the motion, both ends included.
fn even_times(duration: f64, count: usize) -> Vec<f64> {
    let share = |k: usize| k as f64 / (count - 1) as f64;
    (0..count).map(|k| duration * share(k)).collect()
}

/// The requested samples.
fn plot_times(args: &PlotArgs, actuation: &Actuation) -> Vec<f64> {
    if args.samples.is_none() && args.scene.table.is_some() {
        return crate::cli::open::inputs_table::row_times(actuation);
    }
    even_times(
        actuation.duration,
        args.samples.unwrap_or(USUAL_SAMPLES).max(2),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_split_outside_of_parentheses() {
        assert_eq!(
            split_list("h, d(h, phi, 2),atan2(a,b)"),
            ["h", "d(h, phi, 2)", "atan2(a,b)"]
        );
        assert_eq!(split_list(" , "), Vec::<String>::new());
    }
}
