//! Charts of a solved motion: the plots of a scene, evaluated at every sample. Where the motion has no pose, the chart
//! says so.

use super::coarse_samples::coarse_note;
use super::gaps::{gap_shades, leave_out_outliers};
use super::wraps::is_wrap;
use crate::kinematics::rates::columns::{RateVariable, slot_series};
use crate::kinematics::rates::rated::rate_values;
use crate::kinematics::results::trajectory::{Event, EventKind, Sample, Trajectory};
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::expression::{Expression, Op};
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::plot::{Abscissa, Plot, PlotCurve};
use crate::model::rate::RateOrder;
use crate::numbers::decimal::{shortened, with_minus};
use crate::numbers::series::TaylorSeries;
use crate::plot::chart::{Axis, Chart, EventMark, Panel, PlotSeries};
use crate::plot::scale::ScaleKind;
use crate::staging::quantity_names::written_label;
use std::f64::consts::PI;

/// Maximum number of curves in a default plot.
const MOST_DEFAULT_CURVES: usize = 12;

/// Charts `plots` of `trajectory`.
pub fn motion_chart(
    system: &System,
    actuation: &Actuation,
    plots: &[Plot],
    trajectory: &Trajectory,
) -> Chart {
    let mechanism = system.mechanism();
    let mut motion = ChartedMotion {
        mechanism,
        system,
        actuation,
        trajectory,
        slots: pose_slots(mechanism, trajectory),
        series: Vec::new(),
    };
    let mut chart = Chart {
        title: mechanism.title.clone(),
        ..Chart::default()
    };
    for plot in plots {
        motion.add(plot, &mut chart);
    }
    let missing = trajectory.missing();
    if missing > 0 {
        let all = trajectory.asked();
        chart.notes.push(format!(
            "{missing} of {all} samples {} no pose: the loops are not closed there",
            if missing == 1 { "has" } else { "have" }
        ));
    }
    chart.notes.extend(coarse_note(mechanism, trajectory));
    let named = |p: &Panel| {
        let names: Vec<&str> = p.series.iter().map(|s| s.name.as_str()).collect();
        format!("{} against {}", names.join(", "), p.x.heading(0))
    };
    let panels: Vec<String> = chart.panels.iter().map(named).collect();
    chart.description = format!("{} at {} samples", panels.join("; "), trajectory.asked());
    chart
}

/// Default plots of a scene that defines none: its outputs, else its traced points, else its unknowns; against its only
/// moving input if that is monotonic, else against time.
pub fn default_plot(mechanism: &Mechanism, actuation: &Actuation) -> Plot {
    plot_of_outputs(mechanism, actuation, &vec![true; mechanism.outputs.len()])
}

/// The same with some of the outputs.
pub fn plot_of_outputs(mechanism: &Mechanism, actuation: &Actuation, chosen: &[bool]) -> Plot {
    let slot = |slot: usize, label: &str, kind: Kind| PlotCurve {
        label: label.to_owned(),
        unit: mechanism.unit_name(kind).to_owned(),
        factor: mechanism.file_units(kind),
        expression: Expression::new(vec![Op::Slot(slot)]),
        kind,
        rate: None,
        rates: Vec::new(),
    };
    let n = mechanism.coordinate_count();
    let after_traces = n + 3 * mechanism.traces.len();
    let outputs = mechanism.outputs.iter().enumerate();
    let mut y: Vec<PlotCurve> = outputs
        .filter(|(k, _)| chosen[*k])
        .map(|(k, o)| {
            let (unit, factor) = mechanism.output_unit(o);
            let curve = slot(after_traces + k, &o.name, o.kind);
            PlotCurve {
                unit,
                factor,
                ..curve
            }
        })
        .collect();
    if y.is_empty() {
        let points = mechanism
            .traces
            .iter()
            .flat_map(|t| ["x", "y", "z"].map(|c| format!("{}.{c}", t.name)));
        y = points
            .enumerate()
            .map(|(k, name)| slot(n + k, &name, Kind::Length))
            .collect();
    }
    if y.is_empty() {
        let unknowns = mechanism.unknowns.iter().enumerate();
        y = unknowns.map(|(k, c)| slot(k, &c.name, c.kind)).collect();
    }
    y.truncate(MOST_DEFAULT_CURVES);
    let x = match lone_input(actuation) {
        Some(k) => {
            let input = &mechanism.inputs[k];
            Abscissa::Quantity(slot(mechanism.unknowns.len() + k, &input.name, input.kind))
        }
        None => Abscissa::Time,
    };
    Plot {
        title: String::new(),
        x,
        y,
        equal: false,
        marks: Vec::new(),
        lines: Vec::new(),
    }
}

