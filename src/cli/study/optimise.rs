//! `mechanim optimise`: the study's objective made small; the result proved, reported, and written as a scene.

use super::kept_clearances::{Clearances, settle_clearances};
use super::method::{SCHEMA, ending_word, search_method, widen_variables};
use super::search_film::Improvement;
use super::{pairs, search_film as optimise_film};
use crate::analysis::optimise::{Ended, Minimum};
use crate::analysis::study::FamilyError;
use crate::analysis::study::optimum::{Optimum, Verified, find_optimum, verify_optimum};
use crate::cli::args::study::OptimiseArgs;
use crate::cli::interrupt::{CANCEL, is_interrupted, save_results, unless_interrupted};
use crate::cli::io;
use crate::cli::open::study::{Opened, open_study};
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::cli::term::progress::Progress;
use crate::report::cells::{aligned_rows, six_digits};
use crate::report::rounded::at_most;
use crate::scene::edit::with_values;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Instant;

/// Violation of a constraint that is still called kept: searches let a ten-millionth pass.
const KEPT: f64 = 1e-6;

/// Iterations from one plain line of progress to the next.
const LINES_APART: usize = 50;

/// How far an objective that is measured again may be off, as a share of it (or of this share of the first value).
const SAME: f64 = 1e-6;

/// Runs the verb.
pub fn run_optimise(args: &OptimiseArgs, term: &Term) -> Result<Outcome, Failure> {
    let reports = [
        ("--out", args.out.as_deref()),
        ("--json", args.json.as_deref()),
        ("--film", args.film.as_deref()),
    ];
    io::refuse_clashes(&[&args.scene], &reports)?;
    let film = args.film.as_deref().map(optimise_film::film_file);
    let film = film.transpose()?;
    let mut opened = open_study(&args.scene, &args.vary, args.pairs, term)?;
    if let Some(share) = args.within {
        widen_variables(&mut opened.family, share);
    }
    if args.pairs {
        return pairs::run_pairs(args, &opened, term);
    }
    let start = Instant::now();
    let opened = Arc::new(opened);
    let (mut optimum, improvements) = search_optimum(args, &opened, term)?;
    let clearances = settled(&opened, &mut optimum.minimum, &improvements)?;
    let is_stopped = optimum.minimum.ended == Ended::Stopped;
    let seconds = start.elapsed().as_secs_f64();
    let study = &opened.family.study;
    let vary: Vec<String> = study.variables.iter().map(|v| v.name.clone()).collect();
    let parameters = opened.parameters(&optimum.minimum.x);
    let verified = verified(&opened, parameters.clone(), vary);
    let complete = |path| io::unless_complete(path, !is_stopped);
    let out = args.out.as_deref().map(complete);
    if let Some(out) = &out {
        let text = with_values(&opened.source, &parameters, &opened.overrides.guess);
        let text = text.ok_or_else(|| {
            Failure::usage(
                "the scene's text cannot be given these start values",
                vec!["write them as a section of their own: [guess]".to_owned()],
            )
        })?;
        io::write_text(&args.scene, out, &text)?;
        if !opened.overrides.inputs.is_empty() || opened.overrides.drives.is_some() {
            let out = out.display();
            term.warning(&format!(
                "{out} has the drive of the scene, not that of the command line"
            ));
        }
    }
    let result = OptimiseReport {
        opened: &opened,
        optimum: &optimum,
        verified: &verified,
        clearances: &clearances,
        seconds,
    };
    if let Some(path) = &args.json {
        io::write_json(
            &args.scene,
            &io::unless_complete(path, !is_stopped),
            &result.document(),
        )?;
    }
    io::print_beside(term, args.json.as_deref(), &result.text())?;
    if is_stopped {
        let kept = out.map_or_else(
            || "the best so far was reported".to_owned(),
            |out| format!("the best so far was written to {}", out.display()),
        );
        return Err(Failure::Stopped(kept));
    }
    save_results(false);
    if let Some(film) = &film {
        optimise_film::write_search_film(film, &opened, &improvements, term)?;
    }
    let is_kept = clearances.as_ref().is_none_or(|c| c.kept);
    Ok(match &verified {
        Ok(v) if v.violation <= KEPT && result.agrees(v) && is_kept => Outcome::Done,
        _ => Outcome::CheckFailed,
    })
}

