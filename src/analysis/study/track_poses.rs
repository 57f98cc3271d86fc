//! Poses the mechanism with other values of its variables: from known poses along a straight line to the new values,
//! with the branch checks of any motion.

use super::family::ParametricMechanism;
use crate::kinematics::abreast::pose_group::PoseGroup;
use crate::kinematics::motion::tracker::steps::Steps;
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::follows_prediction;
use crate::kinematics::solve::predictor::Prediction;
use crate::model::mechanism::{Kind, Mechanism};
use crate::numbers::octet::LANES;
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

/// Smallest fraction of the way that is tried before a candidate is given up.
const SMALLEST_SHARE: f64 = 1.0 / 256.0;

/// A pose whose smallest singular value is below this fraction of the first one's is next to a singular pose, where the
/// motion could continue on either side: nothing may be built on it.
const LEAST_SIGMA: f64 = 1e-5;

/// Below this smallest singular value a pose is known to half of the digits at most, and its derivatives to none: they are off by
/// the rounding of the pose over the square of it.
const SINGULAR: f64 = 1e-7;

/// The farthest prediction over the dimensions that a step may take, in scaled unknowns. Next to a singular pose predictions go
/// farther, and a correction could end at the same pose some turns away.
pub(super) const LONGEST_STEP: f64 = 1.0;

/// Largest difference of two poses that are one, in scaled unknowns: closed poses differ by rounding over their smallest
/// singular value.
const SAME_POSE: f64 = 1e-9;

/// All poses of all tracks with one set of values, and their derivatives by the values.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackPoses {
    /// Values of the variables.
    pub values: Vec<f64>,
    /// Unknowns, then inputs (the variables last), of every pose, track after track.
    pub poses: Vec<Vec<f64>>,
    /// d(unknowns)/d(variable) of every pose, variable after variable.
    sensitivities: Vec<Vec<f64>>,
    pub(super) signs: Vec<Vec<i8>>,
    /// Smallest singular value of every pose with the file's values.
    sigmas: Vec<f64>,
    /// The first pose behind a singular one, from which a piece may go on in another assembly: pieces are then followed along their
    /// own motions only.
    pub(super) behind_singular: Option<usize>,
}

impl TrackPoses {
    /// d(unknowns)/d(variable) of every pose, variable after variable; empty if the poses were only reached.
    pub(super) fn sensitivities(&self) -> Option<&[Vec<f64>]> {
        let known = self.sensitivities.len() == self.poses.len();
        known.then_some(&self.sensitivities[..])
    }

    /// Poses at other values, on the same side of all singular ones; without sensitivities.
    pub(super) fn approached(&self, values: Vec<f64>, poses: Vec<Vec<f64>>) -> Self {
        Self {
            values,
            poses,
            sensitivities: Vec::new(),
            signs: self.signs.clone(),
            sigmas: self.sigmas.clone(),
            behind_singular: self.behind_singular,
        }
    }

    /// The same, of which this one is the first behind a singular one.
    pub(super) fn passing_singular(self, behind_singular: Option<usize>) -> Self {
        Self {
            behind_singular,
            ..self
        }
    }

    /// Whether these poses pass a singular one, so that pieces are followed along their own motions.
    pub fn passes_singular(&self) -> bool {
        self.behind_singular.is_some()
    }

    /// Whether the poses are those of another way to the same values, except for rounding and full turns.
    pub(super) fn are_those_of(&self, other: &Self, mechanism: &Mechanism) -> bool {
        let mut pairs = self.poses.iter().zip(&other.poses);
        self.poses.len() == other.poses.len() && pairs.all(|(a, b)| is_one_pose(mechanism, a, b))
    }

    /// Whether pose `index` is singular, so that sensitivities are meaningless.
    pub(super) fn is_singular(&self, index: usize) -> bool {
        self.signs[index].contains(&0) || self.sigmas[index] < SINGULAR
    }

    /// Whether a pose is on the same side of all singular ones as pose `index`, if that is on one.
    pub(super) fn has_side(&self, index: usize, signs: &[i8]) -> bool {
        self.is_singular(index) || self.signs[index] == signs
    }
}

