//! A proof between samples: around the path from one sample to the next there is one motion, and it joins the two
//! certified poses. No jump to another assembly can hide there.
//!
//! The path over a stretch of time is a cubic curve in the unknowns; the drive is enclosed as it is. All poses of the
//! stretch take the Newton-Kantorovich test at once ([`proof`]), which gives two radii: within the smaller one around the path
//! there is a solution at every instant, within the larger one it is the only one. So tubes are joined, and the
//! samples' own certified poses are joined to them, wherever one solution lies within the larger radius of the
//! other. A stretch that fails is halved, down to [`FLOOR`] of the interval; keyframes always part stretches.

mod chain;
mod drive;
mod form;
mod gradient;
mod path;
mod proof;
mod rows;
mod series;

use super::{BALL, Certificate, Reason};
use crate::kinematics::branch::BranchWatch;
use crate::kinematics::newton::{Corrector, Pace};
use crate::kinematics::structure::{Block, Structure, StructureError};
use crate::kinematics::trajectory::{Sample, Trajectory};
use crate::model::mechanism::Mechanism;
use drive::{Stretch, keys_between};
use form::Form;
use path::{InputPath, Path};
use proof::Earlier;
use rows::Site;

/// Shortest stretch, as a fraction of the interval between two samples: near a singular pose tubes get as short
/// as they are far from it, and there is no end to that.
pub const FLOOR: f64 = 1.0 / 4096.0;

/// Factor between the balls that are tried where a formula has no bounds in the largest.
const BALL_STEP: f64 = 16.0;

/// No smaller ball is tried: a motion so close to a kink is as good as on it.
const SMALLEST_BALL: f64 = 1e-6;

/// An input of a sample may differ from the enclosed drive by rounding: this much of a radian or of the size.
const SAME_INPUT: f64 = 1e-9;

/// What could be proved about the motion between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalCertificate {
    /// Stretches that were proved, from the start of the interval on.
    pub tubes: usize,
    /// The motion is nowhere farther from the proved path (measured like the error bound of a pose).
    pub radius: f64,
    /// It is the only one within this distance of the path, measured likewise.
    pub unique_radius: f64,
    /// Where and why the proof ended before the interval did.
    pub refused: Option<Refusal>,
}

/// The end of a proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusal {
    /// Seconds: what lies right after it is not proved.
    pub time: f64,
    /// Why.
    pub obstacle: Obstacle,
}

/// Why a stretch is not proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// A sample has no pose: the motion ends, or resumes, somewhere in between.
    NoPose,
    /// The drive jumps, or its formula has a kink or no value.
    Drive,
    /// There is a motion, but not one that joins the two samples.
    NotJoined,
    /// The test fails, at a sample or between.
    Test(Reason),
}

impl Obstacle {
    /// The word used in reports.
    pub const fn word(self) -> &'static str {
        match self {
            Self::NoPose => "no-pose",
            Self::Drive => "drive",
            Self::NotJoined => "not-joined",
            Self::Test(reason) => reason.word(),
        }
    }
}

/// Proves every interval between consecutive samples; one entry less than there are samples.
///
/// # Errors
/// Only where the mechanism itself is ill-posed.
pub fn certify_motion(
    mechanism: &Mechanism,
    trajectory: &Trajectory,
) -> Result<Vec<IntervalCertificate>, StructureError> {
    let structure = Structure::new(mechanism)?;
    let mut prover = Prover::new(mechanism, &structure);
    let pairs = trajectory.samples.windows(2);
    Ok(pairs.map(|pair| prover.interval(pair).0).collect())
}

/// Proves a single pose whose formulas have no affine form: error bound and radius of uniqueness in radians and sizes.
pub(super) fn pose(
    mechanism: &Mechanism,
    structure: &Structure,
    coordinates: &[f64],
    bases: &[Vec<usize>],
) -> Result<(f64, f64), Reason> {
    let forms = Form::all(mechanism);
    let proved = prove_blocks(
        mechanism,
        structure,
        &forms,
        bases,
        &Path::still(coordinates),
    )?;
    Ok((proved.largest, proved.unique))
}

