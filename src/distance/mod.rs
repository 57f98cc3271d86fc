//! Signed distances of solids: exact, not faceted. Independent of motions.

pub mod bodies;
pub(crate) mod boxes;
pub(crate) mod curve_bend;
mod depth;
mod distance_along;
mod flaps;
mod half_space;
pub mod mesh;
pub mod mesh_tree;
pub mod pair;
pub(crate) mod point;
pub mod primitive;
pub(crate) mod primitive_distance;
mod primitive_pair;
mod rims;
mod scaled;
pub(crate) mod search;
mod shell_boxes;
mod shell_surface;
mod shells;
pub mod solids;
mod surface_edges;
pub(crate) mod triangle_tree;
pub(crate) mod triangles;
mod two_sided;
mod winding;
