//! Why a study cannot be made, and what would help.

use crate::diag::{SceneError, name_hint};
use crate::kinematics::structure::block::StructureError;
use crate::scene::{KeptIn, KeptParameter};

/// Why a study cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum FamilyError {
    /// The scene has mistakes.
    #[error(transparent)]
    Scene(#[from] Box<SceneError>),
    /// The mechanism is ill-posed.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// Something the study needs is missing.
    #[error("{0}")]
    Lacks(String),
    /// Dimensions without a tolerance.
    #[error("there is no tolerance for {0}")]
    NoTolerance(String),
    /// A tolerance for those that have none, where all have one.
    #[error(
        "the given tolerance applies to no dimension: only {0} may vary, with tolerances of their own"
    )]
    UnusedTolerance(String),
    /// A dimension in a place that keeps the file's value.
    #[error("`{}` appears {}, where it would keep the file's value", .0.name, .0.place)]
    Kept(KeptParameter),
    /// A measure or value that the scene does not have.
    #[error("the scene has no {what} `{name}`")]
    Unknown {
        /// What it should be.
        what: &'static str,
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// A pose of a track does not exist with the file's own values.
    #[error("track `{track}`: {message}")]
    Track {
        /// Name of the track.
        track: String,
        /// Which pose, and why.
        message: String,
    },
}

impl FamilyError {
    /// A suggested remedy that needs no options of the command line.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Unknown { name, known, .. } => {
                Some(name_hint(name, known.iter().map(String::as_str)))
            }
            Self::NoTolerance(_) => Some(
                "give one for all, or each its own: `[study.variables]` NAME = { tolerance = 0.1 }"
                    .to_owned(),
            ),
            Self::UnusedTolerance(_) => Some(
                "leave it out, or vary others too: `--vary all` takes every dimension".to_owned(),
            ),
            Self::Kept(kept) if kept.place == KeptIn::Drive => {
                Some("put what is added to an input into the chain: Rz(phi + phi0)".to_owned())
            }
            Self::Kept(_) => {
                Some("leave it out of what varies, or write the number there".to_owned())
            }
            Self::Scene(_) | Self::Structure(_) | Self::Lacks(_) | Self::Track { .. } => None,
        }
    }

    /// Refuses a tolerance for those that have none, where all `varied` dimensions have one of their own.
    ///
    /// # Errors
    /// It is given, and has no effect.
    pub fn refuse_unused<'n>(
        general: Option<f64>,
        varied: impl Iterator<Item = (&'n str, bool)>,
    ) -> Result<(), Self> {
        let varied: Vec<(&str, bool)> = varied.collect();
        if general.is_none() || varied.is_empty() || !varied.iter().all(|(_, has_own)| *has_own) {
            return Ok(());
        }
        let names: Vec<&str> = varied.into_iter().map(|(name, _)| name).collect();
        Err(Self::UnusedTolerance(names.join(", ")))
    }

    /// The refusal of a study without variables: what to do depends on whether the scene has `dimensions`.
    pub fn nothing_to_vary(dimensions: &[String]) -> Self {
        let message = if dimensions.is_empty() {
            "there is nothing to vary: the scene has no parameters; write its dimensions as `[parameters]`"
        } else {
            "there is nothing to vary: name parameters in `[study.variables]` or as those to vary"
        };
        Self::Lacks(message.to_owned())
    }
}
