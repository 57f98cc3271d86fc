//! The report of a synthesis: every scene's starts, its result and verification; several scenes as a ladder.

use super::cells::{aligned_rows, six_digits};
use super::rounded::at_most;
use super::sentences::{beside_unit, certified_error};
use crate::analysis::study::KEPT;
use crate::analysis::study::{FamilyError, ParametricMechanism};
use crate::analysis::synthesis::verify::Proof;
use crate::analysis::synthesis::{FinishedStart, Synthesis, ending_word};
use crate::model::measure::{Measure, MeasureSource};

/// The result for a scene.
pub struct FoundMechanism<'a> {
    /// As requested.
    pub name: String,
    /// The scene.
    pub family: &'a ParametricMechanism,
    /// Where random numbers started.
    pub seed: u64,
    /// The search.
    pub synthesis: Synthesis,
    /// Measures at the scene's own values, internal units.
    pub own: Vec<f64>,
    /// The independent motion.
    pub proof: Result<Proof, FamilyError>,
    /// Text of the found scene.
    pub scene: String,
}

impl FoundMechanism<'_> {
    /// Everything is proved, and all limits are kept between the samples, too.
    pub fn holds(&self) -> bool {
        self.proof
            .as_ref()
            .is_ok_and(|p| p.holds() && self.violation(p) <= KEPT)
    }

    pub(super) fn violation(&self, proof: &Proof) -> f64 {
        let pairs = self.family.measures.list.iter().zip(&proof.measures);
        let values = pairs.map(|(m, v)| m.violation(v.unwrap_or(f64::NAN)));
        // What has no bound is told as such.
        let whole = proof.whole.iter().map(|whole| whole.missed);
        let values = values.chain(whole.filter(|missed| missed.is_finite()));
        values.fold(f64::NEG_INFINITY, |worst, v| {
            if v > worst || v.is_nan() { v } else { worst }
        })
    }

    /// Printed, own and found values of a measure, in the file's unit.
    pub(super) fn values(&self, index: usize, measure: &Measure) -> [Option<f64>; 3] {
        let study = &self.family.study;
        let printed = study.printed.iter().find(|(k, _)| *k == index);
        let is_objective = study.objective == Some(index);
        let found = match &self.proof {
            // The objective is evaluated at the study's own samples, as in the search.
            _ if is_objective => Some(self.synthesis.value),
            Ok(proof) => proof.measures[index],
            Err(_) => None,
        };
        let shown = |v: f64| self.family.shown(measure, v);
        [
            printed.map(|(_, v)| shown(*v)),
            Some(shown(self.own[index])),
            found.map(shown),
        ]
    }
}

fn error_cell(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), six_digits)
}

fn owned_words(list: &[&str]) -> Vec<String> {
    list.iter().map(|s| (*s).to_owned()).collect()
}

/// One scene for people.
pub fn synthesis_text(found: &FoundMechanism) -> String {
    let (family, synthesis) = (found.family, &found.synthesis);
    let objective = family.objective();
    let unit = objective.map_or(1.0, |m| family.units(m.kind));
    let name = objective.map_or("objective", |m| &m.name);
    let mut text = format!("{}\n", family.mechanism().title);
    if let Some(note) = &family.study.note {
        text.push_str(&format!("  {note}\n"));
    }
    let rejected = synthesis.rejected();
    text.push_str(&format!(
        "  least {name} {}: {} starts, seed {}, {} evaluations, {:.2} s{}\n",
        six_digits(synthesis.value * unit),
        synthesis.searched,
        found.seed,
        synthesis.evaluations(),
        synthesis.seconds,
        if synthesis.stopped { ", stopped" } else { "" },
    ));
    text.push_str(&format!(
        "  random starts rejected: {} cannot be assembled, {} cannot be followed along the tracks, {} interpenetrate\n\n",
        rejected.not_assembled, rejected.not_moving, rejected.interpenetrating
    ));
    let heads = [
        "start",
        "from",
        "first",
        "found",
        "evaluations",
        "refused",
        "cutting",
        "s",
        "why it ended",
    ];
    let mut table = vec![owned_words(&heads)];
    for (k, start) in synthesis.starts.iter().enumerate() {
        let polish = k >= synthesis.searched;
        table.push(start_row(k, start, polish, unit));
    }
    text.push_str(&aligned_rows(&table));
    text.push('\n');
    text.push_str(&variable_lines(found));
    text.push('\n');
    text.push_str(&measure_lines(found));
    text.push_str(&proof_line(found));
    text.push('\n');
    text
}

fn start_row(index: usize, start: &FinishedStart, is_polish: bool, unit: f64) -> Vec<String> {
    let number = if is_polish {
        "polish".to_owned()
    } else {
        (index + 1).to_string()
    };
    let origin = if is_polish {
        "best".to_owned()
    } else {
        start.origin.words()
    };
    let mut row = vec![number, origin];
    match &start.minimum {
        Some(minimum) => row.extend([
            six_digits(start.first * unit),
            six_digits(minimum.value * unit),
            (minimum.evaluations + minimum.gradients).to_string(),
            start.refusals.count().to_string(),
            start.interpenetrating.to_string(),
            format!("{:.2}", start.seconds),
            if start.value().is_finite() {
                ending_word(minimum.ended).to_owned()
            } else {
                "limits not kept".to_owned()
            },
        ]),
        None => row.extend(owned_words(&[
            "-",
            "-",
            "0",
            "0",
            "0",
            "-",
            "no start can be followed",
        ])),
    }
    row
}

