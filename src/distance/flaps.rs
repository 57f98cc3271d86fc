//! Flaps: flat pieces of a mesh that are attached to a closed shell or lie inside or beside it, and enclose nothing.
//!
//! A stray triangle on a closed shell creates an edge with three sides, but does not change what the shell encloses. A
//! mesh with a hole has such edges too, so that only flat, isolated pieces count: several adjacent ones may be the
//! remains of a shell.

use super::surface_edges::{SurfaceEdges, triangle_edges};
use glam::DVec3;

/// Flaps are isolated if their balls, enlarged by this factor, do not meet.
const ALONE: f64 = 2.0;

/// Maximum number of flat pieces that are regarded as stray.
const MOST: usize = 32;

/// The triangles that are flaps; `at` gives a corner's place, and corners within `flat` of a plane are coplanar.
pub(crate) fn find_flaps(
    triangles: &[[u32; 3]],
    edges: &SurfaceEdges,
    at: impl Fn(u32) -> DVec3,
    flat: f64,
) -> Vec<bool> {
    let mut is_flap = vec![false; triangles.len()];
    let mut balls: Vec<(DVec3, f64)> = Vec::new();
    let mut found = Vec::new();
    // Sheets are connected across edges with exactly two sides, so that a flap ends where it is attached.
    each_sheet(triangles, edges, |sheet| {
        let mut sides = sheet.iter().flat_map(|k| triangle_edges(triangles[*k]));
        // An edge of one side is free, one of three belongs to a closed shell and a flap: both are odd.
        let is_loose = sides.any(|edge| edges.at(edge).len() % 2 == 1);
        let corners = || sheet.iter().flat_map(|k| triangles[*k].map(&at));
        // Flat loose sheets are candidates, with a ball around each. One too many is kept, so that it is noticed.
        if found.len() <= MOST && is_loose && is_flat(sheet, triangles, &at, flat) {
            let count = (3 * sheet.len()) as f64;
            let centre = corners().sum::<DVec3>() / count;
            let radius = corners().map(|p| p.distance(centre)).fold(0.0, f64::max);
            balls.push((centre, radius));
            found.push(sheet.to_vec());
        }
    });
    // Candidates near each other may be what remains of a shell: then none is a flap.
    let is_alone = |k: usize| {
        let (p, r) = balls[k];
        let mut others = balls.iter().enumerate().filter(|(j, _)| *j != k);
        others.all(|(_, (q, s))| p.distance(*q) > ALONE * (r + s))
    };
    if found.len() <= MOST && (0..found.len()).all(is_alone) {
        found.iter().flatten().for_each(|k| is_flap[*k] = true);
    }
    is_flap
}

/// Reports every set of triangles that are connected by edges with two sides.
pub(super) fn each_sheet(
    triangles: &[[u32; 3]],
    edges: &SurfaceEdges,
    mut tell: impl FnMut(&[usize]),
) {
    let mut is_done = vec![false; triangles.len()];
    let mut sheet = Vec::new();
    for seed in 0..triangles.len() {
        if std::mem::replace(&mut is_done[seed], true) {
            continue;
        }
        sheet.clear();
        sheet.push(seed);
        let mut next = 0;
        while let Some(k) = sheet.get(next).copied() {
            next += 1;
            for edge in triangle_edges(triangles[k]) {
                for other in edges.pair(edge).into_iter().flatten() {
                    if !std::mem::replace(&mut is_done[other], true) {
                        sheet.push(other);
                    }
                }
            }
        }
        tell(&sheet);
    }
}

fn is_flat(sheet: &[usize], triangles: &[[u32; 3]], at: &impl Fn(u32) -> DVec3, flat: f64) -> bool {
    let corners = |k: &usize| triangles[*k].map(at);
    let areas = sheet.iter().map(|k| {
        let [a, b, c] = corners(k);
        (b - a).cross(c - a)
    });
    // Neighbours may have either orientation.
    let normal = areas.fold(DVec3::ZERO, |sum, area| {
        if sum.dot(area) < 0.0 {
            sum - area
        } else {
            sum + area
        }
    });
    let normal = normal.normalize_or_zero();
    let Some(first) = sheet.first().map(|k| corners(k)[0]) else {
        return false;
    };
    let mut all = sheet.iter().flat_map(corners);
    all.all(|p| normal.dot(p - first).abs() <= flat)
}
