//! Another description of a mechanism's ball joints, which is never gimbal-locked.
//!
//! Each joint is its present rotation, a constant, times three small rotations about x, y and z, in the same unknowns.
//! What solves the mechanism solves the chart; the scene's angles are then read from the rotation.

use super::ball::{Ball, balls, stands_at};
use super::structure::{Structure, block};
use crate::math::Pose;
use crate::model::chain::{Argument, Chain, Motion, Step};
use crate::model::expression::Affine;
use crate::model::mechanism::Mechanism;
use glam::{DMat3, DVec3};

/// Where a ball joint stands in the loops.
#[derive(Clone, Copy, Debug)]
struct Place {
    loop_index: usize,
    step: usize,
    is_inverse: bool,
}

/// The mechanism with its ball joints described from their present rotation on.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Loops and unknowns only; the unknowns of ball joints are small rotations about x, y, z.
    pub mechanism: Mechanism,
    /// The scene's order of solution, for `mechanism`.
    pub structure: Structure,
    /// The ball joints, none of which is held.
    pub balls: Vec<Ball>,
    /// Places of the constant rotations in `mechanism`, for every ball.
    places: Vec<Vec<Place>>,
    /// Present rotations.
    rotations: Vec<DMat3>,
}

impl Chart {
    /// `None` if there is no ball joint.
    pub fn new(mechanism: &Mechanism, structure: &Structure) -> Option<Self> {
        let balls = balls(mechanism, structure);
        if balls.is_empty() {
            return None;
        }
        let mut charted = Mechanism {
            bodies: Vec::new(),
            traces: Vec::new(),
            outputs: Vec::new(),
            ..mechanism.clone()
        };
        let mut places = Vec::new();
        for ball in &balls {
            for (argument, slot) in ball.arguments.iter().zip(ball.slots) {
                charted.arguments[*argument] = Argument::Affine(Affine {
                    terms: vec![(slot, 1.0)],
                    constant: 0.0,
                });
            }
        }
        for (index, item) in charted.loops.iter_mut().enumerate() {
            places.extend(rewrite(&mut item.chain, index, &balls));
        }
        let of_ball = |k: usize| {
            let own = places.iter().filter(|(ball, _)| *ball == k);
            own.map(|(_, place)| *place).collect()
        };
        Some(Self {
            places: (0..balls.len()).map(of_ball).collect(),
            rotations: vec![DMat3::IDENTITY; balls.len()],
            mechanism: charted,
            structure: structure.clone(),
            balls,
        })
    }

    /// Whether the scene's angles are bad coordinates of some joint here.
    pub fn is_needed(&self, coordinates: &[f64]) -> bool {
        self.balls.iter().any(|b| b.is_nearly_locked(coordinates))
    }

    /// Describes the joints from the scene's `coordinates` on; returns the chart's coordinates of that pose.
    pub fn base(&mut self, coordinates: &[f64]) -> Vec<f64> {
        let mut own = coordinates.to_vec();
        for (k, ball) in self.balls.iter().enumerate() {
            let rotation = ball.rotation(coordinates);
            self.rotations[k] = rotation;
            ball.slots.iter().for_each(|slot| own[*slot] = 0.0);
            for place in &self.places[k] {
                let rotation = if place.is_inverse {
                    rotation.transpose()
                } else {
                    rotation
                };
                let steps = &mut self.mechanism.loops[place.loop_index].chain.steps;
                steps[place.step] = Step::Fixed(Pose {
                    rotation,
                    translation: DVec3::ZERO,
                });
            }
        }
        for item in &mut self.structure.blocks {
            let (loops, equations) = (item.loops.clone(), item.equations.clone());
            *item = block(&self.mechanism, loops, equations, item.unknowns.clone());
        }
        own
    }

    /// The scene's coordinates for the chart's: of all names of the pose the one nearest to `near`.
    pub fn scene(&self, own: &[f64], near: &[f64]) -> Vec<f64> {
        let mut coordinates = own.to_vec();
        for (ball, base) in self.balls.iter().zip(&self.rotations) {
            let turn = |k: usize| Pose::from_axis_rotation(k, own[ball.slots[k]]).rotation;
            let rotation = *base * turn(0) * turn(1) * turn(2);
            ball.slots
                .iter()
                .for_each(|slot| coordinates[*slot] = near[*slot]);
            ball.read(&rotation, &mut coordinates);
        }
        coordinates
    }

    /// Gives the joints of a pose in the scene's `coordinates` the names nearest to `near`, without moving them.
    pub fn rename(&self, coordinates: &mut [f64], near: &[f64]) {
        for ball in &self.balls {
            let rotation = ball.rotation(coordinates);
            ball.slots
                .iter()
                .for_each(|slot| coordinates[*slot] = near[*slot]);
            ball.read(&rotation, coordinates);
        }
    }

    /// Rates of the scene's unknowns for rates at the pose that the chart was based on: those of a joint's first and last
    /// angle are NaN where they are locked.
    pub fn scene_rates(&self, coordinates: &[f64], rates: &mut [f64]) {
        for (ball, base) in self.balls.iter().zip(&self.rotations) {
            let turn = *base * DVec3::from_array(ball.slots.map(|slot| rates[slot]));
            for (slot, rate) in ball.slots.iter().zip(ball.rates(coordinates, turn)) {
                rates[*slot] = rate;
            }
        }
    }
}

/// Puts a constant rotation before every ball joint of a chain (after, where it stands inverted), and small
/// rotations in its place. Returns the constants' places with the index of their ball.
fn rewrite(chain: &mut Chain, loop_index: usize, balls: &[Ball]) -> Vec<(usize, Place)> {
    let mut steps: Vec<Step> = Vec::new();
    let mut places = Vec::new();
    let mut k = 0;
    while k < chain.steps.len() {
        let known = balls.iter().enumerate().find_map(|(index, ball)| {
            let window = chain.steps.get(k..k + 3)?;
            stands_at(ball, window).map(|is_inverse| (index, ball, is_inverse))
        });
        let Some((index, ball, is_inverse)) = known else {
            steps.push(chain.steps[k]);
            k += 1;
            continue;
        };
        let small = |axis: usize, sign: f64| Step::Joint {
            motion: Motion::Rotation,
            axis,
            argument: ball.arguments[axis],
            sign,
        };
        let first = steps.len();
        if is_inverse {
            steps.extend([2, 1, 0].map(|axis| small(axis, -1.0)));
            steps.push(Step::Fixed(Pose::IDENTITY));
        } else {
            steps.push(Step::Fixed(Pose::IDENTITY));
            steps.extend([0, 1, 2].map(|axis| small(axis, 1.0)));
        }
        let place = Place {
            loop_index,
            step: if is_inverse { first + 3 } else { first },
            is_inverse,
        };
        places.push((index, place));
        k += 3;
    }
    chain.steps = steps;
    places
}
