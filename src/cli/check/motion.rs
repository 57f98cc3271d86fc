//! The check of a whole motion.

use super::answer::Answer;
use super::{clearance, swept};
use crate::cli::args::motion::{CertifyArg, CheckArgs};
use crate::cli::motion::{certify, event_messages};
use crate::cli::open::inputs_table;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::kinematics::motion::sampling::{even_times, frame_times, knot_times};
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::mechanism::Mechanism;
use crate::report::check::{MotionReport, without_pose};
use crate::report::verdict::{Asked, Verdict};
use crate::report::{closure, measures};
use std::time::Instant;

/// Solves the motion and asks everything that the scene and the command line ask.
pub fn check_motion(args: &CheckArgs, opened: &OpenScene, term: &Term) -> Result<Answer, Failure> {
    let OpenScene { scene, system } = opened;
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    let times = match args.samples {
        Some(count) => even_times(mechanism, actuation, count),
        None if args.scene.table.is_some() => inputs_table::row_times(actuation),
        None => frame_times(mechanism, actuation, scene.view.fps),
    };
    clearance::refuse_without_rules(args, scene)?;
    // Tubes, which clearances are bounded by, join certified poses.
    let needed = match args.certify {
        CertifyArg::None
            if scene.clearance.is_some()
                || args.swept.is_some()
                || measures::needs_certified_poses(scene) =>
        {
            CertifyArg::Pose
        }
        asked => asked,
    };
    let begun = Instant::now();
    let mut trajectory =
        certify::certify_motion(system, actuation, &knot_times(actuation, &times), needed)?;
    let seconds = begun.elapsed().as_secs_f64();
    event_messages::note_moved_start(system, actuation, &mut trajectory)?;
    if let Err(failure) = event_messages::tell_events(system, actuation, &trajectory, term) {
        return Ok(never_closed(mechanism, &trajectory, failure));
    }
    let measured = measures::take_whole(system, scene, &trajectory, &times, args.tolerance);
    let clearances = clearance::check_pairs(args, opened, &trajectory, term)?;
    swept::write(args, opened, &trajectory, term)?;
    let asked = Asked {
        closure: args.closure,
        poses: args.certify != CertifyArg::None,
        motion: args.certify == CertifyArg::Motion,
        estimates: args.allow_estimates || args.certify == CertifyArg::None,
        empty: args.allow_empty,
        band: args.band,
    };
    let found = MotionReport::new(
        (system, actuation),
        &trajectory,
        asked,
        &measured,
        clearances.as_ref(),
    );
    let verdict = found.verdict(seconds);
    Ok(Answer {
        text: found.text(&verdict, args.worst),
        document: args.json.is_some().then(|| found.json(&verdict)),
        verdict,
        failure: None,
    })
}

/// There is no pose at all: `failure` says why and what to do.
fn never_closed(mechanism: &Mechanism, trajectory: &Trajectory, failure: Failure) -> Answer {
    let mut case = closure::closing_case(mechanism, trajectory);
    case.text = format!("{}; {failure}", case.text);
    let verdict = Verdict {
        title: mechanism.title.clone(),
        cases: vec![case],
    };
    Answer {
        text: String::new(),
        document: Some(without_pose(mechanism, trajectory, &verdict)),
        verdict,
        failure: Some(failure),
    }
}
