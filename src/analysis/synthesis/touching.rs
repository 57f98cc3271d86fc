//! Checks that bodies which are meant to touch do not penetrate: the guard of a search, which would otherwise continue
//! to mechanisms whose surfaces intersect near the contact point.

use crate::analysis::study::ParametricMechanism;
use crate::diag::Source;
use crate::distance::bodies::{BodyElements, LeftOut, nearest_bodies};
use crate::kinematics::loops::forward;
use crate::model::mechanism::Mechanism;
use crate::scene::{Overrides, load_scene};

/// Every how many poses are examined; at the end of a search all are.
const STRIDE: usize = 3;

/// Depth that counts as rounding, in mechanism sizes: less than `check` accepts.
const ROUNDING: f64 = 5e-11;

/// Parameters as the scene file has them for values of the variables.
pub type Parameters<'a> = dyn Fn(&[f64]) -> Vec<(String, String)> + Sync + 'a;

/// Examines the touching pairs of a scene with other parameters.
#[derive(Clone, Copy)]
pub struct Touching<'a> {
    /// The scene.
    pub source: &'a Source,
    /// Changes to it other than the variables.
    pub overrides: &'a Overrides,
    /// The variables as parameters.
    pub parameters: &'a Parameters<'a>,
}

impl Touching<'_> {
    /// The largest penetration of a touching pair over the poses (unknowns, then inputs) of `family` with these values,
    /// in mechanism sizes beyond rounding. Zero or less if the scene has no such pair; infinite if it cannot have these
    /// values.
    pub fn depth(&self, family: &ParametricMechanism, values: &[f64], poses: &[Vec<f64>]) -> f64 {
        // The scene with these values: its shapes depend on them.
        let overrides = Overrides {
            parameters: (self.parameters)(values),
            vary: Vec::new(),
            ..self.overrides.clone()
        };
        let Ok(scene) = load_scene(self.source, &overrides) else {
            return f64::INFINITY;
        };
        let Some(rules) = &scene.clearance else {
            return 0.0;
        };
        let mechanism = &scene.mechanism;
        let Some(order) = order_of(family, mechanism) else {
            return f64::INFINITY;
        };
        // The deepest overlap of the touching pairs, at some of the poses.
        let hulls: Vec<Option<BodyElements>> = BodyElements::of_bodies(&mechanism.bodies);
        let mut deepest = f64::NEG_INFINITY;
        for pose in poses.iter().step_by(STRIDE) {
            let coordinates: Vec<f64> = order.iter().map(|k| pose[*k]).collect();
            let bodies = forward::body_poses(mechanism, &coordinates);
            for [a, b] in &rules.touching {
                if let (Some(first), Some(second)) = (&hulls[*a], &hulls[*b]) {
                    let first_from_second = bodies[*a].inverse() * bodies[*b];
                    let near = nearest_bodies(first, second, &first_from_second, &LeftOut::new());
                    let depth = near.map_or(0.0, |n| -n.proximity.distance / mechanism.size);
                    deepest = deepest.max(depth);
                }
            }
        }
        deepest - ROUNDING
    }
}

/// Indices of the scene's coordinates among those of the family, whose further inputs are its variables.
fn order_of(family: &ParametricMechanism, mechanism: &Mechanism) -> Option<Vec<usize>> {
    let theirs = family.mechanism();
    let all: Vec<&str> = theirs
        .unknowns
        .iter()
        .chain(&theirs.inputs)
        .map(|c| c.name.as_str())
        .collect();
    let own = mechanism.unknowns.iter().chain(&mechanism.inputs);
    own.map(|c| all.iter().position(|name| *name == c.name))
        .collect()
}
