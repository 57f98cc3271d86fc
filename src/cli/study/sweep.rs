//! `mechanim sweep`: many designs of a scene, one row each. Rows are kept in parts beside the file until all exist, so
//! that a run that is stopped or killed can be resumed.

use super::row_file::{RowFile, refuse_format};
use super::sweep_plot::SweepChartFile;
use crate::cli::args::sweep::{RowsArgs, SweepArgs, WorkArgs};
use crate::cli::interrupt::{is_interrupted, save_results};
use crate::cli::io;
use crate::cli::open::sweep::{OpenSweep, open_sweep};
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::cli::term::progress::Progress;
use crate::jobs::{core_count, share_watched};
use crate::parts::PartsError;
use crate::parts::folder::Folder;
use crate::parts::merge::Merge;
use crate::parts::plan::{MOST_UNITS, StudyPlan};
use crate::parts::work::{WorkEnd, WorkShare, work_on};
use crate::sweep::row::Row;
use crate::sweep::rows::RowWorker;
use crate::sweep::summary::Summary;
use crate::sweep::swept_scene::Sweep;
use std::cell::Cell;
use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Rows that a thread takes at once; one where a row takes as long as a check.
const PORTION: u64 = 16;

/// Duration of the work between saved parts: the most that a kill can cost.
const UNIT_TIME: Duration = Duration::from_secs(5);

/// Maximum size in bytes of the numbers of a unit, and maximum number of rows.
const UNIT_BYTES: u64 = 1 << 24;
const UNIT_ROWS: u64 = 1 << 16;

/// Runs the verb.
pub fn run_sweep(args: &SweepArgs, term: &Term) -> Result<Outcome, Failure> {
    let rows = &args.rows;
    let reports = [
        ("--out", rows.out.as_deref()),
        ("--plot", rows.plot.as_deref()),
    ];
    io::refuse_clashes(&[&args.asked.scene], &reports)?;
    io::refuse_over(&[PathBuf::from(&args.asked.design)], &reports)?;
    refuse_format(rows)?;
    let opened = open_sweep(&args.asked, term)?;
    let mut taker = RowTaker::new(&opened.sweep, &opened.plan, rows)?;
    let file = rows.out.as_deref().filter(|out| *out != Path::new("-"));
    let begun = Instant::now();
    match file {
        Some(file) => in_parts(args, &opened, file, &mut taker, term)?,
        None => in_memory(&opened, &args.work, &mut taker, term)?,
    }
    let text = taker.finish()?;
    let seconds = begun.elapsed().as_secs_f64();
    let text = format!("{text}  {seconds:.2} s\n");
    io::print_beside(term, rows.out.as_deref(), &text)?;
    Ok(Outcome::Done)
}

/// Rows in parts beside `file`, joined once all exist.
fn in_parts(
    args: &SweepArgs,
    opened: &OpenSweep,
    file: &Path,
    taker: &mut RowTaker,
    term: &Term,
) -> Result<(), Failure> {
    let place = parts_beside(file);
    let folder = match Folder::open(&place) {
        Ok(folder) if args.resume => folder,
        Err(PartsError::NoStudy(_)) if !place.exists() => {
            let mut plan = opened.plan.clone();
            plan.unit = unit_size(&opened.sweep, threads(&args.work), UNIT_TIME);
            Folder::create(&place, plan, &borrowed_files(&opened.files))?
        }
        Err(PartsError::NoStudy(_)) if args.resume => {
            let message = format!("{} holds no sweep that could be continued", place.display());
            let hint = "try again if another process has just begun it; otherwise remove it";
            return Err(Failure::usage(message, vec![hint.to_owned()]));
        }
        Ok(_) | Err(PartsError::NoStudy(_)) => {
            let message = format!("{} is left from a run that was stopped", place.display());
            let hint = "continue with --resume, or remove it";
            return Err(Failure::usage(message, vec![hint.to_owned()]));
        }
        Err(error) => return Err(error.into()),
    };
    refuse_other(&folder, &opened.plan)?;
    let share = WorkShare {
        units: 0..folder.plan.units(),
        begin: 0,
        until: None,
    };
    let make = |items: Range<u64>, watch: &dyn Fn(u64)| {
        numbers_of(&opened.sweep, items, threads(&args.work), watch)
    };
    let progress = Progress::new(args.work.progress, term.quiet()).counting("designs");
    let ended = run_share(&folder, &share, &make, progress);
    let ended = ended.map_err(|failure| unless_finished(failure, &place, file))?;
    if ended == WorkEnd::Stopped {
        let (all, missing) = (folder.plan.units(), folder.missing_units().len() as u64);
        return Err(Failure::Stopped(format!(
            "{} of {all} units are in {}: continue with --resume",
            all - missing,
            place.display()
        )));
    }
    merge_into(&folder, taker).map_err(|failure| unless_finished(failure, &place, file))?;
    taker.commit()?;
    let removed = folder.remove().map_err(Failure::from);
    // Two that finish together both have their rows, and one of them has removed the parts.
    match removed {
        Err(_) if !place.exists() => Ok(()),
        other => other,
    }
}

