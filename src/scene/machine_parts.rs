//! Machine parts as typed: rods with eyes, forks, pins, bearings and turned parts. Each is expanded into solids, so
//! that distances, studies and models do not need to know machine parts.

use super::reader::{TableReader, required_value};
use super::solids::SolidFile;
use super::values::FormulaText;
use crate::diag::Diagnostic;

/// The names of the parts.
pub const PARTS: &str = "rod, fork, pin, bearing, lathe";

/// Reads the machine parts among the keys of a shape: the solids of each, or `None` for one that cannot be read, which
/// is reported.
pub fn read_parts(r: &mut TableReader) -> Vec<Option<Vec<SolidFile>>> {
    let parts = [
        r.table("rod", read_eyed_rod),
        r.table("fork", read_fork),
        r.table("pin", read_pin),
        r.table("bearing", read_bearing),
        r.table("lathe", read_lathe),
    ];
    parts.into_iter().flatten().collect()
}

/// A bar with an eye about z at both ends.
fn read_eyed_rod(r: &mut TableReader) -> Option<Vec<SolidFile>> {
    let from = required_value(r, "from", |r, k| r.vector(k));
    let to = required_value(r, "to", |r, k| r.vector(k));
    let radius = required_value(r, "radius", |r, k| r.formula(k));
    let eye = required_value(r, "eye", |r, k| r.formula(k));
    let width = required_value(r, "width", |r, k| r.formula(k));
    let (from, to, eye, width) = (from?, to?, eye?, width?);
    let eyes = [&from, &to].map(|[x, y, z]| SolidFile::Cylinder {
        from: [x.clone(), y.clone(), mixed(&[(z, 1.0), (&width, -0.5)])],
        to: [x.clone(), y.clone(), mixed(&[(z, 1.0), (&width, 0.5)])],
        radius: eye.clone(),
    });
    let bar = SolidFile::Capsule {
        from,
        to,
        radius: radius?,
    };
    Some(std::iter::once(bar).chain(eyes).collect())
}

/// Two cheeks with eyes about z at the origin, and the bridge between them at −x.
fn read_fork(r: &mut TableReader) -> Option<Vec<SolidFile>> {
    let radius = required_value(r, "radius", |r, k| r.formula(k));
    let gap = required_value(r, "gap", |r, k| r.formula(k));
    let depth = required_value(r, "depth", |r, k| r.formula(k));
    let thickness = required_value(r, "thickness", |r, k| r.formula(k));
    let (radius, gap, depth, thickness) = (radius?, gap?, depth?, thickness?);
    let wide = mixed(&[(&radius, 2.0)]);
    let mut solids = Vec::new();
    for side in [1.0, -1.0] {
        let inner = mixed(&[(&gap, 0.5 * side)]);
        let middle = mixed(&[(&gap, 0.5 * side), (&thickness, 0.5 * side)]);
        let outer = mixed(&[(&gap, 0.5 * side), (&thickness, side)]);
        solids.push(SolidFile::Cylinder {
            from: [zero(), zero(), inner],
            to: [zero(), zero(), outer],
            radius: radius.clone(),
        });
        solids.push(SolidFile::Box {
            centre: Some([mixed(&[(&depth, -0.5)]), zero(), middle]),
            size: [depth.clone(), wide.clone(), thickness.clone()],
        });
    }
    let across = mixed(&[(&gap, 1.0), (&thickness, 2.0)]);
    let back = mixed(&[(&depth, -1.0), (&thickness, -0.5)]);
    solids.push(SolidFile::Box {
        centre: Some([back, zero(), zero()]),
        size: [thickness, wide, across],
    });
    Some(solids)
}

