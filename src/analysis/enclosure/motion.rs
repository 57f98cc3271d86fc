//! Bands of a motion: at every sample a range of every unknown, traced point and output that no piece leaves, and the
//! range that pieces take.

use super::plan::{Plan, sized};
use crate::jobs::share_work;
use crate::kinematics::enclosure::block::Unbounded;
use crate::kinematics::enclosure::pose::{Encloser, PoseEnclosure};
use crate::kinematics::enclosure::region::Tolerance;
use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::motion::continuation::solve_until;
use crate::kinematics::results::certificate::Reason;
use crate::kinematics::results::trajectory::Sample;
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::model::mechanism::{Kind, Mechanism};

/// The range of one number over all pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// With the file's dimensions.
    pub nominal: f64,
    /// No piece is lower.
    pub lo: f64,
    /// No piece is higher.
    pub hi: f64,
    /// The least and the greatest value of a piece that was found.
    pub found: [f64; 2],
}

/// The bands at one sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    /// Unknowns, x, y, z of the traced points, outputs.
    pub list: Vec<Band>,
}

/// Why a sample has no bands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle {
    /// There is no pose with the file's dimensions.
    NoPose,
    /// The caller did not want to wait.
    Interrupted,
    /// The box is not proved.
    Test {
        /// In the words of certificates.
        reason: Reason,
        /// The dimension that takes the mechanism farthest towards where it fails.
        dimension: Option<usize>,
    },
}

impl From<Unbounded> for Obstacle {
    fn from(unbounded: Unbounded) -> Self {
        Self::Test {
            reason: unbounded.reason,
            dimension: unbounded.dimension,
        }
    }
}

/// One instant of the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Enclosed {
    /// Seconds.
    pub time: f64,
    /// All inputs, the dimensions among them.
    pub inputs: Vec<f64>,
    /// The bands, or why there are none.
    pub bands: Result<Bands, Obstacle>,
}

/// The time between two samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// Seconds.
    pub from: f64,
    /// Seconds.
    pub until: f64,
    /// Least and greatest value of every number that has a band, over all its times, or why they are not known.
    pub bands: Result<Vec<[f64; 2]>, Obstacle>,
}

/// Names and kinds of what has a band.
pub fn shown_names(mechanism: &Mechanism) -> Vec<(String, Kind)> {
    let unknowns = mechanism.unknowns.iter().map(|u| (u.name.clone(), u.kind));
    let traces = mechanism.traces.iter().flat_map(|trace| {
        ["x", "y", "z"].map(|axis| (format!("{}.{axis}", trace.name), Kind::Length))
    });
    let outputs = mechanism.outputs.iter().map(|o| (o.name.clone(), o.kind));
    unknowns.chain(traces).chain(outputs).collect()
}

/// Bands at `times`. `search` asks for the range that is found, too.
pub fn enclose_motion(plan: &Plan, times: &[f64], threads: usize, search: bool) -> Vec<Enclosed> {
    let family = plan.family;
    let samples = samples_at(plan, times);
    let encloser = Encloser::new(family.system());
    let work = |solver: &mut PoseSolver, index: usize| {
        let sample = &samples[index];
        let bands = match &sample.pose {
            None => Err(Obstacle::NoPose),
            Some(pose) => {
                let pose = [pose.unknowns.as_slice(), &sample.inputs].concat();
                sized!(plan.room_for(plan.dimensions.len()), N => coordinate_bands::<N>(plan, &encloser, solver, &pose, search))
            }
        };
        Some(Enclosed {
            time: sample.time,
            inputs: sample.inputs.clone(),
            bands,
        })
    };
    let make = || PoseSolver::new(family.system());
    let list = share_work(samples.len(), threads, make, work);
    list.into_iter().map(|(_, enclosed)| enclosed).collect()
}

