//! From sample to sample: where tubes begin and end, and how they are connected to each other and to the samples.

use super::blocks::Blocks;
use super::path::{InputPath, TubePath};
use super::placed::{PlacedArgument, placed_arguments};
use super::stretches::{Bases, Station, Tube, largest_value};
use super::taylor_model::{Polynomial, TERMS};
use crate::kinematics::certificate::pose::prover::PoseProver;
use crate::kinematics::results::certificate::{
    Certificate, IntervalCertificate, ProofObstacle, ProofRefusal, Reason,
};
use crate::kinematics::results::passed::PassedPoses;
use crate::kinematics::results::trajectory::{SAME_INPUT, Sample};
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::drive::Drive;
use crate::model::expression::continuity::Jumps;
use crate::model::expression::pieces::around_instant;
use crate::model::mechanism::Kind;
use crate::model::printed;
use crate::numbers::rounding::{GROW, SHRINK};
use std::sync::Arc;

/// Shortest time interval, as a fraction of the interval between two samples: near a singular pose tubes are as short
/// as its distance, without end.
pub const FLOOR: f64 = 1.0 / 65_536.0;

/// Positions in a time interval at which the rows of over-determined blocks are chosen: the middle, and if that choice
/// fails either end.
const CHOICES: [f64; 3] = [0.5, 0.0, 1.0];

/// Proves intervals of one mechanism.
#[derive(Debug)]
pub struct Prover<'m> {
    pub(super) system: &'m System,
    pub(super) actuation: Actuation,
    pub(super) blocks: Blocks<'m>,
    pub(super) solver: PoseSolver<'m>,
    /// All rows of every block; `None` if a block has more of them than unknowns.
    all_rows: Option<Bases>,
    /// Examines redundant rows with more digits than tubes have; `None` without such rows.
    digits: Option<PoseProver<'m>>,
    /// Whether an interval may end where the drive jumps; it is then proved up to the jump.
    may_jump: bool,
    /// Distance of every input from its drive; none by default.
    play: Vec<f64>,
    /// Poses between the samples.
    pub(super) passed: Arc<PassedPoses>,
    /// Arguments with kinks and cuts.
    pub(super) placed: Vec<PlacedArgument>,
}

impl<'m> Prover<'m> {
    /// Prepares the proofs.
    pub fn new(system: &'m System, actuation: &Actuation) -> Self {
        let is_square = |block: &Block| block.rows() == block.unknowns.len();
        Self {
            system,
            actuation: actuation.clone(),
            blocks: Blocks::new(system),
            solver: PoseSolver::new(system),
            all_rows: (system.blocks().iter()).all(is_square).then(|| {
                let rows = system.blocks().iter();
                Arc::new(rows.map(|b| (0..b.rows()).collect()).collect())
            }),
            digits: (system.redundant_rows() > 0).then(|| PoseProver::new(system)),
            may_jump: false,
            play: Vec::new(),
            passed: Arc::default(),
            placed: placed_arguments(system.mechanism(), actuation),
        }
    }

    /// With poses between the samples, at which intervals that are too long for one tube are parted safely.
    pub fn through(mut self, passed: &Arc<PassedPoses>) -> Self {
        self.passed = Arc::clone(passed);
        self
    }

    /// Whether inputs may deviate from their drives.
    pub fn has_play(&self) -> bool {
        self.play.iter().any(|play| *play > 0.0)
    }

    /// Allows every input to deviate from its drive by its play at every instant: results hold for all such motions.
    pub fn with_play(mut self, play: Vec<f64>) -> Self {
        self.play = play;
        if self.has_play() {
            // The time alone does not tell the inputs.
            self.placed.iter_mut().for_each(|p| p.timed = None);
        }
        self
    }

    /// Allows intervals to begin and end where the drive jumps: they are proved up to there, and the sample beyond is
    /// not connected.
    pub fn up_to_jumps(mut self) -> Self {
        self.may_jump = self.actuation.drives.iter().any(Drive::may_jump);
        self
    }

