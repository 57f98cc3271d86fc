//! The arguments of the verbs that solve a motion or a pose: `render`, `solve`, `check` and `modes`.

use super::files::FileArgs;
use super::scene::SceneArgs;
use super::study::{number_in, positive_number};
use super::values::{frame_count, frame_rate, name_and_text, poster_size, rate_order};
use super::view::ViewArgs;
use crate::clearance::check::ClearanceEffort;
use crate::model::asked_ranges::AGREEMENT;
use crate::report::verdict::CheckRequirements;
use crate::staging::model::Facets;
use clap::{Args, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;

/// `mechanim render`
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// What is written.
    #[command(flatten)]
    pub file: FileArgs,
    /// Size in pixels: 64 million at most, and 240 million for a PNG of one picture.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "640x480", value_parser = poster_size)]
    pub size: [u32; 2],
    /// Frames a second; the scene decides if absent.
    #[arg(long, value_name = "RATE", allow_negative_numbers = true, value_parser = frame_rate)]
    pub fps: Option<f64>,
    /// Number of frames, spread evenly over the motion.
    #[arg(long, value_name = "N", conflicts_with = "fps", value_parser = frame_count)]
    pub frames: Option<usize>,
    /// Time in seconds: draw one picture, of this instant.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub at: Option<f64>,
    /// Draw one picture: the frame with this number, counted from 0.
    #[arg(long, value_name = "N", conflicts_with = "at")]
    pub frame: Option<usize>,
    /// Samples per pixel: 1, 2, 4, 8 or 16 (a graphics adapter takes the nearest that it supports).
    #[arg(long = "supersample", value_name = "N", default_value_t = 4, value_parser = sample_count)]
    pub samples: u32,
    /// Renderer: a hardware adapter if there is one, else the built-in renderer (auto); gpu also accepts software
    /// adapters.
    #[arg(long, value_enum, default_value_t = RendererArg::Auto)]
    pub renderer: RendererArg,
    /// Graphics adapter: `software`, or a part of its name (also from MECHANIM_ADAPTER).
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// For 3-D models: the largest distance between a round surface and its facets, in the scene's unit; or `picture`:
    /// as fine as a screen can show, for much smaller files (a GLB then needs a reader of KHR_mesh_quantization).
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = parse_facets)]
    pub resolution: Option<Facets>,
    /// Colour red, in every frame, the bodies that come closer to each other than the scene's `[clearance]` allows.
    #[arg(long, value_enum, value_name = "WHAT")]
    pub highlight: Option<HighlightArg>,
    /// Print the time that each stage took.
    #[arg(long)]
    pub timings: bool,
    /// Show a plot with a moving marker beside or below the motion: the scene's first, or the one with this title.
    #[arg(long, value_name = "TITLE", num_args = 0..=1, require_equals = true, default_missing_value = "")]
    pub panel: Option<String>,
    /// Show Newton's iterates from the start values instead of the motion: one still with all of them as ghosts, or an
    /// animation with one in each frame.
    #[arg(long, conflicts_with_all = ["at", "frame", "frames", "panel", "highlight"])]
    pub trace_iterations: bool,
    /// Run again whenever a scene, a mesh that it names or its table of inputs changes, until Ctrl-C.
    #[arg(long)]
    pub watch: bool,
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
    /// Where to write: the table as .csv or .json; `-` for CSV on standard output.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Number of samples, spread evenly over the motion; the scene's frames if absent.
    #[arg(long, value_name = "N", value_parser = frame_count)]
    pub samples: Option<usize>,
    /// Time in seconds of the one pose to solve; the motion is followed up to it.
    #[arg(long, value_name = "SECONDS", conflicts_with = "samples")]
    pub at: Option<f64>,
    /// Show Newton's iterates from the start values at the start of the drive, instead of the motion: unknowns,
    /// corrections and the closure error of every loop; in JSON also the open polygons.
    #[arg(long, conflicts_with_all = ["samples", "at", "rates", "order"])]
    pub trace_iterations: bool,
    /// Add columns with the rates of the unknowns per second.
    #[arg(long)]
    pub rates: bool,
    /// Rates up to this order (1 to 8) of unknowns, traced points and outputs, as further columns. At a keyframe they
    /// are those of the piece that begins there. Outputs that contain derivatives have none, distances only the first:
    /// their columns stay empty.
    #[arg(long, value_name = "N", conflicts_with = "rates", value_parser = rate_order)]
    pub order: Option<usize>,
    /// Rates with respect to this input instead of time, the others constant: transfer functions.
    #[arg(long, value_name = "INPUT", requires = "order")]
    pub per: Option<String>,
    /// Add columns bound(NAME) with proved error bounds of traced points and outputs, rounding of the print included.
    #[arg(long, conflicts_with = "trace_iterations")]
    pub bounds: bool,
    /// Also locate limit positions, where an unknown or output reverses while the drive continues; printed, and written
    /// to JSON.
    #[arg(long)]
    pub events: bool,
    /// What is proved: nothing, every pose, or also the motion between the samples.
    #[arg(long, value_enum, default_value_t = CertifyArg::Pose)]
    pub certify: CertifyArg,
    /// Format, if the file name does not determine it.
    #[arg(long, value_enum)]
    pub format: Option<TableFormat>,
}

