//! Events between samples: singular poses that are passed or met, and locked ball joints. The tracker reports them on
//! the way.

use super::crossings::{SignChange, zero_between};
use crate::kinematics::motion::tracker::path_tracker::{PathPoint, PathTracker, PathWatcher};
use crate::kinematics::results::passed::PassedPoses;
use crate::kinematics::results::trajectory::{Event, EventKind};
use crate::model::actuation::Actuation;

/// The events of a motion.
#[derive(Clone, Debug, Default)]
pub(crate) struct Events {
    /// In the order in which they were met.
    pub list: Vec<Event>,
    /// A singular pose that has been passed and not been located yet.
    pub crossing: Option<SignChange>,
    /// Time of a sample that lies on a singular pose, until it is known how the motion goes on.
    pub singular_sample: Option<f64>,
    /// The poses on the way, on request.
    pub passed: Option<PassedPoses>,
}

impl Events {
    pub fn add(&mut self, actuation: &Actuation, time: f64, kind: EventKind) {
        let inputs = actuation.inputs_at(time);
        self.list.push(Event { time, inputs, kind });
    }

    /// A singular pose near `time` was passed.
    pub fn passed_at(&mut self, tracker: &PathTracker, time: f64) {
        self.singular_sample = None;
        self.add(tracker.actuation(), time, EventKind::SingularPosePassed);
        self.crossing = tracker.anchor.clone().map(|before| SignChange {
            event: self.list.len() - 1,
            before,
        });
    }

    /// Locates the last crossing, now that there is a regular pose after it.
    pub(crate) fn locate_crossing(&mut self, tracker: &mut PathTracker, after: &PathPoint) {
        let Some(crossing) = self.crossing.take() else {
            return;
        };
        let Some(time) = zero_between(tracker, crossing.before, after.clone()) else {
            return;
        };
        let inputs = tracker.actuation().inputs_at(time);
        if let Some(event) = self.list.get_mut(crossing.event) {
            event.time = time;
            event.inputs = inputs;
        }
    }
}

impl PathWatcher for Events {
    fn accepted(&mut self, tracker: &mut PathTracker, point: &PathPoint) {
        self.watch_locks(tracker, point);
        if let Some(passed) = &mut self.passed {
            passed.keep(point.time, &point.coordinates[..tracker.unknowns()]);
        }
    }

    fn regular(&mut self, tracker: &mut PathTracker, point: &PathPoint) {
        self.locate_crossing(tracker, point);
    }

    fn passed(&mut self, tracker: &PathTracker, time: f64) {
        self.passed_at(tracker, time);
    }

    fn turned_back(&mut self, tracker: &PathTracker) {
        if let Some(time) = self.singular_sample.take() {
            self.add(tracker.actuation(), time, EventKind::SingularPoseMet);
        }
    }
}
