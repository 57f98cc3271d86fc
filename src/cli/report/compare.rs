//! `mechanim compare`: two versions of a scene on one page.

use super::judged::{JudgedScene, judge};
use super::refuse_other_formats;
use crate::cli::args::report::CompareArgs;
use crate::cli::args::scene::SceneArgs;
use crate::cli::io;
use crate::cli::open::scene::text_of;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::diag::Diagnostics;
use crate::page::{Version, comparison_text};
use crate::scene::file::read_scene;

/// Runs the verb. Its exit code is that of `check` for the new version.
pub fn run_compare(args: &CompareArgs, term: &Term) -> Result<Outcome, Failure> {
    refuse_other_formats(&args.out)?;
    let old = SceneArgs {
        scene: args.old.clone(),
        ..args.new.clone()
    };
    let scenes = [&old, &args.new];
    for scene in scenes {
        io::refuse_input(scene, &args.out)?;
    }
    let parameters = [written_parameters(&old)?, written_parameters(&args.new)?];
    let judged = [
        judge(&args.asked, &old, term)?,
        judge(&args.asked, &args.new, term)?,
    ];
    let checked = [judged[0].checked(), judged[1].checked()];
    let version = |k: usize| Version {
        source: &judged[k].source,
        verdict: judged[k].verdict(),
        checked: checked[k].as_ref(),
        parameters: &parameters[k],
    };
    let text = comparison_text(version(0), version(1))?;
    io::write_text(&args.new, &args.out, &text)?;
    let [before, after] = [&judged[0], &judged[1]].map(|j: &JudgedScene| j.verdict().sentence());
    term.note(&format!("old: {before}; new: {after}"));
    let [_, new] = judged;
    new.end
}

/// The parameters of a scene, as in its text or as replaced.
fn written_parameters(scene: &SceneArgs) -> Result<Vec<(String, String)>, Failure> {
    let (source, overrides) = text_of(scene)?;
    let file = read_scene(&source, &mut Diagnostics::default());
    let own = file.parameters.into_iter();
    let mut list: Vec<(String, String)> = own.map(|(n, f)| (n.value, f.text)).collect();
    for (name, text) in &mut list {
        if let Some((_, put)) = overrides.parameters.iter().find(|(n, _)| n == name) {
            text.clone_from(put);
        }
    }
    Ok(list)
}
