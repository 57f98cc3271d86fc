//! `mechanim snapshot`: the pictures of a list against their golden files.

use super::diff::difference_numbers;
use crate::cli::args::files::{SnapshotArgs, UpdateArg};
use crate::cli::io;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::diag::{list_names, name_hint};
use crate::import::film::png_files;
use crate::report::sentences::counted_things;
use crate::scene::source;
use crate::snapshot::golden::path_beside;
use crate::snapshot::manifest::GoldenPicture;
use crate::snapshot::{
    DrawError, GoldenVerdict, MANIFEST, Manifest, Update, draw_picture, judge_picture,
};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Runs the verb.
pub fn run_snapshot(args: &SnapshotArgs, term: &Term) -> Result<Outcome, Failure> {
    let update = wanted_update(args)?;
    let mut manifest = read_manifest(&args.folder)?;
    for picture in &mut manifest.pictures {
        picture.folders.clone_from(&args.allowed);
    }
    let wanted = wanted_pictures(args, &manifest)?;
    let pictures = manifest.pictures.iter();
    let files = pictures.flat_map(|picture| [picture.file.as_str(), picture.scene.as_str()]);
    let inputs = files.chain([MANIFEST]).map(|file| args.folder.join(file));
    let inputs: Vec<PathBuf> = inputs.collect();
    io::refuse_over(&inputs, &[("--json", args.json.as_deref())])?;
    let mut results = Vec::new();
    for picture in wanted {
        let drawn = draw_picture(picture, &args.folder).map_err(|e| picture_failure(picture, e))?;
        let golden = args.folder.join(&picture.file);
        let verdict = judge_picture(&golden, &drawn, picture.allowed, update)?;
        if crate::cli::interrupt::CANCEL.load(std::sync::atomic::Ordering::Relaxed) {
            let written = results
                .iter()
                .filter(|(_, v)| matches!(v, GoldenVerdict::Written));
            return Err(
                match written.count() + usize::from(matches!(verdict, GoldenVerdict::Written)) {
                    0 => Failure::Interrupted,
                    count => {
                        Failure::Stopped(format!("{count} golden pictures were written before"))
                    }
                },
            );
        }
        results.push((picture, verdict));
    }
    warn_of_strangers(&args.folder, &manifest, term)?;
    let failed = results
        .iter()
        .any(|(_, v)| matches!(v, GoldenVerdict::Failed { .. }));
    if let Some(path) = &args.json {
        io::write_document(path, &snapshot_document(&results, failed))?;
    }
    io::print_beside(
        term,
        args.json.as_deref(),
        &snapshot_text(&args.folder, &results),
    )?;
    Ok(if failed {
        Outcome::CheckFailed
    } else {
        Outcome::Done
    })
}

/// Where failed pictures may be written; nothing if nobody could look at them.
fn wanted_update(args: &SnapshotArgs) -> Result<Update, Failure> {
    let Some(update) = args.update else {
        return Ok(Update::Never);
    };
    if std::env::var_os("CI").is_some() {
        let message = "--update is refused if CI is set: golden pictures must be reviewed before they are accepted";
        return Err(Failure::usage(message, Vec::new()));
    }
    Ok(match update {
        UpdateArg::New => Update::New,
        UpdateArg::Failing => Update::Failing,
        UpdateArg::All => Update::All,
    })
}

fn read_manifest(folder: &Path) -> Result<Manifest, Failure> {
    let path = folder.join(MANIFEST);
    let name = path.display().to_string();
    let failed = |message| {
        let hint = format!("{MANIFEST} lists the pictures: [[picture]] with `file` and `scene`");
        Failure::usage(message, vec![hint])
    };
    let file = std::fs::File::open(&path);
    let file = file.map_err(|e| failed(format!("cannot read {name}: {e}")))?;
    // Size limit, as for a scene.
    let text = source::read_source(file, &name).map_err(|e| failed(e.message))?;
    Ok(Manifest::read(&text)?)
}

