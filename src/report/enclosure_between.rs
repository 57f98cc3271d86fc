//! Results proved between the samples, in words and as objects of a document.

use super::cells::aligned_rows;
use super::enclosure::{bounded_end, outer_end};
use crate::analysis::enclosure::{SpanBands, TolerancePlan, shown_names};
use crate::model::printed::shortest_decimal;
use serde_json::{Map, Value, json};

/// Bounds for every piece over the whole motion, including the times between the samples.
pub fn between_lines(plan: &TolerancePlan, stretches: &[SpanBands]) -> String {
    let mechanism = plan.family.mechanism();
    let proved: Vec<&Vec<[f64; 2]>> = stretches
        .iter()
        .filter_map(|s| s.bands.as_ref().ok())
        .collect();
    let mut text = format!(
        "\nAt all times: poses of {} of {} stretches proved\n",
        proved.len(),
        stretches.len()
    );
    let mut rows = vec![
        [
            match proved.len() == stretches.len() {
                true => "over the motion",
                false => "over what is proved",
            },
            "never below",
            "never above",
        ]
        .map(str::to_owned)
        .to_vec(),
    ];
    for (index, (name, kind)) in shown_names(mechanism).into_iter().enumerate() {
        let ends = proved.iter().filter_map(|bands| bands.get(index));
        let all = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |all, [lo, hi]| {
            [all[0].min(*lo), all[1].max(*hi)]
        });
        let [lo, hi] =
            [(all[0], -1.0), (all[1], 1.0)].map(|(v, side)| outer_end(v, kind, mechanism, side));
        rows.push(vec![name, lo, hi]);
    }
    text.push_str(&aligned_rows(&rows));
    let refused = stretches.iter().find(|s| s.bands.is_err());
    if let Some(stretch) = refused {
        text += &format!(
            "  not proved from t = {} s to {} s: the first of those refused\n",
            shortest_decimal(stretch.from),
            shortest_decimal(stretch.until)
        );
    }
    text
}

/// The same as objects of a document.
pub fn between_objects(plan: &TolerancePlan, list: &[SpanBands]) -> Value {
    let mechanism = plan.family.mechanism();
    let names = shown_names(mechanism);
    let object = |stretch: &SpanBands| {
        let mut row = Map::new();
        row.insert("from".to_owned(), json!(stretch.from));
        row.insert("until".to_owned(), json!(stretch.until));
        row.insert("proved".to_owned(), json!(stretch.bands.is_ok()));
        let bands = stretch.bands.iter().flatten();
        for ((name, kind), [lo, hi]) in names.iter().zip(bands) {
            for (value, side, word) in [(lo, -1.0, "lo"), (hi, 1.0, "hi")] {
                let shown = bounded_end(*value, *kind, mechanism, side);
                row.insert(format!("{name}.{word}"), json!(shown));
            }
        }
        Value::Object(row)
    };
    Value::Array(list.iter().map(object).collect())
}
