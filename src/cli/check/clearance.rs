//! The clearance part of `mechanim check`: options and files.

use crate::charts;
use crate::clearance::check::ClearanceReport;
use crate::clearance::covered::CoveredMotion;
use crate::cli::args::files::ProgressArg;
use crate::cli::args::motion::CheckArgs;
use crate::cli::files::chart;
use crate::cli::files::chart::PlotFormat;
use crate::cli::io;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::cli::term::progress::Progress;
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::mechanism::Mechanism;
use crate::plot::{ChartTheme, Drawing, matrix};
use crate::report::clearance::to_csv;
use crate::report::motion_check::MotionCheck;
use crate::scene::Scene;
use std::path::Path;

/// Maximum number of distinguishable curves in one panel.
const MOST_CURVES: usize = 5;

/// Refuses to report clearances of a scene that requests none.
pub fn refuse_without_rules(
    args: &CheckArgs,
    own: &[(String, f64)],
    scene: &Scene,
) -> Result<(), Failure> {
    let options = [
        ("--csv", &args.csv),
        ("--plot", &args.plot),
        ("--render", &args.render),
        ("--matrix", &args.matrix),
    ];
    let asked = options.into_iter().find(|(_, path)| path.is_some());
    let asked = asked.map(|(option, _)| option);
    let asked = asked.or(args.made_within.map(|_| "--made-within"));
    let asked = asked.or(own.first().map(|_| "an interval of a dimension"));
    match asked.filter(|_| scene.clearance.is_none()) {
        None => Ok(()),
        Some(option) => Err(Failure::without_clearance(format!(
            "{option} reports clearances, but the scene has no section [clearance]"
        ))),
    }
}

/// Checks the clearances that the scene requests; `None` if it requests none.
pub fn check_pairs(
    args: &CheckArgs,
    opened: &OpenScene,
    check: &MotionCheck,
    (trajectory, covered): (&Trajectory, &mut CoveredMotion),
    term: &Term,
) -> Result<Option<ClearanceReport>, Failure> {
    if opened.scene.clearance.is_none() {
        return Ok(None);
    }
    let mechanism = &opened.scene.mechanism;
    let progress = Progress::new(ProgressArg::Auto, !term.shows_progress()).counting("pairs");
    let found = check.clearances(covered, &|done, all| {
        progress.show(done, all);
    })?;
    progress.end();
    let Some(found) = found else {
        return Ok(None);
    };
    for warning in &found.warnings {
        term.warning(warning);
    }
    if let Some(path) = &args.csv {
        io::write_text(&args.scene, path, &to_csv(mechanism, &found))?;
    }
    if let Some(path) = &args.plot {
        plot_distances(args, mechanism, &found, path)?;
    }
    if let Some(path) = &args.matrix {
        let chart = charts::clearance_matrix::clearance_matrix(mechanism, &found, args.asked.band);
        let drawing = matrix::draw_matrix(&chart, matrix::usual_size(&chart), ChartTheme::LIGHT);
        write_drawing(args, path, &drawing)?;
    }
    if let Some(path) = &args.render {
        crate::cli::pictures::clearance::write_worst_pair(
            args, opened, trajectory, &found, path, term,
        )?;
    }
    Ok(Some(found))
}

/// Writes a picture in the format of its file extension.
fn write_drawing(args: &CheckArgs, path: &Path, drawing: &Drawing) -> Result<(), Failure> {
    let format = PlotFormat::of(path)?;
    io::refuse_input(&args.scene, path)?;
    let mut output = io::open_output(path)?;
    chart::write_drawing(drawing, format, output.as_mut())?;
    Ok(output.commit()?)
}

/// The distances of the worst pairs over time as a chart.
fn plot_distances(
    args: &CheckArgs,
    mechanism: &Mechanism,
    found: &ClearanceReport,
    path: &Path,
) -> Result<(), Failure> {
    let chart =
        charts::clearance::clearance_chart(mechanism, found, args.asked.worst.min(MOST_CURVES));
    let size = crate::plot::usual_size(&chart);
    write_drawing(
        args,
        path,
        &crate::plot::draw_chart(&chart, size, ChartTheme::LIGHT),
    )
}
