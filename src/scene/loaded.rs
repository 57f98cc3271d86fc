//! A scene as it was loaded: its mechanism, and what it asks for.

use crate::diag::Diagnostics;
use crate::model::actuation::Actuation;
use crate::model::clearance::ClearanceRules;
use crate::model::measure::Measures;
use crate::model::mechanism::Mechanism;
use crate::model::plot::Plot;
use crate::model::study::Study;
use crate::model::view::View;
use std::sync::Arc;

/// A scene ready to be solved and drawn.
#[derive(Clone, Debug)]
pub struct Scene {
    /// One line for lists.
    pub description: String,
    /// The mechanism.
    pub mechanism: Arc<Mechanism>,
    /// What drives it, and where the search for a first pose starts.
    pub actuation: Actuation,
    /// What is measured of its motion.
    pub measures: Measures,
    /// How it wants to be seen.
    pub view: View,
    /// Which clearances it asks for, if any.
    pub clearance: Option<ClearanceRules>,
    /// What of its motion it wants to be plotted.
    pub plots: Vec<Plot>,
    /// What may be varied in it, and what is asked of it.
    pub study: Option<Study>,
    /// Lengths and angles that the file gives as numbers: what else could be varied.
    pub dimensions: Vec<String>,
    /// What is odd but usable.
    pub warnings: Diagnostics,
}
