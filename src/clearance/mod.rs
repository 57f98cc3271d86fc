//! Clearance: signed distances of solids, their least values over the motion with a bound, and what may touch.
//!
//! Everything here is values in, values out; nothing prints.

pub mod core;
mod cores;
mod depth;
pub mod mesh;
pub mod pair;
mod point;
mod search;
