//! The clearance report as an object of the JSON document.

use super::clearance::{
    body_names, judgement_reason, judgement_word, left_out_shapes, shape_names,
};
use super::pieces::pieces_document;
use super::verdict::Status;
use crate::clearance::check::{ClearanceReport, Judgement, PairReport, Violation, Violations};
use crate::clearance::touching::MustTouch;
use crate::model::mechanism::Mechanism;
use glam::DVec3;
use serde_json::{Value, json};

/// The report as the `clearance` object of `mechanim-check/1`; `result` is the result of its cases, and pairs within
/// `band` of their minimum are near.
pub fn to_json(
    mechanism: &Mechanism,
    report: &ClearanceReport,
    (result, band): (Status, Option<f64>),
) -> Value {
    let pair = |p: &PairReport| {
        let judged = judgement_reason(&p.judgement).is_none();
        let mut value = json!({
            "bodies": body_names(mechanism, p),
            "verdict": judgement_word(&p.judgement),
            "distance": p.least.distance,
            "minimum": p.minimum,
            "time": p.least.time,
            "points": points_json(p.least.moment().points),
            "shapes": shape_names(mechanism, p),
            "inside": p.least.inside,
        });
        if let Some(object) = value.as_object_mut() {
            if judged {
                object.insert("class".to_owned(), json!(p.class(band).word()));
                object.insert("bound".to_owned(), json!(p.known_bound()));
                object.insert("certified".to_owned(), json!(p.least.is_certified));
                object.insert("refined".to_owned(), json!(p.least.is_refined));
                object.insert("slack".to_owned(), json!(p.slack));
                if let Some(violations) = &p.violations {
                    object.insert("violations".to_owned(), violations_json(violations));
                }
                if let Some(touching) = &p.touching {
                    object.insert("farthest".to_owned(), json!(p.known_farthest()));
                    object.insert("touching".to_owned(), touching_json(p, touching));
                }
            }
            if let Some(reason) = judgement_reason(&p.judgement) {
                object.insert("reason".to_owned(), json!(reason));
                let shapes = left_out_shapes(mechanism, p);
                if !shapes.is_empty() {
                    object.insert("left_out".to_owned(), json!(shapes));
                }
            }
        }
        value
    };
    let pieces = report.pieces.as_ref();
    json!({
        "pieces": pieces.map(|pieces| pieces_document(mechanism, pieces)),
        "unit": mechanism.length_unit,
        "tolerance": report.tolerance,
        "passed": result == Status::Passed,
        "judged": report.judged_count(),
        "pairs": report.judged.iter().map(pair).collect::<Vec<_>>(),
        "far": report.far.map(|far| json!({
            "pairs": far.count,
            "verdict": judgement_word(&far.judgement()),
            "bound": far.apart,
            "certified": far.is_certified,
        })),
        "excluded": report.excluded.iter().map(pair).collect::<Vec<_>>(),
        "counted": report.counted.iter().map(counted_judgement).collect::<Vec<_>>(),
        "unchecked": report.gaps,
        "warnings": report.warnings,
    })
}

/// Two points, or null.
fn points_json(points: Option<[DVec3; 2]>) -> Value {
    json!(points.map(|points| points.map(|q| q.to_array())))
}

/// Where bodies that must touch are farthest apart, and whether that, or an overlap, is more than is allowed.
fn touching_json(p: &PairReport, touching: &MustTouch) -> Value {
    json!({
        "apart": touching.apart.distance,
        "time": touching.apart.time,
        "points": points_json(touching.apart.points),
        "allowed": touching.allowed,
        "parted": p.parted().is_some(),
        "overlaps": p.is_pressed(),
    })
}

/// When a pair is too near.
fn violations_json(violations: &Violations) -> Value {
    let one = |v: &Violation| {
        json!({
            "from": v.from,
            "to": v.to,
            "seen": v.is_seen,
            "distance": v.distance,
            "time": v.time,
        })
    };
    json!({
        "certified": violations.is_certified,
        "intervals": violations.list.iter().map(one).collect::<Vec<_>>(),
    })
}

/// Excluded pairs of which only the number is reported.
fn counted_judgement((judgement, count): &(Judgement, usize)) -> Value {
    json!({
        "verdict": judgement_word(judgement),
        "reason": judgement_reason(judgement),
        "pairs": count,
    })
}
