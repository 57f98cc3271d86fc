//! The chart of a clearance report: distance over time of the worst pairs, with their minimum and the worst moment.

use crate::clearance::check::{ClearanceReport, PairReport};
use crate::diag::decimals_of;
use crate::model::mechanism::Mechanism;
use crate::plot::chart::{Axis, Chart, EventMark, Panel, PlotSeries, Shade};
use crate::report::clearance::pair_sentence;
use crate::report::lengths::{LengthForm, distance_words};
use crate::sorting::sort_by_number;

/// Lower bound of a pair's distance over the motion; `None` where it would lie below the chart.
fn chart_bound(pair: &PairReport) -> Option<f64> {
    let bound = pair.known_bound().filter(|bound| *bound >= 0.0);
    bound.filter(|_| pair.least.distance > 0.0)
}

/// Plots one curve per pair for the `most` pairs with the least clearance. The dashed line is the required minimum and
/// the marker the instant of least clearance.
pub fn clearance_chart(mechanism: &Mechanism, report: &ClearanceReport, most: usize) -> Chart {
    let all = report.judged.len();
    let shown = &report.judged[..most.clamp(1, all.max(1)).min(all)];
    let mut panel = empty_panel(mechanism, report);
    let curves = shown.iter().map(|pair| pair_curve(mechanism, report, pair));
    panel.series.extend(curves);
    let mut minima: Vec<f64> = Vec::new();
    for pair in shown {
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
        if shown.len() == 1 {
            panel.title = pair_name(mechanism, worst);
        }
        mark_worst(mechanism, worst, &mut panel, &mut chart);
    }
    if all > shown.len() {
        let note = format!("the {} worst of {all} pairs", shown.len());
        chart.notes.push(note);
    }
    chart.panels.push(panel);
    chart
}

fn pair_name(mechanism: &Mechanism, pair: &PairReport) -> String {
    let [a, b] = pair.pair.map(|k| mechanism.bodies[k].name.as_str());
    format!("{a} / {b}")
}

/// Axes, instants and the stretches that were not checked.
fn empty_panel(mechanism: &Mechanism, report: &ClearanceReport) -> Panel {
    let shade = |[from, to]: &[f64; 2]| Shade {
        from: *from,
        to: *to,
        word: "not checked".to_owned(),
    };
    Panel {
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
        shades: report.gaps.iter().map(shade).collect(),
        ..Panel::default()
    }
}

/// The distances of a pair. The minimum usually lies between samples, so it is added to the curve.
fn pair_curve(mechanism: &Mechanism, report: &ClearanceReport, pair: &PairReport) -> PlotSeries {
    let samples = report.times.iter().zip(&pair.distances);
    let mut points: Vec<[f64; 2]> = samples.map(|(t, d)| [*t, *d]).collect();
    let apart = pair
        .touching
        .as_ref()
        .map(|t| [t.apart.time, t.apart.distance]);
    points.push([pair.least.time, pair.least.distance]);
    points.extend(apart);
    sort_by_number(&mut points, |p| p[0]);
    PlotSeries {
        name: pair_name(mechanism, pair),
        points: points.into_iter().map(Some).collect(),
        ..PlotSeries::default()
    }
}

/// What the dashed lines are.
fn dashed_note(mechanism: &Mechanism, worst: &PairReport) -> String {
    let (least, unit) = (&worst.least, &mechanism.length_unit);
    let (pair, minimum) = (pair_name(mechanism, worst), worst.minimum);
    if worst.touching.is_some() {
        return format!("{pair} must touch: their distance has to stay 0");
    }
    let how = match least.is_certified {
        true => "proved",
        false => "estimated",
    };
    let known = chart_bound(worst).map_or_else(
        || match least.distance > 0.0 {
            true => "not above zero".to_owned(),
            false => "the depth of the overlap has no bound".to_owned(),
        },
        |bound| {
            let form = LengthForm::of(&[least.distance, minimum], mechanism.size, 4);
            format!("never below {} {unit} ({how})", form.at_least(bound))
        },
    );
    format!("dashed: the required minimum, {minimum}, and the bound of {pair}, {known}")
}

/// The worst moment in the chart, in its notes and in its description.
fn mark_worst(mechanism: &Mechanism, worst: &PairReport, panel: &mut Panel, chart: &mut Chart) {
    let (shown, unit) = (worst.worst_moment(), &mechanism.length_unit);
    chart.notes.push(dashed_note(mechanism, worst));
    if worst.least.has_end() {
        panel.marks.push([shown.time, shown.distance]);
    }
    panel.events.push(EventMark {
        x: shown.time,
        label: distance_words(shown.distance, 4, unit),
    });
    let [a, b] = worst.pair.map(|k| mechanism.bodies[k].name.as_str());
    chart.description = match worst.touching {
        Some(_) => pair_sentence(mechanism, worst),
        None => format!(
            "{a} and {b} come nearest, {} at {} s; the minimum is {}",
            distance_words(shown.distance, 6, unit),
            decimals_of(shown.time, 6),
            worst.minimum
        ),
    };
}
