//! The check of a whole motion.

use super::answer::Answer;
use super::{clearance, swept};
use crate::clearance::check::Closely;
use crate::cli::args::motion::{CertifyArg, CheckArgs};
use crate::cli::interrupt::{is_interrupted, refuse_interrupted};
use crate::cli::motion::event_messages;
use crate::cli::open::inputs_table;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::kinematics::motion::sampling::{even_times, frame_times};
use crate::report::motion_check::MotionCheck;
use crate::report::verdict::Asked;
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
    let check = MotionCheck {
        scene,
        system,
        times: &times,
        asked: Asked {
            closure: args.closure,
            poses: args.certify != CertifyArg::None,
            motion: args.certify == CertifyArg::Motion,
            estimates: args.allow_estimates || args.certify == CertifyArg::None,
            empty: args.allow_empty,
            band: args.band,
        },
        closely: Closely {
            tolerance: args.tolerance,
            pairs: args.worst.max(Closely::PAIRS),
            times: true,
        },
        is_swept: args.swept.is_some(),
        worst: args.worst,
    };
    let begun = Instant::now();
    let mut trajectory = check.solve(&is_interrupted)?;
    refuse_interrupted()?;
    let seconds = begun.elapsed().as_secs_f64();
    event_messages::note_moved_start(system, actuation, &mut trajectory)?;
    if let Err(failure) = event_messages::tell_events(system, actuation, &trajectory, term) {
        let answer = check.without_pose(&trajectory, Some(&failure.to_string()));
        return Ok(Answer {
            text: String::new(),
            document: Some(answer.document),
            verdict: answer.verdict,
            failure: Some(failure),
        });
    }
    let mut covered = check.cover(&trajectory);
    let clearances =
        clearance::check_pairs(args, opened, &check, (&trajectory, &mut covered), term)?;
    swept::write(args, opened, &mut covered, term)?;
    let answer = check.answer(&trajectory, &mut covered, clearances.as_ref(), seconds);
    Ok(Answer {
        text: answer.text,
        document: args.json.is_some().then_some(answer.document),
        verdict: answer.verdict,
        failure: None,
    })
}
