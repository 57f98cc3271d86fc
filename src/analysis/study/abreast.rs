//! Poses and measures designs eight at a time, starting from the poses of a known
//! [`TrackPoses`](super::track_poses::TrackPoses). Designs that fail any test are left to the [`Evaluator`], one by
//! one.

use super::lane_measures::LaneMeasures;
use super::measure::MeasureValues;
use super::track_poses::{Evaluator, LONGEST_STEP, Rejection, TrackPoses};
use crate::kinematics::abreast::anchor::AnchorPose;
use crate::kinematics::abreast::closing::LaneSolver;
use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::solve::pose_solver::largest_correction;
use crate::numbers::octet::{LANES, LaneMask, Octet};

/// Known poses from which designs are posed side by side; created once, shared by all threads.
#[derive(Clone, Debug)]
pub struct PoseAnchors<'t> {
    track_poses: &'t TrackPoses,
    /// `None` if some pose cannot be used: every design is then posed individually.
    anchors: Option<Vec<AnchorPose>>,
    /// `None` if measures are computed individually.
    measures: Option<LaneMeasures<'t>>,
}

impl<'t> PoseAnchors<'t> {
    /// The poses and their sensitivities.
    pub fn new(evaluator: &Evaluator<'t>, track_poses: &'t TrackPoses) -> Self {
        let system = evaluator.family().system();
        let is_followed = track_poses.sensitivities().is_some() && !track_poses.passes_singular();
        let anchors = track_poses
            .poses
            .iter()
            .map(|pose| AnchorPose::new(system, pose));
        Self {
            anchors: anchors.collect::<Option<_>>().filter(|_| is_followed),
            measures: LaneMeasures::new(evaluator.family()),
            track_poses,
        }
    }
}

/// Poses and measures designs eight at a time; one per thread.
pub struct LaneEvaluator<'f> {
    plain: Evaluator<'f>,
    solver: LaneSolver<'f>,
    anchors: &'f PoseAnchors<'f>,
    /// Coordinates of the designs, pose after pose.
    poses: Vec<Vec<Octet>>,
    /// Designs that were posed individually.
    pub alone: usize,
}

impl<'f> LaneEvaluator<'f> {
    /// Buffers for one thread.
    pub fn new(plain: Evaluator<'f>, anchors: &'f PoseAnchors<'f>) -> Self {
        Self {
            solver: LaneSolver::new(plain.family().system()),
            poses: vec![Vec::new(); anchors.track_poses.poses.len()],
            alone: 0,
            plain,
            anchors,
        }
    }

    /// The measures of designs with these values of the variables, at most [`LANES`].
    pub fn measure(&mut self, designs: &[Vec<f64>]) -> Vec<Result<MeasureValues, Rejection>> {
        let lanes = self.posed(designs);
        let found = self.measured(lanes, designs);
        let found = designs.iter().zip(found);
        found
            .map(|(values, measures)| match measures {
                Some(measures) => Ok(MeasureValues { measures }),
                None => self.alone(values),
            })
            .collect()
    }

    /// A design posed individually.
    fn alone(&mut self, values: &[f64]) -> Result<MeasureValues, Rejection> {
        self.alone += 1;
        let track_poses = self.plain.piece(self.anchors.track_poses, values)?;
        self.plain.measure(&track_poses)
    }

    /// Poses the designs; returns the lanes that are closed at all poses by one trusted step from the known poses.
    fn posed(&mut self, designs: &[Vec<f64>]) -> LaneMask {
        let track_poses = self.anchors.track_poses;
        let mut lanes = LaneMask::first(designs.len());
        let Some((anchors, sensitivities)) = self
            .anchors
            .anchors
            .as_ref()
            .zip(track_poses.sensitivities())
        else {
            return LaneMask::NONE;
        };
        let of_variable = |k: usize| {
            let of_lane = |lane: usize| designs.get(lane).map_or(track_poses.values[k], |v| v[k]);
            Octet::new(std::array::from_fn(of_lane))
        };
        let values: Vec<Octet> = (0..track_poses.values.len()).map(of_variable).collect();
        let known = values.iter().zip(&track_poses.values);
        let change: Vec<Octet> = known.map(|(v, s)| *v - Octet::splat(*s)).collect();
        let mechanism = self.plain.family().mechanism();
        for (index, anchor) in anchors.iter().enumerate() {
            let pose = &mut self.poses[index];
            pose.clear();
            pose.extend(track_poses.poses[index].iter().map(|c| Octet::splat(*c)));
            // Predicted along the sensitivities, ...
            let (n, mut length) = (mechanism.unknowns.len(), Octet::ZERO);
            for (k, unknown) in pose.iter_mut().take(n).enumerate() {
                let columns = sensitivities[index].chunks_exact(n).zip(&change);
                let moved = columns.fold(Octet::ZERO, |sum, (column, d)| sum + *d * column[k]);
                length = length.larger_magnitude(moved * (1.0 / mechanism.scale_of(k)));
                *unknown += moved;
            }
            let first = pose.len() - values.len();
            pose[first..].copy_from_slice(&values);
            // ... corrected by Newton steps, and trusted if the correction is small against the step.
            let closed = self.solver.close(anchor, pose, lanes);
            let allowed = length.each(|length| match length <= LONGEST_STEP {
                true => largest_correction(length),
                false => f64::NEG_INFINITY,
            });
            lanes = closed.lanes.and(closed.first_step.at_most(allowed));
            if !lanes.any() {
                break;
            }
        }
        lanes
    }

    /// The measures of `lanes`; none if one has no value or must be computed individually.
    fn measured(&mut self, lanes: LaneMask, designs: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
        let measures = self.anchors.measures.filter(|_| lanes.any());
        let Some(measures) = measures else {
            let one = |lane: usize| {
                lanes
                    .has(lane)
                    .then(|| self.measured_plainly(lane, designs))
            };
            return (0..designs.len()).map(one).map(Option::flatten).collect();
        };
        let mechanism = self.plain.family().mechanism();
        // Outputs and traces of all lanes at once.
        let slots: Vec<Vec<Octet>> = self
            .poses
            .iter()
            .map(|pose| observed_slots(mechanism, pose))
            .collect();
        let tracks = self.plain.family().ranges();
        let slots: Vec<&[Vec<Octet>]> = tracks.map(|poses| &slots[poses]).collect();
        let found = measures.of(&slots, designs).into_iter().enumerate();
        let is_whole = |all: &[f64]| all.iter().all(|v| v.is_finite());
        found
            .map(|(lane, all)| (lanes.has(lane) && is_whole(&all)).then_some(all))
            .collect()
    }

    /// The measures of a lane's poses, by the code for single designs.
    fn measured_plainly(&self, lane: usize, designs: &[Vec<f64>]) -> Option<Vec<f64>> {
        let pose = |pose: &Vec<Octet>| pose.iter().map(|c| c.lane(lane)).collect();
        let poses = self.poses.iter().map(pose).collect();
        let track_poses = self
            .anchors
            .track_poses
            .approached(designs[lane].clone(), poses);
        Some(self.plain.measure(&track_poses).ok()?.measures)
    }
}

/// Designs that are posed at a time.
pub const AT_A_TIME: usize = LANES;
