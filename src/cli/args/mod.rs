//! The argument table: names, help texts, ranges that need no scene. Nothing is done here.

pub mod charts;
pub mod files;
pub mod study;
pub mod view;

use charts::{AccuracyArgs, PlotArgs};
use clap::{Args, Parser, Subcommand, ValueEnum};
use files::{DiffArgs, EncodeArgs, FileArgs, SnapshotArgs};
use std::path::PathBuf;
use study::{OptimiseArgs, SensitivityArgs, SynthesiseArgs, ToleranceArgs};
use view::ViewArgs;

/// Exact motion, checks and pictures of spatial mechanisms, from their equations, without a display.
#[derive(Debug, Parser)]
#[command(name = "mechanim", version, max_term_width = 100, after_help = EXIT_CODES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// When to colour messages; NO_COLOR is respected.
    #[arg(long, global = true, value_enum, default_value_t = ColourChoice::Auto)]
    pub color: ColourChoice,
    /// Say nothing but errors.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 a check failed; 2 bad usage or bad scene; 3 no usable graphics \
adapter; 4 the mechanism could not be closed over the whole motion; 70 internal error; 130 interrupted.";

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw the motion into an animation, a still, a sequence of frames or raw video; or write it as a 3-D model.
    Render(RenderArgs),
    /// Solve the motion and write every coordinate with its proof (CSV or JSON).
    Solve(SolveArgs),
    /// Check that all loops close over the motion, or judge a pose that is offered.
    Check(CheckArgs),
    /// Search the assemblies that close at a pose of the inputs, from many starts, and list them.
    Modes(ModesArgs),
    /// Plot outputs, coordinates and their derivatives against input or time (SVG or PNG).
    Plot(PlotArgs),
    /// Measure time per pose against true error for many ways along the motion (table, JSON, CSV, chart).
    Accuracy(AccuracyArgs),
    /// Assemble PNG frames made elsewhere into an animation.
    Encode(EncodeArgs),
    /// Compare two pictures, two animations or two folders of pictures.
    Diff(DiffArgs),
    /// Draw a list of pictures and compare them with the golden ones beside it.
    Snapshot(SnapshotArgs),
    /// Derivatives of the study's measures by every dimension, ranked.
    Sensitivity(SensitivityArgs),
    /// What tolerances of the dimensions do to the study's measures: linear rules and random pieces.
    Tolerance(ToleranceArgs),
    /// Change dimensions so that the study's objective becomes least.
    Optimise(OptimiseArgs),
    /// Find dimensions from many starts, prove the best, and compare scenes of one task.
    Synthesise(SynthesiseArgs),
    /// List the built-in scenes, or print one.
    Scenes {
        /// Name of the scene whose file is printed.
        name: Option<String>,
    },
    /// Versions, graphics adapters and drivers, for bug reports.
    Info {
        /// Machine-readable.
        #[arg(long)]
        json: bool,
    },
    /// Print a completion script for a shell.
    Completions {
        /// bash, zsh, fish, elvish or powershell.
        shell: clap_complete::Shell,
    },
}

/// Which scene, and what is changed in it.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Name of a built-in scene, path of a scene file, or `-` for standard input.
    pub scene: String,
    /// Replace a parameter: NAME=FORMULA. May be repeated.
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = assignment)]
    pub parameters: Vec<(String, String)>,
    /// Replace the drive of an input: NAME=FORMULA, a number or a formula of `t`. May be repeated.
    #[arg(long = "input", value_name = "NAME=VALUE", value_parser = assignment)]
    pub inputs: Vec<(String, String)>,
    /// Replace the start value of an unknown, which chooses the assembly mode: NAME=VALUE. May be repeated.
    #[arg(long = "guess", value_name = "NAME=VALUE", value_parser = assignment)]
    pub guess: Vec<(String, String)>,
    /// Take the inputs from the rows of a CSV file; columns are found by the names of the inputs.
    #[arg(long = "inputs", value_name = "TABLE.csv")]
    pub table: Option<PathBuf>,
    /// Start from assembly number K of `mechanim modes` at the start of the drive, or from the one with that branch
    /// signature (such as `+-`), in place of the start values.
    #[arg(long, value_name = "K", conflicts_with = "guess", value_parser = mode_choice, allow_hyphen_values = true)]
    pub mode: Option<ModeChoice>,
}

