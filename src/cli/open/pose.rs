//! The pose of a motion at one instant.

use super::scene::OpenScene;
use crate::cli::interrupt::{is_interrupted, refuse_interrupted};
use crate::cli::motion::solve::up_to;
use crate::cli::term::outcome::Failure;
use crate::kinematics::motion::continuation::solve_until;
use crate::kinematics::motion::sampling::{self, even_times, frame_times};
use crate::kinematics::results::trajectory::Sample;
use crate::report::sentences::input_sentence;

/// Coordinates (unknowns, then inputs) of the pose that the motion reaches at an instant.
///
/// Errors: an instant outside of the motion, or without a pose.
pub fn coordinates_at(open: &OpenScene, at: f64) -> Result<Vec<f64>, Failure> {
    let (scene, system) = (&open.scene, &open.system);
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    let frames = frame_times(mechanism, actuation, scene.view.fps);
    let times = up_to(at, actuation.duration, &frames)?;
    sampling::allow_samples(mechanism, times.len())?;
    let trajectory = solve_until(system, actuation, &times, None, &is_interrupted);
    refuse_interrupted()?;
    let Some(sample) = trajectory.samples.last() else {
        return Ok(Vec::new());
    };
    match &sample.pose {
        Some(_) => Ok(coordinates_of(sample).unwrap_or_default()),
        None => {
            let values = input_sentence(mechanism, &sample.inputs);
            Err(Failure::without_pose(
                trajectory.is_undecided(),
                format!("the motion has no pose at t = {at} s ({values})"),
                vec!["take another time with --at SECONDS".to_owned()],
            ))
        }
    }
}

/// Coordinates at `count` instants spread evenly over the motion; those without a pose are left out.
pub fn coordinates_along(open: &OpenScene, count: usize) -> Result<Vec<Vec<f64>>, Failure> {
    let (mechanism, actuation) = (&open.scene.mechanism, &open.scene.actuation);
    let times = even_times(mechanism, actuation, count);
    let trajectory = solve_until(&open.system, actuation, &times, None, &is_interrupted);
    refuse_interrupted()?;
    Ok(trajectory
        .samples
        .iter()
        .filter_map(coordinates_of)
        .collect())
}

fn coordinates_of(sample: &Sample) -> Option<Vec<f64>> {
    let pose = sample.pose.as_ref()?;
    Some([pose.unknowns.as_slice(), &sample.inputs].concat())
}
