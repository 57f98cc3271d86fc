//! A scene after loading: its mechanism, its drives, and what it requests.

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

/// A place where a scene keeps the file's value of a parameter that a study varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptIn {
    /// In the drive of an input.
    Drive,
    /// In the ends of a track, or the number of its poses.
    Track,
    /// In the power of a norm.
    Power,
    /// In the limits of a measure.
    Limit,
    /// In the duration.
    Duration,
    /// In the axis of a rotation.
    Direction,
    /// In the minimum of a clearance, or the depth that is allowed.
    Clearance,
    /// In the range or the tolerance of a variable.
    Range,
}

impl fmt::Display for KeptIn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Drive => "in a drive",
            Self::Track => "in a track",
            Self::Power => "in the power of a norm",
            Self::Limit => "in the limits of a measure",
            Self::Duration => "in the duration",
            Self::Direction => "in the axis of a rotation",
            Self::Clearance => "in the limits of clearances",
            Self::Range => "in the range or tolerance of a variable",
        })
    }
}

/// A varied parameter whose file value is still used somewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeptParameter {
    /// The parameter.
    pub name: String,
    /// Where.
    pub place: KeptIn,
}

/// A scene ready to be solved and drawn. Parts that do not depend on the drive are shared between copies.
#[derive(Clone, Debug)]
pub struct Scene {
    /// One line for lists.
    pub description: String,
    /// The mechanism.
    pub mechanism: Arc<Mechanism>,
    /// Its drives, and the start values of the first pose.
    pub actuation: Actuation,
    /// Its measures.
    pub measures: Arc<Measures>,
    /// Its view.
    pub view: Arc<View>,
    /// The clearances to check, if any.
    pub clearance: Option<Arc<ClearanceRules>>,
    /// The plots of its motion.
    pub plots: Arc<[Plot]>,
    /// What may be varied, and the objective and limits.
    pub study: Option<Arc<Study>>,
    /// Lengths and angles given as numbers in the file: further candidates for variation.
    pub dimensions: Arc<[String]>,
    /// The kind of every parameter, if known.
    pub kinds: Arc<[(String, Kind)]>,
    /// Varied parameters whose file values are still used somewhere.
    pub kept: Vec<KeptParameter>,
    /// Its chains as written, on request.
    pub notation: Option<Notation>,
    /// Its solids as functions of the varied parameters, on request.
    pub carried: Vec<CarriedShape>,
    /// For every body the varied parameters that its shapes depend on, by their number.
    pub shaped_by: Vec<Vec<usize>>,
    /// Warnings.
    pub warnings: Diagnostics,
}

impl Scene {
    /// Gives the measures the limits of `[study.limits]` as well.
    pub fn keep_limits_of_study(&mut self) {
        if let Some(study) = &self.study {
            study.limit(Arc::make_mut(&mut self.measures));
        }
    }
}
