//! `mechanim tolerance`: linear scatter and random pieces of a study, with yield against the limits of its measures.

use crate::analysis::study::DefaultVariables;
use crate::analysis::tolerance_study::ToleranceStudy;
use crate::cli::args::study::ToleranceArgs;
use crate::cli::interrupt::CANCEL;
use crate::cli::io;
use crate::cli::open::study::open_study;
use crate::cli::open::tolerance::batch_of;
use crate::cli::pictures::tolerance_cloud;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::cli::term::progress::Progress;
use crate::export::ExportError;
use crate::jobs::core_count;
use crate::report::tolerance::{SHARES, ToleranceReport};
use std::path::PathBuf;
use std::time::Instant;

/// Runs the verb.
pub fn run_tolerance(args: &ToleranceArgs, term: &Term) -> Result<Outcome, Failure> {
    tolerance_cloud::refuse_cloud(args)?;
    if args.first.checked_add(args.samples).is_none() {
        let message = "--skip plus --pieces is too large a number";
        return Err(Failure::usage(message, Vec::new()));
    }
    let reports = [
        ("--json", args.json.as_deref()),
        ("--csv", args.csv.as_deref()),
        ("--picture", args.picture.as_deref()),
        ("--plot", args.plot.as_deref()),
    ];
    let scatter = &args.scatter;
    io::refuse_clashes(&[&scatter.scene], &reports)?;
    let default = DefaultVariables::WithTolerance;
    let loaded = open_study(&scatter.scene, &scatter.vary, default, term)?;
    let start = Instant::now();
    let threads = args.threads.unwrap_or_else(core_count);
    let batch = batch_of(scatter, args.samples, args.first, threads);
    let study = ToleranceStudy::new(&loaded, scatter.tolerance, batch)?.with_extremes(&CANCEL);
    let progress = Progress::new(args.progress, term.quiet()).counting("pieces");
    let watch = |done| progress.show(done, args.samples);
    // The pieces computed so far are worth saving.
    crate::cli::interrupt::save_results(true);
    let pieces = study.pieces(&CANCEL, &watch);
    progress.end();
    if pieces.made == 0 {
        return Err(Failure::Interrupted);
    }
    let is_whole = pieces.made == args.samples;
    if is_whole {
        tolerance_cloud::write_cloud(args, &study)?;
    }
    let report = ToleranceReport {
        study: &study,
        pieces: &pieces.summary(&SHARES),
        first: args.first as u64,
        seconds: Some(start.elapsed().as_secs_f64()),
    };
    if let Some(path) = &args.csv {
        let mut target = io::open_output(&io::unless_complete(path, is_whole))?;
        let written = report.write_csv(&pieces, &mut target);
        written.map_err(|source| ExportError::write(target.name(), source))?;
        target.commit()?;
    }
    if let Some(path) = &args.json {
        let path = io::unless_complete(path, is_whole);
        io::write_json(&scatter.scene, &path, &report.document())?;
    }
    let reports = [&args.json, &args.csv].into_iter().flatten();
    io::print_beside(term, reports.map(PathBuf::as_path), &report.text())?;
    if !is_whole {
        let done = pieces.made;
        return Err(Failure::Stopped(format!(
            "the report is that of the first {done} pieces"
        )));
    }
    Ok(Outcome::Done)
}