fn variable_lines(found: &FoundMechanism) -> String {
    let study = &found.family.study;
    let mut table = vec![owned_words(&[
        "variable", "scene", "found", "lowest", "highest",
    ])];
    for (variable, x) in study.variables.iter().zip(&found.synthesis.best) {
        let unit = found.family.units(variable.kind);
        let numbers = [variable.start, *x, variable.lower, variable.upper];
        let mut row = vec![variable.name.clone()];
        row.extend(numbers.map(|v| six_digits(v * unit)));
        table.push(row);
    }
    aligned_rows(&table)
}

fn measure_lines(found: &FoundMechanism) -> String {
    let mut table = vec![owned_words(&["measure", "printed", "scene", "found"])];
    for (index, measure) in found.family.measures.list.iter().enumerate() {
        let mut row = vec![measure.name.clone()];
        row.extend(found.values(index, measure).map(error_cell));
        table.push(row);
    }
    aligned_rows(&table) + &coarse_line(found)
}

/// Which measures are of the poses of the search; the others are of the finer motion, so that formulas need not fit both.
fn coarse_line(found: &FoundMechanism) -> String {
    let family = found.family;
    let list = &family.measures.list;
    let counted = family
        .measures
        .depend_on_count(family.mechanism().inputs.len());
    let is_coarse = |k: usize| counted[k] || family.study.objective == Some(k);
    let names = (0..list.len()).filter(|k| is_coarse(*k));
    let names: Vec<&str> = names.map(|k| list[k].name.as_str()).collect();
    let is_finer = |k: usize| !is_coarse(k) && matches!(list[k].source, MeasureSource::Over { .. });
    match !names.is_empty() && (0..list.len()).any(is_finer) {
        true => format!(
            "  found: {} at the poses of the search, all others at finer ones\n",
            names.join(", ")
        ),
        false => String::new(),
    }
}

fn proof_line(found: &FoundMechanism) -> String {
    let proof = match &found.proof {
        Ok(proof) => proof,
        Err(error) => return format!("\n  NOT PROVED: {error}\n"),
    };
    let unit = found.family.mechanism().pose_unit();
    let open = proof.open.map_or(String::new(), |open| {
        format!(
            ", returning to its start to within {}",
            beside_unit(at_most(open), unit)
        )
    });
    let mut text = format!(
        "\n  solved again: {} poses of the drive, {} missing, {} without a certificate, {}, {}{open}\n",
        proof.poses,
        proof.missing,
        proof.unproved,
        certified_error(
            [proof.poses - proof.missing, proof.unproved],
            proof.error_bound,
            unit
        ),
        if proof.one_branch {
            "one branch"
        } else {
            "SEVERAL BRANCHES"
        },
    );
    let names = |pairs: &[[String; 2]]| -> String {
        let pairs = pairs.iter().map(|[a, b]| format!("{a} and {b}"));
        pairs.collect::<Vec<_>>().join("; ")
    };
    if !proof.cutting.is_empty() {
        text.push_str(&format!(
            "  PART OR OVERLAP, BUT MUST TOUCH: {}\n",
            names(&proof.cutting)
        ));
    }
    if !proof.meeting.is_empty() {
        text.push_str(&format!(
            "  other bodies that collide with these dimensions: {}\n",
            names(&proof.meeting)
        ));
    }
    if found.violation(proof) > KEPT {
        text.push_str(&format!(
            "  a limit is violated by {:.2e} of itself between the samples\n",
            found.violation(proof)
        ));
    }
    let open = proof.unkept();
    if let Some(whole) = open.filter(|whole| !whole.is_proved || !whole.missed.is_finite()) {
        let measure = &found.family.measures.list[whole.measure];
        text.push_str(&format!(
            "  it is not proved that `{}` keeps its limits between the samples\n",
            measure.name
        ));
    }
    text.push_str(if found.holds() {
        "  proved: the mechanism moves as found, and keeps its limits\n"
    } else {
        "  NOT PROVED\n"
    });
    text
}

/// Measures that all scenes have, in the order of the first.
fn common_lines(found: &[FoundMechanism]) -> Vec<String> {
    let Some(first) = found.first() else {
        return Vec::new();
    };
    let has =
        |one: &FoundMechanism, name: &str| one.family.measures.list.iter().any(|m| m.name == name);
    let names = first.family.measures.list.iter().map(|m| m.name.clone());
    names
        .filter(|name| found.iter().all(|one| has(one, name)))
        .collect()
}

/// Several scenes side by side: the cost of simplification.
pub fn restart_ladder(found: &[FoundMechanism]) -> String {
    let names = common_lines(found);
    let mut text = "Ladder\n".to_owned();
    for name in &names {
        let mut table = vec![owned_words(&[
            name,
            "variables",
            "printed",
            "scene",
            "found",
            "evaluations",
            "s",
            "proved",
        ])];
        for one in found {
            let measures = one.family.measures.list.iter().enumerate();
            for (index, measure) in measures.filter(|(_, m)| m.name == *name) {
                let mut row = vec![
                    one.name.clone(),
                    one.family.study.variables.len().to_string(),
                ];
                row.extend(one.values(index, measure).map(error_cell));
                row.extend([
                    one.synthesis.evaluations().to_string(),
                    format!("{:.1}", one.synthesis.seconds),
                    if one.holds() { "yes" } else { "NO" }.to_owned(),
                ]);
                table.push(row);
            }
        }
        text.push_str(&aligned_rows(&table));
        text.push('\n');
    }
    text
}
