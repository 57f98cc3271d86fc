//! Clearances on a page: the table of pairs with their worst moments, and the curves of the worst pairs.

use super::curves::Curves;
use super::frames::nearest_frame;
use super::markup::{Cell, Section, Table};
use crate::charts::clearance::clearance_chart;
use crate::clearance::check::{ClearanceReport, Judgement, PairReport};
use crate::diag::decimals_of;
use crate::kinematics::results::trajectory::Trajectory;
use crate::math::narrow_vector;
use crate::model::mechanism::Mechanism;
use crate::plot::chart::Chart;
use crate::report::clearance::{
    asked_words, body_names, judgement_reason, judgement_word, pair_sentence, verdict_words,
};
use crate::report::lengths::{at_least_length, distance_text, distance_words};
use crate::report::sentences::counted_things;
use crate::report::verdict::Status;
use serde_json::{Value, json};

/// Rows of the table, and of the list of pairs that are left out.
const MOST_PAIRS: usize = 40;

/// Curves of one chart.
const MOST_CURVES: usize = 5;

/// The section, the marks of its pairs and its chart.
pub fn clearance_section(
    mechanism: &Mechanism,
    found: &ClearanceReport,
    shown: &Trajectory,
    (curves, marks): (&mut Curves, &mut Vec<Value>),
) -> Section {
    let mut section = Section::new("Clearance");
    section.text(&format!(
        "{} of bodies judged, {} excluded; lengths in {}. A bound holds at every instant, between the samples too.",
        counted_things(found.judged_count(), "pair"),
        found.excluded_count(),
        mechanism.length_unit,
    ));
    if let Some(worst) = found.worst() {
        section.text(&format!(
            "Worst moment: {}.",
            pair_sentence(mechanism, worst)
        ));
    }
    let heads = [
        "pair",
        "verdict",
        "nearest:",
        "at t / s:",
        "never below:",
        "minimum:",
        "",
    ];
    let mut table = Table::new("Pairs of bodies, the worst first", &heads);
    for pair in found.judged.iter().take(MOST_PAIRS) {
        table.rows.push(pair_row(mechanism, pair, shown, marks));
    }
    section.table(&table);
    if found.judged.len() > MOST_PAIRS {
        section.text(&format!(
            "and {} more pairs",
            found.judged.len() - MOST_PAIRS
        ));
    }
    if let Some(far) = &found.far {
        section.text(&format!(
            "{} more pairs never come closer than {} {} ({})",
            far.count,
            at_least_length(far.apart, mechanism.size, 3),
            mechanism.length_unit,
            sure(far.is_certified),
        ));
    }
    if !found.judged.is_empty() {
        let chart = clearance_chart(mechanism, found, MOST_CURVES);
        let frames = at_frames(&chart, shown);
        section.blocks.push(curves.add(chart, &frames));
    }
    section.table(&left_out(mechanism, found));
    section
}

fn pair_row(
    mechanism: &Mechanism,
    pair: &PairReport,
    shown: &Trajectory,
    marks: &mut Vec<Value>,
) -> Vec<Cell> {
    let least = &pair.least;
    let names = body_names(mechanism, pair).join(" / ");
    let status = match pair.judgement {
        Judgement::Passed => Status::Passed,
        Judgement::Failed => Status::Failed,
        _ => Status::NotProved,
    };
    let bound = pair.known_bound().map_or_else(
        || "–".to_owned(),
        |bound| {
            let bound = at_least_length(bound, mechanism.size, 6);
            format!("{bound} ({})", sure(least.is_certified))
        },
    );
    let unit = &mechanism.length_unit;
    let worst = pair.worst_moment();
    marks.push(json!({
        "points": worst.points.map(|points| points.map(narrow_vector)),
        "text": format!(
            "{names}: {} at t = {} s.",
            distance_words(worst.distance, 6, unit),
            decimals_of(worst.time, 6)
        ),
    }));
    let show = Cell::Show {
        frame: nearest_frame(shown, worst.time),
        mark: Some(marks.len() - 1),
        about: format!("the worst moment of {names}"),
    };
    vec![
        Cell::text(&names),
        Cell::State(status, verdict_words(pair, unit)),
        Cell::number(distance_text(least.distance, 6)),
        Cell::number(decimals_of(least.time, 6)),
        Cell::number(bound),
        Cell::number(asked_words(pair, |minimum| minimum.to_string())),
        show,
    ]
}

fn sure(is_certified: bool) -> &'static str {
    match is_certified {
        true => "proved",
        false => "estimated",
    }
}

/// A clearance chart at the page's frames: between samples distances are interpolated linearly, like the curves.
pub(super) fn at_frames(chart: &Chart, shown: &Trajectory) -> Chart {
    let mut frames = chart.clone();
    for panel in &mut frames.panels {
        panel.samples = shown.samples.iter().map(|s| s.time).collect();
        for series in &mut panel.series {
            let points: Vec<[f64; 2]> = series.points.iter().flatten().copied().collect();
            let at = |time: &f64| {
                let next = points.partition_point(|p| p[0] < *time);
                let right = points.get(next)?;
                let left = points.get(next.saturating_sub(1))?;
                let share = match right[0] > left[0] {
                    true => (time - left[0]) / (right[0] - left[0]),
                    false => 0.0,
                };
                Some([*time, left[1] + share * (right[1] - left[1])])
            };
            series.points = panel.samples.iter().map(at).collect();
        }
    }
    frames
}

/// Pairs that are not judged, with the reason.
fn left_out(mechanism: &Mechanism, found: &ClearanceReport) -> Table {
    let mut table = Table::new("Excluded pairs", &["pair", "why", "", "nearest:"]);
    for pair in found.excluded.iter().take(MOST_PAIRS) {
        table.rows.push(vec![
            Cell::text(body_names(mechanism, pair).join(" / ")),
            Cell::text(judgement_word(&pair.judgement)),
            Cell::text(judgement_reason(&pair.judgement).unwrap_or_default()),
            Cell::number(distance_text(pair.least.distance, 6)),
        ]);
    }
    let rest = found.excluded.len().saturating_sub(MOST_PAIRS);
    let rest = (rest > 0).then(|| (rest, "excluded".to_owned()));
    let counted = found
        .counted
        .iter()
        .map(|(judgement, count)| (*count, judgement_word(judgement).to_owned()));
    for (count, word) in rest.into_iter().chain(counted) {
        table.rows.push(vec![
            Cell::text(format!("{count} more pairs")),
            Cell::text(word),
            Cell::Empty,
            Cell::Empty,
        ]);
    }
    table
}
