//! `mechanim optimise`: the study's objective made small; the result proved, reported, and written as a scene.

use super::outcome::{Failure, Outcome};
use super::study::{Opened, aligned, open, six};
use super::study_args::{MethodArg, OptimiseArgs};
use super::term::Term;
use super::tolerance::cores;
use super::{CANCEL, open_scene, report};
use crate::analysis::optimise::Ended;
use crate::analysis::study::optimum::{Method, Optimum, Verified, optimise, verify};
use crate::analysis::study::{Family, FamilyError};
use crate::scene::with_parameters;
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Version of the JSON document.
const SCHEMA: u32 = 1;

/// Tolerances where none is asked for: what the common simplex search takes, and what rounding allows.
const SIMPLEX_TOLERANCE: f64 = 1e-4;
const GRADIENT_TOLERANCE: f64 = 1e-9;

/// Violation of a constraint that is still called kept: searches let a ten-millionth pass.
const KEPT: f64 = 1e-6;

/// How far an objective that is measured again may be off, as a share of it (or of this share of the first value).
const SAME: f64 = 1e-6;

/// Runs the verb.
pub fn run(args: &OptimiseArgs, term: &Term) -> Result<Outcome, Failure> {
    if let Some(out) = &args.out
        && open_scene::is_scene_file(&args.scene, out)
    {
        let message = format!("{} is an input of this command", out.display());
        return Err(Failure::usage(message, Vec::new()));
    }
    let mut opened = open(&args.scene, &args.vary, args.pairs, term)?;
    if let Some(share) = args.within {
        widen(&mut opened.family, share);
    }
    if args.pairs {
        return pairs(args, &opened);
    }
    let start = Instant::now();
    let watch = |iteration: usize, _: &[f64], value: f64| {
        if iteration.is_multiple_of(50) {
            term.note(&format!("  iteration {iteration}: {}", six(value)));
        }
        !CANCEL.load(Ordering::Relaxed)
    };
    let optimum = optimise(
        &opened.family,
        method(args),
        args.iterations,
        Box::new(watch),
    )?;
    let seconds = start.elapsed().as_secs_f64();
    let study = &opened.family.study;
    let vary: Vec<String> = study.variables.iter().map(|v| v.name.clone()).collect();
    let parameters = opened.parameters(&optimum.minimum.x);
    let verified = verify(&opened.source, &opened.overrides, parameters.clone(), &vary);
    if let Some(out) = &args.out {
        let text = with_parameters(&opened.source, &parameters)
            .ok_or_else(|| Failure::Internal("the scene's text cannot be edited".to_owned()))?;
        report::write_text(&args.scene, out, &text)?;
    }
    let result = Report {
        opened: &opened,
        optimum: &optimum,
        verified: &verified,
        seconds,
    };
    if let Some(path) = &args.json {
        report::write_json(&args.scene, path, &result.document())?;
    }
    if args.json.as_deref() != Some(Path::new("-")) {
        let mut out = std::io::stdout().lock();
        out.write_all(result.text().as_bytes())?;
        out.flush()?;
    }
    if optimum.minimum.ended == Ended::Stopped {
        return Err(Failure::Stopped);
    }
    Ok(match &verified {
        Ok(v) if v.violation <= KEPT && result.agrees(v) => Outcome::Done,
        _ => Outcome::CheckFailed,
    })
}

/// Ranges of a share of the variables' values, in place of the study's.
fn widen(family: &mut Family, share: f64) {
    for variable in &mut family.study.variables {
        let half = share * variable.start.abs();
        if half > 0.0 {
            (variable.lower, variable.upper) = (variable.start - half, variable.start + half);
        }
    }
}

fn method(args: &OptimiseArgs) -> Method {
    let tolerance = |usual: f64| args.tolerance.unwrap_or(usual);
    match args.method {
        MethodArg::NelderMead => Method::NelderMead {
            tolerance: tolerance(SIMPLEX_TOLERANCE),
        },
        MethodArg::Bfgs => Method::Bfgs {
            tolerance: tolerance(GRADIENT_TOLERANCE),
        },
        MethodArg::Minimax => Method::Minimax {
            tolerance: tolerance(GRADIENT_TOLERANCE),
        },
        MethodArg::Evolution => Method::Evolution {
            tolerance: tolerance(GRADIENT_TOLERANCE),
            seed: args.seed,
        },
    }
}

struct Report<'a> {
    opened: &'a Opened,
    optimum: &'a Optimum,
    verified: &'a Result<Verified, FamilyError>,
    seconds: f64,
}

