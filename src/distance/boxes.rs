//! Oriented boxes around triangles, aligned with their content, so that they are as thin as a surface is curved.

use glam::{DMat3, DVec3};

/// A box in any orientation, and the sphere around its content.
#[derive(Clone, Copy, Debug)]
pub struct OrientedBox {
    /// Its centre, also that of the ball.
    pub centre: DVec3,
    /// Distance of the farthest point from the centre.
    pub radius: f64,
    /// Unit vectors along its edges.
    axes: DMat3,
    /// Half edge lengths.
    half: DVec3,
}

/// Number of squarings of the matrix whose largest eigenvector is computed: its 64th power.
const SQUARINGS: usize = 6;

/// Number of triangles that determine the orientation of a box.
const SAMPLED: usize = 128;

impl OrientedBox {
    /// The box around triangles: along their common plane, or along the coordinate axes where that is smaller. The
    /// orientation for many triangles is computed from a sample of them.
    pub fn around(triangles: &[[DVec3; 3]]) -> Self {
        let stride = triangles.len().div_ceil(SAMPLED).max(1);
        let some: Vec<[DVec3; 3]> = triangles.iter().step_by(stride).copied().collect();
        let turned = principal_frame(&some);
        let is_smaller =
            Self::along(&some, turned).surface() < Self::along(&some, DMat3::IDENTITY).surface();
        Self::along(triangles, if is_smaller { turned } else { DMat3::IDENTITY })
    }

    fn along(triangles: &[[DVec3; 3]], axes: DMat3) -> Self {
        let to_box = axes.transpose();
        let points = || triangles.iter().flatten();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for point in points() {
            let local = to_box * *point;
            (low, high) = (low.min(local), high.max(local));
        }
        let centre = axes * ((low + high) * 0.5);
        let far = points().map(|p| p.distance_squared(centre));
        Self {
            centre,
            radius: far.fold(0.0, f64::max).sqrt(),
            axes,
            half: (high - low) * 0.5,
        }
    }

    /// The same box with all coordinates multiplied by a positive factor.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            centre: self.centre * factor,
            radius: self.radius * factor,
            half: self.half * factor,
            ..*self
        }
    }

    fn surface(&self) -> f64 {
        let DVec3 { x, y, z } = self.half;
        x * y + y * z + z * x
    }

    /// Half of its extent along `n`, times the length of `n`.
    #[inline]
    pub fn reach(&self, n: DVec3) -> f64 {
        let [x, y, z] = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis];
        let local = DVec3::new(x.dot(n), y.dot(n), z.dot(n));
        local.abs().dot(self.half)
    }

    /// Largest n · p of its points.
    #[inline]
    pub fn support(&self, n: DVec3) -> f64 {
        self.centre.dot(n) + self.reach(n)
    }

    /// The direction of its longest edge.
    pub fn longest(&self) -> DVec3 {
        let axis = (0..3).fold(0, |k, j| if self.half[j] > self.half[k] { j } else { k });
        self.axes.col(axis)
    }
}

/// Three unit vectors: perpendicular to the triangles as far as they have a common plane, and along their longer extent
/// in it.
fn principal_frame(triangles: &[[DVec3; 3]]) -> DMat3 {
    let mut spread = DMat3::ZERO;
    let mut middle = DVec3::ZERO;
    for [a, b, c] in triangles {
        let area = (*b - *a).cross(*c - *a);
        let size = area.length();
        if size > 0.0 {
            spread += outer_product(area, area / size);
        }
        middle += (*a + *b + *c) / 3.0;
    }
    middle /= triangles.len().max(1) as f64;
    let normal = main_direction(spread);
    let x = normal.any_orthonormal_vector();
    let y = normal.cross(x);
    let (mut difference, mut mixed) = (0.0, 0.0);
    for point in triangles.iter().flatten() {
        let (u, v) = (x.dot(*point - middle), y.dot(*point - middle));
        difference += u * u - v * v;
        mixed += u * v;
    }
    // The double angle of the longer main axis of the points in the plane.
    let (sin, cos) = crate::math::sin_cos(0.5 * libm::atan2(2.0 * mixed, difference));
    DMat3::from_cols(x * cos + y * sin, y * cos - x * sin, normal)
}

fn outer_product(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Rotation about the eigenvector of the largest eigenvalue, unit: any direction makes a valid box.
fn main_direction(mut matrix: DMat3) -> DVec3 {
    for _ in 0..SQUARINGS {
        let trace = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
        if trace <= 0.0 || !trace.is_finite() {
            return DVec3::Z;
        }
        matrix *= 1.0 / trace;
        matrix = matrix * matrix;
    }
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let longest = columns.into_iter().fold(DVec3::ZERO, |best, column| {
        if column.length_squared() > best.length_squared() {
            column
        } else {
            best
        }
    });
    longest.try_normalize().unwrap_or(DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tilted plate with both of its faces: the box is as thin as the plate, and contains every corner.
    #[test]
    fn a_box_lies_along_a_thin_plate() {
        let turn = DMat3::from_quat(glam::DQuat::from_scaled_axis(DVec3::new(0.3, 1.1, -0.7)));
        let mut triangles = Vec::new();
        for height in [0.0, 0.01] {
            for (x, y) in [(0.0, 0.0), (3.0, 1.0), (2.0, 5.0), (-1.0, 2.0)] {
                let corner = |dx: f64, dy: f64| turn * DVec3::new(x + dx, y + dy, height);
                triangles.push([corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)]);
            }
        }
        let around = OrientedBox::around(&triangles);
        assert!(around.reach(turn.z_axis) < 0.006, "{around:?}");
        for n in [DVec3::X, DVec3::Y, DVec3::Z, turn.x_axis, -turn.z_axis] {
            let farthest = triangles.iter().flatten().map(|p| n.dot(*p));
            let farthest = farthest.fold(f64::NEG_INFINITY, f64::max);
            assert!(around.support(n) >= farthest - 1e-12);
        }
    }
}
