//! Signed distances of solids: exact, not faceted. Nothing here knows a motion.

pub mod bodies;
pub(crate) mod boxes;
pub mod core;
mod core_pair;
pub(crate) mod cores;
mod depth;
mod flaps;
mod half_space;
pub mod mesh;
pub mod mesh_tree;
pub mod pair;
pub(crate) mod point;
pub(crate) mod search;
mod shells;
pub mod solids;
pub(crate) mod triangles;
