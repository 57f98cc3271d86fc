//! A mechanism with variables, posed along the tracks of its study, and the measures of that: values and exact
//! gradients. Optimisers, sensitivities and tolerances are loops around this.

mod family;
mod gradient;
mod measure;
pub mod optimum;
mod peaks;
mod reshaped;
mod rows;
mod search;
mod slopes;
mod stand;
mod tears;

pub use family::{FamilyError, Nominal, ParametricMechanism};
pub use gradient::Gradients;
pub use measure::Measured;
pub use peaks::{Guard, Peaks};
pub use search::{Refusals, StudySearch, Watch};
pub use stand::{Evaluator, Rejection, TrackPoses};
