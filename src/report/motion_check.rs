//! The check of a whole motion, shared by the program and the library, which add their own messages about progress and
//! failure.

use super::between::BetweenSamples;
use super::check::{MotionReport, without_pose};
use super::verdict::{CheckRequirements, Verdict};
use super::{closure, measures};
use crate::clearance::check::{ClearanceEffort, ClearanceReport, check_over};
use crate::clearance::closer::{is_cheap, solve_closely, unproved};
use crate::clearance::covered::CoveredMotion;
use crate::clearance::motion::ProvedMotion;
use crate::kinematics::certificate::tube::certify_motion;
use crate::kinematics::motion::proved::{Proofs, solve_proved};
use crate::kinematics::motion::sampling::{allow_samples, knot_times};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::limits::{LimitExceeded, Resource, current_limits};
use crate::model::printed::InputReading;
use crate::scene::Scene;
use serde_json::Value;

/// The subject and the options of a check.
pub struct MotionCheck<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its mechanism, ready to be solved.
    pub system: &'a System,
    /// Seconds at which the motion is sampled.
    pub times: &'a [f64],
    /// The requirements, and the requested proofs.
    pub asked: CheckRequirements,
    /// Requested accuracy of the bounds of distances.
    pub closely: ClearanceEffort,
    /// Whether swept volumes are requested as well, which need tubes.
    pub is_swept: bool,
    /// Rows of the table of pairs in the text.
    pub worst: usize,
}

/// What a check found.
pub struct MotionAnswer {
    /// Lines for people.
    pub text: String,
    /// The JSON report.
    pub document: Value,
    /// The one verdict.
    pub verdict: Verdict,
    /// Results about the motion and its proof, one line each with its heading; none without a pose.
    pub motion: Vec<(String, String)>,
    /// Results about the freedoms, one line each with its heading.
    pub freedoms: Vec<(String, String)>,
}

impl<'a> MotionCheck<'a> {
    /// Tubes, which bound the clearances, connect certified poses: more may be proved than is requested.
    fn proofs(&self) -> Proofs {
        let needs_tubes = self.scene.clearance.is_some()
            || self.is_swept
            || measures::needs_certified_poses(self.scene);
        match (self.asked.motion, self.asked.poses || needs_tubes) {
            (true, _) => Proofs::Motion,
            (false, true) => Proofs::Poses,
            (false, false) => Proofs::None,
        }
    }

    /// The motion at the asked times and at the keys of its drives, until `cancelled` says so; and what is proved between them,
    /// if poses are to be proved and that costs little.
    ///
    /// Errors: more samples than a run may have.
    pub fn solve(
        &self,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<(Trajectory, Option<ProvedMotion<'a>>), LimitExceeded> {
        let (system, actuation) = (self.system, &self.scene.actuation);
        let times = self.knots()?;
        let proofs = self.proofs();
        if !self.looks_between(times.len()) {
            let trajectory = solve_proved(system, actuation, &times, proofs, cancelled);
            return Ok((trajectory, None));
        }
        let reading = InputReading::Decimals;
        let (mut trajectory, motion) = solve_closely(system, actuation, &times, reading, cancelled);
        if proofs == Proofs::Motion && !cancelled() {
            trajectory.intervals = certify_motion(system, actuation, &trajectory);
        }
        Ok((trajectory, Some(motion)))
    }

    /// The same motion with proofs of its poses at most: what can be shown at once.
    ///
    /// Errors: more samples than a run may have.
    pub fn sampled(&self) -> Result<Trajectory, LimitExceeded> {
        let proofs = match self.proofs() {
            Proofs::None => Proofs::None,
            Proofs::Poses | Proofs::Motion => Proofs::Poses,
        };
        let (times, actuation) = (self.knots()?, &self.scene.actuation);
        Ok(solve_proved(
            self.system,
            actuation,
            &times,
            proofs,
            &|| false,
        ))
    }

    /// The asked times and the keys of the drives.
    fn knots(&self) -> Result<Vec<f64>, LimitExceeded> {
        let mechanism = self.system.mechanism();
        let times = knot_times(mechanism, &self.scene.actuation, self.times);
        allow_samples(mechanism, times.len())?;
        Ok(times)
    }

    /// Whether the motion between so many samples is examined without a request: where poses are to be proved, and the proofs cost
    /// little beside the motion.
    fn looks_between(&self, samples: usize) -> bool {
        self.asked.poses && is_cheap(self.system, samples)
    }

    /// The motion between the samples of a trajectory, for all that is asked of it; `proved` is what is known already.
    pub fn cover<'t>(
        &self,
        trajectory: &'t Trajectory,
        proved: Option<ProvedMotion<'t>>,
    ) -> CoveredMotion<'t>
    where
        'a: 't,
    {
        CoveredMotion::new(self.system, &self.scene.actuation, trajectory, proved)
    }

