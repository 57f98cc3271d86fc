//! Bodies, traced points and labels of a scene file, as typed.

use super::reader::{Spanned, TableReader, required_value};
use super::shapes::read_shapes;
use super::solids::ShapeFile;
use super::values::FormulaText;
use crate::diag::Span;

/// One entry of `[[bodies]]`.
#[derive(Clone, Debug)]
pub struct BodyFile {
    /// `name`
    pub name: Spanned<String>,
    /// `frame`: the chain `world_from_body`; the world itself if absent.
    pub frame: Option<FormulaText>,
    /// `colour`
    pub colour: Option<[u8; 3]>,
    /// `opacity`
    pub opacity: Option<FormulaText>,
    /// `shapes`
    pub shapes: Vec<ShapeFile>,
}

/// One entry of `[[traces]]`.
#[derive(Clone, Debug)]
pub struct TraceFile {
    /// `name`
    pub name: Spanned<String>,
    /// `body`
    pub body: Spanned<String>,
    /// `point`; the origin of the body's frame if absent.
    pub point: Option<[FormulaText; 3]>,
    /// `colour`
    pub colour: Option<[u8; 3]>,
    /// `radius`
    pub radius: Option<FormulaText>,
}

/// One entry of `[[labels]]`.
#[derive(Clone, Debug)]
pub struct LabelFile {
    /// `text`
    pub text: Spanned<String>,
    /// `body`
    pub body: Option<Spanned<String>>,
    /// `point`
    pub point: Option<[FormulaText; 3]>,
    /// `trace`
    pub trace: Option<Spanned<String>>,
    /// `time`
    pub time: Option<FormulaText>,
    /// `colour`
    pub colour: Option<[u8; 3]>,
    /// `size`
    pub size: Option<FormulaText>,
    /// `leader`
    pub leader: Option<bool>,
    /// `hides`
    pub hides: Option<bool>,
    /// The whole entry.
    pub span: Span,
}

/// Reads one entry; what is required and missing is reported.
pub fn read_body(r: &mut TableReader) -> Option<BodyFile> {
    let name = required_value(r, "name", |r, key| r.string(key));
    let frame = r.formula("frame");
    let colour = r.colour("colour");
    let opacity = r.formula("opacity");
    let shapes = r
        .tables("shapes", read_shapes)
        .into_iter()
        .flatten()
        .collect();
    Some(BodyFile {
        name: name?,
        frame,
        colour,
        opacity,
        shapes,
    })
}

/// Reads one entry; what is required and missing is reported.
pub fn read_trace(r: &mut TableReader) -> Option<TraceFile> {
    let name = required_value(r, "name", |r, k| r.string(k));
    let body = required_value(r, "body", |r, k| r.string(k));
    let (point, colour, radius) = (r.vector("point"), r.colour("colour"), r.formula("radius"));
    Some(TraceFile {
        name: name?,
        body: body?,
        point,
        colour,
        radius,
    })
}

/// Reads one entry; what is required and missing is reported.
pub fn read_label(r: &mut TableReader) -> Option<LabelFile> {
    let span = r.span.clone();
    let text = required_value(r, "text", |r, k| r.lines(k));
    let (body, point) = (r.string("body"), r.vector("point"));
    let (trace, time) = (r.string("trace"), r.formula("time"));
    let (colour, size) = (r.colour("colour"), r.formula("size"));
    let (leader, hides) = (r.boolean("leader"), r.boolean("hides"));
    Some(LabelFile {
        text: text?,
        body,
        point,
        trace,
        time,
        colour,
        size,
        leader,
        hides,
        span,
    })
}
