//! The effect of tolerances on a motion and its measures, with proof: bands that contain every piece, and the ranges
//! that pieces were found to attain.

mod allowed;
mod between;
mod clearances;
mod found_pieces;
mod measures;
mod motion;
mod pieces;
mod plan;
mod pose_bands;
mod reductions;
mod tracked;
mod whole_measures;

pub use allowed::{AllowedTolerance, allowed_motion};
pub use between::enclose_between;
pub use clearances::enclose_clearances;
pub use measures::{MeasureBand, enclose_measures};
pub use motion::{Enclosed, SpanBands, enclose_motion, shown_names};
pub use pieces::PieceTolerances;
pub use plan::{MOST_DIMENSIONS, TolerancePlan, TolerancedDimension};
pub use pose_bands::{BandObstacle, Bands, ValueBand};
pub use whole_measures::measures_at_all_times;
