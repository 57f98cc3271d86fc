//! Loops around the solver: studies of a mechanism whose parameters vary.

pub mod study;
