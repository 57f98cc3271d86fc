//! The argument table of the verbs that vary a scene's parameters.

use super::files::ProgressArg;
use super::scene::SceneArgs;
use crate::analysis::study::optimum::{Method, SearchMethod};
use crate::model::asked_ranges::{ACCURACY, POSITIVE, TOLERANCE, WITHIN, range_words};
use crate::report::requirement::Requirement;
use clap::{Args, ValueEnum};
use std::ffi::OsString;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Which parameters change.
#[derive(Clone, Debug, Args)]
pub struct VaryArgs {
    /// Parameters to vary, separated by commas, or `all` for every length and angle given as a number.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub vary: Vec<String>,
}

/// `mechanim sensitivity`
#[derive(Debug, Args)]
pub struct SensitivityArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// What is varied; every length and angle if absent.
    #[command(flatten)]
    pub vary: VaryArgs,
    /// Rank by this measure; the study's objective if absent.
    #[arg(long, value_name = "MEASURE")]
    pub rank: Option<String>,
    /// Find tolerances that keep the scatter (root sum square) of a measure to VALUE, every dimension contributing
    /// equally: MEASURE=VALUE.
    #[arg(long, value_name = "MEASURE=VALUE", value_parser = named_limit)]
    pub scatter: Option<(String, f64)>,
    /// Draw a chart (.svg or .png): the derivatives as bars, ranked.
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Where to write: the whole table as .csv or .json; `-` for JSON on standard output.
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// What scatters, and how: everything that the numbers of a piece depend on.
#[derive(Debug, Args)]
pub struct ScatterArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// What scatters; every length and angle if absent.
    #[command(flatten)]
    pub vary: VaryArgs,
    /// Tolerance of every dimension that has none of its own: plus or minus this, in the dimension's unit.
    #[arg(long, value_name = "VALUE", value_parser = half_width)]
    pub tolerance: Option<f64>,
    /// Distribution of a dimension within its tolerance.
    #[arg(long, value_enum, default_value_t = DistributionArg::Uniform)]
    pub distribution: DistributionArg,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// `mechanim tolerance`
#[derive(Debug, Args)]
pub struct ToleranceArgs {
    /// What scatters.
    #[command(flatten)]
    pub scatter: ScatterArgs,
    /// Number of random pieces.
    #[arg(long = "pieces", value_name = "N", default_value_t = 10_000, value_parser = piece_count)]
    pub samples: usize,
    /// Leave out this many pieces at the beginning, so that several machines can share the work.
    #[arg(long = "skip", alias = "first", value_name = "N", default_value_t = 0)]
    pub first: usize,
    /// Worker threads; all cores if absent. The numbers do not depend on it.
    #[arg(long, value_name = "N", value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Write the report as JSON to this file (`-` for standard output).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write a table as CSV: the measures of every piece.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Draw the mechanism with the paths of random pieces around those of its traced points.
    #[arg(long, value_name = "FILE.png")]
    pub picture: Option<PathBuf>,
    /// Draw a chart (.svg or .png): quantile bands of the deviation across each path, along the path.
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Maximum number of pieces whose paths are drawn.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = path_count)]
    pub paths: usize,
    /// Magnification of the deviations in the picture; if absent, a round number that makes them visible.
    #[arg(long, value_name = "FACTOR", value_parser = parse_enlargement, requires = "picture")]
    pub enlarge: Option<f64>,
    /// Time in seconds of the pose in the picture.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 0.0,
        requires = "picture"
    )]
    pub at: f64,
    /// Progress on standard error: a bar on a terminal (auto), plain lines, or none.
    #[arg(long, value_enum, default_value_t = ProgressArg::Auto)]
    pub progress: ProgressArg,
}

