//! The subject of an article: a check with its scene and motion.

use crate::clearance::check::ClearanceReport;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::report::motion_check::MotionAnswer;
use crate::scene::Scene;

/// A check with its scene and motion.
#[derive(Clone, Copy)]
pub struct CheckedMotion<'a> {
    /// Where the scene is from.
    pub source: &'a str,
    /// The scene.
    pub scene: &'a Scene,
    /// Its mechanism.
    pub system: &'a System,
    /// The motion that was checked.
    pub trajectory: &'a Trajectory,
    /// The clearances, if the scene asks for some.
    pub clearances: Option<&'a ClearanceReport>,
    /// What was found.
    pub answer: &'a MotionAnswer,
}
