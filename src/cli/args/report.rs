//! The arguments of `report`.

use super::motion::AskedArgs;
use super::scene::SceneArgs;
use clap::Args;
use std::ffi::OsString;
use std::path::PathBuf;

/// `mechanim report`
#[derive(Clone, Debug, Args)]
#[command(
    after_help = "Examples:\n  mechanim report gearshift --out gearshift.html\n  mechanim report \"designs/*.toml\" --out all.html --certify motion"
)]
pub struct ReportArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// More scenes for the same page; a name may be a pattern, such as designs/*.toml.
    #[arg(value_name = "SCENE")]
    pub more: Vec<OsString>,
    /// File to write: one .html page that needs no network (`-` for standard output).
    #[arg(long, short, value_name = "FILE.html")]
    pub out: PathBuf,
    /// Run again whenever a scene, a mesh that it names or its table of inputs changes, until Ctrl-C.
    #[arg(long)]
    pub watch: bool,
    /// What is asked.
    #[command(flatten)]
    pub asked: AskedArgs,
}
