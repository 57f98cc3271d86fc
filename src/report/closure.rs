//! The questions whether a motion closes, and whether an offered pose does.

use super::sentences::gap_sentence;
use super::verdict::{Case, MOTION, Status};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::solve::pose_check::{OfferedLoop, Verdict};
use crate::model::mechanism::Mechanism;

/// Whether there is a pose at every sample and between them.
pub fn closes(mechanism: &Mechanism, trajectory: &Trajectory) -> Case {
    let (samples, missing) = (trajectory.samples.len(), trajectory.missing());
    let counted = match missing {
        0 => format!("{samples} samples, all with a pose"),
        _ => format!("{missing} of {samples} samples have no pose"),
    };
    let gaps = trajectory.gaps.iter().map(|g| gap_sentence(mechanism, g));
    let text: Vec<String> = [counted].into_iter().chain(gaps).collect();
    let status = match trajectory.is_whole() {
        true => Status::Passed,
        false => Status::NotClosed,
    };
    Case::new(MOTION, "motion closes", status, text.join("; "))
}

/// Whether the poses are closed to `allowed`, relative to the mechanism's size.
pub fn error(mechanism: &Mechanism, trajectory: &Trajectory, allowed: f64) -> Case {
    let worst = trajectory.closure_error();
    let status = match worst <= allowed {
        true => Status::Passed,
        false => Status::Failed,
    };
    Case::new(
        MOTION,
        "closure error",
        status,
        error_sentence(mechanism, worst, allowed),
    )
}

/// A closure error with what is allowed.
pub fn error_sentence(mechanism: &Mechanism, worst: f64, allowed: f64) -> String {
    let (size, unit) = (mechanism.size, &mechanism.length_unit);
    format!("{worst:.2e} (allowed {allowed:.0e}, relative to {size} {unit})")
}

/// Whether a loop is closed at an offered pose.
pub fn offered(mechanism: &Mechanism, item: &OfferedLoop) -> Case {
    let status = match item.verdict {
        Verdict::Closed => Status::Passed,
        Verdict::HalfTurn | Verdict::Open => Status::Failed,
    };
    Case::new(
        MOTION,
        &item.name,
        status,
        offered_sentence(mechanism, item),
    )
}

/// The word of a loop's verdict.
pub fn offered_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Closed => "closed",
        Verdict::HalfTurn => "half-turn",
        Verdict::Open => "open",
    }
}

fn offered_sentence(mechanism: &Mechanism, item: &OfferedLoop) -> String {
    let (angle, distance, unit) = (item.angle, item.distance, &mechanism.length_unit);
    let gap = format!("{angle:.6} rad and {distance:.6} {unit}");
    match item.verdict {
        Verdict::Closed => format!("closed (off by {angle:.1e} rad and {distance:.1e} {unit})"),
        Verdict::HalfTurn => format!(
            "half-turn, not closed: the ends meet turned by π ({gap}); a residual of off-diagonal entries takes this for a solution"
        ),
        Verdict::Open => format!("open by {gap}"),
    }
}
