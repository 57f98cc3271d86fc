//! `mechanim synthesise`: dimensions found from many starts, proved, reported, and written as scenes.

use super::found_files::target_files;
use super::target::{run_target, search_plan};
use crate::analysis::study::{DefaultVariables, FamilyError, LoadedStudy};
use crate::analysis::synthesis::touching::Touching;
use crate::analysis::synthesis::verify::{Proof, prove_found};
use crate::analysis::synthesis::{FinishedStart, Listener, Synthesis, synthesise_path};
use crate::cli::args::scene::SceneArgs;
use crate::cli::args::study::{SynthesiseArgs, VaryArgs};
use crate::cli::interrupt::{is_interrupted, save_results, unless_interrupted};
use crate::cli::io;
use crate::cli::open::study::open_search;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::diag::Source;
use crate::diag::name_hint;
use crate::report::cells::six_digits;
use crate::report::requirement::{Requirement, simplest_of, simplest_text};
use crate::report::synthesis::{FoundMechanism, restart_ladder, synthesis_text};
use crate::report::synthesis_document::{found_rows, synthesis_document};
use crate::scene::Overrides;
use crate::scene::edit::with_values;
use std::ffi::OsStr;
use std::path::PathBuf;

/// Runs the verb.
pub fn run_synthesise(args: &SynthesiseArgs, term: &Term) -> Result<Outcome, Failure> {
    let scenes: Vec<SceneArgs> = args.scenes.iter().map(|s| scene_args(args, s)).collect();
    if let Some(table) = &args.target {
        let [scene] = scenes.as_slice() else {
            let message = "--target takes one scene";
            return Err(Failure::usage(message, Vec::new()));
        };
        return run_target(args, scene, table, term);
    }
    let mut opened = Vec::new();
    for scene in &scenes {
        let vary = VaryArgs { vary: Vec::new() };
        opened.push(open_search(
            scene,
            &vary,
            (DefaultVariables::OfStudy, args.minimise.as_deref()),
            term,
        )?);
    }
    refuse_unknown(args, &opened)?;
    let targets = target_files(args)?;
    let mut reports = vec![
        ("--json", args.json.as_deref()),
        ("--csv", args.csv.as_deref()),
    ];
    reports.extend(targets.iter().map(|path| ("--out", Some(path.as_path()))));
    io::refuse_clashes(&scenes.iter().collect::<Vec<_>>(), &reports)?;
    let mut found = Vec::new();
    for ((opened, scene), name) in opened.iter().zip(&scenes).zip(&args.scenes) {
        if is_interrupted() {
            break;
        }
        let name = name.to_string_lossy();
        term.note(&format!("{name}:"));
        let one = synthesise_one(args, opened, &name, term)?;
        if let Some(out) = targets.get(found.len()) {
            let out = io::unless_complete(out, !is_interrupted());
            io::write_text(scene, &out, &one.scene)?;
        }
        found.push(one);
    }
    let stopped = is_interrupted();
    if let Some(path) = &args.json {
        io::write_document(
            &io::unless_complete(path, !stopped),
            &synthesis_document(&found, &args.demands),
        )?;
    }
    if let Some(path) = &args.csv
        && let Some(scene) = scenes.first()
    {
        io::write_text(
            scene,
            &io::unless_complete(path, !stopped),
            &found_rows(&found),
        )?;
    }
    let mut report: String = found.iter().map(synthesis_text).collect();
    if found.len() > 1 {
        report.push_str(&restart_ladder(&found));
    }
    if !args.demands.is_empty() {
        report.push_str(&simplest_text(&found, &args.demands));
    }
    let reports = [&args.json, &args.csv].into_iter().flatten();
    io::print_beside(term, reports.map(PathBuf::as_path), &report)?;
    if stopped {
        return Err(Failure::best_so_far(None));
    }
    // The demands determine the exit code; without a demand every mechanism must be proved.
    let is_answered = match args.demands.is_empty() {
        true => found.iter().all(FoundMechanism::holds),
        false => simplest_of(&found, &args.demands).is_some(),
    };
    Ok(if is_answered {
        Outcome::Done
    } else {
        Outcome::CheckFailed
    })
}

