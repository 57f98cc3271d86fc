//! One mechanism on a page: the questions and their answers, in the order in which an engineer asks them.

use super::checked::CheckedMotion;
use super::clearance::clearance_section;
use super::curves::{Curves, curves_section, transfer_section};
use super::frames::{nearest_frame, shown_trajectory};
use super::markup::{Cell, Section, Table};
use super::mechanism::mechanism_section;
use super::model::{motion_value, viewer_model};
use super::quantities::{ShownQuantity, extreme_table, shown_quantities};
use super::still::first_picture;
use crate::diag::decimals_of;
use crate::kinematics::motion::limits::add_limits;
use crate::kinematics::results::trajectory::{EventKind, Trajectory};
use crate::model::mechanism::Mechanism;
use crate::render::{Camera, RenderError};
use crate::report::event_sentences::{event_sentence, gap_sentence};
use crate::report::verdict::{CLEARANCE, Case, Status, Verdict};
use crate::sorting::sort_by_number;
use serde_json::{Value, json};

/// Most rows of a table on a page.
const MOST_ROWS: usize = 60;

/// A mechanism's part of a page, ready to be written.
#[derive(Clone, Debug)]
pub struct Article {
    /// Title of the scene.
    pub title: String,
    /// Where the scene is from.
    pub(super) source: String,
    /// The worst answer.
    pub(super) status: Status,
    /// The result in words.
    pub(super) result: String,
    /// A picture as PNG.
    pub(super) still: Option<Vec<u8>>,
    /// Why there is no 3-D view.
    pub(super) note: Option<String>,
    /// Names and units of the values that follow the slider.
    pub(super) values: Vec<(String, String)>,
    /// Everything below the picture.
    pub(super) sections: Vec<Section>,
    /// What the page's script reads.
    pub(super) data: Value,
}

/// The article of a motion that was checked.
///
/// Errors: the picture cannot be drawn.
pub fn article_of(checked: &CheckedMotion, number: usize) -> Result<Article, RenderError> {
    if checked.trajectory.poses().next().is_none() {
        return Ok(article_without_motion(
            checked.source,
            &checked.answer.verdict,
        ));
    }
    let shown = shown_frames(checked);
    let picture = first_picture(checked.scene, &shown)?;
    let camera = Some((&picture.camera, picture.aspect));
    let mut article = article_of_frames(checked, &shown, camera, number);
    article.still = Some(picture.png);
    Ok(article)
}

/// The same for a page that already shows the mechanism: without a picture and without its own camera.
pub(super) fn article_in_view(checked: &CheckedMotion, number: usize) -> Article {
    match checked.trajectory.poses().next() {
        None => article_without_motion(checked.source, &checked.answer.verdict),
        Some(_) => article_of_frames(checked, &shown_frames(checked), None, number),
    }
}

fn shown_frames(checked: &CheckedMotion) -> Trajectory {
    let actuation = &checked.scene.actuation;
    shown_trajectory(
        checked.system,
        actuation,
        checked.trajectory,
        checked.clearances,
    )
}

fn article_of_frames(
    checked: &CheckedMotion,
    shown: &Trajectory,
    camera: Option<(&Camera, f64)>,
    number: usize,
) -> Article {
    let CheckedMotion {
        scene,
        system,
        trajectory,
        ..
    } = *checked;
    let mut article = article_without_motion(checked.source, &checked.answer.verdict);
    // A page that shows the mechanism already knows its shapes.
    let model = match camera {
        Some(_) => viewer_model(scene, (trajectory, shown), camera),
        None => Ok(motion_value(&scene.mechanism, (trajectory, shown))),
    };
    let mut curves = Curves::new(scene, system, shown, number);
    let mut marks = Vec::new();
    let plots = curves_section(&mut curves);
    let transfer = transfer_section(&mut curves);
    let clearance = checked
        .clearances
        .map(|found| clearance_section(&scene.mechanism, found, shown, (&mut curves, &mut marks)));
    article.sections.extend([
        mechanism_section(checked),
        motion_section(checked, shown),
        plots,
        transfer,
    ]);
    article.sections.extend(clearance);
    article.data = json!({
        "times": frame_times(shown),
        "values": values_at(&scene.mechanism, shown),
        "charts": curves.list,
        "marks": marks,
        "model": model.as_ref().ok(),
    });
    let values = shown_quantities(&scene.mechanism);
    article.values = values.into_iter().map(|q| (q.name, q.unit)).collect();
    article.note = model.err();
    article
}

/// Seconds of all frames.
pub(super) fn frame_times(shown: &Trajectory) -> Vec<f64> {
    shown.samples.iter().map(|s| s.time).collect()
}

