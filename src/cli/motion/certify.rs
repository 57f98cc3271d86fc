//! Solving with as much proof as was asked for.

use crate::cli::args::motion::CertifyArg;
use crate::cli::term::outcome::Failure;
use crate::kinematics::certificate::tube::certify_motion;
use crate::kinematics::motion::continuation::solve_until;
use crate::kinematics::motion::sampling::is_cyclic;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::printed::InputReading;
use std::sync::atomic::Ordering;

/// Who reads a table reads its decimals.
const AS_PRINTED: Option<InputReading> = Some(InputReading::Decimals);

/// The motion at `times`. A cyclic motion is proved up to its end, where it is solved once more for that purpose.
pub fn motion(
    system: &System,
    actuation: &Actuation,
    times: &[f64],
    certify: CertifyArg,
) -> Result<Trajectory, Failure> {
    let trajectory = match certify {
        CertifyArg::None => solve_until(system, actuation, times, None, &interrupted),
        CertifyArg::Pose => solve_until(system, actuation, times, AS_PRINTED, &interrupted),
        CertifyArg::Motion => proved(system, actuation, times),
    };
    crate::cli::interrupt::refuse_interrupted()?;
    Ok(trajectory)
}

fn interrupted() -> bool {
    crate::cli::interrupt::CANCEL.load(Ordering::Relaxed)
}

fn proved(system: &System, actuation: &Actuation, times: &[f64]) -> Trajectory {
    let mut wanted = times.to_vec();
    let last = times.last().copied().unwrap_or(0.0);
    if times.len() > 1 && last < actuation.duration && is_cyclic(system.mechanism(), actuation) {
        wanted.push(actuation.duration);
    }
    let mut trajectory = solve_until(system, actuation, &wanted, AS_PRINTED, &interrupted);
    if interrupted() {
        return trajectory;
    }
    trajectory.intervals = certify_motion(system, actuation, &trajectory);
    trajectory.samples.truncate(times.len());
    trajectory
}
