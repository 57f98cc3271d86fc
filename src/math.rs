//! Poses and angles in f64, and the only conversion from f64 to the GPU's f32.
//!
//! Independent of mechanisms and solvers. A pose named `a_from_b` maps coordinates of frame b to frame a,
//! so that products chain by name: `a_from_c = a_from_b * b_from_c`.

use glam::{DMat3, DQuat, DVec3};

/// Sine and cosine of an angle in radians.
///
/// The portable implementation gives the same bits on every platform; the pictures of the CPU renderer
/// are reproducible because of it. Error below one unit in the last place.
#[inline]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    libm::sincos(angle)
}

/// What is left of a vector along an axis is rounding and may lie along the axis itself, which is a unit vector to rounding only:
/// then the square of its part across is less than this.
const ALONG: f64 = 1e-12;

/// The unit vector perpendicular to `axis` that is nearest to `v`; zero along the axis.
pub fn square_to(axis: DVec3, v: DVec3) -> DVec3 {
    // Twice: next to the axis the first remainder is mostly rounding.
    let across = (v - axis * v.dot(axis)).normalize_or_zero();
    let square = across - axis * across.dot(axis);
    let size = square.length_squared();
    if size > ALONG {
        square / size.sqrt()
    } else {
        DVec3::ZERO
    }
}

/// A rigid motion: rotation matrix and translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Orthonormal, determinant +1; columns are the axes of the source frame in the target frame.
    pub rotation: DMat3,
    /// Origin of the source frame in the target frame, in the scene's length unit.
    pub translation: DVec3,
}

impl Pose {
    /// The motion that moves nothing.
    pub const IDENTITY: Self = Self {
        rotation: DMat3::IDENTITY,
        translation: DVec3::ZERO,
    };

    /// Pure translation by `offset`.
    #[inline]
    pub const fn from_translation(offset: DVec3) -> Self {
        Self {
            rotation: DMat3::IDENTITY,
            translation: offset,
        }
    }

    /// Rotation about the coordinate axis `axis` (0 x, 1 y, 2 z) by `angle` radians.
    #[inline]
    pub fn from_axis_rotation(axis: usize, angle: f64) -> Self {
        let (s, c) = sin_cos(angle);
        Self::from_axis_sin_cos(axis, s, c)
    }

    /// The same from the sine and the cosine of the angle.
    pub fn from_axis_sin_cos(axis: usize, s: f64, c: f64) -> Self {
        let rotation = match axis {
            0 => DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, c, s, 0.0, -s, c]),
            1 => DMat3::from_cols_array(&[c, 0.0, -s, 0.0, 1.0, 0.0, s, 0.0, c]),
            _ => DMat3::from_cols_array(&[c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0]),
        };
        Self {
            rotation,
            translation: DVec3::ZERO,
        }
    }

    /// The shortest rotation that takes the z axis to the direction of `axis`; identity for a zero vector.
    pub fn from_z_axis(axis: DVec3) -> Self {
        let Some(z) = axis.try_normalize() else {
            return Self::IDENTITY;
        };
        // The seed axis is the one least aligned with z, so the cross product never degenerates.
        let seed = if z.x.abs() <= z.y.abs() && z.x.abs() <= z.z.abs() {
            DVec3::X
        } else if z.y.abs() <= z.z.abs() {
            DVec3::Y
        } else {
            DVec3::Z
        };
        let x = (seed - z * seed.dot(z)).normalize();
        Self {
            rotation: DMat3::from_cols(x, z.cross(x), z),
            translation: DVec3::ZERO,
        }
    }

    /// The inverse motion: `b_from_a` of `a_from_b`.
    #[inline]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self {
            rotation,
            translation: -(rotation * self.translation),
        }
    }

    /// Maps a point of the source frame to the target frame.
    #[inline]
    pub fn transform_point(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation
    }

    /// Maps a direction of the source frame to the target frame.
    #[inline]
    pub fn transform_vector(&self, vector: DVec3) -> DVec3 {
        self.rotation * vector
    }

    /// True when every entry is a finite number.
    pub fn is_finite(&self) -> bool {
        self.rotation.is_finite() && self.translation.is_finite()
    }
}

impl std::ops::Mul for Pose {
    type Output = Self;
    #[inline]
    fn mul(self, right: Self) -> Self {
        Self {
            rotation: self.rotation * right.rotation,
            translation: self.rotation * right.translation + self.translation,
        }
    }
}

/// Rotation vector (axis times angle, 0 to π) of a rotation matrix.
///
/// Vanishes only at the identity: a rotation by π, whose skew part is zero, gives a vector of length π.
/// Error is a few units in the last place of the angle, also next to 0 and to π.
pub fn rotation_log(rotation: &DMat3) -> DVec3 {
    let r = rotation;
    let skew = DVec3::new(
        r.y_axis.z - r.z_axis.y,
        r.z_axis.x - r.x_axis.z,
        r.x_axis.y - r.y_axis.x,
    ) * 0.5;
    let cos = 0.5 * (r.x_axis.x + r.y_axis.y + r.z_axis.z - 1.0);
    let sin = skew.length();
    // sin/angle is smooth through zero; below 1e-8 the quotient is 1 to rounding.
    if cos > 0.0 && sin < 1e-8 {
        return skew;
    }
    let angle = libm::atan2(sin, cos);
    if cos > -0.9 {
        return skew * (angle / sin);
    }
    // Next to π the axis is read from the symmetric part, whose largest column is well conditioned.
    let symmetric = (*r + r.transpose()) * 0.5 - DMat3::from_diagonal(DVec3::splat(cos));
    let columns = [symmetric.x_axis, symmetric.y_axis, symmetric.z_axis];
    let longest = columns.into_iter().fold(DVec3::ZERO, |a, b| {
        if b.length_squared() > a.length_squared() {
            b
        } else {
            a
        }
    });
    let axis = longest.normalize_or_zero();
    let sign = if axis.dot(skew) < 0.0 { -1.0 } else { 1.0 };
    axis * (sign * angle)
}