/// What fails because another process has finished the sweep and removed its parts is told as that.
fn unless_finished(failure: Failure, place: &Path, file: &Path) -> Failure {
    if place.exists() || !file.exists() {
        return failure;
    }
    let message = "another process has finished this sweep meanwhile";
    let hint = format!("all rows are in {}", file.display());
    Failure::usage(message, vec![hint])
}

/// Rows that are passed on as they are computed.
fn in_memory(
    opened: &OpenSweep,
    work: &WorkArgs,
    taker: &mut RowTaker,
    term: &Term,
) -> Result<(), Failure> {
    let sweep = &opened.sweep;
    let step = unit_size(sweep, threads(work), Duration::from_secs(1));
    let progress = Progress::new(work.progress, term.quiet()).counting("designs");
    let (width, all) = (sweep.width(), sweep.design.count());
    for first in (0..all).step_by(step as usize) {
        let items = first..all.min(first + step);
        let watch = |made: u64| progress.show((first + made) as usize, all as usize);
        let Some(numbers) = numbers_of(sweep, items.clone(), threads(work), &watch) else {
            progress.end();
            taker.commit()?;
            return Err(match first {
                0 => Failure::Interrupted,
                _ => Failure::Stopped(format!("only the first {first} designs were examined")),
            });
        };
        for (item, record) in items.zip(numbers.chunks_exact(width)) {
            taker.take(item, record)?;
        }
    }
    progress.end();
    taker.commit()
}

/// Computes the numbers of some items, or nothing after Ctrl-C, and reports the number finished.
pub type UnitWork<'w> = dyn Fn(Range<u64>, &dyn Fn(u64)) -> Option<Vec<f64>> + 'w;

/// Works on units of a study, with all threads on one unit. `counted` is the name of its items.
pub fn run_share(
    folder: &Folder,
    share: &WorkShare,
    make: &UnitWork,
    progress: Progress,
) -> Result<WorkEnd, Failure> {
    // Only the work of this run predicts the remaining time.
    let units = share.units.clone().filter(|unit| !folder.has(*unit));
    let all: u64 = units
        .map(|unit| items_in(&folder.plan.items_of(unit)))
        .sum();
    let before = Cell::new(0);
    let mut compute = |items: Range<u64>| {
        let count = items_in(&items);
        let watch = |made: u64| progress.show((before.get() + made) as usize, all as usize);
        let numbers = make(items, &watch);
        before.set(before.get() + count);
        numbers
    };
    // The current unit is worth waiting for.
    save_results(true);
    let ended = work_on(folder, share, &mut compute, &is_interrupted);
    save_results(false);
    progress.end();
    Ok(ended?)
}

/// Passes all rows of a study to `taker`, in order.
pub fn merge_into(folder: &Folder, taker: &mut RowTaker) -> Result<(), Failure> {
    Merge::new(folder)?.each(&mut |item, record| taker.take(item, record))
}

/// The study in a folder must be the requested one.
pub fn refuse_other(folder: &Folder, asked: &StudyPlan) -> Result<(), Failure> {
    if folder.plan.identity == asked.identity {
        return Ok(());
    }
    Err(Failure::Parts(PartsError::Foreign {
        path: folder.path().to_owned(),
        why: "contains rows of another scene, other meshes or other arguments".to_owned(),
    }))
}

