//! `mechanim study`: a sweep in units, done by any number of machines that see one folder.

use super::submit;
use super::sweep::{
    RowTaker, borrowed, merge_into, refuse_format, refuse_other, run_share, unit_size,
};
use crate::cli::args::sweep::{
    MergeArgs, PlanSweepArgs, PlannedVerb, RunArgs, StudyCommand, SweepAsked,
};
use crate::cli::io;
use crate::cli::open::sweep::{OpenSweep, VERB, open_planned, open_sweep};
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::parts::PartsError;
use crate::parts::folder::Folder;
use crate::parts::plan::Plan;
use crate::parts::ranges::shown_ranges;
use crate::parts::work::{Ended, Share};
use clap::Parser;
use serde_json::json;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

/// How long a unit takes where nothing is said.
const UNIT_TIME: Duration = Duration::from_secs(30);

/// Runs the verb.
pub fn run_study(command: &StudyCommand, term: &Term) -> Result<Outcome, Failure> {
    match command {
        StudyCommand::Plan { verb } => match verb {
            PlannedVerb::Sweep(args) => plan_sweep(args, term),
        },
        StudyCommand::Run(args) => run_units(args, term),
        StudyCommand::Status { folder, json } => print_status(folder, *json, term),
        StudyCommand::Merge(args) => merge(args, term),
        StudyCommand::Submit(args) => submit::submit(args, term),
    }
}

fn plan_sweep(args: &PlanSweepArgs, term: &Term) -> Result<Outcome, Failure> {
    let opened = open_sweep(&args.asked, term)?;
    let mut plan = opened.plan.clone();
    plan.unit = match args.units {
        Some(units) => plan.items.div_ceil(units),
        None => unit_size(&opened.sweep, 1, UNIT_TIME),
    };
    let folder = Folder::create(&args.out, plan, &borrowed(&opened.files))?;
    let text = format!(
        "{}: {} designs in {} units of {}\n",
        args.out.display(),
        folder.plan.items,
        folder.plan.units(),
        folder.plan.unit
    );
    io::print_beside(term, None, &text)?;
    Ok(Outcome::Done)
}

/// The arguments of a plan, read as those of a command.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct PlannedSweep {
    #[command(flatten)]
    asked: SweepAsked,
}

/// The study in a folder, ready to be worked on.
fn open_folder(path: &Path, term: &Term) -> Result<(Folder, OpenSweep), Failure> {
    let folder = Folder::open(path)?;
    let asked = planned(path, &folder.plan)?;
    let opened = open_planned(&asked, &folder.plan, path, term)?;
    refuse_other(&folder, &opened)?;
    Ok((folder, opened))
}

fn planned(path: &Path, plan: &Plan) -> Result<SweepAsked, Failure> {
    let bad = |why: String| PartsError::BadPlan {
        path: path.join("plan.json"),
        why,
    };
    if plan.verb != VERB {
        return Err(bad(format!("no study does `{}`", plan.verb)).into());
    }
    let words = std::iter::once("scene").chain(plan.arguments.iter().map(String::as_str));
    let read = PlannedSweep::try_parse_from(words);
    let read = read.map_err(|e| bad(format!("`arguments` cannot be read: {}", e.kind())))?;
    Ok(read.asked)
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
    // Worker I begins where I - 1 shares of the units end.
    let begin = args.worker.map_or(units.start, |[own, workers]| {
        (u128::from(own - 1) * u128::from(all) / u128::from(workers)) as u64
    });
    let share = Share {
        until: args.until.map(|time| Instant::now() + time),
        begin,
        units,
    };
    let ended = run_share(&folder, &opened.sweep, &share, &args.work, term)?;
    let missing = folder.missing_units().len() as u64;
    let done = format!("{} of {all} units are done", all - missing);
    match ended {
        Ended::Stopped => Err(Failure::Stopped(done)),
        Ended::Done | Ended::TimeOver => {
            io::print_beside(term, None, &format!("{done}\n"))?;
            Ok(Outcome::Done)
        }
    }
}

fn print_status(path: &Path, is_json: bool, term: &Term) -> Result<Outcome, Failure> {
    let folder = Folder::open(path)?;
    let (all, missing) = (folder.plan.units(), folder.missing_units());
    let (leased, done) = (folder.leased_units(), all - missing.len() as u64);
    let rate = unit_rate(&folder.part_times());
    let left = rate.map(|rate| missing.len() as f64 / rate);
    if is_json {
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
        io::write_document(Path::new("-"), &document)?;
        return Ok(Outcome::Done);
    }
    let mut text = format!(
        "{} of {}: {} designs\n  {done} of {all} units done, {} worked on\n",
        folder.plan.verb,
        folder.plan.scene,
        folder.plan.items,
        leased.len()
    );
    if !missing.is_empty() {
        text.push_str(&format!("  missing: {}\n", shown_ranges(&missing)));
    }
    if let (Some(rate), Some(left), false) = (rate, left, missing.is_empty()) {
        text.push_str(&format!("  {rate:.3} units a second, {left:.0} s left\n"));
    }
    io::print_beside(term, None, &text)?;
    Ok(Outcome::Done)
}

/// Units a second between the first part and the last; unknown of fewer than two.
fn unit_rate(times: &[SystemTime]) -> Option<f64> {
    let [first, .., last] = times else {
        return None;
    };
    let seconds = last.duration_since(*first).ok()?.as_secs_f64();
    (seconds > 0.0).then(|| (times.len() - 1) as f64 / seconds)
}

fn merge(args: &MergeArgs, term: &Term) -> Result<Outcome, Failure> {
    if args.missing {
        let folder = Folder::open(&args.folder)?;
        let text = shown_ranges(&folder.missing_units());
        io::print_beside(term, None, &format!("{text}\n"))?;
        return Ok(Outcome::Done);
    }
    refuse_format(&args.rows)?;
    let (folder, opened) = open_folder(&args.folder, term)?;
    let mut taker = RowTaker::new(&opened.sweep, &args.rows)?;
    merge_into(&folder, &mut taker)?;
    taker.commit()?;
    io::print_beside(term, args.rows.out.as_deref(), &taker.finish()?)?;
    Ok(Outcome::Done)
}
