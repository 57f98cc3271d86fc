//! Constant poses of chains, and bounds of their errors.
//!
//! While a scene is resolved, adjacent constant factors are multiplied in plain f64. No constant bounds the error,
//! since there may be thousands of factors. Every pose therefore carries its own bound: the uncertainty of its numbers,
//! and the rounding of each product, measured with two f64 per number.

use super::pattern::RowPattern;
use crate::math::Pose;
use crate::numbers::constant::Constant;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::rounding::{DECIMAL, GROW, SIN_COS, is_exact};
use crate::numbers::sin_cos::sin_cos;
use glam::{DMat3, DVec3};
use std::f64::consts::SQRT_2;
use std::ops::{Deref, Mul};

/// Bounds of the difference between a stored pose and the exact one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseError {
    /// Of the rotation: the Frobenius norm. No vector is rotated by a larger angle.
    pub rotation: f64,
    /// Of the translation: length.
    pub translation: f64,
}

/// A constant pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedPose {
    /// The pose used in computations.
    pub pose: Pose,
    /// Its error bound.
    pub error: PoseError,
    /// The entries of the exact pose that are zero, derived from its motions.
    pub pattern: RowPattern,
}

impl FixedPose {
    /// A pose that is exact.
    pub fn exact(pose: Pose) -> Self {
        Self {
            pose,
            error: PoseError::default(),
            pattern: RowPattern::of_exact(&pose),
        }
    }

    /// Along a coordinate axis by a length of the scene.
    pub fn translation(axis: usize, length: Constant) -> Self {
        let error = PoseError {
            rotation: 0.0,
            translation: length.open(),
        };
        Self {
            pose: Pose::from_translation(DVec3::AXES[axis] * length.number()),
            error,
            pattern: unless_zero(length, RowPattern::of_shift(axis)),
        }
    }

    /// About a coordinate axis by an angle in radians.
    ///
    /// An error of d in the angle changes the matrix by 2√2 sin(d/2) ≤ √2 d. Its four entries are compared with a sine
    /// and a cosine of 20 digits.
    pub fn rotation(axis: usize, angle: Constant) -> Self {
        if let Some(quarters) = angle.quarter_turns() {
            return Self::quarter_turns(axis, quarters);
        }
        let pose = Pose::from_axis_rotation(axis, angle.number());
        let own = pose.rotation.col((axis + 1) % 3);
        let (cos, sin) = (own[(axis + 1) % 3], own[(axis + 2) % 3]);
        let mut rotation = 0.0;
        if angle != Constant::exact(0.0) {
            let (exact_sin, exact_cos) = sin_cos(angle.value());
            let off = [(exact_sin, sin), (exact_cos, cos)]
                .map(|(exact, stored)| (exact.value() - DoubleDouble::from(stored)).hi);
            let rounded = SQRT_2 * (libm::hypot(off[0], off[1]) + 2.0 * SIN_COS);
            rotation = (SQRT_2 * angle.error() + rounded) * GROW;
        }
        // An angle too large to be reduced has no known digit.
        let rotation = if rotation.is_nan() {
            2.0 * SQRT_2
        } else {
            rotation
        };
        let error = PoseError {
            rotation,
            translation: 0.0,
        };
        Self {
            pose,
            error,
            pattern: unless_zero(angle, RowPattern::of_turn(axis)),
        }
    }

    /// About a coordinate axis by whole quarter turns: its entries are whole and exact.
    fn quarter_turns(axis: usize, quarters: i64) -> Self {
        let (sin, cos) = match quarters.rem_euclid(4) {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            2 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        };
        let pose = Pose::from_axis_sin_cos(axis, sin, cos);
        Self::exact(pose)
    }

