//! mechanim: exact motion, collision reports and pictures of spatial mechanisms, from their equations.
//!
//! Data flows one way: scene file → [`model`] → trajectory ([`kinematics`]) → frames ([`render`]) → files
//! ([`export`]). Nothing but [`cli`], the room of the program, prints.

pub mod analysis;
pub mod charts;
pub mod clearance;
pub mod cli;
pub mod compare;
pub mod diag;
pub mod export;
pub mod geometry;
pub mod import;
pub mod jobs;
pub mod kinematics;
pub mod linalg;
pub mod math;
pub mod model;
pub mod numbers;
pub mod pictures;
pub mod plot;
pub mod render;
pub mod report;
pub mod scene;
pub mod snapshot;
pub mod staging;