/// The quantities that follow the slider, with their values at all frames.
pub(super) fn values_at(mechanism: &Mechanism, shown: &Trajectory) -> Vec<Value> {
    let one = |q: ShownQuantity| json!({ "name": q.name, "unit": q.unit, "at": q.values(shown) });
    shown_quantities(mechanism).into_iter().map(one).collect()
}

/// The article of a scene without a motion to show: the questions and their answers.
pub fn article_without_motion(source: &str, verdict: &Verdict) -> Article {
    let mut answers = Section::new("Checks and results");
    let mut table = Table::new("Questions", &["about", "question", "answer", "found"]);
    // If there is a motion to show, pairs of bodies have a table of their own.
    let is_elsewhere = |case: &&Case| case.group == CLEARANCE && case.status <= Status::Passed;
    let kept = verdict.cases.iter().filter(is_elsewhere).count();
    let told = verdict.cases.iter().filter(|case| !is_elsewhere(case));
    table.rows = told
        .map(|case| {
            vec![
                Cell::text(case.group),
                Cell::text(&case.name),
                Cell::State(case.status, case.status.word().to_owned()),
                Cell::text(&case.text),
            ]
        })
        .take(MOST_ROWS)
        .collect();
    let all = table.rows.len() + kept;
    answers.table(&table);
    if kept > 0 {
        answers.text(&format!(
            "{kept} pairs of bodies keep their distance or are excluded: see Clearance."
        ));
    }
    if all < verdict.cases.len() {
        answers.text(&format!("and {} more", verdict.cases.len() - all));
    }
    Article {
        title: verdict.title.clone(),
        source: source.to_owned(),
        status: verdict.result(),
        result: verdict.sentence(),
        still: None,
        note: None,
        values: Vec::new(),
        sections: vec![answers],
        data: json!({ "times": [], "values": [], "charts": [], "marks": [], "model": null }),
    }
}

/// The motion: proofs, least and greatest values, limit positions, events and gaps.
fn motion_section(checked: &CheckedMotion, shown: &Trajectory) -> Section {
    let CheckedMotion {
        scene,
        system,
        trajectory,
        answer,
        ..
    } = *checked;
    let mechanism = &scene.mechanism;
    let mut section = Section::new("Motion and its proof");
    let mut terms = vec![(
        "Duration".to_owned(),
        format!("{} s", scene.actuation.duration),
    )];
    terms.extend(
        answer
            .motion
            .iter()
            .map(|(head, text)| (long_head(head).to_owned(), text.clone())),
    );
    section.terms(&terms);
    section.table(&extreme_table(mechanism, shown));
    let mut limits = Trajectory {
        samples: trajectory.samples.clone(),
        ..Trajectory::default()
    };
    add_limits(system, &scene.actuation, &mut limits);
    let turning = limits
        .events
        .iter()
        .filter(|e| matches!(e.kind, EventKind::LimitPosition { .. }));
    let mut table = Table::new(
        "Limit positions, events and gaps",
        &["t / s:", "what happens", ""],
    );
    let row = |time: f64, text: String| {
        vec![
            Cell::number(decimals_of(time, 6)),
            Cell::text(&text),
            Cell::Show {
                frame: nearest_frame(shown, time),
                mark: None,
                about: text,
            },
        ]
    };
    let told = trajectory.events.iter();
    let told = told.filter(|event| !event.kind.is_told_by_gap());
    let mut rows: Vec<(f64, Vec<Cell>)> = turning
        .chain(told)
        .map(|event| {
            (
                event.time,
                row(event.time, event_sentence(mechanism, event)),
            )
        })
        .collect();
    rows.extend(trajectory.gaps.iter().map(|gap| {
        let time = gap
            .from
            .as_ref()
            .or(gap.until.as_ref())
            .map_or(0.0, |at| at.time);
        (time, row(time, gap_sentence(mechanism, gap)))
    }));
    sort_by_number(&mut rows, |a| a.0);
    let more = rows.len().saturating_sub(MOST_ROWS);
    table.rows = rows
        .into_iter()
        .take(MOST_ROWS)
        .map(|(_, row)| row)
        .collect();
    section.table(&table);
    if more > 0 {
        section.text(&format!("and {more} more"));
    }
    section
}

/// Headings in place of the report's abbreviations.
fn long_head(head: &str) -> &str {
    match head {
        "samples" => "Samples",
        "closure error" => "Largest closure error",
        "smallest sigma" => "Smallest singular value (distance from a singular pose)",
        "condition" => "Largest condition number",
        "branch" => "Assembly branch",
        "certificate" => "Certificate of the poses",
        "motion" => "Certificate between the poses",
        "assumed" => "The proofs assume",
        other => other,
    }
}
