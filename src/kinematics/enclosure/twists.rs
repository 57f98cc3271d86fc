//! The derivatives of a chain's product by its joints, in any arithmetic: every joint's axis and origin are recorded.
//!
//! Translations between two rotations are summed before they are rotated, and positions are relative to a base point
//! near the joints: otherwise, in a chain that goes a long way out and back, an enclosure of its rotation would be
//! multiplied by the whole distance.

use crate::model::chain::{ArgumentValue, ChainJoint, ChainStep, ElementaryMotion};
use crate::model::fixed::FixedPose;
use crate::model::walk::{Carried, Triple, WalkFrame, add_vectors, walk_chain};
use crate::numbers::constant::Constant;
use crate::numbers::scalar::{Scalar, Sign};
use glam::DMat3;

/// A joint on the way along a chain.
#[derive(Clone, Copy, Debug)]
struct Noted<S> {
    joint: ChainJoint,
    axis: Triple<S>,
    origin: Triple<S>,
}

/// A frame, and the translations along its axes since its last rotation.
struct Gathered<S> {
    frame: WalkFrame<S>,
    shift: Triple<S>,
    /// Where it was at each rotation.
    origins: Vec<Triple<S>>,
}

impl<S: Scalar> Gathered<S> {
    /// The start of a chain that is expressed about a point.
    fn from_point(about: [f64; 3]) -> Self {
        Self {
            frame: WalkFrame::identity(),
            shift: about.map(|c| S::number(-c)),
            origins: Vec::new(),
        }
    }

    /// Where it ends.
    fn back_to(mut self, about: [f64; 3]) -> WalkFrame<S> {
        self.move_by(about.map(S::number));
        self.gather_shifts();
        self.frame
    }

    /// Where it is.
    fn place(&self) -> Triple<S> {
        let moved = |k: usize| self.frame.axes[k].map(|c| c * self.shift[k]);
        let along = [0, 1, 2].map(moved);
        along.into_iter().fold(self.frame.origin, add_vectors)
    }

    /// Rotates the accumulated translations before the frame itself.
    fn gather_shifts(&mut self) {
        self.frame.origin = self.place();
        self.shift = [S::number(0.0); 3];
    }

    fn move_by(&mut self, by: Triple<S>) {
        self.shift = add_vectors(self.shift, by);
    }
}

impl<S: Scalar> Carried for Gathered<S> {
    type Argument = ArgumentValue<S>;

    fn fix(&mut self, fixed: &FixedPose) {
        if fixed.rotation == DMat3::IDENTITY {
            let meant = |v| S::from_constant(Constant::within(v, fixed.error.translation));
            self.move_by(fixed.translation.to_array().map(meant));
        } else {
            self.gather_shifts();
            self.frame.fix(fixed);
        }
    }

    fn shift(&mut self, axis: usize, sign: f64, by: &Self::Argument) {
        self.shift[axis] = self.shift[axis] + by.value.scale(sign);
    }

    fn turn(&mut self, axis: usize, sign: f64, by: &Self::Argument) {
        self.gather_shifts();
        self.origins.push(self.frame.origin);
        self.frame.turn(axis, sign, by);
    }
}

/// A chain at a pose: its end frame and the twists of its joints there.
#[derive(Clone, Debug)]
pub struct ChainTwists<S> {
    /// The frame at the end.
    pub end: WalkFrame<S>,
    joints: Vec<Noted<S>>,
    /// Trace of the rotation.
    trace: S,
}

impl<S: Scalar> ChainTwists<S> {
    /// Traverses a chain; arguments are those of the whole mechanism. A chain expressed `about` a point lies between a
    /// translation to that point and one back: it closes if the chain itself does.
    pub fn new(steps: &[ChainStep], arguments: &[ArgumentValue<S>], about: [f64; 3]) -> Self {
        let mut way = Gathered::from_point(about);
        let mut joints = Vec::with_capacity(steps.len());
        walk_chain(steps, &mut way, arguments, |way: &Gathered<S>, joint| {
            joints.push(Noted {
                joint,
                axis: way.frame.axes[joint.axis].map(|c| c.scale(joint.sign)),
                // That of a translation is irrelevant; those of rotations follow.
                origin: way.frame.origin,
            });
        });
        let is_turn = |noted: &&mut Noted<S>| noted.joint.motion == ElementaryMotion::Rotation;
        let turns = joints.iter_mut().filter(is_turn);
        turns
            .zip(&way.origins)
            .for_each(|(noted, origin)| noted.origin = *origin);
        let end = way.back_to(about);
        let trace = end.axes[0][0] + end.axes[1][1] + end.axes[2][2];
        Self { end, joints, trace }
    }