/// Inverse of the left Jacobian of SO(3): maps a spatial angular velocity to the rate of the rotation vector.
///
/// `phi` is the rotation vector, length below 2π. Formula: I - P/2 + c P² with P the
/// cross-product matrix of `phi`, Chirikjian,
/// Stochastic Models vol. 2, section 10.8.
pub fn left_jacobian_inverse(phi: DVec3) -> DMat3 {
    let angle_squared = phi.length_squared();
    let cross = skew_matrix(phi);
    let c = if angle_squared < 1e-4 {
        1.0 / 12.0 + angle_squared / 720.0
    } else {
        let angle = angle_squared.sqrt();
        let (s, co) = sin_cos(0.5 * angle);
        (1.0 - 0.5 * angle * co / s) / angle_squared
    };
    DMat3::IDENTITY - cross * 0.5 + cross * cross * c
}

/// The matrix of the cross product with `v` from the left.
pub fn skew_matrix(v: DVec3) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(0.0, v.z, -v.y),
        DVec3::new(-v.z, 0.0, v.x),
        DVec3::new(v.y, -v.x, 0.0),
    )
}

/// The unit quaternions of rotation matrices, each with the sign nearest to the previous one, so that interpolation
/// takes the shorter way.
pub fn rotation_quaternions(matrices: &[DMat3]) -> Vec<DQuat> {
    let mut list: Vec<DQuat> = Vec::with_capacity(matrices.len());
    for matrix in matrices {
        let rotation = DQuat::from_mat3(matrix).normalize();
        let turned = list.last().is_some_and(|last| last.dot(rotation) < 0.0);
        list.push(if turned { -rotation } else { rotation });
    }
    list
}

/// The only conversion from f64 to f32, for the renderers.
#[inline]
pub fn narrow_vector(v: DVec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// A unit quaternion as (x, y, z, w).
#[inline]
pub fn narrow_rotation(rotation: DQuat) -> [f32; 4] {
    rotation.to_array().map(|component| component as f32)
}

/// A pose as three rows of four f32 (rotation | translation), the layout of the mesh shader's instances.
pub fn narrow_pose(pose: &Pose) -> [[f32; 4]; 3] {
    let r = pose.rotation.transpose();
    let t = pose.translation;
    let row = |v: DVec3, t: f64| [v.x as f32, v.y as f32, v.z as f32, t as f32];
    [row(r.x_axis, t.x), row(r.y_axis, t.y), row(r.z_axis, t.z)]
}

/// Distance of a point of the plane from the segment between two others.
pub fn segment_distance(point: [f64; 2], [from, to]: [[f64; 2]; 2]) -> f64 {
    let [along, off] = [to, point].map(|end| [end[0] - from[0], end[1] - from[1]]);
    let square = along[0] * along[0] + along[1] * along[1];
    let share = match square > 0.0 {
        true => ((off[0] * along[0] + off[1] * along[1]) / square).clamp(0.0, 1.0),
        false => 0.0,
    };
    libm::hypot(off[0] - share * along[0], off[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn log_of_axis_rotations_is_the_angle() {
        for axis in 0..3 {
            for angle in [0.0, 1e-9, 1e-3, 0.5, 2.0, 3.0, PI - 1e-5, PI] {
                let log = rotation_log(&Pose::from_axis_rotation(axis, angle).rotation);
                assert!(
                    (log.length() - angle).abs() < 4e-15,
                    "axis {axis} angle {angle} log {log}"
                );
            }
        }
    }

    #[test]
    fn left_jacobian_inverse_matches_differences() {
        let phi = DVec3::new(0.4, -0.9, 1.3);
        let base = Pose {
            rotation: DMat3::from_quat(glam::DQuat::from_scaled_axis(phi)),
            translation: DVec3::ZERO,
        };
        let jac = left_jacobian_inverse(phi);
        for k in 0..3 {
            let h = 1e-6;
            let mut w = DVec3::ZERO;
            w[k] = h;
            let spin = |w: DVec3| {
                rotation_log(&(DMat3::from_quat(glam::DQuat::from_scaled_axis(w)) * base.rotation))
            };
            let difference = (spin(w) - spin(-w)) / (2.0 * h);
            assert!((difference - jac.col(k)).length() < 1e-9);
        }
    }

    #[test]
    fn z_axis_pose_is_a_rotation() {
        for v in [
            DVec3::X,
            DVec3::NEG_Z,
            DVec3::new(1.0, 2.0, -3.0),
            DVec3::new(1e-9, 0.0, 1.0),
        ] {
            let p = Pose::from_z_axis(v);
            assert!((p.transform_vector(DVec3::Z) - v.normalize()).length() < 1e-15);
            assert!((p.rotation.determinant() - 1.0).abs() < 1e-14);
        }
    }
}
