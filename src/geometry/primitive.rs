//! Meshes of links, pins and balls: parry's tessellations, with analytic normals.
//!
//! parry determines the triangles and the positions of their corners on the unit shape; here they are moved onto the
//! true surface, so that the result does not depend on the platform's sine.

use super::crease;
use super::mesh::Mesh;
use super::round::{is_positive, segment_count, settle_direction, upright_frame};
use crate::math::Pose;
use glam::{DMat3, DVec3};
use parry3d_f64::shape::{Ball, Capsule, Cone, Cuboid, Cylinder};

/// Below this fraction of the radius a link has no length, and a capsule is a ball.
const NO_LENGTH: f64 = 1e-9;

/// parry's corner in a frame whose third column is the shape's axis.
fn placed_corner(frame: &DMat3, corner: DVec3) -> DVec3 {
    frame.x_axis * corner.z + frame.y_axis * corner.x + frame.z_axis * corner.y
}

/// Segments around and from pole to pole of a ball; the errors of the two directions add up.
fn ball_segments(radius: f64, tolerance: f64) -> [u32; 2] {
    let around = segment_count(radius, 0.5 * tolerance);
    [around, around / 2]
}

pub(super) fn ball_mesh(centre: DVec3, radius: f64, tolerance: f64) -> Mesh {
    if !is_positive(radius) {
        return Mesh::default();
    }
    let [around, down] = ball_segments(radius, tolerance);
    // The unit ball of parry, whose corners are its normals.
    let (corners, triangles) = Ball::new(1.0).to_trimesh(around, down);
    let frame = upright_frame(DVec3::Z);
    let normals: Vec<DVec3> = corners
        .into_iter()
        .map(|corner| placed_corner(&frame, settle_direction(corner)))
        .collect();
    Mesh {
        positions: normals.iter().map(|n| centre + *n * radius).collect(),
        normals,
        triangles,
    }
}

pub(super) fn capsule_mesh(from: DVec3, to: DVec3, radius: f64, tolerance: f64) -> Mesh {
    if !is_positive(from.distance(to) - NO_LENGTH * radius) {
        return ball_mesh(from, radius, tolerance);
    }
    let [around, down] = ball_segments(radius, tolerance);
    let (corners, triangles) = Capsule::new_y(1.0, 1.0).to_trimesh(around, down);
    let frame = upright_frame(to - from);
    let mut mesh = Mesh {
        triangles,
        ..Mesh::default()
    };
    // The upper hemisphere belongs to the end, the lower one to the start.
    for corner in corners {
        let top = corner.y > 0.0;
        let (end, middle) = if top {
            (to, DVec3::Y)
        } else {
            (from, DVec3::NEG_Y)
        };
        let normal = placed_corner(&frame, settle_direction(corner - middle));
        mesh.push_vertex(end + normal * radius, normal);
    }
    mesh
}

/// Thickness of the sheet that represents a half-space, relative to its edge.
const SHEET: f64 = 0.01;

/// The square sheet that represents a half-space: its upper side lies in the plane.
pub(super) fn sheet_mesh(point: DVec3, normal: DVec3, size: f64) -> Mesh {
    let thickness = SHEET * size;
    let mut mesh = cuboid_mesh(
        DVec3::new(0.0, 0.0, -0.5 * thickness),
        DVec3::new(size, size, thickness),
    );
    let turn = Pose::from_z_axis(normal);
    for position in &mut mesh.positions {
        *position = turn.transform_vector(*position) + point;
    }
    for normal in &mut mesh.normals {
        *normal = settle_direction(turn.transform_vector(*normal));
    }
    mesh
}

/// Cylinder, frustum or cone between two centres, its flat ends with edges of their own.
pub(super) fn frustum_mesh(ends: [DVec3; 2], radii: [f64; 2], tolerance: f64) -> Mesh {
    let widest = radii[0].max(radii[1]);
    let axis = ends[1] - ends[0];
    if !(widest > 0.0 && radii[0].min(radii[1]) >= 0.0 && axis.length() > NO_LENGTH * widest) {
        return Mesh::default();
    }
    if radii[0] == 0.0 {
        return frustum_mesh([ends[1], ends[0]], [radii[1], radii[0]], tolerance);
    }
    let around = segment_count(widest, tolerance);
    let pointed = radii[1] == 0.0;
    let (corners, triangles) = if pointed {
        Cone::new(1.0, 1.0).to_trimesh(around)
    } else {
        Cylinder::new(1.0, 1.0).to_trimesh(around)
    };
    let frame = upright_frame(axis);
    let tilt = radii[0] - radii[1];
    let outward: Vec<DVec3> = corners
        .iter()
        .map(|c| placed_corner(&frame, settle_direction(DVec3::new(c.x, 0.0, c.z))))
        .collect();
    let position = |corner: usize| {
        let end = usize::from(corners[corner].y > 0.0);
        ends[end] + outward[corner] * radii[end]
    };
    let mut mesh = Mesh::default();
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| i as usize);
        let level = corners[a].y + corners[b].y + corners[c].y;
        let flat = level.abs() > 2.5;
        // The tip of a cone has no normal; the direction in the middle of the side is used.
        let middle = outward[a] + outward[b] + outward[c];
        let corners_out = [a, b, c].map(|corner| {
            let out = if outward[corner] == DVec3::ZERO {
                middle
            } else {
                outward[corner]
            };
            let normal = if flat {
                frame.z_axis * level.signum()
            } else {
                (out.normalize_or_zero() * axis.length() + frame.z_axis * tilt).normalize_or_zero()
            };
            mesh.push_vertex(position(corner), normal)
        });
        mesh.triangles.push(corners_out);
    }
    crease::share_vertices(mesh)
}

pub(super) fn cuboid_mesh(centre: DVec3, size: DVec3) -> Mesh {
    if !is_positive(size.min_element()) {
        return Mesh::default();
    }
    let (corners, triangles) = Cuboid::new(size * 0.5).to_trimesh();
    let corners: Vec<DVec3> = corners.into_iter().map(|c| c + centre).collect();
    crease::mesh_of_triangles(&corners, &triangles)
}
