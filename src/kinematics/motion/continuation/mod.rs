//! The motion along a drive as samples and events: the tracker goes from sample to sample, and events between them are
//! located and reported.

mod crossings;
mod domain_proof;
mod endings;
mod events;
mod fold_proof;
mod gaps;
mod locks;
mod poses;
mod proved_stretch;
mod recorder;
mod resumptions;
mod starts;

use crate::kinematics::results::trajectory::{EventKind, Trajectory};
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::printed::InputReading;
use recorder::Recorder;

/// Solves `system` along `actuation` at the given ascending times. A pose that does not exist is an event in the
/// trajectory.
pub fn solve_motion(system: &System, actuation: &Actuation, times: &[f64]) -> Trajectory {
    solve_until(
        system,
        actuation,
        times,
        Some(InputReading::Numbers),
        &|| false,
    )
}

/// The same with certificates for the inputs as they are `read`, or without certificates. Stops early, with the samples
/// so far, when `cancelled` says so.
pub fn solve_until(
    system: &System,
    actuation: &Actuation,
    times: &[f64],
    read: Option<InputReading>,
    cancelled: &dyn Fn() -> bool,
) -> Trajectory {
    let recorder = Recorder::new(system, actuation, cancelled);
    match read {
        Some(reading) => recorder.proving(reading).run(times),
        None => recorder.run(times),
    }
}

/// [`solve_until`] with certificates, in so many steps at most, at times that may be as near to each other as they can be told
/// apart.
pub fn solve_closer(
    system: &System,
    actuation: &Actuation,
    (times, steps): (&[f64], usize),
    reading: InputReading,
    cancelled: &dyn Fn() -> bool,
) -> Trajectory {
    let recorder = Recorder::new(system, actuation, cancelled).proving(reading);
    recorder.looking_closer(steps).run(times)
}

/// [`solve_until`] with additional samples where the motion ends and resumes, as curves need.
pub fn solve_with_ends(
    system: &System,
    actuation: &Actuation,
    times: &[f64],
    cancelled: &dyn Fn() -> bool,
) -> Trajectory {
    let recorder = Recorder::new(system, actuation, cancelled);
    let recorder = recorder.proving(InputReading::Numbers);
    recorder.with_edges().run(times)
}

/// [`solve_motion`] without certificates of the poses.
pub fn solve_unproved(system: &System, actuation: &Actuation, times: &[f64]) -> Trajectory {
    solve_until(system, actuation, times, None, &|| false)
}

/// The motion without certificates, if it has no gap; ends at the first one.
pub fn solve_whole(system: &System, actuation: &Actuation, times: &[f64]) -> Option<Trajectory> {
    let recorder = Recorder::new(system, actuation, &|| false);
    let motion = recorder.up_to_gaps().run(times);
    let mut ends = motion.events.iter();
    let broken = ends.any(|e| matches!(e.kind, EventKind::MotionEnds(_)));
    let all = motion.samples.len() == times.len() && motion.missing() == 0;
    (all && !broken).then_some(motion)
}