/// `mechanim render`
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// What is written.
    #[command(flatten)]
    pub file: FileArgs,
    /// Picture size in pixels.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "640x480", value_parser = size)]
    pub size: [u32; 2],
    /// Frames a second; the scene decides if absent.
    #[arg(long, value_name = "RATE", allow_negative_numbers = true, value_parser = frame_rate)]
    pub fps: Option<f64>,
    /// Number of frames, spread evenly over the motion.
    #[arg(long, value_name = "N", conflicts_with = "fps", value_parser = frame_count)]
    pub frames: Option<usize>,
    /// Draw one picture at this time in seconds.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub at: Option<f64>,
    /// Draw one picture: the frame with this number, counted from 0.
    #[arg(long, value_name = "N", conflicts_with = "at")]
    pub frame: Option<usize>,
    /// Samples per pixel: 1, 2, 4, 8 or 16 (a graphics adapter takes the nearest it knows).
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = samples)]
    pub samples: u32,
    /// Who draws: a hardware adapter if there is one, else the built-in renderer (auto); gpu also takes software adapters.
    #[arg(long, value_enum, default_value_t = RendererArg::Auto)]
    pub renderer: RendererArg,
    /// Graphics adapter: `software`, or a part of its name (also from MECHANIM_ADAPTER).
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Point something out: bodies that come nearer to each other than the scene's `[clearance]` allows turn red.
    #[arg(long, value_enum, value_name = "WHAT")]
    pub show: Option<ShowArg>,
    /// Print where the time went, stage by stage.
    #[arg(long)]
    pub timings: bool,
    /// Show a plot with a moving marker beside or below the motion: the scene's first, or the one with this title.
    #[arg(long, value_name = "TITLE", num_args = 0..=1, require_equals = true, default_missing_value = "")]
    pub panel: Option<String>,
    /// Show Newton's iterates from the start values instead of the motion: a still with all of them as ghosts, or one
    /// a frame.
    #[arg(long, conflicts_with_all = ["at", "frame", "frames", "panel", "show"])]
    pub trace_iterations: bool,
    /// How it is looked at.
    #[command(flatten)]
    pub view: ViewArgs,
}

/// `mechanim solve`
#[derive(Debug, Args)]
pub struct SolveArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Table to write: .csv or .json; `-` for CSV on standard output.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Number of samples, spread evenly over the motion; the scene's frames if absent.
    #[arg(long, value_name = "N", value_parser = frame_count)]
    pub samples: Option<usize>,
    /// Solve at this time in seconds only (following the motion up to it).
    #[arg(long, value_name = "SECONDS", conflicts_with = "samples")]
    pub at: Option<f64>,
    /// Write Newton's iterates from the start values at the start of the drive instead of the motion: unknowns,
    /// corrections and gaps of every loop; in JSON the opened polygons, too.
    #[arg(long, conflicts_with_all = ["samples", "at", "rates", "order"])]
    pub trace_iterations: bool,
    /// Add columns with the rates of the unknowns per second.
    #[arg(long)]
    pub rates: bool,
    /// Add columns with the rates up to order N (1 to 8) of unknowns, traced points and outputs. At a
    /// keyframe they are those of the piece that begins there.
    #[arg(long, value_name = "N", conflicts_with = "rates", value_parser = order)]
    pub order: Option<usize>,
    /// Take these rates by an input, the others standing still, in place of time: transfer functions.
    #[arg(long, value_name = "INPUT", requires = "order")]
    pub per: Option<String>,
    /// Locate the limit positions too: where an unknown or output turns back while the drive goes on. Printed, and
    /// written to JSON.
    #[arg(long)]
    pub events: bool,
    /// What is proved: nothing, every pose, or also the motion between the samples.
    #[arg(long, value_enum, default_value_t = CertifyArg::Pose)]
    pub certify: CertifyArg,
    /// Format of the table if the file name does not tell.
    #[arg(long, value_enum)]
    pub format: Option<TableFormat>,
}

/// `mechanim check`
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Judge this pose instead of solving: values of the unknowns, NAME=VALUE,NAME=VALUE,…
    #[arg(long, value_name = "NAME=VALUE,…", value_delimiter = ',', value_parser = assignment)]
    pub pose: Vec<(String, String)>,
    /// Largest closure error that passes, relative to the mechanism's size.
    #[arg(long, value_name = "E", default_value_t = 1e-9)]
    pub closure: f64,
    /// Number of samples, spread evenly over the motion; the scene's frames if absent. Both ends of the drive and all keys
    /// are sampled in any case.
    #[arg(long, value_name = "N", value_parser = frame_count)]
    pub samples: Option<usize>,
    /// What is proved: nothing, every pose, or also the motion between the samples, which then is part of the check.
    /// Clearances rest on proved poses whatever is asked for.
    #[arg(long, value_enum, default_value_t = CertifyArg::Pose)]
    pub certify: CertifyArg,
    /// Write the report as JSON to this file (`-` for standard output).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the clearances as JUnit XML, one case a pair of bodies.
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write the distance of every judged pair over time as CSV.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Plot the distances of the worst pairs over time, with their minimum and the worst moment, to this file
    /// (.svg or .png).
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Draw the moment at which the worst pair is nearest, with the distance marked, to this PNG file.
    #[arg(long, value_name = "FILE.png")]
    pub render: Option<PathBuf>,
    /// How many pairs the table shows, the worst first.
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub worst: usize,
    /// How near the proved bound must come to the least distance found, as a part of the pair's minimum (of that
    /// distance where the minimum is 0).
    #[arg(long, value_name = "E", default_value_t = 1e-3, value_parser = share)]
    pub tolerance: f64,
}