/// The only moving input, if it never reverses.
pub fn lone_input(actuation: &Actuation) -> Option<usize> {
    const LOOKS: usize = 240;
    let moving: Vec<usize> = (0..actuation.drives.len())
        .filter(|k| !actuation.drives[*k].is_constant())
        .collect();
    let [only] = moving.as_slice() else {
        return None;
    };
    let at = |k: usize| actuation.drives[*only].value(actuation.duration * k as f64 / LOOKS as f64);
    let steps: Vec<f64> = (0..LOOKS).map(|k| at(k + 1) - at(k)).collect();
    let one_way = steps.iter().all(|s| *s >= 0.0) || steps.iter().all(|s| *s <= 0.0);
    one_way.then_some(*only)
}

/// Values of all slots at every sample that has a pose.
fn pose_slots(mechanism: &Mechanism, trajectory: &Trajectory) -> Vec<Option<Vec<f64>>> {
    let of = |sample: &Sample| {
        let pose = sample.pose.as_ref()?;
        let mut slots = pose.unknowns.clone();
        slots.extend(&sample.inputs);
        slots.extend(pose.traces.iter().flat_map(|p| p.to_array()));
        slots.extend(&pose.outputs);
        debug_assert!(slots.len() >= mechanism.coordinate_count());
        Some(slots)
    };
    trajectory.samples.iter().map(of).collect()
}

/// Taylor series of all slots at every sample.
type SeriesOfSamples = Vec<Option<Vec<TaylorSeries>>>;

/// A trajectory and what has been computed from it.
struct ChartedMotion<'a> {
    mechanism: &'a Mechanism,
    system: &'a System,
    actuation: &'a Actuation,
    trajectory: &'a Trajectory,
    slots: Vec<Option<Vec<f64>>>,
    series: Vec<(RateOrder, SeriesOfSamples)>,
}