/// The numbers of some rows; nothing after Ctrl-C. `watch` receives the number finished.
pub fn numbers_of(
    sweep: &Sweep,
    items: Range<u64>,
    threads: usize,
    watch: &dyn Fn(u64),
) -> Option<Vec<f64>> {
    let portion = if sweep.reads_anew() { 1 } else { PORTION };
    let count = items_in(&items).div_ceil(portion);
    let work = |worker: &mut RowWorker, index: usize| {
        if is_interrupted() {
            return None;
        }
        let first = items.start + portion * index as u64;
        let mut numbers = Vec::with_capacity(portion as usize * sweep.width());
        for row in worker.rows(first..items.end.min(first + portion)) {
            numbers.extend(row.record());
        }
        Some(numbers)
    };
    let make = || RowWorker::new(sweep);
    let portions = |done: usize| watch((done as u64 * portion).min(items_in(&items)));
    let made = share_watched(count as usize, threads, make, work, &portions);
    let is_whole = made.len() as u64 == count;
    is_whole.then(|| made.into_iter().flat_map(|(_, numbers)| numbers).collect())
}

fn items_in(items: &Range<u64>) -> u64 {
    items.end - items.start
}

/// Rows of a unit that takes about `time`, a power of two. The rows do not depend on it.
pub fn unit_size(sweep: &Sweep, threads: usize, time: Duration) -> u64 {
    let begun = Instant::now();
    let middle = sweep.design.count() / 2;
    RowWorker::new(sweep).rows(middle..middle + 1);
    let row = begun.elapsed().as_secs_f64().max(1e-7) / threads as f64;
    let most = (UNIT_BYTES / (8 * sweep.width() as u64)).clamp(1, UNIT_ROWS);
    let rows = ((time.as_secs_f64() / row) as u64).clamp(1, most);
    let least = sweep.design.count().div_ceil(MOST_UNITS);
    (1 << rows.ilog2()).max(least)
}

/// The requested number of threads.
pub fn threads(work: &WorkArgs) -> usize {
    work.threads.unwrap_or_else(core_count)
}

/// Names and bytes of files.
pub fn borrowed_files<'f>(files: &'f [(&'static str, Vec<u8>)]) -> Vec<(&'f str, &'f [u8])> {
    let each = files.iter();
    each.map(|(name, bytes)| (*name, bytes.as_slice()))
        .collect()
}

/// `rows.csv.parts` beside `rows.csv`.
fn parts_beside(file: &Path) -> PathBuf {
    let mut name = OsString::from(file);
    name.push(".parts");
    PathBuf::from(name)
}

/// Receives rows in order: for a file, a picture, and the summary.
pub struct RowTaker<'s> {
    file: Option<RowFile<'s>>,
    plot: Option<SweepChartFile<'s>>,
    summary: Summary<'s>,
}

impl<'s> RowTaker<'s> {
    /// Opens the files before anything is computed.
    pub fn new(sweep: &'s Sweep, plan: &StudyPlan, rows: &RowsArgs) -> Result<Self, Failure> {
        let open = |path: &PathBuf| RowFile::open(sweep, plan, path);
        Ok(Self {
            file: rows.out.as_ref().map(open).transpose()?,
            plot: SweepChartFile::open(sweep, rows)?,
            summary: Summary::new(sweep),
        })
    }

    /// Adds the row of design `item`.
    pub fn take(&mut self, item: u64, record: &[f64]) -> Result<(), Failure> {
        let row = Row::of_record(record).ok_or_else(|| {
            Failure::Internal("a part contains something that is not a row".to_owned())
        })?;
        self.summary.add(item, &row);
        if let Some(plot) = &mut self.plot {
            plot.add(item, &row);
        }
        self.file
            .as_mut()
            .map_or(Ok(()), |file| file.take(item, &row))
    }

    /// Ends the file of rows.
    pub fn commit(&mut self) -> Result<(), Failure> {
        self.file.take().map_or(Ok(()), RowFile::commit)
    }

    /// Draws, and prints the result.
    pub fn finish(self) -> Result<String, Failure> {
        if let Some(plot) = self.plot {
            plot.write()?;
        }
        Ok(self.summary.text())
    }
}
