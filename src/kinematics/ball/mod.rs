//! Ball joints written as three rotations, and their description next to gimbal-locked poses.

pub mod chart;
pub mod joint;
mod run;
