//! Invariants of every mesh: closed, of the right genus, facing outward, within the tolerance.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod solids;
mod triangles;
mod tubes;

use super::mesh::closed_edges;
use super::round::segment_count;
use super::*;
use crate::model::shape::TriangleSoup;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

fn volume(mesh: &Mesh) -> f64 {
    mesh.triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

fn euler(mesh: &Mesh) -> i64 {
    let [v, e, f] = closed_edges(mesh).expect("a closed mesh");
    v as i64 - e as i64 + f as i64
}

/// Every normal is a unit vector on the outer side of the facets that use it.
fn check_normals(mesh: &Mesh) {
    assert_eq!(mesh.positions.len(), mesh.normals.len());
    for normal in &mesh.normals {
        assert!((normal.length() - 1.0).abs() < 1e-12);
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let facet = (b - a).cross(c - a);
        if facet.length() > 0.0 {
            for i in t {
                let cosine = facet.normalize().dot(mesh.normals[*i as usize]);
                assert!(cosine > 0.5, "{cosine} in {t:?}");
            }
        }
    }
}

fn segment_distance(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + (b - a) * t)
}

fn check_normals_of_sides(mesh: &Mesh) {
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        assert!(normal.dot(*position - DVec3::X * position.x) >= 0.0);
    }
    assert!(volume(mesh) > 0.0);
}
