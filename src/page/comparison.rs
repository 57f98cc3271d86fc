//! Two versions of a scene on one page: the effect of a change on the answers, the curves, the clearances and the
//! pictures.

use super::article::{Article, article_of, article_without_motion, frame_times};
use super::checked::CheckedMotion;
use super::clearance::at_frames;
use super::curves::{Curves, shown_plots};
use super::document::linked_text;
use super::frames::shown_trajectory;
use super::markup::{Cell, Section, Table};
use super::quantities::extreme_values;
use crate::charts::clearance::clearance_chart;
use crate::charts::motion::motion_chart;
use crate::clearance::check::PairReport;
use crate::diag::decimals_of;
use crate::kinematics::motion::continuation::{solve_motion, solve_with_ends};
use crate::kinematics::results::trajectory::Trajectory;
use crate::plot::chart::{Chart, SeriesStyle};
use crate::render::RenderError;
use crate::report::clearance::{body_names, verdict_words};
use crate::report::lengths::{at_least_length, distance_text};
use crate::report::verdict::{Case, Verdict};
use serde_json::json;

/// Most rows of a table on a page.
const MOST_ROWS: usize = 80;

/// Pairs of bodies whose distances are drawn.
const MOST_CURVES: usize = 4;

/// Samples of a curve: every one and a half degrees of a turn.
const SAMPLES: usize = 241;

/// A version of a scene, judged.
#[derive(Clone, Copy)]
pub struct Version<'a> {
    /// Where it is from.
    pub source: &'a str,
    /// Its answers.
    pub verdict: &'a Verdict,
    /// Its motion, if there is one.
    pub checked: Option<&'a CheckedMotion<'a>>,
    /// Its parameters as they are written.
    pub parameters: &'a [(String, String)],
}

/// The page of two versions.
///
/// Errors: a picture cannot be drawn.
pub fn comparison_text(old: Version, new: Version) -> Result<String, RenderError> {
    let mut articles = [drawn_version(old, 1)?, drawn_version(new, 2)?];
    let mut sections = vec![
        answers_section(old, new),
        parameters_section(old.parameters, new.parameters),
    ];
    if let (Some(before), Some(after)) = (old.checked, new.checked) {
        sections.push(values_section(before, after));
        let shown = shown_of(after);
        let mut curves = Curves::new(after.scene, after.system, &shown, 2);
        sections.push(curves_section(before, after, (&shown, &mut curves)));
        sections.push(clearance_section(before, after, (&shown, &mut curves)));
        articles[1].data["charts"] = json!(curves.list);
        look_alike(&mut articles);
    }
    Ok(linked_text(&articles, &sections))
}

/// A version's picture and verdict; the comparison follows below.
fn drawn_version(version: Version, number: usize) -> Result<Article, RenderError> {
    let mut article = match version.checked {
        Some(checked) => article_of(checked, number)?,
        None => article_without_motion(version.source, version.verdict),
    };
    article.sections.clear();
    article.data["charts"] = json!([]);
    article.data["marks"] = json!([]);
    Ok(article)
}

fn shown_of(checked: &CheckedMotion) -> Trajectory {
    let (system, actuation) = (checked.system, &checked.scene.actuation);
    shown_trajectory(system, actuation, checked.trajectory, checked.clearances)
}

/// Both are seen from the direction of the new one.
fn look_alike(articles: &mut [Article; 2]) {
    let camera = articles[1].data["model"]["camera"].clone();
    if camera.is_object() && articles[0].data["model"].is_object() {
        articles[0].data["model"]["camera"] = camera;
    }
}

/// Every question whose answer or numbers have changed.
fn answers_section(old: Version, new: Version) -> Section {
    let mut section = Section::new("What has changed");
    let mut table = Table::new(
        "Checks with different results",
        &["about", "question", "old", "", "new", ""],
    );
    let key = |case: &Case| (case.group, case.name.clone());
    let find = |list: &[Case], wanted: &Case| list.iter().find(|c| key(c) == key(wanted)).cloned();
    let (before, after) = (&old.verdict.cases, &new.verdict.cases);
    let gone = before.iter().filter(|case| find(after, case).is_none());
    for case in after.iter().chain(gone) {
        let pair = [find(before, case), find(after, case)];
        let is_same =
            matches!(&pair, [Some(a), Some(b)] if a.status == b.status && a.text == b.text);
        if is_same {
            continue;
        }
        let mut row = vec![Cell::text(case.group), Cell::text(&case.name)];
        for side in pair {
            row.extend(match side {
                Some(case) => [
                    Cell::State(case.status, case.status.word().to_owned()),
                    Cell::text(&case.text),
                ],
                None => [Cell::text("not asked"), Cell::Empty],
            });
        }
        table.rows.push(row);
    }
    match table.rows.len() {
        0 => section.text("All checks have the same results, to the last digit shown."),
        all => {
            table.rows.truncate(MOST_ROWS);
            section.table(&table);
            if all > MOST_ROWS {
                section.text(&format!("and {} more", all - MOST_ROWS));
            }
        }
    }
    section
}