/// `mechanim optimise`
#[derive(Debug, Args)]
pub struct OptimiseArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// What is varied; the study's variables if absent.
    #[command(flatten)]
    pub vary: VaryArgs,
    /// Minimise this measure, in place of the study's objective.
    #[arg(long, value_name = "MEASURE")]
    pub minimise: Option<String>,
    /// Method of the search for the minimum.
    #[arg(long, value_enum, default_value_t = MethodArg::Bfgs)]
    pub method: MethodArg,
    /// Let every variable move by this share of its value (0.2 or 20%), instead of within the study's ranges. One whose value is zero keeps its
    /// range.
    #[arg(long, value_name = "SHARE", value_parser = proper_share)]
    pub within: Option<f64>,
    /// Relative tolerance at which the search stops: of the gradient (bfgs), of the variables relative to their values and of the
    /// objective relative to its largest difference within a simplex (nelder-mead), of the predicted decrease (minimax), of the spread
    /// of the generation (evolution).
    #[arg(long = "convergence", value_name = "VALUE", value_parser = relative_share)]
    pub tolerance: Option<f64>,
    /// Maximum number of iterations; of a study with limits, in each of its rounds.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = iteration_count)]
    pub iterations: usize,
    /// Seed of the random numbers (evolution).
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Optimise every pair of all dimensions, or of those named, on its own and rank the pairs.
    #[arg(long)]
    pub pairs: bool,
    /// Number of rows to print: the ranking of the pairs, the best first.
    #[arg(
        long,
        alias = "worst",
        value_name = "N",
        default_value_t = 20,
        requires = "pairs"
    )]
    pub rows: usize,
    /// Worker threads; all cores if absent. Pairs are shared among them (--pairs); the numbers do not depend on it.
    #[arg(long, value_name = "N", value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Write a film of the improvements, one frame each: .gif, .apng, a folder, or a pattern of frames.
    #[arg(long, value_name = "FILE", conflicts_with = "pairs")]
    pub film: Option<PathBuf>,
    /// Draw a chart (.svg, .pdf or .png): the paths of the scene's plots with equal axes, those of the start dashed.
    #[arg(long, value_name = "FILE", conflicts_with = "pairs")]
    pub plot: Option<PathBuf>,
    /// Draw contours of the objective over the two variables, with the points that the search visited (.svg, .pdf or .png).
    #[arg(long, value_name = "FILE", conflicts_with = "pairs")]
    pub map: Option<PathBuf>,
    /// Write the points that the search visited as CSV: iteration, objective, variables (`-` for standard output).
    #[arg(long, value_name = "FILE", conflicts_with = "pairs")]
    pub history: Option<PathBuf>,
    /// Progress on standard error. auto: the best value, in one line on a terminal; plain: a line every 50 iterations;
    /// none.
    #[arg(long, value_enum, default_value_t = ProgressArg::Auto)]
    pub progress: ProgressArg,
    /// Where to write: the scene with the best values, which solves and renders.
    #[arg(long, short, value_name = "FILE.toml", conflicts_with = "pairs")]
    pub out: Option<PathBuf>,
    /// Write the report as JSON to this file (`-` for standard output).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

impl OptimiseArgs {
    /// The method asked for.
    pub fn search_method(&self) -> Method {
        let method = match self.method {
            MethodArg::NelderMead => SearchMethod::NelderMead,
            MethodArg::Bfgs => SearchMethod::Bfgs,
            MethodArg::Minimax => SearchMethod::Minimax,
            MethodArg::Evolution => SearchMethod::Evolution,
        };
        method.with_tolerance(self.tolerance, self.seed)
    }
}

/// Where searches start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum StartsFrom {
    /// The scene's own values and random ones.
    Everywhere,
    /// The scene's own values only.
    Scene,
    /// Random values only.
    Random,
}