/// The end of a search in words.
fn ended(ended: Ended) -> &'static str {
    match ended {
        Ended::Converged => "converged",
        Ended::Stalled => "no step gains any more",
        Ended::OutOfBudget => "iterations used up",
        Ended::Stopped => "interrupted, best so far",
    }
}

impl Report<'_> {
    /// Name and unit of the objective.
    fn objective(&self) -> (&str, f64) {
        let measure = self.opened.objective();
        measure.map_or(("objective", 1.0), |m| (&m.name, self.opened.units(m.kind)))
    }

    /// Whether the motion that was followed again is the one that was optimised.
    fn agrees(&self, verified: &Verified) -> bool {
        let objective = self.opened.family.study.objective;
        let again = objective.map(|index| verified.measures[index]);
        let value = self.optimum.minimum.value;
        let scale = value.abs().max(SAME * self.optimum.first_value.abs());
        again.is_some_and(|again| (again - value).abs() <= SAME * scale)
    }

    fn text(&self) -> String {
        let (name, unit) = self.objective();
        let (minimum, study) = (&self.optimum.minimum, &self.opened.family.study);
        let factor = self.optimum.first_value / minimum.value;
        let mut text = format!(
            "{}\n  {name}: {} to {} ({} times less)\n",
            self.opened.family.mechanism.title,
            six(self.optimum.first_value * unit),
            six(minimum.value * unit),
            six(factor),
        );
        text.push_str(&format!(
            "  {}: {} iterations, {} evaluations ({} refused: {} not reached, {} without a value), {:.2} s\n\n",
            ended(minimum.ended),
            minimum.iterations,
            minimum.evaluations,
            self.optimum.refusals.count(),
            self.optimum.refusals.not_reached,
            self.optimum.refusals.no_value,
            self.seconds
        ));
        let mut rows = vec![
            ["variable", "from", "to", "lowest", "highest"]
                .map(str::to_owned)
                .to_vec(),
        ];
        for (variable, x) in study.variables.iter().zip(&minimum.x) {
            let unit = self.opened.units(variable.kind);
            let numbers = [variable.start, *x, variable.lower, variable.upper];
            let mut row = vec![variable.name.clone()];
            row.extend(numbers.map(|v| six(v * unit)));
            rows.push(row);
        }
        text.push_str(&aligned(&rows));
        match self.verified {
            Ok(v) => {
                text.push_str(&format!(
                    "\nFollowed again from the start values: {} poses, {} without a certificate, error at most {:.1e} {}.\n",
                    v.poses, v.unproved, v.error_bound, self.opened.family.mechanism.length_unit
                ));
                let mut rows = vec![vec!["measure".to_owned(), "value".to_owned()]];
                let measures = self.opened.measures().iter().zip(&v.measures);
                rows.extend(
                    measures.map(|(m, v)| vec![m.name.clone(), six(self.opened.shown(m, *v))]),
                );
                text.push_str(&aligned(&rows));
                if !self.agrees(v) {
                    text.push_str(
                        "Not confirmed: this motion is another than the one that was optimised.\n",
                    );
                }
                if v.violation > KEPT {
                    text.push_str(&format!(
                        "No candidate keeps all constraints; this one misses a bound by {:.3} %.\n",
                        100.0 * v.violation
                    ));
                }
            }
            Err(error) => text.push_str(&format!("\nNot confirmed: {error}\n")),
        }
        text
    }

    fn document(&self) -> Value {
        let (name, unit) = self.objective();
        let (minimum, study) = (&self.optimum.minimum, &self.opened.family.study);
        let variables = study.variables.iter().zip(&minimum.x).map(|(v, x)| {
            let unit = self.opened.units(v.kind);
            json!({ "name": v.name, "from": v.start * unit, "to": x * unit })
        });
        let verified = self.verified.as_ref().ok().map(|v| {
            let measures = self.opened.measures().iter().zip(&v.measures);
            let measures = measures.map(|(m, v)| (m.name.clone(), json!(self.opened.shown(m, *v))));
            json!({
                "poses": v.poses,
                "unproved": v.unproved,
                "error_bound": v.error_bound,
                "violation": v.violation.max(0.0),
                "measures": measures.collect::<serde_json::Map<String, Value>>(),
            })
        });
        json!({
            "schema": format!("mechanim-optimise-{SCHEMA}"),
            "title": self.opened.family.mechanism.title,
            "objective": name,
            "from": self.optimum.first_value * unit,
            "to": minimum.value * unit,
            "ended": ended(minimum.ended),
            "iterations": minimum.iterations,
            "evaluations": minimum.evaluations,
            "refused": { "not_reached": self.optimum.refusals.not_reached, "no_value": self.optimum.refusals.no_value },
            "variables": variables.collect::<Vec<_>>(),
            "verified": verified,
        })
    }
}

