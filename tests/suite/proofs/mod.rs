//! What the engine says is proved.

mod absence;
mod certificate_bounds;
mod certificates;
mod printed_rows;
mod tubes;
