//! Whether neighbouring poses of a track still belong to one motion. Each pose follows the variables by itself; where a
//! singular pose passes between two samples of a track, they end up on different branches, and no sample shows it.

use super::stand::{
    CORRECTION_FLOOR, CORRECTION_OF_STEP, Evaluator, MAX_CORRECTION, Rejection, Stand,
};
use crate::analysis::observer::{distance, positions};
use crate::kinematics::motion::continuation::solve_whole;
use crate::kinematics::results::trajectory::EventKind;
use crate::kinematics::solve::newton::Pace;
use crate::model::actuation::Actuation;

/// Numbers of equal parts in which the way from a pose to the next is tried with nothing but Newton steps.
const PARTS: [usize; 2] = [1, 4];

/// A pose that was followed to is the next one within this, in scaled unknowns, or in mechanism sizes.
const SAME: f64 = 1e-7;

impl Evaluator<'_> {
    /// Checks that every track is one motion from its first pose to its last.
    ///
    /// # Errors
    /// The pose that the one before it does not lead to.
    pub fn whole(&mut self, stand: &Stand) -> Result<(), Rejection> {
        for (track, range) in self.family.rows() {
            for (from, pair) in stand.poses[range].windows(2).enumerate() {
                if !self.leads_to(&pair[0], &pair[1]) {
                    let pose = from + 2;
                    return Err(Rejection::Torn { track, pose });
                }
            }
        }
        Ok(())
    }

    fn scaled<'s>(&'s self, change: impl Fn(usize) -> f64 + 's) -> f64 {
        let mechanism = self.family.mechanism();
        let unknowns = 0..mechanism.unknowns.len();
        let moves = unknowns.map(|k| (change(k) / mechanism.scale_of(k)).abs());
        moves.fold(0.0, f64::max)
    }

    fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        self.scaled(|k| b[k] - a[k])
    }

    fn leads_to(&mut self, from: &[f64], to: &[f64]) -> bool {
        let ends = PARTS.iter().find_map(|parts| self.follow(from, to, *parts));
        ends.is_some_and(|end| self.apart(&end, to) < SAME) || self.moves_to(from, to)
    }

    /// The same by a motion with all its care: through locked joints, past change points.
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
        let off = distance(&positions(mechanism, &end), &positions(mechanism, to));
        off < SAME * mechanism.size
    }

    /// Where the motion from one pose is at the inputs of another; `None` where so many parts are too few.
    fn follow(&mut self, from: &[f64], to: &[f64], parts: usize) -> Option<Vec<f64>> {
        let family = self.family;
        let system = family.system();
        let n = system.mechanism().unknowns.len();
        let mut pose = from.to_vec();
        let mut rates = vec![0.0; pose.len()];
        for part in 1..=parts {
            let share = part as f64 / parts as f64;
            for k in n..pose.len() {
                rates[k] = from[k] + (to[k] - from[k]) * share - pose[k];
            }
            self.corrector.tangent(system, &pose, &mut rates);
            let mut next: Vec<f64> = pose.iter().zip(&rates).map(|(x, d)| x + d).collect();
            let length = self.scaled(|k| rates[k]);
            let correction = self.corrector.correct(system, &mut next, Pace::Brisk);
            let allowed = (CORRECTION_OF_STEP * length + CORRECTION_FLOOR).min(MAX_CORRECTION);
            if !correction.converged || correction.first_step > allowed {
                return None;
            }
            pose = next;
        }
        Some(pose)
    }
}
