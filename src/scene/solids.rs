//! Solids of a body as typed: their kinds, and the formulas of each.

use super::reader::Spanned;
use super::values::FormulaText;
use crate::diag::Span;

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
        centre: Option<[FormulaText; 3]>,
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
        centre: Option<[FormulaText; 3]>,
        size: [FormulaText; 3],
    },
    Torus {
        centre: Option<[FormulaText; 3]>,
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
