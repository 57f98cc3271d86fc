//! A summary of what is proved about a motion: its poses and the intervals between them.

use super::rounded::{at_least, at_most};
use super::sentences;
use super::verdict::{Case, PROOF, Status};
use crate::diag::decimals_of;
use crate::kinematics::results::certificate::{
    CONSISTENT, Certificate, IntervalCertificate, Reason,
};
use crate::kinematics::results::printed::printed_certificate;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Mechanism;
use crate::report::sentences::{beside_unit, counted_things};
use serde_json::{Value, json};

/// The assumptions of a mechanism's proofs, one sentence each.
pub fn proof_assumptions(system: &System) -> Vec<String> {
    let mut list = vec![
        "sine and cosine accurate to one unit in the last place".to_owned(),
        "inputs as printed".to_owned(),
    ];
    let redundant = system.redundant_rows();
    if redundant > 0 {
        let equations = counted_things(redundant, "redundant equation");
        list.push(format!("{equations} bounded, not proved"));
    }
    list
}

/// Summary of the intervals of a motion.
pub struct MotionProof<'t> {
    trajectory: &'t Trajectory,
    certified: usize,
    /// Intervals whose redundant equations are bounded only.
    consistent: usize,
    closes_to: f64,
    tubes: usize,
    radius: f64,
    unique_radius: f64,
}

impl<'t> MotionProof<'t> {
    /// Of the intervals between the samples.
    pub fn of(trajectory: &'t Trajectory) -> Self {
        let mut proof = Self {
            trajectory,
            certified: 0,
            consistent: 0,
            closes_to: 0.0,
            tubes: 0,
            radius: 0.0,
            unique_radius: f64::INFINITY,
        };
        for interval in trajectory.intervals.iter().filter(|i| i.refused.is_none()) {
            match interval.closes_to {
                None => proof.certified += 1,
                Some(closes_to) => {
                    proof.consistent += 1;
                    proof.closes_to = proof.closes_to.max(closes_to);
                }
            }
            proof.tubes += interval.tubes;
            proof.radius = proof.radius.max(interval.radius);
            proof.unique_radius = proof.unique_radius.min(interval.unique_radius);
        }
        proof
    }

    /// Whether every interval is certified or, for redundant equations, consistent.
    pub fn is_whole(&self) -> bool {
        self.proved() == self.trajectory.intervals.len()
    }

    fn proved(&self) -> usize {
        self.certified + self.consistent
    }

    /// The first interval that is not certified: its sample and its certificate.
    fn first_refused(&self) -> Option<(usize, &IntervalCertificate)> {
        let mut intervals = self.trajectory.intervals.iter().enumerate();
        intervals.find(|(_, interval)| interval.refused.is_some())
    }

    /// One line.
    pub fn sentence(&self, mechanism: &Mechanism, actuation: &Actuation) -> String {
        let unit = mechanism.pose_unit();
        // With redundant equations intervals are consistent: these hold as far as rounding allows to judge.
        let word = if self.consistent > 0 {
            CONSISTENT
        } else {
            "certified"
        };
        let mut text = format!(
            "{} of {} intervals {word} in {} tubes",
            self.proved(),
            self.trajectory.intervals.len(),
            self.tubes
        );
        if self.consistent > 0 {
            text.push_str(&format!(
                "; redundant equations close to {} everywhere",
                beside_unit(at_most(self.closes_to), unit)
            ));
        }
        // The tube around the path, and how far around it there is no other motion.
        if self.proved() > 0 {
            text.push_str(&format!(
                "; within {} of the proved path, the only motion{}",
                beside_unit(at_most(self.radius), unit),
                within_radius(self.unique_radius, unit)
            ));
        }
        let refusal = self.first_refused().and_then(|(_, i)| i.refused);
        if let Some(refusal) = refusal {
            let inputs = sentences::input_sentence(mechanism, &actuation.inputs_at(refusal.time));
            let word = refusal.obstacle.word();
            let time = decimals_of(refusal.time, 9);
            text.push_str(&format!(
                "; refused first after t = {time} s ({inputs}): {word}"
            ));
        }
        text
    }

    /// The answer to the question whether the motion is proved between the samples.
    fn status(&self) -> Status {
        match self.is_whole() {
            true => Status::Passed,
            false => Status::NotProved,
        }
    }

    /// The question whether the motion is proved between the samples.
    pub fn case(&self, mechanism: &Mechanism, actuation: &Actuation) -> Case {
        let status = self.status();
        let text = self.sentence(mechanism, actuation);
        Case::new(PROOF, "motion certificate", status, text)
    }

    /// For the JSON report.
    pub fn json(&self) -> Value {
        let intervals = self.trajectory.intervals.iter().enumerate();
        let refused = intervals.filter_map(|(k, interval)| {
            let refusal = interval.refused?;
            Some(json!({
                "after_sample": k,
                "time": refusal.time,
                "because": refusal.obstacle.word(),
            }))
        });
        let any = self.proved() > 0;
        json!({
            "intervals": self.trajectory.intervals.len(),
            "certified": self.certified,
            "consistent": self.consistent,
            "closes_to": (self.consistent > 0).then_some(self.closes_to),
            "tubes": self.tubes,
            "radius": any.then_some(self.radius),
            "unique_radius": any.then_some(self.unique_radius),
            "refused": refused.collect::<Vec<_>>(),
        })
    }
}

