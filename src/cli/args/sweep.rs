//! The argument tables of `mechanim sweep`, and of `mechanim study`, which cuts it into units.

use super::files::ProgressArg;
use super::scene::SceneArgs;
use super::study::{ScatterArgs, thread_count, whole_between};
use super::values::{frame_count, named_word};
use crate::model::theme::Theme;
use crate::sweep::design_text::read_count;
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;

/// What is swept, and what is asked of every design: everything that the rows depend on.
#[derive(Clone, Debug, Args)]
pub struct SweepRequestArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The designs: grid:A=0..10:11,B=1..2:5 (every combination), lhs:N or sobol:N (within the ranges of the scene's study, or
    /// lhs:N,A=0..10), or a table TABLE.csv with a column for every parameter.
    #[arg(long, value_name = "DESIGN")]
    pub design: String,
    /// Rows contain the scene's measures; this is the default.
    #[arg(long, conflicts_with_all = ["outputs", "check"])]
    pub measures: bool,
    /// Rows contain these, separated by commas, at the instants of --samples or --at: inputs, unknowns, traced points as
    /// NAME.x, outputs.
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        conflicts_with = "check"
    )]
    pub outputs: Vec<String>,
    /// Leave out the certificates, which makes rows many times faster: poses are closed and kept on their branch by tests of
    /// the steps, but nothing is proved.
    #[arg(long, conflicts_with = "check")]
    pub unproved: bool,
    /// Rows contain the result of `mechanim check`: whether it passes, and the smallest margin of a clearance, as found and as
    /// proved for all times.
    #[arg(long)]
    pub check: bool,
    /// Number of samples, spread evenly over the motion [default: 180; with --outputs 60].
    #[arg(long, value_name = "N", value_parser = frame_count, conflicts_with = "check")]
    pub samples: Option<usize>,
    /// Time in seconds of a value; several separated by commas, in place of even ones.
    #[arg(
        long,
        value_name = "SECONDS",
        value_delimiter = ',',
        conflicts_with = "samples",
        requires = "outputs"
    )]
    pub at: Vec<f64>,
    /// Seed of the random numbers (lhs).
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// Where rows go once they are there.
#[derive(Clone, Debug, Args)]
pub struct RowsArgs {
    /// Where to write: the rows as .csv, .jsonl or (where the program has it) .parquet; `-` for CSV on standard output.
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Draw a chart (.svg or .png): a curve over one parameter, or a map over two, with the feasible region.
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Draw only this value; if absent, the study's objective, otherwise the first value.
    #[arg(long, value_name = "NAME", requires = "plot")]
    pub only: Option<String>,
    /// Light or dark: colours of background, text and lines.
    #[arg(long, value_parser = named_word(&Theme::NAMES), default_value = "light")]
    pub theme: Theme,
}

/// How a machine works.
#[derive(Clone, Debug, Args)]
pub struct WorkArgs {
    /// Worker threads; all cores if absent. The rows do not depend on it.
    #[arg(long, value_name = "N", value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Progress on standard error: a bar on a terminal (auto), plain lines, or none.
    #[arg(long, value_enum, default_value_t = ProgressArg::Auto)]
    pub progress: ProgressArg,
}

/// `mechanim sweep`
#[derive(Debug, Args)]
#[command(after_help = SWEEP_EXAMPLES)]
pub struct SweepArgs {
    /// What is swept.
    #[command(flatten)]
    pub asked: SweepRequestArgs,
    /// Where rows go.
    #[command(flatten)]
    pub rows: RowsArgs,
    /// Continue a run that was stopped, from the folder FILE.parts beside --out; from the beginning if there is none.
    #[arg(long, requires = "out")]
    pub resume: bool,
    /// How it works.
    #[command(flatten)]
    pub work: WorkArgs,
}

const SWEEP_EXAMPLES: &str = "Examples:
  mechanim sweep gearshift --design grid:ZR1=240..300:31,L6s=80..140:31 --out rows.csv --plot map.svg
  mechanim sweep four-bar --design lhs:1000,crank=20..40,ex=0..90 --outputs K.x,K.y --samples 60 --out curves.jsonl
  mechanim sweep four-bar --design table.csv --check --out checked.csv --resume";

/// `mechanim study`
#[derive(Debug, Subcommand)]
pub enum StudyCommand {
    /// Make the folder of a study and cut the work into units.
    Plan {
        /// What is done.
        #[command(subcommand)]
        verb: PlannedVerb,
    },
    /// Work on missing units; any number of machines that see the folder may do so at once.
    #[command(after_help = RUN_EXAMPLES)]
    Run(RunArgs),
    /// Print which units are done, and how long the others will take.
    Status {
        /// The folder of the study.
        folder: PathBuf,
        /// Write the report as JSON to this file (`-` for standard output).
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
    },
    /// Merge the parts; the result is identical to that of a single run, byte for byte. For a tolerance study,
    /// --out writes the report (.json).
    Merge(MergeArgs),
    /// Write the script that runs the study on a cluster, and submit it.
    Submit(SubmitArgs),
}

const RUN_EXAMPLES: &str = "Examples:
  mechanim study run DIR                     # all missing units
  mechanim study run DIR --unit-range 0..8   # units 0 to 7
  mechanim study run DIR --worker 3/64 --threads 1 --until 2h";

