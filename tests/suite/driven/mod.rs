//! Mechanisms with what drives them, as most tests use them: read, changed here and there, solved at some times.

use glam::DVec3;
use mechanim::clearance::check::{ClearanceEffort, ClearanceReport, Judgement, PairReport};
use mechanim::distance::bodies::{BodyElements, nearest_bodies};
use mechanim::kinematics::certificate::tube;
use mechanim::kinematics::motion::feasible::Feasible;
use mechanim::kinematics::motion::{continuation, feasible, limits, sampling};
use mechanim::kinematics::rates::columns::{self, RateColumns};
use mechanim::kinematics::results::certificate::IntervalCertificate;
use mechanim::kinematics::results::trajectory::{ClosedPose, Trajectory};
use mechanim::kinematics::structure::block::StructureError;
use mechanim::kinematics::structure::system::System;
use mechanim::model::actuation::Actuation;
use mechanim::model::measure::Measures;
use mechanim::model::mechanism::Mechanism;
use mechanim::scene::Scene;
use std::collections::HashSet;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

/// Something with a mechanism and its drives.
pub trait Driven {
    /// The mechanism.
    fn mechanism(&self) -> &Arc<Mechanism>;
    /// What drives it.
    fn actuation(&self) -> &Actuation;
    /// Ready to be solved: analysed anew, so that a test may have changed anything.
    fn system(&self) -> Result<System, StructureError> {
        System::new(Arc::clone(self.mechanism()), self.actuation())
    }
}

impl Driven for Scene {
    fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    fn actuation(&self) -> &Actuation {
        &self.actuation
    }
}

/// The mechanism of a scene with its drives and measures. Reads and writes go to the mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Shared until it is changed.
    pub mechanism: Arc<Mechanism>,
    /// Drives, duration, start values.
    pub actuation: Actuation,
    /// Tracks and measures.
    pub measures: Measures,
}

impl From<Scene> for Model {
    fn from(scene: Scene) -> Self {
        Self {
            mechanism: scene.mechanism,
            actuation: scene.actuation,
            measures: Arc::unwrap_or_clone(scene.measures),
        }
    }
}

impl Driven for Model {
    fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    fn actuation(&self) -> &Actuation {
        &self.actuation
    }
}

impl Deref for Model {
    type Target = Mechanism;

    fn deref(&self) -> &Mechanism {
        &self.mechanism
    }
}

impl DerefMut for Model {
    fn deref_mut(&mut self) -> &mut Mechanism {
        Arc::make_mut(&mut self.mechanism)
    }
}

/// The motion at `times`.
pub fn solve(driven: &impl Driven, times: &[f64]) -> Result<Trajectory, StructureError> {
    Ok(continuation::solve_motion(
        &driven.system()?,
        driven.actuation(),
        times,
    ))
}

/// The same without certificates.
pub fn solve_unproved(driven: &impl Driven, times: &[f64]) -> Result<Trajectory, StructureError> {
    let system = driven.system()?;
    Ok(continuation::solve_unproved(
        &system,
        driven.actuation(),
        times,
    ))
}

/// `count` equal steps over the drive.
pub fn even_times(driven: &impl Driven, count: usize) -> Vec<f64> {
    sampling::even_times(driven.mechanism(), driven.actuation(), count)
}

/// Times of frames.
pub fn frame_times(driven: &impl Driven, fps: f64) -> Vec<f64> {
    sampling::frame_times(driven.mechanism(), driven.actuation(), fps)
}

/// Times with the ends and keys of the drive.
pub fn knots(driven: &impl Driven, times: &[f64]) -> Vec<f64> {
    sampling::knot_times(driven.mechanism(), driven.actuation(), times)
}

/// Proofs of the intervals of a trajectory.
pub fn certify_motion(driven: &impl Driven, trajectory: &Trajectory) -> Vec<IntervalCertificate> {
    tube::certify_motion(&driven.system().unwrap(), driven.actuation(), trajectory)
}

