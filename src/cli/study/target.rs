//! `mechanim synthesise --target`: the mechanism that does what a table requires, searched from many starts and solved
//! afresh.

use super::found_files::target_files;
use crate::analysis::study::{FamilyError, ParametricMechanism};
use crate::analysis::synthesis::target::{
    StartResult, TargetSearch, TargetSynthesis, fit_target, verify_target,
};
use crate::analysis::synthesis::verify::prove_found;
use crate::analysis::synthesis::{From, SearchPlan};
use crate::cli::args::scene::SceneArgs;
use crate::cli::args::study::{StartsFrom, SynthesiseArgs};
use crate::cli::interrupt::{is_interrupted, save_results};
use crate::cli::io;
use crate::cli::open::study::nominal_source;
use crate::cli::open::target_table::read_target;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::diag::Source;
use crate::jobs::core_count;
use crate::report::cells::six_digits;
use crate::report::target::{FoundTarget, target_document, target_text};
use crate::scene::edit::with_values;
use crate::scene::{KeptIn, Overrides};
use std::path::Path;

/// Default number of iterations from one start: a fit ends by itself.
const ITERATIONS: usize = 200;

/// Runs the verb with a table.
pub fn run_target(
    args: &SynthesiseArgs,
    scene: &SceneArgs,
    table: &Path,
    term: &Term,
) -> Result<Outcome, Failure> {
    let out = target_files(args)?.pop();
    let reports = [("--json", args.json.as_deref()), ("--out", out.as_deref())];
    io::refuse_clashes(&[scene], &reports)?;
    let (source, overrides, drawn) = nominal_source(scene, term)?;
    let study = drawn.study.iter().flat_map(|s| &s.variables);
    let names: Vec<String> = match args.vary.vary.as_slice() {
        [] => study.map(|v| v.name.clone()).collect(),
        [all] if all == "all" => drawn.dimensions.to_vec(),
        named => named.to_vec(),
    };
    if names.is_empty() {
        return Err(FamilyError::nothing_to_vary(&drawn.dimensions).into());
    }
    let mut family = ParametricMechanism::varying(&source, &overrides, &names)?;
    refuse_driven(&family)?;
    if let Some(share) = args.within {
        family.free_within(share);
    }
    let driven = (family.mechanism(), &family.actuation);
    let target = read_target(table, driven, family.own_inputs())?;
    let done = |index: usize, tried: &StartResult| {
        save_results(true);
        let [first, last] = [tried.first, tried.sum].map(six_digits);
        let from = tried.origin.words();
        term.note(&format!("  start {}, {from}: {first} to {last}", index + 1));
    };
    let search = TargetSearch {
        family: &family,
        target: &target,
        plan: search_plan(args, args.iterations.max(ITERATIONS)),
        goes_on: &|| !is_interrupted(),
        done: &done,
    };
    let synthesis = match fit_target(&search) {
        Err(_) if is_interrupted() => return Err(Failure::Interrupted),
        found => found?,
    };
    let is_whole = !is_interrupted();
    let (found, text) = write_found(&family, &synthesis, (&source, &overrides))?;
    let begins = synthesis.unknowns.is_some();
    let rows = verify_target((&source, &found), &target, &synthesis.fit, begins)?;
    let proof = prove_found(&source, &found);
    let out = out.map(|path| io::unless_complete(&path, is_whole));
    if let Some(path) = &out {
        io::write_text(scene, path, &text)?;
    }
    let answer = FoundTarget {
        family: &family,
        target: &target,
        seed: args.seed,
        synthesis,
        rows,
        proof,
    };
    if let Some(path) = &args.json {
        let path = io::unless_complete(path, is_whole);
        io::write_document(&path, &target_document(&answer))?;
    }
    io::print_beside(term, args.json.as_deref(), &target_text(&answer))?;
    if !is_whole {
        return Err(Failure::best_so_far(out.as_deref()));
    }
    Ok(match answer.rows.holds() {
        true => Outcome::Done,
        false => Outcome::CheckFailed,
    })
}

/// The effort of a search, and its starts.
pub fn search_plan(args: &SynthesiseArgs, iterations: usize) -> SearchPlan {
    SearchPlan {
        starts: args.starts,
        seed: args.seed,
        iterations,
        limit: args.time,
        from: match args.from {
            StartsFrom::Everywhere => From::Everywhere,
            StartsFrom::Scene => From::Scene,
            StartsFrom::Random => From::Random,
        },
        threads: args.threads.unwrap_or_else(core_count),
    }
}

/// A drive or the axis of a rotation keeps the file's values.
fn refuse_driven(family: &ParametricMechanism) -> Result<(), Failure> {
    let is_lost = |place: KeptIn| matches!(place, KeptIn::Drive | KeptIn::Direction);
    match family.kept.iter().find(|kept| is_lost(kept.place)) {
        None => Ok(()),
        Some(kept) => Err(FamilyError::Kept(kept.clone()).into()),
    }
}

/// The values found as overrides of the scene, and as the text of a scene of its own.
fn write_found(
    family: &ParametricMechanism,
    synthesis: &TargetSynthesis,
    (source, overrides): (&Source, &Overrides),
) -> Result<(Overrides, String), Failure> {
    let variables = family.study.variables.iter().zip(&synthesis.fit.x);
    let parameters: Vec<(String, String)> = variables
        .map(|(v, x)| (v.name.clone(), family.variable_text(v, *x)))
        .collect();
    let mechanism = family.mechanism();
    let first = synthesis
        .fit
        .poses
        .first()
        .map(|pose| &pose[..mechanism.unknowns.len()]);
    let start = synthesis.unknowns.as_deref().or(first).unwrap_or_default();
    let guess: Vec<(String, String)> = mechanism
        .unknowns
        .iter()
        .zip(start)
        .map(|(u, value)| (u.name.clone(), family.file_text(u.kind, *value)))
        .collect();
    let scene = with_values(source, &parameters, &guess)?;
    let mut all = overrides.parameters.clone();
    all.retain(|(name, _)| !parameters.iter().any(|(n, _)| n == name));
    all.extend(parameters);
    let overrides = Overrides {
        parameters: all,
        guess,
        ..overrides.clone()
    };
    Ok((overrides, scene))
}
