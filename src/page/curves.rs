//! Curves of a page: inline drawings whose playheads know the position of every frame.

use super::markup::{Section, escaped};
use crate::charts::motion::{default_plot, lone_input, motion_chart, plot_of_outputs};
use crate::kinematics::motion::continuation::solve_with_ends;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::plot::{Plot, PlotCurve, rate_unit};
use crate::model::rate::{Per, RateOrder};
use crate::plot::theme::Colour;
use crate::plot::{Chart, ChartTheme, Drawing, draw_chart, svg};
use crate::scene::Scene;
use serde_json::{Value, json};

/// Samples of a curve: every one and a half degrees of a turn.
const SAMPLES: usize = 241;

/// Width of a chart in pixels: its texts are readable at half that size.
const WIDTH: u32 = 720;

/// Most quantities in one chart; more would be a tangle.
const MOST_TRANSFERS: usize = 6;

/// The charts of one mechanism, as the page's script knows them.
pub struct Curves<'a> {
    scene: &'a Scene,
    system: &'a System,
    shown: &'a Trajectory,
    number: usize,
    fine: Trajectory,
    /// Playheads of all charts so far.
    pub list: Vec<Value>,
}

impl<'a> Curves<'a> {
    /// For mechanism `number` of the page, whose frames are `shown`.
    pub fn new(scene: &'a Scene, system: &'a System, shown: &'a Trajectory, number: usize) -> Self {
        let duration = scene.actuation.duration;
        let time = |k: usize| duration * k as f64 / (SAMPLES - 1) as f64;
        let times: Vec<f64> = (0..SAMPLES).map(time).collect();
        let fine = solve_with_ends(system, &scene.actuation, &times, &|| false);
        Self {
            scene,
            system,
            shown,
            number,
            fine,
            list: Vec::new(),
        }
    }

    /// Draws plots of the motion.
    fn plots(&mut self, plots: &[Plot]) -> String {
        let chart = |trajectory: &Trajectory| {
            motion_chart(self.system, &self.scene.actuation, plots, trajectory)
        };
        let (fine, frames) = (chart(&self.fine), chart(self.shown));
        self.add(fine, &frames)
    }

    /// A chart as an element of the page; `frames` is the same one at the page's frames.
    pub fn add(&mut self, mut chart: Chart, frames: &Chart) -> String {
        // The article shows the title; screen readers get a description.
        let title = std::mem::take(&mut chart.title);
        let [usual, height] = crate::plot::usual_size(&chart);
        let height = (f64::from(height) * f64::from(WIDTH) / f64::from(usual)) as u32;
        let mut drawing = draw_chart(&chart, [WIDTH, height], ChartTheme::LIGHT);
        drawing.title = title;
        let id = format!("chart-{}-{}", self.number, self.list.len() + 1);
        self.list
            .push(json!({ "id": id, "panels": playhead_places(frames, &drawing) }));
        format!(
            "<div class=\"chart scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">{}</div>",
            escaped(&drawing.description),
            svg::write_inline(&drawing, &id, &colour_names()),
        )
    }
}

/// The position of every frame on the curves, in tenths of a pixel.
fn playhead_places(frames: &Chart, drawing: &Drawing) -> Vec<Value> {
    let tenth = |v: f64| (v * 10.0).round() / 10.0;
    let panels = frames.panels.iter().zip(&drawing.areas);
    panels
        .map(|(panel, area)| {
            let places = panel.samples.iter();
            let places: Vec<Option<f64>> = places.map(|x| area.x.pixel(*x).map(tenth)).collect();
            let curves = panel.series.iter().map(|series| {
                let points = series.points.iter();
                points
                    .map(|p| p.and_then(|p| area.pixel(p)).map(|p| p.map(tenth)))
                    .collect::<Vec<_>>()
            });
            let rect = area.rect;
            let sides = [rect.left, rect.top, rect.right, rect.bottom].map(tenth);
            json!({
                "box": sides,
                "equal": panel.equal,
                "x": places,
                "y": curves.collect::<Vec<_>>(),
            })
        })
        .collect()
}

/// The page's names for the colours of a light chart, so that its style can turn it into a dark one.
fn colour_names() -> Vec<(Colour, String)> {
    let theme = ChartTheme::LIGHT;
    let named = [
        (theme.background, "chart-background"),
        (theme.text, "chart-text"),
        (theme.faint_text, "chart-faint"),
        (theme.grid, "chart-grid"),
        (theme.event, "chart-event"),
        (theme.shade, "chart-shade"),
        (theme.hatch, "chart-hatch"),
    ];
    let series = theme.series.into_iter().enumerate();
    let series = series.map(|(k, colour)| (colour, format!("var(--s{k})")));
    named
        .map(|(colour, name)| (colour, format!("var(--{name})")))
        .into_iter()
        .chain(series)
        .collect()
}

/// The scene's plots, or default plots of a scene without any.
pub(super) fn shown_plots(scene: &Scene) -> Vec<Plot> {
    match &*scene.plots {
        [] => vec![default_plot(&scene.mechanism, &scene.actuation)],
        plots => plots.to_vec(),
    }
}

/// The section of these plots.
pub fn curves_section(curves: &mut Curves) -> Section {
    let mut section = Section::new("Curves");
    let plots = shown_plots(curves.scene);
    if plots.iter().all(|plot| plot.y.is_empty()) {
        return section;
    }
    let drawn = curves.plots(&plots);
    section.blocks.push(drawn);
    section
}

/// First derivatives of the quantities in the scene's default plot by the only input that moves.
pub fn transfer_section(curves: &mut Curves) -> Section {
    let mut section = Section::new("Transfer functions");
    let (mechanism, actuation) = (&curves.scene.mechanism, &curves.scene.actuation);
    // A transfer function exists by a single input that moves.
    let Some(input) = lone_input(actuation) else {
        return section;
    };
    let driven = &mechanism.inputs[input];
    let per = (
        mechanism.unit_name(driven.kind),
        mechanism.file_units(driven.kind),
    );
    let orders = mechanism.output_rate_orders().into_iter();
    let differentiable: Vec<bool> = orders.map(|order| order > 0).collect();
    let mut plot = plot_of_outputs(mechanism, actuation, &differentiable);
    plot.y.truncate(MOST_TRANSFERS);
    // Each curve becomes its own first derivative, with the unit of a rate.
    for curve in &mut plot.y {
        let (unit, factor) = rate_unit((&curve.unit, curve.factor), per, 1);
        *curve = PlotCurve {
            label: format!("d({}, {})", curve.label, driven.name),
            unit,
            factor,
            rate: Some(RateOrder {
                per: Per::Input(input),
                order: 1,
            }),
            ..curve.clone()
        };
    }
    if plot.y.is_empty() {
        return section;
    }
    section.text(&format!(
        "Derivative of every quantity with respect to the input {}: exact derivatives through the loops, not differences.",
        driven.name
    ));
    let drawn = curves.plots(&[plot]);
    section.blocks.push(drawn);
    section
}
