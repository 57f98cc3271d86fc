//! Clearances as a table of text: the worst pairs, the pairs that are far apart, and the excluded pairs with their
//! reasons.

use super::clearance::{
    NO_BOUND, asked_words, body_names, bound_text, judgement_reason, judgement_word,
    touching_words, violations_sentence,
};
use super::lengths::{LengthForm, at_least_length};
use super::pieces::piece_table;
use super::rounded::at_most;
use super::sentences::counted_things;
use crate::clearance::check::{ClearanceReport, FarPairs, Judgement, PairReport};
use crate::clearance::neighbours::Neighbours;
use crate::diag::decimals_of;
use crate::model::mechanism::Mechanism;

/// More excluded pairs with the same reason are merged into one line of the table. JSON and JUnit have all of them.
const MOST_OF_ONE_REASON: usize = 3;

/// The worst pairs, then what was left out.
pub fn clearance_table(mechanism: &Mechanism, found: &ClearanceReport, worst: usize) -> String {
    let unit = &mechanism.length_unit;
    let has_gaps = !found.gaps.is_empty();
    let mut text = format!(
        "  clearance        {} judged, {} excluded; lengths in {unit}\n",
        counted_things(found.judged_count(), "pair"),
        found.excluded_count()
    );
    if !found.judged.is_empty() {
        text.push_str("      distance   never below     minimum      at t/s  verdict    pair\n");
    }
    // The pairs that are judged, the worst first, with remarks below each.
    for p in found.judged.iter().take(worst) {
        text.push_str(&pair_row(mechanism, p));
        if let Some(times) = violations_sentence(p, has_gaps) {
            text.push_str(&format!("                  {times}\n"));
        }
        if let Some(slack) = slack_used(p) {
            let slack = at_most(slack);
            text.push_str(&format!(
                "                  below its minimum by no more than the slack for rounding, {slack} {unit}\n"
            ));
        }
        if let Some(words) = touching_words(mechanism, p) {
            text.push_str(&format!(
                "                  they must touch{words}; {}\n",
                bound_text(mechanism, p, has_gaps)
            ));
        }
    }
    if found.judged.len() > worst {
        let rest = found.judged.len() - worst;
        text.push_str(&format!(
            "    and {rest} more (--rows {})\n",
            found.judged.len()
        ));
    }
    if let Some(far) = &found.far {
        text.push_str(&far_line(mechanism, far));
    }
    // What was excluded, reason by reason, and what was only counted.
    for group in by_reason(&found.excluded) {
        text.push_str(&excluded_row(mechanism, &group));
    }
    for (judgement, count) in &found.counted {
        let reason = judgement_reason(judgement).unwrap_or_default();
        text.push_str(&format!(
            "                  {:<10} {count} pairs: {reason}\n",
            judgement_word(judgement)
        ));
    }
    // Gaps of the motion, where nothing was checked.
    for [start, end] in &found.gaps {
        let [start, end] = [start, end].map(|time| decimals_of(*time, 6));
        text.push_str(&format!("    not checked from t = {start} s to {end} s\n"));
    }
    let pieces = found.pieces.iter();
    text.extend(pieces.map(|pieces| piece_table(mechanism, pieces, worst)));
    text
}

/// The slack of a pair that passes because of it: its bound is below the minimum.
fn slack_used(p: &PairReport) -> Option<f64> {
    let is_used = p.touching.is_none() && p.judgement.is_kept() && p.least.bound < p.minimum;
    is_used.then_some(p.slack)
}

/// Excluded pairs with equal reasons, in order of first appearance.
fn by_reason(pairs: &[PairReport]) -> Vec<Vec<&PairReport>> {
    let mut groups: Vec<Vec<&PairReport>> = Vec::new();
    for p in pairs {
        match groups.iter_mut().find(|g| g[0].judgement == p.judgement) {
            Some(group) => group.push(p),
            None => groups.push(vec![p]),
        }
    }
    groups
}

/// Lines of excluded pairs with one reason: one a pair, or one for all of them with the nearest pair.
fn excluded_row(mechanism: &Mechanism, group: &[&PairReport]) -> String {
    let line = |p: &PairReport, who: &str| {
        // The smallest that was found: but of a rigid part nothing is proved of it.
        let is_rigid = p.judgement == Judgement::Neighbours(Neighbours::Rigid.words());
        let mark = if is_rigid { "" } else { "~" };
        let form = LengthForm::of(&[p.least.distance], mechanism.size, 4);
        let distance = format!("{mark}{}", form.length(p.least.distance));
        format!(
            "    {distance:>10}{}  {:<10} {who}: {}\n",
            inside_word(p),
            judgement_word(&p.judgement),
            judgement_reason(&p.judgement).unwrap_or_default()
        )
    };
    let name = |p: &PairReport| body_names(mechanism, p).join(" / ");
    if group.len() <= MOST_OF_ONE_REASON {
        return group.iter().map(|p| line(p, &name(p))).collect();
    }
    let distance = |p: &&&PairReport| p.least.distance;
    let nearest = group
        .iter()
        .min_by(|p, q| distance(p).total_cmp(&distance(q)));
    let folded = |p: &&PairReport| line(p, &format!("{} pairs, nearest {}", group.len(), name(p)));
    nearest.map(folded).unwrap_or_default()
}

fn inside_word(p: &PairReport) -> &'static str {
    if p.least.inside.contains(&true) {
        " (inside)"
    } else {
        ""
    }
}

/// The line of all pairs that were not examined one by one.
fn far_line(mechanism: &Mechanism, far: &FarPairs) -> String {
    let mark = if far.is_certified { "" } else { "~" };
    let bound = format!("{mark}{}", at_least_length(far.apart, mechanism.size, 4));
    format!(
        "                {bound:>12}                          {:<10} {} far apart\n",
        judgement_word(&far.judgement()),
        counted_things(far.count, "pair")
    )
}

fn pair_row(mechanism: &Mechanism, p: &PairReport) -> String {
    let [a, b] = body_names(mechanism, p);
    let form = LengthForm::of(&[p.least.distance, p.minimum], mechanism.size, 4);
    let bound = match (p.known_bound(), p.least.is_certified) {
        _ if p.touching.is_some() => "-".to_owned(),
        (Some(bound), true) => form.at_least(bound),
        (Some(bound), false) => format!("~{}", form.at_least(bound)),
        (None, _) if p.least.distance > 0.0 => NO_BOUND.to_owned(),
        // A depth: it is only known that the bodies overlap, not how deeply.
        (None, _) => "-".to_owned(),
    };
    format!(
        "    {:>10}  {bound:>12}  {:>10}  {:>10.5}  {:<10} {a} / {b}{}\n",
        form.length(p.least.distance),
        asked_words(p, |minimum| form.length(minimum)),
        p.least.time,
        judgement_word(&p.judgement),
        inside_word(p),
    )
}
