//! Bars to equations: the square of the distance of two points, less that of the length.
//!
//! An end that chains only shift has coordinates that are sums of what shifts it. Where rotations carry it around, its
//! coordinates become unknowns of their own, called `BAR.from.x` and so on, and a loop that closes in a point (a pin) says where
//! they are. So the equation of a bar is of second degree in its coordinates, whatever carries its ends.

mod ends;
pub mod equations;
pub mod parsed;
mod pins;
