//! Vectors and twists of four joints at once, and the present frame of a traversal of a loop.
//!
//! Plain f64 arithmetic lane by lane in a fixed order.

use crate::kinematics::structure::layout::{LayoutJoint, PlannedGroup};
use crate::linalg::lanes::{Lanes, all_lanes, lane_sum};
use crate::math::Pose;
use crate::model::chain::{ArgumentValue, ElementaryMotion};
use glam::{DMat3, DVec3};
use std::ops::{Add, AddAssign, Mul, Sub};
use wide::f64x4;

/// Four vectors: their x, their y, their z.
#[derive(Clone, Copy, Debug)]
pub struct Vectors(pub [f64x4; 3]);

impl Default for Vectors {
    /// Zeros; inlined wherever code is made for size, too.
    #[inline(always)]
    fn default() -> Self {
        Self([f64x4::ZERO; 3])
    }
}

impl Vectors {
    /// Four times the same vector.
    #[inline]
    pub fn splat(v: DVec3) -> Self {
        Self([all_lanes(v.x), all_lanes(v.y), all_lanes(v.z)])
    }

    /// From the numbers of four lanes.
    #[inline]
    pub fn of(lanes: &[Lanes; 3]) -> Self {
        Self([
            f64x4::new(lanes[0]),
            f64x4::new(lanes[1]),
            f64x4::new(lanes[2]),
        ])
    }

    /// The four cross products.
    #[inline(always)]
    pub fn cross(&self, b: &Self) -> Self {
        let (a, b) = (&self.0, &b.0);
        Self([
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ])
    }

    /// The same matrix times each vector.
    #[inline(always)]
    pub fn mapped(&self, by: &DMat3) -> Self {
        let [x, y, z] = self.0;
        let row = |k: usize| {
            x * all_lanes(by.x_axis[k]) + y * all_lanes(by.y_axis[k]) + z * all_lanes(by.z_axis[k])
        };
        Self([row(0), row(1), row(2)])
    }

    /// The sum of the four vectors.
    #[inline]
    pub fn total(&self) -> DVec3 {
        let [x, y, z] = self.0.map(|v| lane_sum(v.to_array()));
        DVec3::new(x, y, z)
    }
}

impl Add for Vectors {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self([self.0[0] + b.0[0], self.0[1] + b.0[1], self.0[2] + b.0[2]])
    }
}

impl Sub for Vectors {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self([self.0[0] - b.0[0], self.0[1] - b.0[1], self.0[2] - b.0[2]])
    }
}

impl Mul<f64x4> for Vectors {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factors: f64x4) -> Self {
        let [x, y, z] = self.0;
        Self([x * factors, y * factors, z * factors])
    }
}

impl AddAssign for Vectors {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

/// Four screws: angular and linear parts at the origin of the loop's base.
#[derive(Clone, Copy, Debug, Default)]
pub struct LaneTwists {
    /// Angular parts.
    pub angular: Vectors,
    /// Linear parts.
    pub linear: Vectors,
}

impl LaneTwists {
    /// Adds each screw of `other` times its factor.
    #[inline(always)]
    pub fn add_scaled(&mut self, other: &Self, factors: f64x4) {
        self.angular += other.angular * factors;
        self.linear += other.linear * factors;
    }

    /// Adds the brackets [aᵢ, bᵢ].
    #[inline(always)]
    pub fn add_bracket(&mut self, a: &Self, b: &Self) {
        self.angular += a.angular.cross(&b.angular);
        self.linear += a.angular.cross(&b.linear) + a.linear.cross(&b.angular);
    }

    /// Each screw multiplied by its factor.
    #[inline(always)]
    pub fn scaled(&self, factors: f64x4) -> Self {
        Self {
            angular: self.angular * factors,
            linear: self.linear * factors,
        }
    }

    /// Replaces the screws by the sums of those before them, including `link`, and adds all to `link`.
    #[inline(always)]
    pub fn sums_before(&self, link: &mut [f64; 6]) -> Self {
        let mut before = *self;
        let parts = before.angular.0.iter_mut().chain(&mut before.linear.0);
        for (part, link) in parts.zip(link) {
            // Prefix sums across the four lanes, carried on to the next group.
            let [a, b, c, d] = part.to_array();
            let first = *link + a;
            let second = first + b;
            let third = second + c;
            *part = f64x4::new([*link, first, second, third]);
            *link = third + d;
        }
        before
    }
}

/// Axes and places of four joints in the base frame of their loop.
#[derive(Clone, Copy, Debug, Default)]
pub struct JointGroup {
    /// Directions, with the joints' signs.
    pub axis: [Lanes; 3],
    /// Points of the axes.
    pub origin: [Lanes; 3],
}

impl JointGroup {
    /// The joints' twists.
    #[inline(always)]
    pub fn twists(&self, planned: &PlannedGroup) -> LaneTwists {
        let (axis, origin) = (Vectors::of(&self.axis), Vectors::of(&self.origin));
        let (turns, slides) = (f64x4::new(planned.turns), f64x4::new(planned.slides));
        LaneTwists {
            angular: axis * turns,
            linear: origin.cross(&axis) * turns + axis * slides,
        }
    }

