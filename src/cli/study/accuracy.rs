//! `mechanim accuracy`: methods along a motion, their time against their true error.

use crate::analysis::work_precision::{PrecisionStudy, StudyError, study_precision};
use crate::charts;
use crate::cli::args::charts::AccuracyArgs;
use crate::cli::files::chart::{PlotFormat, write_chart};
use crate::cli::io;
use crate::cli::open::scene as open_scene;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::export::Output;
use crate::kinematics::motion::continuation::solve_motion;
use crate::model::mechanism::Mechanism;
use crate::report::precision;
use std::path::Path;

/// Pixels of the chart.
const CHART: [u32; 2] = [840, 520];

/// Format of the report.
enum StudyFormat {
    Csv,
    Json,
    Chart(PlotFormat),
}

/// Runs the verb.
pub fn run_accuracy(args: &AccuracyArgs, term: &Term) -> Result<Outcome, Failure> {
    let format = args.out.as_deref().map(accuracy_format).transpose()?;
    if let Some(out) = &args.out {
        io::refuse_input(&args.scene, out)?;
    }
    let OpenScene { scene, system, .. } = open_scene::open_scene(&args.scene, term)?;
    let mechanism = &scene.mechanism;
    let mut output = args.out.as_deref().map(io::open_output).transpose()?;
    let study = match study_precision(&system, &scene.actuation, args.poses, args.turns) {
        Ok(study) => study,
        Err(error @ StudyError::Gap { time }) => {
            let motion = solve_motion(&system, &scene.actuation, &[0.0, time]);
            let is_undecided = motion.is_whole() || motion.is_undecided();
            let hints = vec!["`mechanim check` shows where the motion ends".to_owned()];
            return Err(Failure::without_pose(
                is_undecided,
                error.to_string(),
                hints,
            ));
        }
    };
    crate::cli::interrupt::refuse_interrupted()?;
    if let (Some(format), Some(output)) = (format, output.as_mut()) {
        save_accuracy(mechanism, &study, &format, args, output.as_mut())?;
    }
    if let Some(output) = output {
        output.commit()?;
    }
    io::print_beside(
        term,
        args.out.as_deref(),
        &precision::precision_text(mechanism, &study),
    )?;
    Ok(Outcome::Done)
}

fn accuracy_format(path: &Path) -> Result<StudyFormat, Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        None if path == Path::new("-") => Ok(StudyFormat::Json),
        Some("json") => Ok(StudyFormat::Json),
        Some("csv") => Ok(StudyFormat::Csv),
        Some("svg") => Ok(StudyFormat::Chart(PlotFormat::Svg)),
        Some("png") => Ok(StudyFormat::Chart(PlotFormat::Png)),
        _ => {
            let known = "known kinds: .json, .csv, .svg and .png";
            Err(Failure::unknown_kind(path, "report", known))
        }
    }
}

fn save_accuracy(
    mechanism: &Mechanism,
    study: &PrecisionStudy,
    format: &StudyFormat,
    args: &AccuracyArgs,
    output: &mut dyn Output,
) -> Result<(), Failure> {
    let text = match format {
        StudyFormat::Chart(format) => {
            let chart = charts::precision::precision_chart(mechanism, study);
            return write_chart(
                &chart,
                *format,
                Some(args.size.unwrap_or(CHART)),
                args.theme,
                output,
            );
        }
        StudyFormat::Json => format!("{:#}\n", precision::precision_json(mechanism, study)),
        StudyFormat::Csv => precision::precision_csv(study),
    };
    output.emit(text.as_bytes())?;
    Ok(())
}
