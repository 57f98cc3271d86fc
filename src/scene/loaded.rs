//! A scene as it was loaded: its mechanism, and what it asks for.

use crate::diag::Diagnostics;
use crate::model::actuation::Actuation;
use crate::model::carried::CarriedShape;
use crate::model::clearance::ClearanceRules;
use crate::model::measure::Measures;
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::notation::Notation;
use crate::model::plot::Plot;
use crate::model::study::Study;
use crate::model::view::View;
use std::fmt;
use std::sync::Arc;

/// Where a scene keeps the file's value of a parameter that is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptIn {
    /// In the drive of an input.
    Drive,
    /// In the ends of a track.
    Track,
    /// In a measure, by a parameter that is computed from it.
    Measure,
    /// In the axis of a rotation.
    Direction,
}

impl fmt::Display for KeptIn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Drive => "in a drive",
            Self::Track => "in the ends of a track",
            Self::Measure => "in a measure, by a parameter that is computed from it",
            Self::Direction => "in the axis of a rotation",
        })
    }
}

/// A varied parameter whose file's value is kept somewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    /// The parameter.
    pub name: String,
    /// Where.
    pub place: KeptIn,
}

/// A scene ready to be solved and drawn. What a change of the drive leaves alone is shared between copies.
#[derive(Clone, Debug)]
pub struct Scene {
    /// One line for lists.
    pub description: String,
    /// The mechanism.
    pub mechanism: Arc<Mechanism>,
    /// What drives it, and where the search for a first pose starts.
    pub actuation: Actuation,
    /// What is measured of its motion.
    pub measures: Arc<Measures>,
    /// How it wants to be seen.
    pub view: Arc<View>,
    /// Which clearances it asks for, if any.
    pub clearance: Option<Arc<ClearanceRules>>,
    /// What of its motion it wants to be plotted.
    pub plots: Arc<[Plot]>,
    /// What may be varied in it, and what is asked of it.
    pub study: Option<Arc<Study>>,
    /// Lengths and angles that the file gives as numbers: what else could be varied.
    pub dimensions: Arc<[String]>,
    /// What every parameter measures, as far as known.
    pub kinds: Arc<[(String, Kind)]>,
    /// Varied parameters whose file's values are kept somewhere.
    pub kept: Vec<Kept>,
    /// Its chains as written, where they were asked for.
    pub notation: Option<Notation>,
    /// Its solids as they follow what is varied, if that was asked for.
    pub carried: Vec<CarriedShape>,
    /// What is odd but usable.
    pub warnings: Diagnostics,
}
