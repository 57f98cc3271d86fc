//! The report on a whole motion as text and as JSON: the results of all parts, and the one verdict.

use super::between::BetweenSamples;
use super::clearance;
use super::clearance_json;
use super::clearance_table::clearance_table;
use super::closure;
use super::event_sentences::event_sentence;
use super::events::gap_list;
use super::freedoms;
use super::measures::TakenMeasure;
use super::proof::{MotionProof, PoseProofs, proof_assumptions};
use super::verdict::{CLEARANCE, CheckRequirements, Verdict};
use crate::clearance::check::ClearanceReport;
use crate::kinematics::freedoms::mobility::Mobility;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Mechanism;
use serde_json::{Value, json};

/// All results about a motion.
pub struct MotionReport<'a> {
    mechanism: &'a Mechanism,
    actuation: &'a Actuation,
    trajectory: &'a Trajectory,
    asked: CheckRequirements,
    mobility: Mobility,
    poses: PoseProofs,
    motion: Option<MotionProof<'a>>,
    between: Option<BetweenSamples>,
    assumptions: Vec<String>,
    measured: &'a [TakenMeasure<'a>],
    clearances: Option<&'a ClearanceReport>,
}

impl<'a> MotionReport<'a> {
    /// Summarises a motion that has poses.
    pub fn new(
        (system, actuation): (&'a System, &'a Actuation),
        trajectory: &'a Trajectory,
        asked: CheckRequirements,
        measured: &'a [TakenMeasure<'a>],
        clearances: Option<&'a ClearanceReport>,
    ) -> Self {
        let is_proving =
            !system.structure().blocks.is_empty() || asked.motion || clearances.is_some();
        let assumptions = match asked.poses && is_proving {
            true => proof_assumptions(system),
            false => Vec::new(),
        };
        Self {
            mechanism: system.mechanism(),
            actuation,
            trajectory,
            asked,
            mobility: Mobility::new(system, actuation),
            poses: PoseProofs::of(system, trajectory, asked.poses),
            motion: asked.motion.then(|| MotionProof::of(trajectory)),
            between: None,
            assumptions,
            measured,
            clearances,
        }
    }

    /// With what is known of the motion between the samples.
    pub fn between(self, between: Option<BetweenSamples>) -> Self {
        Self { between, ..self }
    }

    /// Every question with its answer; the motion took `seconds` to solve.
    pub fn verdict(&self, seconds: f64) -> Verdict {
        let (mechanism, trajectory) = (self.mechanism, self.trajectory);
        let mut cases = vec![closure::closing_case(mechanism, trajectory).taking(seconds)];
        cases.push(closure::closure_case(
            mechanism,
            trajectory,
            self.asked.closure,
        ));
        cases.push(self.poses.case(mechanism));
        let motion = self.motion.iter();
        cases.extend(motion.map(|proof| proof.case(mechanism, self.actuation)));
        let between = self.between.iter();
        cases.extend(between.map(|found| found.case(mechanism, self.actuation)));
        cases.extend(self.measured.iter().map(|m| m.case(self.asked)));
        if let Some(report) = self.clearances {
            cases.extend(clearance::clearance_cases(mechanism, report, self.asked));
        }
        Verdict {
            title: mechanism.title.clone(),
            cases,
        }
    }

    /// Smallest singular value of all poses; `None` if there are no unknowns.
    fn sigma(&self) -> Option<f64> {
        let poses = self.trajectory.poses().map(|p| p.sigma_min);
        let least = poses.fold(f64::INFINITY, f64::min);
        least.is_finite().then_some(least)
    }

    /// Largest condition number, likewise; infinite at singular poses.
    fn worst_condition(&self) -> Option<f64> {
        let poses = self.trajectory.poses().map(|p| p.condition);
        self.sigma().map(|_| poses.fold(0.0, f64::max))
    }

    /// The branch signatures met, in order.
    fn branches(&self) -> Vec<&str> {
        let signatures = self.trajectory.poses().map(|p| p.branch.as_str());
        let mut list: Vec<&str> = signatures.filter(|s| !s.is_empty()).collect();
        list.dedup();
        list
    }

    /// Results about the motion and its proof, one line each with its heading.
    pub fn motion_lines(&self) -> Vec<(&str, String)> {
        let (mechanism, trajectory) = (self.mechanism, self.trajectory);
        let samples = trajectory.samples.len();
        let mut lines = vec![(
            "samples",
            format!("{samples} ({} without a pose)", trajectory.missing()),
        )];
        if let (Some(sigma), Some(condition)) = (self.sigma(), self.worst_condition()) {
            let error = trajectory.closure_error();
            let error = closure::error_sentence(mechanism, error, self.asked.closure);
            lines.push(("closure error", error));
            lines.push(("smallest sigma", sigma_text(sigma)));
            lines.push(("condition", format!("{condition:.1}")));
            lines.push(("branch", self.branches().join(" ")));
            lines.push(("certificate", self.poses.sentence(mechanism)));
        }
        let motion = self.motion.iter();
        lines.extend(motion.map(|proof| ("motion", proof.sentence(mechanism, self.actuation))));
        let between = self.between.iter();
        lines.extend(between.map(|b| ("between samples", b.sentence(mechanism, self.actuation))));
        if !self.assumptions.is_empty() {
            lines.push(("assumed", self.assumptions.join("; ")));
        }
        lines
    }

    /// Results about the freedoms, one line each with its heading.
    pub fn freedoms_lines(&self) -> Vec<(&'static str, String)> {
        freedoms::freedoms_lines(self.mechanism, &self.mobility)
    }

    /// Lines for people; the table shows the `worst` pairs.
    pub fn text(&self, verdict: &Verdict, worst: usize) -> String {
        let mechanism = self.mechanism;
        let mut lines = self.motion_lines();
        lines.extend(self.measured.iter().map(|m| (m.name(), m.sentence())));
        lines.extend(self.freedoms_lines());
        let lines: String = lines.iter().map(case_line).collect();
        let pairs = self
            .clearances
            .map(|found| clearance_table(mechanism, found, worst));
        format!(
            "{}\n{lines}{}{}",
            mechanism.title,
            pairs.unwrap_or_default(),
            case_line(&("result", verdict.sentence()))
        )
    }

    /// The JSON document.
    pub fn json(&self, verdict: &Verdict) -> Value {
        let (mechanism, trajectory) = (self.mechanism, self.trajectory);
        let certified = self.poses.certified();
        let events = trajectory.events.iter();
        let result = (verdict.result_of(CLEARANCE), self.asked.band);
        let clearance = self
            .clearances
            .map(|found| clearance_json::to_json(mechanism, found, result));
        json!({
            "schema": "mechanim-check/1",
            "title": mechanism.title,
            "samples": trajectory.samples.len(),
            "missing": trajectory.missing(),
            "closure_error": trajectory.closure_error(),
            "tolerance": self.asked.closure,
            "size": mechanism.size,
            "sigma_min": self.sigma(),
            "condition": self.worst_condition().filter(|c| c.is_finite()),
            "branches": self.branches(),
            "error_bound": certified.map(|p| p.error_bound),
            "unique_radius": certified.map(|p| p.unique_radius).filter(|r| r.is_finite()),
            "refused": self.poses.refused,
            "refused_because": self.poses.reasons,
            "locked": self.poses.locked,
            "consistent": self.poses.consistent,
            "closes_to": (self.poses.consistent > 0).then_some(self.poses.closes_to),
            "measures": self.measured.iter().map(|m| m.json(self.asked)).collect::<Vec<_>>(),
            "assumed": self.assumptions,
            "motion": self.motion.as_ref().map(MotionProof::json),
            "between": self.between.as_ref().map(BetweenSamples::json),
            "mobility": freedoms::freedoms_document(mechanism, &self.mobility),
            "events": events.map(|e| event_sentence(mechanism, e)).collect::<Vec<_>>(),
            "clearance": clearance,
            "gaps": gap_list(mechanism, trajectory),
            "checks": verdict.json(),
            "result": verdict.result().word(),
        })
    }
}

