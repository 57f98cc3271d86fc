//! The chart of a work-precision study: time per pose over error.

use crate::analysis::routes::{RotationForm, Route};
use crate::analysis::work_precision::{PrecisionRow, PrecisionStudy};
use crate::model::mechanism::Mechanism;
use crate::plot::{Axis, Chart, Panel, PlotSeries, ScaleKind, SeriesStyle};
use crate::sorting::sort_by_number;

/// Errors below this fraction of the size are drawn here: zero has no place on a logarithmic axis.
const LEAST_SHOWN: f64 = 1e-17;

/// Time per pose over error, both logarithmic; one curve per family, fastest and most exact towards the lower left.
pub fn precision_chart(mechanism: &Mechanism, study: &PrecisionStudy) -> Chart {
    let mut families: Vec<&str> = Vec::new();
    let shown: Vec<&PrecisionRow> = study.rows.iter().filter(|r| is_shown(r, study)).collect();
    for row in &shown {
        if !families.contains(&row.family) {
            families.push(row.family);
        }
    }
    let least = LEAST_SHOWN * mechanism.size;
    let series = families.into_iter().map(|family| {
        let rows = shown.iter().filter(|r| r.family == family);
        let mut points: Vec<[f64; 2]> = rows.map(|r| [r.error.max(least), r.time]).collect();
        sort_by_number(&mut points, |a| a[0]);
        PlotSeries {
            name: family.to_owned(),
            points: points.into_iter().map(Some).collect(),
            style: SeriesStyle::Dots,
            ..PlotSeries::default()
        }
    });
    let axis = |label: &str, unit: &str| Axis {
        label: label.to_owned(),
        unit: unit.to_owned(),
        scale: ScaleKind::Log,
        tight: false,
    };
    Chart {
        title: format!("{}: work against precision", mechanism.title),
        description: format!(
            "Microseconds per pose against the largest error of {} poses, by route",
            study.poses
        ),
        panels: vec![Panel {
            x: axis("largest error", &mechanism.length_unit),
            y: axis("time per pose", "µs"),
            series: series.filter(|s| !s.points.is_empty()).collect(),
            ..Panel::default()
        }],
        notes: vec![format!(
            "{} unknowns, {} poses",
            study.unknowns, study.poses
        )],
    }
}

/// Whether a row is a point of the chart. The skew residual coincides with the rotation vector's curve, and Newton
/// needs no smaller steps; both are in the table.
fn is_shown(row: &PrecisionRow, study: &PrecisionStudy) -> bool {
    let is_variant = match row.route {
        Some(Route::Position { form, .. }) => {
            form == RotationForm::Skew || row.steps != study.poses
        }
        _ => false,
    };
    row.error.is_finite() && row.lost == 0 && !is_variant
}