/// The test in the largest ball in which the formulas of the mechanism are smooth.
fn prove_blocks(
    mechanism: &Mechanism,
    structure: &Structure,
    forms: &[Form],
    bases: &[Vec<usize>],
    path: &Path,
) -> Result<Earlier, Reason> {
    let mut ball = BALL;
    loop {
        let proof = prove_in_ball(mechanism, structure, forms, bases, path, ball);
        if proof.as_ref().err() != Some(&Reason::Formula) || ball < SMALLEST_BALL {
            return proof;
        }
        ball /= BALL_STEP;
    }
}

fn prove_in_ball(
    mechanism: &Mechanism,
    structure: &Structure,
    forms: &[Form],
    bases: &[Vec<usize>],
    path: &Path,
    ball: f64,
) -> Result<Earlier, Reason> {
    let mut proved = Earlier {
        rest: vec![0.0; mechanism.unknowns.len()],
        largest: 0.0,
        unique: f64::INFINITY,
    };
    for (block, basis) in structure.blocks.iter().zip(bases) {
        let columns = columns(mechanism, forms, block);
        let site = Site {
            mechanism,
            forms,
            block,
            columns: &columns,
            ball,
        };
        proof::prove(site, path, basis, &mut proved)?;
    }
    Ok(proved)
}

/// The unknowns of a block, then those of earlier blocks that it depends on.
fn columns(mechanism: &Mechanism, forms: &[Form], block: &Block) -> Vec<usize> {
    let used = rows::used(mechanism, block);
    let mut others: Vec<usize> = used.flat_map(|form| forms[form].coordinates()).collect();
    others.sort_unstable();
    others.dedup();
    others.retain(|slot| *slot < mechanism.unknowns.len() && block.column_of[*slot].is_none());
    [block.unknowns.clone(), others].concat()
}

/// One proved stretch.
#[derive(Clone, Debug)]
pub struct Tube {
    /// Seconds.
    pub start: f64,
    /// Seconds.
    pub end: f64,
    /// Distance of the motion from the path at most, in radians and sizes.
    pub radius: f64,
    /// Distance from the path within which it is the only one, likewise.
    pub unique: f64,
    path: Path,
}

impl Tube {
    /// The path's value of unknown `k` at a time of the stretch.
    pub fn centre(&self, k: usize, time: f64) -> f64 {
        self.path.at(k, time).middle()
    }
}

/// A pose on the way.
#[derive(Clone, Debug)]
struct Place {
    time: f64,
    unknowns: Vec<f64>,
    /// Of a sample: its inputs, and how far the exact pose is, in radians and sizes.
    sample: Option<(Vec<f64>, f64)>,
}

/// Proves intervals of one mechanism.
#[derive(Debug)]
pub struct Prover<'m> {
    mechanism: &'m Mechanism,
    structure: &'m Structure,
    forms: Vec<Form<'m>>,
    corrector: Corrector,
    bases: Option<Vec<Vec<usize>>>,
}

impl<'m> Prover<'m> {
    /// Prepares the proofs.
    pub fn new(mechanism: &'m Mechanism, structure: &'m Structure) -> Self {
        Self {
            mechanism,
            structure,
            forms: Form::all(mechanism),
            corrector: Corrector::new(structure),
            bases: None,
        }
    }

    /// Proves the interval between the two samples of `pair`; the tubes are those up to its end or its refusal.
    pub fn interval(&mut self, pair: &[Sample]) -> (IntervalCertificate, Vec<Tube>) {
        let mut tubes = Vec::new();
        let refused = match pair {
            [start, end] => self.between(start, end, &mut tubes).err(),
            _ => None,
        };
        let size = self.mechanism.size;
        let radius = tubes.iter().map(|t: &Tube| t.radius).fold(0.0, f64::max);
        let unique = tubes.iter().map(|t| t.unique).fold(f64::INFINITY, f64::min);
        let certificate = IntervalCertificate {
            tubes: tubes.len(),
            radius: radius * size * (1.0 + 1e-12),
            unique_radius: unique * size * (1.0 - 1e-12),
            refused,
        };
        (certificate, tubes)
    }

