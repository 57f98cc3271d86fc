//! Boxes around the poses of all pieces: the dimensions lie anywhere in their intervals, and the unknowns, traced points and
//! outputs of every such piece lie in the box.
//!
//! Everything is a function of the dimensions: its value, its derivatives as affine forms, which preserve mixed second
//! derivatives, and a bound on the remainder of third order. [`block`] contains the test, [`quadratic`] the ranges.

pub mod block;
mod block_box;
mod centre;
mod corner;
mod form;
mod mapped;
pub mod observer;
pub mod pose;
pub mod quadratic;
pub mod region;
pub mod rows;
mod twists;
