//! A second description of a mechanism's ball joints, which is never gimbal-locked.
//!
//! Each joint is its rotation at a base pose times three small rotations about x, y and z, in the same unknowns. The
//! angles of the base pose are inputs of the chart, so that its chains contain no rounded rotation and can be proved.
//! The usual solver solves the chart; the scene's angles are then computed from the rotation.

use super::joint::Ball;
use crate::kinematics::structure::block::block_of;
use crate::kinematics::structure::system::System;
use crate::math::Pose;
use crate::model::chain::{Argument, Chain, ChainStep, ElementaryMotion};
use crate::model::expression::Affine;
use crate::model::joints::{Joints, Passage};
use crate::model::mechanism::{Coordinate, Kind, Mechanism};
use crate::numbers::constant::Constant;
use glam::DVec3;
use std::sync::Arc;

/// The mechanism of a system with its ball joints described from a pose on.
#[derive(Clone, Copy, Debug)]
pub struct BallChart<'s> {
    /// Loops and coordinates only. The unknowns of ball joints are small rotations about x, y, z; the scene's inputs
    /// are followed by the base angles of every ball joint.
    pub system: &'s System,
    /// The ball joints; none of their angles is held.
    pub balls: &'s [Ball],
    /// Coordinates of the scene.
    count: usize,
}

/// The system of a chart: the scene's blocks for loops in which `balls` are small rotations.
pub(crate) fn chart_system(system: &System, balls: &[Ball]) -> System {
    let mechanism = system.mechanism();
    let mut charted = Mechanism {
        bodies: Vec::new(),
        traces: Vec::new(),
        outputs: Vec::new(),
        // The scene's table of joints does not apply to the chart's chains, and theirs is not needed.
        joints: Joints::default(),
        ..mechanism.clone()
    };
    let mut small = Vec::new();
    for ball in balls {
        for (argument, slot) in ball.arguments().into_iter().zip(ball.slots) {
            let base = charted.coordinate_count();
            charted.inputs.push(Coordinate {
                name: mechanism.unknowns[slot].name.clone(),
                kind: Kind::Angle,
            });
            rebase_argument(&mut charted.arguments[argument], base);
        }
        let first = charted.arguments.len();
        charted.arguments.extend(ball.slots.map(|slot| {
            Argument::Affine(Affine {
                terms: vec![(slot, Constant::exact(1.0))],
                constant: Constant::exact(0.0),
            })
        }));
        small.push(first);
    }
    for (item, passages) in charted.loops.iter_mut().zip(&mechanism.joints.along_loops) {
        rewrite_chain(&mut item.chain, passages, balls, &small);
    }
    let mut structure = system.structure().clone();
    for item in &mut structure.blocks {
        let (loops, equations) = (item.loops.clone(), item.equations.clone());
        *item = block_of(&charted, loops, equations, item.unknowns.clone());
    }
    System::bare(Arc::new(charted), structure)
}

impl<'s> BallChart<'s> {
    /// `None` if there is no ball joint.
    pub fn new(system: &'s System) -> Option<Self> {
        Some(Self {
            system: system.chart()?,
            balls: system.balls(),
            count: system.mechanism().coordinate_count(),
        })
    }

    /// Whether the scene's angles are bad coordinates of some joint here.
    pub fn is_needed(&self, coordinates: &[f64]) -> bool {
        self.balls.iter().any(|b| b.is_nearly_locked(coordinates))
    }

    /// The chart's coordinates of the pose at the scene's `coordinates`, which becomes its base.
    pub fn base(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut own = coordinates.to_vec();
        for ball in self.balls {
            own.extend(ball.slots.map(|slot| coordinates[slot]));
            ball.slots.iter().for_each(|slot| own[*slot] = 0.0);
        }
        own
    }

