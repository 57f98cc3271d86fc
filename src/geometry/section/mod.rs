//! Meshes cut by a plane: what is left of the surface (`cut`), and the region of the plane inside the solid (`region`).

mod cut;
mod plane;
mod region;

pub use cut::{CutMesh, CutPart, cut_mesh};
pub use plane::{CutPlane, PlaneFrame};
pub use region::{Strips, Trapezoid, divide_region};

#[cfg(test)]
mod tests;
