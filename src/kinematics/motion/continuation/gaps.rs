//! Intervals of the drive without a pose, and the remaining closure error there.

use crate::kinematics::certificate::absence::has_no_pose;
use crate::kinematics::motion::tracker::path_tracker::{PathPoint, PathTracker, Unwatched};
use crate::kinematics::results::trajectory::{Ending, Instant, MotionGap, RemainingGap};
use crate::kinematics::solve::assembly::{NotClosed, smallest_gap};

/// Poses (scaled unknowns) that agree within this are the same pose.
const SAME_POSE: f64 = 1e-6;

/// The gaps of a motion.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gaps {
    /// In the order of time; the last one may be open.
    pub list: Vec<MotionGap>,
    /// The sample of the present gap with the largest closure error.
    widest: Option<(f64, NotClosed)>,
    /// After the end of a motion: a pose of another assembly at the last sample, which the motion cannot reach.
    pub(super) elsewhere: Option<PathPoint>,
}

pub(super) fn gap_instant(tracker: &PathTracker, time: f64) -> Instant {
    Instant {
        time,
        inputs: tracker.actuation().inputs_at(time),
    }
}

impl Gaps {
    /// An interval without a pose begins.
    pub fn open(&mut self, tracker: &PathTracker, from: Option<(f64, Ending)>) {
        self.elsewhere = None;
        self.widest = None;
        let (from, ending) = from.unzip();
        self.list.push(MotionGap {
            from: from.map(|time| gap_instant(tracker, time)),
            until: None,
            ending,
            beginning: None,
            widest: None,
        });
    }

    /// Poses may exist in the present gap; a certain end of the motion before it is kept.
    pub fn give_up(&mut self, ending: Ending) {
        let undecided = |gap: &&mut MotionGap| gap.ending.as_ref().is_none_or(Ending::is_undecided);
        if let Some(gap) = self.list.last_mut().filter(undecided) {
            gap.ending = Some(ending);
        }
    }

    /// Keeps the sample of a gap with the largest closure error.
    pub fn note_lack(&mut self, tracker: &PathTracker, time: f64, best: NotClosed) {
        if self.list.last().is_none_or(|g| g.until.is_some()) {
            self.open(tracker, None);
        }
        let known = self.widest.as_ref();
        if known.is_none_or(|(_, known)| known.amount() < best.amount()) {
            self.widest = Some((time, best));
        }
    }

    /// Computes the closure error at that sample, once per gap. With a `proof` that no assembly closes there, if there
    /// is one.
    pub fn measure(&mut self, tracker: &PathTracker, proof: bool) {
        let Some((time, best)) = self.widest.take() else {
            return;
        };
        let at = gap_instant(tracker, time);
        let proved = proof && has_no_pose(tracker.system(), &at.inputs);
        let lack = smallest_gap(tracker.system(), best);
        if let Some(gap) = self.list.last_mut() {
            gap.widest = Some(RemainingGap {
                at,
                name: lack.name,
                angle: lack.angle,
                distance: lack.distance,
                proved,
            });
        }
    }

    /// Whether `found` belongs to the assembly that was rejected at the previous sample.
    pub fn is_known_elsewhere(&mut self, tracker: &mut PathTracker, found: &PathPoint) -> bool {
        let Some(before) = self.elsewhere.clone() else {
            return false;
        };
        tracker.anchor = Some(before.clone());
        let reached = tracker.follow(before, found.time, &mut Unwatched);
        // The motion of that assembly leads to this pose.
        let same = reached.is_ok_and(|there| {
            let solver = &tracker.solver;
            solver.apart(&there.coordinates, &found.coordinates) <= SAME_POSE
        });
        if same {
            self.elsewhere = Some(found.clone());
        }
        same
    }
}
