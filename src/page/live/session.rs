//! A scene on a live page: its text, replaced values, and the resulting motion.

use super::following::{FollowEnd, Follower, NamedPose, by_name, named_pose};
use super::requirements::LiveRequirements;
use super::sliders::typed;
use crate::diag::{SceneError, Source};
use crate::kinematics::results::trajectory::{Sample, Trajectory};
use crate::kinematics::structure::block::StructureError;
use crate::kinematics::structure::system::System;
use crate::limits::LimitExceeded;
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::printed::shortest_decimal;
use crate::scene::edit::with_values;
use crate::scene::{Overrides, Scene, load_scene};
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

/// A scene, what is changed in it, and its motion.
pub struct LiveScene {
    /// Its index on the page.
    pub(super) number: usize,
    pub(super) source: Source,
    pub(super) overrides: Overrides,
    /// Start values that the page was created with; those added by following change.
    own_guess: Vec<(String, String)>,
    pub(super) asked: LiveRequirements,
    pub(super) now: Opened,
    /// A pose set by hand, which replaces the motion.
    pub(super) hand: Option<Sample>,
    follower: Option<Follower>,
    /// The mechanism whose shapes the page has received.
    told: Arc<Mechanism>,
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
        let now = opened_scene(&source, &overrides, &asked)?;
        Ok(Self {
            number,
            own_guess: overrides.guess.clone(),
            source,
            overrides,
            asked,
            told: Arc::clone(&now.scene.mechanism),
            now,
            hand: None,
            follower: None,
        })
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

    /// Whether the bodies' shapes have changed since the last call.
    pub(super) fn is_reshaped(&mut self) -> bool {
        let now = Arc::clone(&self.now.scene.mechanism);
        let told = std::mem::replace(&mut self.told, now);
        let [before, after] = [&told.bodies, &self.told.bodies];
        let mut pairs = before.iter().zip(after);
        before.len() != after.len() || pairs.any(|(a, b)| a.shapes != b.shapes)
    }

    /// The value of a parameter as it is now, in the file's unit.
    fn value(&self, follower: &Follower, name: &str) -> Option<f64> {
        let put = self.overrides.parameters.iter().find(|(n, _)| n == name);
        match put.and_then(|(_, text)| text.parse().ok()) {
            Some(value) => Some(value),
            None => Some(typed(follower.start()? / follower.unit())),
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
        let Some(pose) = self.first_pose() else {
            // Without a pose there is nothing to follow.
            self.take(changed)?;
            return Ok(None);
        };
        let scene = load_scene(&self.source, &changed).map_err(Box::new)?;
        let inputs = [&self.now.scene, &scene].map(|s| s.actuation.inputs_at(0.0));
        let follower = match self.follower.take() {
            Some(known) if known.fits(&self.overrides, name) => known,
            _ => Follower::new(&self.source, &self.overrides, name)
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
        scene: Scene,
        pose: &NamedPose,
        (from, name): (f64, &str),
    ) -> Result<Option<FollowEnd>, LiveError> {
        let mut now = solved_scene(scene, &self.asked)?;
        if !begins_at(&now, pose) {
            changed.guess = guess_text(&now.scene.mechanism, pose);
            now = opened_scene(&self.source, &changed, &self.asked)?;
        }
        if !begins_at(&now, pose) {
            let why = format!(
                "{name}: the pose that was followed is not found again from its own values"
            );
            return Ok(Some(FollowEnd::Stopped { at: from, why }));
        }
        (self.overrides, self.now, self.hand) = (changed, now, None);
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
        self.now = opened_scene(&self.source, &changed, &self.asked)?;
        (self.overrides, self.hand) = (changed, None);
        Ok(())
    }

    fn first_pose(&self) -> Option<NamedPose> {
        let first = self.now.motion.samples.first()?;
        let pose = first.pose.as_ref().filter(|_| first.time == 0.0)?;
        Some(named_pose(self.mechanism(), pose))
    }

    /// The text with the present values; `None` if the text is written in a form that cannot be edited.
    pub fn text(&self) -> Option<String> {
        let Overrides {
            parameters, guess, ..
        } = &self.overrides;
        match parameters.is_empty() && guess.is_empty() {
            true => Some(self.source.text.clone()),
            false => with_values(&self.source, parameters, guess),
        }
    }
}

/// Reads a scene with changed values and solves it as it is judged.
fn opened_scene(
    source: &Source,
    overrides: &Overrides,
    asked: &LiveRequirements,
) -> Result<Opened, LiveError> {
    solved_scene(load_scene(source, overrides).map_err(Box::new)?, asked)
}

fn solved_scene(scene: Scene, asked: &LiveRequirements) -> Result<Opened, LiveError> {
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation)?;
    let times = asked.times(&scene);
    let (motion, _) = asked.check(&scene, &system, &times).solve(&|| false)?;
    Ok(Opened {
        scene,
        system,
        motion,
    })
}

/// Whether a motion begins at a pose, compared by the scene's unknowns.
fn begins_at(now: &Opened, pose: &NamedPose) -> bool {
    let mechanism = &now.scene.mechanism;
    let wanted = by_name(mechanism, pose);
    let first = now.motion.samples.first().filter(|s| s.time == 0.0);
    let Some(found) = first.and_then(|s| s.pose.as_ref()) else {
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
fn guess_text(mechanism: &Mechanism, pose: &NamedPose) -> Vec<(String, String)> {
    let values = by_name(mechanism, pose);
    let unknowns = mechanism.unknowns.iter().zip(values);
    unknowns
        .map(|(unknown, value)| {
            let value = value * mechanism.file_units(unknown.kind);
            (unknown.name.clone(), shortest_decimal(value))
        })
        .collect()
}
