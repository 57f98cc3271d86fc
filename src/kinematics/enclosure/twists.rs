//! The derivatives of a chain's product by its joints, in any arithmetic: every joint's axis and origin are noted on the way.

use crate::model::chain::{ArgumentValue, ChainJoint, ChainStep, ElementaryMotion};
use crate::model::walk::{Triple, WalkFrame, walk_chain};
use crate::numbers::scalar::Scalar;

/// A joint on the way along a chain.
#[derive(Clone, Copy, Debug)]
struct Noted<S> {
    joint: ChainJoint,
    axis: Triple<S>,
    origin: Triple<S>,
}

/// A chain at a pose: where it ends and what its joints do there.
#[derive(Clone, Debug)]
pub struct Twists<S> {
    /// The frame at the end.
    pub end: WalkFrame<S>,
    joints: Vec<Noted<S>>,
    /// Trace of the rotation.
    trace: S,
}

impl<S: Scalar> Twists<S> {
    /// Walks along a chain; arguments are those of the whole mechanism.
    pub fn new(steps: &[ChainStep], arguments: &[ArgumentValue<S>]) -> Self {
        let mut end = WalkFrame::identity();
        let mut joints = Vec::with_capacity(steps.len());
        walk_chain(steps, &mut end, arguments, |frame: &WalkFrame<S>, joint| {
            joints.push(Noted {
                joint,
                axis: frame.axes[joint.axis].map(|c| c.scale(joint.sign)),
                origin: frame.origin,
            });
        });
        let trace = end.axes[0][0] + end.axes[1][1] + end.axes[2][2];
        Self { end, joints, trace }
    }

    /// The residual of a loop: the skew part of the rotation, then the translation over the loop's size.
    pub fn residual(&self, component: usize, per_size: f64) -> S {
        if component >= 3 {
            return self.end.origin[component - 3].scale(per_size);
        }
        let (i, j) = ((component + 1) % 3, (component + 2) % 3);
        (self.end.axes[i][j] - self.end.axes[j][i]).scale(0.5)
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

    /// Calls `take` with the argument of every joint and the velocity of a point, which the chain's end carries.
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

    /// Rate of the skew part ½ Σ eⱼ × (a × rⱼ) = ½ (tr R a - R a) of a rotation R with columns r that turns about a.
    fn skew_rate(&self, a: Triple<S>) -> Triple<S> {
        let axes = &self.end.axes;
        [0, 1, 2].map(|k| {
            let turned = axes[0][k] * a[0] + axes[1][k] * a[1] + axes[2][k] * a[2];
            (self.trace * a[k] - turned).scale(0.5)
        })
    }
}

fn cross_product<S: Scalar>(a: Triple<S>, b: Triple<S>) -> Triple<S> {
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}

fn vector_difference<S: Scalar>(a: Triple<S>, b: Triple<S>) -> Triple<S> {
    [0, 1, 2].map(|k| a[k] - b[k])
}