/// Whether two poses are one, except for rounding and full turns.
pub(super) fn is_one_pose(mechanism: &Mechanism, a: &[f64], b: &[f64]) -> bool {
    let mut unknowns = mechanism.unknowns.iter().enumerate();
    unknowns.all(|(k, unknown)| {
        let apart = match unknown.kind {
            Kind::Angle => libm::remainder(a[k] - b[k], TAU),
            Kind::Length | Kind::Number => a[k] - b[k],
        };
        apart.abs() <= SAME_POSE * mechanism.scale_of(k)
    })
}

/// Why values of the variables are rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Rejection {
    /// A pose does not exist, or cannot be reached without crossing a singular one.
    #[error("pose {pose} of track `{track}` cannot be reached on this branch")]
    NotReached {
        /// Name of the track.
        track: String,
        /// Number of the pose, from 1.
        pose: usize,
    },
    /// A singular pose passed between two samples: they are on different branches.
    #[error("pose {pose} of track `{track}` is no longer on the branch of the one before it")]
    BranchLost {
        /// Name of the track.
        track: String,
        /// Number of the second pose, from 1.
        pose: usize,
    },
    /// A measure has no value.
    #[error("`{0}` has no value")]
    NoValue(String),
    /// A measure has a value and no derivative: at the end of a root, say.
    #[error("`{0}` has no derivative")]
    NoDerivative(String),
}

/// Poses a family; one for each thread.
#[derive(Clone, Debug)]
pub struct Evaluator<'f> {
    pub(super) family: &'f ParametricMechanism,
    pub(super) group: PoseGroup<'f>,
    cancel: Option<&'f AtomicBool>,
}

impl<'f> Evaluator<'f> {
    /// Buffers for `family`.
    pub fn new(family: &'f ParametricMechanism) -> Self {
        Self {
            family,
            group: PoseGroup::new(family.system()),
            cancel: None,
        }
    }

    /// The same, which rejects everything when `cancel` is raised.
    pub fn until(self, cancel: &'f AtomicBool) -> Self {
        Self {
            cancel: Some(cancel),
            ..self
        }
    }