    fn between(
        &mut self,
        start: &Sample,
        end: &Sample,
        tubes: &mut Vec<Tube>,
    ) -> Result<(), Refusal> {
        let refuse = |sample: &Sample, obstacle| Refusal {
            time: sample.time,
            obstacle,
        };
        let mut here = self.place(start).map_err(|o| refuse(start, o))?;
        let last = self.place(end).map_err(|o| refuse(end, o))?;
        let floor = FLOOR * (end.time - start.time);
        let mut ahead = self.by_keyframes(&here, last)?;
        while let Some(next) = ahead.pop() {
            match self.tube(&here, &next, tubes.last()) {
                Ok(tube) => {
                    tubes.push(tube);
                    here = next;
                }
                Err(obstacle) if next.time - here.time < 2.0 * floor => {
                    return Err(Refusal {
                        time: here.time,
                        obstacle,
                    });
                }
                Err(obstacle) => {
                    let time = 0.5 * here.time + 0.5 * next.time;
                    let middle = self.pose_between(&here, &next, time);
                    let middle = middle.ok_or(Refusal {
                        time: here.time,
                        obstacle,
                    })?;
                    ahead.extend([next, middle]);
                }
            }
        }
        Ok(())
    }

    /// A certified sample.
    fn place(&mut self, sample: &Sample) -> Result<Place, Obstacle> {
        let pose = sample.pose.as_ref().ok_or(Obstacle::NoPose)?;
        let error = match pose.certificate {
            Certificate::Certified { error_bound, .. } => error_bound,
            Certificate::Refused { reason } => return Err(Obstacle::Test(reason)),
        };
        if self.bases.is_none() {
            let coordinates = [&pose.unknowns[..], &sample.inputs].concat();
            let mut watch = BranchWatch::default();
            watch.observe(
                self.mechanism,
                self.structure,
                &mut self.corrector,
                &coordinates,
            );
            self.bases = Some(watch.bases().to_vec());
        }
        Ok(Place {
            time: sample.time,
            unknowns: pose.unknowns.clone(),
            sample: Some((
                sample.inputs.clone(),
                error / self.mechanism.size * (1.0 + 1e-12),
            )),
        })
    }

    /// The interval's end and the keyframes before it, the first one last.
    fn by_keyframes(&mut self, start: &Place, end: Place) -> Result<Vec<Place>, Refusal> {
        let mut ahead = Vec::new();
        for time in keys_between(&self.mechanism.drives, start.time, end.time) {
            let place = self.pose_between(start, &end, time).ok_or(Refusal {
                time: start.time,
                obstacle: Obstacle::NotJoined,
            })?;
            ahead.push(place);
        }
        ahead.push(end);
        ahead.reverse();
        Ok(ahead)
    }

    /// A closed pose at `time`, corrected from the straight line between two others. Which assembly it is of is found
    /// out by the proof.
    fn pose_between(&mut self, a: &Place, b: &Place, time: f64) -> Option<Place> {
        let share = (time - a.time) / (b.time - a.time);
        let pairs = a.unknowns.iter().zip(&b.unknowns);
        let mut coordinates: Vec<f64> = pairs.map(|(a, b)| a + share * (b - a)).collect();
        coordinates.extend(self.mechanism.inputs_at(time));
        let correction = self.corrector.correct(
            self.mechanism,
            self.structure,
            &mut coordinates,
            Pace::Brisk,
        );
        coordinates.truncate(self.mechanism.unknowns.len());
        correction.converged.then_some(Place {
            time,
            unknowns: coordinates,
            sample: None,
        })
    }

