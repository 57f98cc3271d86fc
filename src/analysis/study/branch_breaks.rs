//! Checks that adjacent poses of a track belong to one motion. Each pose follows the variables individually; if a
//! singular pose passes between two samples of a track, they end up on different branches, although no sample shows it.

use super::track_poses::{Evaluator, Rejection, TrackPoses};
use crate::analysis::observer::{largest_distance, marked_positions};
use crate::kinematics::motion::continuation::solve_whole;
use crate::kinematics::results::trajectory::EventKind;
use crate::model::actuation::Actuation;

/// Numbers of equal parts into which the motion from a pose to the next is divided when it is tried with Newton steps
/// only.
const PARTS: [usize; 2] = [1, 4];

/// A followed pose equals the next one if they agree to this, in scaled unknowns, or in mechanism sizes.
const SAME: f64 = 1e-7;

impl Evaluator<'_> {
    /// Checks that every track is one motion from its first pose to its last.
    ///
    /// # Errors
    /// The pose that the one before it does not lead to.
    pub fn whole(&mut self, track_poses: &TrackPoses) -> Result<(), Rejection> {
        for (track, range) in self.family.rows() {
            for (from, pair) in track_poses.poses[range].windows(2).enumerate() {
                if !self.leads_to(&pair[0], &pair[1]) {
                    let pose = from + 2;
                    return Err(Rejection::BranchLost { track, pose });
                }
            }
        }
        Ok(())
    }

    fn leads_to(&mut self, from: &[f64], to: &[f64]) -> bool {
        let ends = PARTS.iter().find_map(|parts| self.follow(from, to, *parts));
        ends.is_some_and(|end| self.group.solver.apart(&end, to) < SAME) || self.moves_to(from, to)
    }

    /// The same by a full motion: through locked joints and past change points.
    fn moves_to(&self, from: &[f64], to: &[f64]) -> bool {
        let mechanism = self.family.mechanism();
        let n = mechanism.unknowns.len();
        let moved = Actuation::straight(&from[n..], &to[n..], from[..n].to_vec());
        let Some(motion) = solve_whole(self.family.system(), &moved, &[0.0, 1.0]) else {
            return false;
        };
        let mut events = motion.events.iter();
        if events.any(|e| e.kind == EventKind::OtherStart) {
            return false;
        }
        let Some(end) = motion.poses().last() else {
            return false;
        };
        let end = [end.unknowns.as_slice(), &to[n..]].concat();
        // The poses are equal if every marked point of the bodies agrees.
        let off = largest_distance(
            &marked_positions(mechanism, &end),
            &marked_positions(mechanism, to),
        );
        off < SAME * mechanism.size
    }

    /// The motion from one pose to the inputs of another; `None` if this many parts are too few.
    fn follow(&mut self, from: &[f64], to: &[f64], parts: usize) -> Option<Vec<f64>> {
        let n = self.family.mechanism().unknowns.len();
        let mut pose = from.to_vec();
        for part in 1..=parts {
            let share = part as f64 / parts as f64;
            let ends = from[n..].iter().zip(&to[n..]);
            let inputs: Vec<f64> = ends.map(|(a, b)| a + (b - a) * share).collect();
            pose = self.group.solver.step(&pose, &inputs, 1)?;
        }
        Some(pose)
    }
}
