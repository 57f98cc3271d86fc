//! Compares assemblies by the placements of links and bodies.
//!
//! For a link with an idle spin (a rod between two ball joints) the mean over all its poses about the axis of the spin
//! is compared.

use crate::kinematics::freedoms::idle::Spins;
use crate::kinematics::freedoms::twists::PluckerLine;
use crate::kinematics::loops::forward::body_poses;
use crate::kinematics::structure::system::System;
use crate::math::{Pose, sin_cos};
use crate::model::chain::Chain;
use crate::model::mechanism::{Kind, Mechanism};
use std::collections::BTreeSet;

/// Link placements (rotation entries, translations over the size) that agree within this are equal: above the rounding
/// at a nearly singular pose, below the difference of assemblies that can be distinguished.
pub const SAME: f64 = 1e-6;

/// All placements at a pose.
#[derive(Clone, Debug)]
pub struct PlacedPoint {
    /// Of the links, and unknowns that move none: they define a mode.
    pub links: Vec<f64>,
    /// Of the bodies: they define a placement. Without bodies, of the links without idle spin.
    pub bodies: Vec<f64>,
}

/// Compares poses of one system.
pub struct Alike<'s> {
    mechanism: &'s Mechanism,
    spins: Spins,
    /// Bodies that move with the unknowns.
    bodies: Vec<usize>,
    outside: Vec<usize>,
    /// Angles whose turns matter.
    counted: BTreeSet<usize>,
}

impl<'s> Alike<'s> {
    /// The quantities compared in a system.
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
            counted: mechanism.counted_angles(),
        }
    }

    /// Bodies that are compared; if there are none, links.
    pub fn bodies(&self) -> &[usize] {
        &self.bodies
    }

    /// Where everything is at a closed pose.
    pub fn place(&self, coordinates: &[f64]) -> PlacedPoint {
        let mechanism = self.mechanism;
        let arguments = mechanism.argument_values(coordinates);
        let lines = self.spins.lines(mechanism, coordinates);
        // Placements of the links, without the angle of those that spin.
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

    /// Unknowns that appear in formulas only.
    fn outside(&self, coordinates: &[f64]) -> Vec<f64> {
        let number = |slot: &usize| match self.mechanism.unknowns[*slot].kind {
            Kind::Angle if self.counted.contains(slot) => vec![coordinates[*slot]],
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

/// Appends the numbers of a placement; for a spinning link the means over a turn, and the distance of its origin from
/// the axis. The direction of the axis does not matter.
fn note_pose(numbers: &mut Vec<f64>, pose: &Pose, line: Option<&PluckerLine>, size: f64) {
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
    // The mean over a turn about the axis: components along it, and the foot on it.
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

/// Unknowns that appear in formulas only.
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
    // Lists differ in length if a link is idle in one of them only.
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME)
}

/// Largest difference of two lists.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}