/// What is asked of a motion by the verbs that judge one.
#[derive(Clone, Debug, Args)]
pub struct RequirementArgs {
    /// Largest closure error that passes, relative to the mechanism's size.
    #[arg(long = "max-closure", alias = "closure", value_name = "E", default_value_t = CheckRequirements::CLOSURE, value_parser = positive_number)]
    pub closure: f64,
    /// Number of samples, spread evenly over the motion; the scene's frames if absent. Both ends of the drive and all keys
    /// are sampled in any case.
    #[arg(long, value_name = "N", value_parser = frame_count)]
    pub samples: Option<usize>,
    /// What is proved: nothing, every pose and the bounds of clearances, or also the motion between the samples. The
    /// check fails if a requested proof fails.
    #[arg(long, value_enum, default_value_t = CertifyArg::Pose)]
    pub certify: CertifyArg,
    /// A pair counts as near if it is less than this length above its minimum; if absent, below twice its minimum.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub band: Option<f64>,
    /// Let pairs of bodies and measures pass whose bound is only estimated.
    #[arg(long)]
    pub allow_estimates: bool,
    /// Let a check pass that judges no pair of bodies though the scene asks for clearances.
    #[arg(long)]
    pub allow_empty: bool,
    /// Number of rows to print: pairs of bodies, the worst first. With more than 200 pairs, distant ones are
    /// judged together; at least this many are judged one by one.
    #[arg(long = "rows", alias = "worst", value_name = "N", default_value_t = 10)]
    pub worst: usize,
    /// How close the proved bound must come to the least distance found, as a fraction of the pair's minimum (of that
    /// distance where the minimum is 0).
    #[arg(long = "bound-tolerance", value_name = "E", default_value_t = ClearanceEffort::TOLERANCE, value_parser = proper_share)]
    pub tolerance: f64,
}

