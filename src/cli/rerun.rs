//! `--watch`: runs a verb again whenever its scene, a mesh of it or its table of inputs has changed. Errors are shown
//! until the next change; Ctrl-C ends it.

use super::args::scene::SceneArgs;
use super::interrupt::is_interrupted;
use super::open::patterns::scenes_of;
use super::open::scene::named_meshes;
use super::term::Term;
use super::term::outcome::{Failure, Outcome};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// Polling interval of the files: shorter than the time from a glance at the editor to one at the picture.
const POLLING: Duration = Duration::from_millis(100);

/// Runs a verb once, or with `watch` once after every change.
pub fn run_again(
    watch: bool,
    (scene, more): (&SceneArgs, &[OsString]),
    term: &Term,
    run: impl Fn() -> Result<Outcome, Failure>,
) -> Result<Outcome, Failure> {
    if !watch {
        return run();
    }
    let mut seen = watched_files(scene, more)?;
    if seen.is_empty() {
        let message = "--watch needs a file: built-in scenes and pipes do not change";
        return Err(Failure::usage(
            message,
            vec!["write one: mechanim new NAME --from SCENE".to_owned()],
        ));
    }
    for number in 1.. {
        let begun = Instant::now();
        let code = match run() {
            Ok(outcome) => outcome.code(),
            Err(Failure::Interrupted) => return Ok(Outcome::Done),
            Err(failure) => {
                term.failure(&failure);
                failure.code()
            }
        };
        term.note(&format!(
            "run {number} ended with exit code {code} after {:.1} s; waiting for changes, Ctrl-C ends",
            begun.elapsed().as_secs_f64()
        ));
        match next_change(&seen, scene, more) {
            None => return Ok(Outcome::Done),
            Some(files) => seen = files,
        }
    }
    Ok(Outcome::Done)
}

/// A file with the attributes that reveal a change.
type Stamp = (PathBuf, Option<(SystemTime, u64)>);

/// Waits for a change, and then until the files stay unchanged: editors write in several steps. `None` after Ctrl-C.
fn next_change(seen: &[Stamp], scene: &SceneArgs, more: &[OsString]) -> Option<Vec<Stamp>> {
    let mut last = seen.to_vec();
    loop {
        std::thread::sleep(POLLING);
        if is_interrupted() {
            return None;
        }
        // A pattern may match no file for a moment.
        let now = watched_files(scene, more).unwrap_or_else(|_| last.clone());
        let has_settled = now == last;
        if has_settled && now != seen && now.iter().all(|(_, stamp)| stamp.is_some()) {
            return Some(now);
        }
        last = now;
    }
}

/// The scenes that are files, their tables of inputs, and the meshes that their texts name.
fn watched_files(scene: &SceneArgs, more: &[OsString]) -> Result<Vec<Stamp>, Failure> {
    let mut paths: Vec<PathBuf> = Vec::new();
    for one in scenes_of(scene, more)? {
        let path = PathBuf::from(&one.scene);
        match named_meshes(&path) {
            Some(meshes) => paths.extend(meshes.into_iter().chain([path])),
            // Gone for a moment, as while an editor replaces it; a built-in scene has no file at all.
            None => paths.extend(path.extension().is_some().then_some(path)),
        }
    }
    paths.extend(scene.table.clone().filter(|path| path != Path::new("-")));
    paths.sort();
    paths.dedup();
    Ok(paths
        .into_iter()
        .map(|path| {
            let stamp = std::fs::metadata(&path)
                .ok()
                .and_then(|m| Some((m.modified().ok()?, m.len())));
            (path, stamp)
        })
        .collect())
}