/// The JSON document of a motion without any pose.
pub fn without_pose(mechanism: &Mechanism, trajectory: &Trajectory, verdict: &Verdict) -> Value {
    let events = trajectory.events.iter();
    json!({
        "schema": "mechanim-check/1",
        "title": mechanism.title,
        "samples": trajectory.samples.len(),
        "missing": trajectory.missing(),
        "size": mechanism.size,
        "events": events.map(|e| event_sentence(mechanism, e)).collect::<Vec<_>>(),
        "gaps": gap_list(mechanism, trajectory),
        "checks": verdict.json(),
        "result": verdict.result().word(),
    })
}

/// Singular values below this are shown in scientific notation instead of decimals.
const SMALL_SIGMA: f64 = 1e-3;

fn sigma_text(sigma: f64) -> String {
    match sigma > 0.0 && sigma < SMALL_SIGMA {
        true => format!("{sigma:.3e}"),
        false => format!("{sigma:.4}"),
    }
}

/// One line of the report with its head.
fn case_line((head, text): &(&str, String)) -> String {
    format!("  {head:<16} {text}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_singular_value_is_not_zero() {
        for (sigma, text) in [
            (0.46944, "0.4694"),
            (1e-3, "0.0010"),
            (9.87654e-4, "9.877e-4"),
            (3e-17, "3.000e-17"),
            (0.0, "0.0000"),
        ] {
            assert_eq!(sigma_text(sigma), text);
        }
    }
}
