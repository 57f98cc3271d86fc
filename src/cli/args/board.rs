//! The arguments of the verbs that put on paper or on a board what a scene writes: `draw` and `show`.

use super::scene::SceneArgs;
use super::values::named_word;
use super::view::{azimuth_angle, elevation_angle};
use crate::diagram::sheet::DiagramParts;
use crate::model::theme::Theme;
use crate::model::view::NamedView;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Directions from which a diagram may be looked at.
const VIEWS: [(&str, NamedView); 4] = [
    ("iso", NamedView::Iso),
    ("front", NamedView::Front),
    ("top", NamedView::Top),
    ("side", NamedView::Side),
];

/// `mechanim draw`
#[derive(Debug, Args)]
pub struct DrawArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Where to write: .svg, .pdf or .png; `-` for SVG on standard output.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Time in seconds of the pose that is drawn; if absent, the one of 24 poses whose loops enclose the largest area.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub at: Option<f64>,
    /// Look from a named direction. If absent, a planar mechanism is shown from the front, any other one from the
    /// direction of its scene.
    #[arg(long, value_parser = named_word(&VIEWS))]
    pub view: Option<NamedView>,
    /// Direction of the viewer about the up axis, in degrees.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = azimuth_angle)]
    pub azimuth: Option<f64>,
    /// Height of the viewer above the horizon, in degrees, -90 to 90.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = elevation_angle)]
    pub elevation: Option<f64>,
    /// Parts shown in addition to links and joints: any of frames, bodies, dimensions, loops, names, vectors, angles,
    /// values; `none` for links and joints alone. If absent, bodies,dimensions,loops,names,angles.
    #[arg(long, value_name = "WHAT,WHAT,…", value_parser = shown_words)]
    pub show: Option<DiagramParts>,
    /// Width in pixels; the height follows from the mechanism.
    #[arg(long, value_name = "PIXELS", default_value_t = 1200, value_parser = clap::value_parser!(u32).range(200..=8000))]
    pub width: u32,
    /// Light or dark: colours of background, text and lines.
    #[arg(long, value_parser = named_word(&Theme::NAMES), default_value = "light")]
    pub theme: Theme,
}

/// `mechanim show`
#[derive(Debug, Args)]
pub struct ShowArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Time in seconds of the pose whose numbers are written.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub at: f64,
    /// A chain of `[chains]`, or a loop. May be repeated; all loops if none is named.
    #[arg(long = "chain", value_name = "NAME")]
    pub chains: Vec<String>,
    /// Format, if the file name does not determine it: text if absent.
    #[arg(long, value_enum)]
    pub format: Option<BoardFormat>,
    /// Where to write: .txt, .json, .tex or .html; standard output if absent.
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// `--format` of `show`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum BoardFormat {
    Text,
    Json,
    Latex,
    Html,
}

impl ShowArgs {
    /// The format asked for, else that of the file.
    pub fn board_format(&self) -> BoardFormat {
        let extension = self.out.as_ref().and_then(|out| out.extension());
        let by_name = match extension.and_then(|e| e.to_str()) {
            Some("json") => BoardFormat::Json,
            Some("tex") => BoardFormat::Latex,
            Some("html" | "htm") => BoardFormat::Html,
            _ => BoardFormat::Text,
        };
        self.format.unwrap_or(by_name)
    }
}

fn shown_words(text: &str) -> Result<DiagramParts, String> {
    let mut shown = DiagramParts::default();
    for word in text
        .split(',')
        .map(str::trim)
        .filter(|word| *word != "none")
    {
        match DiagramParts::WORDS.iter().find(|(known, _)| *known == word) {
            Some((_, turn_on)) => turn_on(&mut shown),
            None => {
                let known: Vec<&str> = DiagramParts::WORDS.iter().map(|(word, _)| *word).collect();
                return Err(format!("`{word}` is not one of {}, none", known.join(", ")));
            }
        }
    }
    Ok(shown)
}
