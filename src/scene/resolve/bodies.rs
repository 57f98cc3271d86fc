//! Links, their solids and their traced points.

use super::super::file::SceneFile;
use super::super::formula::compile::constant_node;
use super::super::shapes::{ShapeFile, SolidFile};
use super::joints::FoldedJoints;
use super::meshes::MeshFiles;
use super::names::Names;
use super::parsed::Parsed;
use super::parsing::parsed_expression;
use crate::diag::{Diagnostic, Diagnostics, Span, shown_number};
use crate::math::Pose;
use crate::model::mechanism::{Body, Trace};
use crate::model::palette;
use crate::model::shape::{Shape, Solid};
use crate::scene::values::FormulaText;
use glam::DVec3;
use std::collections::HashMap;

/// Constant formulas of shapes and views, with their messages.
pub struct BodyConstants<'a> {
    /// Parameters and their values.
    pub names: &'a Names,
}

impl BodyConstants<'_> {
    /// The value of a formula of parameters.
    pub fn value(&self, text: &FormulaText, diagnostics: &mut Diagnostics) -> Option<f64> {
        let node = parsed_expression(text, diagnostics)?;
        match constant_node(&node, &|n, s| self.names.constant(n, s)) {
            Ok(value) => Some(value),
            Err(diagnostic) => {
                diagnostics.push(diagnostic);
                None
            }
        }
    }

    /// Three of them.
    pub fn vector(&self, texts: &[FormulaText; 3], diagnostics: &mut Diagnostics) -> Option<DVec3> {
        let [x, y, z] = texts.each_ref().map(|text| self.value(text, diagnostics));
        Some(DVec3::new(x?, y?, z?))
    }

    /// A vector that may be absent.
    pub fn vector_or_zero(
        &self,
        texts: &Option<[FormulaText; 3]>,
        diagnostics: &mut Diagnostics,
    ) -> Option<DVec3> {
        texts
            .as_ref()
            .map_or(Some(DVec3::ZERO), |texts| self.vector(texts, diagnostics))
    }

    /// A value that must be positive.
    pub fn positive(
        &self,
        what: &str,
        text: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let value = self.value(text, diagnostics)?;
        if value > 0.0 {
            return Some(value);
        }
        diagnostics.push(
            Diagnostic::error(format!(
                "{what} must be positive, found {}",
                shown_number(value)
            ))
            .at(text.span.clone()),
        );
        None
    }
}

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
        let first = *places.entry(name).or_insert(place);
        if first != place {
            diagnostics.push(
                Diagnostic::error(format!("there are two bodies named `{name}`"))
                    .at(place.clone())
                    .related(first.clone(), "first here"),
            );
        }
        let chain = joints
            .chain(&parsed.frames[index], diagnostics)
            .unwrap_or_default();
        let colour = body
            .colour
            .unwrap_or(palette::BODIES[index % palette::BODIES.len()]);
        let opacity = body
            .opacity
            .as_ref()
            .map_or(Some(1.0), |o| body_opacity(o, &constants, diagnostics))
            .unwrap_or(1.0);
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
    if (0.0..=1.0).contains(&value) {
        return Some(value);
    }
    diagnostics.push(
        Diagnostic::error(format!(
            "opacity is between 0 and 1, found {}",
            shown_number(value)
        ))
        .at(text.span.clone()),
    );
    None
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
    let solid = resolve_solid(&shape.solid, &shape.span, constants, meshes, diagnostics);
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