/// Adds the limit positions.
pub fn add_limits(driven: &impl Driven, trajectory: &mut Trajectory) {
    limits::add_limits(&driven.system().unwrap(), driven.actuation(), trajectory);
}

/// Fills in derivatives.
pub fn add_derivatives(driven: &impl Driven, trajectory: &mut Trajectory, columns: RateColumns) {
    let system = driven.system().unwrap();
    columns::add_derivatives(&system, driven.actuation(), trajectory, columns);
}

/// Values of the inputs that have poses.
pub fn feasible_inputs(driven: &impl Driven) -> Vec<Feasible> {
    feasible::feasible_inputs(&driven.system().unwrap(), driven.actuation())
}

/// Measures of a model's motion.
pub fn measures(model: &Model, trajectory: &Trajectory) -> Vec<Option<f64>> {
    let system = model.system().unwrap();
    let (actuation, measures) = (&model.actuation, &model.measures);
    mechanim::kinematics::measures::measure_motion(
        &system,
        actuation,
        measures,
        mechanim::kinematics::measures::DriveSamples::all(&trajectory.samples),
    )
}

/// The clearances that a scene asks for, in a report that keeps its word.
pub fn check(scene: &Scene, trajectory: &Trajectory, tolerance: f64) -> ClearanceReport {
    let closely = ClearanceEffort {
        times: true,
        ..ClearanceEffort::to(tolerance)
    };
    check_closely(scene, trajectory, closely)
}

/// The same, with as many pairs looked at one by one as are wanted.
pub fn check_closely(
    scene: &Scene,
    trajectory: &Trajectory,
    closely: ClearanceEffort,
) -> ClearanceReport {
    let system = scene.system().unwrap();
    let (actuation, rules) = (&scene.actuation, scene.clearance.as_ref().unwrap());
    let clearance = mechanim::clearance::check::check_clearance;
    let report = clearance(&system, actuation, rules, trajectory, closely, &|_, _| {});
    keeps_its_word(scene, trajectory, &report);
    report
}

/// What passes is proved, is never nearer than its minimum at any sample, and has a bound that says so; no bound is above a
/// distance that was found.
fn keeps_its_word(scene: &Scene, trajectory: &Trajectory, report: &ClearanceReport) {
    far_pairs_stay_apart(scene, trajectory, report);
    for p in &report.judged {
        let (least, said) = (&p.least, format!("{p:?}"));
        let found = p.distances.iter().copied().fold(least.distance, f64::min);
        // Rounding of the poses, in sizes of the pair.
        let rounding = 1e-8 * extent(scene, trajectory, p.pair);
        if p.judgement == Judgement::Passed {
            assert!(least.is_certified && report.gaps.is_empty(), "{said}");
            if p.touching.is_none() {
                assert!(least.bound >= p.minimum - p.slack, "{said}");
                assert!(found >= p.minimum - p.slack, "{said}");
                assert!(!least.is_enclosed && p.slack <= rounding, "{said}");
            }
        }
        times_hold(report, p, &said);
        if least.is_certified && found > 0.0 {
            assert!(least.bound <= found + rounding, "{said}");
        }
        assert!(least.distance <= found + rounding, "{said}");
        if let Some(touching) = &p.touching {
            let apart = p
                .distances
                .iter()
                .copied()
                .fold(touching.apart.distance, f64::max);
            assert!(touching.apart.distance >= apart - rounding, "{said}");
            assert!(touching.farthest >= apart - rounding, "{said}");
        }
    }
}

