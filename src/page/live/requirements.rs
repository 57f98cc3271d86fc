//! The options for every motion of a live page: those of the command line.

use crate::clearance::check::ClearanceEffort;
use crate::kinematics::motion::sampling::{even_times, frame_times};
use crate::kinematics::structure::system::System;
use crate::report::motion_check::MotionCheck;
use crate::report::verdict::CheckRequirements;
use crate::scene::Scene;
use serde_json::{Value, json};

/// The options for a motion.
#[derive(Clone, Copy, Debug)]
pub struct LiveRequirements {
    /// What must be so.
    pub asked: CheckRequirements,
    /// Requested accuracy of the bounds of distances.
    pub closely: ClearanceEffort,
    /// Samples, spread evenly; the scene's frames if absent.
    pub samples: Option<usize>,
}

impl LiveRequirements {
    /// As stored in the page.
    pub fn json(&self) -> Value {
        let CheckRequirements {
            closure,
            poses,
            motion,
            estimates,
            empty,
            band,
        } = self.asked;
        json!({
            "closure": closure, "poses": poses, "motion": motion, "estimates": estimates, "empty": empty, "band": band,
            "tolerance": self.closely.tolerance, "pairs": self.closely.pairs, "samples": self.samples,
        })
    }

    /// From the data stored in a page; missing ones have the defaults of `check`.
    pub(super) fn read(kept: &Value) -> Self {
        let is = |name: &str, usual: bool| kept[name].as_bool().unwrap_or(usual);
        let number = |name: &str| kept[name].as_f64();
        let count = |name: &str| kept[name].as_u64().map(|n| n as usize);
        Self {
            asked: CheckRequirements {
                closure: number("closure").unwrap_or(CheckRequirements::CLOSURE),
                poses: is("poses", true),
                motion: is("motion", false),
                estimates: is("estimates", false),
                empty: is("empty", false),
                band: number("band"),
            },
            closely: ClearanceEffort {
                tolerance: number("tolerance").unwrap_or(ClearanceEffort::TOLERANCE),
                pairs: count("pairs").unwrap_or(ClearanceEffort::PAIRS),
                times: true,
            },
            samples: count("samples"),
        }
    }

    /// Seconds at which the motion of a scene is judged.
    pub(super) fn times(&self, scene: &Scene) -> Vec<f64> {
        match self.samples {
            Some(count) => even_times(&scene.mechanism, &scene.actuation, count),
            None => frame_times(&scene.mechanism, &scene.actuation, scene.view.fps),
        }
    }

    /// The check of a scene at these times.
    pub(super) fn check<'a>(
        &self,
        scene: &'a Scene,
        system: &'a System,
        times: &'a [f64],
    ) -> MotionCheck<'a> {
        MotionCheck {
            scene,
            system,
            times,
            asked: self.asked,
            closely: self.closely,
            is_swept: false,
            worst: 0,
        }
    }
}
