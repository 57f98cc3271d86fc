//! The clearance report as a table for people, as JSON, JUnit XML and CSV. Nothing is computed here.

use crate::clearance::check::{ClearanceReport, Judgement, PairReport};
use crate::model::mechanism::Mechanism;
use crate::model::shape::Solid;
use serde_json::{Value, json};

/// The word of a judgement in reports.
pub fn word(judgement: &Judgement) -> &'static str {
    match judgement {
        Judgement::Passed => "passed",
        Judgement::Failed => "failed",
        Judgement::Undecided => "undecided",
        Judgement::Neighbours(_) => "neighbours",
        Judgement::Ignored(_) => "ignored",
    }
}

/// Names of a pair's bodies.
pub fn names<'m>(mechanism: &'m Mechanism, pair: &PairReport) -> [&'m str; 2] {
    pair.pair.map(|body| mechanism.bodies[body].name.as_str())
}

/// `capsule 2`: the kind of a body's shape and its number, from 1.
pub fn shape_name(mechanism: &Mechanism, body: usize, shape: usize) -> String {
    let solid = mechanism.bodies[body].shapes.get(shape).map(|s| &s.solid);
    let kind = match solid {
        Some(Solid::Sphere { .. }) => "sphere",
        Some(Solid::Capsule { .. }) => "capsule",
        Some(Solid::Cylinder { .. }) => "cylinder",
        Some(Solid::Cone { .. }) => "cone",
        Some(Solid::Box { .. }) => "box",
        Some(Solid::Torus { .. }) => "torus",
        Some(Solid::Tube { .. }) => "tube",
        Some(Solid::HalfSpace { .. }) => "half-space",
        Some(Solid::Triangles(_)) => "mesh",
        None => "shape",
    };
    format!("{kind} {}", shape + 1)
}

fn shapes(mechanism: &Mechanism, pair: &PairReport) -> [String; 2] {
    [0, 1].map(|k| shape_name(mechanism, pair.pair[k], pair.least.shapes[k]))
}

/// The report as the `clearance` object of `mechanim-check/1`.
pub fn to_json(mechanism: &Mechanism, report: &ClearanceReport) -> Value {
    let pair = |p: &PairReport| {
        let judged = matches!(
            p.judgement,
            Judgement::Passed | Judgement::Failed | Judgement::Undecided
        );
        let mut value = json!({
            "bodies": names(mechanism, p),
            "verdict": word(&p.judgement),
            "distance": p.least.distance,
            "minimum": p.minimum,
            "time": p.least.time,
            "points": p.least.points.map(|q| q.to_array()),
            "shapes": shapes(mechanism, p),
            "inside": p.least.inside,
        });
        if let Some(object) = value.as_object_mut() {
            if judged {
                object.insert("bound".to_owned(), json!(p.least.bound));
                object.insert("certified".to_owned(), json!(p.least.is_certified));
                object.insert("refined".to_owned(), json!(p.least.is_refined));
                if let Some(farthest) = p.farthest {
                    object.insert("farthest".to_owned(), json!(farthest));
                }
            }
            let reason = match &p.judgement {
                Judgement::Neighbours(joint) => Some((*joint).to_owned()),
                Judgement::Ignored(reason) => Some(reason.clone()),
                _ => None,
            };
            if let Some(reason) = reason {
                object.insert("reason".to_owned(), json!(reason));
            }
        }
        value
    };
    json!({
        "unit": mechanism.length_unit,
        "tolerance": report.tolerance,
        "passed": report.passed(),
        "judged": report.judged.len(),
        "pairs": report.judged.iter().map(pair).collect::<Vec<_>>(),
        "excluded": report.excluded.iter().map(pair).collect::<Vec<_>>(),
        "unchecked": report.gaps,
        "warnings": report.warnings,
    })
}

/// A text for XML attributes and contents.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&apos;"),
            // XML 1.0 has no way to write other control characters.
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// One sentence on a pair.
pub fn sentence(mechanism: &Mechanism, p: &PairReport) -> String {
    let unit = &mechanism.length_unit;
    let [first, second] = shapes(mechanism, p);
    let least = &p.least;
    let what = if least.distance < 0.0 {
        format!("overlap by {:.6} {unit}", -least.distance)
    } else {
        format!("come within {:.6} {unit}", least.distance)
    };
    let [a, b] = names(mechanism, p);
    format!(
        "`{a}` ({first}) and `{b}` ({second}) {what} at t = {:.6} s; {:.6} {unit} are asked",
        least.time, p.minimum
    )
}

