//! `mechanim optimise --pairs`: optimises every pair of dimensions on its own, and ranks the pairs.

use crate::analysis::optimise::Minimum;
use crate::analysis::study::optimum::{Optimum, Verified, find_optimum, verify_optimum};
use crate::analysis::study::whole_limits::WholeLimit;
use crate::analysis::study::{FamilyError, KEPT, LoadedStudy, ParametricMechanism};
use crate::cli::args::study::OptimiseArgs;
use crate::cli::interrupt::{CANCEL, save_results};
use crate::cli::io;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::cli::term::progress::Progress;
use crate::jobs::{core_count, share_watched};
use crate::report::cells::{aligned_rows, six_digits};
use crate::report::optimum::{SCHEMA, ending_word};
use crate::report::sentences::counted_things;
use crate::sorting::sort_by;
use serde_json::{Value, json};
use std::sync::atomic::Ordering;
use std::time::Instant;

/// One pair of variables with its optimum.
struct Pair {
    names: [String; 2],
    found: Result<PairOptimum, FamilyError>,
}

/// The optimum of two variables, solved again.
struct PairOptimum {
    optimum: Optimum,
    verified: Verified,
}

impl PairOptimum {
    /// Whether all limits are kept, over the whole motion as well.
    fn keeps_limits(&self) -> bool {
        self.verified.violation <= KEPT && self.verified.whole.iter().all(WholeLimit::is_kept)
    }
}

/// Runs all pairs; after an interrupt the finished ones are ranked.
pub fn run_pairs(
    args: &OptimiseArgs,
    study: &LoadedStudy,
    term: &Term,
) -> Result<Outcome, Failure> {
    let variables = &study.family.study.variables;
    let mut jobs = Vec::new();
    for (k, a) in variables.iter().enumerate() {
        jobs.extend(
            variables[k + 1..]
                .iter()
                .map(|b| [a.name.clone(), b.name.clone()]),
        );
    }
    if jobs.is_empty() {
        return Err(Failure::usage(
            "pairs need at least two variables",
            Vec::new(),
        ));
    }
    let start = Instant::now();
    let progress = Progress::new(args.progress, term.quiet()).counting("pairs");
    let threads = args.threads.unwrap_or_else(core_count);
    let one = |_: &mut (), index: usize| {
        if CANCEL.load(Ordering::Relaxed) {
            return None;
        }
        let names = jobs[index].clone();
        let found = optimise_pair(args, study, &names);
        // An interrupted search does not give the optimum of the pair.
        if CANCEL.load(Ordering::Relaxed) {
            return None;
        }
        // From here on there is a ranking to save.
        save_results(true);
        Some(Pair { names, found })
    };
    let watch = |done| progress.show(done, jobs.len());
    let mut done = share_watched(jobs.len(), threads, || (), one, &watch);
    progress.end();
    if done.is_empty() {
        return Err(Failure::Interrupted);
    }
    // Those that keep all limits first.
    let rank = |p: &Pair| match &p.found {
        Ok(found) => (!found.keeps_limits(), found.optimum.minimum.value),
        Err(_) => (true, f64::INFINITY),
    };
    sort_by(&mut done, |(i, a), (j, b)| {
        let ((missed, value), (other_missed, other)) = (rank(a), rank(b));
        let by_value = value.total_cmp(&other).then(i.cmp(j));
        missed.cmp(&other_missed).then(by_value)
    });
    let ranked: Vec<Pair> = done.into_iter().map(|(_, pair)| pair).collect();
    let seconds = start.elapsed().as_secs_f64();
    if let Some(path) = &args.json {
        let rows: Vec<Value> = ranked.iter().map(|p| pair_document(study, p)).collect();
        let document = json!({
            "schema": format!("mechanim-pairs/{SCHEMA}"),
            "title": study.family.mechanism().title,
            "complete": ranked.len() == jobs.len(),
            "pairs": rows,
        });
        let path = io::unless_complete(path, ranked.len() == jobs.len());
        io::write_json(&args.scene, &path, &document)?;
    }
    io::print_beside(
        term,
        args.json.as_deref(),
        &pair_ranking(study, &ranked, args.rows, seconds),
    )?;
    if ranked.len() < jobs.len() {
        let kept = format!(
            "the ranking contains {} of {} pairs",
            ranked.len(),
            jobs.len()
        );
        return Err(Failure::Stopped(kept));
    }
    let keeps = |pair: &Pair| pair.found.as_ref().is_ok_and(PairOptimum::keeps_limits);
    match ranked.iter().any(keeps) {
        true => Ok(Outcome::Done),
        false => Ok(Outcome::CheckFailed),
    }
}