fn resolve_solid(
    solid: &SolidFile,
    span: &Span,
    constants: &BodyConstants,
    meshes: &mut MeshFiles,
    diagnostics: &mut Diagnostics,
) -> Option<Solid> {
    let d = diagnostics;
    match solid {
        SolidFile::Sphere { center, radius } => {
            let (center, radius) = (
                constants.vector_or_zero(center, d),
                constants.positive("radius", radius, d),
            );
            Some(Solid::Sphere {
                center: center?,
                radius: radius?,
            })
        }
        SolidFile::Capsule { from, to, radius } => {
            let (from, to) = (constants.vector(from, d), constants.vector(to, d));
            let radius = constants.positive("radius", radius, d);
            Some(Solid::Capsule {
                from: from?,
                to: to?,
                radius: radius?,
            })
        }
        SolidFile::Cylinder { from, to, radius } => {
            let (from, to) = (constants.vector(from, d), constants.vector(to, d));
            let radius = constants.positive("radius", radius, d);
            let (from, to) = distinct_names(from?, to?, span, d)?;
            Some(Solid::Cylinder {
                from,
                to,
                radius: radius?,
            })
        }
        SolidFile::Cone {
            from,
            to,
            radius_from,
            radius_to,
        } => {
            let (from, to) = (constants.vector(from, d), constants.vector(to, d));
            let (first, last) = (
                constants.value(radius_from, d)?,
                constants.value(radius_to, d)?,
            );
            if first < 0.0 || last < 0.0 || first + last <= 0.0 {
                d.push(
                    Diagnostic::error("radii of a cone must not be negative, and not both zero")
                        .at(span.clone()),
                );
                return None;
            }
            let (from, to) = distinct_names(from?, to?, span, d)?;
            Some(Solid::Cone {
                from,
                to,
                radius_from: first,
                radius_to: last,
            })
        }
        SolidFile::Box { center, size } => {
            let (center, size) = (
                constants.vector_or_zero(center, d),
                constants.vector(size, d)?,
            );
            if size.min_element() <= 0.0 {
                d.push(Diagnostic::error("edges of a box must be positive").at(span.clone()));
                return None;
            }
            Some(Solid::Box {
                center: center?,
                size,
            })
        }
        SolidFile::Torus {
            center,
            axis,
            ring,
            tube,
        } => {
            let center = constants.vector_or_zero(center, d);
            let axis = axis
                .as_ref()
                .map_or(Some(DVec3::Z), |axis| constants.vector(axis, d));
            let (ring, tube) = (
                constants.positive("ring radius", ring, d),
                constants.positive("tube radius", tube, d),
            );
            let Some(axis) = axis?.try_normalize() else {
                d.push(Diagnostic::error("the axis of a torus has no direction").at(span.clone()));
                return None;
            };
            Some(Solid::Torus {
                center: center?,
                axis,
                ring: ring?,
                tube: tube?,
            })
        }
        SolidFile::Tube {
            points,
            radius,
            closed,
        } => {
            let list: Option<Vec<DVec3>> = points
                .value
                .iter()
                .map(|p| constants.vector(p, d))
                .collect();
            let radius = constants.positive("radius", radius, d);
            let list = list?;
            if list.len() < 2 {
                d.push(
                    Diagnostic::error("a tube needs at least two points").at(points.span.clone()),
                );
                return None;
            }
            Some(Solid::Tube {
                points: list,
                radius: radius?,
                closed: *closed,
            })
        }
        SolidFile::HalfSpace {
            point,
            normal,
            size,
        } => {
            let point = constants.vector_or_zero(point, d);
            let normal = normal
                .as_ref()
                .map_or(Some(DVec3::Z), |normal| constants.vector(normal, d));
            let size = constants.positive("size", size, d);
            let Some(normal) = normal?.try_normalize() else {
                d.push(
                    Diagnostic::error("the normal of a half-space has no direction")
                        .at(span.clone()),
                );
                return None;
            };
            Some(Solid::HalfSpace {
                point: point?,
                normal,
                size: size?,
            })
        }
        SolidFile::Stl {
            file,
            scale,
            surface,
        } => {
            let scale = scale
                .as_ref()
                .map_or(Some(1.0), |s| constants.positive("scale", s, d))?;
            match meshes.read(&file.value, scale, *surface) {
                Ok(soup) => Some(Solid::Triangles(soup)),
                Err(error) => {
                    d.push(Diagnostic::error(error).at(file.span.clone()));
                    None
                }
            }
        }
    }
}

fn distinct_names(
    from: DVec3,
    to: DVec3,
    span: &Span,
    diagnostics: &mut Diagnostics,
) -> Option<(DVec3, DVec3)> {
    if from != to {
        return Some((from, to));
    }
    diagnostics.push(Diagnostic::error("both ends are the same point").at(span.clone()));
    None
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
        let point = constants.vector_or_zero(&trace.point, diagnostics);
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