/// Verbs that a study can do.
#[derive(Debug, Subcommand)]
pub enum PlannedVerb {
    /// A sweep; see `mechanim sweep --help`.
    Sweep(PlanSweepArgs),
    /// Random pieces; see `mechanim tolerance --help`.
    Tolerance(PlanToleranceArgs),
}

/// `mechanim study plan sweep`
#[derive(Debug, Args)]
pub struct PlanSweepArgs {
    /// What is swept.
    #[command(flatten)]
    pub asked: SweepRequestArgs,
    /// How it is cut.
    #[command(flatten)]
    pub cut: CutArgs,
}

/// `mechanim study plan tolerance`
#[derive(Debug, Args)]
pub struct PlanToleranceArgs {
    /// What scatters.
    #[command(flatten)]
    pub scatter: ScatterArgs,
    /// Number of random pieces, such as 1e8.
    #[arg(long, value_name = "N", default_value = "10000", value_parser = read_count)]
    pub pieces: u64,
    /// How it is cut.
    #[command(flatten)]
    pub cut: CutArgs,
}

/// How a study is cut into units, and where it lies.
#[derive(Debug, Args)]
pub struct CutArgs {
    /// Number of units, at most; units of about half a minute if absent.
    #[arg(long, value_name = "N", value_parser = read_count)]
    pub units: Option<u64>,
    /// Where to write: the folder of the study, which must not exist yet.
    #[arg(long, short, value_name = "DIR")]
    pub out: PathBuf,
}

/// `mechanim study run`
#[derive(Debug, Args)]
pub struct RunArgs {
    /// The folder of the study.
    pub folder: PathBuf,
    /// Work on these units only, counted from 0: FIRST..END.
    #[arg(long = "unit-range", value_name = "FIRST..END", value_parser = unit_range)]
    pub units: Option<[u64; 2]>,
    /// Worker I of N, counted from 1: each worker begins with a different unit and continues with whatever is missing.
    #[arg(long, value_name = "I/N", value_parser = worker_of, conflicts_with = "units")]
    pub worker: Option<[u64; 2]>,
    /// Begin no unit after this time: 90s, 30m, 2h.
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub until: Option<Duration>,
    /// How it works.
    #[command(flatten)]
    pub work: WorkArgs,
}

/// `mechanim study merge`
#[derive(Debug, Args)]
pub struct MergeArgs {
    /// The folder of the study.
    pub folder: PathBuf,
    /// Where rows go.
    #[command(flatten)]
    pub rows: RowsArgs,
    /// Only print the numbers of the missing units, in the form of `sbatch --array`.
    #[arg(long, conflicts_with_all = ["out", "plot"])]
    pub missing: bool,
}

/// `mechanim study submit`
#[derive(Debug, Args)]
pub struct SubmitArgs {
    /// The folder of the study, on a disk that all machines see.
    pub folder: PathBuf,
    /// The scheduler.
    #[arg(long, value_name = "ENGINE", value_enum)]
    pub to: Engine,
    /// Number of workers; each takes units until none is left.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = worker_total)]
    pub workers: usize,
    /// Cores of a worker.
    #[arg(long = "cores", value_name = "N", default_value_t = 1, value_parser = thread_count)]
    pub threads: usize,
    /// Container image with the program (kubernetes).
    #[arg(long, value_name = "IMAGE", default_value = "mechanim:latest")]
    pub image: String,
    /// Print the script, but do not submit it.
    #[arg(long)]
    pub dry_run: bool,
}

/// `--to`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Engine {
    /// An array of jobs (sbatch).
    Slurm,
    /// A driver in Python (ray).
    Ray,
    /// HyperQueue, also within an allocation of another scheduler.
    Hq,
    /// An indexed job (kubectl).
    Kubernetes,
}

fn unit_range(text: &str) -> Result<[u64; 2], String> {
    let wrong = || "write FIRST..END, such as 0..8 for units 0 to 7".to_owned();
    let (first, end) = text.split_once("..").ok_or_else(wrong)?;
    let range = [first, end].map(|number| number.trim().parse::<u64>());
    match range {
        [Ok(first), Ok(end)] if first < end => Ok([first, end]),
        _ => Err(wrong()),
    }
}

fn worker_of(text: &str) -> Result<[u64; 2], String> {
    let wrong = || "write I/N, such as 3/64: worker 3 of 64".to_owned();
    let (own, all) = text.split_once('/').ok_or_else(wrong)?;
    match [own, all].map(|number| number.trim().parse::<u64>()) {
        [Ok(own), Ok(all)] if 1 <= own && own <= all && all <= MOST_WORKERS => Ok([own, all]),
        _ => Err(wrong()),
    }
}

/// Most workers of one study: more than any cluster has cores.
const MOST_WORKERS: u64 = 1 << 24;

fn worker_total(text: &str) -> Result<usize, String> {
    whole_between(text, 1, 100_000)
}

fn parse_duration(text: &str) -> Result<Duration, String> {
    let wrong = || "write 90s, 30m or 2h".to_owned();
    let (number, seconds) = match text.char_indices().last() {
        Some((end, 's')) => (&text[..end], 1.0),
        Some((end, 'm')) => (&text[..end], 60.0),
        Some((end, 'h')) => (&text[..end], 3600.0),
        _ => return Err(wrong()),
    };
    let number = number.parse::<f64>().ok().filter(|n| *n > 0.0);
    let time = number.map(|n| Duration::try_from_secs_f64(n * seconds));
    time.and_then(Result::ok).ok_or_else(wrong)
}