fn optimise_pair(
    args: &OptimiseArgs,
    study: &LoadedStudy,
    names: &[String; 2],
) -> Result<PairOptimum, FamilyError> {
    let mut family = ParametricMechanism::load(&study.source, &study.overrides, names)?;
    if let Some(share) = args.within {
        family.free_within(share);
    }
    let watch = Box::new(|_: usize, _: &[f64], _: f64| true);
    let optimum = find_optimum(
        &family,
        args.search_method(),
        args.iterations,
        watch,
        &CANCEL,
    )?;
    // Solved again with the values found.
    let mut parameters = study.overrides.parameters.clone();
    for (variable, x) in family.study.variables.iter().zip(&optimum.minimum.x) {
        parameters.retain(|(name, _)| *name != variable.name);
        parameters.push((variable.name.clone(), family.variable_text(variable, *x)));
    }
    let passes_singular = family.nominal()?.singular.is_some();
    let verified = verify_optimum(
        &study.source,
        &study.overrides,
        parameters,
        (names, passes_singular),
    )?;
    Ok(PairOptimum { optimum, verified })
}

fn pair_ranking(study: &LoadedStudy, ranked: &[Pair], most: usize, seconds: f64) -> String {
    let objective = study.family.objective();
    let unit = objective.map_or(1.0, |m| study.family.units(m.kind));
    let name = objective.map_or("objective", |m| &m.name);
    let mut rows = vec![
        ["pair", name, "first", "second", "limits", "evaluations"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for pair in ranked.iter().take(most) {
        let mut row = vec![pair.names.join(" + ")];
        match &pair.found {
            Ok(found) => {
                let minimum = &found.optimum.minimum;
                let [a, b] = pair_places(study, pair, minimum);
                let limits = match found.keeps_limits() {
                    true => "kept",
                    false => "NOT KEPT",
                };
                row.extend([
                    six_digits(minimum.value * unit),
                    six_digits(a),
                    six_digits(b),
                    limits.to_owned(),
                    minimum.evaluations.to_string(),
                ]);
            }
            Err(error) => row.push(error.to_string()),
        }
        rows.push(row);
    }
    format!(
        "{}\n  {} optimised in {seconds:.2} s, the best {} of them:\n\n{}",
        study.family.mechanism().title,
        counted_things(ranked.len(), "pair"),
        rows.len() - 1,
        aligned_rows(&rows)
    )
}

/// Values of a pair's variables in the file's units.
fn pair_places(study: &LoadedStudy, pair: &Pair, minimum: &Minimum) -> [f64; 2] {
    let unit = |k: usize| {
        let mut variables = study.family.study.variables.iter();
        let variable = variables.find(|v| v.name == pair.names[k]);
        variable.map_or(1.0, |v| study.family.units(v.kind))
    };
    [0, 1].map(|k| minimum.x[k] * unit(k))
}

fn pair_document(study: &LoadedStudy, pair: &Pair) -> Value {
    let objective = study.family.objective();
    let unit = objective.map_or(1.0, |m| study.family.units(m.kind));
    match &pair.found {
        Ok(found) => {
            let minimum = &found.optimum.minimum;
            json!({
                "names": pair.names,
                "objective": minimum.value * unit,
                "values": pair_places(study, pair, minimum),
                "violation": found.verified.violation.max(0.0),
                "limits_kept": found.keeps_limits(),
                "iterations": minimum.iterations,
                "evaluations": minimum.evaluations,
                "ended": ending_word(minimum.ended),
            })
        }
        Err(error) => json!({ "names": pair.names, "error": error.to_string() }),
    }
}
