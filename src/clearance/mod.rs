//! Clearance: signed distances of solids, their least values over the motion with a bound, and what may touch.
//!
//! Everything here is values in, values out; nothing prints.

mod asked;
pub mod bodies;
mod boxes;
mod branch_and_bound;
mod broad_phase;
pub mod check;
mod contact;
pub mod core;
mod core_pair;
mod cores;
mod curved;
mod depth;
mod flaps;
mod found;
mod gap;
mod half_space;
pub mod meeting;
pub mod mesh;
mod mesh_faults;
mod mesh_meeting;
pub mod mesh_tree;
pub mod motion;
pub mod neighbours;
pub mod pair;
mod point;
mod relative;
mod search;
mod shells;
mod slab;
pub mod sweep;
mod track;
mod triangles;
mod violations;
