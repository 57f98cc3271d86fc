//! Solving with as much proof as was asked for, and the proof of a motion in words.

use crate::cli::args::motion::CertifyArg;
use crate::cli::report::events as report;
use crate::cli::term::outcome::Failure;
use crate::kinematics::certificate::tube::certify_motion;
use crate::kinematics::motion::continuation::solve_until;
use crate::kinematics::motion::sampling::is_cyclic;
use crate::kinematics::results::certificate::IntervalCertificate;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::block::Structure;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Mechanism;
use serde_json::{Value, json};
use std::sync::atomic::Ordering;

/// The motion at `times`. A cyclic motion is proved up to its end, where it is solved once more for that purpose.
pub fn motion(
    system: &System,
    actuation: &Actuation,
    times: &[f64],
    certify: CertifyArg,
) -> Result<Trajectory, Failure> {
    let trajectory = match certify {
        CertifyArg::None => solve_until(system, actuation, times, false, &interrupted),
        CertifyArg::Pose => solve_until(system, actuation, times, true, &interrupted),
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
    let mut trajectory = solve_until(system, actuation, &wanted, true, &interrupted);
    if interrupted() {
        return trajectory;
    }
    trajectory.intervals = certify_motion(system, actuation, &trajectory);
    trajectory.samples.truncate(times.len());
    trajectory
}

/// What the proofs rest on, one sentence each; none where nothing was to be proved.
pub fn assumptions(structure: &Structure, certify: CertifyArg) -> Vec<String> {
    if certify == CertifyArg::None {
        return Vec::new();
    }
    let mut list = vec![
        "sine and cosine right within one unit in the last place".to_owned(),
        "inputs as printed".to_owned(),
    ];
    let unknowns: usize = structure.blocks.iter().map(|b| b.unknowns.len()).sum();
    let dropped = structure.equation_count().saturating_sub(unknowns);
    if dropped > 0 {
        list.push(format!("{dropped} dependent equations checked, not proved"));
    }
    let empty = structure.empty_equations.len();
    if empty > 0 {
        list.push(format!(
            "{empty} equations empty at random poses hold at all"
        ));
    }
    list
}

/// The intervals of a motion, summed up.
pub struct MotionProof<'t> {
    trajectory: &'t Trajectory,
    certified: usize,
    tubes: usize,
    radius: f64,
    unique_radius: f64,
}

impl<'t> MotionProof<'t> {
    /// `None` where nobody asked for it.
    pub fn of(trajectory: &'t Trajectory, certify: CertifyArg) -> Option<Self> {
        let mut proof = Self {
            trajectory,
            certified: 0,
            tubes: 0,
            radius: 0.0,
            unique_radius: f64::INFINITY,
        };
        for interval in trajectory.intervals.iter().filter(|i| i.refused.is_none()) {
            proof.certified += 1;
            proof.tubes += interval.tubes;
            proof.radius = proof.radius.max(interval.radius);
            proof.unique_radius = proof.unique_radius.min(interval.unique_radius);
        }
        (certify == CertifyArg::Motion).then_some(proof)
    }

    /// Whether every interval is certified.
    pub fn is_whole(&self) -> bool {
        self.certified == self.trajectory.intervals.len()
    }

    /// The first interval that is not certified: its sample and its certificate.
    fn first_refused(&self) -> Option<(usize, &IntervalCertificate)> {
        let mut intervals = self.trajectory.intervals.iter().enumerate();
        intervals.find(|(_, interval)| interval.refused.is_some())
    }

    /// One line.
    pub fn sentence(&self, mechanism: &Mechanism, actuation: &Actuation) -> String {
        let unit = &mechanism.length_unit;
        let mut text = format!(
            "{} of {} intervals certified in {} tubes",
            self.certified,
            self.trajectory.intervals.len(),
            self.tubes
        );
        if self.certified > 0 {
            text.push_str(&format!(
                "; within {:.1e} {unit} of the proved path, the only motion within {} {unit}",
                self.radius,
                report::radius(self.unique_radius)
            ));
        }
        let refusal = self.first_refused().and_then(|(_, i)| i.refused);
        if let Some(refusal) = refusal {
            let inputs = report::inputs(mechanism, &actuation.inputs_at(refusal.time));
            let word = refusal.obstacle.word();
            let time = refusal.time;
            text.push_str(&format!(
                "; refused first after t = {time:.9} s ({inputs}): {word}"
            ));
        }
        text
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
        let any = self.certified > 0;
        json!({
            "intervals": self.trajectory.intervals.len(),
            "certified": self.certified,
            "tubes": self.tubes,
            "radius": any.then_some(self.radius),
            "unique_radius": any.then_some(self.unique_radius),
            "refused": refused.collect::<Vec<_>>(),
        })
    }
}
