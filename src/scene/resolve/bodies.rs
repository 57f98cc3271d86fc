//! Links, their solids and their traced points.

use super::super::file::SceneFile;
use super::super::solids::ShapeFile;
use super::body_constants::BodyConstants;
use super::joints::FoldedJoints;
use super::meshes::MeshFiles;
use super::names::Names;
use super::parsed::Parsed;
use super::range::in_range;
use super::solids::resolve_solid;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::math::Pose;
use crate::model::mechanism::{Body, Trace};
use crate::model::palette;
use crate::model::shape::Shape;
use crate::scene::reader::Spanned;
use crate::scene::values::FormulaText;
use std::collections::HashMap;

/// Resolves all bodies.
pub fn resolve_bodies(
    file: &SceneFile,
    parsed: &Parsed,
    names: &Names,
    joints: &mut FoldedJoints,
    meshes: &mut MeshFiles,
    diagnostics: &mut Diagnostics,
) -> Vec<Body> {
    let constants = BodyConstants { names };
    let mut bodies: Vec<Body> = Vec::new();
    let mut places: HashMap<&str, &Span> = HashMap::new();
    for (index, body) in file.bodies.iter().enumerate() {
        let (name, place) = (body.name.value.as_str(), &body.name.span);
        // Two bodies of one name are an error, which shows both places.
        let first = *places.entry(name).or_insert(place);
        if first != place {
            diagnostics.push(
                Diagnostic::error(format!("there are two bodies named `{name}`"))
                    .at(place.clone())
                    .with_related(first.clone(), "first here"),
            );
        }
        // World to body. After an error the chain is empty, so that further errors are found.
        let chain = joints
            .chain(&parsed.frames[index], diagnostics)
            .unwrap_or_default();
        // What shapes inherit: colour and opacity.
        let colour = body
            .colour
            .unwrap_or(palette::BODIES[index % palette::BODIES.len()]);
        let opacity = body
            .opacity
            .as_ref()
            .map_or(Some(1.0), |o| body_opacity(o, &constants, diagnostics))
            .unwrap_or(1.0);
        // Shapes with errors, which have been reported, are left out.
        let mut shapes = Vec::new();
        for shape in &body.shapes {
            let inherited = BodyLook { colour, opacity };
            shapes.extend(resolve_shape(
                shape,
                inherited,
                parsed,
                &constants,
                joints,
                meshes,
                diagnostics,
            ));
        }
        bodies.push(Body {
            name: body.name.value.clone(),
            world_from_body: chain,
            shapes,
        });
    }
    bodies
}

#[derive(Clone, Copy)]
struct BodyLook {
    colour: [u8; 3],
    opacity: f64,
}

fn body_opacity(
    text: &FormulaText,
    constants: &BodyConstants,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let value = constants.value(text, diagnostics)?;
    diagnostics.taken(in_range("opacity", value, [0.0, 1.0], &text.span))
}

fn resolve_shape(
    shape: &ShapeFile,
    inherited: BodyLook,
    parsed: &Parsed,
    constants: &BodyConstants,
    joints: &mut FoldedJoints,
    meshes: &mut MeshFiles,
    diagnostics: &mut Diagnostics,
) -> Option<Shape> {
    // All parts are resolved before the shape is given up, so that all errors are reported.
    let solid = resolve_solid(&shape.solid, &shape.span, constants, meshes, diagnostics);
    // A shape does not move in its body: its frame is a constant pose.
    let body_from_shape = match &shape.frame {
        None => Some(Pose::IDENTITY),
        Some(text) => {
            let factors = parsed.factors(text, diagnostics);
            factors.and_then(|factors| joints.constant_pose(&factors, &text.span, diagnostics))
        }
    };
    let opacity = shape.opacity.as_ref().map_or(Some(inherited.opacity), |o| {
        body_opacity(o, constants, diagnostics)
    });
    Some(Shape {
        solid: solid?,
        body_from_shape: body_from_shape?,
        colour: shape.colour.unwrap_or(inherited.colour),
        opacity: opacity?,
    })
}

/// Resolves the traces.
pub fn body_traces(
    file: &SceneFile,
    names: &Names,
    bodies: &[Body],
    diagnostics: &mut Diagnostics,
) -> Vec<Trace> {
    let constants = BodyConstants { names };
    let mut traces = Vec::new();
    for (index, trace) in file.traces.iter().enumerate() {
        let Some(body) = body_index(&trace.body.value, &trace.body.span, bodies, diagnostics)
        else {
            continue;
        };
        // A place in the body's own frame.
        let point = constants.vector_or_zero(&trace.point, diagnostics);
        // `None` is no radius, `Some(None)` one with an error.
        let radius = trace
            .radius
            .as_ref()
            .map(|r| constants.value(r, diagnostics));
        let (Some(point), false) = (point, radius == Some(None)) else {
            continue;
        };
        traces.push(Trace {
            name: trace.name.value.clone(),
            body,
            point,
            // Without a colour the palette's, from another place on than for bodies.
            colour: trace
                .colour
                .unwrap_or(palette::BODIES[(index + 3) % palette::BODIES.len()]),
            radius: radius.flatten(),
        });
    }
    traces
}

/// The index of the body of that name, or a message.
pub fn body_index(
    name: &str,
    span: &Span,
    bodies: &[Body],
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    let found = bodies.iter().position(|body| body.name == name);
    if found.is_none() {
        diagnostics.push(
            Diagnostic::error(format!("there is no body `{name}`"))
                .at(span.clone())
                .suggest(name, bodies.iter().map(|b| b.name.as_str())),
        );
    }
    found
}

/// The index of the trace of that name, or a message unless it is declared and only unreadable.
pub fn trace_index(
    trace: &Spanned<String>,
    names: &Names,
    traces: &[Trace],
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    let found = traces.iter().position(|t| t.name == trace.value);
    if found.is_none() && !names.declares_trace(&trace.value) {
        diagnostics.push(
            Diagnostic::error(format!("there is no trace `{}`", trace.value))
                .at(trace.span.clone())
                .suggest(&trace.value, traces.iter().map(|t| t.name.as_str())),
        );
    }
    found
}