/// The pictures selected by `--only`; at least one.
fn wanted_pictures<'a>(
    args: &SnapshotArgs,
    manifest: &'a Manifest,
) -> Result<Vec<&'a GoldenPicture>, Failure> {
    let is_wanted = |picture: &&GoldenPicture| {
        args.only.is_empty() || args.only.iter().any(|text| picture.file.contains(text))
    };
    let wanted: Vec<&GoldenPicture> = manifest.pictures.iter().filter(is_wanted).collect();
    if wanted.is_empty() {
        let names = manifest.pictures.iter().map(|p| p.file.as_str());
        let message = format!("no picture is called {}", args.only.join(" or "));
        // Any part of a name selects pictures; only one that was written alone has a nearest name.
        let hint = match args.only.as_slice() {
            [word] => name_hint(word, names),
            _ => list_names(names),
        };
        return Err(Failure::usage(message, vec![hint]));
    }
    Ok(wanted)
}

fn picture_failure(picture: &GoldenPicture, error: DrawError) -> Failure {
    match error {
        DrawError::Scene(error) => error.into(),
        DrawError::Structure(error) => error.into(),
        DrawError::Render(error) => error.into(),
        DrawError::Limit(error) => error.into(),
        other => Failure::usage(format!("{}: {other}", picture.file), Vec::new()),
    }
}

/// PNG files that are not in the list are compared with nothing.
fn warn_of_strangers(folder: &Path, manifest: &Manifest, term: &Term) -> Result<(), Failure> {
    for path in png_files(folder)? {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let known = manifest.pictures.iter().any(|picture| picture.file == name);
        let ours = name.ends_with(".new.png") || name.ends_with(".diff.png");
        if !known && !ours {
            term.warning(&format!("{} is not in {MANIFEST}", path.display()));
        }
    }
    Ok(())
}

fn snapshot_text(folder: &Path, results: &[(&GoldenPicture, GoldenVerdict)]) -> String {
    let mut text = String::new();
    for (picture, verdict) in results {
        let file = &picture.file;
        text += &match verdict {
            GoldenVerdict::Passed(_) => format!("passed   {file}\n"),
            GoldenVerdict::Written => format!("written  {file}\n"),
            GoldenVerdict::Failed { reason, .. } => {
                let golden = folder.join(file);
                let left = ["new", "diff"].map(|kind| path_beside(&golden, kind));
                let left = left.iter().filter(|path| path.exists());
                let left: Vec<String> = left.map(|path| path.display().to_string()).collect();
                format!(
                    "failed   {file}: {reason}\n         see {}\n",
                    left.join(" and ")
                )
            }
        };
    }
    let failed = results
        .iter()
        .filter(|(_, v)| matches!(v, GoldenVerdict::Failed { .. }));
    text + &format!(
        "{} of {} failed\n",
        failed.count(),
        counted_things(results.len(), "picture")
    )
}

/// The report as JSON; described in `docs/formats.md`.
fn snapshot_document(results: &[(&GoldenPicture, GoldenVerdict)], failed: bool) -> Value {
    let pictures = results.iter().map(|(picture, verdict)| {
        let (word, reason, difference) = match verdict {
            GoldenVerdict::Passed(difference) => ("passed", None, Some(difference)),
            GoldenVerdict::Written => ("written", None, None),
            GoldenVerdict::Failed { reason, difference } => {
                ("failed", Some(reason), difference.as_ref())
            }
        };
        json!({
            "file": picture.file,
            "scene": picture.scene,
            "tolerance": picture.allowed.tolerance,
            "max_pixels": picture.allowed.pixels,
            "verdict": word,
            "reason": reason,
            "difference": difference.map(difference_numbers),
        })
    });
    json!({
        "schema": "mechanim-snapshot/1",
        "pictures": pictures.collect::<Vec<_>>(),
        "result": if failed { "failed" } else { "passed" },
    })
}
