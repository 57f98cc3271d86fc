//! The argument tables of `mechanim dyads` and `mechanim intervals`.

use super::scene::SceneArgs;
use super::study::{positive_number, thread_count};
use super::values::named_word;
use crate::model::theme::Theme;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Which pose and which drive.
#[derive(Debug, Args)]
pub struct RowArgs {
    /// The scene: a planar linkage of hinges with one degree of freedom.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Time in seconds of the pose; the start if absent.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    pub at: f64,
    /// Rates with respect to this input instead of time, the others constant: velocities are for one unit of it. The only input
    /// if absent.
    #[arg(long, value_name = "INPUT")]
    pub per: Option<String>,
    /// Range of the angle between the two bars of a dyad, in degrees: FROM..TO. For `--derive tied` from an angle to its
    /// supplement.
    #[arg(long, value_name = "FROM..TO", default_value = "10..170", value_parser = angle_range)]
    pub delta: [f64; 2],
}

/// `mechanim dyads`
#[derive(Debug, Args)]
pub struct DyadsArgs {
    /// The row.
    #[command(flatten)]
    pub row: RowArgs,
    /// Where to write: the table of the velocities as .csv, .md or .tex, or everything as .json; `-` for JSON on standard
    /// output.
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// What is made of the system in intervals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum Derivation {
    /// Random directions of all bars: quantiles of velocities and conjugate positions.
    Trials,
    /// The formal solution, by the subdifferential Newton method.
    Formal,
    /// The largest cube of tolerable velocities around those of the pose.
    Centre,
    /// The exact set of start positions for which the bars of every dyad keep their angle, paved.
    Tied,
}

/// `mechanim intervals`
#[derive(Debug, Args)]
pub struct IntervalsArgs {
    /// The row.
    #[command(flatten)]
    pub row: RowArgs,
    /// What is derived from the interval system.
    #[arg(long, value_enum)]
    pub derive: Derivation,
    /// Keep the direction of each bar within this many degrees of its own, instead of the whole range of --delta.
    #[arg(long, value_name = "DEGREES", value_parser = positive_number)]
    pub spread: Option<f64>,
    /// Velocity of the last point, in place of its own: VX,VY.
    #[arg(long, value_name = "VX,VY", value_parser = two_numbers, allow_hyphen_values = true)]
    pub velocity: Option<[f64; 2]>,
    /// Half the width of all right-hand sides; 5 % of the given velocity if absent.
    #[arg(long, value_name = "VALUE", value_parser = positive_number)]
    pub side: Option<f64>,
    /// Centre the cube on zero instead of on the velocities of the pose.
    #[arg(long)]
    pub about_zero: bool,
    /// Number of trials; 100000 if absent.
    #[arg(long, value_name = "N", value_parser = trial_count)]
    pub trials: Option<usize>,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Worker threads; all cores if absent. The numbers do not depend on it.
    #[arg(long, value_name = "N", value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Half-width of the square searched around each point, in the scene's unit of length; a tenth of the mechanism if absent.
    #[arg(long, value_name = "LENGTH", value_parser = positive_number)]
    pub reach: Option<f64>,
    /// How often the squares of a paving are halved; 6 times if absent.
    #[arg(long, value_name = "N", value_parser = halving_count)]
    pub halvings: Option<u32>,
    /// Where to write: the result as .json; `-` for standard output.
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Draw a chart (.svg or .png): the paved sets in the plane of the mechanism. With --derive tied.
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Light or dark: colours of background, text and lines.
    #[arg(long, value_parser = named_word(&Theme::NAMES), default_value = "light")]
    pub theme: Theme,
}

/// `FROM..TO` in degrees.
fn angle_range(text: &str) -> Result<[f64; 2], String> {
    let wrong = || "write FROM..TO in degrees, for example 10..170".to_owned();
    let (from, to) = text.split_once("..").ok_or_else(wrong)?;
    let [from, to] = [from, to].map(|end| end.trim().parse::<f64>());
    match (from, to) {
        (Ok(from), Ok(to)) if from > to => Err(format!(
            "the lower end {from} of the interval is above the upper end {to}"
        )),
        (Ok(from), Ok(to)) if from >= -360.0 && to <= 360.0 => Ok([from, to]),
        _ => Err(wrong()),
    }
}

/// `X,Y`
fn two_numbers(text: &str) -> Result<[f64; 2], String> {
    let wrong = || "write two numbers, for example 1,0.5".to_owned();
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    match (x.trim().parse::<f64>(), y.trim().parse::<f64>()) {
        (Ok(x), Ok(y)) if x.is_finite() && y.is_finite() => Ok([x, y]),
        _ => Err(wrong()),
    }
}

fn trial_count(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if (1..=10_000_000).contains(&count) => Ok(count),
        _ => Err("between 1 and 10000000".to_owned()),
    }
}

fn halving_count(text: &str) -> Result<u32, String> {
    match text.parse::<u32>() {
        Ok(count) if (1..=10).contains(&count) => Ok(count),
        _ => Err("between 1 and 10".to_owned()),
    }
}
