//! The files of a verdict: JUnit, SARIF, Markdown, each of one scene or of many.

use crate::cli::args::motion::CheckArgs;
use crate::cli::io;
use crate::cli::term::outcome::Failure;
use crate::report::junit::to_junit;
use crate::report::sarif::to_sarif;
use crate::report::summary::to_markdown;
use crate::report::verdict::SceneVerdict;
use std::path::Path;

/// The options that name them; the JSON report comes first.
pub fn verdict_files(args: &CheckArgs) -> Vec<(&'static str, Option<&Path>)> {
    vec![
        ("--json", args.json.as_deref()),
        ("--junit", args.junit.as_deref()),
        ("--sarif", args.sarif.as_deref()),
        ("--summary", args.summary.as_deref()),
    ]
}

/// The one that goes to standard output, if any.
pub fn streamed_report(args: &CheckArgs) -> Option<&Path> {
    let paths = verdict_files(args).into_iter().filter_map(|(_, path)| path);
    paths.into_iter().find(|path| *path == Path::new("-"))
}

/// Writes the requested files.
pub fn write_verdicts(args: &CheckArgs, judged: &[SceneVerdict]) -> Result<(), Failure> {
    if let Some(path) = &args.junit {
        io::write_text(&args.scene, path, &to_junit(judged))?;
    }
    if let Some(path) = &args.sarif {
        io::write_json(&args.scene, path, &to_sarif(judged))?;
    }
    if let Some(path) = &args.summary {
        io::write_text(&args.scene, path, &to_markdown(judged))?;
    }
    Ok(())
}
