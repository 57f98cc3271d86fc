//! The shapes of a body as typed: which solids there are, and the keys each of them has.

use super::reader::{Spanned, TableReader, required_value};
use super::values::FormulaText;
use crate::diag::{Diagnostic, Span};

/// One shape of a body.
#[derive(Clone, Debug)]
pub struct ShapeFile {
    /// The solid.
    pub solid: SolidFile,
    /// `frame`: a constant chain `body_from_shape`.
    pub frame: Option<FormulaText>,
    /// `colour`
    pub colour: Option<[u8; 3]>,
    /// `opacity`
    pub opacity: Option<FormulaText>,
    /// Where the shape stands.
    pub span: Span,
}

/// Parameters of a solid as typed.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub enum SolidFile {
    Sphere {
        center: Option<[FormulaText; 3]>,
        radius: FormulaText,
    },
    Capsule {
        from: [FormulaText; 3],
        to: [FormulaText; 3],
        radius: FormulaText,
    },
    Cylinder {
        from: [FormulaText; 3],
        to: [FormulaText; 3],
        radius: FormulaText,
    },
    Cone {
        from: [FormulaText; 3],
        to: [FormulaText; 3],
        radius_from: FormulaText,
        radius_to: FormulaText,
    },
    Box {
        center: Option<[FormulaText; 3]>,
        size: [FormulaText; 3],
    },
    Torus {
        center: Option<[FormulaText; 3]>,
        axis: Option<[FormulaText; 3]>,
        ring: FormulaText,
        tube: FormulaText,
    },
    Tube {
        points: Spanned<Vec<[FormulaText; 3]>>,
        radius: FormulaText,
        closed: bool,
    },
    HalfSpace {
        point: Option<[FormulaText; 3]>,
        normal: Option<[FormulaText; 3]>,
        size: FormulaText,
    },
    Stl {
        file: Spanned<String>,
        scale: Option<FormulaText>,
        surface: bool,
    },
}

/// The names of the solids, in the order in which they are tried.
const SOLIDS: &str = "sphere, capsule, cylinder, cone, box, torus, tube, half_space, stl";

/// Reads one entry of `shapes`.
pub fn read_shape(r: &mut TableReader) -> Option<ShapeFile> {
    let span = r.span.clone();
    let solids: Vec<Option<SolidFile>> = [
        r.table("sphere", |s| {
            let center = s.vector("center");
            Some(SolidFile::Sphere {
                center,
                radius: required_value(s, "radius", |s, k| s.formula(k))?,
            })
        }),
        r.table("capsule", |s| {
            let (from, to, radius) = read_rod(s);
            Some(SolidFile::Capsule {
                from: from?,
                to: to?,
                radius: radius?,
            })
        }),
        r.table("cylinder", |s| {
            let (from, to, radius) = read_rod(s);
            Some(SolidFile::Cylinder {
                from: from?,
                to: to?,
                radius: radius?,
            })
        }),
        r.table("cone", read_cone),
        r.table("box", |s| {
            let center = s.vector("center");
            Some(SolidFile::Box {
                center,
                size: required_value(s, "size", |s, k| s.vector(k))?,
            })
        }),
        r.table("torus", read_torus),
        r.table("tube", read_tube),
        r.table("half_space", |s| {
            let (point, normal) = (s.vector("point"), s.vector("normal"));
            Some(SolidFile::HalfSpace {
                point,
                normal,
                size: required_value(s, "size", |s, k| s.formula(k))?,
            })
        }),
        r.table("stl", |s| {
            let (scale, surface) = (s.formula("scale"), s.boolean("surface"));
            Some(SolidFile::Stl {
                file: required_value(s, "file", |s, k| s.raw_string(k))?,
                scale,
                surface: surface.unwrap_or(false),
            })
        }),
    ]
    .into_iter()
    .flatten()
    .collect();
    let (frame, colour, opacity) = (r.formula("frame"), r.colour("colour"), r.formula("opacity"));
    if solids.len() != 1 {
        let message = if solids.is_empty() {
            "a shape needs a solid"
        } else {
            "a shape can have only one solid"
        };
        r.diagnostics.push(
            Diagnostic::error(message)
                .at(span)
                .hint(format!("one of {SOLIDS}")),
        );
        return None;
    }
    let solid = solids.into_iter().flatten().next()?;
    Some(ShapeFile {
        solid,
        frame,
        colour,
        opacity,
        span,
    })
}

type Rod = (
    Option<[FormulaText; 3]>,
    Option<[FormulaText; 3]>,
    Option<FormulaText>,
);

fn read_rod(s: &mut TableReader) -> Rod {
    let from = required_value(s, "from", |s, k| s.vector(k));
    let to = required_value(s, "to", |s, k| s.vector(k));
    (from, to, required_value(s, "radius", |s, k| s.formula(k)))
}

fn read_cone(s: &mut TableReader) -> Option<SolidFile> {
    let from = required_value(s, "from", |s, k| s.vector(k));
    let to = required_value(s, "to", |s, k| s.vector(k));
    let radius_from = required_value(s, "radius_from", |s, k| s.formula(k));
    let radius_to = required_value(s, "radius_to", |s, k| s.formula(k));
    Some(SolidFile::Cone {
        from: from?,
        to: to?,
        radius_from: radius_from?,
        radius_to: radius_to?,
    })
}

fn read_torus(s: &mut TableReader) -> Option<SolidFile> {
    let (center, axis) = (s.vector("center"), s.vector("axis"));
    let ring = required_value(s, "ring", |s, k| s.formula(k));
    let tube = required_value(s, "tube", |s, k| s.formula(k));
    Some(SolidFile::Torus {
        center,
        axis,
        ring: ring?,
        tube: tube?,
    })
}

fn read_tube(s: &mut TableReader) -> Option<SolidFile> {
    let points = required_value(s, "points", |s, k| s.rows::<3>(k));
    let radius = required_value(s, "radius", |s, k| s.formula(k));
    let closed = s.boolean("closed").unwrap_or(false);
    Some(SolidFile::Tube {
        points: points?,
        radius: radius?,
        closed,
    })
}
