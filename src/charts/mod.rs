//! Charts of what was solved and studied: quantities of a motion, clearances, clouds of paths, work against precision.
//!
//! Values in, a [`Chart`](crate::plot::Chart) out; drawing it is [`plot`](crate::plot)'s.

pub mod bands;
pub mod clearance;
pub mod clearance_matrix;
pub mod cloud;
pub mod contours;
mod gaps;
pub mod motion;
pub mod paving;
pub mod precision;
pub mod search;
pub mod sensitivity;
pub mod sweep;