    /// Where drives and joints that depend on the time alone jump.
    pub fn jumps_between(&self, start: f64, end: f64) -> Jumps {
        let of_placed = self
            .jumping()
            .map(|(_, timed)| timed.jumps_between(start, end));
        of_placed.fold(self.actuation.jumps_between(start, end), Jumps::and)
    }

    /// Whether a sample's inputs are those of the tube at that time, which fails at a jump of the drive. Tubes begin
    /// and end with the exact poses of samples with their inputs.
    pub fn has_inputs(&self, tube: &Tube, sample: &Sample) -> bool {
        let jumps = self.jumps_between(tube.start, tube.end);
        if (jumps.at_start && sample.time == tube.start)
            || (jumps.at_end && sample.time == tube.end)
        {
            return false;
        }
        let slot = self.system.mechanism().unknowns.len();
        let is_same = |(k, value): (usize, &f64)| {
            let off = tube.path.at(slot + k, sample.time).distance(*value);
            off <= SAME_INPUT * self.unit(k, *value)
        };
        sample.inputs.iter().enumerate().all(is_same)
    }

    /// Proves the interval between the two samples of `pair`; the tubes are those up to its end or its refusal.
    pub fn interval(&mut self, pair: &[Sample]) -> (IntervalCertificate, Vec<Tube>) {
        let (tubes, refused) = self.tubes(pair, FLOOR);
        let [least, largest] = self.system.mechanism().distance_units();
        let radius = tubes.iter().map(|t: &Tube| t.radius).fold(0.0, f64::max);
        let unique = tubes.iter().map(|t| t.unique).fold(f64::INFINITY, f64::min);
        let certificate = IntervalCertificate {
            tubes: tubes.len(),
            radius: radius * largest * GROW,
            unique_radius: unique * least * SHRINK,
            closes_to: self.closes_to(tubes.iter()),
            refused,
        };
        (certificate, tubes)
    }

