//! The layout of a loop for its proof: its joints, and error bounds of the constants between them.

use crate::math::Pose;
use crate::model::chain::{ChainStep, ElementaryMotion};
use crate::model::fixed::FixedPose;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::sin_cos::SinCosFactor;
use glam::DMat3;

/// A joint on the way along the loop, and the fixed pose before it.
#[derive(Clone, Debug)]
pub struct PlannedJoint {
    /// Translation before the joint, axis by axis.
    pub shift: [Option<SinCosFactor>; 3],
    /// Rotation before it.
    pub turn: Option<DMat3>,
    /// Kind of motion.
    pub motion: ElementaryMotion,
    /// Along or about which axis.
    pub axis: usize,
    /// Place of its argument.
    pub argument: usize,
    /// Factor on the argument.
    pub sign: f64,
    /// Error bounds of the fixed poses after the joint: rotation and translation.
    pub open_behind: [f64; 2],
    /// The length of their translation.
    pub length_behind: f64,
    /// The angle of their rotation.
    pub angle_behind: f64,
}

/// A loop laid out for the traversal.
#[derive(Clone, Debug, Default)]
pub struct LoopPlan {
    /// In the order of the chain.
    pub joints: Vec<PlannedJoint>,
    /// The fixed pose at the end, as a joint that does not move.
    pub end: Option<PlannedJoint>,
    /// Error bounds of the fixed pose before the first joint: rotation and translation.
    pub open_before: [f64; 2],
    /// The length of its translation.
    pub length_before: f64,
    /// The angle of its rotation.
    pub angle_before: f64,
    /// Steps of the chain.
    pub steps: usize,
}

impl LoopPlan {
    /// Lays out a chain whose arguments are renamed by `place`.
    pub fn new(steps: &[ChainStep], place: impl Fn(usize) -> usize) -> Self {
        let mut plan = Self {
            steps: steps.len(),
            ..Self::default()
        };
        let mut fixed: Option<FixedPose> = None;
        for step in steps {
            match *step {
                // Constant poses in a row are multiplied; the next joint begins with their product.
                ChainStep::Fixed(pose) => fixed = Some(fixed.map_or(pose, |f| f * pose)),
                ChainStep::Joint {
                    motion,
                    axis,
                    argument,
                    sign,
                } => {
                    let mut joint = plan.after(fixed.take());
                    joint.motion = motion;
                    joint.axis = axis;
                    joint.argument = place(argument);
                    joint.sign = sign;
                    plan.joints.push(joint);
                }
            }
        }
        if fixed.is_some() {
            plan.end = Some(plan.after(fixed));
        }
        plan
    }

    /// Places of the joints' arguments.
    pub fn arguments(&self) -> impl Iterator<Item = usize> + '_ {
        self.joints.iter().map(|joint| joint.argument)
    }

    /// A joint after a fixed pose, which is attributed to the joint before.
    fn after(&mut self, fixed: Option<FixedPose>) -> PlannedJoint {
        let pose = fixed.unwrap_or(FixedPose::exact(Pose::IDENTITY));
        let open = [pose.error.rotation, pose.error.translation];
        // The angle of the constant rotation, from its trace.
        let trace: f64 = (0..3).map(|k| pose.rotation.col(k)[k]).sum();
        let angle = libm::acos((0.5 * (trace - 1.0)).clamp(-1.0, 1.0));
        match self.joints.last_mut() {
            Some(last) => {
                last.open_behind = open;
                last.length_behind = pose.translation.length();
                last.angle_behind = angle;
            }
            None => {
                self.open_before = open;
                self.length_before = pose.translation.length();
                self.angle_before = angle;
            }
        }
        let part = |v: f64| (v != 0.0).then(|| SinCosFactor::short(DoubleDouble::from(v)));
        PlannedJoint {
            shift: pose.translation.to_array().map(part),
            turn: (pose.rotation != DMat3::IDENTITY).then_some(pose.rotation),
            motion: ElementaryMotion::Translation,
            axis: 0,
            argument: 0,
            sign: 1.0,
            open_behind: [0.0; 2],
            length_behind: 0.0,
            angle_behind: 0.0,
        }
    }
}