/// The clearances at the minimum, which may move for them; of a search that was interrupted they are not looked at.
fn settled(
    opened: &Arc<Opened>,
    minimum: &mut Minimum,
    improvements: &[Improvement],
) -> Result<Option<Clearances>, Failure> {
    if minimum.ended == Ended::Stopped {
        return Ok(None);
    }
    let (opened, found) = (Arc::clone(opened), minimum.clone());
    let improvements = improvements.to_vec();
    let work = move || {
        let mut minimum = found.clone();
        let clearances = settle_clearances(&opened, &mut minimum, &improvements);
        clearances.map(|clearances| (clearances, minimum))
    };
    match unless_interrupted(work) {
        Some(settled) => {
            let (clearances, place) = settled?;
            *minimum = place;
            Ok(clearances)
        }
        None => {
            minimum.ended = Ended::Stopped;
            Ok(None)
        }
    }
}

/// The independent motion, unless Ctrl-C comes before it is there.
fn verified(
    opened: &Opened,
    parameters: Vec<(String, String)>,
    vary: Vec<String>,
) -> Result<Verified, FamilyError> {
    let (source, overrides) = (opened.source.clone(), opened.overrides.clone());
    let unproved = || {
        Err(FamilyError::Lacks(
            "interrupted before the proof".to_owned(),
        ))
    };
    let work = move || verify_optimum(&source, &overrides, parameters.clone(), &vary);
    unless_interrupted(work).unwrap_or_else(unproved)
}

/// The search with its progress, and the points it came to, from the start on.
fn search_optimum(
    args: &OptimiseArgs,
    opened: &Opened,
    term: &Term,
) -> Result<(Optimum, Vec<Improvement>), Failure> {
    let progress = Progress::new(args.progress, term.quiet());
    let mut improvements: Vec<Improvement> = Vec::new();
    let unit = opened
        .family
        .objective()
        .map_or(1.0, |m| opened.family.units(m.kind));
    let watch = |iteration: usize, values: &[f64], value: f64| {
        let text = format!("  iteration {iteration}: {}", six_digits(value * unit));
        progress.say(&text, iteration.is_multiple_of(LINES_APART));
        let last = improvements.last();
        if last.is_none_or(|last| last.values != values) {
            improvements.push(Improvement {
                iteration,
                values: values.to_vec(),
                objective: value,
            });
        }
        // From here on the best so far is worth waiting for.
        save_results(true);
        true
    };
    let method = search_method(args);
    let (family, watch) = (&opened.family, Box::new(watch));
    let optimum = find_optimum(family, method, args.iterations, watch, &CANCEL)?;
    progress.end();
    if improvements.is_empty() && is_interrupted() {
        return Err(Failure::Interrupted);
    }
    let first = Improvement {
        iteration: 0,
        values: opened.family.start(),
        objective: optimum.first_value,
    };
    improvements.insert(0, first);
    let minimum = &optimum.minimum;
    if improvements
        .last()
        .is_none_or(|last| last.values != minimum.x)
    {
        improvements.push(Improvement {
            iteration: minimum.iterations,
            values: minimum.x.clone(),
            objective: minimum.value,
        });
    }
    Ok((optimum, improvements))
}

struct OptimiseReport<'a> {
    opened: &'a Opened,
    optimum: &'a Optimum,
    verified: &'a Result<Verified, FamilyError>,
    clearances: &'a Option<Clearances>,
    seconds: f64,
}