    /// The residual of a loop.
    pub fn residual(&self, component: usize, per_size: f64) -> S {
        residual_component(&self.end, component, per_size)
    }

    /// Calls `take` with the argument of every joint and the derivative of the residual by it.
    pub fn columns(&self, per_size: f64, mut take: impl FnMut(usize, [S; 6])) {
        let zero = S::number(0.0);
        for Noted {
            joint,
            axis,
            origin,
        } in &self.joints
        {
            // A translation moves the end along its axis; a rotation rotates it and moves it perpendicular to the arm.
            let [turn, shift] = match joint.motion {
                ElementaryMotion::Translation => [[zero; 3], axis.map(|c| c.scale(per_size))],
                ElementaryMotion::Rotation => {
                    let arm = vector_difference(self.end.origin, *origin);
                    let shift = cross_product(*axis, arm).map(|c| c.scale(per_size));
                    [self.skew_rate(*axis), shift]
                }
            };
            let [a, b, c] = turn;
            let [d, e, f] = shift;
            take(joint.argument, [a, b, c, d, e, f]);
        }
    }

    /// Origins of all rotations on the way.
    pub fn rotation_origins(&self) -> impl Iterator<Item = Triple<S>> + '_ {
        let turns = |noted: &&Noted<S>| noted.joint.motion == ElementaryMotion::Rotation;
        self.joints.iter().filter(turns).map(|noted| noted.origin)
    }

    /// Calls `take` with the argument of every joint and the velocity of a point carried by the chain's end.
    pub fn velocities(&self, point: Triple<S>, mut take: impl FnMut(usize, Triple<S>)) {
        for noted in &self.joints {
            let velocity = match noted.joint.motion {
                ElementaryMotion::Translation => noted.axis,
                ElementaryMotion::Rotation => {
                    cross_product(noted.axis, vector_difference(point, noted.origin))
                }
            };
            take(noted.joint.argument, velocity);
        }
    }

    /// Rate of the skew part ½ Σ eⱼ × (a × rⱼ) = ½ (tr R a - R a) of a rotation matrix R with columns r, for a rotation
    /// about a.
    fn skew_rate(&self, a: Triple<S>) -> Triple<S> {
        let axes = &self.end.axes;
        [0, 1, 2].map(|k| {
            let (plus, minus) = (Sign::Plus, Sign::Minus);
            S::signed_products([
                (plus, self.trace, a[k]),
                (minus, axes[0][k], a[0]),
                (minus, axes[1][k], a[1]),
                (minus, axes[2][k], a[2]),
            ])
            .scale(0.5)
        })
    }
}

/// The residual of a loop that ends so: the skew part of the rotation, then the translation over the loop's size.
pub fn residual_component<S: Scalar>(end: &WalkFrame<S>, component: usize, per_size: f64) -> S {
    if component >= 3 {
        return end.origin[component - 3].scale(per_size);
    }
    let (i, j) = ((component + 1) % 3, (component + 2) % 3);
    (end.axes[i][j] - end.axes[j][i]).scale(0.5)
}

/// The end of a chain expressed `about` a point.
pub fn frame_about<S: Scalar>(
    steps: &[ChainStep],
    arguments: &[ArgumentValue<S>],
    about: [f64; 3],
) -> WalkFrame<S> {
    let mut way = Gathered::from_point(about);
    walk_chain(steps, &mut way, arguments, |_, _| {});
    way.back_to(about)
}

fn cross_product<S: Scalar>(a: Triple<S>, b: Triple<S>) -> Triple<S> {
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        S::signed_products([(Sign::Plus, a[i], b[j]), (Sign::Minus, a[j], b[i])])
    })
}

fn vector_difference<S: Scalar>(a: Triple<S>, b: Triple<S>) -> Triple<S> {
    [0, 1, 2].map(|k| a[k] - b[k])
}
