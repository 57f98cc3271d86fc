//! Whether bodies that a scene says touch do no more than that: the guard of a search, which would otherwise go on to
//! mechanisms whose surfaces cut each other beside the point of contact.

use crate::analysis::study::ParametricMechanism;
use crate::diag::Source;
use crate::distance::bodies::{Hull, LeftOut, nearest_bodies};
use crate::kinematics::loops::forward;
use crate::model::mechanism::Mechanism;
use crate::scene::{Overrides, load_scene};

/// Every so many poses are looked at; where a search ends all are.
const STRIDE: usize = 3;

/// Depth that is rounding, in mechanism sizes: less than the check of clearances lets pass.
const ROUNDING: f64 = 5e-11;

/// Parameters as the scene file has them for values of the variables.
pub type Parameters<'a> = dyn Fn(&[f64]) -> Vec<(String, String)> + Sync + 'a;

/// Looks at the touching pairs of a scene with other parameters.
#[derive(Clone, Copy)]
pub struct Touching<'a> {
    /// The scene.
    pub source: &'a Source,
    /// What is changed in it besides the variables.
    pub overrides: &'a Overrides,
    /// The variables as parameters.
    pub parameters: &'a Parameters<'a>,
}

impl Touching<'_> {
    /// How deep a touching pair cuts into each other at the worst of the poses (unknowns, then inputs) of `family` with
    /// these values, in mechanism sizes beyond rounding. Zero or less where the scene names no such pair; infinite where it
    /// cannot have these values.
    pub fn depth(&self, family: &ParametricMechanism, values: &[f64], poses: &[Vec<f64>]) -> f64 {
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
        let hulls: Vec<Option<Hull>> = Hull::of_bodies(&mechanism.bodies);
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

/// Where the coordinates of the scene stand among those of the family, whose further inputs are its variables.
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