    /// The joints' columns: the change of the rotation vector and of the scaled translation of a loop whose product has
    /// the given `translation`. `log_from_spin` maps a spin to the rate of the rotation vector.
    #[inline(always)]
    pub fn columns(
        &self,
        planned: &PlannedGroup,
        log_from_spin: &DMat3,
        translation: DVec3,
        per_size: f64,
    ) -> [Lanes; 6] {
        let (axis, origin) = (Vectors::of(&self.axis), Vectors::of(&self.origin));
        let (turns, slides) = (f64x4::new(planned.turns), f64x4::new(planned.slides));
        // A rotation moves the loop's end perpendicular to its arm; a translation along its axis.
        let arms = Vectors::splat(translation) - origin;
        let turn = axis.mapped(log_from_spin) * turns;
        let shift = (axis.cross(&arms) * turns + axis * slides) * all_lanes(per_size);
        let ([a, b, c], [d, e, f]) = (turn.0, shift.0);
        [
            a.to_array(),
            b.to_array(),
            c.to_array(),
            d.to_array(),
            e.to_array(),
            f.to_array(),
        ]
    }
}

/// The two axes after an axis, in turn; nothing is a fourth.
const OTHERS: [(usize, usize); 4] = [(1, 2), (2, 0), (0, 1), (3, 3)];

/// Three columns of a rotation, then the origin; the fourth lane is not used.
#[derive(Clone, Copy, Debug)]
pub struct LaneFrame([Lanes; 4]);

impl LaneFrame {
    /// Where every walk begins.
    pub const IDENTITY: Self = Self([
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0; 4],
    ]);

    #[inline(always)]
    fn get(&self, column: usize) -> f64x4 {
        f64x4::new(self.0[column & 3])
    }

    /// Applies the fixed pose before a joint; returns the joint's axis, with its sign, and its position.
    #[inline(always)]
    pub fn reach(&mut self, joint: &LayoutJoint) -> (Lanes, Lanes) {
        if let Some(shift) = joint.shift {
            self.shift(shift);
        }
        if let Some(turn) = &joint.turn {
            self.turn(turn);
        }
        let axis = self.get(joint.axis) * all_lanes(joint.sign);
        (axis.to_array(), self.0[3])
    }

    /// Applies the joint's own motion.
    #[inline(always)]
    pub fn pass(&mut self, joint: &LayoutJoint, value: &ArgumentValue) {
        match joint.motion {
            ElementaryMotion::Translation => {
                let way = self.get(joint.axis) * all_lanes(joint.sign * value.value);
                self.0[3] = (self.get(3) + way).to_array();
            }
            ElementaryMotion::Rotation => {
                let (sin, cos) = (all_lanes(joint.sign * value.sin), all_lanes(value.cos));
                // The axis turned about stays; the other two columns turn in their plane.
                let (b, c) = OTHERS[joint.axis & 3];
                let (x, y) = (self.get(b), self.get(c));
                self.0[b] = (x * cos + y * sin).to_array();
                self.0[c] = (y * cos - x * sin).to_array();
            }
        }
    }

    #[inline(always)]
    fn mapped(&self, v: DVec3) -> f64x4 {
        self.get(0) * all_lanes(v.x) + self.get(1) * all_lanes(v.y) + self.get(2) * all_lanes(v.z)
    }

    #[inline]
    fn shift(&mut self, by: DVec3) {
        self.0[3] = (self.get(3) + self.mapped(by)).to_array();
    }

    #[inline]
    fn turn(&mut self, by: &DMat3) {
        let columns = [by.x_axis, by.y_axis, by.z_axis].map(|v| self.mapped(v));
        for (own, new) in self.0.iter_mut().zip(columns) {
            *own = new.to_array();
        }
    }

    /// The frame after a last fixed pose.
    #[inline]
    pub fn end(mut self, end: &Pose) -> Pose {
        self.shift(end.translation);
        if end.rotation != DMat3::IDENTITY {
            self.turn(&end.rotation);
        }
        let [x, y, z, t] = self.0.map(|[x, y, z, _]| DVec3::new(x, y, z));
        Pose {
            rotation: DMat3::from_cols(x, y, z),
            translation: t,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn four() -> [Vectors; 2] {
        let lanes = |seed: f64| {
            [0.0, 1.0, 2.0].map(|k| [0, 1, 2, 3].map(|l| (seed + k + 3.0 * f64::from(l)).sin()))
        };
        [Vectors::of(&lanes(0.3)), Vectors::of(&lanes(1.9))]
    }

    fn lane(v: &Vectors, lane: usize) -> DVec3 {
        let [x, y, z] = v.0.map(|part| part.to_array()[lane]);
        DVec3::new(x, y, z)
    }

    #[test]
    fn every_lane_is_the_product_of_its_vectors() {
        let [a, b] = four();
        let matrix = DMat3::from_cols(DVec3::X + DVec3::Y, DVec3::Z * 2.0, DVec3::NEG_X);
        for k in 0..4 {
            assert_eq!(lane(&a.cross(&b), k), lane(&a, k).cross(lane(&b, k)));
            assert_eq!(lane(&a.mapped(&matrix), k), matrix * lane(&a, k));
        }
        let sum: DVec3 = (0..4).map(|k| lane(&a, k)).sum();
        assert!((a.total() - sum).length() < 1e-15);
    }

    #[test]
    fn sums_before_are_those_of_the_joints_one_after_the_other() {
        let [angular, linear] = four();
        let twists = LaneTwists { angular, linear };
        let mut link = [0.5, 0.0, 0.0, 0.0, 0.0, -2.0];
        let before = twists.sums_before(&mut link);
        let (mut turn, mut shift) = (DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.0, 0.0, -2.0));
        for k in 0..4 {
            assert_eq!(lane(&before.angular, k), turn);
            assert_eq!(lane(&before.linear, k), shift);
            turn += lane(&angular, k);
            shift += lane(&linear, k);
        }
        assert_eq!(link, [turn.x, turn.y, turn.z, shift.x, shift.y, shift.z]);
    }
}
