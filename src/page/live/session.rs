//! A scene on a live page: its text, replaced values, and the resulting motion.

use super::following::{FollowEnd, Follower, NamedPose, by_name, motion_until, named_values};
use super::requirements::LiveRequirements;
use crate::clearance::check::ClearanceReport;
use crate::diag::{SceneError, Source};
use crate::kinematics::results::trajectory::{ClosedPose, Sample, Trajectory};
use crate::kinematics::structure::block::StructureError;
use crate::kinematics::structure::system::System;
use crate::limits::LimitExceeded;
use crate::model::mechanism::{Body, Kind, Mechanism};
use crate::model::printed::{as_typed, shortest_decimal};
use crate::scene::edit::with_values;
use crate::scene::text::SceneText;
use crate::scene::{Overrides, Scene};
use crate::staging::model::extent_of_motion;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Two first poses are equal if no unknown differs by more than this: radians, or fractions of the mechanism's size.
const SAME_POSE: f64 = 1e-6;

/// Why a scene cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// It has mistakes.
    #[error(transparent)]
    Scene(#[from] Box<SceneError>),
    /// Its mechanism is ill-posed.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// It is too large.
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
    /// A missing item, with an explanation.
    #[error("{0}")]
    Request(String),
}

/// A scene as it is solved at present.
pub(super) struct Opened {
    pub scene: Scene,
    pub system: System,
    pub motion: Trajectory,
}

/// A motion that was also looked at between its samples, and its clearances.
pub(super) struct JudgedMotion {
    pub motion: Trajectory,
    pub clearances: Option<ClearanceReport>,
}

impl Opened {
    /// The pose with which the motion begins.
    pub fn first_pose(&self) -> Option<&ClosedPose> {
        first_pose(&self.motion)
    }
}

/// The pose with which a motion begins.
fn first_pose(motion: &Trajectory) -> Option<&ClosedPose> {
    let first = motion.samples.first()?;
    first.pose.as_ref().filter(|_| first.time == 0.0)
}

/// A scene, what is changed in it, and its motion.
pub struct LiveScene {
    /// Its index on the page.
    pub(super) number: usize,
    pub(super) text: SceneText,
    pub(super) overrides: Overrides,
    /// Start values that the page was created with; those added by following change.
    own_guess: Vec<(String, String)>,
    pub(super) asked: LiveRequirements,
    pub(super) now: Opened,
    /// The same motion as it is judged, and its clearances, once they were asked for.
    pub(super) judged: Option<JudgedMotion>,
    /// A pose set by hand, which replaces the motion.
    pub(super) hand: Option<Sample>,
    follower: Option<Follower>,
    /// The mechanism whose shapes the page has received.
    told: Arc<Mechanism>,
    /// The extent that its meshes were made for.
    pub(super) extent: f64,
}

impl LiveScene {
    /// Reads a scene and solves its motion.
    ///
    /// Errors: mistakes; a mechanism that is not determined.
    pub fn open(
        number: usize,
        source: Source,
        overrides: Overrides,
        asked: LiveRequirements,
    ) -> Result<Self, LiveError> {
        let text = SceneText::read(source);
        let now = opened_scene(&text, &overrides, &asked)?;
        Ok(Self {
            number,
            own_guess: overrides.guess.clone(),
            text,
            overrides,
            asked,
            told: Arc::clone(&now.scene.mechanism),
            extent: extent_of_motion(&now.scene, &now.motion),
            now,
            judged: None,
            hand: None,
            follower: None,
        })
    }

    /// The text and its name.
    pub(super) fn source(&self) -> &Source {
        self.text.source()
    }

    pub(super) fn mechanism(&self) -> &Mechanism {
        &self.now.scene.mechanism
    }

    /// The pose held by hand as a motion of one sample.
    pub(super) fn held(&self) -> Option<Trajectory> {
        let sample = self.hand.clone()?;
        Some(Trajectory {
            samples: vec![sample],
            ..Trajectory::default()
        })
    }

    /// The bodies whose shapes have changed since the last call.
    pub(super) fn reshaped(&mut self) -> Vec<usize> {
        let now = Arc::clone(&self.now.scene.mechanism);
        let told = std::mem::replace(&mut self.told, now);
        let bodies = self.told.bodies.iter().enumerate();
        let is_new = |index: usize, body: &Body| {
            let known = told.bodies.get(index);
            known.is_none_or(|known| known.shapes != body.shapes)
        };
        bodies
            .filter(|(index, body)| is_new(*index, body))
            .map(|(index, _)| index)
            .collect()
    }

    /// The value of a parameter as it is now, in the file's unit.
    fn value(&self, follower: &Follower, name: &str) -> Option<f64> {
        let put = self.overrides.parameters.iter().find(|(n, _)| n == name);
        match put.and_then(|(_, text)| text.parse().ok()) {
            Some(value) => Some(value),
            None => Some(as_typed(follower.start()? / follower.unit())),
        }
    }

