//! `mechanim check` of several scenes in one run: each as alone, one summary, the worst exit code.

use super::answer::CheckAnswer;
use super::files;
use super::judge::judge;
use crate::cli::args::motion::CheckArgs;
use crate::cli::args::scene::SceneArgs;
use crate::cli::io;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::jobs::{core_count, share_work};
use crate::report::verdict::{SceneVerdict, Status, Verdict};
use serde_json::{Value, json};
use std::time::Instant;

/// Result of one scene.
struct CheckedScene {
    scene: String,
    seconds: f64,
    found: Result<CheckAnswer, Failure>,
    /// Messages printed meanwhile.
    said: Term,
}

impl CheckedScene {
    /// The scene's verdict; for a scene that could not be checked, a verdict that states this.
    fn verdict(&self) -> Verdict {
        match &self.found {
            Ok(answer) => answer.verdict.clone(),
            Err(failure) => Verdict::unreadable(&self.scene, failure.told(), failure.line()),
        }
    }

    /// The exit code of `check` for this scene alone.
    fn code(&self) -> i32 {
        match &self.found {
            Ok(CheckAnswer {
                failure: Some(failure),
                ..
            })
            | Err(failure) => failure.code(),
            Ok(answer) => Outcome::from(answer.verdict.result()).code(),
        }
    }

    fn outcome(&self) -> Option<Outcome> {
        let all = [Outcome::Done, Outcome::CheckFailed, Outcome::NotClosed];
        all.into_iter()
            .find(|outcome| outcome.code() == self.code())
    }

    fn document(&self) -> Value {
        let (document, error) = match &self.found {
            Ok(answer) => (answer.document.clone(), None),
            Err(failure) => (None, Some(failure.told())),
        };
        json!({
            "scene": self.scene,
            "exit_code": self.code(),
            "report": document,
            "error": error,
        })
    }
}

/// Checks all of them on several threads, and reports in the order of the command line.
pub fn check_many(args: &CheckArgs, scenes: &[SceneArgs], term: &Term) -> Result<Outcome, Failure> {
    refuse_single(args)?;
    let list: Vec<&SceneArgs> = scenes.iter().collect();
    io::refuse_clashes(&list, &files::verdict_files(args))?;
    let threads = args.jobs.unwrap_or_else(core_count);
    let check = |_: &mut (), k: usize| Some(check_one(args, &scenes[k], term));
    let all = share_work(scenes.len(), threads, || (), check);
    let mut checked = Vec::new();
    for (_, one) in all {
        if let Err(failure @ (Failure::Interrupted | Failure::Internal(_))) = one.found {
            return Err(failure);
        }
        checked.push(one);
    }
    write_reports(args, &checked)?;
    for one in &checked {
        one.said.pass_on(term);
        let failure = match &one.found {
            Ok(answer) => answer.failure.as_ref(),
            Err(failure) => Some(failure),
        };
        if let Some(failure) = failure {
            term.note(&format!("{}:", one.scene));
            term.failure(failure);
        }
    }
    io::print_beside(
        term,
        files::streamed_report(args),
        &joined_reports(&checked),
    )?;
    worst_outcome(&checked)
}

/// Checks one scene; its messages are stored, so that those of several scenes are not interleaved.
fn check_one(args: &CheckArgs, scene: &SceneArgs, term: &Term) -> CheckedScene {
    let own = CheckArgs {
        scene: scene.clone(),
        ..args.clone()
    };
    let said = term.kept_back();
    let begun = Instant::now();
    let found = judge(&own, &said);
    CheckedScene {
        scene: scene.scene.to_string_lossy().into_owned(),
        seconds: begun.elapsed().as_secs_f64(),
        found,
        said,
    }
}

/// The reports of all scenes, then a line for each.
fn joined_reports(checked: &[CheckedScene]) -> String {
    let reports = checked.iter().filter_map(|one| one.found.as_ref().ok());
    let mut text: String = reports.map(|answer| answer.text.clone()).collect();
    text.push_str(&format!("{} scenes\n", checked.len()));
    let width = checked
        .iter()
        .map(|one| one.scene.chars().count())
        .max()
        .unwrap_or(0);
    for one in checked {
        let result = match &one.found {
            Ok(answer) => answer.verdict.sentence(),
            Err(_) => Status::Unreadable.word().to_owned(),
        };
        text.push_str(&format!("  {:<width$}  {result}\n", one.scene));
    }
    text
}

fn write_reports(args: &CheckArgs, checked: &[CheckedScene]) -> Result<(), Failure> {
    let verdicts: Vec<Verdict> = checked.iter().map(CheckedScene::verdict).collect();
    let judged: Vec<SceneVerdict> = checked
        .iter()
        .zip(&verdicts)
        .map(|(one, verdict)| SceneVerdict {
            source: &one.scene,
            verdict,
            seconds: one.seconds,
        })
        .collect();
    files::write_verdicts(args, &judged)?;
    if let Some(path) = &args.json {
        let codes = checked.iter().map(CheckedScene::code);
        let passed = codes.filter(|code| *code == 0).count();
        let document = json!({
            "schema": "mechanim-checks/1",
            "passed": passed,
            "scenes": checked.iter().map(CheckedScene::document).collect::<Vec<_>>(),
        });
        io::write_json(&args.scene, path, &document)?;
    }
    Ok(())
}

/// The worst result: a scene that cannot be checked before one that does not close, and that before one that fails.
fn worst_outcome(checked: &[CheckedScene]) -> Result<Outcome, Failure> {
    let outcomes: Vec<Option<Outcome>> = checked.iter().map(CheckedScene::outcome).collect();
    let unreadable = outcomes.iter().filter(|outcome| outcome.is_none()).count();
    if unreadable > 0 {
        let message = format!(
            "{unreadable} of {} scenes could not be checked",
            checked.len()
        );
        return Err(Failure::usage(message, Vec::new()));
    }
    Ok(outcomes
        .into_iter()
        .flatten()
        .fold(Outcome::Done, Outcome::worse))
}

/// Refuses options that apply to a single scene.
fn refuse_single(args: &CheckArgs) -> Result<(), Failure> {
    let asked = [
        ("--csv", args.csv.is_some()),
        ("--plot", args.plot.is_some()),
        ("--render", args.render.is_some()),
        ("--matrix", args.matrix.is_some()),
        ("--swept", args.swept.is_some()),
        ("--pose", !args.pose.is_empty()),
        ("--inputs-box", !args.inputs_box.is_empty()),
    ];
    match asked.into_iter().find(|(_, is_asked)| *is_asked) {
        None => Ok(()),
        Some((option, _)) => Err(Failure::usage(
            format!("{option} works on a single scene, and there are several"),
            vec!["check them one by one, or write one page for all: mechanim report".to_owned()],
        )),
    }
}