/// `mechanim modes`
#[derive(Debug, Args)]
pub struct ModesArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Time in seconds at which the inputs are taken from the drive.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    pub at: f64,
    /// Random starts; more of them find more, up to the assemblies there are.
    #[arg(long, value_name = "N", default_value_t = crate::kinematics::solve::assembly_modes::DEFAULT_STARTS, value_parser = starts)]
    pub starts: usize,
    /// Write the list as JSON to this file (`-` for standard output).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// `--certify`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum CertifyArg {
    None,
    Pose,
    Motion,
}

/// `--renderer`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum RendererArg {
    Auto,
    Gpu,
    Cpu,
}

/// `--show`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum ShowArg {
    Clearance,
}

/// `--color`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum ColourChoice {
    Auto,
    Always,
    Never,
}

/// `--format`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum TableFormat {
    Csv,
    Json,
}

/// Longest side of a picture: 16384 squared at 16 samples is already 20 GiB of samples in a naive renderer.
pub const MAX_SIDE: u32 = 16_384;

/// Most pixels of a picture: 8K video has 33 million.
pub const MAX_PIXELS: u64 = 64_000_000;

pub(crate) fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write NAME=VALUE".to_owned()),
    }
}

pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || "write WIDTHxHEIGHT, for example 640x480".to_owned();
    let (width, height) = text.split_once(['x', '×']).ok_or_else(wrong)?;
    let size = [
        width.trim().parse::<u32>().map_err(|_| wrong())?,
        height.trim().parse().map_err(|_| wrong())?,
    ];
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    if size.contains(&0) {
        return Err("a picture needs at least one pixel".to_owned());
    }
    if size.iter().any(|side| *side > MAX_SIDE) || pixels > MAX_PIXELS {
        return Err(format!(
            "at most {MAX_SIDE} pixels a side and {} million in all",
            MAX_PIXELS / 1_000_000
        ));
    }
    Ok(size)
}

pub(crate) fn frame_rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if (0.01..=1000.0).contains(&rate) => Ok(rate),
        _ => Err("a frame rate is between 0.01 and 1000".to_owned()),
    }
}

pub(crate) fn frame_count(text: &str) -> Result<usize, String> {
    let limit = crate::kinematics::motion::sampling::MAX_SAMPLES;
    match text.parse::<usize>() {
        Ok(count) if (1..=limit).contains(&count) => Ok(count),
        _ => Err(format!("between 1 and {limit}")),
    }
}

fn samples(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(count) if [1, 2, 4, 8, 16].contains(&count) => Ok(count),
        _ => Err("1, 2, 4, 8 or 16".to_owned()),
    }
}

pub(crate) fn quality(text: &str) -> Result<u8, String> {
    match text.parse() {
        Ok(quality) if (1..=100).contains(&quality) => Ok(quality),
        _ => Err("between 1 and 100".to_owned()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (1e-9..=1.0).contains(&share) => Ok(share),
        _ => Err("between 1e-9 and 1".to_owned()),
    }
}

pub(crate) fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if (1..=256).contains(&count) => Ok(count),
        _ => Err("between 1 and 256".to_owned()),
    }
}

fn starts(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if count <= 1_000_000 => Ok(count),
        _ => Err("between 0 and 1000000".to_owned()),
    }
}

/// An assembly mode by its place in the table, or by its branch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ModeChoice {
    /// Counted from 1.
    Number(usize),
    /// A sign per block.
    Signature(String),
}

fn mode_choice(text: &str) -> Result<ModeChoice, String> {
    if !text.is_empty() && text.chars().all(|c| c == '+' || c == '-') {
        return Ok(ModeChoice::Signature(text.to_owned()));
    }
    match text.parse::<usize>() {
        Ok(number) if number > 0 => Ok(ModeChoice::Number(number)),
        _ => Err("a number of the table, counted from 1, or a signature such as `+-`".to_owned()),
    }
}

pub(crate) fn order(text: &str) -> Result<usize, String> {
    let limit = crate::model::plot::MAX_ORDER;
    match text.parse::<usize>() {
        Ok(order) if (1..=limit).contains(&order) => Ok(order),
        _ => Err(format!("between 1 and {limit}")),
    }
}