/// Changed parameters.
fn parameters_section(old: &[(String, String)], new: &[(String, String)]) -> Section {
    let mut section = Section::new("Parameters");
    let mut table = Table::new("Changed parameters", &["parameter", "old:", "new:"]);
    let find = |list: &[(String, String)], name: &str| {
        let found = list.iter().find(|(other, _)| other == name);
        found.map(|(_, text)| text.clone())
    };
    let gone = old.iter().filter(|(name, _)| find(new, name).is_none());
    for (name, _) in new.iter().chain(gone) {
        let pair = [find(old, name), find(new, name)];
        if pair[0] != pair[1] {
            let mut row = vec![Cell::text(name)];
            row.extend(pair.map(|text| Cell::number(text.unwrap_or_else(|| "–".to_owned()))));
            table.rows.push(row);
        }
    }
    section.table(&table);
    section
}

/// Smallest and largest values, side by side.
fn values_section(old: &CheckedMotion, new: &CheckedMotion) -> Section {
    let mut section = Section::new("Values");
    let mut table = Table::new(
        "Smallest and largest values among the poses shown",
        &[
            "quantity",
            "least, old:",
            "new:",
            "difference:",
            "greatest, old:",
            "new:",
            "difference:",
        ],
    );
    // Quantities are matched by name and unit; those that only the old version has are not listed.
    let [before, after] = [old, new].map(|c| extreme_values(&c.scene.mechanism, &shown_of(c)));
    for (name, unit, now) in &after {
        let was = before
            .iter()
            .find(|(other, of, _)| other == name && of == unit);
        let mut row = vec![Cell::text(format!("{name} {unit}").trim_end())];
        // Least, then greatest: old, new and difference.
        for end in 0..2 {
            let number = |v: f64| Cell::number(decimals_of(v, 6));
            row.extend(match was {
                Some((_, _, was)) => [
                    number(was[end]),
                    number(now[end]),
                    Cell::number(signed_change(now[end] - was[end])),
                ],
                None => [Cell::Empty, number(now[end]), Cell::Empty],
            });
        }
        table.rows.push(row);
    }
    section.table(&table);
    section
}

/// The plots of the new version with the curves of the old one dashed in them.
fn curves_section(
    old: &CheckedMotion,
    new: &CheckedMotion,
    (shown, curves): (&Trajectory, &mut Curves),
) -> Section {
    let mut section = Section::new("Curves");
    let chart = |checked: &CheckedMotion, motion: &Trajectory| {
        let actuation = &checked.scene.actuation;
        motion_chart(
            checked.system,
            actuation,
            &shown_plots(checked.scene),
            motion,
        )
    };
    let fine = |checked: &CheckedMotion| {
        let duration = checked.scene.actuation.duration;
        let time = |k: usize| duration * k as f64 / (SAMPLES - 1) as f64;
        let times: Vec<f64> = (0..SAMPLES).map(time).collect();
        chart(
            checked,
            &solve_with_ends(checked.system, &checked.scene.actuation, &times, &|| false),
        )
    };
    // The old motion at the frames of the new one, as far as it lasts.
    let duration = old.scene.actuation.duration;
    let times: Vec<f64> = frame_times(shown)
        .into_iter()
        .filter(|t| *t <= duration)
        .collect();
    let frames_of_old = chart(old, &solve_motion(old.system, &old.scene.actuation, &times));
    let both = overlaid_chart(fine(new), &fine(old), usize::MAX);
    let frames = overlaid_chart(chart(new, shown), &frames_of_old, shown.samples.len());
    if both.panels.iter().any(|panel| !panel.series.is_empty()) {
        section.text("Dashed: the old version.");
        section.blocks.push(curves.add(both, &frames));
    }
    section
}

/// A chart with the series of another one dashed in its panels, as far as their axes are the same. Series at frames are made as
/// long as there are frames.
fn overlaid_chart(mut chart: Chart, old: &Chart, frames: usize) -> Chart {
    for panel in &mut chart.panels {
        let mut alike = old
            .panels
            .iter()
            .filter(|p| p.x == panel.x && p.y.unit == panel.y.unit);
        let named: Vec<&String> = panel.series.iter().map(|s| &s.name).collect();
        let shares =
            |p: &&crate::plot::chart::Panel| p.series.iter().any(|s| named.contains(&&s.name));
        let Some(before) = alike.find(shares) else {
            continue;
        };
        for series in &before.series {
            let mut series = series.clone();
            series.name = format!("{} (old)", series.name);
            series.style = SeriesStyle::Dashed;
            if frames != usize::MAX {
                series.points.resize(frames, None);
            }
            panel.series.push(series);
        }
    }
    chart
}

