//! `mechanim report`: the results of `check` and `solve` for scenes, as one HTML file.

pub mod compare;
mod engine;
mod judged;
pub mod site;

use super::args::motion::RequirementArgs;
use super::args::report::ReportArgs;
use super::args::scene::SceneArgs;
use super::check::motion::{asked_questions, nearness};
use super::io;
use super::open::patterns::scenes_of;
use super::open::scene::text_of;
use super::term::Term;
use super::term::outcome::{Failure, Outcome};
use crate::page::live::{LiveRequirements, LiveStart};
use crate::page::{Article, article_of, article_without_motion, page_text};
use crate::report::sentences::counted_things;
use engine::{find_engine, refuse_files};
use judged::judge;
use std::path::Path;

/// Runs the verb.
pub fn run_report(args: &ReportArgs, term: &Term) -> Result<Outcome, Failure> {
    refuse_other_formats(&args.out)?;
    let scenes = scenes_of(&args.scene, &args.more)?;
    for scene in &scenes {
        io::refuse_input(scene, &args.out)?;
    }
    let engine = args.live.then(|| find_engine(args.wasm.as_deref()));
    let engine = engine.transpose()?;
    let (mut articles, mut outcome, mut failed) = (Vec::new(), Outcome::Done, None);
    let live = if args.live { Live::Surely } else { Live::Not };
    for (index, scene) in scenes.iter().enumerate() {
        let written = scene_article(&args.asked, scene, (index + 1, live), term)?;
        articles.push(written.article);
        match written.end {
            Ok(end) => outcome = outcome.worse(end),
            Err(failure) => failed = failed.or(Some(failure)),
        }
    }
    let title = counted_things(articles.len(), "mechanism");
    let text = page_text(&title, &articles, engine.as_ref());
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

/// Whether pages are live.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Live {
    /// None of them is.
    Not,
    /// All are; a scene that cannot be live is refused.
    Surely,
    /// Those that can be.
    WherePossible,
}

/// A scene's article.
struct Written {
    article: Article,
    description: String,
    /// The exit code of `check`.
    end: Result<Outcome, Failure>,
}

/// The article of scene `number` of its page.
fn scene_article(
    asked: &RequirementArgs,
    scene: &SceneArgs,
    (number, live): (usize, Live),
    term: &Term,
) -> Result<Written, Failure> {
    let judged = judge(asked, scene, term)?;
    let Some(checked) = judged.checked() else {
        return Ok(Written {
            article: article_without_motion(&judged.source, judged.verdict()),
            description: String::new(),
            end: judged.end,
        });
    };
    let mut article = article_of(&checked, number)?;
    match (live, refuse_files(scene, checked.scene)) {
        (Live::Surely, Err(failure)) => return Err(failure),
        (Live::Not, _) | (Live::WherePossible, Err(_)) => {}
        (Live::Surely | Live::WherePossible, Ok(())) => {
            enliven_article(&mut article, asked, scene)?
        }
    }
    let description = checked.scene.description.clone();
    Ok(Written {
        article,
        description,
        end: judged.end,
    })
}

/// Lets the reader of an article move its mechanism.
fn enliven_article(
    article: &mut Article,
    asked: &RequirementArgs,
    scene: &SceneArgs,
) -> Result<(), Failure> {
    let (source, overrides) = text_of(scene)?;
    let stem = Path::new(&scene.scene).file_stem().and_then(|s| s.to_str());
    article.enliven(&LiveStart {
        source: &source,
        overrides: &overrides,
        asked: LiveRequirements {
            asked: asked_questions(asked),
            closely: nearness(asked),
            samples: asked.samples,
        },
        file: stem.filter(|s| *s != "-").unwrap_or("scene"),
    });
    Ok(())
}

pub(super) fn refuse_other_formats(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().and_then(|e| e.to_str());
    let is_page =
        extension.is_some_and(|e| ["html", "htm"].contains(&e.to_ascii_lowercase().as_str()));
    match is_page || path == Path::new("-") {
        true => Ok(()),
        false => Err(Failure::usage(
            format!("`{}` is not an .html file", path.display()),
            vec!["name the page: --out report.html".to_owned()],
        )),
    }
}
