//! The argument tables of picture files: what is written, and the verbs that take pictures as they are.

use super::values::hex_colour;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// What is written, and how.
#[derive(Debug, Args)]
pub struct FileArgs {
    /// Where to write: .gif, .apng, .png, .mp4, .webm, .webp, .y4m, .rgba, a folder, a pattern such as frame-%04d.png, or `-` for standard
    /// output; for scenes also the 3-D models .glb, .stl and .obj.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Format, if the file name does not determine it; `-` alone is a GIF.
    #[arg(long, value_enum)]
    pub format: Option<PictureFormat>,
    /// Quality of a GIF, 1 to 100 (88 if absent): lower values allow small colour errors for smaller files.
    #[arg(long, value_name = "N", value_parser = super::values::gif_quality)]
    pub quality: Option<u8>,
    /// PNG compression level [default: balanced; fast for sequences].
    #[arg(long, value_enum)]
    pub compression: Option<Compression>,
    /// Resolution of a PNG in dots per inch, as the file says: its size on paper.
    #[arg(long, value_name = "N", value_parser = super::values::dots_per_inch)]
    pub dpi: Option<f64>,
    /// Chroma of a y4m video: full resolution (444, the default), or one sample for 2 by 2 pixels, as most players
    /// expect (420).
    #[arg(long, value_enum)]
    pub chroma: Option<ChromaArg>,
    /// Whether a GIF or APNG repeats.
    #[arg(long = "loop", value_enum)]
    pub repeat: Option<Repeat>,
    /// Worker threads; all cores if absent. The files do not depend on it.
    #[arg(long, value_name = "N", value_parser = super::values::worker_count)]
    pub threads: Option<usize>,
    /// Progress on standard error: a bar on a terminal (auto), plain lines, or none.
    #[arg(long, value_enum, default_value_t = ProgressArg::Auto)]
    pub progress: ProgressArg,
}

/// `mechanim new`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  mechanim new wiper --from four-bar\n  mechanim new designs/press --from slider-crank"
)]
pub struct NewArgs {
    /// Name of the scene and its file: `wiper` makes wiper.toml. An existing file is never replaced.
    #[arg(value_name = "NAME")]
    pub name: PathBuf,
    /// Built-in scene to copy.
    #[arg(long, value_name = "SCENE")]
    pub from: String,
}

/// `mechanim encode`
#[derive(Debug, Args)]
pub struct EncodeArgs {
    /// PNG files, or folders of them, in numerical order: f2 before f10.
    #[arg(required = true, value_name = "FRAMES")]
    pub frames: Vec<PathBuf>,
    /// What is written.
    #[command(flatten)]
    pub file: FileArgs,
    /// Frames a second.
    #[arg(long, value_name = "RATE", default_value_t = 25.0, allow_negative_numbers = true, value_parser = super::values::frame_rate)]
    pub fps: f64,
    /// Keep the order of the command line.
    #[arg(long)]
    pub no_sort: bool,
    /// Colour of the background, under translucent frames.
    #[arg(long, value_name = "#rrggbb", value_parser = hex_colour)]
    pub background: Option<[u8; 3]>,
}

/// `mechanim diff`
#[derive(Debug, Args)]
pub struct DiffArgs {
    /// The expected picture: a PNG, an APNG, a GIF, or a folder of PNGs.
    pub a: PathBuf,
    /// The actual one, of the same kind.
    pub b: PathBuf,
    /// Largest difference of a colour channel that is ignored, 0 to 255.
    #[arg(long = "levels", value_name = "N", default_value_t = 0)]
    pub tolerance: u8,
    /// Maximum number of pixels of a picture that may differ by more.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub max_pixels: u64,
    /// Where to write: a PNG of A, the difference and B side by side; of several frames the worst.
    #[arg(long, short, value_name = "FILE.png")]
    pub out: Option<PathBuf>,
    /// Write the report as JSON to this file (`-` for standard output).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// `mechanim snapshot`
#[derive(Debug, Args)]
pub struct SnapshotArgs {
    /// Folder with `snapshots.toml` and the golden pictures.
    pub folder: PathBuf,
    /// Write golden pictures instead of comparing: missing ones only (--update=new), missing and failing ones (--update),
    /// or all of them. Refused where the variable CI is set.
    #[arg(long, value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "failing")]
    pub update: Option<UpdateArg>,
    /// Draw only pictures whose file name contains this text. May be repeated.
    #[arg(long = "only", value_name = "TEXT")]
    pub only: Vec<String>,
    /// Also allow files in or below this folder: scenes and their mesh files, which otherwise must be in or below the folder of
    /// the list. May be repeated.
    #[arg(long = "allow-files", value_name = "DIR")]
    pub allowed: Vec<PathBuf>,
    /// Write the report as JSON to this file (`-` for standard output).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// `--format`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum PictureFormat {
    Gif,
    Apng,
    Png,
    Mp4,
    Webm,
    Webp,
    Y4m,
    Rgba,
    Glb,
    Stl,
    Obj,
}

/// `--compression`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum Compression {
    Fast,
    Balanced,
    Small,
}

/// `--chroma`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum ChromaArg {
    #[value(name = "444")]
    C444,
    #[value(name = "420")]
    C420,
}

/// `--loop`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum Repeat {
    Forever,
    Once,
}

/// `--update`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum UpdateArg {
    New,
    Failing,
    All,
}

/// `--progress`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum ProgressArg {
    Auto,
    Plain,
    None,
}