    /// The base angles of ball `index` in the chart's coordinates `own`, at their positions in the scene's.
    fn angles_of_base(&self, index: usize, own: &[f64]) -> Vec<f64> {
        let first = self.count + 3 * index;
        let mut coordinates = own[..self.count].to_vec();
        for (slot, angle) in self.balls[index].slots.iter().zip(&own[first..]) {
            coordinates[*slot] = *angle;
        }
        coordinates
    }

    /// The scene's coordinates for the chart's: of all equivalent angles those nearest to `near`.
    pub fn scene(&self, own: &[f64], near: &[f64]) -> Vec<f64> {
        let mut coordinates = own[..self.count].to_vec();
        for (index, ball) in self.balls.iter().enumerate() {
            let base = ball.rotation(&self.angles_of_base(index, own));
            let turn = |k: usize| Pose::from_axis_rotation(k, own[ball.slots[k]]).rotation;
            // The chart's three angles are turns about the axes of the rotation it is based on.
            let rotation = base * turn(0) * turn(1) * turn(2);
            ball.slots
                .iter()
                .for_each(|slot| coordinates[*slot] = near[*slot]);
            ball.read(&rotation, &mut coordinates);
        }
        coordinates
    }

    /// Replaces the angles of a pose's joints in the scene's `coordinates` by the equivalent ones nearest to `near`.
    pub fn rename(&self, coordinates: &mut [f64], near: &[f64]) {
        for ball in self.balls {
            let rotation = ball.rotation(coordinates);
            ball.slots
                .iter()
                .for_each(|slot| coordinates[*slot] = near[*slot]);
            ball.read(&rotation, coordinates);
        }
    }

    /// Rates of the scene's unknowns for rates at the base pose `coordinates`: those of a joint's first and last angle
    /// are NaN where they are locked.
    pub fn scene_rates(&self, coordinates: &[f64], rates: &mut [f64]) {
        for ball in self.balls {
            let base = ball.rotation(coordinates);
            let turn = base * DVec3::from_array(ball.slots.map(|slot| rates[slot]));
            for (slot, rate) in ball.slots.iter().zip(ball.rates(coordinates, turn)) {
                rates[*slot] = rate;
            }
        }
    }
}

/// Makes a joint depend on coordinate `slot` instead of its own.
fn rebase_argument(argument: &mut Argument, slot: usize) {
    if let Argument::Affine(affine) = argument {
        affine.terms.iter_mut().for_each(|term| term.0 = slot);
    }
}

/// Inserts small rotations after every ball joint of a chain (before it if it is inverted), about the point where its
/// axes meet. Their arguments begin at `small`, for every ball.
fn rewrite_chain(chain: &mut Chain, passages: &[Passage], balls: &[Ball], small: &[usize]) {
    // From the last to the first, so that the numbers of earlier steps remain valid.
    for passage in passages.iter().rev() {
        let mut pairs = balls.iter().zip(small);
        let Some((ball, first)) = pairs.find(|(ball, _)| ball.joint == passage.joint) else {
            continue;
        };
        let turns = turns_about(ball.centre, *first);
        if ball.is_inverse(passage) {
            let turns = turns.iter().rev().map(ChainStep::inverse);
            let at = passage.steps.start;
            chain.steps.splice(at..at, turns.collect::<Vec<_>>());
        } else {
            let at = passage.steps.end;
            chain.steps.splice(at..at, turns);
        }
    }
}

/// Rotations about x, y and z in a point, with the arguments from `first` on.
fn turns_about(centre: DVec3, first: usize) -> Vec<ChainStep> {
    let turn = |axis: usize| ChainStep::Joint {
        motion: ElementaryMotion::Rotation,
        axis,
        argument: first + axis,
        sign: 1.0,
    };
    let mut steps: Vec<ChainStep> = [0, 1, 2].map(turn).to_vec();
    if centre != DVec3::ZERO {
        let shift =
            |translation: DVec3| ChainStep::Fixed(Pose::from_translation(translation).into());
        steps.insert(0, shift(centre));
        steps.push(shift(-centre));
    }
    steps
}
