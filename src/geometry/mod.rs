//! Triangle meshes of the model's solids. Holds no poses of links and no renderer.

mod crease;
mod primitive;
pub mod stl;
mod torus;
pub mod trace;
mod tube;

pub use crease::mesh_of_triangles;
pub use stl::{MAX_STL_TRIANGLES, StlError, read_stl};
pub use trace::{TraceMesh, trace_mesh};

use crate::model::shape::Solid;
use glam::{DMat3, DVec3};

/// Fewest segments around a circle: an octagon still reads as round in a picture of a few pixels.
pub const MIN_SEGMENTS: u32 = 8;
/// Most segments around a circle; at 256 the chord error is below 8e-5 of the radius.
pub const MAX_SEGMENTS: u32 = 256;
/// Bits kept of a unit vector's components that came from the platform's sine and cosine, whose last bits
/// differ between platforms. 2^-26 is far below any tessellation error and far above those bits.
const SETTLE: f64 = (1u64 << 26) as f64;

/// A closed or open triangle mesh with one normal per vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices in the mesh's frame, in the scene's length unit.
    pub positions: Vec<DVec3>,
    /// Outward unit normals, one per vertex.
    pub normals: Vec<DVec3>,
    /// Corner indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Adds a vertex and returns its index.
    pub fn push_vertex(&mut self, position: DVec3, normal: DVec3) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        (self.positions.len() - 1) as u32
    }

    /// Least and greatest corner of the axis-parallel box around all vertices; `None` without vertices.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let first = *self.positions.first()?;
        Some(
            self.positions
                .iter()
                .fold([first, first], |[low, high], p| [low.min(*p), high.max(*p)]),
        )
    }

    /// Whether every edge is shared by two triangles that run along it in opposite directions.
    ///
    /// Corners at exactly the same position count as one, triangles with two such corners are ignored.
    pub fn is_closed(&self) -> bool {
        closed_edges(self).is_some()
    }

    /// Whether the outside hides the inside completely: closed, and not inside out as a file may have it. A
    /// renderer may leave out the back faces of such a mesh.
    pub fn hides_its_inside(&self) -> bool {
        let corner = |index: u32| {
            let position = self.positions.get(index as usize);
            position.copied().unwrap_or_default()
        };
        let six_volumes: f64 = self
            .triangles
            .iter()
            .map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))))
            .sum();
        six_volumes > 0.0 && self.is_closed()
    }
}

/// Number of distinct vertices, edges and triangles of a closed mesh; `None` for an open one.
fn closed_edges(mesh: &Mesh) -> Option<[usize; 3]> {
    use std::collections::{HashMap, HashSet};
    // Adding zero makes -0 into 0, so that equal positions have equal bits.
    let mut index_of = HashMap::new();
    let welded: Vec<usize> = mesh
        .positions
        .iter()
        .map(|p| {
            let next = index_of.len();
            *index_of
                .entry((*p + 0.0).to_array().map(f64::to_bits))
                .or_insert(next)
        })
        .collect();
    let mut balance: HashMap<[usize; 2], [u32; 2]> = HashMap::new();
    let mut used = HashSet::new();
    let mut triangles = 0;
    for triangle in &mesh.triangles {
        let corners = triangle.map(|i| welded.get(i as usize).copied());
        let [Some(a), Some(b), Some(c)] = corners else {
            return None;
        };
        if a == b || b == c || c == a {
            continue;
        }
        triangles += 1;
        used.extend([a, b, c]);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            balance.entry([from.min(to), from.max(to)]).or_default()[usize::from(from > to)] += 1;
        }
    }
    let closed = triangles > 0 && balance.values().all(|[along, against]| along == against);
    closed.then_some([used.len(), balance.len(), triangles])
}

/// The mesh of a solid in the solid's own frame.
///
/// `tolerance` is the largest distance between a round surface and its facets, in the scene's unit; the
/// facet count stays within [`MIN_SEGMENTS`] and [`MAX_SEGMENTS`] a turn. A solid without extent or with
/// numbers that are not finite gives an empty mesh.
pub fn mesh_of(solid: &Solid, tolerance: f64) -> Mesh {
    let mesh = match solid {
        Solid::Sphere { center, radius } => primitive::ball(*center, *radius, tolerance),
        Solid::Capsule { from, to, radius } => primitive::capsule(*from, *to, *radius, tolerance),
        Solid::Cylinder { from, to, radius } => {
            primitive::frustum([*from, *to], [*radius, *radius], tolerance)
        }
        Solid::Cone {
            from,
            to,
            radius_from,
            radius_to,
        } => primitive::frustum([*from, *to], [*radius_from, *radius_to], tolerance),
        Solid::Box { center, size } => primitive::cuboid(*center, *size),
        Solid::Torus {
            center,
            axis,
            ring,
            tube,
        } => torus::torus(*center, *axis, *ring, *tube, tolerance),
        Solid::Tube {
            points,
            radius,
            closed,
        } => tube::tube(points, *radius, *closed, tolerance),
        Solid::HalfSpace {
            point,
            normal,
            size,
        } => primitive::sheet(*point, *normal, *size),
        Solid::Triangles(soup) => mesh_of_triangles(&soup.vertices, &soup.triangles),
    };
    let finite = mesh
        .positions
        .iter()
        .chain(&mesh.normals)
        .all(|v| v.is_finite());
    if finite { mesh } else { Mesh::default() }
}

/// Segments around a circle of `radius` so that its chords stay within `tolerance`; a multiple of 4, so
/// that the extreme points along the axes are vertices.
fn segments(radius: f64, tolerance: f64) -> u32 {
    let share = tolerance / radius;
    if !positive(share) {
        return MAX_SEGMENTS;
    }
    let half_angle = libm::acos((1.0 - share).max(0.0));
    let count = (std::f64::consts::PI / half_angle).min(f64::from(MAX_SEGMENTS));
    (count.ceil() as u32)
        .next_multiple_of(4)
        .clamp(MIN_SEGMENTS, MAX_SEGMENTS)
}

/// Whether a length is one: above zero and not "not a number".
fn positive(length: f64) -> bool {
    length > 0.0
}

/// A unit vector with the bits removed in which platforms differ.
fn settle(direction: DVec3) -> DVec3 {
    ((direction * SETTLE).round() / SETTLE).normalize_or_zero()
}

/// Rotation whose third column is `axis`; the columns map parry's (z, x, y), whose round shapes stand on y.
fn upright(axis: DVec3) -> DMat3 {
    crate::math::Pose::from_z_axis(axis).rotation
}

#[cfg(test)]
mod tests;
