//! The result for a table of targets: text and JSON. All numbers are computed elsewhere.

use super::cells::{aligned_rows, six_digits};
use super::rounded::at_most;
use super::sentences::counted_things;
use crate::analysis::study::{FamilyError, ParametricMechanism};
use crate::analysis::synthesis::ending_word;
use crate::analysis::synthesis::target::{
    StartResult, Target, TargetRow, TargetSynthesis, VerifiedRows,
};
use crate::analysis::synthesis::verify::Proof;
use serde_json::{Value, json};

/// What was found.
pub struct FoundTarget<'a> {
    /// The scene with its variables.
    pub family: &'a ParametricMechanism,
    /// The targets.
    pub target: &'a Target,
    /// Where random numbers started.
    pub seed: u64,
    /// The search.
    pub synthesis: TargetSynthesis,
    /// The rows, as met by an independent motion.
    pub rows: VerifiedRows,
    /// The whole drive of the found mechanism.
    pub proof: Result<Proof, FamilyError>,
}

impl FoundTarget<'_> {
    /// Deviations of the independent motion, and the rows that count: those with a weight.
    fn missed(&self) -> impl Iterator<Item = (f64, &TargetRow)> {
        let pairs = self.rows.missed.iter().zip(&self.target.rows);
        let missed = pairs.map(|(missed, row)| (missed.unwrap_or(f64::INFINITY), row));
        missed.filter(|(_, row)| row.weight > 0.0)
    }

    /// Weighted sum of squared deviations.
    fn sum(&self) -> f64 {
        self.missed()
            .map(|(off, row)| row.weight * off.powi(2))
            .sum()
    }

    /// Root of the weighted mean of squared deviations.
    fn typical(&self) -> f64 {
        let weights: f64 = self.missed().map(|(_, row)| row.weight).sum();
        (self.sum() / weights).sqrt()
    }

    /// The largest deviation, and the line of its row.
    fn farthest(&self) -> (f64, usize) {
        let worst = self.missed().max_by(|a, b| a.0.total_cmp(&b.0));
        worst.map_or((0.0, 0), |(off, row)| (off, row.line))
    }

    fn poses(&self) -> usize {
        self.synthesis.starts.iter().map(|tried| tried.poses).sum()
    }
}

/// The report in words.
pub fn target_text(found: &FoundTarget) -> String {
    let (family, target, synthesis) = (found.family, found.target, &found.synthesis);
    let mechanism = family.mechanism();
    let unit = &mechanism.length_unit;
    let names: Vec<&str> = target.columns.iter().map(|c| c.name.as_str()).collect();
    let met = match target.free_input {
        Some(free) => format!("`{}` free in every row", mechanism.inputs[free.input].name),
        None => "when the table says".to_owned(),
    };
    let mut text = format!(
        "{}\n  targets          {} of {}, {met}\n",
        mechanism.title,
        counted_things(target.rows.len(), "row"),
        names.join(", ")
    );
    text += &format!(
        "  search           {} (seed {}), {} poses, {:.1} s{}\n",
        counted_things(synthesis.starts.len(), "start"),
        found.seed,
        found.poses(),
        synthesis.seconds,
        if synthesis.stopped { ", stopped" } else { "" }
    );
    let (farthest, line) = found.farthest();
    text += &format!(
        "  missed           sum of squares {}, root mean square {} {unit}, farthest {} {unit} (line {})\n",
        six_digits(found.sum()),
        six_digits(found.typical()),
        six_digits(farthest),
        line
    );
    text += &format!("  rows             {}\n", rows_sentence(found));
    text += &format!(
        "  whole drive      {}\n",
        drive_sentence(&found.proof, unit)
    );
    let mut rows = vec![["variable", "file", "found"].map(str::to_owned).to_vec()];
    for (variable, x) in family.study.variables.iter().zip(&synthesis.fit.x) {
        let shown = |v: f64| six_digits(v * family.units(variable.kind));
        rows.push(vec![
            variable.name.clone(),
            shown(variable.start),
            shown(*x),
        ]);
    }
    text + &aligned_rows(&rows)
}

/// The result of the independent motion for the rows.
fn rows_sentence(found: &FoundTarget) -> String {
    let rows = &found.rows;
    // Rows without a weight are no targets.
    let count = found.missed().count();
    let met = found.missed().filter(|(off, _)| off.is_finite()).count();
    let mut text = match rows.one_branch {
        true => format!("{met} of {count} have a pose on one motion"),
        false => format!("{met} of {count} have a pose, but on several branches"),
    };
    text += &match rows.unproved {
        0 => format!(", certified to {}", at_most(rows.error_bound)),
        count => format!(", {count} without a certificate"),
    };
    if !rows.in_order {
        text += ", not in the table's order";
    }
    text
}

fn drive_sentence(proof: &Result<Proof, FamilyError>, unit: &str) -> String {
    match proof {
        Err(error) => error.to_string(),
        Ok(proof) => {
            let mut text = format!("{} of {} poses", proof.poses - proof.missing, proof.poses);
            text += &match proof.unproved {
                0 => format!(", certified to {}", at_most(proof.error_bound)),
                count => format!(", {count} without a certificate"),
            };
            if let Some(open) = proof.open {
                text += &format!(", closed to {} {unit}", at_most(open));
            }
            if !proof.meeting.is_empty() || !proof.cutting.is_empty() {
                let count = proof.meeting.len() + proof.cutting.len();
                text += &format!(
                    ", colliding: {} of other bodies",
                    counted_things(count, "pair")
                );
            }
            text
        }
    }
}

/// The JSON document.
pub fn target_document(found: &FoundTarget) -> Value {
    let (family, target, synthesis) = (found.family, found.target, &found.synthesis);
    let mechanism = family.mechanism();
    let variables = family.study.variables.iter().zip(&synthesis.fit.x);
    let unknowns = mechanism.unknowns.len();
    let row = |(k, pose): (usize, &Vec<f64>)| {
        let inputs = mechanism.inputs.iter().zip(&pose[unknowns..]);
        let inputs = inputs.take(family.own_inputs());
        let inputs: serde_json::Map<String, Value> = inputs
            .map(|(input, v)| (input.name.clone(), json!(v * family.units(input.kind))))
            .collect();
        json!({
            "line": target.rows[k].line,
            "inputs": inputs,
            "missed": found.rows.missed.get(k).copied().flatten(),
        })
    };
    let start = |tried: &StartResult| {
        json!({
            "from": tried.origin.words(),
            "first": tried.first,
            "sum": tried.sum,
            "steps": tried.steps,
            "ended": ending_word(tried.ended),
            "poses": tried.poses,
        })
    };
    json!({
        "schema": "mechanim-target/1",
        "title": mechanism.title,
        "unit": mechanism.length_unit,
        "seed": found.seed,
        // Everything that differs between identical runs.
        "timing": { "seconds": synthesis.seconds },
        "sum": found.sum(),
        "variables": variables.map(|(v, x)| json!({
            "name": v.name,
            "file": v.start * family.units(v.kind),
            "found": x * family.units(v.kind),
        })).collect::<Vec<_>>(),
        "rows": synthesis.fit.poses.iter().enumerate().map(row).collect::<Vec<_>>(),
        "in_order": found.rows.in_order,
        "proved": found.rows.holds(),
        "error_bound": found.rows.error_bound,
        "drive_holds": found.proof.as_ref().is_ok_and(Proof::holds),
        "starts": synthesis.starts.iter().map(start).collect::<Vec<_>>(),
    })
}