impl ChartedMotion<'_> {
    /// Adds the panels of a plot: one per unit.
    fn add(&mut self, plot: &Plot, chart: &mut Chart) {
        let places = self.abscissa_values(&plot.x);
        let mut units: Vec<&str> = Vec::new();
        for curve in &plot.y {
            if !units.contains(&curve.unit.as_str()) {
                units.push(&curve.unit);
            }
        }
        for (k, unit) in units.into_iter().enumerate() {
            let curves: Vec<&PlotCurve> = plot.y.iter().filter(|c| c.unit == unit).collect();
            let mut panel = self.unit_panel(plot, &curves, &places);
            // Reference points belong to the first quantity.
            if k == 0 {
                panel.title.clone_from(&plot.title);
                panel.marks.clone_from(&plot.marks);
                panel.lines.clone_from(&plot.lines);
            }
            chart.notes.extend(leave_out_outliers(&mut panel));
            chart.panels.push(panel);
        }
    }

    /// Curves of one unit.
    fn unit_panel(&mut self, plot: &Plot, curves: &[&PlotCurve], places: &[f64]) -> Panel {
        let is_known = self.places_of_all(&plot.x);
        let (label, unit) = match &plot.x {
            Abscissa::Time => ("time", "s"),
            Abscissa::Quantity(curve) => (curve.label.as_str(), curve.unit.as_str()),
        };
        let alone = match curves {
            [only] => written_label(&only.label),
            _ => String::new(),
        };
        let mut panel = Panel {
            x: Axis {
                label: written_label(label),
                unit: unit.to_owned(),
                scale: ScaleKind::Linear,
                tight: is_known && !plot.equal,
            },
            y: Axis {
                label: alone,
                unit: curves.first().map_or_else(String::new, |c| c.unit.clone()),
                ..Axis::default()
            },
            equal: plot.equal,
            samples: places.to_vec(),
            ..Panel::default()
        };
        let mut valueless = vec![false; places.len()];
        for curve in curves {
            let series = self.series_of(curve, &plot.x, places, &mut valueless);
            panel.series.push(series);
        }
        if is_known {
            panel.events = self.events(&plot.x);
            let poseless: Vec<bool> = self.slots.iter().map(Option::is_none).collect();
            panel.shades = gap_shades(&poseless, &valueless, places);
        }
        panel
    }

    fn series_of(
        &mut self,
        curve: &PlotCurve,
        x: &Abscissa,
        places: &[f64],
        valueless: &mut [bool],
    ) -> PlotSeries {
        let values = self.values(curve);
        let mut series = PlotSeries {
            name: written_label(&curve.label),
            ..PlotSeries::default()
        };
        for (k, value) in values.iter().enumerate() {
            let point = value.map(|v| [places[k], v * curve.factor]);
            let point = point.filter(|p| p[0].is_finite() && p[1].is_finite());
            valueless[k] |= point.is_none() && self.slots[k].is_some();
            series.points.push(point);
        }
        let x_turn = match x {
            Abscissa::Quantity(c) if c.kind == Kind::Angle && c.rate.is_none() => PI * c.factor,
            _ => f64::INFINITY,
        };
        let y_turn = match (curve.kind, curve.rate) {
            (Kind::Angle, None) => PI * curve.factor,
            _ => f64::INFINITY,
        };
        let points = &series.points;
        let x_at = |k: usize| points.get(k)?.map(|p| p[0]);
        let y_at = |k: usize| points.get(k)?.map(|p| p[1]);
        series.breaks = (1..points.len())
            .filter(|k| is_wrap(x_at, *k, x_turn) || is_wrap(y_at, *k, y_turn))
            .collect();
        series
    }

    /// Internal values of a quantity at all samples; `None` without a pose or, for a rate, at a singular one.
    fn values(&mut self, curve: &PlotCurve) -> Vec<Option<f64>> {
        if let Some(rate) = curve.rate {
            return self.curve_rates(&curve.expression, rate);
        }
        let parts = curve.rates.iter();
        let parts: Vec<Vec<Option<f64>>> =
            parts.map(|(f, rate)| self.curve_rates(f, *rate)).collect();
        let value = |(index, slots): (usize, &Option<Vec<f64>>)| {
            let slots = slots.as_ref()?;
            if parts.is_empty() {
                return Some(curve.expression.value(slots));
            }
            let rates: Option<Vec<f64>> = parts.iter().map(|rates| rates[index]).collect();
            Some(
                curve
                    .expression
                    .value(&[slots.as_slice(), &rates?].concat()),
            )
        };
        self.slots.iter().enumerate().map(value).collect()
    }

    /// A rate of a formula at all samples.
    fn curve_rates(&mut self, formula: &Expression, rate: RateOrder) -> Vec<Option<f64>> {
        let order = rate.order;
        let (system, actuation, samples) = (self.system, self.actuation, &self.trajectory.samples);
        let all = self.sample_series(rate).iter().zip(samples);
        let value = |(slots, sample): (&Option<Vec<TaylorSeries>>, &Sample)| {
            let known = formula.value(slots.as_ref()?).derivative(order);
            let pose = sample.pose.as_ref()?;
            if !known.is_nan() {
                return Some(known);
            }
            // At zeros of roots a rate depends on higher orders.
            let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
            let asked = [(formula.clone(), rate)];
            rate_values(system, (actuation, sample.time), &coordinates, &asked).pop()
        };
        all.map(value).collect()
    }

    /// Taylor series of all slots with respect to the variable of `rate`; computed once for each kind.
    fn sample_series(&mut self, rate: RateOrder) -> &SeriesOfSamples {
        if let Some(known) = self.series.iter().position(|(r, _)| *r == rate) {
            return &self.series[known].1;
        }
        let system = self.system;
        let by = RateVariable::from(rate.per);
        let of = |sample: &Sample| {
            let pose = sample.pose.as_ref()?;
            let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
            let driven = (self.actuation, sample.time);
            slot_series(system, &coordinates, by, driven, rate.order)
        };
        let all = self.trajectory.samples.iter().map(of).collect();
        self.series.push((rate, all));
        &self.series[self.series.len() - 1].1
    }

    /// Whether every sample has a place on the axis, including those without a pose.
    fn places_of_all(&self, x: &Abscissa) -> bool {
        let n = self.mechanism.unknowns.len();
        match x {
            Abscissa::Time => true,
            Abscissa::Quantity(curve) => {
                let inputs = n..self.mechanism.coordinate_count();
                curve.rate.is_none() && curve.expression.slots().iter().all(|s| inputs.contains(s))
            }
        }
    }

    /// Places of all samples in the axis' unit; NaN where a sample has none.
    fn abscissa_values(&mut self, x: &Abscissa) -> Vec<f64> {
        let samples = &self.trajectory.samples;
        match x {
            Abscissa::Time => samples.iter().map(|s| s.time).collect(),
            Abscissa::Quantity(_) if self.places_of_all(x) => samples
                .iter()
                .map(|s| self.place(x, s.time, &s.inputs))
                .collect(),
            Abscissa::Quantity(curve) => {
                let values = self.values(curve);
                values
                    .into_iter()
                    .map(|v| v.map_or(f64::NAN, |v| v * curve.factor))
                    .collect()
            }
        }
    }

    /// Place on an axis that does not depend on the pose.
    fn place(&self, x: &Abscissa, time: f64, inputs: &[f64]) -> f64 {
        match x {
            Abscissa::Time => time,
            Abscissa::Quantity(curve) => {
                let unknowns = vec![f64::NAN; self.mechanism.unknowns.len()];
                curve
                    .expression
                    .value(&[unknowns.as_slice(), inputs].concat())
                    * curve.factor
            }
        }
    }

    fn events(&self, x: &Abscissa) -> Vec<EventMark> {
        let mut marks: Vec<EventMark> = Vec::new();
        for event in &self.trajectory.events {
            let place = self.place(x, event.time, &event.inputs);
            let label = event_word(event, place, x);
            let mark = EventMark { x: place, label };
            if !marks.contains(&mark) && !mark.label.is_empty() {
                marks.push(mark);
            }
        }
        marks
    }
}

