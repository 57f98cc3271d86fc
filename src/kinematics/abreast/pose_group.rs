//! Closed poses of one system, eight at a time: moved to other inputs by one step, and differentiated by inputs. What
//! fails a test is left to the [`PoseSolver`].

use super::following::LaneFollower;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::kinematics::structure::system::System;
use crate::numbers::octet::{LANES, LaneMask, Octet};

/// Moves and differentiates poses of one system; one per thread.
#[derive(Clone, Debug)]
pub struct PoseGroup<'s> {
    /// For single poses.
    pub solver: PoseSolver<'s>,
    /// `None` if the system cannot be solved side by side.
    lanes: Option<LaneFollower<'s>>,
    /// The poses of the lanes: unknowns, then inputs.
    coordinates: Vec<Octet>,
    inputs: Vec<Octet>,
    rates: Vec<Octet>,
}

impl<'s> PoseGroup<'s> {
    /// Buffers for `system`.
    pub fn new(system: &'s System) -> Self {
        Self {
            solver: PoseSolver::new(system),
            lanes: LaneFollower::new(system),
            coordinates: Vec::new(),
            inputs: Vec::new(),
            rates: Vec::new(),
        }
    }

    /// Moves at most [`LANES`] closed poses by one step to the inputs `input(lane, k)`. Returns the lanes whose step is
    /// trusted: each is closed, on the same side of all singular poses as before, and its smallest singular value is at
    /// least `least_sigmas[lane]`.
    pub fn step(
        &mut self,
        poses: &[Vec<f64>],
        input: impl Fn(usize, usize) -> f64,
        least_sigmas: &[f64],
    ) -> LaneMask {
        let begun = self.begin(poses);
        let Some(follower) = self.lanes.as_mut().filter(|_| begun.any()) else {
            return LaneMask::NONE;
        };
        let unknowns = follower.system().mechanism().unknowns.len();
        // Lanes without a pose do as the first one.
        let of_lane = |lane: usize| if lane < poses.len() { lane } else { 0 };
        let lane_inputs = |k: usize| Octet::new(std::array::from_fn(|l| input(of_lane(l), k)));
        self.inputs.clear();
        self.inputs
            .extend((0..self.coordinates.len() - unknowns).map(lane_inputs));
        let trusted = follower.step(&mut self.coordinates, &self.inputs, begun);
        let least = Octet::new(std::array::from_fn(|l| least_sigmas[of_lane(l)]));
        trusted.and(least.at_most(follower.least_sigma()))
    }

    /// The pose of a lane after a step.
    pub fn pose(&self, lane: usize) -> Vec<f64> {
        self.coordinates.iter().map(|c| c.lane(lane)).collect()
    }

    /// d(unknowns)/d(input) of every lane after a step, input after input.
    pub fn lane_sensitivities(&mut self, inputs: &[usize]) -> Vec<Vec<f64>> {
        let Some(follower) = &mut self.lanes else {
            return Vec::new();
        };
        let unknowns = follower.system().mechanism().unknowns.len();
        let mut lanes = vec![Vec::new(); LANES];
        for input in inputs {
            // One column of implicit differentiation: the tangents for a unit rate of the input.
            self.rates.clear();
            self.rates.resize(self.coordinates.len(), Octet::ZERO);
            self.rates[unknowns + input] = Octet::splat(1.0);
            follower.tangent(&mut self.rates);
            for (lane, column) in lanes.iter_mut().enumerate() {
                column.extend(self.rates[..unknowns].iter().map(|rate| rate.lane(lane)));
            }
        }
        lanes
    }

    /// d(unknowns)/d(input) at closed poses, input after input.
    pub fn sensitivities(&mut self, poses: &[Vec<f64>], inputs: &[usize]) -> Vec<Vec<f64>> {
        let mut all = Vec::with_capacity(poses.len());
        for group in poses.chunks(LANES) {
            let regular = self.begin(group);
            let mut lanes = match regular.any() {
                true => self.lane_sensitivities(inputs),
                false => Vec::new(),
            };
            for (lane, pose) in group.iter().enumerate() {
                let found = lanes.get_mut(lane).filter(|_| regular.has(lane));
                let found = found.map(std::mem::take);
                all.push(found.unwrap_or_else(|| self.sensitivity(pose, inputs)));
            }
        }
        all
    }

    /// d(unknowns)/d(input) at one closed pose, input after input.
    pub fn sensitivity(&mut self, pose: &[f64], inputs: &[usize]) -> Vec<f64> {
        let unknowns = self.solver.system().mechanism().unknowns.len();
        let mut rates = vec![0.0; pose.len()];
        let mut all = Vec::with_capacity(unknowns * inputs.len());
        for input in inputs {
            rates.fill(0.0);
            rates[unknowns + input] = 1.0;
            self.solver.tangent(pose, &mut rates);
            all.extend_from_slice(&rates[..unknowns]);
        }
        all
    }

    /// Linearises at closed poses; returns the lanes that are regular, and in which no ball joint is nearly locked.
    fn begin(&mut self, poses: &[Vec<f64>]) -> LaneMask {
        let (Some(follower), Some(first)) = (&mut self.lanes, poses.first()) else {
            return LaneMask::NONE;
        };
        let of_lane = |lane: usize, k: usize| poses.get(lane).unwrap_or(first)[k];
        self.coordinates.clear();
        self.coordinates
            .extend((0..first.len()).map(|k| Octet::new(std::array::from_fn(|l| of_lane(l, k)))));
        let balls = follower.system().balls();
        let is_locked = |pose: &[f64]| balls.iter().any(|ball| ball.may_have_locked(pose, pose));
        let locked = poses.iter().enumerate().filter(|(_, pose)| is_locked(pose));
        let lanes = locked.fold(LaneMask::first(poses.len()), |lanes, (lane, _)| {
            lanes.except(lane)
        });
        follower.begin(&self.coordinates, lanes)
    }
}
