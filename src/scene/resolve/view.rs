//! The `[view]` section and the labels.

use super::super::bodies::LabelFile;
use super::super::file::SceneFile;
use super::super::views::ViewFile;
use super::bodies::{body_index, trace_index};
use super::body_constants::BodyConstants;
use super::choices::{MOST_LABELS, chosen_word};
use super::names::Names;
use super::shown_dimensions;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::camera_path::CameraPath;
use crate::model::mechanism::{Body, Trace};
use crate::model::section::MOST_EXPLODED;
use crate::model::theme::Theme;
use crate::model::view::{
    Decor, EdgeLines, GroundPlace, LabelPlace, NamedView, Playback, SceneLabel, Shadows, UpAxis,
    View, ViewProjection,
};
use crate::model::view_change::ViewChange;
use crate::scene::reader::Spanned;
use crate::scene::values::FormulaText;
use glam::DVec3;

const DEFAULT_AZIMUTH_DEG: f64 = -60.0;
const DEFAULT_ELEVATION_DEG: f64 = 22.0;
const DEFAULT_FOV_DEG: f64 = 24.0;
const DEFAULT_MARGIN: f64 = 0.06;
const DEFAULT_FPS: f64 = 20.0;
/// Fraction of the picture's height: readable in a 480-line picture.
const DEFAULT_LABEL_SIZE: f64 = 0.035;

/// Resolves the view; angles of the view are always in degrees.
pub fn resolve_view(
    file: &SceneFile,
    names: &Names,
    bodies: &[Body],
    traces: &[Trace],
    diagnostics: &mut Diagnostics,
) -> View {
    let constants = BodyConstants { names };
    let view = &file.view;
    // What stands in the view: labels, decor, dimensions.
    if let Some(beyond) = file.labels.get(MOST_LABELS) {
        let message = format!("at most {MOST_LABELS} labels");
        diagnostics.push(Diagnostic::error(message).at(beyond.text.span.clone()));
    }
    let labels = file.labels.iter();
    let labels = labels.filter_map(|l| resolve_label(l, &constants, bodies, traces, diagnostics));
    let labels = labels.collect();
    let decor = super::decor::resolve_decor(view, &constants, diagnostics);
    let places = (bodies, traces);
    let dimensions =
        shown_dimensions::resolve_dimensions(&file.dimensions, &constants, places, diagnostics);
    // Resolved here and set at the end: a named direction clears the path.
    let camera_path = super::camera::resolve_camera(view, &constants, diagnostics);
    let section = super::section::resolve_section(view, &constants, bodies, diagnostics);
    let mut reader = ViewReader {
        view,
        constants: &constants,
        diagnostics,
    };
    let mut resolved = View {
        labels,
        dimensions,
        decor,
        section,
        ..reader.plain_view()
    };
    reader.look_from_name(&mut resolved);
    resolved.camera_path = camera_path;
    resolved
}

/// The keys of `[view]`, and the context in which they are read.
struct ViewReader<'a, 'n> {
    view: &'a ViewFile,
    constants: &'a BodyConstants<'n>,
    diagnostics: &'a mut Diagnostics,
}

impl ViewReader<'_, '_> {
    /// The view without labels, decor and camera path.
    fn plain_view(&mut self) -> View {
        let view = self.view;
        let [azimuth, elevation] = [
            (&view.azimuth, DEFAULT_AZIMUTH_DEG, 720.0, "azimuth"),
            (&view.elevation, DEFAULT_ELEVATION_DEG, 90.0, "elevation"),
        ]
        .map(|(text, default, most, what)| self.angle(text, default, [-most, most], what));
        let projection = self.projection();
        // Numbers outside their range are reported, and defaults take their place.
        let margin = self.number(&view.margin, DEFAULT_MARGIN, [0.0, 0.4], "margin");
        let fps = self.number(&view.fps, DEFAULT_FPS, [0.01, 1000.0], "fps");
        let playback = Playback {
            bounce: view.bounce.unwrap_or(false),
            pause: self.number(&view.pause, 0.0, [0.0, Playback::LONGEST_PAUSE], "pause"),
        };
        let diagnostics = &mut *self.diagnostics;
        // Look: a theme has a background of its own.
        let theme = chosen_word(&view.theme, &Theme::NAMES, "theme", diagnostics);
        let (edges, shadows) = (&EdgeLines::NAMES, &Shadows::NAMES);
        View {
            azimuth,
            elevation,
            is_aimed: view.azimuth.is_some() || view.elevation.is_some(),
            up: chosen_word(&view.up, &UpAxis::NAMES, "up axis", diagnostics),
            projection,
            margin,
            four: false,
            theme,
            transparent: view.transparent.unwrap_or(false),
            background: view.background.unwrap_or(theme.background()),
            edges: chosen_word(&view.edges, edges, "kind of edges", diagnostics),
            shadows: chosen_word(&view.shadows, shadows, "kind of shadows", diagnostics),
            ground: self.ground(),
            fps,
            playback,
            captions: view.captions.unwrap_or(true),
            // These are not set here.
            labels: Vec::new(),
            dimensions: Vec::new(),
            decor: Decor::default(),
            camera_path: CameraPath::default(),
            hidden: Vec::new(),
            section: None,
            explode: self.number(&view.explode, 0.0, [0.0, MOST_EXPLODED], "explode"),
        }
    }

