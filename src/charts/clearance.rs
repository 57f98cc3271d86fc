//! The chart of a clearance report: distance over time of the worst pairs, with their minimum and the worst moment.

use crate::clearance::check::{ClearanceReport, PairReport};
use crate::model::mechanism::Mechanism;
use crate::plot::chart::{Axis, Chart, EventMark, Panel, PlotSeries, Shade};
use crate::report::rounded::not_below;

/// What a pair never comes below, if that says anything: a depth has no bound.
fn chart_bound(pair: &PairReport) -> Option<f64> {
    let least = &pair.least;
    let is_one = least.distance > 0.0 && least.bound.is_finite() && least.bound >= 0.0;
    is_one.then_some(least.bound)
}

/// One curve a pair, the `most` worst ones; the dashed line is the minimum asked for, the mark the worst moment.
pub fn clearance_chart(mechanism: &Mechanism, report: &ClearanceReport, most: usize) -> Chart {
    let shown = &report.judged[..most
        .clamp(1, report.judged.len().max(1))
        .min(report.judged.len())];
    let name = |k: usize| mechanism.bodies[k].name.as_str();
    let mut panel = Panel {
        x: Axis {
            label: "time".to_owned(),
            unit: "s".to_owned(),
            tight: true,
            ..Axis::default()
        },
        y: Axis {
            label: "clearance".to_owned(),
            unit: mechanism.length_unit.clone(),
            ..Axis::default()
        },
        samples: report.times.clone(),
        ..Panel::default()
    };
    let mut minima: Vec<f64> = Vec::new();
    for pair in shown {
        let [a, b] = pair.pair.map(name);
        // The least distance lies between samples as a rule: it belongs to the curve.
        let mut points: Vec<[f64; 2]> = report
            .times
            .iter()
            .copied()
            .zip(pair.distances.iter().copied())
            .map(<[f64; 2]>::from)
            .collect();
        points.push([pair.least.time, pair.least.distance]);
        points.sort_by(|p, q| p[0].total_cmp(&q[0]));
        panel.series.push(PlotSeries {
            name: format!("{a} / {b}"),
            points: points.into_iter().map(Some).collect(),
            ..PlotSeries::default()
        });
        if !minima.contains(&pair.minimum) {
            minima.push(pair.minimum);
        }
    }
    let worst = report.worst();
    if let (Some(first), Some(last)) = (report.times.first(), report.times.last()) {
        let bound = worst.and_then(chart_bound).into_iter();
        let levels = minima.iter().copied().chain(bound);
        panel.lines = levels.map(|v| [[*first, v], [*last, v]]).collect();
    }
    let mut chart = Chart {
        title: mechanism.title.clone(),
        ..Chart::default()
    };
    if let Some(worst) = worst {
        let least = &worst.least;
        let [a, b] = worst.pair.map(name);
        let unit = &mechanism.length_unit;
        if shown.len() == 1 {
            panel.title = format!("{a} / {b}");
        }
        let known = match (chart_bound(worst), least.is_certified) {
            (None, _) => "a depth has no bound".to_owned(),
            (Some(bound), true) => format!("never below {} {unit} (proved)", not_below(bound, 4)),
            (Some(bound), false) => {
                format!("never below {} {unit} (estimated)", not_below(bound, 4))
            }
        };
        chart.notes.push(format!(
            "dashed: the minimum, {} is asked, and the bound of {a} / {b}, {known}",
            worst.minimum
        ));
        panel.marks.push([least.time, least.distance]);
        panel.events.push(EventMark {
            x: least.time,
            label: format!("{:.4} {}", least.distance, mechanism.length_unit),
        });
        chart.description = format!(
            "{a} and {b} come nearest, {:.6} {} at {:.6} s; {} is asked for",
            least.distance, mechanism.length_unit, least.time, worst.minimum
        );
    }
    panel.shades = report
        .gaps
        .iter()
        .map(|[from, to]| Shade {
            from: *from,
            to: *to,
            word: "not checked".to_owned(),
        })
        .collect();
    if report.judged.len() > shown.len() {
        let (shown, all) = (shown.len(), report.judged.len());
        chart
            .notes
            .push(format!("the {shown} worst of {all} pairs"));
    }
    chart.panels.push(panel);
    chart
}
