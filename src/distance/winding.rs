//! Winding numbers of triangles about a point: by the crossings of a ray, or by the sum of their solid angles.

use glam::DVec3;
use std::f64::consts::PI;

/// Directions of rays, tried in turn until one keeps clear of all edges. None lies along the axes, along which the edges
/// of many files do.
const RAYS: [DVec3; 6] = [
    DVec3::new(0.48, 0.615, 0.626),
    DVec3::new(-0.711, 0.217, 0.669),
    DVec3::new(0.133, -0.828, 0.545),
    DVec3::new(0.377, 0.529, -0.761),
    DVec3::new(-0.591, -0.463, -0.66),
    DVec3::new(0.893, -0.277, -0.355),
];

/// Angle within which a ray may pass an edge on either side, and fraction of the distance within which its start may
/// lie on a triangle: far above rounding, and small enough that a second ray is unlikely to be ambiguous again.
const CLEAR: f64 = 1e-9;

/// Rounding of sums and products of coordinates, relative to their size.
const ROUNDING: f64 = 1e-13;

/// A ray, and two directions perpendicular to it.
pub(crate) struct Ray {
    start: DVec3,
    pub(crate) along: DVec3,
    across: [DVec3; 2],
}

impl Ray {
    /// Several rays from one point, to be tried in turn.
    pub(crate) fn from_point(start: DVec3) -> impl Iterator<Item = Self> {
        RAYS.into_iter().map(move |along| {
            let along = along.normalize();
            let x = along.any_orthonormal_vector();
            Self {
                start,
                along,
                across: [x, along.cross(x)],
            }
        })
    }

    /// Whether it may meet anything in a ball of the given extent along directions.
    pub(crate) fn may_meet(
        &self,
        centre: DVec3,
        radius: f64,
        reach: impl Fn(DVec3) -> f64,
    ) -> bool {
        let span = centre - self.start;
        let slack = CLEAR * (span.length() + radius);
        let depth = self.along.dot(span);
        let off = span - self.along * depth;
        let distance = off.length();
        if distance > radius + slack || depth + reach(self.along) < -slack {
            return false;
        }
        distance <= slack || distance <= reach(off / distance) + slack
    }

    /// 1 where it leaves through a triangle, outside first seen counter-clockwise, -1 where it enters, 0 where it misses;
    /// `None` where that is not clear.
    pub(crate) fn crossing(&self, triangle: &[DVec3; 3]) -> Option<i32> {
        let local = triangle.map(|p| {
            let span = p - self.start;
            let [x, y] = self.across.map(|n| n.dot(span));
            DVec3::new(x, y, self.along.dot(span))
        });
        let low = local[0].min(local[1]).min(local[2]);
        let high = local[0].max(local[1]).max(local[2]);
        let slack = CLEAR * high.abs().max(low.abs()).max_element();
        let is_beside = low.truncate().max_element() > slack
            || high.truncate().min_element() < -slack
            || high.z < -slack;
        if is_beside {
            return Some(0);
        }
        let mut sides = [0.0; 3];
        let (mut left, mut right) = (0, 0);
        for (k, side) in sides.iter_mut().enumerate() {
            let [a, b] = [k, (k + 1) % 3].map(|j| local[j].truncate());
            *side = a.perp_dot(b);
            let unclear = CLEAR * a.length() * b.length() + ROUNDING * slack / CLEAR * slack;
            left += u32::from(*side > unclear);
            right += u32::from(*side < -unclear);
        }
        if left > 0 && right > 0 {
            return Some(0);
        }
        if left.max(right) < 3 {
            return None;
        }
        // Where it crosses the triangle's plane.
        let sum: f64 = sides.iter().sum();
        let depth = (sides[1] * local[0].z + sides[2] * local[1].z + sides[0] * local[2].z) / sum;
        match depth {
            d if d > slack => Some(if left == 3 { 1 } else { -1 }),
            d if d < -slack => Some(0),
            _ => None,
        }
    }
}

/// Winding number of triangles about a point: their solid angles, in units of the whole sphere.
pub(crate) fn turns_around<'t>(
    triangles: impl IntoIterator<Item = &'t [DVec3; 3]>,
    point: DVec3,
) -> f64 {
    let angle = |t: &[DVec3; 3]| {
        let [a, b, c] = t.map(|p| (p - point).normalize_or_zero());
        let volume = a.dot(b.cross(c));
        2.0 * libm::atan2(volume, 1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    };
    triangles.into_iter().map(angle).sum::<f64>() / (4.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box, oriented outwards or inwards, rotated so that no edge is parallel to an axis.
    fn cuboid(middle: DVec3, half: f64, is_out: bool) -> Vec<[DVec3; 3]> {
        let turn = glam::DQuat::from_scaled_axis(DVec3::new(0.2, 1.0, -0.4));
        let corner = |k: usize| {
            let sign = |bit: usize| if k >> bit & 1 == 1 { half } else { -half };
            middle + turn * DVec3::new(sign(0), sign(1), sign(2))
        };
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let halves = faces.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let mut list: Vec<[DVec3; 3]> = halves
            .into_iter()
            .flatten()
            .map(|t| t.map(corner))
            .collect();
        if !is_out {
            list.iter_mut().for_each(|t| t.swap(0, 1));
        }
        list
    }

    /// Ray crossings against solid angles, for nested, disjoint and intersecting shells.
    #[test]
    fn rays_count_what_solid_angles_add_up_to() {
        let shells = [
            cuboid(DVec3::ZERO, 2.0, true),
            cuboid(DVec3::new(0.3, 0.0, 0.1), 1.0, false),
            cuboid(DVec3::new(1.5, 1.5, 0.0), 1.2, true),
            cuboid(DVec3::new(9.0, 0.0, 0.0), 0.5, true),
        ];
        let triangles = shells.concat();
        let mut state = 5u64;
        let mut draw = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 * 8.0 - 4.0
        };
        for _ in 0..2000 {
            let point = DVec3::new(draw(), draw(), draw());
            let angles = turns_around(&triangles, point);
            let crossings = Ray::from_point(point).find_map(|ray| {
                triangles
                    .iter()
                    .try_fold(0, |sum, t| Some(sum + ray.crossing(t)?))
            });
            assert_eq!(crossings, Some(angles.round() as i32), "{point} {angles}");
        }
        // On a triangle, on an edge and at a corner the result is ambiguous.
        let [a, b, c] = triangles[0];
        for point in [(a + b + c) / 3.0, 0.5 * (a + b), a] {
            let any = Ray::from_point(point).find_map(|ray| {
                triangles
                    .iter()
                    .try_fold(0, |sum, t| Some(sum + ray.crossing(t)?))
            });
            assert_eq!(any, None, "{point}");
        }
    }
}