/// One pair of variables with its optimum.
struct Pair {
    names: [String; 2],
    found: Result<Optimum, FamilyError>,
}

fn pairs(args: &OptimiseArgs, opened: &Opened) -> Result<Outcome, Failure> {
    let variables = &opened.family.study.variables;
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
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(names) = jobs.get(index).filter(|_| !CANCEL.load(Ordering::Relaxed)) else {
                return done;
            };
            let found = pair(args, opened, names);
            let names = names.clone();
            done.push((index, Pair { names, found }));
        }
    };
    let threads = args.threads.unwrap_or_else(cores);
    let mut done: Vec<(usize, Pair)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .flat_map(|w| w.join().unwrap_or_default())
            .collect()
    });
    if CANCEL.load(Ordering::Relaxed) {
        return Err(Failure::Interrupted);
    }
    let value = |p: &Pair| p.found.as_ref().map_or(f64::INFINITY, |o| o.minimum.value);
    done.sort_by(|(i, a), (j, b)| value(a).total_cmp(&value(b)).then(i.cmp(j)));
    let ranked: Vec<Pair> = done.into_iter().map(|(_, pair)| pair).collect();
    let seconds = start.elapsed().as_secs_f64();
    if let Some(path) = &args.json {
        let rows: Vec<Value> = ranked.iter().map(|p| pair_document(opened, p)).collect();
        let document = json!({
            "schema": format!("mechanim-pairs-{SCHEMA}"),
            "title": opened.family.mechanism.title,
            "pairs": rows,
        });
        report::write_json(&args.scene, path, &document)?;
    }
    if args.json.as_deref() != Some(Path::new("-")) {
        let mut out = std::io::stdout().lock();
        out.write_all(ranking(opened, &ranked, args.worst, seconds).as_bytes())?;
        out.flush()?;
    }
    Ok(Outcome::Done)
}

fn pair(args: &OptimiseArgs, opened: &Opened, names: &[String; 2]) -> Result<Optimum, FamilyError> {
    let mut family = Family::load(&opened.source, &opened.overrides, names)?;
    if let Some(share) = args.within {
        widen(&mut family, share);
    }
    let watch = |_: usize, _: &[f64], _: f64| !CANCEL.load(Ordering::Relaxed);
    optimise(&family, method(args), args.iterations, Box::new(watch))
}

fn ranking(opened: &Opened, ranked: &[Pair], most: usize, seconds: f64) -> String {
    let objective = opened.objective();
    let unit = objective.map_or(1.0, |m| opened.units(m.kind));
    let name = objective.map_or("objective", |m| &m.name);
    let mut rows = vec![
        ["pair", name, "first", "second", "evaluations"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for pair in ranked.iter().take(most) {
        let mut row = vec![pair.names.join(" + ")];
        match &pair.found {
            Ok(o) => {
                let [a, b] = places(opened, pair, o);
                row.extend([
                    six(o.minimum.value * unit),
                    six(a),
                    six(b),
                    o.minimum.evaluations.to_string(),
                ]);
            }
            Err(error) => row.push(error.to_string()),
        }
        rows.push(row);
    }
    format!(
        "{}\n  {} pairs optimised in {seconds:.2} s, the best {} of them:\n\n{}",
        opened.family.mechanism.title,
        ranked.len(),
        rows.len() - 1,
        aligned(&rows)
    )
}

/// Values of a pair's variables in the file's units.
fn places(opened: &Opened, pair: &Pair, optimum: &Optimum) -> [f64; 2] {
    let unit = |k: usize| {
        let mut variables = opened.family.study.variables.iter();
        let variable = variables.find(|v| v.name == pair.names[k]);
        variable.map_or(1.0, |v| opened.units(v.kind))
    };
    [0, 1].map(|k| optimum.minimum.x[k] * unit(k))
}

fn pair_document(opened: &Opened, pair: &Pair) -> Value {
    match &pair.found {
        Ok(o) => json!({
            "names": pair.names,
            "objective": o.minimum.value,
            "values": places(opened, pair, o),
            "iterations": o.minimum.iterations,
            "evaluations": o.minimum.evaluations,
            "ended": ended(o.minimum.ended),
        }),
        Err(error) => json!({ "names": pair.names, "error": error.to_string() }),
    }
}
