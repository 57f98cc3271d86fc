//! Solids of bodies: their numbers, and checks whether they can be drawn and measured.

use super::super::solids::SolidFile;
use super::body_constants::BodyConstants;
use super::meshes::MeshFiles;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::model::shape::Solid;
use crate::scene::reader::Spanned;
use crate::scene::values::FormulaText;
use glam::DVec3;

/// Three formulas of a scene.
type VectorText = [FormulaText; 3];

/// A solid with its numbers; `None` if one of them is invalid, which is reported.
pub fn resolve_solid(
    solid: &SolidFile,
    span: &Span,
    constants: &BodyConstants,
    meshes: &mut MeshFiles,
    diagnostics: &mut Diagnostics,
) -> Option<Solid> {
    let mut site = SolidSite {
        span,
        constants,
        diagnostics,
    };
    // Every kind has its own method, which reads all numbers before it rejects any.
    match solid {
        SolidFile::Sphere { centre, radius } => site.sphere(centre, radius),
        SolidFile::Capsule { from, to, radius } => site.capsule([from, to], radius),
        SolidFile::Cylinder { from, to, radius } => site.cylinder([from, to], radius),
        SolidFile::Cone {
            from,
            to,
            radius_from,
            radius_to,
        } => site.cone([from, to], [radius_from, radius_to]),
        SolidFile::Box { centre, size } => site.cuboid(centre, size),
        SolidFile::Torus {
            centre,
            axis,
            ring,
            tube,
        } => site.torus((centre, axis), [ring, tube]),
        SolidFile::Tube {
            points,
            radius,
            closed,
        } => site.tube(points, radius, *closed),
        SolidFile::HalfSpace {
            point,
            normal,
            size,
        } => site.half_space((point, normal), size),
        SolidFile::Stl {
            file,
            scale,
            surface,
        } => site.triangles(file, scale.as_ref(), *surface, meshes),
    }
}

/// A solid in the file, and the context in which its numbers are read. All numbers are read before a missing one ends
/// it, so that all errors are reported.
struct SolidSite<'a, 'n> {
    span: &'a Span,
    constants: &'a BodyConstants<'n>,
    diagnostics: &'a mut Diagnostics,
}

impl SolidSite<'_, '_> {
    fn sphere(&mut self, centre: &Option<VectorText>, radius: &FormulaText) -> Option<Solid> {
        let (centre, radius) = (self.vector_or_zero(centre), self.positive("radius", radius));
        Some(Solid::Sphere {
            centre: centre?,
            radius: radius?,
        })
    }

    fn capsule(&mut self, ends: [&VectorText; 2], radius: &FormulaText) -> Option<Solid> {
        let [from, to] = ends.map(|end| self.vector(end));
        let radius = self.positive("radius", radius);
        Some(Solid::Capsule {
            from: from?,
            to: to?,
            radius: radius?,
        })
    }

    fn cylinder(&mut self, ends: [&VectorText; 2], radius: &FormulaText) -> Option<Solid> {
        let ends = ends.map(|end| self.vector(end));
        let radius = self.positive("radius", radius);
        let [from, to] = self.distinct_ends(ends)?;
        Some(Solid::Cylinder {
            from,
            to,
            radius: radius?,
        })
    }

    fn cone(&mut self, ends: [&VectorText; 2], radii: [&FormulaText; 2]) -> Option<Solid> {
        let ends = ends.map(|end| self.vector(end));
        let [first, last] = radii.map(|radius| self.constants.value(radius, self.diagnostics));
        let (radius_from, radius_to) = (first?, last?);
        if radius_from < 0.0 || radius_to < 0.0 || radius_from + radius_to <= 0.0 {
            return self.refuse("radii of a cone must not be negative, and not both zero");
        }
        let [from, to] = self.distinct_ends(ends)?;
        Some(Solid::Cone {
            from,
            to,
            radius_from,
            radius_to,
        })
    }

