//! `mechanim scenes`: the list of built-in scenes, or the file of one.

use crate::cli::term::outcome::{Failure, Outcome};
use crate::scene::source::no_builtin;
use crate::scene::{Overrides, builtin, load_scene};
use std::io::Write;

/// Runs the verb.
pub fn print_scenes(name: Option<&str>) -> Result<Outcome, Failure> {
    let mut out = std::io::stdout().lock();
    match name {
        Some(name) => {
            let Some(source) = builtin::find_builtin(name) else {
                return Err(no_builtin(name).into());
            };
            out.write_all(source.text.as_bytes())?;
        }
        None => {
            let width = builtin::ALL
                .iter()
                .map(|scene| scene.name.len())
                .max()
                .unwrap_or(0);
            for scene in builtin::ALL {
                let source =
                    builtin::find_builtin(scene.name).ok_or_else(|| no_builtin(scene.name))?;
                let loaded = load_scene(&source, &Overrides::default()).map_err(Box::new)?;
                writeln!(out, "{:width$}  {}", scene.name, loaded.description)?;
            }
        }
    }
    out.flush()?;
    Ok(Outcome::Done)
}