/// JUnit XML: one case a pair, excluded ones skipped with their reason.
pub fn to_junit(mechanism: &Mechanism, report: &ClearanceReport) -> String {
    let failures = report
        .judged
        .iter()
        .filter(|p| p.judgement != Judgement::Passed)
        .count();
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite name=\"{} clearance\" tests=\"{}\" failures=\"{failures}\" skipped=\"{}\">\n",
        escaped(&mechanism.title),
        report.judged.len() + report.excluded.len(),
        report.excluded.len(),
    );
    for p in report.judged.iter().chain(&report.excluded) {
        let [a, b] = names(mechanism, p);
        let name = escaped(&format!("{a} / {b}"));
        text.push_str(&format!(
            "    <testcase classname=\"clearance\" name=\"{name}\""
        ));
        let message = escaped(&sentence(mechanism, p));
        match &p.judgement {
            Judgement::Passed => text.push_str("/>\n"),
            Judgement::Failed => text.push_str(&format!(
                ">\n      <failure message=\"{message}\"/>\n    </testcase>\n"
            )),
            Judgement::Undecided => text.push_str(&format!(
                ">\n      <failure message=\"not decided, the bound is {:.6}: {message}\"/>\n    </testcase>\n",
                p.least.bound
            )),
            Judgement::Neighbours(joint) => text.push_str(&format!(
                ">\n      <skipped message=\"neighbours: {}\"/>\n    </testcase>\n",
                escaped(joint)
            )),
            Judgement::Ignored(reason) => text.push_str(&format!(
                ">\n      <skipped message=\"ignored: {}\"/>\n    </testcase>\n",
                escaped(reason)
            )),
        }
    }
    text.push_str("  </testsuite>\n</testsuites>\n");
    text
}

/// A CSV cell: quoted where it has to be.
fn cell(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// CSV: time, then one column of distances a judged pair.
pub fn to_csv(mechanism: &Mechanism, report: &ClearanceReport) -> String {
    let mut text = String::from("time");
    for p in &report.judged {
        let [a, b] = names(mechanism, p);
        text.push(',');
        text.push_str(&cell(&format!("{a} / {b}")));
    }
    text.push('\n');
    for (row, time) in report.times.iter().enumerate() {
        text.push_str(&time.to_string());
        for p in &report.judged {
            text.push(',');
            if let Some(distance) = p.distances.get(row) {
                text.push_str(&distance.to_string());
            }
        }
        text.push('\n');
    }
    text
}

/// The worst pairs, then what was left out.
pub fn table(mechanism: &Mechanism, found: &ClearanceReport, worst: usize) -> String {
    let unit = &mechanism.length_unit;
    let mut text = format!(
        "  clearance        {} pairs judged, {} excluded; lengths in {unit}\n",
        found.judged.len(),
        found.excluded.len()
    );
    if !found.judged.is_empty() {
        text.push_str("      distance   never below     minimum      at t/s  verdict    pair\n");
    }
    for p in found.judged.iter().take(worst) {
        text.push_str(&row(mechanism, p));
        if let Some(farthest) = p.farthest {
            let sure = if p.least.is_certified {
                "proved"
            } else {
                "estimated"
            };
            text.push_str(&format!(
                "                  touching: between the samples from {:.2e} to {farthest:.2e} {unit} apart ({sure})\n",
                p.least.bound
            ));
        }
    }
    if found.judged.len() > worst {
        let rest = found.judged.len() - worst;
        text.push_str(&format!(
            "    and {rest} more (--worst {})\n",
            found.judged.len()
        ));
    }
    for p in &found.excluded {
        let [a, b] = names(mechanism, p);
        let (kind, why) = match &p.judgement {
            Judgement::Ignored(reason) => ("ignored", reason.as_str()),
            Judgement::Neighbours(joint) => ("neighbours", *joint),
            other => (word(other), ""),
        };
        text.push_str(&format!(
            "    {:>10.4}{}  {kind:<10} {a} / {b}: {why}\n",
            p.least.distance,
            inside(p)
        ));
    }
    for [start, end] in &found.gaps {
        text.push_str(&format!(
            "    not checked from t = {start:.6} s to {end:.6} s\n"
        ));
    }
    text
}

fn inside(p: &PairReport) -> &'static str {
    if p.least.inside.contains(&true) {
        " (inside)"
    } else {
        ""
    }
}

fn row(mechanism: &Mechanism, p: &PairReport) -> String {
    let [a, b] = names(mechanism, p);
    // A depth has no bound: it is only known that the bodies overlap.
    let bound = match (
        p.least.distance > 0.0 && p.farthest.is_none(),
        p.least.is_certified,
    ) {
        (false, _) => "-".to_owned(),
        (true, true) => format!("{:.4}", p.least.bound),
        (true, false) => format!("~{:.4}", p.least.bound),
    };
    format!(
        "    {:>10.4}  {bound:>12}  {:>10.4}  {:>10.5}  {:<10} {a} / {b}{}\n",
        p.least.distance,
        p.minimum,
        p.least.time,
        word(&p.judgement),
        inside(p),
    )
}
