//! The arguments of `report`.

use super::motion::RequirementArgs;
use super::scene::SceneArgs;
use clap::Args;
use std::ffi::OsString;
use std::path::PathBuf;

/// `mechanim report`
#[derive(Clone, Debug, Args)]
#[command(
    after_help = "Examples:\n  mechanim report gearshift --out gearshift.html\n  mechanim report \"designs/*.toml\" --out all.html --certify motion\n  mechanim report gearshift --live --out live.html"
)]
pub struct ReportArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// More scenes for the same page; a name may be a pattern, such as designs/*.toml.
    #[arg(value_name = "SCENE")]
    pub more: Vec<OsString>,
    /// Where to write: one .html page that needs no network (`-` for standard output).
    #[arg(long, short, value_name = "FILE.html")]
    pub out: PathBuf,
    /// Add sliders for dimensions and inputs: the page holds the program itself as WebAssembly, which follows the mechanism
    /// and proves every pose again.
    #[arg(long, conflicts_with_all = ["inputs", "table", "mode"])]
    pub live: bool,
    /// The engine of live pages; `mechanim.wasm` beside the program if absent.
    #[arg(long, value_name = "FILE.wasm", requires = "live")]
    pub wasm: Option<PathBuf>,
    /// Run again whenever a scene, a mesh that it names or its table of inputs changes, until Ctrl-C.
    #[arg(long)]
    pub watch: bool,
    /// What is asked.
    #[command(flatten)]
    pub asked: RequirementArgs,
}

/// `mechanim compare`
#[derive(Clone, Debug, Args)]
#[command(after_help = "Example:\n  mechanim compare old.toml new.toml --out change.html")]
pub struct CompareArgs {
    /// The old version: a built-in name or a path. --param, --input and --guess apply to both.
    pub old: OsString,
    /// The scene as it is.
    #[command(flatten)]
    pub new: SceneArgs,
    /// Where to write: one .html page that needs no network (`-` for standard output).
    #[arg(long, short, value_name = "FILE.html")]
    pub out: PathBuf,
    /// What is asked of both.
    #[command(flatten)]
    pub asked: RequirementArgs,
}

/// `mechanim site`
#[derive(Clone, Debug, Args)]
#[command(after_help = "Example:\n  mechanim site \"scenes/*.toml\" --out site")]
pub struct SiteArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// More scenes; a name may be a pattern, such as designs/*.toml.
    #[arg(value_name = "SCENE")]
    pub more: Vec<OsString>,
    /// Where to write: the folder, with index.html and a page for each scene beside it. Other files there are left alone.
    #[arg(long, short, value_name = "DIR")]
    pub out: PathBuf,
    /// Title of the front page; the number of mechanisms if absent.
    #[arg(long)]
    pub title: Option<String>,
    /// The engine of live pages; `mechanim.wasm` beside the program if absent.
    #[arg(long, value_name = "FILE.wasm")]
    pub wasm: Option<PathBuf>,
    /// What is asked.
    #[command(flatten)]
    pub asked: RequirementArgs,
}
