//! From sample to sample: where stretches part, and how tubes are joined to each other and to the samples.

use super::blocks::Blocks;
use super::drive::{Stretch, keys_between};
use super::form::Form;
use super::model::{Model, Polynomial, TERMS};
use super::path::{InputPath, Path};
use crate::kinematics::results::certificate::{
    Certificate, IntervalCertificate, Obstacle, Reason, Refusal,
};
use crate::kinematics::results::trajectory::Sample;
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Kind;
use crate::model::printed;
use crate::numbers::interval::Interval;

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
    /// Distance of every unknown from the path, likewise.
    rest: Vec<f64>,
    path: Path,
}

impl Tube {
    /// The path's value of unknown `k` at a time of the stretch.
    pub fn centre(&self, k: usize, time: f64) -> f64 {
        self.path.at(k, time).middle()
    }

    /// Rate of the path of unknown `k` at the end.
    fn rate_at_end(&self, k: usize) -> f64 {
        let c = &self.path.coordinates[k].c;
        let slope: f64 = c.iter().enumerate().map(|(j, c)| j as f64 * c).sum();
        slope / self.path.stretch().half
    }
}

/// A pose on the way.
#[derive(Clone, Debug)]
struct Place {
    time: f64,
    unknowns: Vec<f64>,
    /// Rates of the unknowns, where they are known: only the first guess of a path needs them.
    rates: Option<Vec<f64>>,
    /// Of a sample: its inputs, and how far the exact pose is, in radians and sizes.
    sample: Option<(Vec<f64>, f64)>,
}

/// Proves intervals of one mechanism.
#[derive(Debug)]
pub struct Prover<'m> {
    system: &'m System,
    actuation: &'m Actuation,
    blocks: Blocks<'m>,
    solver: PoseSolver<'m>,
    bases: Option<Vec<Vec<usize>>>,
    /// A block has rows that its proof leaves out.
    has_more_rows: bool,
    /// An interval may end where the drive jumps; it is then proved up to the jump.
    may_jump: bool,
}

impl<'m> Prover<'m> {
    /// Prepares the proofs.
    pub fn new(system: &'m System, actuation: &'m Actuation) -> Self {
        Self {
            system,
            actuation,
            blocks: Blocks::new(system),
            solver: PoseSolver::new(system),
            bases: None,
            has_more_rows: system.blocks().iter().any(|b| b.rows() > b.unknowns.len()),
            may_jump: false,
        }
    }

    /// Lets intervals end where the drive jumps: they are proved up to there, and the sample after it is not joined.
    pub fn up_to_jumps(mut self) -> Self {
        self.may_jump = true;
        self
    }

    /// Whether a sample's exact pose is the one that the tube has at that time.
    pub fn meets(&mut self, tube: &Tube, sample: &Sample) -> bool {
        self.place(sample)
            .is_ok_and(|place| self.holds(tube, &place))
    }

    /// Proves the interval between the two samples of `pair`; the tubes are those up to its end or its refusal.
    pub fn interval(&mut self, pair: &[Sample]) -> (IntervalCertificate, Vec<Tube>) {
        let (tubes, refused) = self.tubes(pair, FLOOR);
        let [least, largest] = self.system.mechanism().distance_units();
        let radius = tubes.iter().map(|t: &Tube| t.radius).fold(0.0, f64::max);
        let unique = tubes.iter().map(|t| t.unique).fold(f64::INFINITY, f64::min);
        let certificate = IntervalCertificate {
            tubes: tubes.len(),
            radius: radius * largest * (1.0 + 1e-12),
            unique_radius: unique * least * (1.0 - 1e-12),
            refused,
        };
        (certificate, tubes)
    }

    /// The tubes of an interval, from its start up to its end or a refusal. No stretch is shorter than `floor` of the
    /// interval.
    pub fn tubes(&mut self, pair: &[Sample], floor: f64) -> (Vec<Tube>, Option<Refusal>) {
        let mut tubes = Vec::new();
        let refused = match pair {
            [start, end] => self.between(start, end, floor, &mut tubes).err(),
            _ => None,
        };
        (tubes, refused)
    }

    /// The same motion in two tubes, each thinner; `None` where they cannot be proved.
    pub fn halves(&mut self, tube: &Tube) -> Option<[Tube; 2]> {
        let middle = 0.5 * tube.start + 0.5 * tube.end;
        let mut part = |start: f64, end: f64| {
            let inputs = InputPath::new(self.actuation, Stretch::new(start, end));
            let path = inputs.with(tube.path.part(
                self.system.mechanism().unknowns.len(),
                start,
                end,
            ));
            let half = self.prove([start, end], path).ok()?;
            self.same_motion(tube, &half).then_some(half)
        };
        Some([part(tube.start, middle)?, part(middle, tube.end)?])
    }

