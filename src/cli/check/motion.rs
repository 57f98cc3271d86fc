//! The check of a whole motion.

use super::answer::CheckAnswer;
use super::{clearance, pieces, swept};
use crate::clearance::check::ClearanceEffort;
use crate::cli::args::motion::{CertifyArg, CheckArgs, RequirementArgs};
use crate::cli::args::scene::SceneArgs;
use crate::cli::interrupt::{is_interrupted, refuse_interrupted};
use crate::cli::motion::event_messages;
use crate::cli::open::inputs_table;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::kinematics::motion::sampling::{even_times, frame_times};
use crate::report::motion_check::MotionCheck;
use crate::report::verdict::CheckRequirements;
use crate::scene::Scene;
use std::time::Instant;

/// Solves the motion and checks all requirements of the scene and the command line.
pub fn check_motion(
    args: &CheckArgs,
    opened: &OpenScene,
    own: &[(String, f64)],
    term: &Term,
) -> Result<CheckAnswer, Failure> {
    let OpenScene { scene, system, .. } = opened;
    let actuation = &scene.actuation;
    clearance::refuse_without_rules(args, own, scene)?;
    let times = asked_times(&args.asked, &args.scene, scene);
    let mut check = motion_check(&args.asked, opened, &times, args.swept.is_some());
    let with_pieces = args.made_within.is_some() || !own.is_empty();
    if with_pieces {
        // Pairs that are far apart as drawn are examined as well.
        check.closely.pairs = usize::MAX;
    }
    let begun = Instant::now();
    let (mut trajectory, proved) = check.solve(&is_interrupted)?;
    refuse_interrupted()?;
    let seconds = begun.elapsed().as_secs_f64();
    event_messages::note_moved_start(system, actuation, &mut trajectory)?;
    if let Err(failure) = event_messages::tell_events(system, actuation, &trajectory, term) {
        let answer = check.without_pose(&trajectory, Some(&failure.to_string()));
        return Ok(CheckAnswer {
            text: String::new(),
            document: Some(answer.document),
            verdict: answer.verdict,
            failure: Some(failure),
        });
    }
    let mut covered = check.cover(&trajectory, proved);
    if with_pieces {
        // Half of the time is for the motion as drawn, half for the pieces.
        covered.proved().share_time(2);
    }
    let mut clearances =
        clearance::check_pairs(args, opened, &check, (&trajectory, &mut covered), term)?;
    if let Some(found) = clearances.as_mut().filter(|_| with_pieces) {
        found.pieces = Some(pieces::all_pieces(args, own, opened, &times, &found.parts)?);
    }
    swept::write(args, opened, &mut covered, term)?;
    let answer = check.answer(&trajectory, &mut covered, clearances.as_ref(), seconds);
    Ok(CheckAnswer {
        text: answer.text,
        document: args.json.is_some().then_some(answer.document),
        verdict: answer.verdict,
        failure: None,
    })
}

/// Seconds at which a motion is examined: as many as requested, the rows of a table, or the scene's frames.
pub fn asked_times(asked: &RequirementArgs, args: &SceneArgs, scene: &Scene) -> Vec<f64> {
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    match asked.samples {
        Some(count) => even_times(mechanism, actuation, count),
        None if args.table.is_some() => inputs_table::row_times(actuation),
        None => frame_times(mechanism, actuation, scene.view.fps),
    }
}

/// The check requested from any verb that examines a motion.
pub fn motion_check<'a>(
    asked: &RequirementArgs,
    opened: &'a OpenScene,
    times: &'a [f64],
    is_swept: bool,
) -> MotionCheck<'a> {
    MotionCheck {
        scene: &opened.scene,
        system: &opened.system,
        times,
        asked: asked_questions(asked),
        closely: nearness(asked),
        is_swept,
        worst: asked.worst,
    }
}

/// The requirements of the command line.
pub fn asked_questions(asked: &RequirementArgs) -> CheckRequirements {
    CheckRequirements {
        closure: asked.closure,
        poses: asked.certify != CertifyArg::None,
        motion: asked.certify == CertifyArg::Motion,
        estimates: asked.allow_estimates || asked.certify == CertifyArg::None,
        empty: asked.allow_empty,
        band: asked.band,
    }
}

/// Requested accuracy of the bounds of distances.
pub fn nearness(asked: &RequirementArgs) -> ClearanceEffort {
    ClearanceEffort {
        tolerance: asked.tolerance,
        pairs: asked.worst.max(ClearanceEffort::PAIRS),
        times: true,
    }
}
