//! Charts of solved motions and studies: quantities of a motion, clearances, clouds of paths, time against error.
//!
//! Values become a [`Chart`](crate::plot::Chart); [`plot`](crate::plot) draws it.

pub mod bands;
pub mod clearance;
pub mod clearance_matrix;
pub mod cloud;
mod coarse_samples;
pub mod contours;
mod gaps;
pub mod motion;
pub mod paving;
pub mod precision;
pub mod search;
pub mod sensitivity;
pub mod sweep;
mod wraps;
