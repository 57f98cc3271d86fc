//! Loops around the solver: studies of a mechanism whose parameters vary, and the minimisers they use.

pub mod optimise;
pub mod random;
pub mod study;
pub mod tolerance;
