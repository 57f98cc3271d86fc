//! The motion with the requested proofs.

use super::continuation::solve_until;
use super::sampling::is_cyclic;
use crate::kinematics::certificate::tube::certify_motion;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::printed::InputReading;

/// The requested proofs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Proofs {
    /// Nothing.
    None,
    /// Every pose.
    #[default]
    Poses,
    /// Every pose, and the motion between them.
    Motion,
}

/// The motion at `times`, until `cancelled` says so. Poses are proved at the inputs as a table prints them. A cyclic
/// motion is proved up to its end, where it is solved once more for that purpose.
pub fn solve_proved(
    system: &System,
    actuation: &Actuation,
    times: &[f64],
    proofs: Proofs,
    cancelled: &dyn Fn() -> bool,
) -> Trajectory {
    let reading = match proofs {
        Proofs::None => None,
        Proofs::Poses | Proofs::Motion => Some(InputReading::Decimals),
    };
    let mut wanted = times.to_vec();
    let last = times.last().copied().unwrap_or(0.0);
    // A cycle is proved up to where it closes.
    let goes_on = proofs == Proofs::Motion && times.len() > 1 && last < actuation.duration;
    if goes_on && is_cyclic(system.mechanism(), actuation) {
        wanted.push(actuation.duration);
    }
    let mut trajectory = solve_until(system, actuation, &wanted, reading, cancelled);
    // Tubes connect the samples; those beyond the last requested time are dropped afterwards.
    if proofs == Proofs::Motion && !cancelled() {
        trajectory.intervals = certify_motion(system, actuation, &trajectory);
    }
    trajectory.samples.truncate(times.len());
    trajectory
}
