//! From sample to sample: where stretches part, and how tubes are joined to each other and to the samples.

use super::super::{Certificate, Reason};
use super::drive::{Stretch, keys_between};
use super::form::Form;
use super::path::{InputPath, Path};
use super::{IntervalCertificate, Obstacle, Refusal, prove_blocks};
use crate::kinematics::branch::BranchWatch;
use crate::kinematics::newton::{Corrector, Pace};
use crate::kinematics::structure::Structure;
use crate::kinematics::trajectory::Sample;
use crate::model::mechanism::{Kind, Mechanism};

/// Shortest stretch, as a fraction of the interval between two samples: near a singular pose tubes get as short
/// as they are far from it, and there is no end to that.
pub const FLOOR: f64 = 1.0 / 65_536.0;

/// An input of a sample may differ from the enclosed drive by rounding: this much of a radian or of the size.
const SAME_INPUT: f64 = 1e-9;

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
                Kind::Length => self.mechanism.size,
                _ => value.abs().max(1.0),
            };
            let off = inputs.admit(k, place.time, *value);
            if off.is_nan() || off > SAME_INPUT * unit {
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
