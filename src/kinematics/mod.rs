//! Position kinematics: closes the loops at every instant of the drive, and says how well.
//!
//! A [`Trajectory`](trajectory::Trajectory) is complete before anything is drawn; nothing here draws or prints.

pub mod assembly;
pub mod branch;
pub mod certificate;
pub mod closure;
pub mod continuation;
pub mod forward;
pub mod iterates;
pub mod measures;
pub mod modes;
pub mod newton;
pub mod offered;
pub mod qr;
pub mod rank;
pub mod rates;
pub mod sampling;
pub mod structure;
pub mod taylor;
pub mod trajectory;
