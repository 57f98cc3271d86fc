//! Ball joints written as three consecutive rotations: their rotation from their angles, and their angles from their
//! rotation.
//!
//! Where the middle angle makes the first and the last axis parallel, the three angles are no longer coordinates of a
//! rotation, although nothing is wrong with the joint: gimbal lock. `chart` describes what is solved instead near
//! such poses.
//!
//! Constant poses may separate the rotations as long as all three axes meet in one point and each is at right
//! angles to the next: `Rz(a) Rx(90) Rz(b) Rx(-90) Rz(c)` is a ball joint. With u1, u2, u3 the axes in the frame before
//! the joint at zero angles, M the product of the constant rotations, C = [u1, u2, u1 × u2], and u3 turned by mu from
//! u1 × u2 about u2, every such joint is C Rx(a) Ry(b + mu) Rz(c) Ry(-mu) Cᵀ M: one formula serves all orders of axes.
//! It is locked where cos(b + mu) = 0; only a + c or a - c is determined there. Axes that are not at right angles do
//! not reach all rotations: where they lie in one plane, the joint is at its limit and really singular.
//!
//! The [table of joints](crate::model::joints) decides which rotations form a spherical joint; a ball is one of them
//! whose three angles are unknowns of their own, solved in one block.

use super::run::{RotationRun, axes_of, ball_centre};
use crate::kinematics::structure::block::Structure;
use crate::math::{Pose, sin_cos};
use crate::model::chain::Argument;
use crate::model::joints::{JointKind, Passage};
use crate::model::mechanism::Mechanism;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Distance from a locked pose, in half turns, at which |cos(b + mu)| is 0.2.
const NEAR: f64 = 0.064_094_216_849;

/// Below this |cos(b + mu)| the last angle is kept instead of computed: the first then has an error of at most this
/// size in radians, no more than the rounding of a long chain.
const UNREADABLE: f64 = 4e-15;

/// Angles whose middle one is so near to a quarter turn, by its cosine, are locked: rates have no digits left there.
const LOCKED: f64 = 1e-9;

/// A ball joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Ball {
    /// Its three unknowns, in the order of the rotations.
    pub slots: [usize; 3],
    /// Block that solves them.
    pub block: usize,
    /// Index into the table of joints.
    pub(crate) joint: usize,
    /// Whether the table contains its inverse.
    is_reversed: bool,
    run: RotationRun,
    /// Radians by unknown.
    factors: [f64; 3],
    /// Added to the unknowns to give the angles.
    offsets: [f64; 3],
    /// C above.
    frame: DMat3,
    /// M above.
    constant: DMat3,
    mu: f64,
    /// From the frame after the joint to the point where the axes meet.
    pub(crate) centre: DVec3,
}

impl Ball {
    /// The joint's rotation.
    pub fn rotation(&self, coordinates: &[f64]) -> DMat3 {
        let angles = self.joint_angles(coordinates);
        let turn = |k: usize| Pose::from_axis_rotation(self.run.turns[k].0, angles[k]).rotation;
        let [first, second] = self.run.between.map(|pose| pose.rotation);
        turn(0) * first * turn(1) * second * turn(2)
    }

    /// Arguments of its rotations, in their order.
    pub(crate) fn arguments(&self) -> [usize; 3] {
        self.run.arguments()
    }

    /// Whether a passage of the joint is inverted.
    pub(crate) fn is_inverse(&self, passage: &Passage) -> bool {
        self.is_reversed != passage.is_inverse
    }

    /// Two smooth numbers that vanish where the angles are locked; their length is |cos(b + mu)|.
    pub fn lock(&self, coordinates: &[f64]) -> DVec2 {
        let s = self.canonical_rotation(&self.rotation(coordinates));
        DVec2::new(s.x_axis.x, s.y_axis.x)
    }

    /// Whether |cos(b + mu)| is below 0.2: the angles then lose a digit of the rotation, and soon more. Without a
    /// cosine, since it is called at every step.
    pub fn is_nearly_locked(&self, coordinates: &[f64]) -> bool {
        let part = self.half_turns(coordinates);
        (part - part.round()).abs() < NEAR
    }

