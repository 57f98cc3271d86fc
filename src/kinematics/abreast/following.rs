//! Eight motions followed side by side from closed poses, each with its own poses and Jacobians.
//!
//! A step consists of a prediction along the tangents, corrected for the bend of the path during the previous steps, and
//! a correction. It is trusted under the usual conditions: the correction is small compared with it, and the Jacobians at
//! its ends are similar. Where formulas of the inputs have a kink, the step need only lie between the tangents at its two
//! ends. A lane that violates this, or in which a formula jumps, leaves for good.

use super::closing::ClosedLanes;
use super::frames::turn_of;
use super::linearised::Linearised;
use super::prediction::RecentSteps;
use crate::kinematics::solve::pose_solver::{MAX_CORRECTION, largest_correction};
use crate::kinematics::structure::system::System;
use crate::model::chain::{Argument, ArgumentValue};
use crate::model::expression::Expression;
use crate::model::mechanism::Closes;
use crate::model::outputs::fill_arguments;
use crate::model::walk::WalkFrame;
use crate::numbers::octet::{LANES, LaneMask, Octet};

/// The largest change of a scaled unknown in one step: an eighth of a turn, so that none hides a whole one.
const LONGEST_STEP: f64 = std::f64::consts::FRAC_PI_4;

/// Follows motions of one system; one per thread.
#[derive(Clone, Debug)]
pub struct LaneFollower<'s> {
    system: &'s System,
    /// Formulas of joints and equations that may jump.
    jumping: Vec<&'s Expression>,
    /// At the poses reached.
    here: Linearised<'s>,
    steps: RecentSteps,
    bends: Vec<Octet>,
    /// Changes of all coordinates along the tangents at the end of a step.
    ends: Vec<Octet>,
    poses: [Vec<f64>; 2],
    /// Arguments of all loops, and their values at a pose.
    used: Vec<usize>,
    arguments: Vec<ArgumentValue<Octet>>,
}

impl<'s> LaneFollower<'s> {
    /// Buffers for `system`; `None` if it has blocks that cannot be followed side by side.
    pub fn new(system: &'s System) -> Option<Self> {
        let here = Linearised::new(system)?;
        let mechanism = system.mechanism();
        let of_joints = mechanism
            .arguments
            .iter()
            .filter_map(|argument| match argument {
                Argument::Formula(formula) => Some(formula),
                Argument::Affine(_) => None,
            });
        let formulas = of_joints.chain(mechanism.equations.iter().map(|e| &e.expression));
        let of_loops = mechanism.loops.iter();
        let mut used: Vec<usize> = of_loops.flat_map(|item| item.chain.arguments()).collect();
        used.sort_unstable();
        used.dedup();
        Some(Self {
            jumping: formulas.filter(|formula| formula.has_jumps()).collect(),
            here,
            steps: RecentSteps::default(),
            bends: Vec::new(),
            ends: Vec::new(),
            poses: [Vec::new(), Vec::new()],
            used,
            arguments: Vec::new(),
            system,
        })
    }

