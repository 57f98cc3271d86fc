//! Solving with the requested proofs, until Ctrl-C.

use crate::cli::args::motion::CertifyArg;
use crate::cli::interrupt::{is_interrupted, refuse_interrupted};
use crate::cli::term::outcome::Failure;
use crate::kinematics::motion::proved::{Proofs, solve_proved};
use crate::kinematics::motion::sampling;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;

/// The motion at `times`.
///
/// Errors: Ctrl-C.
pub fn certify_motion(
    system: &System,
    actuation: &Actuation,
    times: &[f64],
    certify: CertifyArg,
) -> Result<Trajectory, Failure> {
    sampling::allow_samples(system.mechanism(), times.len())?;
    let proofs = match certify {
        CertifyArg::None => Proofs::None,
        CertifyArg::Pose => Proofs::Poses,
        CertifyArg::Motion => Proofs::Motion,
    };
    let trajectory = solve_proved(system, actuation, times, proofs, &is_interrupted);
    refuse_interrupted()?;
    Ok(trajectory)
}