    /// Whether the locked pose lies between two poses, or near one of them.
    pub fn may_have_locked(&self, a: &[f64], b: &[f64]) -> bool {
        self.half_turns(a).floor() != self.half_turns(b).floor()
            || self.is_nearly_locked(a)
            || self.is_nearly_locked(b)
    }

    /// Half turns of b + mu from a locked pose.
    fn half_turns(&self, coordinates: &[f64]) -> f64 {
        (self.angle(coordinates, 1) + self.mu) / PI - 0.5
    }

    /// Sign of the determinant of the map from rates of the unknowns to the joint's angular velocity.
    pub fn orientation(&self, coordinates: &[f64]) -> i8 {
        let b = self.joint_angles(coordinates)[1] + self.mu;
        let rates: f64 = (0..3).map(|k| self.rate(k)).product();
        if rates * sin_cos(b).1 < 0.0 { -1 } else { 1 }
    }

    fn joint_angles(&self, coordinates: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.angle(coordinates, k))
    }

    fn angle(&self, coordinates: &[f64], k: usize) -> f64 {
        self.run.turns[k].2 * (self.factors[k] * coordinates[self.slots[k]] + self.offsets[k])
    }

    /// Rate of angle `k` by its unknown.
    fn rate(&self, k: usize) -> f64 {
        self.run.turns[k].2 * self.factors[k]
    }

    /// Rx(a) Ry(b + mu) Rz(c) of a rotation of the joint.
    fn canonical_rotation(&self, rotation: &DMat3) -> DMat3 {
        let back = Pose::from_axis_rotation(1, self.mu).rotation;
        self.frame.transpose() * *rotation * self.constant.transpose() * self.frame * back
    }

    /// Writes the unknowns that give `rotation` into `coordinates`: of all triples the one nearest to the present
    /// values.
    pub(crate) fn read(&self, rotation: &DMat3, coordinates: &mut [f64]) {
        let s = self.canonical_rotation(rotation);
        let before = self.joint_angles(coordinates);
        let locked = DVec2::new(s.x_axis.x, s.y_axis.x).length() < UNREADABLE;
        let last = if locked {
            before[2]
        } else {
            libm::atan2(-s.y_axis.x, s.x_axis.x)
        };
        let triple = |c: f64| {
            let (sin, cos) = sin_cos(c);
            // Columns of S Rz(-c) = Rx(a) Ry(b + mu).
            let (x, y) = (
                s.x_axis * cos - s.y_axis * sin,
                s.x_axis * sin + s.y_axis * cos,
            );
            let found = [
                libm::atan2(y.z, y.y),
                libm::atan2(s.z_axis.x, x.x) - self.mu,
                c,
            ];
            let near = |k: usize| found[k] - TAU * ((found[k] - before[k]) / TAU).round();
            [near(0), near(1), near(2)]
        };
        let far = |angles: &[f64; 3]| -> f64 {
            angles.iter().zip(&before).map(|(a, b)| (a - b).abs()).sum()
        };
        let (one, other) = (triple(last), triple(last + PI));
        let nearest = if !locked && far(&other) < far(&one) {
            other
        } else {
            one
        };
        self.write(nearest, coordinates);
    }

    /// Writes the other unknowns that give the same rotation into `coordinates`: every rotation has two triples of
    /// angles.
    pub(crate) fn rename(&self, coordinates: &mut [f64]) {
        let [a, b, c] = self.joint_angles(coordinates);
        self.write([a + PI, PI - b - 2.0 * self.mu, c + PI], coordinates);
    }

    /// Writes the unknowns that are these angles.
    fn write(&self, angles: [f64; 3], coordinates: &mut [f64]) {
        for k in 0..3 {
            let argument = self.run.turns[k].2 * angles[k];
            coordinates[self.slots[k]] = (argument - self.offsets[k]) / self.factors[k];
        }
    }

    /// Rates of the unknowns for an angular velocity in the frame before the joint; the first and the last are NaN
    /// where the angles are locked.
    pub(crate) fn rates(&self, coordinates: &[f64], turn: DVec3) -> [f64; 3] {
        let [a, b, _] = self.joint_angles(coordinates);
        let w = Pose::from_axis_rotation(0, -a).rotation * (self.frame.transpose() * turn);
        let (sin, cos) = sin_cos(b + self.mu);
        // The third angle's rate has the pole of gimbal lock.
        let last = if cos.abs() < LOCKED {
            f64::NAN
        } else {
            w.z / cos
        };
        let found = [w.x - last * sin, w.y, last];
        [0, 1, 2].map(|k| found[k] / self.rate(k))
    }
}

