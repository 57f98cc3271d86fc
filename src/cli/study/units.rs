//! `mechanim study`: a sweep, or the pieces of a tolerance study, in units, done by any number of machines that share a
//! folder.

use super::row_file::refuse_format;
use super::sweep::{
    RowTaker, UnitWork, borrowed_files, merge_into, numbers_of, refuse_other, run_share, threads,
    unit_size,
};
use super::{submit, tolerance_units};
use crate::cli::args::study::ScatterArgs;
use crate::cli::args::sweep::{
    CutArgs, MergeArgs, PlanSweepArgs, PlanToleranceArgs, PlannedVerb, RunArgs, StudyCommand,
    SweepRequestArgs,
};
use crate::cli::io;
use crate::cli::open::planned::SCENE_FILE;
use crate::cli::open::sweep::{DESIGN_FILE, OpenSweep};
use crate::cli::open::tolerance::OpenTolerance;
use crate::cli::open::{sweep, tolerance};
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::cli::term::progress::Progress;
use crate::parts::PartsError;
use crate::parts::folder::Folder;
use crate::parts::plan::{MOST_UNITS, StudyPlan};
use crate::parts::ranges::shown_ranges;
use crate::parts::work::{WorkEnd, WorkShare};
use crate::report::sentences::counted_things;
use clap::Parser;
use serde_json::json;
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

/// Default duration of a unit.
const UNIT_TIME: Duration = Duration::from_secs(30);

/// Runs the verb.
pub fn run_study(command: &StudyCommand, term: &Term) -> Result<Outcome, Failure> {
    match command {
        StudyCommand::Plan { verb } => match verb {
            PlannedVerb::Sweep(args) => plan_sweep(args, term),
            PlannedVerb::Tolerance(args) => plan_tolerance(args, term),
        },
        StudyCommand::Run(args) => run_units(args, term),
        StudyCommand::Status { folder, json } => print_status(folder, json.as_deref(), term),
        StudyCommand::Merge(args) => merge_parts(args, term),
        StudyCommand::Submit(args) => submit::submit(args, term),
    }
}

fn plan_sweep(args: &PlanSweepArgs, term: &Term) -> Result<Outcome, Failure> {
    let opened = sweep::open_sweep(&args.asked, term)?;
    let unit = || Ok(unit_size(&opened.sweep, 1, UNIT_TIME));
    create_study(&args.cut, opened.plan.clone(), &opened.files, unit, term)
}

fn plan_tolerance(args: &PlanToleranceArgs, term: &Term) -> Result<Outcome, Failure> {
    let opened = tolerance::open_tolerance(&args.scatter, args.pieces, term)?;
    // A study that cannot be run is refused before its folder is made.
    let study = tolerance_units::study_of(&opened)?;
    let unit = || Ok(tolerance_units::unit_size(&study, args.pieces, UNIT_TIME));
    create_study(&args.cut, opened.plan.clone(), &opened.files, unit, term)
}

/// Makes the folder of a study; `unit` gives the default size of its units.
fn create_study(
    cut: &CutArgs,
    mut plan: StudyPlan,
    files: &[(&'static str, Vec<u8>)],
    unit: impl FnOnce() -> Result<u64, Failure>,
    term: &Term,
) -> Result<Outcome, Failure> {
    plan.unit = match cut.units {
        Some(units) => plan.items.div_ceil(units.min(MOST_UNITS)),
        None => unit()?,
    };
    let folder = Folder::create(&cut.out, plan, &borrowed_files(files))?;
    let text = format!(
        "{}: {} {} in {} of {}\n",
        cut.out.display(),
        folder.plan.items,
        counted_items(&folder.plan),
        counted_things(folder.plan.units() as usize, "unit"),
        folder.plan.unit
    );
    io::print_beside(term, None, &text)?;
    Ok(Outcome::Done)
}

/// The name of the items of a study.
fn counted_items(plan: &StudyPlan) -> &'static str {
    match plan.verb == tolerance::VERB {
        true => "pieces",
        false => "designs",
    }
}

/// The arguments of a plan, read as those of a command.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct PlannedSweep {
    #[command(flatten)]
    asked: SweepRequestArgs,
}

