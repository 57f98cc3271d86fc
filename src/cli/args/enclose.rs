//! The argument table of `mechanim enclose`.

use super::scene::SceneArgs;
use super::study::{VaryArgs, named_limit, positive_number, thread_count};
use super::values::{frame_count, named_word};
use crate::model::theme::Theme;
use clap::Args;
use std::path::PathBuf;

/// `mechanim enclose`
#[derive(Debug, Args)]
pub struct EncloseArgs {
    /// The scene; `--param NAME=880+-0.2` and `--param NAME=879.8..880.2` give a parameter an interval.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// What has a tolerance: parameters and inputs. If absent, those with an interval or a tolerance of their own; if there
    /// are none, every length and angle.
    #[command(flatten)]
    pub vary: VaryArgs,
    /// Tolerance of every dimension that has none of its own: plus or minus this, in the dimension's unit.
    #[arg(long, value_name = "VALUE", value_parser = positive_number)]
    pub tolerance: Option<f64>,
    /// Number of samples, spread evenly over the motion.
    #[arg(long, value_name = "N", default_value_t = 120, value_parser = frame_count)]
    pub samples: usize,
    /// Time in seconds of a sample; several separated by commas, in place of even ones.
    #[arg(
        long,
        value_name = "SECONDS",
        value_delimiter = ',',
        conflicts_with = "samples"
    )]
    pub at: Vec<f64>,
    /// Find tolerances that keep a band (of an unknown, a traced point or an output) within VALUE of the nominal motion,
    /// or a measure within VALUE of its nominal value, as a multiple of the given tolerances: NAME=VALUE.
    #[arg(long, value_name = "NAME=VALUE", value_parser = named_limit)]
    pub allow: Option<(String, f64)>,
    /// Skip the search for pieces near the ends of the bands.
    #[arg(long)]
    pub no_search: bool,
    /// Prove bands between the samples, too: they hold for all pieces at all times.
    #[arg(long, conflicts_with_all = ["at", "allow"])]
    pub between: bool,
    /// Worker threads; all cores if absent. The numbers do not depend on it.
    #[arg(long, value_name = "N", value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Where to write: the bands of every sample as .csv or .json; `-` for CSV on standard output.
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Draw a chart (.svg or .png): the bands over time, relative to the nominal motion.
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Draw only these, separated by commas; outputs and traced points if absent.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "plot")]
    pub only: Vec<String>,
    /// Light or dark: colours of background, text and lines.
    #[arg(long, value_parser = named_word(&Theme::NAMES), default_value = "light")]
    pub theme: Theme,
}