/// All ball joints of the loops, in the order in which loops pass them.
pub fn ball_joints(mechanism: &Mechanism, structure: &Structure) -> Vec<Ball> {
    let mut list: Vec<Ball> = Vec::new();
    let passages = mechanism.joints.along_loops.iter();
    for (item, passages) in mechanism.loops.iter().zip(passages) {
        for passage in passages {
            let kind = mechanism.joints.list[passage.joint].kind;
            if kind != JointKind::Spherical || list.iter().any(|b| b.joint == passage.joint) {
                continue;
            }
            let run = RotationRun::of(&item.chain.steps[passage.steps.clone()]);
            list.extend(run.and_then(|run| ball_of(mechanism, structure, run, passage, item.size)));
        }
    }
    list
}

/// The ball joint of `run` as it appears in a loop's `passage`.
fn ball_of(
    mechanism: &Mechanism,
    structure: &Structure,
    run: RotationRun,
    passage: &Passage,
    size: f64,
) -> Option<Ball> {
    let mut slots = [0; 3];
    let (mut factors, mut offsets) = ([0.0; 3], [0.0; 3]);
    // Every angle must be one unknown times a factor, plus a constant.
    for (k, argument) in run.arguments().into_iter().enumerate() {
        let Argument::Affine(affine) = &mechanism.arguments[argument] else {
            return None;
        };
        let [(slot, factor)] = affine.terms[..] else {
            return None;
        };
        (slots[k], factors[k], offsets[k]) = (slot, factor.number(), affine.constant.number());
    }
    // All three unknowns belong to one block, which can be solved in the rotation instead.
    let of_slot = |slot: &usize| {
        let mut blocks = structure.blocks.iter();
        blocks.position(|b| b.unknowns.contains(slot))
    };
    let block = of_slot(&slots[0])?;
    let is_whole = slots.iter().all(|slot| of_slot(slot) == Some(block));
    let axes = axes_of(&run)?;
    let ball = Ball {
        slots,
        block,
        joint: passage.joint,
        is_reversed: passage.is_inverse,
        factors,
        offsets,
        frame: axes.frame,
        constant: run.between[0].rotation * run.between[1].rotation,
        mu: axes.mu,
        centre: ball_centre(&run, size)?,
        run,
    };
    (is_whole && is_spelled_alike(mechanism, &ball, size)).then_some(ball)
}

