//! `mechanim optimise`: minimises the study's objective; the result is proved, reported, and written as a scene.

use super::{pairs, search_film, search_map, search_paths};
use crate::analysis::optimise::StopReason;
use crate::analysis::study::optimum::Verified;
use crate::analysis::study::{DefaultVariables, FamilyError, FoundOptimum, LoadedStudy};
use crate::cli::args::study::OptimiseArgs;
use crate::cli::files::chart::PlotFormat;
use crate::cli::interrupt::{CANCEL, is_interrupted, save_results, unless_interrupted};
use crate::cli::io;
use crate::cli::open::study::open_search;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::cli::term::progress::Progress;
use crate::report::cells::six_digits;
use crate::report::optimum::OptimumReport;
use crate::scene::edit::with_values;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Iterations between two plain lines of progress.
const LINES_APART: usize = 50;

/// Runs the verb.
pub fn run_optimise(args: &OptimiseArgs, term: &Term) -> Result<Outcome, Failure> {
    let reports = [
        ("--out", args.out.as_deref()),
        ("--json", args.json.as_deref()),
        ("--film", args.film.as_deref()),
        ("--plot", args.plot.as_deref()),
        ("--history", args.history.as_deref()),
        ("--map", args.map.as_deref()),
    ];
    io::refuse_clashes(&[&args.scene], &reports)?;
    let chart = args.plot.as_deref().map(PlotFormat::of).transpose()?;
    let map = args.map.as_deref().map(PlotFormat::of).transpose()?;
    let film = args.film.as_deref().map(search_film::film_file);
    let film = film.transpose()?;
    // Pairs are of all dimensions.
    let default = match args.pairs {
        true => DefaultVariables::All,
        false => DefaultVariables::OfStudy,
    };
    let mut study = open_search(
        &args.scene,
        &args.vary,
        (default, args.minimise.as_deref()),
        term,
    )?;
    if let Some(share) = args.within {
        study.family.free_within(share);
    }
    if args.pairs {
        return pairs::run_pairs(args, &study, term);
    }
    if chart.is_some() {
        search_paths::refuse_without_paths(&study)?;
    }
    if map.is_some() {
        search_map::refuse_other_count(&study)?;
    }
    let start = Instant::now();
    let study = Arc::new(study);
    let found = search_with_progress(args, &study, term)?;
    let found = settled_optimum(&study, found)?;
    let is_stopped = found.optimum.minimum.ended == StopReason::Stopped;
    let seconds = start.elapsed().as_secs_f64();
    let verified = verified_motion(&study, &found.optimum.minimum.x);
    let complete = |path| io::unless_complete(path, !is_stopped);
    let out = args.out.as_deref().map(complete);
    if let Some(out) = &out {
        write_scene(args, out, &study, &found.optimum.minimum.x, term)?;
    }
    let report = OptimumReport {
        study: &study,
        found: &found,
        verified: &verified,
        seconds,
    };
    if let Some(path) = &args.json {
        io::write_json(&args.scene, &complete(path), &report.document())?;
    }
    if let Some(path) = &args.history {
        let history = search_paths::search_history(&study, &found.improvements);
        io::write_text(&args.scene, &complete(path), &history)?;
    }
    let reports = [&args.json, &args.history].into_iter().flatten();
    io::print_beside(term, reports.map(PathBuf::as_path), &report.text())?;
    if is_stopped {
        return Err(Failure::best_so_far(out.as_deref()));
    }
    save_results(false);
    if let (Some(path), Some(format)) = (&args.plot, chart) {
        search_paths::write_paths(path, format, &study, &found.improvements)?;
    }
    if let (Some(path), Some(format)) = (&args.map, map) {
        search_map::write_map(path, format, &study, &found.improvements)?;
    }
    if let Some(film) = &film {
        search_film::write_search_film(film, &study, &found.improvements, term)?;
    }
    Ok(match report.holds() {
        true => Outcome::Done,
        false => Outcome::CheckFailed,
    })
}

/// The scene with the best values, as a file.
fn write_scene(
    args: &OptimiseArgs,
    out: &Path,
    study: &LoadedStudy,
    values: &[f64],
    term: &Term,
) -> Result<(), Failure> {
    let parameters = study.parameters(values);
    let text = with_values(&study.source, &parameters, &study.overrides.guess)?;
    io::write_text(&args.scene, out, &text)?;
    if !study.overrides.inputs.is_empty() || study.overrides.drives.is_some() {
        let out = out.display();
        term.warning(&format!(
            "{out} has the drive of the scene, not that of the command line"
        ));
    }
    Ok(())
}

/// The same with the clearances, whose minimum may move; after an interrupted search they are not examined.
fn settled_optimum(
    study: &Arc<LoadedStudy>,
    mut found: FoundOptimum,
) -> Result<FoundOptimum, Failure> {
    if found.optimum.minimum.ended == StopReason::Stopped {
        return Ok(found);
    }
    let (own, before) = (Arc::clone(study), found.clone());
    let work = move || {
        let mut found = before.clone();
        own.settle(&mut found).map(|()| found)
    };
    match unless_interrupted(work) {
        Some(settled) => Ok(settled?),
        None => {
            found.optimum.minimum.ended = StopReason::Stopped;
            Ok(found)
        }
    }
}

/// The independent motion, unless Ctrl-C comes first.
fn verified_motion(study: &Arc<LoadedStudy>, values: &[f64]) -> Result<Verified, FamilyError> {
    let (study, values) = (Arc::clone(study), values.to_vec());
    let unproved = || {
        Err(FamilyError::Lacks(
            "interrupted before the proof".to_owned(),
        ))
    };
    unless_interrupted(move || study.verify(&values)).unwrap_or_else(unproved)
}

/// The search, which reports its progress and ends with Ctrl-C.
fn search_with_progress(
    args: &OptimiseArgs,
    study: &LoadedStudy,
    term: &Term,
) -> Result<FoundOptimum, Failure> {
    let progress = Progress::new(args.progress, term.quiet());
    let unit = study.objective_unit();
    let mut heard = |iteration: usize, value: f64| {
        let text = format!("  iteration {iteration}: {}", six_digits(value * unit));
        progress.say(&text, iteration.is_multiple_of(LINES_APART));
        // From here on the best result so far is worth saving.
        save_results(true);
    };
    let method = args.search_method();
    let found = study.search_optimum(method, args.iterations, &mut heard, &CANCEL)?;
    progress.end();
    if found.is_empty() && is_interrupted() {
        return Err(Failure::Interrupted);
    }
    Ok(found)
}
