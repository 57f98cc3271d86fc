//! The arguments of the verbs that draw charts: `plot` and `accuracy`.

use super::scene::SceneArgs;
use super::values::{frame_count, named_word, picture_size, rate_order};
use crate::model::theme::Theme;
use clap::Args;
use std::path::PathBuf;

/// `mechanim plot`
#[derive(Debug, Args)]
pub struct PlotArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Where to write: .svg, .pdf or .png; `-` for SVG on standard output.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Run again whenever a scene, a mesh that it names or its table of inputs changes, until Ctrl-C.
    #[arg(long)]
    pub watch: bool,
    /// Curves in place of the scene's plots: names or formulas as in outputs, or d(NAME, INPUT, ORDER). May be repeated.
    #[arg(long, value_name = "NAME,NAME,…", allow_hyphen_values = true)]
    pub y: Vec<String>,
    /// Quantity on the horizontal axis: a name or formula; time if absent.
    #[arg(long, value_name = "NAME", requires = "y")]
    pub x: Option<String>,
    /// The same scale on both axes, for paths in a plane.
    #[arg(long, requires = "y")]
    pub equal: bool,
    /// Rates up to this order (1 to 8) of the curves are drawn as well: derivatives by time.
    #[arg(long, value_name = "N", requires = "y", value_parser = rate_order)]
    pub order: Option<usize>,
    /// Rates with respect to this input instead of time, the others constant: transfer functions.
    #[arg(long, value_name = "INPUT", requires = "order")]
    pub per: Option<String>,
    /// Draw only the plot with this title.
    #[arg(long, value_name = "TITLE", conflicts_with = "y")]
    pub only: Option<String>,
    /// Number of samples, spread evenly over the motion; 361 if absent.
    #[arg(long, value_name = "N", value_parser = frame_count)]
    pub samples: Option<usize>,
    /// Size in pixels; as high as the panels need if absent.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = picture_size)]
    pub size: Option<[u32; 2]>,
    /// Light or dark: colours of background, text and lines.
    #[arg(long, value_parser = named_word(&Theme::NAMES), default_value = "light")]
    pub theme: Theme,
}

/// `mechanim accuracy`
#[derive(Debug, Args)]
pub struct AccuracyArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Where to write: the report as .json or .csv, or a chart as .svg or .png; `-` for JSON on standard output.
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Number of poses that each solver computes, spread evenly over the motion.
    #[arg(long, value_name = "N", default_value_t = 90, value_parser = pose_count)]
    pub poses: usize,
    /// Maximum number of turns in the drift table, for motions that return to their start.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = turn_count)]
    pub turns: usize,
    /// Size in pixels of the chart.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = picture_size)]
    pub size: Option<[u32; 2]>,
    /// Light or dark: colours of background, text and lines.
    #[arg(long, value_parser = named_word(&Theme::NAMES), default_value = "light")]
    pub theme: Theme,
}

fn pose_count(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if (1..=10_000).contains(&count) => Ok(count),
        _ => Err("between 1 and 10000".to_owned()),
    }
}

fn turn_count(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if count <= 10_000 => Ok(count),
        _ => Err("between 0 and 10000".to_owned()),
    }
}