    /// A rotation that takes the z axis to a direction of the scene, not zero. It is not unique, so that the stored
    /// matrix M is compared with the nearest one that has the exact direction.
    ///
    /// The nearest rotation Q is within g = |MᵀM - I| of M, and so is its axis, which is within a of the direction by
    /// M's own; rotating Q by g + a makes it exact.
    pub fn z_axis(meant: [Constant; 3]) -> Self {
        let direction = DVec3::from(meant.map(Constant::number));
        let pose = Pose::from_z_axis(direction);
        let m = pose.rotation;
        if m.to_cols_array().into_iter().all(is_exact) && meant.into_iter().all(Constant::is_exact)
        {
            return Self::exact(pose);
        }
        let columns = [m.x_axis, m.y_axis, m.z_axis];
        let mut squares = 0.0;
        for (i, a) in columns.iter().enumerate() {
            for (j, b) in columns.iter().enumerate() {
                let product = exact_dot(*a, *b) - DoubleDouble::from(f64::from(i == j));
                squares += product.hi * product.hi;
            }
        }
        let defect = squares.sqrt();
        // Uncertain components change the direction by no more than their share.
        let (z, u) = (m.z_axis, direction / direction.abs().max_element());
        let off = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
            let product = DoubleDouble::product(z[i], u[j]) - DoubleDouble::product(z[j], u[i]);
            product.hi
        });
        let open = DVec3::from(meant.map(Constant::open)).length() / direction.length();
        let tilt = DVec3::from_array(off).length() / u.length() + 2.0 * DECIMAL + 2.0 * open;
        let error = PoseError {
            rotation: (defect + SQRT_2 * (defect + tilt)) * GROW,
            translation: 0.0,
        };
        Self {
            pose,
            error,
            pattern: RowPattern::of_any_rotation(),
        }
    }

    /// The inverse motion.
    pub fn inverse(&self) -> Self {
        let pose = self.pose.inverse();
        let back = pose.rotation;
        let rounded = rounding_error(&back, self.pose.translation, DVec3::ZERO, -pose.translation);
        let PoseError {
            rotation,
            translation,
        } = self.error;
        let error = PoseError {
            rotation,
            translation: (rotation * self.pose.translation.length() + translation + rounded) * GROW,
        };
        Self {
            pose,
            error,
            pattern: self.pattern.inverse(),
        }
    }
}

/// The pattern of a motion; a motion by exactly zero has none.
fn unless_zero(by: Constant, pattern: RowPattern) -> RowPattern {
    if by == Constant::exact(0.0) {
        RowPattern::IDENTITY
    } else {
        pattern
    }
}

/// a · b with 31 digits.
fn exact_dot(a: DVec3, b: DVec3) -> DoubleDouble {
    let [x, y, z] = [0, 1, 2].map(|k| DoubleDouble::product(a[k], b[k]));
    x + y + z
}

/// The difference between `stored` and `matrix v + shift`.
fn rounding_error(matrix: &DMat3, v: DVec3, shift: DVec3, stored: DVec3) -> f64 {
    let rows = matrix.transpose();
    let off = [0, 1, 2].map(|k| {
        let exact = exact_dot(rows.col(k), v) + DoubleDouble::from(shift[k]);
        (exact - DoubleDouble::from(stored[k])).hi
    });
    DVec3::from_array(off).length()
}

/// The product: |AB - A*B*| ≤ |A - A*| |B| + |A*| |B - B*| with |A*| = 1, plus rounding.
impl Mul for FixedPose {
    type Output = Self;
    fn mul(self, right: Self) -> Self {
        let pose = self.pose * right.pose;
        let (a, b) = (self.pose, right.pose);
        // Rounding of the product: of its three columns, and of the moved origin.
        let columns = [0, 1, 2].map(|k| {
            let column = pose.rotation.col(k);
            rounding_error(&a.rotation, b.rotation.col(k), DVec3::ZERO, column)
        });
        let moved = rounding_error(&a.rotation, b.translation, a.translation, pose.translation);
        // An error of the left rotation displaces the right translation; errors of rotations compose to first order
        // and their product.
        let open = self.error.rotation * b.translation.length();
        let error = PoseError {
            rotation: self.error.rotation * (1.0 + right.error.rotation)
                + right.error.rotation
                + DVec3::from_array(columns).length(),
            translation: self.error.translation + right.error.translation + open + moved,
        };
        // The sums above are rounded, too.
        let error = PoseError {
            rotation: error.rotation * GROW,
            translation: error.translation * GROW,
        };
        Self {
            pose,
            error,
            pattern: self.pattern * right.pattern,
        }
    }
}

impl Mul<FixedPose> for Pose {
    type Output = Self;
    #[inline]
    fn mul(self, right: FixedPose) -> Self {
        self * right.pose
    }
}

impl From<Pose> for FixedPose {
    fn from(pose: Pose) -> Self {
        Self::exact(pose)
    }
}

/// What can be asked of a pose can be asked of a constant one.
impl Deref for FixedPose {
    type Target = Pose;
    #[inline]
    fn deref(&self) -> &Pose {
        &self.pose
    }
}
