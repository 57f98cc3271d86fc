//! Ball joints written as three rotations, and their description near gimbal lock.

pub mod chart;
pub mod joint;
mod run;
