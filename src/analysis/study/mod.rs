//! A mechanism with variables, posed along the tracks of its study, and the measures of that: values and exact
//! gradients. Optimisers, sensitivities and tolerances are loops around this.

mod gradient;
mod measure;
pub mod optimum;
mod peaks;
mod reduce;
mod search;
mod stand;

use crate::diag::{SceneError, Source};
use crate::kinematics::certificate::Certificate;
use crate::kinematics::continuation::solve;
use crate::kinematics::structure::{Structure, StructureError};
use crate::model::drive::{Drive, Ease};
use crate::model::mechanism::Mechanism;
use crate::model::study::Study;
use crate::scene::{Overrides, load};
pub use gradient::Gradients;
pub use measure::Measured;
pub use peaks::Peaks;
pub use search::{Refusals, Search, Watch};
pub use stand::{Evaluator, Rejection, Stand};

/// A mechanism whose last inputs are the variables of its study.
#[derive(Clone, Debug)]
pub struct Family {
    /// The mechanism; traced points have frames of their own in it, bodies are as in the file.
    pub mechanism: Mechanism,
    /// What is varied and asked.
    pub study: Study,
    structure: Structure,
}

/// The poses of a study with the file's values, and what is proved of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Nominal {
    /// Unknowns, then inputs, of every pose, track after track.
    pub poses: Vec<Vec<f64>>,
    /// Largest certified error of a coordinate, in the scene's unit as certificates have it.
    pub error_bound: f64,
    /// Poses without a certificate.
    pub unproved: usize,
}

impl Nominal {
    fn add(&mut self, pose: Vec<f64>, certificate: Certificate) {
        self.poses.push(pose);
        match certificate {
            Certificate::Certified { error_bound, .. } => {
                self.error_bound = self.error_bound.max(error_bound)
            }
            Certificate::Refused { .. } => self.unproved += 1,
        }
    }
}

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
    /// A pose of a track does not exist with the file's own values.
    #[error("track `{track}`: {message}")]
    Track {
        /// Name of the track.
        track: String,
        /// Which pose, and why.
        message: String,
    },
}

impl Family {
    /// Reads the scene with the parameters called `vary` as variables, or with those of its `[study]`.
    ///
    /// # Errors
    /// Mistakes in the scene; nothing to vary; a mechanism that is not determined.
    pub fn load(
        source: &Source,
        overrides: &Overrides,
        vary: &[String],
    ) -> Result<Self, FamilyError> {
        let nominal = load(source, overrides).map_err(Box::new)?;
        let own = nominal.study.iter().flat_map(|s| &s.variables);
        let names: Vec<String> = if vary.is_empty() {
            own.map(|v| v.name.clone()).collect()
        } else {
            vary.to_vec()
        };
        if names.is_empty() {
            let message =
                "nothing is to be varied: name parameters in `[study.variables]` or with --vary";
            return Err(FamilyError::Lacks(message.to_owned()));
        }
        let overrides = Overrides {
            vary: names,
            ..overrides.clone()
        };
        let scene = load(source, &overrides).map_err(Box::new)?;
        let mut mechanism = scene.mechanism;
        // Fixed offsets became joints of this mechanism; its residuals keep their scale.
        mechanism.size = nominal.mechanism.size;
        let structure = Structure::new(&mechanism)?;
        let study = scene.study.unwrap_or_default();
        if study.tracks.is_empty() {
            let message = "the scene has no `[study.tracks]`: say at which inputs poses are taken";
            return Err(FamilyError::Lacks(message.to_owned()));
        }
        Ok(Self {
            mechanism,
            study,
            structure,
        })
    }

    /// Number of the scene's own inputs; the variables follow them.
    pub fn own_inputs(&self) -> usize {
        self.mechanism.inputs.len() - self.study.variables.len()
    }

    /// The file's values of the variables.
    pub fn start(&self) -> Vec<f64> {
        self.study.variables.iter().map(|v| v.start).collect()
    }

    /// Every pose of every track with the file's values, followed from the start of the drive.
    ///
    /// # Errors
    /// The first pose that does not exist.
    pub fn nominal(&self) -> Result<Nominal, FamilyError> {
        let mut nominal = Nominal::default();
        for track in &self.study.tracks {
            let mut mechanism = self.mechanism.clone();
            let mut rows = vec![self.mechanism.inputs_at(0.0)[..self.own_inputs()].to_vec()];
            rows.extend(track.inputs.iter().cloned());
            let times: Vec<f64> = (0..rows.len()).map(|k| k as f64).collect();
            for input in 0..self.own_inputs() {
                mechanism.drives[input] = Drive::Keys {
                    times: times.clone(),
                    values: rows.iter().map(|row| row[input]).collect(),
                    ease: Ease::Linear,
                };
            }
            mechanism.duration = times.len() as f64;
            let trajectory = solve(&mechanism, &times)?;
            for (k, sample) in trajectory.samples.iter().enumerate().skip(1) {
                let Some(pose) = &sample.pose else {
                    return Err(FamilyError::Track {
                        track: track.name.clone(),
                        message: format!(
                            "the mechanism cannot be closed at pose {k} with the file's values"
                        ),
                    });
                };
                nominal.add(
                    [pose.unknowns.as_slice(), &sample.inputs].concat(),
                    pose.certificate,
                );
            }
        }
        Ok(nominal)
    }

    /// Track and number (from 1) of pose `index` of all.
    fn place_of(&self, index: usize) -> (usize, usize) {
        let mut rest = index;
        for (number, track) in self.study.tracks.iter().enumerate() {
            if rest < track.inputs.len() {
                return (number, rest + 1);
            }
            rest -= track.inputs.len();
        }
        (0, 0)
    }
}