/// The same for pieces.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct PlannedTolerance {
    #[command(flatten)]
    scatter: ScatterArgs,
}

/// A study that is ready to be run.
enum OpenStudy {
    Sweep(Box<OpenSweep>),
    Tolerance(Box<OpenTolerance>),
}

/// The study in a folder.
fn open_folder(path: &Path, term: &Term) -> Result<(Folder, OpenStudy), Failure> {
    let folder = Folder::open(path)?;
    let plan = &folder.plan;
    let opened = match plan.verb.as_str() {
        sweep::VERB => {
            let read: PlannedSweep = planned_arguments(path, plan)?;
            let opened = sweep::open_planned(&read.asked, plan, path, term)?;
            refuse_other(&folder, &opened.plan)?;
            OpenStudy::Sweep(Box::new(opened))
        }
        tolerance::VERB => {
            let read: PlannedTolerance = planned_arguments(path, plan)?;
            let opened = tolerance::open_planned(&read.scatter, plan, path, term)?;
            refuse_other(&folder, &opened.plan)?;
            OpenStudy::Tolerance(Box::new(opened))
        }
        other => return Err(bad_plan(path, format!("a study cannot do `{other}`"))),
    };
    Ok((folder, opened))
}

fn bad_plan(folder: &Path, why: String) -> Failure {
    let path = folder.join("plan.json");
    PartsError::BadPlan { path, why }.into()
}

fn planned_arguments<P: Parser>(path: &Path, plan: &StudyPlan) -> Result<P, Failure> {
    let words = std::iter::once("scene").chain(plan.arguments.iter().map(String::as_str));
    let read = P::try_parse_from(words);
    read.map_err(|e| bad_plan(path, format!("`arguments` cannot be read: {}", e.kind())))
}

fn run_units(args: &RunArgs, term: &Term) -> Result<Outcome, Failure> {
    let (folder, opened) = open_folder(&args.folder, term)?;
    let all = folder.plan.units();
    let units = match args.units {
        Some([_, end]) if end > all => {
            let message = format!("the study has {all} units, 0..{all}");
            return Err(Failure::usage(message, Vec::new()));
        }
        Some([first, end]) => first..end,
        None => 0..all,
    };
    // Worker I begins at the fraction (I - 1) / N of the units.
    let begin = args.worker.map_or(units.start, |[own, workers]| {
        (u128::from(own - 1) * u128::from(all) / u128::from(workers)) as u64
    });
    let share = WorkShare {
        until: args.until.map(|time| Instant::now() + time),
        begin,
        units,
    };
    let ended = work_on_share(&folder, &opened, &share, args, term)?;
    let missing = folder.missing_units().len() as u64;
    let done = format!("{} of {all} units are done", all - missing);
    match ended {
        WorkEnd::Stopped => Err(Failure::Stopped(done)),
        WorkEnd::Done | WorkEnd::TimeOver => {
            io::print_beside(term, None, &format!("{done}\n"))?;
            Ok(Outcome::Done)
        }
    }
}

fn work_on_share(
    folder: &Folder,
    opened: &OpenStudy,
    share: &WorkShare,
    args: &RunArgs,
    term: &Term,
) -> Result<WorkEnd, Failure> {
    let work = &args.work;
    let share_of = |make: &UnitWork| {
        let progress = Progress::new(work.progress, term.quiet());
        run_share(
            folder,
            share,
            make,
            progress.counting(counted_items(&folder.plan)),
        )
    };
    match opened {
        OpenStudy::Sweep(opened) => share_of(&|items: Range<u64>, watch: &dyn Fn(u64)| {
            numbers_of(&opened.sweep, items, threads(work), watch)
        }),
        OpenStudy::Tolerance(opened) => {
            let study = tolerance_units::study_of(opened)?;
            share_of(&|items: Range<u64>, watch: &dyn Fn(u64)| {
                tolerance_units::sums_of(&study, items, threads(work), watch)
            })
        }
    }
}

