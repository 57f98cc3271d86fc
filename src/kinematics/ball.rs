//! Ball joints written as three rotations in a row: which they are, and their angles from their rotation.
//!
//! Where the middle angle makes the first and the last axis parallel, the three angles are no coordinates of a
//! rotation any more, though nothing is wrong with the joint: they are gimbal-locked. What is solved instead next to
//! such poses is in `chart`.
//!
//! With C = [u1, u2, u1 × u2] for the axes u1, u2 of the first two rotations, and the third axis turned by mu from
//! u1 × u2 about u2, every such joint is C Rx(a) Ry(b + mu) Rz(c) Ry(-mu) Cᵀ: one formula serves all orders of axes.
//! It is locked where cos(b + mu) = 0; only a + c or a - c is determined there.
//!
//! Three rotations count as a ball joint if they stand side by side wherever they are used, are unknowns of their own,
//! and no body belongs to a link between them: a body there would show the single angles.

use super::structure::Structure;
use crate::math::{Pose, sin_cos};
use crate::model::chain::{Argument, Chain, Motion, Step};
use crate::model::mechanism::Mechanism;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Distance from a locked pose, in half turns, at which |cos(b + mu)| is 0.2.
const NEAR: f64 = 0.064_094_216_849;

/// Below this |cos(b + mu)| the last angle is kept and not read: the first then carries an error of this size in
/// radians at most, no more than rounding of a long chain.
const UNREADABLE: f64 = 4e-15;

/// A ball joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Ball {
    /// Its three unknowns, in the order of the rotations.
    pub slots: [usize; 3],
    /// Block that solves them.
    pub block: usize,
    pub(super) arguments: [usize; 3],
    axes: [usize; 3],
    signs: [f64; 3],
    /// Added to the unknowns before they are angles.
    offsets: [f64; 3],
    /// C above.
    frame: DMat3,
    mu: f64,
}

impl Ball {
    /// The joint's rotation.
    pub fn rotation(&self, coordinates: &[f64]) -> DMat3 {
        let angles = self.angles(coordinates);
        let turn = |k: usize| Pose::from_axis_rotation(self.axes[k], angles[k]).rotation;
        turn(0) * turn(1) * turn(2)
    }

    /// Two smooth numbers that vanish where the angles are locked; their length is |cos(b + mu)|.
    pub fn lock(&self, coordinates: &[f64]) -> DVec2 {
        let s = self.canonical(&self.rotation(coordinates));
        DVec2::new(s.x_axis.x, s.y_axis.x)
    }

    /// Whether |cos(b + mu)| is below 0.2: the angles then lose a digit of the rotation, and soon more. Needs no cosine,
    /// since it is asked at every step.
    pub fn is_nearly_locked(&self, coordinates: &[f64]) -> bool {
        let part = self.half_turns(coordinates);
        (part - part.round()).abs() < NEAR
    }

    /// Whether the locked pose lies between two poses, or one of them is near it.
    pub fn may_have_locked(&self, a: &[f64], b: &[f64]) -> bool {
        self.half_turns(a).floor() != self.half_turns(b).floor()
            || self.is_nearly_locked(a)
            || self.is_nearly_locked(b)
    }

    /// Half turns of b + mu from a locked pose.
    fn half_turns(&self, coordinates: &[f64]) -> f64 {
        let b = self.signs[1] * (coordinates[self.slots[1]] + self.offsets[1]);
        (b + self.mu) / PI - 0.5
    }

    /// Sign of the determinant of the map from rates of the unknowns to the joint's angular velocity.
    pub fn orientation(&self, coordinates: &[f64]) -> i8 {
        let b = self.angles(coordinates)[1] + self.mu;
        let signs: f64 = self.signs.iter().product();
        if signs * sin_cos(b).1 < 0.0 { -1 } else { 1 }
    }

