//! The space that the triangles of a shell go around.

use glam::DVec3;

/// A shell encloses nothing if the volumes over its triangles cancel to this share of their sum: rounding leaves some 1e-16 for
/// every triangle, and of the thinnest plate half of them remain.
const CANCELLED: f64 = 1e-9;

/// Six times the volume, negative for a shell that is inside out.
pub(crate) fn six_volumes<'t>(triangles: impl Iterator<Item = &'t [DVec3; 3]> + Clone) -> f64 {
    each_volume(triangles).sum()
}

/// Whether closed triangles enclose anything: those of a sheet with two sides, or of a shell that stands there once outwards
/// and once inwards, do not.
pub(crate) fn encloses_space<'t>(triangles: impl Iterator<Item = &'t [DVec3; 3]> + Clone) -> bool {
    let (sum, size) = each_volume(triangles).fold((0.0, 0.0), |(sum, size): (f64, f64), volume| {
        (sum + volume, size + volume.abs())
    });
    sum.abs() > CANCELLED * size
}

/// Six times the volume between every triangle and the first corner.
fn each_volume<'t>(
    triangles: impl Iterator<Item = &'t [DVec3; 3]> + Clone,
) -> impl Iterator<Item = f64> {
    let origin = triangles.clone().next().map_or(DVec3::ZERO, |t| t[0]);
    triangles.map(move |t| {
        let [a, b, c] = t.map(|p| p - origin);
        a.dot(b.cross(c))
    })
}