/// Whether all loops have the joint with the same constants between its rotations: small rotations after it in one loop
/// can then be used in all.
fn is_spelled_alike(mechanism: &Mechanism, ball: &Ball, size: f64) -> bool {
    let loops = mechanism.loops.iter().zip(&mechanism.joints.along_loops);
    let mut own = loops.flat_map(|(item, passages)| {
        let own = passages.iter().filter(|p| p.joint == ball.joint);
        own.map(|p| (p, &item.chain.steps[p.steps.clone()]))
    });
    own.all(|(passage, steps)| {
        RotationRun::of(steps).is_some_and(|run| {
            let run = match ball.is_inverse(passage) {
                true => run.inverse(),
                false => run,
            };
            run.is(&ball.run, size)
        })
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::model::chain::{ChainStep, ElementaryMotion};
    use std::f64::consts::FRAC_PI_2;

    /// A joint with constants between its rotations, which may be the identity.
    fn ball(axes: [usize; 3], signs: [f64; 3], between: [Pose; 2]) -> Ball {
        let turn = |k: usize| ChainStep::Joint {
            motion: ElementaryMotion::Rotation,
            axis: axes[k],
            argument: k,
            sign: signs[k],
        };
        let steps = [
            turn(0),
            ChainStep::Fixed(between[0].into()),
            turn(1),
            ChainStep::Fixed(between[1].into()),
            turn(2),
        ];
        let run = RotationRun::of(&steps).unwrap();
        let found = axes_of(&run).unwrap();
        Ball {
            slots: [0, 1, 2],
            block: 0,
            joint: 0,
            is_reversed: false,
            factors: [1.0, 1.0, -2.0],
            offsets: [0.1, 0.0, -0.3],
            frame: found.frame,
            constant: between[0].rotation * between[1].rotation,
            mu: found.mu,
            centre: ball_centre(&run, 1.0).unwrap(),
            run,
        }
    }

    /// Orders of axes with constants that keep neighbours at right angles.
    fn orders() -> Vec<([usize; 3], [Pose; 2])> {
        let turn = |axis, degrees: f64| Pose::from_axis_rotation(axis, degrees.to_radians());
        let plain = [
            [0, 1, 2],
            [2, 1, 0],
            [1, 2, 0],
            [2, 0, 2],
            [0, 1, 0],
            [1, 0, 2],
        ];
        let mut list: Vec<_> = plain.map(|axes| (axes, [Pose::IDENTITY; 2])).to_vec();
        list.push(([2, 2, 2], [turn(0, 90.0), turn(0, -90.0)]));
        list.push(([0, 0, 2], [turn(1, 90.0), Pose::IDENTITY]));
        list.push(([0, 1, 2], [turn(0, 30.0), turn(1, -70.0)]));
        list.push(([0, 1, 2], [turn(1, 25.0), turn(2, 40.0)]));
        list
    }

    fn difference(a: &DMat3, b: &DMat3) -> f64 {
        (*a - *b)
            .to_cols_array()
            .iter()
            .fold(0.0, |m, v| m.max(v.abs()))
    }

    #[test]
    fn angles_are_read_back_for_all_orders_of_axes_locked_or_not() {
        for (axes, between) in orders() {
            for signs in [[1.0; 3], [1.0, -1.0, 1.0], [-1.0; 3]] {
                let ball = ball(axes, signs, between);
                for near_lock in [1.0, 1e-3, 1e-9, 1e-15, 0.0, -1e-9, -0.5] {
                    let middle = signs[1] * (FRAC_PI_2 - ball.mu - near_lock);
                    let truth = [0.7, middle, -2.0];
                    let rotation = ball.rotation(&truth);
                    assert!((ball.lock(&truth).length() - near_lock.sin().abs()).abs() < 1e-15);
                    assert_eq!(ball.is_nearly_locked(&truth), near_lock.sin().abs() < 0.2);
                    let beyond = [0.0, signs[1] * (FRAC_PI_2 - ball.mu + 1.0), 0.0];
                    assert_eq!(ball.may_have_locked(&truth, &beyond), near_lock >= -0.2);
                    // From nearby the same angles come back; from anywhere the same rotation.
                    let mut found = truth.map(|v| v + 1e-3);
                    ball.read(&rotation, &mut found);
                    if near_lock.abs() > 2e-3 {
                        for k in 0..3 {
                            assert!((found[k] - truth[k]).abs() < 1e-12, "{axes:?} {found:?}");
                        }
                    }
                    assert!(difference(&ball.rotation(&found), &rotation) < 5e-15);
                    let mut other = truth;
                    ball.rename(&mut other);
                    assert!(difference(&ball.rotation(&other), &rotation) < 5e-15);
                    assert!((other[2] - truth[2]).abs() > 1.0);
                    let mut far = [9.0, -4.0, 2.5];
                    ball.read(&rotation, &mut far);
                    assert!(difference(&ball.rotation(&far), &rotation) < 5e-15);
                }
            }
        }
    }

    #[test]
    fn rates_of_angles_follow_the_angular_velocity() {
        for (axes, between) in orders() {
            let ball = ball(axes, [1.0, -1.0, 1.0], between);
            let (q, rates) = ([0.4, 0.3, -1.1], [0.5, -0.2, 0.9]);
            let h = 1e-6;
            let at = |s: f64| {
                let moved = [0, 1, 2].map(|k| q[k] + s * rates[k]);
                ball.rotation(&moved)
            };
            let spin = (at(h) - at(-h)) * (0.5 / h) * at(0.0).transpose();
            let turn = DVec3::new(spin.y_axis.z, spin.z_axis.x, spin.x_axis.y);
            let found = ball.rates(&q, turn);
            for k in 0..3 {
                assert!((found[k] - rates[k]).abs() < 1e-8, "{axes:?} {found:?}");
            }
        }
    }
}