    /// The system whose motions are followed.
    pub fn system(&self) -> &'s System {
        self.system
    }

    /// Starts at closed poses; returns those of `lanes` that are regular.
    pub fn begin(&mut self, coordinates: &[Octet], lanes: LaneMask) -> LaneMask {
        self.steps.clear();
        self.here.at(coordinates, lanes)
    }

    /// One step to other inputs; returns those of `lanes` in which it is trusted.
    pub fn step(
        &mut self,
        coordinates: &mut [Octet],
        inputs: &[Octet],
        lanes: LaneMask,
    ) -> LaneMask {
        self.steps.begin(coordinates);
        let length = self.predict(coordinates, inputs);
        let bend = self.bend(coordinates);
        let ClosedLanes { lanes, first_step } = self.here.close(coordinates, lanes);
        self.steps.end(first_step, length);
        let allowed = length.each(largest_correction);
        // After a whole turn all Jacobians are the same again: longer steps tell nothing.
        let lanes = lanes.and(length.at_most(Octet::splat(LONGEST_STEP)));
        let trusted = lanes.and((first_step + bend).at_most(allowed));
        let is_near = first_step.at_most(Octet::splat(MAX_CORRECTION));
        let doubted = lanes.without(trusted).and(is_near);
        let trusted = match doubted.any() {
            true => trusted.or(self.kinked(coordinates, doubted, allowed)),
            false => trusted,
        };
        self.unbroken(coordinates, trusted)
    }

    /// Rates of the unknowns at the poses reached, for the rates of the inputs in the tail of `rates`.
    pub fn tangent(&mut self, rates: &mut [Octet]) {
        self.here.tangent(rates);
    }

    /// A lower bound of the smallest singular value at the poses reached, except for rounding.
    pub fn least_sigma(&mut self) -> Octet {
        self.here.least_sigma()
    }

    /// Moves all coordinates along the tangents; the largest change of a scaled unknown.
    fn predict(&mut self, coordinates: &mut [Octet], inputs: &[Octet]) -> Octet {
        let n = coordinates.len() - inputs.len();
        let rates = self.steps.rates_mut();
        for (rate, (new, old)) in rates[n..]
            .iter_mut()
            .zip(inputs.iter().zip(&coordinates[n..]))
        {
            *rate = *new - *old;
        }
        let length = self.here.tangent(rates);
        coordinates[n..].copy_from_slice(inputs);
        for (unknown, rate) in coordinates[..n].iter_mut().zip(&*rates) {
            *unknown += *rate;
        }
        length
    }

    /// Corrects the prediction for the bend of the path; returns the largest resulting change of a scaled unknown.
    fn bend(&mut self, coordinates: &mut [Octet]) -> Octet {
        let n = self.system.mechanism().unknowns.len();
        self.steps.bends(n, &mut self.bends);
        let mut largest = Octet::ZERO;
        for block in self.system.blocks() {
            for (unknown, scale) in block.unknowns.iter().zip(&block.plan.scales) {
                let bend = self.bends[*unknown];
                coordinates[*unknown] += bend;
                largest = largest.larger_magnitude(bend * (1.0 / scale));
            }
        }
        largest
    }

    /// Those of `lanes` whose step lies between the tangents at its ends, as where one kink is passed. Their next step is
    /// compared with the tangents at the end.
    fn kinked(&mut self, coordinates: &[Octet], lanes: LaneMask, allowed: Octet) -> LaneMask {
        let n = self.system.mechanism().unknowns.len();
        self.ends.clear();
        self.ends.resize(n, Octet::ZERO);
        self.ends.extend_from_slice(&self.steps.rates()[n..]);
        self.here.tangent(&mut self.ends);
        // In scaled unknowns: the step beyond the first tangent, and the second tangent beyond it.
        let blocks = self.system.blocks().iter();
        let slots = blocks.flat_map(|b| b.unknowns.iter().zip(&b.plan.scales));
        let beyond = slots.map(|(unknown, scale)| {
            let first = self.steps.rates()[*unknown];
            let step = coordinates[*unknown] - self.steps.from()[*unknown];
            [step - first, self.ends[*unknown] - first].map(|v| v * (1.0 / scale))
        });
        let beyond: Vec<[Octet; 2]> = beyond.collect();
        let dot = |pair: fn(&[Octet; 2]) -> Octet| {
            let terms = beyond.iter().map(pair);
            terms.fold(Octet::ZERO, |sum, term| sum + term)
        };
        let share = dot(|[step, turn]| *step * *turn) / dot(|[_, turn]| *turn * *turn);
        let share = share.each(|share| share.clamp(0.0, 1.0));
        let off = beyond.iter().fold(Octet::ZERO, |off, [step, turn]| {
            off.larger_magnitude(*step - *turn * share)
        });
        let kinked = lanes.and(off.at_most(allowed));
        self.steps.turn(kinked, &self.ends);
        kinked
    }

    /// The members of `lanes` in which no formula jumps, and no ball joint comes near a pose with locked angles.
    fn unbroken(&mut self, coordinates: &[Octet], mut lanes: LaneMask) -> LaneMask {
        let balls = self.system.balls();
        let may_break = !balls.is_empty() || !self.jumping.is_empty();
        let asked = lanes;
        for lane in (0..LANES).filter(|lane| may_break && asked.has(*lane)) {
            for (pose, octets) in self.poses.iter_mut().zip([self.steps.from(), coordinates]) {
                pose.clear();
                pose.extend(octets.iter().map(|c| c.lane(lane)));
            }
            let [from, to] = &self.poses;
            let jumps = |formula: &&Expression| formula.jump_on_way(from, to).is_some();
            let locks = balls.iter().any(|ball| ball.may_have_locked(from, to));
            if locks || self.jumping.iter().any(jumps) {
                lanes = lanes.except(lane);
            }
        }
        lanes
    }

    /// The largest closure error over all loops and equations of every lane, relative to the loop's size, by plain
    /// products; NaN if a loop is rotated by more than a little.
    pub fn closure_error(&mut self, coordinates: &[Octet]) -> Octet {
        let mechanism = self.system.mechanism();
        let mut largest = Octet::ZERO;
        fill_arguments(mechanism, &self.used, coordinates, &mut self.arguments);
        for item in &mechanism.loops {
            let end = WalkFrame::at_end_of(&item.chain.steps, &self.arguments);
            let length = |v: [Octet; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).root();
            // Loops through a sphere close in a point, without rotation.
            if item.closes == Closes::Frame {
                largest = largest.larger_magnitude(length(turn_of(&end.axes)));
            }
            largest = largest.larger_magnitude(length(end.origin) * (1.0 / item.size));
        }
        let mut scratch = Vec::new();
        for (index, equation) in mechanism.equations.iter().enumerate() {
            let value = equation.expression.value_with(coordinates, &mut scratch);
            largest = largest.larger_magnitude(value * mechanism.equations[index].weight);
        }
        largest
    }
}