    /// Follows the mechanism to another value of a parameter. If the motion ends before, everything stays as it is, and
    /// the place is returned.
    ///
    /// Errors: a text that is not a number; values that the scene does not allow.
    pub fn move_to(&mut self, name: &str, text: &str) -> Result<Option<FollowEnd>, LiveError> {
        let is_number = |v: &f64| v.is_finite();
        let wanted = text.trim().parse().ok().filter(is_number);
        let wanted: f64 =
            wanted.ok_or_else(|| LiveError::Request(format!("`{text}` is not a number")))?;
        let mut changed = self.overrides.clone();
        changed.parameters.retain(|(other, _)| other != name);
        changed
            .parameters
            .push((name.to_owned(), text.trim().to_owned()));
        changed.guess = self.own_guess.clone();
        let first = self.now.first_pose();
        let Some(pose) = first.map(|pose| named_values(self.mechanism(), &pose.unknowns)) else {
            // Without a pose there is nothing to follow.
            self.take(changed)?;
            return Ok(None);
        };
        let scene = self.text.resolved(&changed).map_err(Box::new)?;
        let inputs = [&self.now.scene, &scene].map(|s| s.actuation.inputs_at(0.0));
        let follower = match self.follower.take() {
            Some(known) if known.fits(&self.overrides, name) => known,
            _ => Follower::new(self.source(), &self.overrides, name)
                .map_err(|error| LiveError::Request(error.to_string()))?,
        };
        let from = self.value(&follower, name).unwrap_or(wanted);
        let way = follower.way((&inputs[0], &pose), [from, wanted], &inputs[1]);
        self.follower = Some(follower);
        match way {
            FollowEnd::Reached(pose) => self.take_at(changed, scene, &pose, (from, name)),
            stopped => Ok(Some(stopped)),
        }
    }

    /// Adopts values with which the motion begins at `pose`: from the scene's own start values if they lead there,
    /// otherwise from those of the pose.
    fn take_at(
        &mut self,
        mut changed: Overrides,
        mut scene: Scene,
        pose: &NamedPose,
        (from, name): (f64, &str),
    ) -> Result<Option<FollowEnd>, LiveError> {
        let mut system = System::new(Arc::clone(&scene.mechanism), &scene.actuation)?;
        let start = motion_until(&system, &scene.actuation, &[0.0]);
        if !begins_at(&scene.mechanism, &start, pose) {
            changed.guess = guess_text(&scene.mechanism, pose);
            scene = self.text.resolved(&changed).map_err(Box::new)?;
            system = System::new(Arc::clone(&scene.mechanism), &scene.actuation)?;
        }
        let now = solved_scene(scene, system, &self.asked)?;
        if !begins_at(&now.scene.mechanism, &now.motion, pose) {
            let why = format!(
                "{name}: the pose that was followed is not found again from its own values"
            );
            return Ok(Some(FollowEnd::Stopped { at: from, why }));
        }
        self.adopt(changed, now);
        Ok(None)
    }

    /// Assembles the mechanism from the scene's own start values, with the present parameters or with one more changed.
    ///
    /// Errors: values that the scene does not allow.
    pub fn assemble(&mut self, change: Option<(&str, &str)>) -> Result<(), LiveError> {
        let mut changed = self.overrides.clone();
        changed.guess = self.own_guess.clone();
        if let Some((name, text)) = change {
            changed.parameters.retain(|(other, _)| other != name);
            changed.parameters.push((name.to_owned(), text.to_owned()));
        }
        self.take(changed)
    }

    fn take(&mut self, changed: Overrides) -> Result<(), LiveError> {
        let now = opened_scene(&self.text, &changed, &self.asked)?;
        self.adopt(changed, now);
        Ok(())
    }

    /// Shows another motion, which belongs to these values.
    pub(super) fn adopt(&mut self, changed: Overrides, now: Opened) {
        (self.overrides, self.now) = (changed, now);
        (self.judged, self.hand) = (None, None);
    }

    /// The text with the present values; `None` if the text is written in a form that cannot be edited.
    pub fn text(&self) -> Option<String> {
        let Overrides {
            parameters, guess, ..
        } = &self.overrides;
        match parameters.is_empty() && guess.is_empty() {
            true => Some(self.source().text.clone()),
            false => with_values(self.source(), parameters, guess).ok(),
        }
    }
}

/// Resolves a scene with changed values and solves its motion.
pub(super) fn opened_scene(
    text: &SceneText,
    overrides: &Overrides,
    asked: &LiveRequirements,
) -> Result<Opened, LiveError> {
    let scene = text.resolved(overrides).map_err(Box::new)?;
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation)?;
    solved_scene(scene, system, asked)
}

/// The motion at its samples; the check of a settled page also looks between them.
fn solved_scene(
    scene: Scene,
    system: System,
    asked: &LiveRequirements,
) -> Result<Opened, LiveError> {
    let times = asked.times(&scene);
    let motion = asked.check(&scene, &system, &times).sampled()?;
    Ok(Opened {
        scene,
        system,
        motion,
    })
}

/// Whether a motion begins at a pose, compared by the scene's unknowns.
fn begins_at(mechanism: &Mechanism, motion: &Trajectory, pose: &NamedPose) -> bool {
    let wanted = by_name(mechanism, pose);
    let Some(found) = first_pose(motion) else {
        return false;
    };
    let pairs = found.unknowns.iter().zip(&wanted).zip(&mechanism.unknowns);
    pairs.into_iter().all(|((found, wanted), unknown)| {
        let off = found - wanted;
        match unknown.kind {
            Kind::Angle => turn_between(off) < SAME_POSE,
            Kind::Length => off.abs() < SAME_POSE * mechanism.size,
            Kind::Number => off.abs() < SAME_POSE * wanted.abs().max(1.0),
        }
    })
}

/// The magnitude of an angle without whole turns.
fn turn_between(angle: f64) -> f64 {
    let turn = angle.rem_euclid(TAU);
    turn.min(TAU - turn)
}

/// A pose as start values of the file.
pub(super) fn guess_text(mechanism: &Mechanism, pose: &NamedPose) -> Vec<(String, String)> {
    let values = by_name(mechanism, pose);
    let unknowns = mechanism.unknowns.iter().zip(values);
    unknowns
        .map(|(unknown, value)| {
            let value = value * mechanism.file_units(unknown.kind);
            (unknown.name.clone(), shortest_decimal(value))
        })
        .collect()
}
