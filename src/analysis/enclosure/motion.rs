//! Bands of a motion: at every sample, for every unknown, traced point and output, a range that contains every piece,
//! and the range that pieces attain.

use super::plan::TolerancePlan;
use super::pose_bands::{BandObstacle, Bands, PieceFinder};
use crate::jobs::share_work;
use crate::kinematics::enclosure::pose::Encloser;
use crate::kinematics::motion::continuation::solve_until;
use crate::kinematics::results::trajectory::Sample;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::model::mechanism::{Kind, Mechanism};

/// One instant of the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Enclosed {
    /// Seconds.
    pub time: f64,
    /// All inputs, the dimensions among them.
    pub inputs: Vec<f64>,
    /// The bands, or the reason why there are none.
    pub bands: Result<Bands, BandObstacle>,
}

/// The time between two samples.
#[derive(Clone, Debug, PartialEq)]
pub struct SpanBands {
    /// Seconds.
    pub from: f64,
    /// Seconds.
    pub until: f64,
    /// Least and greatest value of every quantity over the interval, then of the formula of every measure that is an extreme along
    /// the drive; or the reason why they are unknown.
    pub bands: Result<Vec<[f64; 2]>, BandObstacle>,
}

/// Names and kinds of the quantities with bands.
pub fn shown_names(mechanism: &Mechanism) -> Vec<(String, Kind)> {
    let unknowns = mechanism.unknowns.iter().map(|u| (u.name.clone(), u.kind));
    let traces = mechanism.traces.iter().flat_map(|trace| {
        ["x", "y", "z"].map(|axis| (format!("{}.{axis}", trace.name), Kind::Length))
    });
    let outputs = mechanism.outputs.iter().map(|o| (o.name.clone(), o.kind));
    unknowns.chain(traces).chain(outputs).collect()
}

/// Bands at `times`. `search` also finds the ranges that pieces attain.
pub fn enclose_motion(
    plan: &TolerancePlan,
    times: &[f64],
    threads: usize,
    search: bool,
) -> Vec<Enclosed> {
    let family = plan.family;
    let nominal = samples_at(plan, times);
    let encloser = Encloser::new(family.system());
    // Each sample on its own: the bands at a pose do not depend on other samples.
    let work = |finder: &mut PieceFinder, index: usize| {
        let sample = &nominal.samples[index];
        let pose = nominal.on_first_branch(index);
        let bands = pose.and_then(|pose| finder.bands(&pose.coordinates));
        let bands = bands.map(|bands| {
            if search {
                bands
            } else {
                bands.without_search()
            }
        });
        Some(Enclosed {
            time: sample.time,
            inputs: sample.inputs.clone(),
            bands,
        })
    };
    let make = || PieceFinder::new(plan, &encloser);
    let list = share_work(nominal.samples.len(), threads, make, work);
    list.into_iter().map(|(_, enclosed)| enclosed).collect()
}

/// The motion with the file's dimensions at some times.
pub(super) struct NominalSamples {
    pub samples: Vec<Sample>,
    /// When it comes to a singular pose.
    singular: Option<f64>,
}

impl NominalSamples {
    /// The pose of a sample, if pieces are in its assembly.
    ///
    /// # Errors
    /// There is no pose, or a singular one comes before it.
    pub fn on_first_branch(&self, index: usize) -> Result<NominalPose, BandObstacle> {
        let sample = &self.samples[index];
        match self.singular.filter(|time| *time < sample.time) {
            Some(time) => Err(BandObstacle::BehindSingularPose { time }),
            None => NominalPose::of(sample).ok_or(BandObstacle::NoPose),
        }
    }
}

/// The samples at `times`, followed from the start of the drive, so that they are on its branch. After a cancellation
/// they have no pose.
pub(super) fn samples_at(plan: &TolerancePlan, times: &[f64]) -> NominalSamples {
    // The motion is followed from the start of the drive, which may not be among the samples.
    let begins = times.first().is_none_or(|t| *t == 0.0);
    let lead: &[f64] = if begins { &[] } else { &[0.0] };
    let all = [lead, times].concat();
    let (system, actuation) = (plan.family.system(), &plan.family.actuation);
    let motion = solve_until(system, actuation, &all, None, &|| plan.is_cancelled());
    let singular = motion.first_singular();
    let mut samples = motion.of_one_motion();
    // Behind the end of the motion there are no poses.
    let missing = all.iter().skip(samples.len()).map(|time| Sample {
        time: *time,
        inputs: actuation.inputs_at(*time),
        pose: None,
    });
    samples.extend(missing.collect::<Vec<_>>());
    let samples = samples.split_off(lead.len());
    NominalSamples { samples, singular }
}

/// A nominal pose from which the motion is followed to others nearby.
#[derive(Clone, Debug)]
pub(super) struct NominalPose {
    /// Seconds.
    time: f64,
    /// Unknowns, then inputs.
    pub coordinates: Vec<f64>,
}

impl NominalPose {
    /// That of a sample; `None` if it has none.
    pub fn of(sample: &Sample) -> Option<Self> {
        let pose = sample.pose.as_ref()?;
        Some(Self {
            time: sample.time,
            coordinates: [pose.unknowns.as_slice(), &sample.inputs].concat(),
        })
    }

    /// The pose at another time, in steps that can be trusted: a drive may go far between two samples.
    pub fn followed_to(
        &self,
        solver: &mut PoseSolver,
        plan: &TolerancePlan,
        time: f64,
    ) -> Option<Self> {
        let unknowns = plan.family.mechanism().unknowns.len();
        let inputs = |part: f64| {
            let actuation = &plan.family.actuation;
            actuation.inputs_along([self.time, time], part)
        };
        let coordinates = solver.followed(&self.coordinates[..unknowns], inputs)?;
        Some(Self { time, coordinates })
    }
}
