//! Verification of a synthesis: the scene is read again with the values found, and the motion solver, independently of
//! the search, follows its whole drive in fine steps. Poses are certified, the tracks are measured four times as
//! finely, the drive must close, and the bodies are checked against each other.

use super::plan::FINER;
use crate::analysis::observer::{largest_distance, marked_positions};
use crate::analysis::study::whole_limits::{WholeLimit, whole_limits};
use crate::analysis::study::{DRIVE_SAMPLES, FamilyError};
use crate::clearance::check::{ClearanceEffort, ClearanceReport, check_clearance};
use crate::diag::Source;
use crate::kinematics::measures::{DriveSamples, measure_motion};
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::motion::sampling::{end_apart, is_cyclic, knot_times, measured_times};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::measure::Measures;
use crate::model::mechanism::Mechanism;
use crate::scene::{Overrides, load_scene};
use std::sync::Arc;

/// Steps of the drive: a quarter of a degree of a full turn.
const STEPS: usize = 1440;

/// Samples of the drive at which distances of bodies are listed; between them they are bounded.
const CLEARANCE_SAMPLES: usize = 361;

/// A cyclic drive has closed if everything returns to within this, in mechanism sizes.
const CLOSED: f64 = 1e-9;

/// What was found out.
#[derive(Clone, Debug)]
pub struct Proof {
    /// Number of poses, including missing ones.
    pub poses: usize,
    /// Poses that do not exist.
    pub missing: usize,
    /// Poses without a certificate.
    pub unproved: usize,
    /// Largest certified error of a coordinate.
    pub error_bound: f64,
    /// Whether determinant signs are the same throughout.
    pub one_branch: bool,
    /// Distance of bodies and traces from their first positions after a cyclic drive, in the scene's unit.
    pub open: Option<f64>,
    /// Whether that is rounding.
    pub closed: bool,
    /// Measures of the finer tracks; `None` where one has no value.
    pub measures: Vec<Option<f64>>,
    /// Limited measures of the drive over the whole of it.
    pub whole: Vec<WholeLimit>,
    /// Bodies that are meant to touch but separate or penetrate, by name.
    pub cutting: Vec<[String; 2]>,
    /// Other bodies that penetrate: the shapes do not fit the dimensions found.
    pub meeting: Vec<[String; 2]>,
    /// Number of pairs examined.
    pub pairs: usize,
}

impl Proof {
    /// A limit of the drive that is not proved to be kept between the samples.
    pub fn unkept(&self) -> Option<&WholeLimit> {
        self.whole.iter().find(|whole| !whole.is_kept())
    }

    /// Everything but the drawing.
    pub fn holds(&self) -> bool {
        let moves = self.missing == 0 && self.unproved == 0 && self.one_branch;
        let measured = self.measures.iter().all(Option::is_some);
        moves && self.closed && self.cutting.is_empty() && measured && self.unkept().is_none()
    }
}

/// Measures on the finer tracks, and along the fine motion; those that depend on the number of poses at the poses of the study.
fn proved_measures(
    system: &System,
    actuation: &Actuation,
    [asked, finer]: [&Measures; 2],
    fine: &Trajectory,
) -> Vec<Option<f64>> {
    let mut list = measure_motion(system, actuation, finer, DriveSamples::all(&fine.samples));
    let counted = asked.depend_on_count(actuation.drives.len());
    if counted.contains(&true) {
        let mechanism = system.mechanism();
        let times = measured_times(mechanism, actuation, asked, DRIVE_SAMPLES);
        let motion = solve_motion(system, actuation, &times);
        let is_apart = end_apart(mechanism, actuation, asked).is_some();
        let along = DriveSamples::with_end(&motion.samples, is_apart);
        let own = measure_motion(system, actuation, asked, along);
        for (value, (own, counted)) in list.iter_mut().zip(own.into_iter().zip(counted)) {
            if counted {
                *value = own;
            }
        }
    }
    list
}