/// Digits of the place at which a motion ends.
const PLACE_DIGITS: usize = 6;

/// An event in a word or two.
fn event_word(event: &Event, place: f64, x: &Abscissa) -> String {
    let unit = match x {
        Abscissa::Time => "s",
        Abscissa::Quantity(curve) => curve.unit.as_str(),
    };
    match &event.kind {
        EventKind::MotionEnds(_) => {
            let place = with_minus(&shortened(place, PLACE_DIGITS));
            format!("ends at {place} {unit}").trim_end().to_owned()
        }
        EventKind::MotionResumes { same_branch: true } => "resumes".to_owned(),
        EventKind::MotionResumes { same_branch: false } => "resumes on another branch".to_owned(),
        EventKind::SingularPosePassed | EventKind::SingularPoseMet => "singular pose".to_owned(),
        EventKind::OtherStart => "other start".to_owned(),
        EventKind::StartMoved { .. } => "start moved".to_owned(),
        EventKind::InputUndefined { name, .. } => format!("{name} has no value"),
        EventKind::LimitPosition { name, .. } => format!("{name} turns back"),
        EventKind::GimbalLock { .. } => "gimbal lock".to_owned(),
        EventKind::StartSingular => "singular start".to_owned(),
        EventKind::AxesParallel { contact } => format!("{contact} touches along a line"),
        EventKind::StartNotClosed { .. } | EventKind::BranchChosen { .. } => String::new(),
    }
}
