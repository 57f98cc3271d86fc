//! `[view]` as typed, before names and units are resolved.

use super::reader::{Spanned, TableReader, required_value};
use super::values::FormulaText;
use crate::diag::Span;

/// `[view]`
#[derive(Clone, Debug, Default)]
#[allow(missing_docs)]
pub struct ViewFile {
    pub azimuth: Option<FormulaText>,
    pub elevation: Option<FormulaText>,
    pub up: Option<Spanned<String>>,
    pub projection: Option<Spanned<String>>,
    pub fov: Option<FormulaText>,
    pub margin: Option<FormulaText>,
    pub background: Option<[u8; 3]>,
    pub ground: Option<FormulaText>,
    pub fps: Option<FormulaText>,
    pub captions: Option<bool>,
    pub from: Option<Spanned<String>>,
    pub theme: Option<Spanned<String>>,
    pub edges: Option<Spanned<String>>,
    pub shadows: Option<Spanned<String>>,
    pub transparent: Option<bool>,
    pub ghosts: Option<FormulaText>,
    pub ghost_times: Option<Spanned<Vec<FormulaText>>>,
    pub trails: Option<Spanned<String>>,
    pub trail_length: Option<FormulaText>,
    pub arrows: Option<bool>,
    pub arrow_scale: Option<FormulaText>,
    pub axes: Option<Spanned<String>>,
    pub scale: Option<bool>,
    pub ticks: Option<FormulaText>,
    pub bounce: Option<bool>,
    pub pause: Option<FormulaText>,
    pub gauge: Option<bool>,
    pub joints: Option<bool>,
    pub orbit: Option<FormulaText>,
    pub camera_path: Vec<CameraKeyFile>,
    pub section: Option<SectionFile>,
    pub explode: Option<FormulaText>,
}

/// An entry of `camera_path`
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct CameraKeyFile {
    pub t: Option<FormulaText>,
    pub azimuth: Option<FormulaText>,
    pub elevation: Option<FormulaText>,
    pub zoom: Option<FormulaText>,
    pub distance: Option<FormulaText>,
    pub target: Option<[FormulaText; 3]>,
    pub span: Span,
}

/// `section`
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct SectionFile {
    pub point: Option<[FormulaText; 3]>,
    pub normal: Option<[FormulaText; 3]>,
    pub bodies: Option<Vec<Spanned<String>>>,
}

/// Reads `[view]`.
pub fn read_view(r: &mut TableReader) -> ViewFile {
    ViewFile {
        azimuth: r.formula("azimuth"),
        elevation: r.formula("elevation"),
        up: r.string("up"),
        projection: r.string("projection"),
        fov: r.formula("fov"),
        margin: r.formula("margin"),
        background: r.colour("background"),
        ground: r.formula("ground"),
        fps: r.formula("fps"),
        captions: r.boolean("captions"),
        from: r.string("from"),
        theme: r.string("theme"),
        edges: r.string("edges"),
        shadows: r.string("shadows"),
        transparent: r.boolean("transparent"),
        ghosts: r.formula("ghosts"),
        ghost_times: r.formulas("ghost_times"),
        trails: r.string("trails"),
        trail_length: r.formula("trail_length"),
        arrows: r.boolean("arrows"),
        arrow_scale: r.formula("arrow_scale"),
        axes: r.string("axes"),
        scale: r.boolean("scale"),
        ticks: r.formula("ticks"),
        bounce: r.boolean("bounce"),
        pause: r.formula("pause"),
        gauge: r.boolean("gauge"),
        joints: r.boolean("joints"),
        orbit: r.formula("orbit"),
        camera_path: r.tables("camera_path", camera_key),
        section: r.table("section", section),
        explode: r.formula("explode"),
    }
}

fn section(r: &mut TableReader) -> SectionFile {
    SectionFile {
        point: required_value(r, "point", TableReader::vector),
        normal: required_value(r, "normal", TableReader::vector),
        bodies: r.strings("bodies"),
    }
}

fn camera_key(r: &mut TableReader) -> CameraKeyFile {
    CameraKeyFile {
        t: r.formula("t"),
        azimuth: r.formula("azimuth"),
        elevation: r.formula("elevation"),
        zoom: r.formula("zoom"),
        distance: r.formula("distance"),
        target: r.vector::<3>("target"),
        span: r.span.clone(),
    }
}
