//! Solids of bodies: the numbers of each kind, and what of them cannot be drawn or measured.

use super::super::shapes::SolidFile;
use super::body_constants::BodyConstants;
use super::meshes::MeshFiles;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::model::shape::Solid;
use glam::DVec3;

/// A solid with its numbers; `None` where one of them is no good, which is reported.
pub fn resolve_solid(
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
            let (from, to) = distinct_ends(from?, to?, span, d)?;
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
            let (from, to) = distinct_ends(from?, to?, span, d)?;
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

fn distinct_ends(
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
