//! Analyses of the solver and of mechanisms. They call the solver repeatedly and do not contain a second one.

pub mod cloud;
pub mod dyads;
pub mod enclosure;
pub mod extremes;
pub mod observer;
pub mod optimise;
pub mod piece_sums;
pub mod point_routes;
pub mod random;
pub mod reference;
pub mod routes;
pub mod study;
pub mod synthesis;
pub mod tolerance;
pub mod tolerance_study;
pub mod work_precision;
