//! The poses at which tubes meet: at the breaks of the drive, immediately before and after its jumps, and where a time
//! interval is halved.

use super::drive::{DriveInterval, distinct_between, keys_between};
use super::path::InputPath;
use super::prover::Prover;
use super::stretches::Station;
use crate::kinematics::results::certificate::{ProofObstacle, ProofRefusal};
use crate::kinematics::solve::newton::Pace;
use crate::model::expression::Expression;

/// Number of steps in which the motion is followed to the pose just before a jump.
const STEPS_TO_JUMP: u32 = 8;

/// The drive just before a jump is evaluated over this fraction of the distance to it, ...
const AT_JUMP: f64 = 1.0 / 65_536.0;

/// ... but no less than this fraction of the time, or of a second: the jump itself is known a hundred times as
/// accurately.
const LEAST_AT_JUMP: f64 = 1e-10;

impl Prover<'_> {
    /// Times between two others that part stretches: by the drives of the inputs, and by arguments that the time tells.
    fn partings(&self, start: f64, end: f64) -> Vec<f64> {
        let own = self.actuation.drives.iter();
        let own = own.flat_map(|drive| drive.breaks(start, end));
        let placed = self.placed.iter().filter_map(|p| p.timed.as_ref());
        let placed = placed.flat_map(|timed| timed.breaks(start, end));
        distinct_between(own.chain(placed).collect(), start, end)
    }

    /// The inputs between two times that nothing parts.
    pub(super) fn inputs_over(&self, start: f64, end: f64) -> InputPath {
        let middle = 0.5 * start + 0.5 * end;
        let placed = self.placed.iter().filter_map(|p| p.timed.as_ref());
        let placed = placed.filter(|timed| timed.may_jump());
        let placed: Vec<&Expression> = placed.map(|timed| timed.piece(middle)).collect();
        InputPath::new(&self.actuation, &placed, DriveInterval::new(start, end))
    }

    /// The end of the interval and the breaks of the drive before it, the first one last.
    pub(super) fn by_keyframes(
        &mut self,
        start: &Station,
        end: Station,
    ) -> Result<Vec<Station>, ProofRefusal> {
        let mut ahead = Vec::new();
        for time in self.partings(start.time, end.time) {
            let place = self.pose_between(start, &end, time).ok_or(ProofRefusal {
                time: start.time,
                obstacle: ProofObstacle::NotJoined,
            })?;
            ahead.push(place);
        }
        ahead.push(end);
        ahead.reverse();
        Ok(ahead)
    }

    /// The pose to which the drive leads right before `last`, to which it jumps.
    pub(super) fn before_a_jump(&mut self, here: &Station, last: Station) -> Station {
        let keys = keys_between(&self.actuation.drives, here.time, last.time);
        let from = keys.last().copied().unwrap_or(here.time);
        self.beside_a_jump(last, here, from)
    }

    /// The pose from which the drive leads on right after `here`, from which it jumps.
    pub(super) fn after_a_jump(&mut self, here: Station, last: &Station) -> Station {
        let keys = keys_between(&self.actuation.drives, here.time, last.time);
        let from = keys.first().copied().unwrap_or(last.time);
        self.beside_a_jump(here, last, from)
    }

    /// The limit of the motion at a jump to or from `at`, on the side of `from`: followed from the pose on that side.
    fn beside_a_jump(&mut self, at: Station, there: &Station, from: f64) -> Station {
        // Enclosed over a short time only, so that fast changes farther away do not matter.
        let way = (from - at.time).abs();
        let least = LEAST_AT_JUMP * at.time.abs().max(1.0);
        let beside = at.time + (from - at.time).signum() * way.min(least.max(AT_JUMP * way));
        let ends = [beside.min(at.time), beside.max(at.time)];
        let inputs = self.inputs_over(ends[0], ends[1]);
        let limit = |k: usize| inputs.at(k, at.time).middle();
        let mut coordinates = there.unknowns.clone();
        for step in 1..=STEPS_TO_JUMP {
            let share = f64::from(step) / f64::from(STEPS_TO_JUMP);
            let time = from + share * (at.time - from);
            coordinates.truncate(there.unknowns.len());
            match step < STEPS_TO_JUMP {
                true => coordinates.extend(self.actuation.inputs_at(time)),
                false => coordinates.extend((0..self.actuation.drives.len()).map(limit)),
            }
            if !self.solver.closed(&mut coordinates, Pace::Brisk) {
                return at;
            }
        }
        coordinates.truncate(there.unknowns.len());
        Station {
            time: at.time,
            unknowns: coordinates,
            rates: None,
            sample: None,
        }
    }

    /// A closed pose at `time`, corrected from the straight line between the nearest known poses; if that fails, the motion
    /// is followed from the first one. The proof determines its assembly.
    pub(super) fn pose_between(&mut self, a: &Station, b: &Station, time: f64) -> Option<Station> {
        let ends = [a, b].map(|place| (place.time, &place.unknowns[..]));
        let [from, to] = self.passed.nearest(time, ends);
        let share = (time - from.0) / (to.0 - from.0);
        let actuation = &self.actuation;
        let inputs = actuation.inputs_at(time);
        let on_the_line = (self.solver).between([from.1, to.1], share, &inputs, Pace::Brisk);
        let along = |part: f64| actuation.inputs_along([from.0, time], part);
        let found = on_the_line.or_else(|| self.solver.followed(from.1, along));
        let mut unknowns = found?;
        unknowns.truncate(a.unknowns.len());
        Some(Station {
            time,
            unknowns,
            rates: None,
            sample: None,
        })
    }
}
