//! Clearances of all pieces within their tolerances: as cases of a verdict, as a table and as JSON. All numbers are
//! computed elsewhere.

use super::enclosure::reason_words;
use super::lengths::{LengthForm, at_least_length};
use super::sentences::counted_things;
use super::verdict::{CLEARANCE, Case, Status};
use crate::clearance::part::{Missing, PieceClearance, PieceRefusal, PieceReport};
use crate::diag::decimals_of;
use crate::model::mechanism::Mechanism;
use crate::model::printed::shortest_decimal;
use crate::sorting::sort_by;
use serde_json::{Value, json};

/// The rule: a pair passes if and only if its bound reaches the minimum.
fn piece_status(pair: &PieceClearance) -> Status {
    match (pair.is_kept(), pair.is_broken()) {
        (true, _) => Status::Passed,
        (false, true) => Status::Failed,
        (false, false) => Status::NotProved,
    }
}

/// Dimensions that are named in the heading of a table.
const MOST_NAMED: usize = 6;

/// The word of a pair in reports.
fn piece_word(pair: &PieceClearance) -> &'static str {
    match piece_status(pair) {
        Status::Passed => "passed",
        Status::Failed => "failed",
        _ => "undecided",
    }
}

fn body_names(mechanism: &Mechanism, pair: &PieceClearance) -> String {
    let names = pair.pair.map(|body| mechanism.bodies[body].name.as_str());
    names.join(" / ")
}

/// One case a pair.
pub fn piece_cases<'r>(
    mechanism: &'r Mechanism,
    report: &'r PieceReport,
) -> impl Iterator<Item = Case> + 'r {
    report.list.iter().map(|pair| {
        let name = format!("{}, every piece", body_names(mechanism, pair));
        let text = format!("{}: {}", piece_word(pair), piece_sentence(mechanism, pair));
        Case::new(CLEARANCE, &name, piece_status(pair), text)
    })
}

/// Results about a pair.
fn piece_sentence(mechanism: &Mechanism, pair: &PieceClearance) -> String {
    let unit = &mechanism.length_unit;
    let known = match &pair.refusal {
        Some(refusal) => refusal_words(refusal),
        None => format!(
            "no piece comes nearer than {} {unit} (proved)",
            at_least_length(pair.bound, mechanism.size, 6)
        ),
    };
    format!(
        "{known}; the nearest one found comes within {} {unit} at t = {} s; the minimum is {} {unit}",
        decimals_of(pair.found, 6),
        decimals_of(pair.time, 6),
        decimals_of(pair.minimum, 6)
    )
}

/// Why there is no bound.
fn refusal_words(refusal: &PieceRefusal) -> String {
    let [from, until] = [refusal.from, refusal.until].map(shortest_decimal);
    let why = match refusal.missing {
        Missing::Pose => "no pose was found",
        Missing::Time => "the limit `time` cut off the search",
        Missing::Proof(reason) => reason_words(reason),
    };
    let name = refusal.dimension.as_ref().map(|name| {
        format!("; within the tolerances, `{name}` brings the mechanism closest to a fold or change point")
    });
    format!(
        "no bound from t = {from} to {until} s: {why}{}",
        name.unwrap_or_default()
    )
}

/// The table of all pairs, those with the smallest margin first.
pub fn piece_table(mechanism: &Mechanism, report: &PieceReport, worst: usize) -> String {
    let count = report.dimensions.len();
    let names: Vec<&str> = report
        .dimensions
        .iter()
        .map(|(name, _)| name.as_str())
        .collect();
    let named = match count <= MOST_NAMED {
        true => format!(" ({})", names.join(", ")),
        false => String::new(),
    };
    let mut text = format!(
        "  every piece      {}{named} within {}\n",
        counted_things(count, "dimension"),
        if count == 1 {
            "its tolerance"
        } else {
            "their tolerances"
        }
    );
    if !report.list.is_empty() {
        text.push_str(
            "        nominal     found   never below     minimum      at t/s  verdict    pair\n",
        );
    }
    // The worst verdicts first, and of like ones the smallest margins.
    let mut list: Vec<&PieceClearance> = report.list.iter().collect();
    sort_by(&mut list, |p, q| {
        let order = piece_status(q).cmp(&piece_status(p));
        order.then((p.bound - p.minimum).total_cmp(&(q.bound - q.minimum)))
    });
    for pair in list.iter().take(worst) {
        let lengths = [pair.nominal, pair.found, pair.minimum];
        let form = LengthForm::of(&lengths, mechanism.size, 4);
        let [nominal, found, minimum] = lengths.map(|length| form.length(length));
        // There is no bound where a proof was refused.
        let bound = match pair.refusal {
            Some(_) => "-".to_owned(),
            None => form.at_least(pair.bound),
        };
        text.push_str(&format!(
            "    {nominal:>10}{found:>10}  {bound:>12}  {minimum:>10}  {:>10.5}  {:<10} {}\n",
            pair.time,
            piece_word(pair),
            body_names(mechanism, pair),
        ));
    }
    if list.len() > worst {
        text.push_str(&format!(
            "    and {} more (--rows {})\n",
            list.len() - worst,
            list.len()
        ));
    }
    if let Some(refusal) = list.iter().find_map(|pair| pair.refusal.as_ref()) {
        text.push_str(&format!("    {}\n", refusal_words(refusal)));
    }
    text
}

/// The `pieces` object of the clearances.
pub fn pieces_document(mechanism: &Mechanism, report: &PieceReport) -> Value {
    let dimension =
        |(name, tolerance): &(String, f64)| json!({"name": name, "tolerance": tolerance});
    let pair = |pair: &PieceClearance| {
        json!({
            "bodies": pair.pair.map(|body| &mechanism.bodies[body].name),
            "verdict": piece_word(pair),
            "drawn": pair.nominal,
            "found": pair.found,
            "time": pair.time,
            "bound": pair.refusal.is_none().then_some(pair.bound),
            "minimum": pair.minimum,
            "slack": pair.slack,
            "refused": pair.refusal.as_ref().map(refusal_words),
        })
    };
    json!({
        "dimensions": report.dimensions.iter().map(dimension).collect::<Vec<_>>(),
        "pairs": report.list.iter().map(pair).collect::<Vec<_>>(),
    })
}