    /// How well redundant equations are proved to close along these tubes, in the scene's unit; `None` without any of them.
    pub fn closes_to<'t>(&self, tubes: impl Iterator<Item = &'t Tube>) -> Option<f64> {
        let largest = tubes.map(|tube| tube.closes_to).reduce(f64::max);
        let unit = self.system.mechanism().distance_units()[1];
        let largest = largest.filter(|_| self.digits.is_some());
        largest.map(|largest| largest * unit * GROW)
    }

    /// The tubes of an interval, from its start up to its end or a failure. None is shorter than `floor` of the
    /// interval.
    pub fn tubes(&mut self, pair: &[Sample], floor: f64) -> (Vec<Tube>, Option<ProofRefusal>) {
        let mut tubes = Vec::new();
        let refused = match pair {
            [start, end] => self.between(start, end, floor, &mut tubes).err(),
            _ => None,
        };
        (tubes, refused)
    }

    /// The same motion in two thinner tubes; `None` if they cannot be proved.
    pub fn halves(&mut self, tube: &Tube) -> Option<[Tube; 2]> {
        let middle = 0.5 * tube.start + 0.5 * tube.end;
        let mut part = |start: f64, end: f64| {
            let inputs = self.inputs_over(start, end).widened(&self.play);
            let path = inputs.with(tube.path.part(
                self.system.mechanism().unknowns.len(),
                start,
                end,
            ));
            let half = self.prove([start, end], path, &tube.bases).ok()?;
            half.has_motion_of(tube, self.system.mechanism())
                .then_some(half)
        };
        Some([part(tube.start, middle)?, part(middle, tube.end)?])
    }

    fn between(
        &mut self,
        start: &Sample,
        end: &Sample,
        floor: f64,
        tubes: &mut Vec<Tube>,
    ) -> Result<(), ProofRefusal> {
        let refuse = |sample: &Sample, obstacle| ProofRefusal {
            time: sample.time,
            obstacle,
        };
        let mut here = self.place(start).map_err(|o| refuse(start, o))?;
        let mut last = self.place(end).map_err(|o| refuse(end, o))?;
        let jumps = self.actuation.jumps_between(start.time, end.time);
        if jumps.at_end {
            if !self.may_jump {
                return Err(refuse(end, ProofObstacle::Drive));
            }
            last = self.before_a_jump(&here, last);
        }
        // Of two jumps neither pose is on the motion between them: of open chains alone it is known where that is.
        if jumps.at_start {
            if !self.may_jump || (jumps.at_end && !last.unknowns.is_empty()) {
                return Err(refuse(start, ProofObstacle::Drive));
            }
            here = self.after_a_jump(here, &last);
        }
        let floor = floor * (end.time - start.time);
        // Bisection in time: a stack of poses ahead, halved until every tube is proved.
        let mut ahead = self.by_keyframes(&here, last)?;
        let inside = jumps.inside.map(|time| around_instant(time).lo);
        while let Some(next) = ahead.pop() {
            if inside.is_some_and(|jump| jump <= here.time) {
                return Err(ProofRefusal {
                    time: here.time,
                    obstacle: ProofObstacle::Drive,
                });
            }
            match self.tube(&here, &next, tubes.last()) {
                Ok(tube) => {
                    tubes.push(tube);
                    here = next;
                }
                Err(obstacle) => {
                    let time = 0.5 * here.time + 0.5 * next.time;
                    // Times that are next to each other have none between them.
                    let is_between = here.time < time && time < next.time;
                    if next.time - here.time < 2.0 * floor || !is_between {
                        return Err(ProofRefusal {
                            time: here.time,
                            obstacle,
                        });
                    }
                    let middle = self.pose_between(&here, &next, time);
                    let middle = middle.ok_or(ProofRefusal {
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
    fn place(&self, sample: &Sample) -> Result<Station, ProofObstacle> {
        let pose = sample.pose.as_ref().ok_or(ProofObstacle::NoPose)?;
        let error = match pose.certificate {
            Certificate::Certified { error_bound, .. }
            | Certificate::Consistent { error_bound, .. } => error_bound,
            // Tubes describe angles, which have no bound here.
            Certificate::Locked { .. } => return Err(ProofObstacle::Test(Reason::GimbalLock)),
            Certificate::Refused { reason } => return Err(ProofObstacle::Test(reason)),
        };
        Ok(Station {
            time: sample.time,
            unknowns: pose.unknowns.clone(),
            rates: Some(pose.rates.clone()),
            sample: Some((
                sample.inputs.clone(),
                error / self.system.mechanism().distance_units()[1] * GROW,
            )),
        })
    }

    /// What differences of input `k` are measured in, at a value.
    fn unit(&self, k: usize, value: f64) -> f64 {
        let mechanism = self.system.mechanism();
        match mechanism.inputs[k].kind {
            Kind::Length => mechanism.scale_of(mechanism.unknowns.len() + k),
            _ => value.abs().max(1.0),
        }
    }

    /// Proves the tube from `here` to `next` and connects it to its neighbours.
    fn tube(
        &mut self,
        here: &Station,
        next: &Station,
        before: Option<&Tube>,
    ) -> Result<Tube, ProofObstacle> {
        let mut inputs = self.inputs_over(here.time, next.time).widened(&self.play);
        if !inputs.is_finite() {
            return Err(ProofObstacle::Drive);
        }
        for place in [here, next] {
            self.admit(&mut inputs, place)?;
        }
        let path = inputs.with(self.first_guess(here, next, before));
        let tube = self.prove_on_some_rows(here, next, &path);
        let tube = tube.map_err(ProofObstacle::Test)?;
        if before.is_some_and(|before| !tube.has_inputs_of(before, self.system.mechanism())) {
            return Err(ProofObstacle::Drive);
        }
        let joined = [here, next].iter().all(|place| self.holds(&tube, place))
            && before.is_none_or(|before| tube.has_motion_of(before, self.system.mechanism()));
        joined.then_some(tube).ok_or(ProofObstacle::NotJoined)
    }

    /// Proves the tube on suitable rows: an over-determined block leaves a choice, and rows that are good at one pose
    /// may be dependent at another.
    fn prove_on_some_rows(
        &mut self,
        here: &Station,
        next: &Station,
        path: &TubePath,
    ) -> Result<Tube, Reason> {
        let ends = [here.time, next.time];
        // Where all blocks are square there is no choice.
        if let Some(rows) = self.all_rows.clone() {
            return self.prove(ends, path.clone(), &rows);
        }
        let mut refusal = None;
        let mut tried: Vec<Bases> = Vec::new();
        for share in CHOICES {
            let time = here.time + share * (next.time - here.time);
            let Some(place) = self.pose_between(here, next, time) else {
                continue;
            };
            // The most independent rows at a closed pose of the interval.
            let inputs = self.actuation.inputs_at(time);
            let rows = Arc::new(self.solver.best_rows(&[place.unknowns, inputs].concat()));
            // Other poses often choose the same ones.
            if tried.contains(&rows) {
                continue;
            }
            match self.prove(ends, path.clone(), &rows) {
                Ok(tube) => return Ok(tube),
                // The first refusal is the one that is reported.
                Err(reason) => refusal = refusal.or(Some(reason)),
            }
            tried.push(rows);
        }
        Err(refusal.unwrap_or(Reason::Singular))
    }

    /// Brings a path to the motion and proves the tube around it.
    fn prove(
        &mut self,
        [start, end]: [f64; 2],
        mut path: TubePath,
        bases: &Bases,
    ) -> Result<Tube, Reason> {
        let proved = self.blocks.prove(bases, &mut path, true)?;
        if self.is_open_at(0.5 * start + 0.5 * end, &path, bases) {
            return Err(Reason::Open);
        }
        Ok(Tube {
            start,
            end,
            radius: proved.largest,
            unique: proved.unique,
            closes_to: proved.closes_to,
            rest: proved.rest,
            path,
            bases: Arc::clone(bases),
        })
    }

    /// Whether it is proved that a redundant row does not hold at a time: its closure error may be too small for a
    /// tube.
    fn is_open_at(&mut self, time: f64, path: &TubePath, bases: &Bases) -> bool {
        let Some(digits) = &mut self.digits else {
            return false;
        };
        let unknowns = 0..self.blocks.unknowns;
        let mut place: Vec<f64> = unknowns.map(|k| path.at(k, time).middle()).collect();
        place.extend(self.actuation.inputs_at(time));
        let reason = match digits.prove([&place, &[]], bases, None) {
            Err(Reason::Formula) => {
                let mut still = TubePath::standing(self.blocks.unknowns, &place, &[]);
                self.blocks.prove(bases, &mut still, false).err()
            }
            proved => proved.err(),
        };
        reason == Some(Reason::Open)
    }

    /// Cubic curves of the unknowns through both ends, with the rates there if they are known.
    fn first_guess(&self, here: &Station, next: &Station, past: Option<&Tube>) -> Vec<Polynomial> {
        let half = 0.5 * (next.time - here.time);
        let rate = |place: &Station, k: usize| {
            let rate = half * place.rates.as_ref()?.get(k)?;
            rate.is_finite().then_some(rate)
        };
        let curve = |k: usize| {
            let (a, b) = (here.unknowns[k], next.unknowns[k]);
            let (middle, way) = (0.5 * (a + b), 0.5 * (b - a));
            let at_start = past.map(|tube| half * tube.rate_at_end(k));
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
    fn admit(&self, inputs: &mut InputPath, place: &Station) -> Result<(), ProofObstacle> {
        let Some((values, _)) = &place.sample else {
            return Ok(());
        };
        let mechanism = self.system.mechanism();
        for (k, value) in values.iter().enumerate() {
            // The pose may have been proved at the input as printed in a table.
            let open = printed::input_rounding(*value, mechanism.unit_of(mechanism.inputs[k].kind));
            let off = inputs.admit(k, place.time, *value, open);
            if off.is_nan() || off > SAME_INPUT * self.unit(k, *value) {
                return Err(ProofObstacle::Drive);
            }
        }
        Ok(())
    }

    /// Whether the exact pose of a sample is that of the tube there.
    fn holds(&self, tube: &Tube, place: &Station) -> bool {
        let Some((_, error)) = &place.sample else {
            return true;
        };
        let unknowns = place.unknowns.iter().enumerate();
        let gap = unknowns.map(|(k, q)| {
            let distance = tube.path.at(k, place.time).distance(*q);
            distance / self.system.mechanism().scale_of(k)
        });
        largest_value(gap) * GROW + error < tube.unique
    }
}
