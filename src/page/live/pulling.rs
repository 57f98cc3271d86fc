//! A link pulled by a reader: the inputs move so that a point of it comes near a line of sight. Damped Gauss-Newton steps
//! on the inputs, each followed from pose to pose like a slider.

use super::following::FollowEnd;
use super::session::{LiveError, LiveScene};
use crate::kinematics::freedoms::twists::TwistWalk;
use crate::kinematics::results::trajectory::{ClosedPose, Sample};
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::linalg::lanes::LaneMatrix;
use crate::linalg::normal_equations::damped_solution;
use glam::DVec3;

/// Steps of one pull: the next one begins where the pointer is by then.
const STEPS: usize = 3;

/// A point this near to the line of sight, as a share of the mechanism's size, is there.
const NEAR: f64 = 1e-4;

/// Damping as a share of the squared speeds: inputs that hardly move the point stay.
const DAMPING: f64 = 1e-3;

/// Longest step of an input: radians, or shares of the mechanism's size.
const LONGEST: f64 = 0.3;

/// A step that does not lead nearer is tried at this share of it, twice.
const SHORTER: f64 = 0.3;

/// The step away from a dead point, in the same units.
const FIRST_STEP: f64 = 0.05;

/// What is pulled, and where to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pull {
    /// Index of the body.
    pub body: usize,
    /// The point in the body's frame.
    pub point: DVec3,
    /// A point of the line of sight.
    pub to: DVec3,
    /// Its direction.
    pub along: DVec3,
}

impl Pull {
    /// How far the point is from the line of sight.
    fn miss(&self, pose: &ClosedPose) -> DVec3 {
        let place = pose.bodies[self.body].transform_point(self.point);
        (self.to - place).reject_from(self.along)
    }
}

impl LiveScene {
    /// Moves the inputs from their present values, or from a time of the motion, so that a point comes nearer to a line of
    /// sight. Where the motion ends on the way, the last pose stays, and the place is returned.
    ///
    /// Errors: no such body; nothing that is driven; no pose to start from.
    pub fn pull(&mut self, time: f64, pull: &Pull) -> Result<Option<FollowEnd>, LiveError> {
        let mechanism = self.mechanism();
        let why = match (mechanism.inputs.is_empty(), mechanism.bodies.len()) {
            (true, _) => "nothing is driven",
            (_, count) if pull.body >= count => "no such body",
            _ => "",
        };
        if !why.is_empty() {
            return Err(LiveError::Request(why.to_owned()));
        }
        let near = NEAR * mechanism.size;
        let mut stopped = None;
        for _ in 0..STEPS {
            let (start, pose) = self.standing_pose(time)?;
            if pull.miss(&pose).length() <= near {
                break;
            }
            stopped = None;
            let mut steps = self.shortened_steps(pull, &start, &pose);
            steps.extend(self.first_steps());
            if !steps
                .iter()
                .any(|step| self.is_nearer_after(pull, (&start, &pose), step, &mut stopped))
            {
                break;
            }
        }
        Ok(stopped)
    }

    /// Whether the point is nearer after a step of the inputs, which then stays made. Where the motion ends on the way, that
    /// is noted.
    fn is_nearer_after(
        &mut self,
        pull: &Pull,
        (start, pose): (&Sample, &ClosedPose),
        step: &[f64],
        stopped: &mut Option<FollowEnd>,
    ) -> bool {
        let before = self.hand.clone();
        let moved = start.inputs.iter().zip(step);
        let inputs: Vec<f64> = moved.map(|(input, step)| input + step).collect();
        let end = self.follow_by_hand(start, pose, &inputs);
        let after = self.hand.as_ref().and_then(|held| held.pose.as_ref());
        let nearer =
            after.is_some_and(|after| pull.miss(after).length() < pull.miss(pose).length());
        if end.is_none() && nearer {
            *stopped = None;
            return true;
        }
        self.hand = before;
        *stopped = stopped.take().or(end);
        false
    }

    /// The step towards the line of sight, and shorter ones.
    fn shortened_steps(&self, pull: &Pull, start: &Sample, pose: &ClosedPose) -> Vec<Vec<f64>> {
        let Some(step) = self.step_towards(pull, start, pose) else {
            return Vec::new();
        };
        let shares = [1.0, SHORTER, SHORTER * SHORTER];
        let shorter = |share: f64| step.iter().map(|s| share * s).collect();
        shares.map(shorter).to_vec()
    }

    /// A step of every input to and fro: at a dead point the first order does not tell where a link would go.
    fn first_steps(&self) -> Vec<Vec<f64>> {
        let scales = self.input_scales();
        let both = (0..scales.len()).flat_map(|k| [(k, FIRST_STEP), (k, -FIRST_STEP)]);
        let alone = |(k, step): (usize, f64)| {
            let mut steps = vec![0.0; scales.len()];
            steps[k] = step * scales[k];
            steps
        };
        both.map(alone).collect()
    }

    /// What a unit step of each input is: a radian, or the mechanism's size.
    fn input_scales(&self) -> Vec<f64> {
        let mechanism = self.mechanism();
        let inputs = mechanism.inputs.iter();
        inputs
            .map(|input| mechanism.natural_size(input.kind))
            .collect()
    }

    /// The step of the inputs that takes the point there to the first order; `None` if no input moves it.
    fn step_towards(&self, pull: &Pull, start: &Sample, pose: &ClosedPose) -> Option<Vec<f64>> {
        let mechanism = self.mechanism();
        let count = mechanism.inputs.len();
        let coordinates = [&pose.unknowns[..], &start.inputs].concat();
        let place = pose.bodies[pull.body].transform_point(pull.point);
        let chain = &mechanism.bodies[pull.body].world_from_body;
        let scales = self.input_scales();
        let miss = pull.miss(pose);
        // The velocity of the point across the line of sight for a unit of each input.
        let mut solver = PoseSolver::new(&self.now.system);
        let mut columns = LaneMatrix::default();
        columns.reset(count, 3);
        let mut squares = 0.0;
        for (k, scale) in scales.iter().enumerate() {
            let mut rates = vec![0.0; coordinates.len()];
            rates[pose.unknowns.len() + k] = *scale;
            solver.tangent(&coordinates, &mut rates);
            let (turn, speed) = TwistWalk::new(mechanism, &coordinates, &rates, 1.0).whole(chain);
            let velocity = (turn.cross(place) + speed).reject_from(pull.along);
            for (row, entry) in velocity.to_array().into_iter().enumerate() {
                *columns.at_mut(k, row) = entry;
            }
            squares += velocity.length_squared();
        }
        let mut step = Vec::new();
        let damping = DAMPING * squares;
        if !damped_solution(&columns, &miss.to_array(), damping, &mut step) {
            return None;
        }
        let longest = step.iter().fold(0.0_f64, |longest, s| longest.max(s.abs()));
        let share = (LONGEST / longest).min(1.0);
        let moved = step.iter().zip(&scales);
        Some(moved.map(|(step, scale)| share * step * scale).collect())
    }
}
