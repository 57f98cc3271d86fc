//! Translates bars into equations: the squared distance of two points minus the squared length.
//!
//! If a chain only translates an end, its coordinates are sums of displacements. If rotations carry it, its coordinates
//! become unknowns, called `BAR.from.x` and so on, which are determined by a loop that closes in a point (a pin). The
//! equation of a bar is therefore quadratic in its coordinates, whatever carries its ends.

pub mod ends;
pub mod equations;
pub mod parsed;
mod pins;