    fn angles(&self, coordinates: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.signs[k] * (coordinates[self.slots[k]] + self.offsets[k]))
    }

    /// Rx(a) Ry(b + mu) Rz(c) of a rotation of the joint.
    fn canonical(&self, rotation: &DMat3) -> DMat3 {
        let back = Pose::from_axis_rotation(1, self.mu).rotation;
        self.frame.transpose() * *rotation * self.frame * back
    }

    /// Writes the unknowns that give `rotation` into `coordinates`: of all triples the one nearest to those that
    /// stand there.
    pub(super) fn read(&self, rotation: &DMat3, coordinates: &mut [f64]) {
        let s = self.canonical(rotation);
        let before = self.angles(coordinates);
        let locked = DVec2::new(s.x_axis.x, s.y_axis.x).length() < UNREADABLE;
        let last = if locked {
            before[2]
        } else {
            (-s.y_axis.x).atan2(s.x_axis.x)
        };
        let triple = |c: f64| {
            let (sin, cos) = sin_cos(c);
            // Columns of S Rz(-c) = Rx(a) Ry(b + mu).
            let (x, y) = (
                s.x_axis * cos - s.y_axis * sin,
                s.x_axis * sin + s.y_axis * cos,
            );
            let found = [y.z.atan2(y.y), s.z_axis.x.atan2(x.x) - self.mu, c];
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
        for k in 0..3 {
            coordinates[self.slots[k]] = self.signs[k] * nearest[k] - self.offsets[k];
        }
    }

    /// Rates of the unknowns for an angular velocity in the frame before the joint; the first and the last are NaN
    /// where the angles are locked.
    pub(super) fn rates(&self, coordinates: &[f64], turn: DVec3) -> [f64; 3] {
        let [a, b, _] = self.angles(coordinates);
        let w = Pose::from_axis_rotation(0, -a).rotation * (self.frame.transpose() * turn);
        let (sin, cos) = sin_cos(b + self.mu);
        let last = if cos.abs() < 1e-9 {
            f64::NAN
        } else {
            w.z / cos
        };
        let found = [w.x - last * sin, w.y, last];
        [0, 1, 2].map(|k| self.signs[k] * found[k])
    }
}

/// Axis, argument and sign of a rotation.
fn rotation_of(step: &Step) -> Option<(usize, usize, f64)> {
    match *step {
        Step::Joint {
            motion: Motion::Rotation,
            axis,
            argument,
            sign,
        } => Some((axis, argument, sign)),
        _ => None,
    }
}

/// Whether three steps are the ball joint: as it is, or inverted.
pub(super) fn stands_at(ball: &Ball, window: &[Step]) -> Option<bool> {
    let found = [
        rotation_of(&window[0])?,
        rotation_of(&window[1])?,
        rotation_of(&window[2])?,
    ];
    let own = |k: usize, sign: f64| (ball.axes[k], ball.arguments[k], sign * ball.signs[k]);
    if found == [own(0, 1.0), own(1, 1.0), own(2, 1.0)] {
        Some(false)
    } else if found == [own(2, -1.0), own(1, -1.0), own(0, -1.0)] {
        Some(true)
    } else {
        None
    }
}

/// All ball joints of the loops.
pub fn balls(mechanism: &Mechanism, structure: &Structure) -> Vec<Ball> {
    let mut list: Vec<Ball> = Vec::new();
    for item in &mechanism.loops {
        let mut k = 0;
        while let Some(window) = item.chain.steps.get(k..k + 3) {
            k += 1;
            if list.iter().any(|ball| stands_at(ball, window).is_some()) {
                k += 2;
                continue;
            }
            let Some(ball) = ball_at(mechanism, structure, window) else {
                continue;
            };
            let taken = list
                .iter()
                .any(|b| b.slots.iter().any(|s| ball.slots.contains(s)));
            if !taken && is_alone(mechanism, &ball) {
                list.push(ball);
                k += 2;
            }
        }
    }
    list
}

