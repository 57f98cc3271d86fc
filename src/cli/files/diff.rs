//! `mechanim diff`: whether two pictures, animations or folders are the same, and where they differ.

use crate::cli::args::files::DiffArgs;
use crate::cli::interrupt::CANCEL;
use crate::cli::io;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::compare::film::{
    AllowedDifference, FilmReport, FrameReport, FrameVerdict, compare_films,
};
use crate::compare::{Comparison, Difference, LADDER};
use crate::import::{FilmReader, Plays};
use crate::snapshot::golden::save_triptych;
use serde_json::{Value, json};
use std::sync::atomic::Ordering;

/// Maximum number of frames that are listed one by one.
const MAX_LINES: usize = 12;

/// Runs the verb.
pub fn run_diff(args: &DiffArgs, term: &Term) -> Result<Outcome, Failure> {
    let reports = [
        ("--out", args.out.as_deref()),
        ("--json", args.json.as_deref()),
    ];
    io::refuse_clashes(&[], &reports)?;
    io::refuse_over(&[args.a.clone(), args.b.clone()], &reports)?;
    let (a, b) = (FilmReader::open(&args.a)?, FilmReader::open(&args.b)?);
    let kind = a.kind;
    if kind != b.kind {
        let (left, right) = (args.a.display(), args.b.display());
        let message = format!("{left} is {kind} and {right} is {}", b.kind);
        let hint = "two of a kind can be compared: PNG, APNG, GIF, or folders of PNGs";
        return Err(Failure::usage(message, vec![hint.to_owned()]));
    }
    let allowed = AllowedDifference {
        tolerance: args.tolerance,
        pixels: args.max_pixels,
    };
    let plays = [a.plays, b.plays];
    let going = |film: FilmReader| film.take_while(|_| !CANCEL.load(Ordering::Relaxed));
    let found = compare_films(going(a), going(b), plays, allowed, args.out.is_some())?;
    if CANCEL.load(Ordering::Relaxed) {
        return Err(Failure::Interrupted);
    }
    match (&args.out, &found.worst_pictures) {
        (Some(path), Some([left, right])) => {
            save_triptych([left, right], args.tolerance, path)?;
        }
        (Some(path), None) => term.warning(&format!(
            "no picture is in both: {} was not written",
            path.display()
        )),
        (None, _) => {}
    }
    if let Some(path) = &args.json {
        io::write_document(path, &diff_document(args, kind, &found))?;
    }
    io::print_beside(term, args.json.as_deref(), &diff_text(&found))?;
    Ok(if found.is_same() {
        Outcome::Done
    } else {
        Outcome::CheckFailed
    })
}

/// The report as text.
fn diff_text(found: &FilmReport) -> String {
    let failing = found.failing();
    let mut text = String::new();
    for index in failing.iter().take(MAX_LINES) {
        let frame = &found.frames[*index];
        text += &format!(
            "  {}: {}\n",
            frame_title(*index, frame),
            frame_sentence(frame)
        );
    }
    if failing.len() > MAX_LINES {
        text += &format!("  and {} more\n", failing.len() - MAX_LINES);
    }
    if let Some([a, b]) = found.plays {
        text += &format!("  A plays {}, B {}\n", plays_word(a), plays_word(b));
    }
    let (levels, pixels): (Vec<String>, Vec<String>) = LADDER
        .iter()
        .zip(found.ladder())
        .map(|(level, pixels)| (format!("{level:>9}"), format!("{pixels:>9}")))
        .unzip();
    text += &format!("  off by more than {}\n", levels.concat());
    text += &format!("  pixels           {}\n", pixels.concat());
    let frames = match (found.frames.len(), failing.len()) {
        (1, _) => String::new(),
        (all, failing) => format!(" ({failing} of {all} pictures differ)"),
    };
    text + &format!("  result           {}{frames}\n", verdict_word(found))
}

fn verdict_word(found: &FilmReport) -> &'static str {
    if found.is_same() { "same" } else { "different" }
}

fn frame_title(index: usize, frame: &FrameReport) -> String {
    match frame.name.as_str() {
        "" => format!("frame {index}"),
        name => name.to_owned(),
    }
}

fn frame_sentence(frame: &FrameReport) -> String {
    let mut parts = Vec::new();
    match &frame.verdict {
        FrameVerdict::OnlyInA => parts.push("only in A".to_owned()),
        FrameVerdict::OnlyInB => parts.push("only in B".to_owned()),
        FrameVerdict::Both(comparison) => parts.push(comparison.to_string()),
    }
    if let Some([a, b]) = frame.seconds {
        parts.push(format!("shown for {a:.3} s in A and {b:.3} s in B"));
    }
    parts.join("; ")
}

fn plays_word(plays: Option<Plays>) -> String {
    match plays {
        Some(Plays::Forever) => "without end".to_owned(),
        Some(Plays::Times(1)) => "once".to_owned(),
        Some(Plays::Times(times)) => format!("{times} times"),
        None => "never".to_owned(),
    }
}

/// The report as JSON; described in `docs/formats.md`.
fn diff_document(args: &DiffArgs, kind: &str, found: &FilmReport) -> Value {
    let frames = found.frames.iter().enumerate().map(|(index, frame)| {
        let mut entry =
            json!({ "frame": index, "name": frame.name, "passes": found.passes(index) });
        let status = match &frame.verdict {
            FrameVerdict::OnlyInA => "only-in-a",
            FrameVerdict::OnlyInB => "only-in-b",
            FrameVerdict::Both(Comparison::SizeMismatch { a, b }) => {
                entry["sizes"] = json!([a, b]);
                "other-size"
            }
            FrameVerdict::Both(Comparison::SameSize(difference)) => {
                entry["difference"] = difference_numbers(difference);
                "compared"
            }
        };
        entry["status"] = status.into();
        entry["seconds"] = json!(frame.seconds);
        entry
    });
    let frames: Vec<Value> = frames.collect();
    json!({
        "schema": "mechanim-diff/1",
        "a": args.a.display().to_string(),
        "b": args.b.display().to_string(),
        "kind": kind.trim_start_matches("an ").trim_start_matches("a "),
        "tolerance": args.tolerance,
        "max_pixels": args.max_pixels,
        "levels": LADDER,
        "pixels_over": found.ladder(),
        "plays": found.plays.map(|plays| plays.map(plays_word)),
        "worst": found.worst,
        "frames": frames,
        "result": verdict_word(found),
    })
}

/// The numbers of a difference.
pub fn difference_numbers(difference: &Difference) -> Value {
    // JSON has no infinity, which is the ratio of equal colours.
    let psnr = Some(difference.psnr).filter(|psnr| psnr.is_finite());
    json!({
        "pixels": difference.pixels,
        "over": difference.over,
        "pixels_over": difference.over_ladder,
        "rmse": difference.rmse,
        "psnr": psnr,
        "worst": difference.worst,
        "worst_at": difference.worst_at,
        "bounds": difference.bounds,
    })
}