/// The samples at `times`, followed from the start of the drive, so that they are of its branch. Where nobody waits any more
/// they have no pose.
pub(super) fn samples_at(plan: &Plan, times: &[f64]) -> Vec<Sample> {
    let begins = times.first().is_none_or(|t| *t == 0.0);
    let lead: &[f64] = if begins { &[] } else { &[0.0] };
    let all = [lead, times].concat();
    let (system, actuation) = (plan.family.system(), &plan.family.actuation);
    let motion = solve_until(system, actuation, &all, None, &|| plan.is_cancelled());
    let mut samples = motion.of_one_motion();
    let missing = all.iter().skip(samples.len()).map(|time| Sample {
        time: *time,
        inputs: actuation.inputs_at(*time),
        pose: None,
    });
    samples.extend(missing.collect::<Vec<_>>());
    samples.split_off(lead.len())
}

/// The enclosure of all pieces beside a closed pose.
pub(super) fn enclosed_pose<const N: usize>(
    plan: &Plan,
    encloser: &Encloser,
    solver: &mut PoseSolver,
    pose: &[f64],
) -> Result<PoseEnclosure<N>, Obstacle> {
    pose_enclosure(plan, encloser, solver, pose, &plan.tolerances(pose))
}

/// The same with tolerances of one's own.
pub(super) fn pose_enclosure<const N: usize>(
    plan: &Plan,
    encloser: &Encloser,
    solver: &mut PoseSolver,
    pose: &[f64],
    tolerances: &[Tolerance],
) -> Result<PoseEnclosure<N>, Obstacle> {
    if plan.is_cancelled() {
        return Err(Obstacle::Interrupted);
    }
    let bases = solver.best_rows(pose);
    let open = plan.input_open(pose);
    Ok(encloser.enclose(pose, &open, tolerances, &bases)?)
}

fn coordinate_bands<const N: usize>(
    plan: &Plan,
    encloser: &Encloser,
    solver: &mut PoseSolver,
    pose: &[f64],
    search: bool,
) -> Result<Bands, Obstacle> {
    let mechanism = plan.family.mechanism();
    let enclosure = enclosed_pose::<N>(plan, encloser, solver, pose)?;
    let shown = (0..mechanism.unknowns.len()).chain(mechanism.coordinate_count()..enclosure.len());
    let band = |slot: usize| {
        let function = enclosure.slot(slot);
        let range = function.range();
        let nominal = function.value;
        // Pieces at the ends of the band, closed one by one, say how wide it must be at least.
        let mut found = [nominal; 2];
        if search {
            for place in [&range.lowest, &range.highest] {
                if let Some(value) = enclose_piece(plan, solver, &enclosure, place, slot) {
                    found = [found[0].min(value), found[1].max(value)];
                }
            }
        }
        Band {
            nominal,
            lo: range.lo,
            hi: range.hi,
            found,
        }
    };
    Ok(Bands {
        list: shown.map(band).collect(),
    })
}

/// The value of a slot for the piece whose dimensions are at `place` within their tolerances; `None` if it does not close.
fn enclose_piece<const N: usize>(
    plan: &Plan,
    solver: &mut PoseSolver,
    enclosure: &PoseEnclosure<N>,
    place: &[f64],
    slot: usize,
) -> Option<f64> {
    let mut coordinates = enclosure.coordinates_at(place);
    for (dimension, d) in plan.dimensions.iter().zip(place) {
        // The piece is one of those asked for, to the last bit.
        let nominal = enclosure.form(dimension.slot).value;
        coordinates[dimension.slot] = nominal + d * dimension.tolerance;
    }
    let closed = solver.closed(&mut coordinates, Pace::Brisk) && enclosure.holds(&coordinates);
    if !closed {
        return None;
    }
    if slot < coordinates.len() {
        return Some(coordinates[slot]);
    }
    let value = observed_slots(plan.family.mechanism(), &coordinates)[slot];
    value.is_finite().then_some(value)
}
