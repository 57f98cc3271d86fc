//! The shapes of a body: each is read as one solid, or as the solids of a machine part.

use super::machine_parts;
use super::reader::{TableReader, required_value};
use super::solids::{ShapeFile, SolidFile};
use super::values::FormulaText;
use crate::diag::Diagnostic;

/// The names of the solids, in the order in which they are tried.
const SOLIDS: &str = "sphere, capsule, cylinder, cone, box, torus, tube, half_space, stl";

/// Reads one entry of `shapes`: a solid, or the solids of a machine part.
pub fn read_shapes(r: &mut TableReader) -> Vec<ShapeFile> {
    let span = r.span.clone();
    // Every key is read, so that all errors are reported: `None` for one with an error.
    let solids: Vec<Option<SolidFile>> = [
        r.table("sphere", |s| {
            let centre = s.vector("center");
            Some(SolidFile::Sphere {
                centre,
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
            let centre = s.vector("center");
            Some(SolidFile::Box {
                centre,
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
    // Machine parts are several solids.
    let solids: Vec<Option<Vec<SolidFile>>> = solids
        .into_iter()
        .map(|solid| solid.map(|solid| vec![solid]))
        .chain(machine_parts::read_parts(r))
        .collect();
    let (frame, colour, opacity) = (r.formula("frame"), r.colour("colour"), r.formula("opacity"));
    // One key, with errors or without: anything else is not a shape.
    if solids.len() != 1 {
        let message = if solids.is_empty() {
            "a shape needs a solid"
        } else {
            "a shape can have only one solid"
        };
        r.diagnostics.push(
            Diagnostic::error(message)
                .at(span.clone())
                .hint(format!("one of {SOLIDS}, {}", machine_parts::PARTS)),
        );
        return Vec::new();
    }
    let solids = solids.into_iter().flatten().flatten();
    let shapes = solids.map(|solid| ShapeFile {
        solid,
        frame: frame.clone(),
        colour,
        opacity: opacity.clone(),
        span: span.clone(),
    });
    shapes.collect()
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
    let (centre, axis) = (s.vector("center"), s.vector("axis"));
    let ring = required_value(s, "ring", |s, k| s.formula(k));
    let tube = required_value(s, "tube", |s, k| s.formula(k));
    Some(SolidFile::Torus {
        centre,
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
