//! Stretches of the drive without a pose: how far the mechanism stays from closing there, and where poses begin again.
//!
//! Where a pose is found after a gap, the motion is followed backwards from it until it ends: the gap's end is located
//! as its beginning is. What can be followed back past the beginning of the gap is another assembly, which the motion
//! cannot reach; taking it up would be a jump.

use super::{Follower, Stand, Stop};
use crate::kinematics::results::trajectory::{EventKind, Gap, Instant, Lack};
use crate::kinematics::solve::assembly::{Assembled, NotClosed, shake, smallest_gap};
use crate::kinematics::solve::newton::Pace;

/// How far from its end the other of two branches that meet there is looked for, as shares of what was followed back:
/// as far as mirroring at the fold is a good picture of it.
const BESIDE_FOLD: [f64; 5] = [3e-2, 3e-3, 3e-4, 3e-5, 3e-6];

/// How far start values are moved aside, in scaled unknowns, where those of the last pose lead to none.
const ASIDE: f64 = 0.3;

/// A gap is seen if it is wider than this power of one half of the way on which it is looked for.
const HALVINGS: i32 = 30;

/// Poses (scaled unknowns) that agree within this are the same pose.
const SAME_POSE: f64 = 1e-6;

impl Follower<'_> {
    pub(crate) fn instant(&self, time: f64) -> Instant {
        Instant {
            time,
            inputs: self.actuation.inputs_at(time),
        }
    }

    /// A stretch without a pose begins.
    pub(crate) fn open_gap(&mut self, from: Option<f64>) {
        self.elsewhere = None;
        self.widest = None;
        self.trajectory.gaps.push(Gap {
            from: from.map(|time| self.instant(time)),
            until: None,
            widest: None,
        });
    }

    /// Keeps the sample of a gap at which most is lacking.
    pub(crate) fn note_lack(&mut self, time: f64, best: NotClosed) {
        if self
            .trajectory
            .gaps
            .last()
            .is_none_or(|g| g.until.is_some())
        {
            self.open_gap(None);
        }
        let size = self.system.mechanism().size;
        let amount = |lack: &NotClosed| lack.angle.max(lack.distance / size);
        let known = self.widest.as_ref();
        if known.is_none_or(|(_, known)| amount(known) < amount(&best)) {
            self.widest = Some((time, best));
        }
    }

    /// Measures what is lacking at the sample kept: worth its time once a gap.
    pub(crate) fn measure_gap(&mut self) {
        let Some((time, best)) = self.widest.take() else {
            return;
        };
        let lack = smallest_gap(self.system, best);
        let at = self.instant(time);
        if let Some(gap) = self.trajectory.gaps.last_mut() {
            gap.widest = Some(Lack {
                at,
                name: lack.name,
                angle: lack.angle,
                distance: lack.distance,
            });
        }
    }

    /// Assembles from `start`, and from beside it where that fails: from links in line no correction leaves the line.
    pub(crate) fn assembled_from_beside(&mut self, start: &[f64]) -> Result<Assembled, NotClosed> {
        self.assembled(start, false).or_else(|gap| {
            let mut beside = start.to_vec();
            shake(
                self.system.mechanism(),
                self.trajectory.samples.len(),
                ASIDE,
                &mut beside,
            );
            let found = self.assembled(&beside, false).map_err(|_| gap)?;
            Ok(Assembled { start: 1, ..found })
        })
    }

    /// After a gap: assembles again from the last pose, without searching.
    pub(crate) fn resume(&mut self, last: Stand, time: f64) -> Result<Stand, Option<Stand>> {
        let Ok(inputs) = self.inputs(time) else {
            return Err(None);
        };
        let unknowns = &last.coordinates[..self.system.mechanism().unknowns.len()];
        let start = [unknowns, &inputs].concat();
        match self.assembled_from_beside(&start) {
            Ok(found) => {
                self.iterations += found.iterations;
                let stand = self.stand(time, found.coordinates);
                if self.is_known_elsewhere(&stand) {
                    return Err(None);
                }
                self.re_enter(&last, stand)
            }
            Err(best) => {
                self.note_lack(time, best);
                Err(None)
            }
        }
    }

    /// The first pose of a motion whose drive begins where there is none.
    pub(crate) fn enter(&mut self, found: Stand) -> Result<Stand, Option<Stand>> {
        let first = self.walk_back(&found, None);
        self.close_gap(&found, first.map_or(found.time, |s| s.time), true);
        Ok(self.restart(found))
    }

    /// Takes the motion up again at `found`, on the branch of `last` if it can.
    fn re_enter(&mut self, last: &Stand, found: Stand) -> Result<Stand, Option<Stand>> {
        let gap = self.trajectory.gaps.last();
        let began = gap.and_then(|g| g.from.as_ref()).map(|from| from.time);
        let Some(first) = self.walk_back(&found, began) else {
            self.elsewhere = Some(found);
            return Err(None);
        };
        let found = if found.branch.signs == last.branch.signs {
            found
        } else {
            self.other_branch(&first, &found, last).unwrap_or(found)
        };
        let same_branch = found.branch.signs == last.branch.signs;
        self.close_gap(&found, first.time, same_branch);
        Ok(self.restart(found))
    }

    /// Follows the motion backwards from `found` to where it ends; `None` if it reaches `limit`.
    pub(crate) fn walk_back(&mut self, found: &Stand, limit: Option<f64>) -> Option<Stand> {
        let start = self.trajectory.samples.first().map(|s| s.time);
        let target = limit.or(start)?;
        let events = self.trajectory.events.len();
        self.anchor = Some(found.clone());
        // Ever shorter stretches, so that one of them ends inside of the narrowest gap before the target.
        let halvings = if limit.is_some() { HALVINGS } else { 0 };
        let way = found.time - target;
        let mut targets = (1..=halvings).map(|k| target + way * 0.5_f64.powi(k));
        let end = targets.try_fold(found.clone(), |here, time| self.follow(here, time));
        let end = end.and_then(|here| self.follow(here, target));
        self.trajectory.events.truncate(events);
        self.crossing = None;
        match end {
            Ok(_) => None,
            Err(Stop::Ends(stand) | Stop::Undefined(_, stand)) => Some(stand),
        }
    }

    /// The other of the two branches that meet at `first`, at the time of `found`.
    fn other_branch(&mut self, first: &Stand, found: &Stand, last: &Stand) -> Option<Stand> {
        let events = self.trajectory.events.len();
        let other = BESIDE_FOLD.iter().find_map(|share| {
            let time = first.time + share * (found.time - first.time);
            let mirrored = self.mirrored(first, found, time)?;
            (mirrored.branch.signs == last.branch.signs).then_some(mirrored)
        });
        let reached = other.and_then(|stand| {
            self.anchor = Some(stand.clone());
            self.follow(stand, found.time).ok()
        });
        self.trajectory.events.truncate(events);
        self.crossing = None;
        reached
    }

    /// The pose at `time` of the branch that `found` is not on, mirrored at the fold where both begin.
    fn mirrored(&mut self, fold: &Stand, found: &Stand, time: f64) -> Option<Stand> {
        self.anchor = Some(found.clone());
        let mut coordinates = self.follow(found.clone(), time).ok()?.coordinates;
        let n = self.system.mechanism().unknowns.len();
        for (q, fold) in coordinates[..n].iter_mut().zip(&fold.coordinates) {
            *q = 2.0 * fold - *q;
        }
        let correction = self.correct(&mut coordinates, Pace::Brisk);
        correction.converged.then(|| self.stand(time, coordinates))
    }

    fn close_gap(&mut self, found: &Stand, time: f64, same_branch: bool) {
        self.measure_gap();
        let until = self.instant(time);
        if let Some(gap) = self.trajectory.gaps.last_mut() {
            gap.until = Some(until);
        }
        let events = self.trajectory.events.len();
        self.fill_back(found, time);
        self.trajectory.events.truncate(events);
        self.event(time, EventKind::MotionResumes { same_branch });
    }

    /// Lost samples behind the end of a gap have poses after all: the search from before the gap has missed them.
    fn fill_back(&mut self, found: &Stand, time: f64) {
        let mut here = found.clone();
        for index in (0..self.trajectory.samples.len()).rev() {
            let sample = &self.trajectory.samples[index];
            if sample.pose.is_some() || sample.time < time {
                return;
            }
            self.anchor = Some(here.clone());
            match self.follow(here, sample.time) {
                Ok(stand) => {
                    self.trajectory.samples[index].pose = self.closed_pose(&stand);
                    here = stand;
                }
                Err(_) => return,
            }
        }
    }

    /// The motion goes on from `stand`; what was met before is no anchor any more.
    fn restart(&mut self, stand: Stand) -> Stand {
        self.anchor = None;
        self.keep(stand)
    }

    /// Whether `found` belongs to the assembly that was refused at the sample before.
    fn is_known_elsewhere(&mut self, found: &Stand) -> bool {
        let Some(before) = self.elsewhere.clone() else {
            return false;
        };
        self.anchor = Some(before.clone());
        let events = self.trajectory.events.len();
        let reached = self.follow(before, found.time);
        self.trajectory.events.truncate(events);
        self.crossing = None;
        let n = self.system.mechanism().unknowns.len();
        let same = reached.is_ok_and(|there| {
            let pairs = there.coordinates.iter().zip(&found.coordinates).take(n);
            let scaled = pairs.enumerate();
            scaled
                .into_iter()
                .all(|(k, (a, b))| (a - b).abs() <= SAME_POSE * self.system.mechanism().scale_of(k))
        });
        if same {
            self.elsewhere = Some(found.clone());
        }
        same
    }
}