fn ball_at(mechanism: &Mechanism, structure: &Structure, window: &[Step]) -> Option<Ball> {
    let found = [
        rotation_of(&window[0])?,
        rotation_of(&window[1])?,
        rotation_of(&window[2])?,
    ];
    let axes = found.map(|(axis, _, _)| axis);
    if axes[0] == axes[1] || axes[1] == axes[2] {
        return None;
    }
    let mut slots = [0; 3];
    let mut offsets = [0.0; 3];
    for (k, (_, argument, _)) in found.iter().enumerate() {
        let Argument::Affine(affine) = &mechanism.arguments[*argument] else {
            return None;
        };
        let [(slot, 1.0)] = affine.terms[..] else {
            return None;
        };
        (slots[k], offsets[k]) = (slot, affine.constant);
    }
    let block = structure
        .blocks
        .iter()
        .position(|b| b.unknowns.contains(&slots[0]))?;
    let unknowns = &structure.blocks[block].unknowns;
    let is_whole = slots.iter().all(|slot| unknowns.contains(slot));
    let differ = slots[0] != slots[1] && slots[1] != slots[2] && slots[0] != slots[2];
    let (u1, u2) = (DVec3::AXES[axes[0]], DVec3::AXES[axes[1]]);
    let third = u1.cross(u2);
    let mu = if axes[2] == axes[0] {
        FRAC_PI_2
    } else if third.dot(DVec3::AXES[axes[2]]) > 0.0 {
        0.0
    } else {
        PI
    };
    (is_whole && differ).then(|| Ball {
        slots,
        block,
        arguments: found.map(|(_, argument, _)| argument),
        axes,
        signs: found.map(|(_, _, sign)| sign),
        offsets,
        frame: DMat3::from_cols(u1, u2, third),
        mu,
    })
}

/// Whether the three unknowns are used nowhere but in this joint, and no body stands between its rotations.
fn is_alone(mechanism: &Mechanism, ball: &Ball) -> bool {
    let uses = |slots: &[usize]| slots.iter().any(|slot| ball.slots.contains(slot));
    let elsewhere = mechanism
        .arguments
        .iter()
        .enumerate()
        .any(|(k, argument)| !ball.arguments.contains(&k) && uses(&argument.coordinates()));
    let in_equations = mechanism
        .equations
        .iter()
        .any(|e| uses(&e.expression.slots()));
    let chains = mechanism.loops.iter().map(|l| &l.chain);
    let bodies = mechanism.bodies.iter().map(|b| &b.world_from_body);
    !elsewhere && !in_equations && chains.chain(bodies).all(|chain| is_whole_in(chain, ball))
}

/// Whether the joint's rotations stand in a chain only together.
fn is_whole_in(chain: &Chain, ball: &Ball) -> bool {
    let mut k = 0;
    while k < chain.steps.len() {
        let window = chain.steps.get(k..k + 3);
        if window.is_some_and(|window| stands_at(ball, window).is_some()) {
            k += 3;
            continue;
        }
        if let Step::Joint { argument, .. } = chain.steps[k]
            && ball.arguments.contains(&argument)
        {
            return false;
        }
        k += 1;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(axes: [usize; 3], signs: [f64; 3]) -> Ball {
        let window = [0, 1, 2].map(|k| Step::Joint {
            motion: Motion::Rotation,
            axis: axes[k],
            argument: k,
            sign: signs[k],
        });
        let (u1, u2) = (DVec3::AXES[axes[0]], DVec3::AXES[axes[1]]);
        let third = u1.cross(u2);
        let mu = match axes[2] {
            last if last == axes[0] => FRAC_PI_2,
            last if third.dot(DVec3::AXES[last]) > 0.0 => 0.0,
            _ => PI,
        };
        let ball = Ball {
            slots: [0, 1, 2],
            block: 0,
            arguments: [0, 1, 2],
            axes,
            signs,
            offsets: [0.1, 0.0, -0.3],
            frame: DMat3::from_cols(u1, u2, third),
            mu,
        };
        assert_eq!(stands_at(&ball, &window), Some(false));
        ball
    }

    fn difference(a: &DMat3, b: &DMat3) -> f64 {
        (*a - *b)
            .to_cols_array()
            .iter()
            .fold(0.0, |m, v| m.max(v.abs()))
    }

    #[test]
    fn angles_are_read_back_for_all_orders_of_axes_locked_or_not() {
        for axes in [
            [0, 1, 2],
            [2, 1, 0],
            [1, 2, 0],
            [2, 0, 2],
            [0, 1, 0],
            [1, 0, 2],
        ] {
            for signs in [[1.0; 3], [1.0, -1.0, 1.0], [-1.0; 3]] {
                let ball = ball(axes, signs);
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
                    let mut far = [9.0, -4.0, 2.5];
                    ball.read(&rotation, &mut far);
                    assert!(difference(&ball.rotation(&far), &rotation) < 5e-15);
                }
            }
        }
    }

    #[test]
    fn rates_of_angles_follow_the_angular_velocity() {
        for axes in [[0, 1, 2], [2, 1, 0], [2, 0, 2]] {
            let ball = ball(axes, [1.0, -1.0, 1.0]);
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