/// `mechanim check`
#[derive(Clone, Debug, Args)]
pub struct CheckArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// More scenes, checked in the same run; a name may be a pattern, such as designs/*.toml. The exit code is the worst.
    #[arg(value_name = "SCENE")]
    pub more: Vec<OsString>,
    /// Number of scenes checked at the same time; all cores if absent.
    #[arg(long, value_name = "N", value_parser = super::values::worker_count)]
    pub jobs: Option<usize>,
    /// Run again whenever a scene, a mesh that it names or its table of inputs changes, until Ctrl-C.
    #[arg(long)]
    pub watch: bool,
    /// What is asked.
    #[command(flatten)]
    pub asked: RequirementArgs,
    /// Judge this pose instead of solving: values of the unknowns, NAME=VALUE,NAME=VALUE,…
    #[arg(long, value_name = "NAME=VALUE,…", value_delimiter = ',', value_parser = name_and_text, conflicts_with_all = ["allow_estimates", "allow_empty"])]
    pub pose: Vec<(String, String)>,
    /// Check the clearances over a range of this input instead of the motion; given twice, over a box of two inputs.
    /// They are proved for all values, or the report names the parts of the box that are not covered.
    #[arg(long, value_name = "INPUT=LOW:HIGH", value_parser = input_range, num_args = 1, conflicts_with_all = ["pose", "samples", "csv", "plot", "render", "matrix", "swept"])]
    pub inputs_box: Vec<(String, [f64; 2])>,
    /// Also prove the clearances of every piece whose dimensions differ from the file's by at most this, in their units.
    /// --param NAME=880+-0.2 sets the tolerance of a single dimension and can be used alone.
    #[arg(long, value_name = "VALUE", value_parser = positive_number, conflicts_with_all = ["pose", "inputs_box"])]
    pub made_within: Option<f64>,
    /// What has a tolerance with --made-within: parameters and inputs.
    #[command(flatten)]
    pub vary: super::study::VaryArgs,
    /// Write the report as JSON to this file (`-` for standard output).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the verdict as JUnit XML, one test case for each question: closure, proofs, measures, pairs of bodies.
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write what failed or was not proved as SARIF 2.1.0, which code-hosting services show beside a change.
    #[arg(long, value_name = "FILE")]
    pub sarif: Option<PathBuf>,
    /// Write a summary as Markdown, for the page of a CI job.
    #[arg(long, value_name = "FILE.md")]
    pub summary: Option<PathBuf>,
    /// Write a table as CSV: the distance of every judged pair over time.
    #[arg(long, value_name = "FILE", conflicts_with = "pose")]
    pub csv: Option<PathBuf>,
    /// Draw a chart (.svg or .png): the distances of the worst pairs over time, with their minimum, the bound and the
    /// worst moment.
    #[arg(long, value_name = "FILE", conflicts_with = "pose")]
    pub plot: Option<PathBuf>,
    /// Draw the worst pair at its closest approach, with distance, time and verdict, into this PNG file: red and
    /// blue if it does not pass, green and blue if it does.
    #[arg(long, value_name = "FILE.png", conflicts_with = "pose")]
    pub render: Option<PathBuf>,
    /// Draw the least distances of all pairs of bodies as a matrix into this file (.svg or .png), coloured by class:
    /// below the minimum, not proved, near, clear, excluded.
    #[arg(long, value_name = "FILE", conflicts_with = "pose")]
    pub matrix: Option<PathBuf>,
    /// Write a closed mesh around the volume that the body --body sweeps over the motion (.stl, .obj or .glb), and print the
    /// largest gap between the two.
    #[arg(long, value_name = "FILE", conflicts_with = "pose", requires = "body")]
    pub swept: Option<PathBuf>,
    /// The body of --swept.
    #[arg(long, value_name = "NAME", requires = "swept")]
    pub body: Option<String>,
    /// Frame of the --swept mesh: this body instead of the world.
    #[arg(long, value_name = "NAME", requires = "swept")]
    pub relative_to: Option<String>,
    /// Cells along the longest side of the --swept mesh: more cells, a closer fit.
    #[arg(long, value_name = "N", default_value_t = 96, value_parser = clap::value_parser!(u32).range(4..=1024), requires = "swept")]
    pub cells: u32,
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
    /// Number of starts, at most. The search ends earlier when few assemblies are estimated to be missing.
    #[arg(long, value_name = "N", default_value_t = crate::kinematics::assemblies::DEFAULT_STARTS, value_parser = start_count)]
    pub starts: usize,
    /// Write the report as JSON to this file (`-` for standard output).
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

/// `--highlight`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum HighlightArg {
    Clearance,
}

/// `--format`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum TableFormat {
    Csv,
    Json,
}

fn sample_count(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(count) if [1, 2, 4, 8, 16].contains(&count) => Ok(count),
        _ => Err("1, 2, 4, 8 or 16".to_owned()),
    }
}

fn parse_facets(text: &str) -> Result<Facets, String> {
    match text {
        "picture" => Ok(Facets::Picture),
        _ => positive_number(text).map(Facets::Within),
    }
}

fn proper_share(text: &str) -> Result<f64, String> {
    number_in(text, &AGREEMENT)
}

fn input_range(text: &str) -> Result<(String, [f64; 2]), String> {
    let wanted = || "INPUT=LOW:HIGH, as in phi=0:90".to_owned();
    let (name, range) = text.split_once('=').ok_or_else(wanted)?;
    let (low, high) = range.split_once(':').ok_or_else(wanted)?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    let ends = number(low)
        .zip(number(high))
        .filter(|(low, high)| low < high);
    let (low, high) = ends.ok_or_else(wanted)?;
    Ok((name.trim().to_owned(), [low, high]))
}

fn positive_length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if length >= 0.0 && length.is_finite() => Ok(length),
        _ => Err("a length that is not negative".to_owned()),
    }
}

fn start_count(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if count <= 1_000_000 => Ok(count),
        _ => Err("between 0 and 1000000".to_owned()),
    }
}
