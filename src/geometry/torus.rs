//! Torus meshes: ring, horn and spindle.

use super::mesh::Mesh;
use super::round::{segment_count, upright_frame};
use crate::math::sin_cos;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Outer surface of all points within `tube` of the circle of radius `ring` around `axis`.
///
/// A spindle torus (`tube` ≥ `ring`) is closed by its two dimples on the axis; the inner lemon is left out.
pub(super) fn torus_mesh(centre: DVec3, axis: DVec3, ring: f64, tube: f64, tolerance: f64) -> Mesh {
    if !(tube > 0.0 && ring >= 0.0) {
        return Mesh::default();
    }
    let around = segment_count(ring + tube, 0.5 * tolerance);
    let across = segment_count(tube, 0.5 * tolerance);
    let frame = upright_frame(axis);
    let spindle = tube >= ring;
    // Angle of the tube's section at which the surface meets the axis.
    let reach = if spindle {
        libm::acos(-ring / tube)
    } else {
        PI
    };
    let rows = if spindle {
        ((f64::from(across) * reach / PI).ceil() as u32).max(4)
    } else {
        across
    };
    let mut mesh = Mesh::default();
    let columns: Vec<DVec3> = (0..around)
        .map(|column| {
            let (sin, cos) = sin_cos(TAU * f64::from(column) / f64::from(around));
            frame.x_axis * cos + frame.y_axis * sin
        })
        .collect();
    let lines = if spindle { rows + 1 } else { rows };
    for row in 0..lines {
        let angle = reach * (2.0 * f64::from(row) / f64::from(rows) - 1.0);
        let (sin, cos) = sin_cos(angle);
        let on_axis = spindle && (row == 0 || row == rows);
        for outward in &columns {
            let normal = *outward * cos + frame.z_axis * sin;
            let distance = if on_axis { 0.0 } else { ring + tube * cos };
            let position = centre + *outward * distance + frame.z_axis * (tube * sin);
            mesh.push_vertex(position, normal);
        }
    }
    for row in 0..rows {
        let next_row = (row + 1) % lines;
        for column in 0..around {
            let next = (column + 1) % around;
            let [a, b] = [row * around + column, row * around + next];
            let [d, c] = [next_row * around + column, next_row * around + next];
            // On the axis one side of the cell has no length.
            if !(spindle && row == 0) {
                mesh.triangles.push([a, b, c]);
            }
            if !(spindle && row + 1 == rows) {
                mesh.triangles.push([a, c, d]);
            }
        }
    }
    mesh
}