/// The verdict on a table of poses. Rows that do not close fail it; the intervals between its rows need a proof if one
/// was requested. A pose that is closed but cannot be certified says so in its row.
pub fn table_status(poses: &PoseProofs, motion: Option<&MotionProof>) -> Status {
    match motion.map(MotionProof::status) {
        _ if poses.open > 0 => Status::Failed,
        Some(status) => status,
        None => Status::Passed,
    }
}

/// `" within 2.5 mm"`; nothing where no unknown could differ.
fn within_radius(radius: f64, unit: &str) -> String {
    match radius.is_finite() {
        true => format!(" within {}", beside_unit(at_least(radius), unit)),
        false => String::new(),
    }
}

/// Summary of the certificates of a motion.
pub struct PoseProofs {
    poses: usize,
    /// Whether there is anything to prove.
    is_closing: bool,
    /// Largest error bound of a certified pose.
    pub error_bound: f64,
    /// Smallest radius of uniqueness.
    pub unique_radius: f64,
    /// Poses without a certificate.
    pub refused: usize,
    /// Proved as rotations only.
    pub locked: usize,
    /// Poses whose redundant equations are bounded only.
    pub consistent: usize,
    /// The largest of those bounds.
    pub closes_to: f64,
    /// Poses that are proved not to close: a redundant equation does not hold.
    pub open: usize,
    /// All reasons for a refusal, in words.
    pub reasons: Vec<&'static str>,
}

impl PoseProofs {
    /// The bounds hold for the poses as tables print them. `is_asked` tells whether certificates were requested: clearances
    /// may have needed more.
    pub fn of(system: &System, trajectory: &Trajectory, is_asked: bool) -> Self {
        let mut proof = Self {
            poses: 0,
            is_closing: !system.structure().blocks.is_empty(),
            error_bound: 0.0,
            unique_radius: f64::INFINITY,
            refused: 0,
            locked: 0,
            consistent: 0,
            closes_to: 0.0,
            open: 0,
            reasons: Vec::new(),
        };
        for pose in trajectory.poses() {
            proof.poses += 1;
            // Certificates that were not requested are not reported.
            let certificate = match is_asked {
                false => Certificate::Refused {
                    reason: Reason::NotAsked,
                },
                true => printed_certificate(system.mechanism(), pose),
            };
            // The whole motion is as good as its worst pose: largest error, smallest uniqueness.
            if let Some([error_bound, unique_radius]) = certificate.bounds() {
                let is_locked = matches!(certificate, Certificate::Locked { .. });
                proof.locked += usize::from(is_locked);
                proof.error_bound = proof.error_bound.max(error_bound);
                proof.unique_radius = proof.unique_radius.min(unique_radius);
            }
            if let Some(closes_to) = certificate.closes_to() {
                proof.consistent += 1;
                proof.closes_to = proof.closes_to.max(closes_to);
            }
            // Refusals are counted, and each reason is named once.
            if let Certificate::Refused { reason } = certificate {
                proof.refused += 1;
                proof.open += usize::from(reason == Reason::Open);
                if !proof.reasons.contains(&reason.word()) {
                    proof.reasons.push(reason.word());
                }
            }
        }
        proof
    }

    /// Itself if any pose is certified; otherwise the bounds are meaningless.
    pub fn certified(&self) -> Option<&Self> {
        (self.is_closing && self.refused < self.poses).then_some(self)
    }

    fn is_asked(&self) -> bool {
        self.reasons != [Reason::NotAsked.word()]
    }

    /// The question whether every pose is proved.
    pub fn case(&self, mechanism: &Mechanism) -> Case {
        let status = match self.refused {
            _ if !self.is_asked() || !self.is_closing => Status::Skipped,
            0 => Status::Passed,
            _ if self.open > 0 => Status::Failed,
            _ => Status::NotProved,
        };
        Case::new(PROOF, "pose certificates", status, self.sentence(mechanism))
    }

    /// One line.
    pub fn sentence(&self, mechanism: &Mechanism) -> String {
        if !self.is_closing {
            return "no loop and no equation: nothing to prove".to_owned();
        }
        if !self.is_asked() {
            return "not requested".to_owned();
        }
        let unit = mechanism.pose_unit();
        let bounds = self.certified().map_or_else(String::new, |p| {
            format!(
                "error at most {}, the only pose{}; ",
                beside_unit(at_most(p.error_bound), unit),
                within_radius(p.unique_radius, unit)
            )
        });
        let reasons = if self.reasons.is_empty() {
            String::new()
        } else {
            format!(" ({})", self.reasons.join(", "))
        };
        let consistent = match self.consistent {
            0 => String::new(),
            n => format!(
                "; {n} {CONSISTENT}: redundant equations close to {}",
                beside_unit(at_most(self.closes_to), unit)
            ),
        };
        let open = match self.open {
            0 => String::new(),
            n => format!("; {n} open: redundant equations do not hold"),
        };
        let locked = match self.locked {
            0 => String::new(),
            n => format!("; {n} in gimbal lock, with the rotation proved"),
        };
        format!(
            "{bounds}refused {} of {}{reasons}{consistent}{open}{locked}",
            self.refused, self.poses
        )
    }
}
