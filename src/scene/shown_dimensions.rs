//! Dimensions in pictures as typed.

use super::reader::{Spanned, TableReader, required_value};
use super::values::FormulaText;
use crate::diag::Span;

/// One entry of `[[dimensions]]`.
#[derive(Clone, Debug)]
pub struct ShownDimensionFile {
    /// `from` and `to`; what could not be read is `None` and has been reported.
    pub ends: [Option<PlaceFile>; 2],
    /// `at`: the vertex of an angle.
    pub at: Option<PlaceFile>,
    /// `axis` of an angle
    pub axis: Option<[FormulaText; 3]>,
    /// `radius` of an angle
    pub radius: Option<FormulaText>,
    /// `offset` of a length
    pub offset: Option<[FormulaText; 3]>,
    /// `text`
    pub text: Option<Spanned<String>>,
    /// `digits`
    pub digits: Option<FormulaText>,
    /// `colour`
    pub colour: Option<[u8; 3]>,
    /// The whole entry.
    pub span: Span,
}

/// A point: on a body, on a trace, or in the world.
#[derive(Clone, Debug)]
pub struct PlaceFile {
    /// `body`
    pub body: Option<Spanned<String>>,
    /// `trace`
    pub trace: Option<Spanned<String>>,
    /// `point`
    pub point: Option<[FormulaText; 3]>,
}

/// Reads one entry; what is required and missing is reported.
pub fn read_shown_dimension(r: &mut TableReader) -> ShownDimensionFile {
    let from = required_value(r, "from", |r, key| r.table(key, read_place));
    let to = required_value(r, "to", |r, key| r.table(key, read_place));
    let at = r.table("at", read_place);
    let (axis, radius, offset) = (r.vector("axis"), r.formula("radius"), r.vector("offset"));
    let (text, digits, colour) = (r.string("text"), r.formula("digits"), r.colour("colour"));
    ShownDimensionFile {
        ends: [from, to],
        at,
        axis,
        radius,
        offset,
        text,
        digits,
        colour,
        span: r.span.clone(),
    }
}

fn read_place(r: &mut TableReader) -> PlaceFile {
    PlaceFile {
        body: r.string("body"),
        trace: r.string("trace"),
        point: r.vector("point"),
    }
}