    /// The clearances that the scene asks for; `None` if it asks for none. `progress` hears of pairs done and of all.
    ///
    /// Errors: more pairs than a run may have.
    pub fn clearances(
        &self,
        covered: &mut CoveredMotion,
        progress: &dyn Fn(usize, usize),
    ) -> Result<Option<ClearanceReport>, LimitExceeded> {
        let Some(rules) = &self.scene.clearance else {
            return Ok(None);
        };
        let bodies = self.scene.mechanism.bodies.iter();
        let bodies = bodies.filter(|body| !body.shapes.is_empty()).count();
        let pairs = bodies as f64 * (bodies as f64 - 1.0) / 2.0;
        let who = format!("[clearance] of {bodies} bodies");
        current_limits().allow(Resource::Pairs, pairs, &who)?;
        // Proving the motion and sorting the triangles of meshes may take a while.
        progress(0, 1);
        let found = check_over(covered.proved(), rules, self.closely, progress);
        Ok(Some(found))
    }

    /// All questions with their answers, for a motion that has poses and took `seconds` to solve.
    pub fn answer(
        &self,
        trajectory: &Trajectory,
        covered: &mut CoveredMotion,
        clearances: Option<&ClearanceReport>,
        seconds: f64,
    ) -> MotionAnswer {
        let (system, scene, tolerance) = (self.system, self.scene, self.closely.tolerance);
        let sampled = (trajectory, self.times);
        let measured = measures::take_whole(system, scene, sampled, covered, tolerance);
        let driven = (system, &scene.actuation);
        // Where poses are missing that is said instead.
        let between =
            (trajectory.is_whole() && self.asked.poses && !self.asked.motion).then(|| {
                let looks = self.looks_between(trajectory.samples.len());
                let unproved = looks.then(|| unproved(covered.proved()));
                let [first, last] = covered.proved().span();
                let closes_to = covered.proved().closes_to();
                BetweenSamples::new(unproved, last - first, closes_to)
                    .between_jumps(&covered.proved().jumps)
                    .cut_off(covered.proved().is_late())
            });
        let report = MotionReport::new(driven, trajectory, self.asked, &measured, clearances)
            .between(between);
        let verdict = report.verdict(seconds);
        MotionAnswer {
            text: report.text(&verdict, self.worst),
            document: report.json(&verdict),
            motion: owned_lines(report.motion_lines()),
            freedoms: owned_lines(report.freedoms_lines()),
            verdict,
        }
    }

    /// The answer if no sample has a pose; `why` gives details.
    pub fn without_pose(&self, trajectory: &Trajectory, why: Option<&str>) -> MotionAnswer {
        let mechanism = &self.scene.mechanism;
        let mut case = closure::closing_case(mechanism, trajectory);
        if let Some(why) = why {
            case.text = format!("{}; {why}", case.text);
        }
        let verdict = Verdict {
            title: mechanism.title.clone(),
            cases: vec![case],
        };
        MotionAnswer {
            text: format!("{}\n  result: {}\n", mechanism.title, verdict.sentence()),
            document: without_pose(mechanism, trajectory, &verdict),
            motion: Vec::new(),
            freedoms: Vec::new(),
            verdict,
        }
    }
}

fn owned_lines(lines: Vec<(&str, String)>) -> Vec<(String, String)> {
    let lines = lines.into_iter();
    lines.map(|(head, text)| (head.to_owned(), text)).collect()
}
