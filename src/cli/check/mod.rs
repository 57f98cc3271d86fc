//! `mechanim check`: do all loops close over the motion, is an offered pose a closed one, and is all that was asked for
//! so. Exit code, text, JSON and JUnit follow from one verdict.

mod answer;
mod clearance;
mod inputs_box;
mod motion;
mod pose;
mod swept;

use super::args::motion::CheckArgs;
use super::open::scene as open_scene;
use super::term::Term;
use super::term::outcome::{Failure, Outcome};
use crate::cli::io;
use crate::kinematics::structure::block::StructureError;
use crate::report::junit::to_junit;
use crate::report::verdict::{PROOF, Status};
use answer::Answer;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Runs the verb.
pub fn run_check(args: &CheckArgs, term: &Term) -> Result<Outcome, Failure> {
    if !(args.closure > 0.0 && args.closure.is_finite()) {
        return Err(Failure::usage(
            "the largest closure error must be a positive number",
            Vec::new(),
        ));
    }
    let reports = [
        ("--json", args.json.as_deref()),
        ("--junit", args.junit.as_deref()),
        ("--csv", args.csv.as_deref()),
        ("--plot", args.plot.as_deref()),
        ("--render", args.render.as_deref()),
    ];
    io::refuse_clashes(&[&args.scene], &reports)?;
    let begun = Instant::now();
    let answer = match open_scene::open_scene(&args.scene, term) {
        Err(failure @ Failure::Structure(StructureError::Impossible { .. })) => {
            Answer::closes_nowhere(&args.scene.scene.to_string_lossy(), failure)
        }
        Err(failure) => return Err(failure),
        Ok(opened) if !args.inputs_box.is_empty() => inputs_box::check(args, &opened)?,
        Ok(opened) if args.pose.is_empty() => motion::check_motion(args, &opened, term)?,
        Ok(opened) => pose::check_pose(args, &opened.scene)?,
    };
    let seconds = begun.elapsed().as_secs_f64();
    if let Some(path) = &args.junit {
        io::write_text(&args.scene, path, &to_junit(&answer.verdict, seconds))?;
    }
    if let (Some(path), Some(document)) = (&args.json, &answer.document) {
        io::write_json(&args.scene, path, document)?;
    }
    if let Some(failure) = answer.failure {
        return Err(failure);
    }
    let files = [&args.json, &args.junit, &args.csv];
    let streamed = files
        .into_iter()
        .flatten()
        .find(|path| *path == Path::new("-"));
    io::print_beside(term, streamed.map(PathBuf::as_path), &answer.text)?;
    if answer.verdict.result_of(PROOF) == Status::NotProved {
        term.note("hint: a proof that is asked for and refused fails the check; --certify none asks for none");
    }
    Ok(answer.verdict.result().into())
}
