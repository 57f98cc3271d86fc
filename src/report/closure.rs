//! The questions whether a motion closes, and whether a given pose does.

use super::event_sentences::gap_sentence;
use super::sentences::{angles_note, samples_without_pose};
use super::verdict::{Case, MOTION, Status};
use crate::diag::decimals_of;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::solve::pose_check::{ClosureCheck, ClosureGap, LoopVerdict};
use crate::model::mechanism::Mechanism;
use crate::numbers::decimal::rounded_to;
use serde_json::{Value, json};

/// The question that every check begins with.
const CLOSES: &str = "motion closes";

/// Whether there is a pose at every sample and between them.
pub fn closing_case(mechanism: &Mechanism, trajectory: &Trajectory) -> Case {
    let (samples, missing) = (trajectory.samples.len(), trajectory.missing());
    let counted = match missing {
        0 => format!("{samples} samples, all with a pose"),
        _ => samples_without_pose(missing, samples),
    };
    let gaps = trajectory.gaps.iter().map(|g| gap_sentence(mechanism, g));
    let text: Vec<String> = [counted].into_iter().chain(gaps).collect();
    let status = if trajectory.is_whole() {
        Status::Passed
    } else if trajectory.is_undecided() {
        Status::NotProved
    } else {
        Status::NotClosed
    };
    Case::new(MOTION, CLOSES, status, text.join("; "))
}

/// The same for a loop that no pose closes, for the reason `why`.
pub fn unclosed_case(why: &str) -> Case {
    Case::new(MOTION, CLOSES, Status::NotClosed, why)
}

/// Whether the poses are closed to `allowed`, relative to the mechanism's size or to the terms of its equations.
pub fn closure_case(mechanism: &Mechanism, trajectory: &Trajectory, allowed: f64) -> Case {
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
    // Without the digits that only a sum of decimals adds.
    let shown = rounded_to(size, 13);
    let is_one = mechanism.loops.iter().all(|item| item.size == size);
    let measure = match is_one {
        _ if !mechanism.has_lengths() => "the terms of each equation".to_owned(),
        true => format!("{shown} {unit}"),
        false => format!("the size of each loop, at most {shown} {unit}"),
    };
    format!("{worst:.2e} (allowed {allowed:.0e}, relative to {measure})")
}

/// Whether a loop or an equation is closed at a given pose.
pub fn offered_case(mechanism: &Mechanism, item: &ClosureCheck) -> Case {
    let status = match item.verdict {
        LoopVerdict::Closed => Status::Passed,
        LoopVerdict::HalfTurn | LoopVerdict::Open => Status::Failed,
    };
    let name = match item.gap {
        ClosureGap::Loop { .. } => format!("loop {}", item.name),
        ClosureGap::Equation(_) => format!("equation {}", item.name),
    };
    Case::new(MOTION, &name, status, offered_sentence(mechanism, item))
}

/// The word of a verdict on a given pose.
fn verdict_word(verdict: LoopVerdict) -> &'static str {
    match verdict {
        LoopVerdict::Closed => "closed",
        LoopVerdict::HalfTurn => "half-turn",
        LoopVerdict::Open => "open",
    }
}

/// Loops and equations at a given pose, for the JSON report.
pub fn offered_json(list: &[ClosureCheck]) -> [Vec<Value>; 2] {
    let (mut loops, mut equations) = (Vec::new(), Vec::new());
    for ClosureCheck { name, gap, verdict } in list {
        let verdict = verdict_word(*verdict);
        match gap {
            ClosureGap::Loop { angle, distance } => loops.push(json!({
                "loop": name, "angle": angle, "distance": distance, "verdict": verdict
            })),
            ClosureGap::Equation(value) => equations.push(json!({
                "equation": name, "value": value, "verdict": verdict
            })),
        }
    }
    [loops, equations]
}

fn offered_sentence(mechanism: &Mechanism, item: &ClosureCheck) -> String {
    let unit = &mechanism.length_unit;
    let (angle, distance) = match item.gap {
        ClosureGap::Loop { angle, distance } => (angle, distance),
        ClosureGap::Equation(value) => {
            let bar = mechanism.bars.iter().find(|bar| bar.name == item.name);
            let off = match bar.and_then(|bar| bar.off_length(value)) {
                Some(off) => format!("{off:.1e} {unit}"),
                None => format!("{value:.1e}{}", angles_note(mechanism)),
            };
            return format!("{} (off by {off})", verdict_word(item.verdict));
        }
    };
    let [turned, apart] = [angle, distance].map(|v| decimals_of(v, 6));
    let gap = format!("{turned} rad and {apart} {unit}");
    match item.verdict {
        LoopVerdict::Closed => format!("closed (off by {angle:.1e} rad and {distance:.1e} {unit})"),
        LoopVerdict::HalfTurn => format!(
            "half-turn, not closed: the ends meet turned by π ({gap}); a residual of off-diagonal entries takes this for a solution"
        ),
        LoopVerdict::Open => format!("open by {gap}"),
    }
}
