//! The space that a motion occupies: points that the camera must include.

use super::{explode, link_symbols};
use crate::geometry::coarse_mesh_of;
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::shape::{Solid, TriangleSoup};
use crate::scene::Scene;
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;

/// Number of samples examined: more do not widen the bounds visibly.
const MAX_SAMPLES: usize = 64;

/// Facet error of the bounding meshes relative to a solid's radius: a coarse hull suffices, since the margin covers it.
const COARSE: f64 = 0.02;

/// Number of points of a mesh above which only the outermost ones are kept: all of them at every sample would fill the
/// memory.
const MANY: usize = 50_000;

/// Number of points of all bodies and samples above which again only the outermost are kept.
const MOST: usize = 2_000_000;

/// Number of columns across a box along each of its axes; a bulge smaller than one of them does not widen a picture.
const COLUMNS: usize = 64;

/// The first and last point of every column along each axis.
fn outermost_points(points: &[DVec3]) -> Vec<DVec3> {
    let [low, high] = box_of(points).unwrap_or_default();
    let cell = (high - low).max(DVec3::splat(f64::MIN_POSITIVE)) / COLUMNS as f64;
    let mut found = vec![None::<[usize; 2]>; 3 * COLUMNS * COLUMNS];
    for (index, point) in points.iter().enumerate() {
        let at = ((*point - low) / cell)
            .to_array()
            .map(|v| (v as usize).min(COLUMNS - 1));
        for axis in 0..3 {
            let column = (axis * COLUMNS + at[(axis + 1) % 3]) * COLUMNS + at[(axis + 2) % 3];
            let [first, last] = found[column].get_or_insert([index; 2]);
            if point[axis] < points[*first][axis] {
                *first = index;
            }
            if point[axis] > points[*last][axis] {
                *last = index;
            }
        }
    }
    let mut list: Vec<usize> = found.into_iter().flatten().flatten().collect();
    list.sort_unstable();
    list.dedup();
    list.into_iter().map(|index| points[index]).collect()
}

/// Points of coarse meshes of all bodies over the motion, and all traced points.
pub fn moving_points(scene: &Scene, trajectory: &Trajectory) -> Vec<DVec3> {
    let mechanism = &scene.mechanism;
    let shown = |body| scene.view.shown_shapes(mechanism, body);
    // The outermost points of a file that many shapes use are computed once.
    let mut of_files: HashMap<*const TriangleSoup, Vec<DVec3>> = HashMap::new();
    let hulls: Vec<(usize, Vec<DVec3>)> = (0..mechanism.bodies.len())
        .flat_map(|body| shown(body).map(move |shape| (body, shape)))
        .map(|(body, shape)| {
            let place = |p: &DVec3| shape.body_from_shape.transform_point(*p);
            let hull = match &shape.solid {
                Solid::Triangles(soup) if soup.vertices.len() > MANY => {
                    let of_file = of_files.entry(Arc::as_ptr(soup));
                    let points = of_file.or_insert_with(|| outermost_points(&soup.vertices));
                    points.iter().map(place).collect()
                }
                solid => {
                    let mesh = coarse_mesh_of(solid, COARSE);
                    mesh.positions.iter().map(place).collect()
                }
            };
            (body, hull)
        })
        .collect();
    let offsets = explode::body_offsets(scene, trajectory);
    let poses: Vec<_> = trajectory.poses().collect();
    let stride = poses.len().div_ceil(MAX_SAMPLES).max(1);
    let mut points = Vec::new();
    for pose in poses.iter().step_by(stride) {
        for (body, hull) in &hulls {
            let placed = hull.iter();
            let placed = placed.map(|p| pose.bodies[*body].transform_point(*p) + offsets[*body]);
            points.extend(placed.filter(|p| p.is_finite()));
            if points.len() > MOST {
                points = outermost_points(&points);
            }
        }
    }
    points.extend(poses.iter().flat_map(|pose| pose.traces.iter().copied()));
    points.retain(|p| p.is_finite());
    if mechanism.has_no_shapes() || !mechanism.bars.is_empty() {
        points.extend(link_symbols::moving_points(mechanism, trajectory));
    }
    points
}

/// The points that are outermost in one of `directions` evenly distributed directions (Fibonacci lattice on the
/// sphere): enough to frame all of them.
pub fn point_outline(points: &[DVec3], directions: usize) -> Vec<DVec3> {
    if points.len() <= directions {
        return points.to_vec();
    }
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let outermost = (0..directions).filter_map(|k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / directions as f64;
        let out = (1.0 - z * z).sqrt();
        let (sin, cos) = crate::math::sin_cos(golden * k as f64);
        let direction = DVec3::new(out * cos, out * sin, z);
        let far = |p: &&DVec3, q: &&DVec3| p.dot(direction).total_cmp(&q.dot(direction));
        points.iter().max_by(far).copied()
    });
    outermost.collect()
}

/// Smallest axis-parallel box around the points.
pub fn box_of(points: &[DVec3]) -> Option<[DVec3; 2]> {
    let first = *points.first()?;
    Some(
        points
            .iter()
            .fold([first, first], |[low, high], p| [low.min(*p), high.max(*p)]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fine ball keeps its extent in every direction, with few of its points.
    #[test]
    fn outermost_points_hold_the_extent() {
        let turn = |k: usize, n: usize| std::f64::consts::TAU * k as f64 / n as f64;
        let points = (0..400).flat_map(|i| {
            (0..400).map(move |k| {
                let (a, b) = (turn(i, 400), 0.5 * turn(k, 400));
                DVec3::new(b.sin() * a.cos(), b.sin() * a.sin(), b.cos())
            })
        });
        let points: Vec<DVec3> = points.collect();
        let few = outermost_points(&points);
        assert!(few.len() < 6 * COLUMNS * COLUMNS, "{}", few.len());
        for direction in &points[..1000] {
            let reach = few.iter().map(|p| p.dot(*direction)).fold(0.0, f64::max);
            assert!(reach > 0.99, "{direction} {reach}");
        }
        assert_eq!(box_of(&few), box_of(&points));
    }
}