fn print_status(path: &Path, report: Option<&Path>, term: &Term) -> Result<Outcome, Failure> {
    let folder = Folder::open(path)?;
    refuse_over_study(&folder, &[("--json", report)])?;
    let (all, missing) = (folder.plan.units(), folder.missing_units());
    let (leased, done) = (folder.leased_units(), all - missing.len() as u64);
    let rate = unit_rate(&folder.part_times());
    let left = rate.map(|rate| missing.len() as f64 / rate);
    if let Some(report) = report {
        let document = json!({
            "schema": "mechanim-status/1",
            "identity": folder.plan.identity,
            "items": folder.plan.items,
            "units": all,
            "done": done,
            "leased": leased,
            "missing": shown_ranges(&missing),
            "units_a_second": rate,
            "seconds_left": left,
        });
        io::write_document(report, &document)?;
    }
    let mut text = format!(
        "{} of {}: {} {}\n  {done} of {all} units done, {} in progress\n",
        folder.plan.verb,
        folder.plan.scene,
        folder.plan.items,
        counted_items(&folder.plan),
        leased.len()
    );
    if !missing.is_empty() {
        text.push_str(&format!("  missing: {}\n", shown_ranges(&missing)));
    }
    if let (Some(rate), Some(left), false) = (rate, left, missing.is_empty()) {
        text.push_str(&format!("  {rate:.3} units a second, {left:.0} s left\n"));
    }
    io::print_beside(term, report, &text)?;
    Ok(Outcome::Done)
}

/// Refuses reports over the files of a study.
fn refuse_over_study(folder: &Folder, reports: &[(&str, Option<&Path>)]) -> Result<(), Failure> {
    let scene = Path::new(&folder.plan.scene).file_name();
    let scene = scene.map(|name| name.to_string_lossy().into_owned());
    let names = [DESIGN_FILE, SCENE_FILE];
    let names: Vec<&str> = names.into_iter().chain(scene.as_deref()).collect();
    io::refuse_over(&folder.own_files(&names), reports)
}

/// Units per second between the first part and the last; unknown for fewer than two.
fn unit_rate(times: &[SystemTime]) -> Option<f64> {
    let [first, .., last] = times else {
        return None;
    };
    let seconds = last.duration_since(*first).ok()?.as_secs_f64();
    (seconds > 0.0).then(|| (times.len() - 1) as f64 / seconds)
}

fn merge_parts(args: &MergeArgs, term: &Term) -> Result<Outcome, Failure> {
    if args.missing {
        let folder = Folder::open(&args.folder)?;
        let text = shown_ranges(&folder.missing_units());
        io::print_beside(term, None, &format!("{text}\n"))?;
        return Ok(Outcome::Done);
    }
    let (folder, opened) = open_folder(&args.folder, term)?;
    let (out, plot) = (args.rows.out.as_deref(), args.rows.plot.as_deref());
    refuse_over_study(&folder, &[("--out", out), ("--plot", plot)])?;
    let text = match opened {
        OpenStudy::Sweep(opened) => {
            refuse_format(&args.rows)?;
            let mut taker = RowTaker::new(&opened.sweep, &folder.plan, &args.rows)?;
            merge_into(&folder, &mut taker)?;
            taker.commit()?;
            taker.finish()?
        }
        OpenStudy::Tolerance(opened) => tolerance_units::merge(&folder, &opened, &args.rows)?,
    };
    io::print_beside(term, args.rows.out.as_deref(), &text)?;
    Ok(Outcome::Done)
}