/// Distances of all pairs that either version judges.
fn clearance_section(
    old: &CheckedMotion,
    new: &CheckedMotion,
    (shown, curves): (&Trajectory, &mut Curves),
) -> Section {
    let mut section = Section::new("Clearance");
    let (Some(before), Some(after)) = (old.clearances, new.clearances) else {
        if old.clearances.is_some() || new.clearances.is_some() {
            section.text("Only one of the versions has a section [clearance].");
        }
        return section;
    };
    let unit = &new.scene.mechanism.length_unit;
    section.text(&format!(
        "Lengths in {unit}. A bound holds at every instant, between the samples too."
    ));
    // Pairs are matched by the names of their bodies: their indices may differ.
    let names = |checked: &CheckedMotion, pair: &PairReport| {
        body_names(&checked.scene.mechanism, pair).map(str::to_owned)
    };
    let mut table = Table::new(
        "Pairs of bodies, the worst of the new version first",
        &[
            "pair",
            "old",
            "nearest:",
            "never below:",
            "new",
            "nearest:",
            "never below:",
            "difference:",
        ],
    );
    let cells = |checked: &CheckedMotion, pair: Option<&PairReport>| match pair {
        Some(pair) => [
            Cell::text(verdict_words(pair, &checked.scene.mechanism.length_unit)),
            Cell::number(distance_text(pair.least.distance, 6)),
            match pair.known_bound().filter(|_| pair.least.is_certified) {
                Some(bound) => {
                    let size = checked.scene.mechanism.size;
                    Cell::number(at_least_length(bound, size, 6))
                }
                None => Cell::number("not proved"),
            },
        ],
        None => [Cell::text("not judged"), Cell::Empty, Cell::Empty],
    };
    // Lengths in another unit are not compared.
    let is_alike = old.scene.mechanism.length_unit == *unit;
    if !is_alike {
        section.text(&format!(
            "The old version is in {}: its distances are not compared.",
            old.scene.mechanism.length_unit
        ));
    }
    let of = |pair: &PairReport| {
        let mut alike = before.judged.iter().filter(|_| is_alike);
        alike.find(|p| names(old, p) == names(new, pair))
    };
    // First the pairs of the new version, ...
    for pair in &after.judged {
        let was = of(pair);
        let mut row = vec![Cell::text(names(new, pair).join(" / "))];
        row.extend(cells(old, was));
        row.extend(cells(new, Some(pair)));
        // Two overlaps without end do not differ by a number.
        let change = was.map(|was| pair.least.distance - was.least.distance);
        let change = change.filter(|change| change.is_finite());
        row.push(change.map_or(Cell::Empty, |c| Cell::number(signed_change(c))));
        table.rows.push(row);
    }
    // ... then those that only the old one judges.
    let is_gone = |pair: &&PairReport| {
        after
            .judged
            .iter()
            .all(|p| names(new, p) != names(old, pair))
    };
    for pair in before.judged.iter().filter(|_| is_alike).filter(is_gone) {
        let mut row = vec![Cell::text(names(old, pair).join(" / "))];
        row.extend(cells(old, Some(pair)));
        row.extend(cells(new, None));
        row.push(Cell::Empty);
        table.rows.push(row);
    }
    table.rows.truncate(MOST_ROWS);
    section.table(&table);
    if !after.judged.is_empty() {
        // Both versions in one chart.
        let chart = clearance_chart(&new.scene.mechanism, after, MOST_CURVES);
        let other = clearance_chart(&old.scene.mechanism, before, before.judged.len().max(1));
        let both = match is_alike {
            true => with_pairs_of(chart, &other),
            false => chart,
        };
        let frames = at_frames(&both, shown);
        section.blocks.push(curves.add(both, &frames));
    }
    section
}

/// A difference with its sign.
fn signed_change(change: f64) -> String {
    let sign = if change > 0.0 { "+" } else { "" };
    format!("{sign}{}", decimals_of(change, 6))
}

/// The curves of the same pairs in the old version, dashed.
fn with_pairs_of(mut chart: Chart, old: &Chart) -> Chart {
    for panel in &mut chart.panels {
        let known: Vec<String> = panel.series.iter().map(|s| s.name.clone()).collect();
        let others = old.panels.iter().flat_map(|p| &p.series);
        for series in others.filter(|s| known.contains(&s.name)) {
            let mut series = series.clone();
            series.name = format!("{} (old)", series.name);
            series.style = SeriesStyle::Dashed;
            panel.series.push(series);
        }
    }
    chart
}