    fn cuboid(&mut self, centre: &Option<VectorText>, size: &VectorText) -> Option<Solid> {
        let (centre, size) = (self.vector_or_zero(centre), self.vector(size)?);
        if size.min_element() <= 0.0 {
            return self.refuse("edges of a box must be positive");
        }
        Some(Solid::Box {
            centre: centre?,
            size,
        })
    }

    fn torus(
        &mut self,
        (centre, axis): (&Option<VectorText>, &Option<VectorText>),
        radii: [&FormulaText; 2],
    ) -> Option<Solid> {
        let (centre, axis) = (self.vector_or_zero(centre), self.vector_or_up(axis));
        let [ring, tube] = radii;
        let ring = self.positive("ring radius", ring);
        let tube = self.positive("tube radius", tube);
        let Some(axis) = axis?.try_normalize() else {
            return self.refuse("the axis of a torus has no direction");
        };
        Some(Solid::Torus {
            centre: centre?,
            axis,
            ring: ring?,
            tube: tube?,
        })
    }

    fn tube(
        &mut self,
        points: &Spanned<Vec<VectorText>>,
        radius: &FormulaText,
        closed: bool,
    ) -> Option<Solid> {
        let list: Option<Vec<DVec3>> = points.value.iter().map(|p| self.vector(p)).collect();
        let radius = self.positive("radius", radius);
        let list = list?;
        if list.len() < 2 {
            let diagnostic = Diagnostic::error("a tube needs at least two points");
            self.diagnostics.push(diagnostic.at(points.span.clone()));
            return None;
        }
        Some(Solid::Tube {
            points: list,
            radius: radius?,
            closed,
        })
    }

    fn half_space(
        &mut self,
        (point, normal): (&Option<VectorText>, &Option<VectorText>),
        size: &FormulaText,
    ) -> Option<Solid> {
        let (point, normal) = (self.vector_or_zero(point), self.vector_or_up(normal));
        let size = self.positive("size", size);
        let Some(normal) = normal?.try_normalize() else {
            return self.refuse("the normal of a half-space has no direction");
        };
        Some(Solid::HalfSpace {
            point: point?,
            normal,
            size: size?,
        })
    }

    fn triangles(
        &mut self,
        file: &Spanned<String>,
        scale: Option<&FormulaText>,
        is_surface: bool,
        meshes: &mut MeshFiles,
    ) -> Option<Solid> {
        let scale = scale.map_or(Some(1.0), |scale| self.positive("scale", scale))?;
        match meshes.read(&file.value, scale, is_surface) {
            Ok(soup) => Some(Solid::Triangles(soup)),
            Err(error) => {
                let diagnostic = Diagnostic::error(error).at(file.span.clone());
                self.diagnostics.push(diagnostic);
                None
            }
        }
    }

    fn vector(&mut self, texts: &VectorText) -> Option<DVec3> {
        self.constants.vector(texts, self.diagnostics)
    }

    fn vector_or_zero(&mut self, texts: &Option<VectorText>) -> Option<DVec3> {
        self.constants.vector_or_zero(texts, self.diagnostics)
    }

    /// A direction; z by default.
    fn vector_or_up(&mut self, texts: &Option<VectorText>) -> Option<DVec3> {
        let texts = texts.as_ref();
        texts.map_or(Some(DVec3::Z), |texts| self.vector(texts))
    }

    fn positive(&mut self, what: &str, text: &FormulaText) -> Option<f64> {
        self.constants.positive(what, text, self.diagnostics)
    }

    fn distinct_ends(&mut self, [from, to]: [Option<DVec3>; 2]) -> Option<[DVec3; 2]> {
        let (from, to) = (from?, to?);
        match from != to {
            true => Some([from, to]),
            false => self.refuse("both ends are the same point"),
        }
    }

    /// Reports an error of the whole solid.
    fn refuse<T>(&mut self, message: &str) -> Option<T> {
        let diagnostic = Diagnostic::error(message).at(self.span.clone());
        self.diagnostics.push(diagnostic);
        None
    }
}
