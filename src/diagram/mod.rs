//! Kinematic diagrams: from the chains of a scene at a pose to lines, symbols and text on a sheet.
//!
//! [`walk`] follows every chain as written and records its parts in space: a [`scheme::Scheme`]. [`sheet`] projects it
//! and lays it out; [`labels`] finds places for the text. The result is a drawing like that of a chart, for the same
//! writers.

mod arcs;
mod bars;
mod bins;
mod contacts;
mod ground;
mod guides;
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
mod shown_links;
mod surfaces;
mod symbols;
pub mod walk;
