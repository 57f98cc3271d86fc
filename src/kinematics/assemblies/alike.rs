//! What tells assemblies apart: where links and bodies stand.
//!
//! A link with an idle spin (a rod between two ball joints) stands where its line does: of all its poses about that line
//! the mean is compared.

use crate::kinematics::freedoms::idle::Spins;
use crate::kinematics::freedoms::twists::Line;
use crate::kinematics::loops::forward::body_poses;
use crate::kinematics::structure::system::System;
use crate::math::{Pose, sin_cos};
use crate::model::chain::Chain;
use crate::model::mechanism::{Kind, Mechanism};

/// Link poses (rotation entries, translations over the size) that agree within this are the same: above what
/// rounding leaves at a nearly singular pose, below the distance of assemblies that can be told apart.
pub const SAME: f64 = 1e-6;

/// Where everything is at a pose.
#[derive(Clone, Debug)]
pub struct PlacedPoint {
    /// Links, and unknowns that move none: what makes a mode.
    pub links: Vec<f64>,
    /// Bodies: what makes a placement. Without bodies the links that have no idle spin.
    pub bodies: Vec<f64>,
}

/// Compares poses of one system.
pub struct Alike<'s> {
    mechanism: &'s Mechanism,
    spins: Spins,
    /// Bodies that move with the unknowns.
    bodies: Vec<usize>,
    outside: Vec<usize>,
}

impl<'s> Alike<'s> {
    /// What is compared in a system.
    pub fn new(system: &'s System) -> Self {
        let mechanism = system.mechanism();
        let moves = |body: &usize| {
            let mut coordinates =
                chain_coordinates(mechanism, &mechanism.bodies[*body].world_from_body);
            coordinates.any(|slot| slot < mechanism.unknowns.len())
        };
        Self {
            mechanism,
            spins: Spins::new(system),
            bodies: (0..mechanism.bodies.len()).filter(moves).collect(),
            outside: outside_chains(mechanism),
        }
    }

    /// Bodies that are compared; without any it is the links.
    pub fn bodies(&self) -> &[usize] {
        &self.bodies
    }

    /// Where everything is at a closed pose.
    pub fn place(&self, coordinates: &[f64]) -> PlacedPoint {
        let mechanism = self.mechanism;
        let arguments = mechanism.argument_values(coordinates);
        let lines = self.spins.lines(mechanism, coordinates);
        // Poses of the links, less the angle of those that spin about a line of their own.
        let mut links = Vec::new();
        let mut still = Vec::new();
        let poses = mechanism.joints.link_poses(&arguments);
        for (pose, line) in poses.iter().zip(&lines).skip(1) {
            note_pose(&mut links, pose, line.as_ref(), mechanism.size);
            if line.is_none() {
                note_pose(&mut still, pose, None, mechanism.size);
            }
        }
        let mut bodies = Vec::new();
        let poses = body_poses(mechanism, coordinates);
        for body in &self.bodies {
            let line = lines[mechanism.joints.of_body[*body]].as_ref();
            note_pose(&mut bodies, &poses[*body], line, mechanism.size);
        }
        let outside = self.outside(coordinates);
        links.extend(&bodies);
        links.extend(&outside);
        if self.bodies.is_empty() {
            still.extend(&outside);
            bodies = still;
        }
        PlacedPoint { links, bodies }
    }

    /// Unknowns that stand in formulas only.
    fn outside(&self, coordinates: &[f64]) -> Vec<f64> {
        let number = |slot: &usize| match self.mechanism.unknowns[*slot].kind {
            Kind::Angle => {
                // Angles are compared as points of a circle: whole turns do not matter.
                let (sin, cos) = sin_cos(coordinates[*slot]);
                vec![sin, cos]
            }
            Kind::Length | Kind::Number => {
                vec![coordinates[*slot] / self.mechanism.scale_of(*slot)]
            }
        };
        self.outside.iter().flat_map(number).collect()
    }
}

/// Adds the numbers of a pose; of one that spins about a line those of the mean over a turn, and how far its origin is
/// from the line. The line's sense does not enter.
fn note_pose(numbers: &mut Vec<f64>, pose: &Pose, line: Option<&Line>, size: f64) {
    let origin = pose.translation / size;
    let Some((direction, moment)) = line else {
        numbers.extend(pose.rotation.to_cols_array());
        numbers.extend(origin.to_array());
        return;
    };
    for k in 0..3 {
        let along = *direction * direction.dot(pose.rotation.col(k));
        numbers.extend(along.to_array());
    }
    // The mean over a turn about the line: components along it, and the foot on it.
    let foot = direction.cross(*moment);
    let mean = foot + *direction * direction.dot(origin - foot);
    numbers.extend(mean.to_array());
    numbers.push(origin.distance(mean));
}

fn chain_coordinates<'m>(
    mechanism: &'m Mechanism,
    chain: &'m Chain,
) -> impl Iterator<Item = usize> + 'm {
    let arguments = chain.arguments();
    arguments
        .into_iter()
        .flat_map(|argument| mechanism.arguments[argument].coordinates())
}

/// Unknowns that stand in formulas only.
fn outside_chains(mechanism: &Mechanism) -> Vec<usize> {
    let mut used = vec![false; mechanism.coordinate_count()];
    for slot in mechanism
        .chains()
        .flat_map(|c| chain_coordinates(mechanism, c))
    {
        used[slot] = true;
    }
    (0..mechanism.unknowns.len())
        .filter(|slot| !used[*slot])
        .collect()
}

/// Whether two lists of numbers agree.
pub fn same_numbers(a: &[f64], b: &[f64]) -> bool {
    // Lists differ in length where a link is idle in one of them only.
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME)
}

/// Largest difference of two lists.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}