/// A demand on a measure that the scene does not have is a mistake.
fn refuse_unknown(args: &SynthesiseArgs, opened: &[LoadedStudy]) -> Result<(), Failure> {
    let lists = opened.iter().flat_map(|one| &one.family.measures.list);
    let mut known: Vec<&str> = lists.map(|measure| measure.name.as_str()).collect();
    known.sort_unstable();
    known.dedup();
    let unknown = |demand: &&Requirement| !known.contains(&demand.measure.as_str());
    match args.demands.iter().find(unknown) {
        None => Ok(()),
        Some(demand) => Err(Failure::usage(
            format!("--require: there is no measure `{}`", demand.measure),
            vec![name_hint(&demand.measure, known)],
        )),
    }
}

fn scene_args(args: &SynthesiseArgs, scene: &OsStr) -> SceneArgs {
    SceneArgs {
        scene: scene.to_owned(),
        parameters: args.parameters.clone(),
        inputs: Vec::new(),
        guess: Vec::new(),
        table: None,
        allowed: Vec::new(),
        mode: None,
    }
}

fn synthesise_one<'a>(
    args: &SynthesiseArgs,
    opened: &'a LoadedStudy,
    name: &str,
    term: &Term,
) -> Result<FoundMechanism<'a>, Failure> {
    let plan = search_plan(args, args.iterations);
    let parameters = |x: &[f64]| opened.parameters(x);
    let touching = Touching {
        source: &opened.source,
        overrides: &opened.overrides,
        parameters: &parameters,
    };
    let unit = opened.objective_unit();
    let done = |index: usize, start: &FinishedStart| {
        // From here on the best result so far is worth saving.
        save_results(true);
        let from = start.origin.words();
        let (first, last) = (
            six_digits(start.first * unit),
            six_digits(start.value() * unit),
        );
        // Behind the starts come the best of them, once more.
        let what = match index < plan.starts {
            true => format!("start {}, {from}", index + 1),
            false => "polished".to_owned(),
        };
        term.note(&format!("  {what}: {first} to {last}"));
    };
    let own = own_measures(opened)?;
    let goes_on = || !is_interrupted();
    let listener = Listener {
        done: &done,
        goes_on: &goes_on,
    };
    let synthesis = match synthesise_path(&opened.family, touching, plan, &listener) {
        Err(_) if is_interrupted() => return Err(Failure::Interrupted),
        found => found?,
    };
    let (overrides, scene) = write_found(opened, &synthesis)?;
    let proof = prove_scene(&opened.source, &overrides);
    Ok(FoundMechanism {
        name: name.to_owned(),
        family: &opened.family,
        seed: args.seed,
        synthesis,
        own,
        proof,
        scene,
    })
}

/// The proof, unless Ctrl-C comes first.
fn prove_scene(source: &Source, overrides: &Overrides) -> Result<Proof, FamilyError> {
    let (text, values) = (source.clone(), overrides.clone());
    let unproved = || {
        Err(FamilyError::Lacks(
            "interrupted before the proof".to_owned(),
        ))
    };
    unless_interrupted(move || prove_found(&text, &values)).unwrap_or_else(unproved)
}

/// The values found as overrides of the scene, and as the text of a scene of its own.
fn write_found(
    opened: &LoadedStudy,
    synthesis: &Synthesis,
) -> Result<(Overrides, String), Failure> {
    let parameters = opened.parameters(&synthesis.best);
    let unknowns = &opened.family.mechanism().unknowns;
    let guess: Vec<(String, String)> = match &synthesis.unknowns {
        None => Vec::new(),
        Some(values) => unknowns
            .iter()
            .zip(values)
            .map(|(u, value)| (u.name.clone(), opened.family.file_text(u.kind, *value)))
            .collect(),
    };
    let text = with_values(&opened.source, &parameters, &guess)?;
    let overrides = Overrides {
        parameters,
        guess,
        ..opened.overrides.clone()
    };
    Ok((overrides, text))
}

/// Measures at the scene's own values.
fn own_measures(opened: &LoadedStudy) -> Result<Vec<f64>, FamilyError> {
    let family = &opened.family;
    let mut evaluator = crate::analysis::study::Evaluator::new(family);
    let track_poses = evaluator.nominal(family.nominal()?.poses);
    let measured = evaluator.measure(&track_poses);
    let measured = measured.map_err(|refusal| FamilyError::Lacks(refusal.to_string()))?;
    Ok(measured.measures)
}
