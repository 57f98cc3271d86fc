//! `mechanim accuracy`: routes along a motion, their time against their true error.

use crate::analysis::work_precision::{Study, StudyError, study};
use crate::charts;
use crate::cli::args::charts::AccuracyArgs;
use crate::cli::files::chart::{PlotFormat, write};
use crate::cli::io;
use crate::cli::open::scene as open_scene;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::export::Output;
use crate::model::mechanism::Mechanism;
use crate::report::precision;
use std::path::Path;

/// Pixels of the chart.
const CHART: [u32; 2] = [840, 520];

/// What the report is written as.
enum Format {
    Csv,
    Json,
    Chart(PlotFormat),
}

/// Runs the verb.
pub fn run(args: &AccuracyArgs, term: &Term) -> Result<Outcome, Failure> {
    let format = args.out.as_deref().map(format).transpose()?;
    if let Some(out) = &args.out {
        io::refuse_input(&args.scene, out)?;
    }
    let OpenScene { scene, system } = open_scene::open(&args.scene, term)?;
    let mechanism = &scene.mechanism;
    let mut output = args.out.as_deref().map(io::open).transpose()?;
    let study = match study(&system, &scene.actuation, args.poses, args.turns) {
        Ok(study) => study,
        Err(error @ StudyError::Gap { .. }) => {
            return Err(Failure::NeverClosed {
                message: error.to_string(),
                hints: vec!["`mechanim check` tells where the motion ends".to_owned()],
            });
        }
    };
    crate::cli::interrupt::refuse_interrupted()?;
    if let (Some(format), Some(output)) = (format, output.as_mut()) {
        save(mechanism, &study, &format, args, output.as_mut())?;
    }
    if let Some(output) = output {
        output.commit()?;
    }
    io::print_beside(
        term,
        args.out.as_deref(),
        &precision::text(mechanism, &study),
    )?;
    Ok(Outcome::Done)
}

fn format(path: &Path) -> Result<Format, Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        None if path == Path::new("-") => Ok(Format::Json),
        Some("json") => Ok(Format::Json),
        Some("csv") => Ok(Format::Csv),
        Some("svg") => Ok(Format::Chart(PlotFormat::Svg)),
        Some("png") => Ok(Format::Chart(PlotFormat::Png)),
        _ => Err(Failure::usage(
            format!("{}: unknown kind of report", path.display()),
            vec!["known are .json, .csv, .svg and .png".to_owned()],
        )),
    }
}

fn save(
    mechanism: &Mechanism,
    study: &Study,
    format: &Format,
    args: &AccuracyArgs,
    output: &mut dyn Output,
) -> Result<(), Failure> {
    let text = match format {
        Format::Chart(format) => {
            let chart = charts::precision::chart(mechanism, study);
            return write(
                &chart,
                *format,
                Some(args.size.unwrap_or(CHART)),
                args.theme,
                output,
            );
        }
        Format::Json => format!("{:#}\n", precision::json(mechanism, study)),
        Format::Csv => precision::csv(study),
    };
    output.emit(text.as_bytes())?;
    Ok(())
}