/// What is said of when a pair is too near: every pose that is lies within, and what was seen is too near.
fn times_hold(report: &ClearanceReport, p: &PairReport, said: &str) {
    let Some(violations) = &p.violations else {
        return;
    };
    assert!(!p.judgement.is_kept(), "{said}");
    let within = |time: f64| {
        let mut list = violations.list.iter();
        list.any(|v| v.from <= time && time <= v.to)
    };
    let worst = (p.least.time, p.least.distance);
    let samples = report
        .times
        .iter()
        .copied()
        .zip(p.distances.iter().copied());
    for (time, distance) in samples.chain([worst]) {
        let is_low = distance < p.minimum - p.slack;
        assert!(
            !is_low || within(time) || !violations.is_certified,
            "{time}: {said}"
        );
    }
    for v in &violations.list {
        assert!(v.from <= v.time && v.time <= v.to, "{said}");
        assert_eq!(v.is_seen, v.distance < p.minimum - p.slack, "{said}");
    }
    let mut ends = violations.list.windows(2);
    assert!(ends.all(|v| v[0].to < v[1].from), "{said}");
}

/// Pairs that nobody looked at one by one are never nearer than is said of all of them, and all pairs are accounted for.
fn far_pairs_stay_apart(scene: &Scene, trajectory: &Trajectory, report: &ClearanceReport) {
    let bodies = &scene.mechanism.bodies;
    let hulls: Vec<Option<BodyElements>> = bodies.iter().map(BodyElements::new).collect();
    let shaped: Vec<usize> = (0..bodies.len()).filter(|k| hulls[*k].is_some()).collect();
    let listed = report.judged.iter().chain(&report.excluded);
    let listed: HashSet<[usize; 2]> = listed.map(|p| p.pair).collect();
    let counted: usize = report.counted.iter().map(|(_, count)| count).sum();
    let far = report.far.map_or(0, |far| far.count);
    let all = shaped.len() * shaped.len().saturating_sub(1) / 2;
    assert_eq!(listed.len() + counted + far, all);
    let Some(far) = report.far else {
        return;
    };
    let rules = scene.clearance.as_ref().unwrap();
    assert!(far.apart >= rules.minimum && far.count > 0, "{far:?}");
    let is_judged = |pair: &[usize; 2]| {
        let is_ignored = rules.ignored.iter().any(|i| i.pair == *pair);
        let is_rigid = scene.mechanism.joints.are_rigid(pair[0], pair[1]);
        !listed.contains(pair) && !is_ignored && !is_rigid
    };
    let pairs = shaped.iter().enumerate();
    let pairs = pairs.flat_map(|(k, a)| shaped[k + 1..].iter().map(|b| [*a, *b]));
    let pairs: Vec<[usize; 2]> = pairs.filter(is_judged).collect();
    assert_eq!(pairs.len(), far.count);
    for [a, b] in pairs {
        let [first, second] = [a, b].map(|k| hulls[k].as_ref().unwrap());
        let rounding = 1e-9 * extent(scene, trajectory, [a, b]);
        for pose in trajectory.poses() {
            let a_from_b = pose.bodies[a].inverse() * pose.bodies[b];
            let found = nearest_bodies(first, second, &a_from_b, &Default::default()).unwrap();
            let distance = found.proximity.distance;
            assert!(
                distance >= far.apart - rounding,
                "{a} {b} {distance} {far:?}"
            );
        }
    }
}

/// How far any point of two bodies is from the other's frame at most; of what has no end, from its origin.
fn extent(scene: &Scene, trajectory: &Trajectory, pair: [usize; 2]) -> f64 {
    let reach = |k: usize| {
        let hull = BodyElements::new(&scene.mechanism.bodies[k]);
        let ball = hull.map_or((DVec3::ZERO, 0.0), |hull| hull.ball);
        let reach = ball.0.length() + ball.1;
        if reach.is_finite() { reach } else { 0.0 }
    };
    let origin = |pose: &ClosedPose, k: usize| pose.bodies[k].translation;
    let apart = trajectory
        .poses()
        .map(|pose| origin(pose, pair[0]).distance(origin(pose, pair[1])));
    // Chains may be longer than their ends are apart.
    let size = scene.mechanism.size.min(1e3);
    size + reach(pair[0]) + reach(pair[1]) + apart.fold(0.0, f64::max)
}
