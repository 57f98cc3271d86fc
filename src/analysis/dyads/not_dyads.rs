//! Why a mechanism does not come apart into dyads.

use crate::intervals::peeling::NoDyads;

/// Why a mechanism is no row of dyads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotDyads {
    /// A joint that is no hinge.
    #[error("not a chain of dyads: {0}, and bars turn in hinges only")]
    Joint(String),
    /// Axes that are not parallel.
    #[error("not a chain of dyads: the axes are not parallel, {0}")]
    NotPlanar(String),
    /// Points of a link in one line.
    #[error(
        "not a chain of dyads: the points {0} of a link are in one line, which bars do not hold"
    )]
    InLine(String),
    /// No joint at all.
    #[error("not a chain of dyads: there are no hinges")]
    NoHinges,
    /// A bar's end that is neither on a link nor free in the plane.
    #[error("not a chain of dyads: point {0} is neither on a link nor free in the plane")]
    Point(String),
    /// An equation that is no bar.
    #[error("not a chain of dyads: equation `{0}` is no bar")]
    Equation(String),
    /// The bars do not come apart.
    #[error("not a chain of dyads: {0}")]
    Bars(#[from] NoDyads),
    /// Not one degree of freedom.
    #[error("not a chain of dyads with one degree of freedom: it has {0}")]
    Freedoms(usize),
    /// Bars in line.
    #[error("the bars of dyad {0} are in line here: its matrices have a pole")]
    Pole(String),
}