    /// The arguments of all joints over a tube's stretch.
    pub fn arguments(&self, tube: &Tube) -> Vec<Model> {
        let mut coordinates = tube.path.coordinates.clone();
        for (k, rest) in tube.rest.iter().enumerate() {
            coordinates[k].rest += rest * self.system.mechanism().scale_of(k) * (1.0 + 1e-12);
        }
        let count = self.system.mechanism().arguments.len();
        let of = |form: &Form| match form {
            Form::Affine(affine) => Model::of_affine(affine, &coordinates),
            Form::Formula(_) => {
                let place: Vec<Interval> = coordinates.iter().map(Model::range).collect();
                let mut rates: Vec<f64> = coordinates.iter().map(|c| c.rest).collect();
                // The inputs' own are part of the series.
                rates[tube.rest.len()..].fill(0.0);
                let mut value = form.value(&tube.path);
                value.rest += form.change(&place, &rates).rate;
                value
            }
        };
        self.blocks.forms[..count].iter().map(of).collect()
    }

    fn between(
        &mut self,
        start: &Sample,
        end: &Sample,
        floor: f64,
        tubes: &mut Vec<Tube>,
    ) -> Result<(), Refusal> {
        let refuse = |sample: &Sample, obstacle| Refusal {
            time: sample.time,
            obstacle,
        };
        let mut here = self.place(start).map_err(|o| refuse(start, o))?;
        let mut last = self.place(end).map_err(|o| refuse(end, o))?;
        if self.may_jump {
            last = self.before_a_jump(&here, last);
        }
        let floor = floor * (end.time - start.time);
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
            // Tubes are about angles, which have no bound here.
            Certificate::Locked { .. } => return Err(Obstacle::Test(Reason::GimbalLock)),
            Certificate::Refused { reason } => return Err(Obstacle::Test(reason)),
        };
        if self.bases.is_none() {
            let coordinates = [&pose.unknowns[..], &sample.inputs].concat();
            self.solver.observe(&coordinates);
            self.bases = Some(self.solver.proof_basis(&coordinates).0.to_vec());
        }
        Ok(Place {
            time: sample.time,
            unknowns: pose.unknowns.clone(),
            rates: Some(pose.rates.clone()),
            sample: Some((
                sample.inputs.clone(),
                error / self.system.mechanism().distance_units()[1] * (1.0 + 1e-12),
            )),
        })
    }

    /// The pose to which the drive leads right before `last`, where it jumps to that; else `last` itself.
    fn before_a_jump(&mut self, here: &Place, last: Place) -> Place {
        let keys = keys_between(&self.actuation.drives, here.time, last.time);
        let from = keys.last().copied().unwrap_or(here.time);
        let inputs = InputPath::new(self.actuation, Stretch::new(from, last.time));
        let values = last.sample.iter().flat_map(|(values, _)| values);
        let limit = |k: usize| inputs.at(k, last.time).middle();
        let jumps = |(k, v): (usize, &f64)| (limit(k) - v).abs() > SAME_INPUT * self.unit(k, *v);
        if !values.enumerate().any(jumps) {
            return last;
        }
        let limits = (0..self.actuation.drives.len()).map(limit);
        let mut unknowns: Vec<f64> = here.unknowns.iter().copied().chain(limits).collect();
        if !self.solver.closed(&mut unknowns, Pace::Brisk) {
            return last;
        }
        unknowns.truncate(here.unknowns.len());
        Place {
            time: last.time,
            unknowns,
            rates: None,
            sample: None,
        }
    }

    /// What differences of input `k` are measured in, at a value.
    fn unit(&self, k: usize, value: f64) -> f64 {
        match self.system.mechanism().inputs[k].kind {
            Kind::Length => self.system.mechanism().size,
            _ => value.abs().max(1.0),
        }
    }

    /// The interval's end and the keyframes before it, the first one last.
    fn by_keyframes(&mut self, start: &Place, end: Place) -> Result<Vec<Place>, Refusal> {
        let mut ahead = Vec::new();
        for time in keys_between(&self.actuation.drives, start.time, end.time) {
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
        let inputs = self.actuation.inputs_at(time);
        let ends = [&a.unknowns[..], &b.unknowns[..]];
        let mut unknowns = self.solver.between(ends, share, &inputs, Pace::Brisk)?;
        unknowns.truncate(a.unknowns.len());
        Some(Place {
            time,
            unknowns,
            rates: None,
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
        let mut inputs = InputPath::new(self.actuation, Stretch::new(here.time, next.time));
        if !inputs.is_finite() {
            return Err(Obstacle::Drive);
        }
        for place in [here, next] {
            self.admit(&mut inputs, place)?;
        }
        if self.has_more_rows {
            // The rows that the proof leaves out are checked in the middle.
            let time = 0.5 * here.time + 0.5 * next.time;
            let singular = Obstacle::Test(Reason::Singular);
            self.pose_between(here, next, time).ok_or(singular)?;
        }
        let path = inputs.with(self.first_guess(here, next, before));
        let tube = self
            .prove([here.time, next.time], path)
            .map_err(Obstacle::Test)?;
        if before.is_some_and(|before| !self.same_inputs(before, &tube)) {
            return Err(Obstacle::Drive);
        }
        let joined = [here, next].iter().all(|place| self.holds(&tube, place))
            && before.is_none_or(|before| self.same_motion(before, &tube));
        joined.then_some(tube).ok_or(Obstacle::NotJoined)
    }

    /// Brings a path to the motion and proves the tube around it.
    fn prove(&mut self, [start, end]: [f64; 2], mut path: Path) -> Result<Tube, Reason> {
        let bases = self.bases.as_deref().unwrap_or_default();
        let proved = self.blocks.prove(bases, &mut path, true)?;
        Ok(Tube {
            start,
            end,
            radius: proved.largest,
            unique: proved.unique,
            rest: proved.rest,
            path,
        })
    }

    /// Cubic curves of the unknowns through both ends, with the rates there as far as they are known.
    fn first_guess(&self, here: &Place, next: &Place, before: Option<&Tube>) -> Vec<Polynomial> {
        let half = 0.5 * (next.time - here.time);
        let rate = |place: &Place, k: usize| {
            let rate = half * place.rates.as_ref()?.get(k)?;
            rate.is_finite().then_some(rate)
        };
        let curve = |k: usize| {
            let (a, b) = (here.unknowns[k], next.unknowns[k]);
            let (middle, way) = (0.5 * (a + b), 0.5 * (b - a));
            let at_start = before.map(|tube| half * tube.rate_at_end(k));
            let at_start = at_start.or_else(|| rate(here, k));
            // Without one of the rates the curve is quadratic, without both straight.
            let (u, v) = match (at_start, rate(next, k)) {
                (Some(u), Some(v)) => (u, v),
                (Some(u), None) => (u, 2.0 * way - u),
                (None, Some(v)) => (2.0 * way - v, v),
                (None, None) => (way, way),
            };
            let (bend, twist) = (0.25 * (v - u), 0.25 * (u + v) - 0.5 * way);
            let mut curve = [0.0; TERMS];
            curve[..4].copy_from_slice(&[middle - bend, way - twist, bend, twist]);
            curve
        };
        (0..here.unknowns.len()).map(curve).collect()
    }

    /// Takes the inputs of a sample into the enclosed drive.
    fn admit(&self, inputs: &mut InputPath, place: &Place) -> Result<(), Obstacle> {
        let Some((values, _)) = &place.sample else {
            return Ok(());
        };
        let mechanism = self.system.mechanism();
        for (k, value) in values.iter().enumerate() {
            // The pose may have been proved at the input as a table prints it.
            let unit = mechanism.unit_of(mechanism.inputs[k].kind);
            let open = printed::rounding(*value, unit);
            let off = inputs.admit(k, place.time, *value, open);
            if off.is_nan() || off > SAME_INPUT * self.unit(k, *value) {
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
            distance / self.system.mechanism().scale_of(k)
        });
        largest(gap) * (1.0 + 1e-12) + error < tube.unique
    }

    /// Whether the enclosed drive goes on where two tubes meet.
    fn same_inputs(&self, before: &Tube, tube: &Tube) -> bool {
        let slots =
            self.system.mechanism().unknowns.len()..self.system.mechanism().coordinate_count();
        slots.into_iter().all(|k| {
            let (a, b) = (before.path.at(k, tube.start), tube.path.at(k, tube.start));
            a.lo <= b.hi && b.lo <= a.hi
        })
    }

    /// Whether two consecutive tubes have the same pose where they meet.
    fn same_motion(&self, before: &Tube, tube: &Tube) -> bool {
        let gap = (0..self.system.mechanism().unknowns.len()).map(|k| {
            let (a, b) = (before.path.at(k, tube.start), tube.path.at(k, tube.start));
            (a - b).magnitude() / self.system.mechanism().scale_of(k)
        });
        let gap = largest(gap) * (1.0 + 1e-12);
        gap + before.radius < tube.unique || gap + tube.radius < before.unique
    }
}

/// The largest; a number that is none wins.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a: f64, b| if b.is_nan() || b > a { b } else { a })
}