impl OptimiseReport<'_> {
    /// Name and unit of the objective.
    fn objective(&self) -> (&str, f64) {
        let measure = self.opened.family.objective();
        measure.map_or(("objective", 1.0), |m| {
            (&m.name, self.opened.family.units(m.kind))
        })
    }

    /// Whether the motion that was followed again is the one that was optimised.
    fn agrees(&self, verified: &Verified) -> bool {
        let objective = self.opened.family.study.objective;
        let again = objective.map(|index| verified.measures[index]);
        let value = self.optimum.minimum.value;
        let scale = value.abs().max(SAME * self.optimum.first_value.abs());
        again.is_some_and(|again| (again - value).abs() <= SAME * scale)
    }

    /// Name of the measure that breaks its limit most.
    fn worst_limit(&self, verified: &Verified) -> &str {
        let measures = self
            .opened
            .family
            .measures
            .list
            .iter()
            .zip(&verified.measures);
        let broken = measures.map(|(m, v)| (m.violation(*v), &m.name));
        let worst = broken.max_by(|a, b| a.0.total_cmp(&b.0));
        worst.map_or("", |(_, name)| name)
    }

    fn text(&self) -> String {
        let (name, unit) = self.objective();
        let (minimum, study) = (&self.optimum.minimum, &self.opened.family.study);
        let (first, last) = (self.optimum.first_value, minimum.value);
        let change = match first / last {
            factor if factor >= 1.0 && factor.is_finite() => {
                format!("{} times less", six_digits(factor))
            }
            factor if factor > 0.0 && factor < 1.0 => {
                format!("{} times more", six_digits(1.0 / factor))
            }
            _ => format!("by {}", six_digits((last - first) * unit)),
        };
        let mut text = format!(
            "{}\n  {name}: {} to {} ({change})\n",
            self.opened.family.mechanism().title,
            six_digits(self.optimum.first_value * unit),
            six_digits(minimum.value * unit),
        );
        text.push_str(&format!(
            "  {}: {} iterations, {} evaluations ({} refused: {} not reached, {} torn, {} without a value), {:.2} s\n\n",
            ending_word(minimum.ended),
            minimum.iterations,
            minimum.evaluations,
            self.optimum.refusals.count(),
            self.optimum.refusals.not_reached,
            self.optimum.refusals.torn,
            self.optimum.refusals.no_value,
            self.seconds
        ));
        let mut rows = vec![
            ["variable", "from", "to", "lowest", "highest"]
                .map(str::to_owned)
                .to_vec(),
        ];
        for (variable, x) in study.variables.iter().zip(&minimum.x) {
            let unit = self.opened.family.units(variable.kind);
            let numbers = [variable.start, *x, variable.lower, variable.upper];
            let mut row = vec![variable.name.clone()];
            row.extend(numbers.map(|v| six_digits(v * unit)));
            rows.push(row);
        }
        text.push_str(&aligned_rows(&rows));
        match self.verified {
            Ok(v) => {
                text.push_str(&format!(
                    "\nFollowed again from the start values: {} poses, {} without a certificate, error at most {} {}.\n",
                    v.poses, v.unproved, at_most(v.error_bound), self.opened.family.mechanism().length_unit
                ));
                let mut rows = vec![vec!["measure".to_owned(), "value".to_owned()]];
                let measures = self.opened.family.measures.list.iter().zip(&v.measures);
                rows.extend(measures.map(|(m, v)| {
                    vec![m.name.clone(), six_digits(self.opened.family.shown(m, *v))]
                }));
                text.push_str(&aligned_rows(&rows));
                if !self.agrees(v) {
                    text.push_str(
                        "Not confirmed: this motion is another than the one that was optimised.\n",
                    );
                }
                if v.violation > KEPT {
                    text.push_str(&format!(
                        "No candidate keeps all constraints; with this one `{}` misses its bound by {:.3} %.\n",
                        self.worst_limit(v),
                        100.0 * v.violation
                    ));
                }
            }
            Err(error) => text.push_str(&format!("\nNot confirmed: {error}\n")),
        }
        text.extend(self.clearances.iter().map(Clearances::line));
        text
    }

    fn document(&self) -> Value {
        let (name, unit) = self.objective();
        let (minimum, study) = (&self.optimum.minimum, &self.opened.family.study);
        let variables = study.variables.iter().zip(&minimum.x).map(|(v, x)| {
            let unit = self.opened.family.units(v.kind);
            json!({ "name": v.name, "from": v.start * unit, "to": x * unit })
        });
        let verified = self.verified.as_ref().ok().map(|v| {
            let measures = self.opened.family.measures.list.iter().zip(&v.measures);
            let measures =
                measures.map(|(m, v)| (m.name.clone(), json!(self.opened.family.shown(m, *v))));
            json!({
                "poses": v.poses,
                "unproved": v.unproved,
                "error_bound": v.error_bound,
                "violation": v.violation.max(0.0),
                "measures": measures.collect::<serde_json::Map<String, Value>>(),
            })
        });
        json!({
            "schema": format!("mechanim-optimise/{SCHEMA}"),
            "title": self.opened.family.mechanism().title,
            "objective": name,
            "from": self.optimum.first_value * unit,
            "to": minimum.value * unit,
            "ended": ending_word(minimum.ended),
            "iterations": minimum.iterations,
            "evaluations": minimum.evaluations,
            "refused": { "not_reached": self.optimum.refusals.not_reached, "torn": self.optimum.refusals.torn,
                         "no_value": self.optimum.refusals.no_value },
            "variables": variables.collect::<Vec<_>>(),
            "verified": verified,
            "clearance": self.clearances.as_ref().map(|c| json!({
                "kept": c.kept,
                "nearest": c.worst,
                "instead_of_later": c.instead,
            })),
        })
    }
}
