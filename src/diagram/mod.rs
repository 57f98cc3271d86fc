//! Kinematic diagrams: from the chains of a scene at a pose to lines, signs and letters on a sheet.
//!
//! [`walk`] follows every chain as written and notes what it passes: a [`scheme::Scheme`] in space. [`sheet`] looks at it
//! and lays it out; [`labels`] finds places for the letters. What comes out is a drawing like that of a chart, for the same
//! writers.

mod arcs;
mod bins;
mod contacts;
mod ground;
mod ink;
pub mod labels;
mod lengths;
mod lettering;
mod links;
mod loops;
pub mod plane;
mod quantities;
pub mod scheme;
pub mod sheet;
mod surfaces;
mod symbols;
pub mod walk;
