//! A mechanism with variables, posed along the tracks of its study, and its measures: values and exact gradients.
//! Optimisers, sensitivities and tolerances are loops around this.

mod abreast;
mod branch_breaks;
mod branched;
mod family;
mod family_error;
mod gradient;
pub mod kept_clearances;
mod lane_measures;
mod loaded;
mod measure;
mod one_sided;
pub mod optimum;
mod own_motion;
mod peaks;
mod refined_extremes;
mod reshaped;
mod row_reader;
mod rows;
pub mod search;
mod search_steps;
mod slopes;
mod track_poses;
pub mod whole_limits;

pub use abreast::{AT_A_TIME, LaneEvaluator, PoseAnchors};
pub use family::{DRIVE_SAMPLES, Nominal, ParametricMechanism, SingularPassage};
pub use family_error::FamilyError;
pub use gradient::Gradients;
pub use lane_measures::LaneMeasures;
pub use loaded::{DefaultVariables, LoadedStudy, NominalStudy, varied_names};
pub use measure::MeasureValues;
pub use peaks::{Guard, Peaks};
pub use search::{Refusals, StudySearch, Watch};
pub use search_steps::FoundOptimum;
pub use slopes::MeasureSlopes;
pub use track_poses::{Evaluator, Rejection, TrackPoses};
pub use whole_limits::KEPT;
