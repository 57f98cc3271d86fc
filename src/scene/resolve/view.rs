//! The `[view]` section and the labels.

use super::super::bodies::LabelFile;
use super::super::file::SceneFile;
use super::bodies::body_index;
use super::body_constants::BodyConstants;
use super::choices::{MOST_LABELS, chosen_word};
use super::names::Names;
use crate::diag::{Diagnostic, Diagnostics, shown_number};
use crate::model::camera_path::CameraPath;
use crate::model::mechanism::{Body, Trace};
use crate::model::theme::Theme;
use crate::model::view::{
    EdgeLines, GroundPlace, LabelPlace, NamedView, SceneLabel, Shadows, UpAxis, View,
    ViewProjection,
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
    let mut number = |text: &Option<FormulaText>, default: f64, low: f64, high: f64, what: &str| {
        let Some(text) = text else { return default };
        let Some(value) = constants.value(text, diagnostics) else {
            return default;
        };
        if (low..=high).contains(&value) {
            return value;
        }
        let value = shown_number(value);
        let message = format!("{what} must be between {low} and {high}, found {value}");
        diagnostics.push(Diagnostic::error(message).at(text.span.clone()));
        default
    };
    let azimuth = number(&view.azimuth, DEFAULT_AZIMUTH_DEG, -720.0, 720.0, "azimuth");
    let elevation = number(
        &view.elevation,
        DEFAULT_ELEVATION_DEG,
        -90.0,
        90.0,
        "elevation",
    );
    let fov_y = number(&view.fov, DEFAULT_FOV_DEG, 1.0, 120.0, "fov").to_radians();
    let margin = number(&view.margin, DEFAULT_MARGIN, 0.0, 0.4, "margin");
    let fps = number(&view.fps, DEFAULT_FPS, 0.01, 1000.0, "fps");
    let up = chosen_word(&view.up, &UpAxis::NAMES, "up axis", diagnostics);
    let parallel = chosen_word(
        &view.projection,
        &ViewProjection::NAMES,
        "projection",
        diagnostics,
    );
    let projection = match parallel {
        true => ViewProjection::Orthographic,
        false => ViewProjection::Perspective { fov_y },
    };
    let ground = match &view.ground {
        None => GroundPlace::Auto,
        Some(text) if text.text == "auto" => GroundPlace::Auto,
        Some(text) if text.text == "none" => GroundPlace::None,
        Some(text) => constants
            .value(text, diagnostics)
            .map_or(GroundPlace::Auto, GroundPlace::At),
    };
    if let Some(beyond) = file.labels.get(MOST_LABELS) {
        let message = format!("at most {MOST_LABELS} labels");
        diagnostics.push(Diagnostic::error(message).at(beyond.text.span.clone()));
    }
    let labels = file
        .labels
        .iter()
        .filter_map(|l| resolve_label(l, &constants, bodies, traces, diagnostics))
        .collect();
    let theme = chosen_word(&view.theme, &Theme::NAMES, "theme", diagnostics);
    let decor = super::decor::resolve_decor(view, &constants, diagnostics);
    let mut resolved = View {
        azimuth: azimuth.to_radians(),
        elevation: elevation.to_radians(),
        up,
        projection,
        margin,
        four: false,
        theme,
        transparent: view.transparent.unwrap_or(false),
        background: view.background.unwrap_or(theme.background()),
        edges: chosen_word(&view.edges, &EdgeLines::NAMES, "kind of edges", diagnostics),
        shadows: chosen_word(
            &view.shadows,
            &Shadows::NAMES,
            "kind of shadows",
            diagnostics,
        ),
        ground,
        fps,
        captions: view.captions.unwrap_or(true),
        labels,
        decor,
        camera_path: CameraPath::default(),
    };
    if view.from.is_some() {
        let change = ViewChange {
            from: Some(chosen_word(
                &view.from,
                &NamedView::NAMES,
                "view",
                diagnostics,
            )),
            // What the scene says of its own goes before the name.
            azimuth: view.azimuth.as_ref().map(|_| resolved.azimuth),
            elevation: view.elevation.as_ref().map(|_| resolved.elevation),
            projection: view.projection.as_ref().map(|_| resolved.projection),
            ..ViewChange::default()
        };
        change.apply(&mut resolved);
    }
    resolved.camera_path = super::camera::resolve_camera(view, &constants, diagnostics);
    resolved
}

fn resolve_label(
    label: &LabelFile,
    constants: &BodyConstants,
    bodies: &[Body],
    traces: &[Trace],
    diagnostics: &mut Diagnostics,
) -> Option<SceneLabel> {
    let point = constants.vector_or_zero(&label.point, diagnostics)?;
    let place = match (&label.body, &label.trace) {
        (Some(body), None) => LabelPlace::OnBody {
            body: body_index(&body.value, &body.span, bodies, diagnostics)?,
            point,
        },
        (None, Some(trace)) => on_trace(trace, label, point, constants, traces, diagnostics)?,
        _ => {
            diagnostics.push(
                Diagnostic::error("a label stands on a `body` or on a `trace`")
                    .at(label.text.span.clone())
                    .hint("write body = \"…\" with point = […], or trace = \"…\" with time = …"),
            );
            return None;
        }
    };
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
    let Some(index) = traces.iter().position(|t| t.name == trace.value) else {
        if constants.names.declares_trace(&trace.value) {
            return None;
        }
        diagnostics.push(
            Diagnostic::error(format!("there is no trace `{}`", trace.value))
                .at(trace.span.clone())
                .suggest(&trace.value, traces.iter().map(|t| t.name.as_str())),
        );
        return None;
    };
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
