//! What the engine says is proved.

mod absence;
mod certificate_bounds;
mod certificates;
mod dyads;
mod enclosure;
mod enclosure_jumps;
mod interval_systems;
mod jumps;
mod pieces;
mod printed_rows;
mod tubes;
