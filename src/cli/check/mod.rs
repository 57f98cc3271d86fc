//! `mechanim check`: whether all loops close over the motion, whether a given pose is closed, and whether all
//! requirements are met. Exit code, text, JSON and JUnit follow from one verdict.

mod answer;
mod clearance;
mod files;
mod inputs_box;
mod judge;
mod many;
pub mod motion;
mod pieces;
mod pose;
mod swept;

use super::args::motion::CheckArgs;
use super::open::patterns::scenes_of;
use super::term::Term;
use super::term::outcome::{Failure, Outcome};
use crate::cli::io;
use crate::limits::search_deadline;
use crate::report::verdict::{PROOF, SceneVerdict, Status};
use answer::CheckAnswer;
use judge::judge;
use std::path::Path;
use std::time::Instant;

/// Runs the verb.
pub fn run_check(args: &CheckArgs, term: &Term) -> Result<Outcome, Failure> {
    let scenes = scenes_of(&args.scene, &args.more)?;
    match scenes.as_slice() {
        [only] => check_one(
            &CheckArgs {
                scene: only.clone(),
                ..args.clone()
            },
            term,
        ),
        several => many::check_many(args, several, term),
    }
}

fn check_one(args: &CheckArgs, term: &Term) -> Result<Outcome, Failure> {
    let mut reports = files::verdict_files(args);
    reports.extend([
        ("--csv", args.csv.as_deref()),
        ("--plot", args.plot.as_deref()),
        ("--render", args.render.as_deref()),
    ]);
    io::refuse_clashes(&[&args.scene], &reports)?;
    let begun = Instant::now();
    let source = args.scene.scene.to_string_lossy();
    let answer = match judge(args, term) {
        Err(failure @ (Failure::Interrupted | Failure::Internal(_))) => return Err(failure),
        // Reports of an earlier run must not stay behind as if they were about this one.
        Err(failure) => CheckAnswer::unreadable(&source, failure),
        Ok(answer) => answer,
    };
    let judged = SceneVerdict {
        source: &source,
        verdict: &answer.verdict,
        seconds: begun.elapsed().as_secs_f64(),
    };
    files::write_verdicts(args, &[judged])?;
    if let (Some(path), Some(document)) = (&args.json, &answer.document) {
        io::write_json(&args.scene, path, document)?;
    }
    if let Some(failure) = answer.failure {
        // Without a pose there is nothing to draw or to list.
        let drawn = [
            ("--csv", &args.csv),
            ("--plot", &args.plot),
            ("--render", &args.render),
        ];
        let drawn = drawn
            .into_iter()
            .chain([("--matrix", &args.matrix), ("--swept", &args.swept)]);
        for (option, path) in drawn {
            if let Some(path) = path {
                term.note(&format!(
                    "note: {option} {} was not written",
                    path.display()
                ));
            }
        }
        return Err(failure);
    }
    let streamed =
        files::streamed_report(args).or(args.csv.as_deref().filter(|path| *path == Path::new("-")));
    io::print_beside(term, streamed, &answer.text)?;
    if answer.verdict.result_of(PROOF) == Status::NotProved {
        let easier = match search_deadline().is_over() {
            true => "more time in --limits makes proofs possible",
            false => "more --samples make proofs easier",
        };
        term.note(&format!(
            "hint: the check fails if a proof fails; {easier}, --certify none requests none"
        ));
    }
    Ok(answer.verdict.result().into())
}
