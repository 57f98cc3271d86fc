//! Contacts of two surfaces as typed: the kinds of surfaces and the keys of each.

use super::reader::{Spanned, TableReader, required_value};
use super::values::FormulaText;
use crate::diag::Diagnostic;

/// One entry of `[contacts]`.
#[derive(Clone, Debug)]
pub struct ContactFile {
    /// Its name.
    pub name: Spanned<String>,
    /// `first` and `second`; `None` if one of them could not be read, which has been reported.
    pub surfaces: Option<[SurfaceFile; 2]>,
}

/// One of the two surfaces.
#[derive(Clone, Debug)]
pub struct SurfaceFile {
    /// The surface.
    pub surface: ContactSurface<FormulaText>,
    /// `frame`: the chain `world_from_surface`; the world itself if absent.
    pub frame: Option<FormulaText>,
}

/// A surface in its own frame, with axes and normals along z. `T` is the type of its sizes at this stage.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactSurface<T> {
    /// About the z axis: radius of the centre circle, radius of the tube (which may be the larger one).
    Torus {
        /// `ring`
        ring: T,
        /// `tube`
        tube: T,
    },
    /// About the origin; a radius of zero is a point.
    Sphere {
        /// `radius`
        radius: T,
    },
    /// About the z axis, infinitely long.
    Cylinder {
        /// `radius`
        radius: T,
    },
    /// The xy plane, unbounded; the other body is on the side of +z.
    Plane,
}

impl<T> ContactSurface<T> {
    /// The name in scene files.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Torus { .. } => "torus",
            Self::Sphere { .. } => "sphere",
            Self::Cylinder { .. } => "cylinder",
            Self::Plane => "plane",
        }
    }

    /// Its sizes with their names.
    pub fn sizes(&self) -> Vec<(&'static str, &T)> {
        match self {
            Self::Torus { ring, tube } => vec![("ring", ring), ("tube", tube)],
            Self::Sphere { radius } | Self::Cylinder { radius } => vec![("radius", radius)],
            Self::Plane => Vec::new(),
        }
    }

    /// The same surface with converted sizes; `None` if one of them cannot be converted.
    pub fn try_map<U>(&self, mut f: impl FnMut(&T) -> Option<U>) -> Option<ContactSurface<U>> {
        Some(match self {
            Self::Torus { ring, tube } => {
                let (ring, tube) = (f(ring), f(tube));
                ContactSurface::Torus {
                    ring: ring?,
                    tube: tube?,
                }
            }
            Self::Sphere { radius } => ContactSurface::Sphere { radius: f(radius)? },
            Self::Cylinder { radius } => ContactSurface::Cylinder { radius: f(radius)? },
            Self::Plane => ContactSurface::Plane,
        })
    }
}

/// Reads the two surfaces of a contact.
pub fn read_surfaces(r: &mut TableReader) -> Option<[SurfaceFile; 2]> {
    let first = required_value(r, "first", |r, k| r.table(k, read_surface)).flatten();
    let second = required_value(r, "second", |r, k| r.table(k, read_surface)).flatten();
    Some([first?, second?])
}

fn read_surface(r: &mut TableReader) -> Option<SurfaceFile> {
    let span = r.span.clone();
    // Every key is read, so that all errors are reported.
    let torus = r.table("torus", |s| {
        let ring = required_value(s, "ring", |s, k| s.formula(k));
        let tube = required_value(s, "tube", |s, k| s.formula(k));
        Some(ContactSurface::Torus {
            ring: ring?,
            tube: tube?,
        })
    });
    let sphere = r.table("sphere", |s| {
        let radius = required_value(s, "radius", |s, k| s.formula(k))?;
        Some(ContactSurface::Sphere { radius })
    });
    let cylinder = r.table("cylinder", |s| {
        let radius = required_value(s, "radius", |s, k| s.formula(k))?;
        Some(ContactSurface::Cylinder { radius })
    });
    let plane = r.table("plane", |_| Some(ContactSurface::Plane));
    let frame = r.formula("frame");
    // Exactly one of them: a surface with an error has been reported.
    let mut found = [torus, sphere, cylinder, plane].into_iter().flatten();
    match (found.next(), found.next()) {
        (Some(surface), None) => Some(SurfaceFile {
            surface: surface?,
            frame,
        }),
        (first, _) => {
            let message = match first {
                None => "a contact needs a surface on each side",
                Some(_) => "a side of a contact has only one surface",
            };
            let hint = "one of torus = { ring, tube }, sphere = { radius }, cylinder = { radius }, plane = {}";
            r.diagnostics
                .push(Diagnostic::error(message).at(span).hint(hint));
            None
        }
    }
}