    /// A number of the view or its default; a number outside its range is rejected.
    fn number(
        &mut self,
        text: &Option<FormulaText>,
        default: f64,
        range: [f64; 2],
        what: &str,
    ) -> f64 {
        let number = self.constants.within(what, text, range, self.diagnostics);
        number.unwrap_or(default)
    }

    /// An angle of the view in radians; the default and the range are degrees.
    fn angle(
        &mut self,
        text: &Option<FormulaText>,
        default: f64,
        range: [f64; 2],
        what: &str,
    ) -> f64 {
        let angle = self
            .constants
            .angle_within(what, text, range, self.diagnostics);
        angle.unwrap_or(default.to_radians())
    }

    fn projection(&mut self) -> ViewProjection {
        let fov_y = self.angle(&self.view.fov, DEFAULT_FOV_DEG, [1.0, 120.0], "fov");
        let (word, names) = (&self.view.projection, &ViewProjection::NAMES);
        match chosen_word(word, names, "projection", self.diagnostics) {
            true => ViewProjection::Orthographic,
            false => ViewProjection::Perspective { fov_y },
        }
    }

    fn ground(&mut self) -> GroundPlace {
        match &self.view.ground {
            None => GroundPlace::Auto,
            Some(text) if text.text == "auto" => GroundPlace::Auto,
            Some(text) if text.text == "none" => GroundPlace::None,
            Some(text) => {
                let height = self.constants.value(text, self.diagnostics);
                height.map_or(GroundPlace::Auto, GroundPlace::At)
            }
        }
    }

    /// Applies the named direction of `from`; explicit angles of the scene take precedence.
    fn look_from_name(&mut self, resolved: &mut View) {
        let view = self.view;
        if view.from.is_none() {
            return;
        }
        let named = chosen_word(&view.from, &NamedView::NAMES, "view", self.diagnostics);
        let change = ViewChange {
            from: Some(named),
            azimuth: view.azimuth.as_ref().map(|_| resolved.azimuth),
            elevation: view.elevation.as_ref().map(|_| resolved.elevation),
            projection: view.projection.as_ref().map(|_| resolved.projection),
            ..ViewChange::default()
        };
        change.apply(resolved);
    }
}

fn resolve_label(
    label: &LabelFile,
    constants: &BodyConstants,
    bodies: &[Body],
    traces: &[Trace],
    diagnostics: &mut Diagnostics,
) -> Option<SceneLabel> {
    let point = constants.vector_or_zero(&label.point, diagnostics)?;
    // It moves with a body, or stands at the place of a trace at a time.
    let place = match (&label.body, &label.trace) {
        (Some(body), None) => LabelPlace::OnBody {
            body: body_index(&body.value, &body.span, bodies, diagnostics)?,
            point,
        },
        (None, Some(trace)) => on_trace(trace, label, point, constants, traces, diagnostics)?,
        _ => {
            diagnostics.push(
                Diagnostic::error("a label needs either a `body` or a `trace`")
                    .at(label.text.span.clone())
                    .hint("write body = \"…\" with point = […], or trace = \"…\" with time = …"),
            );
            return None;
        }
    };
    // An error in the size drops the label.
    let size = label.size.as_ref().map_or(Some(DEFAULT_LABEL_SIZE), |s| {
        constants.positive("the size of a label", s, diagnostics)
    })?;
    Some(SceneLabel {
        text: label.text.value.clone(),
        place,
        colour: label.colour,
        leader: label.leader.unwrap_or(false),
        hides: label.hides.unwrap_or(false),
        yields: false,
        size,
    })
}

fn on_trace(
    trace: &Spanned<String>,
    label: &LabelFile,
    offset: DVec3,
    constants: &BodyConstants,
    traces: &[Trace],
    diagnostics: &mut Diagnostics,
) -> Option<LabelPlace> {
    let index = trace_index(trace, constants.names, traces, diagnostics)?;
    let time = label
        .time
        .as_ref()
        .map_or(Some(0.0), |t| constants.value(t, diagnostics))?;
    Some(LabelPlace::OnTrace {
        trace: index,
        time,
        offset,
    })
}
