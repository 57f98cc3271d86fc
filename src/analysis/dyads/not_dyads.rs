//! Reasons why a mechanism cannot be decomposed into dyads.

use crate::intervals::peeling::NoDyads;
use crate::model::mechanism::Mechanism;

/// Why a mechanism is not a sequence of dyads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotDyads {
    /// A joint that is not a hinge.
    #[error("not a chain of dyads: {0}, and bars turn in hinges only")]
    Joint(String),
    /// Axes that are not parallel.
    #[error("not a chain of dyads: the axes are not parallel, {0}")]
    NotPlanar(String),
    /// The points of a link are collinear.
    #[error(
        "not a chain of dyads: the points {0} of a link are in one line, so that bars do not make it rigid"
    )]
    InLine(String),
    /// No joint at all.
    #[error("not a chain of dyads: there are no hinges")]
    NoHinges,
    /// An end of a bar that is neither on a link nor free in the plane.
    #[error("not a chain of dyads: point {0} is neither on a link nor free in the plane")]
    Point(String),
    /// An equation that is not a bar.
    #[error("not a chain of dyads: equation `{0}` is no bar")]
    Equation(String),
    /// The bars cannot be decomposed into dyads.
    #[error("not a chain of dyads: {0}")]
    Bars(#[from] NoDyads),
    /// The degree of freedom is not one.
    #[error("not a chain of dyads with one degree of freedom: it has {0}")]
    Freedoms(usize),
    /// Bars in line.
    #[error("the bars of dyad {0} are in line here: its matrices have a pole")]
    Pole(String),
}

impl NotDyads {
    /// Refuses an equation that is no bar, beside bars.
    pub(super) fn judge_equations(mechanism: &Mechanism) -> Result<(), Self> {
        let is_bar = |name: &str| mechanism.bars.iter().any(|bar| bar.name == name);
        let mut equations = mechanism.equations.iter();
        match equations.find(|e| !mechanism.bars.is_empty() && !is_bar(&e.name)) {
            Some(other) => Err(Self::Equation(other.name.clone())),
            None => Ok(()),
        }
    }
}
