//! The poses that a page shows: those of the check, thinned out if there are too many, and the worst moments.

use crate::clearance::check::ClearanceReport;
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;

/// Most frames: more are invisible and make the file large.
const MOST_FRAMES: usize = 241;

/// Most placements of bodies: each takes 37 characters of the file.
const MOST_PLACEMENTS: usize = 6000;

/// Most pairs of bodies whose worst moments are shown exactly, between the samples.
const MOST_MOMENTS: usize = 12;

/// Moments nearer to each other than this fraction of the motion are merged.
const SAME_MOMENT: f64 = 1e-6;

/// The trajectory that a page shows: the samples with a pose, and the worst moments of pairs of bodies.
pub fn shown_trajectory(
    system: &System,
    actuation: &Actuation,
    trajectory: &Trajectory,
    clearances: Option<&ClearanceReport>,
) -> Trajectory {
    let bodies = system.mechanism().bodies.len().max(1);
    let most = (MOST_PLACEMENTS / bodies).clamp(2, MOST_FRAMES);
    let posed = trajectory.samples.iter().filter(|s| s.pose.is_some());
    let posed: Vec<f64> = posed.map(|s| s.time).collect();
    let count = posed.len().min(most);
    let place = |k: usize| k * (posed.len() - 1) / (count - 1).max(1);
    let mut times: Vec<f64> = (0..count).map(|k| posed[place(k)]).collect();
    let near = SAME_MOMENT * actuation.duration;
    times.dedup_by(|next, last| *next - *last <= near);
    let pairs = clearances
        .into_iter()
        .flat_map(|found| found.judged.iter().take(MOST_MOMENTS));
    for pair in pairs {
        let time = pair.least.time;
        if times.iter().all(|known| (known - time).abs() > near) {
            times.push(time);
        }
    }
    times.sort_by(f64::total_cmp);
    // The samples in between are solved too, so that the page shows the motion that was checked.
    let mut all: Vec<f64> = trajectory
        .samples
        .iter()
        .map(|s| s.time)
        .chain(times.iter().copied())
        .collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    let whole = match all.len() == trajectory.samples.len() {
        true => trajectory.clone(),
        false => solve_motion(system, actuation, &all),
    };
    let is_shown = |time: f64| {
        times
            .binary_search_by(|known| known.total_cmp(&time))
            .is_ok()
    };
    let samples = whole.samples.into_iter();
    Trajectory {
        samples: samples
            .filter(|s| s.pose.is_some() && is_shown(s.time))
            .collect(),
        ..Trajectory::default()
    }
}

/// The frame nearest to a time.
pub fn nearest_frame(shown: &Trajectory, time: f64) -> usize {
    let distance = |k: &usize| (shown.samples[*k].time - time).abs();
    let frames = 0..shown.samples.len();
    frames
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(0)
}