    /// Whether it was cancelled; its answers are meaningless from then on.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|c| c.load(Ordering::Relaxed))
    }

    /// The family that is posed.
    pub fn family(&self) -> &'f ParametricMechanism {
        self.family
    }

    /// The poses at the file's own values.
    pub fn nominal(&mut self, poses: Vec<Vec<f64>>) -> TrackPoses {
        let states = poses.iter().map(|pose| self.side(pose));
        let (signs, sigmas) = states.unzip();
        self.settled(TrackPoses {
            values: self.family.start(),
            sensitivities: Vec::new(),
            signs,
            sigmas,
            poses,
            behind_singular: None,
        })
    }

    /// The side of its singular poses on which a pose is, and its distance from them.
    pub(super) fn side(&mut self, pose: &[f64]) -> (Vec<i8>, f64) {
        let state = self.group.solver.observe(pose);
        (state.signs.into_vec(), state.sigma_min)
    }

    /// The variables, as inputs of the mechanism.
    pub(super) fn variables(&self) -> Vec<usize> {
        let first = self.family.own_inputs();
        (first..first + self.family.study.variables.len()).collect()
    }

    /// The poses at other values, reached from `track_poses` in as many steps as necessary.
    ///
    /// # Errors
    /// The pose at which the way ends.
    pub fn reach(
        &mut self,
        track_poses: &TrackPoses,
        values: &[f64],
    ) -> Result<TrackPoses, Rejection> {
        self.go(track_poses, values, true)
    }

    /// Adds the sensitivities that gradients and further steps need.
    pub fn settled(&mut self, mut track_poses: TrackPoses) -> TrackPoses {
        if track_poses.sensitivities().is_none() {
            let variables = self.variables();
            track_poses.sensitivities = self.group.sensitivities(&track_poses.poses, &variables);
        }
        track_poses
    }

    /// As [`reach`](Self::reach), without the sensitivities that gradients and further steps would need.
    ///
    /// # Errors
    /// The pose at which the way ends.
    pub fn approach(
        &mut self,
        track_poses: &TrackPoses,
        values: &[f64],
    ) -> Result<TrackPoses, Rejection> {
        self.go(track_poses, values, false)
    }

    fn go(
        &mut self,
        track_poses: &TrackPoses,
        values: &[f64],
        settle: bool,
    ) -> Result<TrackPoses, Rejection> {
        // Usually one step is enough.
        let first = match self.step(track_poses, values, settle) {
            Ok(reached) => return Ok(reached),
            Err(pose) => pose,
        };
        let (mut here, mut stuck) = (track_poses.clone(), first);
        let mut steps = Steps::new(0.0, 1.0, 0.5, SMALLEST_SHARE);
        // Otherwise the step is halved until it is trusted, and doubled again afterwards.
        while !steps.is_done() {
            if steps.is_stuck() {
                let (track, pose) = self.family.place_of(stuck);
                return Err(Rejection::NotReached { track, pose });
            }
            let next = steps.target();
            let ends = track_poses.values.iter().zip(values);
            let between: Vec<f64> = ends.map(|(a, b)| a + (b - a) * next).collect();
            let target = if next == 1.0 { values } else { &between };
            match self.step(&here, target, settle || next < 1.0) {
                Ok(reached) => {
                    here = reached;
                    steps.take();
                }
                Err(pose) => {
                    stuck = pose;
                    steps.refuse();
                }
            }
        }
        Ok(here)
    }

    /// One step; on failure the number of the pose that could not be trusted.
    fn step(
        &mut self,
        track_poses: &TrackPoses,
        values: &[f64],
        settle: bool,
    ) -> Result<TrackPoses, usize> {
        let change: Vec<f64> = values
            .iter()
            .zip(&track_poses.values)
            .map(|(b, a)| b - a)
            .collect();
        let (variables, count) = (self.variables(), track_poses.poses.len());
        let (n, own) = (
            self.family.mechanism().unknowns.len(),
            self.family.own_inputs(),
        );
        let mut poses = Vec::with_capacity(count);
        let mut sensitivities = Vec::with_capacity(if settle { count } else { 0 });
        for first in (0..count).step_by(LANES) {
            if self.is_cancelled() {
                return Err(first);
            }
            let group = first..count.min(first + LANES);
            let from = &track_poses.poses[group.clone()];
            let input = |lane: usize, k: usize| match k.checked_sub(own) {
                Some(variable) => values[variable],
                None => from[lane][n + k],
            };
            let least = track_poses.sigmas[group.clone()].iter();
            let least: Vec<f64> = least.map(|sigma| LEAST_SIGMA * sigma).collect();
            let trusted = self.group.step(from, input, &least);
            let mut lanes = match settle && trusted.any() {
                true => self.group.lane_sensitivities(&variables),
                false => Vec::new(),
            };
            for (lane, index) in group.enumerate() {
                if trusted.has(lane) {
                    poses.push(self.group.pose(lane));
                    sensitivities.extend(lanes.get_mut(lane).map(std::mem::take));
                    continue;
                }
                let pose = self.pose(track_poses, index, &change, values);
                let pose = pose.ok_or(index)?;
                if settle {
                    // The correction has just factorised the loops at this pose.
                    sensitivities.push(self.group.sensitivity(&pose, &variables));
                }
                poses.push(pose);
            }
        }
        Ok(TrackPoses {
            sensitivities,
            ..track_poses.approached(values.to_vec(), poses)
        })
    }

    pub(super) fn pose(
        &mut self,
        track_poses: &TrackPoses,
        index: usize,
        change: &[f64],
        values: &[f64],
    ) -> Option<Vec<f64>> {
        let family = self.family;
        let n = family.mechanism().unknowns.len();
        let mut pose = track_poses.poses[index].clone();
        // Predicted along the sensitivities, ...
        let mut length = 0.0_f64;
        let sensitivity = &track_poses.sensitivities[index];
        for k in 0..n {
            let columns = sensitivity.chunks_exact(n).zip(change);
            let moved: f64 = columns.map(|(column, d)| column[k] * d).sum();
            length = length.max((moved / family.mechanism().scale_of(k)).abs());
            pose[k] += moved;
        }
        let first = pose.len() - values.len();
        pose[first..].copy_from_slice(values);
        // ... corrected by Newton steps, and trusted if the correction is small against the step ...
        let correction = self.group.solver.correct(&mut pose, Pace::Brisk);
        let prediction = Prediction { length, bend: 0.0 };
        let trusted = follows_prediction(&correction, &prediction);
        if !trusted || length > LONGEST_STEP {
            return None;
        }
        // ... and the pose is regular, on the same side of all singular ones.
        let (signs, sigma) = self.side(&pose);
        let regular = sigma >= LEAST_SIGMA * track_poses.sigmas[index];
        (regular && signs == track_poses.signs[index]).then_some(pose)
    }
}
