//! How far the points of one body move as seen from another one, around an instant of a stretch of time.

use crate::kinematics::certificate::tube::Model;
use crate::math::Pose;
use crate::model::chain::{ArgumentValue, Chain, Motion, Step, turn_about};
use glam::DVec3;

/// The chain from one body to another, without what both have in common.
#[derive(Clone, Debug)]
pub struct RelativeChain {
    steps: Vec<Step>,
}

/// Motion of a body as seen from another one, from the middle of a short time to its ends: a rigid velocity times
/// -1 ≤ u ≤ 1, and a bound of everything else.
#[derive(Clone, Copy, Debug)]
pub struct RelativeMove {
    /// `a_from_b` in the middle.
    pub pose: Pose,
    /// Velocity of the point of b at a's origin, in a's frame.
    pub shift: DVec3,
    /// Angular velocity in a's frame.
    pub spin: DVec3,
    /// What every point may deviate by ...
    off: f64,
    /// ... and what comes to it for each unit of length from b's origin.
    off_by_reach: f64,
}

impl RelativeMove {
    /// Nothing of a ball of b (centre and radius in b's frame) deviates from the rigid velocity by more.
    pub fn deviation(&self, (center, radius): (DVec3, f64)) -> f64 {
        let by_reach = if self.off_by_reach == 0.0 {
            0.0
        } else {
            self.off_by_reach * (center.length() + radius)
        };
        (self.off + by_reach) * (1.0 + 1e-12)
    }

    /// What the bounds of the arguments alone let the points of a ball deviate by, however short the time.
    pub fn blur(chain: &RelativeChain, arguments: &[Model], ball: (DVec3, f64)) -> f64 {
        let mut blur = 0.0;
        let mut reach = ball.0.length() + ball.1;
        for step in chain.steps.iter().rev() {
            match *step {
                Step::Fixed(pose) => reach += pose.translation.length(),
                Step::Joint {
                    motion, argument, ..
                } => {
                    let model = &arguments[argument];
                    match motion {
                        Motion::Rotation if model.rest > 0.0 => blur += reach * model.rest,
                        Motion::Rotation => {}
                        Motion::Translation => {
                            blur += model.rest;
                            reach += model.size();
                        }
                    }
                }
            }
        }
        blur
    }

    /// No point of a ball of b moves farther.
    pub fn distance(&self, ball: (DVec3, f64)) -> f64 {
        let center = self.pose.transform_point(ball.0);
        let turn = if self.spin == DVec3::ZERO {
            0.0
        } else {
            self.spin.length() * ball.1
        };
        let linear = (self.shift + self.spin.cross(center)).length() + turn;
        linear * (1.0 + 1e-12) + self.deviation(ball)
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

    /// The motion no farther than `half` from the place `s` of a stretch.
    ///
    /// With `wayᵢ` the linear change of joint i, `offᵢ` the rest of it and `playᵢ` both, a point x of b moves by
    /// Σ ∂ᵢx wayᵢ u to within Σ |∂ᵢx| offᵢ + ½ Σ |∂ᵢⱼx| playᵢ playⱼ; no derivative is larger than the reach from the later
    /// joint to the point.
    pub fn around(&self, arguments: &[Model], s: f64, half: f64) -> RelativeMove {
        let mut moved = RelativeMove {
            pose: Pose::IDENTITY,
            shift: DVec3::ZERO,
            spin: DVec3::ZERO,
            off: 0.0,
            off_by_reach: 0.0,
        };
        // Turns of the joints before, and the length from the first joint of all to here.
        let (mut turned, mut length) = (0.0, 0.0);
        // A joint's reach is the whole length less that before it.
        let mut off_by_length = 0.0;
        for step in &self.steps {
            let Step::Joint {
                motion,
                axis,
                argument,
                sign,
            } = *step
            else {
                if let Step::Fixed(pose) = step {
                    length += pose.translation.length();
                    moved.pose = moved.pose * *pose;
                }
                continue;
            };
            let around = arguments[argument].around(s, half);
            let play = around.way.abs() + around.off;
            let direction = moved.pose.rotation.col(axis) * (sign * around.way);
            match motion {
                Motion::Rotation => {
                    moved.spin += direction;
                    moved.shift += moved.pose.translation.cross(direction);
                    let off = around.off + play * (0.5 * play + turned);
                    moved.off_by_reach += off;
                    off_by_length += off * length;
                    turned += play;
                    let value = ArgumentValue::new(around.value);
                    turn_about(&mut moved.pose, axis, sign * value.sin, value.cos);
                }
                Motion::Translation => {
                    moved.shift += direction;
                    moved.off += around.off + turned * play;
                    length += around.value.abs() + play;
                    moved.pose.translation += moved.pose.rotation.col(axis) * (sign * around.value);
                }
            }
        }
        moved.off += (moved.off_by_reach * length - off_by_length).max(0.0)
            + 1e-12 * moved.off_by_reach * length;
        moved
    }
}
