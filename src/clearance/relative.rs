//! How fast the points of one body can move as seen from another one, over a stretch of time.

use super::motion::Span;
use crate::kinematics::certificate::flow::Drift;
use crate::math::Pose;
use crate::model::chain::{ArgumentValue, Chain, Motion, Step};
use glam::DVec3;

/// The chain from one body to another, without what both have in common.
#[derive(Clone, Debug)]
pub struct RelativeChain {
    steps: Vec<Step>,
}

struct Joint {
    motion: Motion,
    argument: usize,
    axis: DVec3,
    origin: DVec3,
    reach: f64,
}

/// Motion of a ball of points as seen from the other body, over a stretch.
#[derive(Clone, Copy, Debug)]
pub struct RelativeSpeed {
    /// Velocity of the ball's centre in the middle of the stretch, in the other body's frame.
    pub velocity: DVec3,
    /// Angular velocity then.
    pub spin: DVec3,
    /// Radius of the ball.
    pub radius: f64,
    /// No point's velocity ever differs by more from what these say.
    pub deviation: f64,
}

impl RelativeSpeed {
    /// Largest speed of any point.
    pub fn speed(&self) -> f64 {
        self.velocity.length() + self.spin.length() * self.radius + self.deviation
    }

    /// Largest speed of any point along the fixed direction `n`.
    pub fn along(&self, n: DVec3) -> f64 {
        self.velocity.dot(n).abs() + n.cross(self.spin).length() * self.radius + self.deviation
    }
}

impl RelativeChain {
    /// The chain whose product is `a_from_b`.
    pub fn new(world_from_a: &Chain, world_from_b: &Chain) -> Self {
        let both = world_from_a.steps.iter().zip(&world_from_b.steps);
        let common = both.take_while(|(a, b)| a == b).count();
        let back = world_from_a.steps[common..].iter().rev().map(Step::inverse);
        let forth = world_from_b.steps[common..].iter().copied();
        Self {
            steps: back.chain(forth).collect(),
        }
    }

    /// The pose `a_from_b`.
    pub fn pose(&self, arguments: &[ArgumentValue]) -> Pose {
        let mut pose = Pose::IDENTITY;
        self.steps
            .iter()
            .for_each(|step| step.advance(&mut pose, arguments));
        pose
    }

    /// Bounds of the motion of a ball of points of b (centre in b's frame and radius) around a stretch's middle pose.
    pub fn speed(
        &self,
        span: &Span,
        arguments: &[ArgumentValue],
        (center, radius): (DVec3, f64),
    ) -> RelativeSpeed {
        let mut pose = Pose::IDENTITY;
        let mut joints = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            if let Step::Joint {
                motion,
                axis,
                argument,
                sign,
            } = *step
            {
                joints.push(Joint {
                    motion,
                    argument,
                    axis: pose.rotation.col(axis) * sign,
                    origin: pose.translation,
                    reach: 0.0,
                });
            }
            step.advance(&mut pose, arguments);
        }
        self.fill_reaches(span, arguments, center.length() + radius, &mut joints);
        let middle = pose.transform_point(center);
        let mut speed = RelativeSpeed {
            velocity: DVec3::ZERO,
            spin: DVec3::ZERO,
            radius,
            deviation: 0.0,
        };
        // Turns by which joints before this one can have changed, and their speeds.
        let (mut turned, mut turning) = (0.0, 0.0);
        for joint in &joints {
            let drift: &Drift = &span.arguments[joint.argument];
            let (play, rate) = (drift.play, drift.speed());
            match joint.motion {
                Motion::Rotation => {
                    speed.spin += joint.axis * drift.rate;
                    speed.velocity += joint.axis.cross(middle - joint.origin) * drift.rate;
                    let bend = play * rate + play * turning + turned * rate;
                    speed.deviation += joint.reach * (drift.deviation + bend);
                    turned += play;
                    turning += rate;
                }
                Motion::Translation => {
                    speed.velocity += joint.axis * drift.rate;
                    speed.deviation += drift.deviation + turned * rate + turning * play;
                }
            }
        }
        speed
    }

    /// No point of the ball is ever farther from a joint than its reach.
    fn fill_reaches(
        &self,
        span: &Span,
        arguments: &[ArgumentValue],
        end: f64,
        joints: &mut [Joint],
    ) {
        let mut reach = end;
        let mut next = joints.len();
        for step in self.steps.iter().rev() {
            match step {
                Step::Fixed(pose) => reach += pose.translation.length(),
                Step::Joint {
                    motion, argument, ..
                } => {
                    next -= 1;
                    joints[next].reach = reach;
                    if *motion == Motion::Translation {
                        reach += arguments[*argument].value.abs() + span.arguments[*argument].play;
                    }
                }
            }
        }
    }
}