/// `mechanim synthesise`
#[derive(Debug, Args)]
pub struct SynthesiseArgs {
    /// Built-in scenes or scene files with a study whose variables have ranges; several make one report.
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<OsString>,
    /// A table (CSV) of the path or motion to reach, in place of the study's objective: columns are coordinates of traced points
    /// (P.x), outputs or unknowns; a column for every input, or `time`, prescribes when each row is met, otherwise this is found;
    /// `weight` is the weight of a row.
    #[arg(long, value_name = "TABLE.csv", conflicts_with = "csv")]
    pub target: Option<PathBuf>,
    /// What is varied with --target; the study's variables if absent.
    #[command(flatten)]
    pub vary: VaryArgs,
    /// Let every variable move by this share of its value (0.2 or 20%), instead of within the study's ranges. One whose value is zero keeps its
    /// range.
    #[arg(long, value_name = "SHARE", value_parser = proper_share, requires = "target")]
    pub within: Option<f64>,
    /// Replace a parameter of every scene: NAME=FORMULA. May be repeated.
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = super::values::name_and_text)]
    pub parameters: Vec<(String, String)>,
    /// Minimise this measure, in place of the study's objective.
    #[arg(long, value_name = "MEASURE")]
    pub minimise: Option<String>,
    /// Number of starts: the scene's own values, then alternately near minima already found and random within the whole
    /// ranges.
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = search_starts)]
    pub starts: usize,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Maximum number of iterations from one start; the best are polished with forty times as many.
    #[arg(long, value_name = "N", default_value_t = 25, value_parser = iteration_count)]
    pub iterations: usize,
    /// Stop the search of each scene after this many seconds and keep the best so far.
    #[arg(long, value_name = "SECONDS", value_parser = positive_number)]
    pub time: Option<f64>,
    /// Where searches start, apart from near the minima found: everywhere, from the scene's own values only, or from random
    /// values only.
    #[arg(long = "start-from", value_name = "WHERE", value_enum, default_value_t = StartsFrom::Everywhere)]
    pub from: StartsFrom,
    /// Name the simplest mechanism found that meets this: MEASURE<=NUMBER or MEASURE>=NUMBER, in the file's units. May be
    /// repeated.
    #[arg(long = "require", value_name = "MEASURE<=NUMBER", value_parser = Requirement::read)]
    pub demands: Vec<Requirement>,
    /// Worker threads; all cores if absent. Without --time the numbers do not depend on it.
    #[arg(long, value_name = "N", value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Where to write: the scene with the best values, or a folder for it (a path that ends with `/`); of several scenes always
    /// a folder.
    #[arg(long, short, value_name = "FILE.toml|FOLDER")]
    pub out: Option<PathBuf>,
    /// Write the report as JSON to this file (`-` for standard output).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write a table as CSV: a row for every scene and measure or variable.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// Methods of `mechanim optimise`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MethodArg {
    /// Simplex search of Nelder and Mead: values only.
    NelderMead,
    /// Quasi-Newton method with exact gradients.
    Bfgs,
    /// Linear programmes over all poses: for an objective that is the largest of many values.
    Minimax,
    /// Differential evolution over the whole ranges, then bfgs from its best.
    Evolution,
}

/// Distributions of `mechanim tolerance`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DistributionArg {
    /// All values within the tolerance are equally likely.
    Uniform,
    /// A normal distribution; the tolerance is three standard deviations.
    Normal,
}

/// Most random pieces of one run: their measures are kept for the quantiles.
const MAX_PIECES: usize = 20_000_000;

fn piece_count(text: &str) -> Result<usize, String> {
    whole_between(text, 1, MAX_PIECES)
}

fn path_count(text: &str) -> Result<usize, String> {
    whole_between(text, 1, 20_000)
}

fn search_starts(text: &str) -> Result<usize, String> {
    whole_between(text, 1, 100_000)
}

fn iteration_count(text: &str) -> Result<usize, String> {
    whole_between(text, 1, 1_000_000)
}

pub(super) fn thread_count(text: &str) -> Result<usize, String> {
    whole_between(text, 1, 256)
}

pub(super) fn whole_between(text: &str, low: usize, high: usize) -> Result<usize, String> {
    // Also such as 1e4.
    let written = text
        .parse::<f64>()
        .ok()
        .filter(|v| *v >= 0.0 && v.fract() == 0.0);
    let number = text.parse().ok().or(written.map(|v| v as usize));
    number
        .filter(|n| (low..=high).contains(n))
        .ok_or_else(|| format!("a whole number from {low} to {high}"))
}

pub(super) fn positive_number(text: &str) -> Result<f64, String> {
    number_in(text, &POSITIVE)
}

/// Largest enlargement of a deviation: a picture resolves a ten-thousandth, rounding a 1e16th.
const MOST_ENLARGED: f64 = 1e12;

pub(super) fn number_in(text: &str, range: &RangeInclusive<f64>) -> Result<f64, String> {
    let value = text.parse::<f64>();
    let value = value.map_err(|_| format!("it must be a number, {}", range_words(range)))?;
    match range.contains(&value) {
        true => Ok(value),
        false => Err(format!("it must be {}", range_words(range))),
    }
}

fn parse_enlargement(text: &str) -> Result<f64, String> {
    number_in(text, &(f64::MIN_POSITIVE..=MOST_ENLARGED))
}

fn half_width(text: &str) -> Result<f64, String> {
    number_in(text, &TOLERANCE)
}

fn relative_share(text: &str) -> Result<f64, String> {
    number_in(text, &ACCURACY)
}

fn proper_share(text: &str) -> Result<f64, String> {
    let value = match text.strip_suffix('%') {
        Some(percent) => positive_number(percent.trim()).map(|v| v / 100.0),
        None => positive_number(text),
    };
    let value = value.ok().filter(|v| WITHIN.contains(v));
    value.ok_or_else(|| format!("a share, 0.2 or 20%, {}", range_words(&WITHIN)))
}

pub(super) fn named_limit(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write MEASURE=VALUE")?;
    Ok((name.trim().to_owned(), positive_number(value.trim())?))
}
