//! Position kinematics: closes the loops at every instant of the drive, with a measure of quality and a proof.
//!
//! A [`Trajectory`](results::trajectory::Trajectory) is complete before anything is drawn; nothing here draws or prints.

pub mod abreast;
pub mod assemblies;
pub mod ball;
pub mod certificate;
pub mod enclosure;
pub mod freedoms;
pub mod loops;
pub mod measures;
pub mod motion;
pub mod rates;
pub mod results;
pub mod solve;
pub mod structure;
