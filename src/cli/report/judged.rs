//! A scene checked as `check` does, with everything that a page shows of it.

use crate::clearance::check::ClearanceReport;
use crate::cli::args::motion::RequirementArgs;
use crate::cli::args::scene::SceneArgs;
use crate::cli::check::motion::{asked_times, motion_check};
use crate::cli::interrupt::{is_interrupted, refuse_interrupted};
use crate::cli::motion::event_messages;
use crate::cli::open::scene::{OpenScene, open_scene};
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::block::StructureError;
use crate::page::CheckedMotion;
use crate::report::closure;
use crate::report::motion_check::MotionAnswer;
use crate::report::verdict::Verdict;
use std::time::Instant;

/// A scene with the results of its check.
pub struct JudgedScene {
    /// The origin of the scene.
    pub source: String,
    /// The results where there is no motion.
    unmoved: Option<Verdict>,
    motion: Option<JudgedMotion>,
    /// The exit code of `check`.
    pub end: Result<Outcome, Failure>,
}

struct JudgedMotion {
    opened: OpenScene,
    trajectory: Trajectory,
    clearances: Option<ClearanceReport>,
    answer: MotionAnswer,
}

impl JudgedScene {
    /// The motion with its results, if there is one.
    pub fn checked(&self) -> Option<CheckedMotion<'_>> {
        let motion = self.motion.as_ref()?;
        Some(CheckedMotion {
            source: &self.source,
            scene: &motion.opened.scene,
            system: &motion.opened.system,
            trajectory: &motion.trajectory,
            clearances: motion.clearances.as_ref(),
            answer: &motion.answer,
        })
    }

    /// The results of the check.
    pub fn verdict(&self) -> &Verdict {
        const NONE: &Verdict = &Verdict {
            title: String::new(),
            cases: Vec::new(),
        };
        let of_motion = self.motion.as_ref().map(|motion| &motion.answer.verdict);
        self.unmoved.as_ref().or(of_motion).unwrap_or(NONE)
    }
}

/// Checks a scene.
///
/// Errors: a scene that cannot be read, Ctrl-C; a scene that does not close is a result.
pub fn judge(
    asked: &RequirementArgs,
    scene: &SceneArgs,
    term: &Term,
) -> Result<JudgedScene, Failure> {
    let source = scene.scene.to_string_lossy().into_owned();
    let unmoved = |source: String, verdict: Verdict, failure: Failure| JudgedScene {
        source,
        unmoved: Some(verdict),
        motion: None,
        end: Err(failure),
    };
    let opened = match open_scene(scene, term) {
        Err(failure @ Failure::Structure(StructureError::Impossible { .. })) => {
            let verdict = Verdict {
                title: source.clone(),
                cases: vec![closure::unclosed_case(&failure.to_string())],
            };
            return Ok(unmoved(source, verdict, failure));
        }
        opened => opened?,
    };
    let OpenScene {
        scene: read,
        system,
        ..
    } = &opened;
    let times = asked_times(asked, scene, read);
    let check = motion_check(asked, &opened, &times, false);
    let begun = Instant::now();
    let (mut trajectory, proved) = check.solve(&is_interrupted)?;
    refuse_interrupted()?;
    let seconds = begun.elapsed().as_secs_f64();
    event_messages::note_moved_start(system, &read.actuation, &mut trajectory)?;
    if let Err(failure) = event_messages::tell_events(system, &read.actuation, &trajectory, term) {
        let answer = check.without_pose(&trajectory, Some(&failure.to_string()));
        return Ok(unmoved(source, answer.verdict, failure));
    }
    let mut covered = check.cover(&trajectory, proved);
    let clearances = check.clearances(&mut covered, &|_, _| {})?;
    let answer = check.answer(&trajectory, &mut covered, clearances.as_ref(), seconds);
    let end = Ok(answer.verdict.result().into());
    Ok(JudgedScene {
        source,
        unmoved: None,
        end,
        motion: Some(JudgedMotion {
            opened,
            trajectory,
            clearances,
            answer,
        }),
    })
}