    /// Proves the stretch from `here` to `next` and joins it to what is at its ends.
    fn tube(
        &mut self,
        here: &Place,
        next: &Place,
        before: Option<&Tube>,
    ) -> Result<Tube, Obstacle> {
        let mut inputs = InputPath::new(self.mechanism, Stretch::new(here.time, next.time));
        if !inputs.is_finite() {
            return Err(Obstacle::Drive);
        }
        for place in [here, next] {
            self.admit(&mut inputs, place)?;
        }
        let time = 0.5 * here.time + 0.5 * next.time;
        let singular = Obstacle::Test(Reason::Singular);
        let middle = self.pose_between(here, next, time).ok_or(singular)?;
        let coordinates = [middle.unknowns, self.mechanism.inputs_at(time)].concat();
        let path = inputs
            .through(self.mechanism, self.structure, &coordinates)
            .ok_or(singular)?;
        let bases = self.bases.as_deref().unwrap_or_default();
        let proved = prove_blocks(self.mechanism, self.structure, &self.forms, bases, &path)
            .map_err(Obstacle::Test)?;
        let tube = Tube {
            start: here.time,
            end: next.time,
            radius: proved.largest,
            unique: proved.unique,
            path,
        };
        if before.is_some_and(|before| !self.same_inputs(before, &tube)) {
            return Err(Obstacle::Drive);
        }
        let joined = [here, next].iter().all(|place| self.holds(&tube, place))
            && before.is_none_or(|before| self.same_motion(before, &tube));
        joined.then_some(tube).ok_or(Obstacle::NotJoined)
    }

    /// Takes the inputs of a sample into the enclosed drive.
    fn admit(&self, inputs: &mut InputPath, place: &Place) -> Result<(), Obstacle> {
        let Some((values, _)) = &place.sample else {
            return Ok(());
        };
        for (k, value) in values.iter().enumerate() {
            let unit = match self.mechanism.inputs[k].kind {
                crate::model::mechanism::Kind::Length => self.mechanism.size,
                _ => value.abs().max(1.0),
            };
            if !(inputs.admit(k, place.time, *value) <= SAME_INPUT * unit) {
                return Err(Obstacle::Drive);
            }
        }
        Ok(())
    }

    /// Whether the exact pose of a sample is the one that the tube has there.
    fn holds(&self, tube: &Tube, place: &Place) -> bool {
        let Some((_, error)) = &place.sample else {
            return true;
        };
        let unknowns = place.unknowns.iter().enumerate();
        let gap = unknowns.map(|(k, q)| {
            let distance = tube.path.at(k, place.time).distance(*q);
            distance / self.mechanism.scale_of(k)
        });
        largest(gap) * (1.0 + 1e-12) + error < tube.unique
    }

    /// Whether the enclosed drive goes on where two tubes meet.
    fn same_inputs(&self, before: &Tube, tube: &Tube) -> bool {
        let slots = self.mechanism.unknowns.len()..self.mechanism.coordinate_count();
        slots.into_iter().all(|k| {
            let (a, b) = (before.path.at(k, tube.start), tube.path.at(k, tube.start));
            a.lo <= b.hi && b.lo <= a.hi
        })
    }

    /// Whether two consecutive tubes have the same pose where they meet.
    fn same_motion(&self, before: &Tube, tube: &Tube) -> bool {
        let gap = (0..self.mechanism.unknowns.len()).map(|k| {
            let (a, b) = (before.path.at(k, tube.start), tube.path.at(k, tube.start));
            (a - b).magnitude() / self.mechanism.scale_of(k)
        });
        let gap = largest(gap) * (1.0 + 1e-12);
        gap + before.radius < tube.unique || gap + tube.radius < before.unique
    }
}

/// The largest; a number that is none wins.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a: f64, b| if b.is_nan() || b > a { b } else { a })
}