/// A pin along z, centred at the origin, with a head beyond each end of its length.
fn read_pin(r: &mut TableReader) -> Option<Vec<SolidFile>> {
    let radius = required_value(r, "radius", |r, k| r.formula(k));
    let length = required_value(r, "length", |r, k| r.formula(k));
    let head = required_value(r, "head", |r, k| r.formula(k));
    let (radius, length, head) = (radius?, length?, head?);
    let along = |from: FormulaText, to: FormulaText, radius: &FormulaText| SolidFile::Cylinder {
        from: [zero(), zero(), from],
        to: [zero(), zero(), to],
        radius: radius.clone(),
    };
    let end = |side: f64| mixed(&[(&length, 0.5 * side)]);
    let heads = [1.0, -1.0].map(|side| {
        let beyond = mixed(&[(&length, 0.5 * side), (&radius, 0.5 * side)]);
        along(end(side), beyond, &head)
    });
    let shank = along(end(-1.0), end(1.0), &radius);
    Some(std::iter::once(shank).chain(heads).collect())
}

/// A housing about z at the origin, on a column with a bolted foot at −y.
fn read_bearing(r: &mut TableReader) -> Option<Vec<SolidFile>> {
    let radius = required_value(r, "radius", |r, k| r.formula(k));
    let width = required_value(r, "width", |r, k| r.formula(k));
    let height = required_value(r, "height", |r, k| r.formula(k));
    let (radius, width, height) = (radius?, width?, height?);
    let of_radius = |share: f64| mixed(&[(&radius, share)]);
    let above_foot = |share: f64| mixed(&[(&height, -1.0), (&radius, share)]);
    let mut solids = vec![
        SolidFile::Cylinder {
            from: [zero(), zero(), mixed(&[(&width, -0.5)])],
            to: [zero(), zero(), mixed(&[(&width, 0.5)])],
            radius: radius.clone(),
        },
        SolidFile::Box {
            // The column ends within the housing and does not reach the shaft.
            centre: Some([zero(), mixed(&[(&height, -0.5), (&radius, -0.375)]), zero()]),
            size: [
                of_radius(1.2),
                mixed(&[(&height, 1.0), (&radius, -0.75)]),
                mixed(&[(&width, 0.8)]),
            ],
        },
        SolidFile::Box {
            centre: Some([zero(), above_foot(0.2), zero()]),
            size: [of_radius(4.0), of_radius(0.4), width],
        },
    ];
    for side in [1.0, -1.0] {
        let x = of_radius(1.4 * side);
        solids.push(SolidFile::Cylinder {
            from: [x.clone(), above_foot(0.1), zero()],
            to: [x, above_foot(0.65), zero()],
            radius: of_radius(0.25),
        });
    }
    Some(solids)
}

/// A turned part about z: its contour as positions along the axis with radii.
fn read_lathe(r: &mut TableReader) -> Option<Vec<SolidFile>> {
    let profile = required_value(r, "profile", |r, k| r.rows::<2>(k))?;
    let pieces = profile.value.windows(2).filter_map(|pair| {
        let [[start, first], [end, last]] = [&pair[0], &pair[1]];
        // A step of the contour: the sections on both sides have separate ends.
        if start.text == end.text {
            return None;
        }
        let at = |z: &FormulaText| [zero(), zero(), z.clone()];
        let (from, to) = (at(start), at(end));
        Some(if first.text == last.text {
            SolidFile::Cylinder {
                from,
                to,
                radius: first.clone(),
            }
        } else {
            SolidFile::Cone {
                from,
                to,
                radius_from: first.clone(),
                radius_to: last.clone(),
            }
        })
    });
    let pieces: Vec<SolidFile> = pieces.collect();
    if pieces.is_empty() {
        let message = "a turned part needs at least two places on its axis";
        r.diagnostics
            .push(Diagnostic::error(message).at(profile.span));
        return None;
    }
    Some(pieces)
}

fn zero() -> FormulaText {
    FormulaText::outside("0")
}

/// A weighted sum of formulas. Messages point at the first formula, whose names keep their positions in the file.
fn mixed(terms: &[(&FormulaText, f64)]) -> FormulaText {
    let texts = terms.iter();
    let texts = texts.map(|(formula, factor)| format!("({})*({factor})", formula.text));
    let text = texts.collect::<Vec<_>>().join("+");
    match terms.first() {
        Some((first, _)) => FormulaText {
            text,
            offset: first.span.start,
            span: first.span.clone(),
            is_unread: terms.iter().any(|(formula, _)| formula.is_unread),
        },
        None => FormulaText::outside(&text),
    }
}
