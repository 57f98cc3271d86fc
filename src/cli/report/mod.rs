//! `mechanim report`: what `check` and `solve` know of scenes, as one HTML file.

use super::args::report::ReportArgs;
use super::args::scene::SceneArgs;
use super::check::motion::{asked_times, motion_check};
use super::interrupt::{is_interrupted, refuse_interrupted};
use super::io;
use super::motion::event_messages;
use super::open::patterns::scenes_of;
use super::open::scene::{OpenScene, open_scene};
use super::term::Term;
use super::term::outcome::{Failure, Outcome};
use crate::kinematics::structure::block::StructureError;
use crate::page::{Article, Checked, article_of, article_without_motion, page_text};
use crate::report::closure;
use crate::report::sentences::counted_things;
use crate::report::verdict::Verdict;
use std::path::Path;
use std::time::Instant;

/// Runs the verb.
pub fn run_report(args: &ReportArgs, term: &Term) -> Result<Outcome, Failure> {
    refuse_other_formats(&args.out)?;
    let scenes = scenes_of(&args.scene, &args.more)?;
    for scene in &scenes {
        io::refuse_input(scene, &args.out)?;
    }
    let (mut articles, mut outcome, mut failed) = (Vec::new(), Outcome::Done, None);
    for (index, scene) in scenes.iter().enumerate() {
        let (article, end) = judge(args, scene, index + 1, term)?;
        articles.push(article);
        match end {
            Ok(end) => outcome = outcome.worse(end),
            Err(failure) => failed = failed.or(Some(failure)),
        }
    }
    let title = counted_things(articles.len(), "mechanism");
    let text = page_text(&title, &articles);
    io::write_text(&args.scene, &args.out, &text)?;
    if args.out != Path::new("-") {
        let size = text.len() as f64 / 1e3;
        term.note(&format!("{}: {title}, {size:.0} kB", args.out.display()));
    }
    // The page says why there is no motion, and so does the exit code.
    match failed {
        Some(failure) => Err(failure),
        None => Ok(outcome),
    }
}

/// Judges a scene as `check` does. The second value is what `check` would end with.
fn judge(
    args: &ReportArgs,
    scene: &SceneArgs,
    number: usize,
    term: &Term,
) -> Result<(Article, Result<Outcome, Failure>), Failure> {
    let source = scene.scene.to_string_lossy();
    let opened = match open_scene(scene, term) {
        Err(failure @ Failure::Structure(StructureError::Impossible { .. })) => {
            let verdict = Verdict {
                title: source.clone().into_owned(),
                cases: vec![closure::unclosed_case(&failure.to_string())],
            };
            return Ok((article_without_motion(&source, &verdict), Err(failure)));
        }
        opened => opened?,
    };
    let OpenScene {
        scene: read,
        system,
    } = &opened;
    let times = asked_times(&args.asked, scene, read);
    let check = motion_check(&args.asked, &opened, &times, false);
    let begun = Instant::now();
    let mut trajectory = check.solve(&is_interrupted)?;
    refuse_interrupted()?;
    let seconds = begun.elapsed().as_secs_f64();
    event_messages::note_moved_start(system, &read.actuation, &mut trajectory)?;
    if let Err(failure) = event_messages::tell_events(system, &read.actuation, &trajectory, term) {
        let answer = check.without_pose(&trajectory, Some(&failure.to_string()));
        return Ok((
            article_without_motion(&source, &answer.verdict),
            Err(failure),
        ));
    }
    let mut covered = check.cover(&trajectory);
    let clearances = check.clearances(&mut covered, &|_, _| {})?;
    let answer = check.answer(&trajectory, &mut covered, clearances.as_ref(), seconds);
    let checked = Checked {
        source: &source,
        scene: read,
        system,
        trajectory: &trajectory,
        clearances: clearances.as_ref(),
        answer: &answer,
    };
    let article = article_of(&checked, number)?;
    Ok((article, Ok(answer.verdict.result().into())))
}

fn refuse_other_formats(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().and_then(|e| e.to_str());
    let is_page =
        extension.is_some_and(|e| ["html", "htm"].contains(&e.to_ascii_lowercase().as_str()));
    match is_page || path == Path::new("-") {
        true => Ok(()),
        false => Err(Failure::usage(
            format!("`{}` is no .html file", path.display()),
            vec!["name the page: --out report.html".to_owned()],
        )),
    }
}
