//! Position kinematics: closes the loops at every instant of the drive, and says how well.
//!
//! A [`Trajectory`](trajectory::Trajectory) is complete before anything is drawn; nothing here draws or prints.

pub mod assembly;
pub mod ball;
pub mod branch;
pub mod certificate;
pub mod chart;
pub mod closure;
pub mod continuation;
pub mod elimination;
pub mod extremes;
pub mod feasible;
pub mod forward;
pub mod idle;
pub mod iterates;
pub mod lanes;
pub mod limits;
pub mod measures;
pub mod mobility;
pub mod modes;
pub mod newton;
pub mod offered;
pub mod order;
pub mod plan;
pub mod predictor;
pub mod probes;
pub mod qr;
mod quads;
pub mod rank;
pub mod rates;
pub mod sampling;
pub mod spin;
pub mod structure;
pub mod taylor;
pub mod trajectory;
pub mod twofold;
pub mod variation;