/// Follows the scene with the given overrides.
///
/// # Errors
/// A scene that cannot be read with these values, or has no motion.
pub fn prove_found(source: &Source, overrides: &Overrides) -> Result<Proof, FamilyError> {
    // Solved again on a finer grid than that of the search.
    let mut scene = load_scene(source, overrides).map_err(Box::new)?;
    scene.keep_limits_of_study();
    let asked = Arc::clone(&scene.measures);
    for track in &mut Arc::make_mut(&mut scene.measures).tracks {
        track.samples = FINER * (track.samples - 1) + 1;
    }
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    let system = System::new(Arc::clone(mechanism), actuation)?;
    let times: Vec<f64> = (0..=STEPS)
        .map(|k| actuation.duration * k as f64 / STEPS as f64)
        .collect();
    // Breaks and keys of the drive are poses of their own.
    let times = knot_times(system.mechanism(), actuation, &times);
    let trajectory = solve_motion(&system, actuation, &times);
    let mut proof = Proof {
        poses: trajectory.samples.len(),
        missing: trajectory.missing(),
        unproved: 0,
        error_bound: 0.0,
        one_branch: true,
        open: None,
        closed: true,
        measures: proved_measures(&system, actuation, [&asked, &scene.measures], &trajectory),
        whole: whole_limits(&scene)?,
        cutting: Vec::new(),
        meeting: Vec::new(),
        pairs: 0,
    };
    // Every pose proved, all of them on one branch.
    let mut branch: Option<&str> = None;
    for pose in trajectory.poses() {
        match pose.certificate.bounds() {
            Some([error_bound, _]) => proof.error_bound = proof.error_bound.max(error_bound),
            None => proof.unproved += 1,
        }
        proof.one_branch &= *branch.get_or_insert(&pose.branch) == pose.branch;
    }
    // A cycle must end where it began.
    let ends = [trajectory.samples.first(), trajectory.samples.last()];
    if let [Some(first), Some(last)] = ends
        && is_cyclic(mechanism, actuation)
    {
        let at = |sample: &crate::kinematics::results::trajectory::Sample| {
            let pose = sample.pose.as_ref()?;
            Some(pivot_places(mechanism, &pose.unknowns, &sample.inputs))
        };
        let open = at(first)
            .zip(at(last))
            .map(|(a, b)| largest_distance(&a, &b));
        proof.closed = open.is_some_and(|d| d <= CLOSED * mechanism.size);
        proof.open = open;
    }
    // Clearances over the whole motion, from fewer samples.
    if let Some(rules) = &scene.clearance {
        let times: Vec<f64> = (0..CLEARANCE_SAMPLES)
            .map(|k| actuation.duration * k as f64 / (CLEARANCE_SAMPLES - 1) as f64)
            .collect();
        let coarse = solve_motion(
            &system,
            actuation,
            &knot_times(system.mechanism(), actuation, &times),
        );
        let tolerance = ClearanceEffort::TOLERANCE;
        let report = check_clearance(
            &system,
            actuation,
            rules,
            &coarse,
            ClearanceEffort::to(tolerance),
            &|_, _| {},
        );
        proof.note(mechanism, &rules.touching, &report);
    }
    Ok(proof)
}

/// Positions of bodies and traces, and directions of the unknowns.
fn pivot_places(mechanism: &Mechanism, unknowns: &[f64], inputs: &[f64]) -> Vec<f64> {
    marked_positions(mechanism, &[unknowns, inputs].concat())
}

impl Proof {
    fn note(&mut self, mechanism: &Mechanism, touching: &[[usize; 2]], report: &ClearanceReport) {
        self.pairs = report.judged.len();
        for pair in &report.judged {
            if !pair.judgement.is_kept() {
                let names = pair.pair.map(|k| mechanism.bodies[k].name.clone());
                if touching.contains(&pair.pair) {
                    self.cutting.push(names);
                } else {
                    self.meeting.push(names);
                }
            }
        }
    }
}
