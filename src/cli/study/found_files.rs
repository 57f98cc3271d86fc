//! Where `mechanim synthesise` writes the scenes that it finds.

use crate::cli::args::study::SynthesiseArgs;
use crate::cli::io;
use crate::cli::term::outcome::Failure;
use crate::export::names_folder;
use std::path::{Path, PathBuf};

/// Destination of the scenes found: files in a folder, unless one scene goes to a file.
pub fn target_files(args: &SynthesiseArgs) -> Result<Vec<PathBuf>, Failure> {
    let Some(out) = &args.out else {
        return Ok(Vec::new());
    };
    if let ([scene], false) = (args.scenes.as_slice(), names_folder(out)) {
        if Path::new(scene) == out {
            return Err(io::is_input(out));
        }
        return Ok(vec![out.clone()]);
    }
    std::fs::create_dir_all(out).map_err(|error| {
        let message = format!("cannot create the folder {}: {error}", out.display());
        Failure::usage(message, Vec::new())
    })?;
    let names = args.scenes.iter().map(|scene| {
        let mut name = Path::new(scene).file_stem().unwrap_or_default().to_owned();
        name.push(".toml");
        out.join(name)
    });
    Ok(names.collect())
}
