//! The complete check of a scene.

use super::error::Error;
use super::loaded::Loaded;
use super::motion::Samples;
use crate::clearance::check::{ClearanceEffort, ClearanceReport, PairReport};
use crate::jobs::Stopwatch;
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::asked_ranges::{AGREEMENT, POSITIVE};
use crate::page::{CheckedMotion, article_of, page_text};
use crate::report::clearance;
use crate::report::junit::to_junit;
use crate::report::motion_check::{MotionAnswer, MotionCheck};
use crate::report::verdict::{CheckRequirements, SceneVerdict, Status};
use std::sync::Arc;

/// Options of a check, in addition to the requirements of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckOptions {
    /// Times at which the motion is sampled; the verdict on clearances covers all times in between.
    pub samples: Samples,
    /// Largest permitted closure error, relative to the mechanism's size; positive.
    pub closure: f64,
    /// Whether the motion between the samples must be proved as well.
    pub motion: bool,
    /// Required agreement of the proved bound with the distance found, as a fraction of the pair's minimum; between 1e-9 and 1.
    pub tolerance: f64,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self {
            samples: Samples::Frames,
            closure: CheckRequirements::CLOSURE,
            motion: false,
            tolerance: ClearanceEffort::TOLERANCE,
        }
    }
}

/// The smallest distance of two bodies over the whole motion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PairClearance {
    /// Names of the bodies.
    pub bodies: [String; 2],
    /// Smallest permitted distance, in the scene's length unit.
    pub minimum: f64,
    /// Smallest distance found, in the scene's length unit; negative if the bodies penetrate each other.
    pub distance: f64,
    /// Time of this distance in seconds.
    pub time: f64,
    /// Lower bound of the distance over the whole motion in the same unit, proved if `is_proved`; negative infinity if nothing is known, or if the
    /// bodies penetrate each other.
    pub bound: f64,
    /// Whether the bound is proved for the whole motion.
    pub is_proved: bool,
    /// Of bodies that must touch: the largest distance found; nothing of other pairs.
    pub apart: Option<f64>,
    /// Whether it is proved that the pair keeps its minimum, or touches all the time if it must.
    pub passed: bool,
}

/// The result of a check.
pub struct Check {
    loaded: Arc<Loaded>,
    trajectory: Trajectory,
    clearances: Option<ClearanceReport>,
    answer: MotionAnswer,
    json: String,
    seconds: f64,
    pairs: Vec<PairClearance>,
}

impl Check {
    pub(super) fn run(loaded: Arc<Loaded>, options: &CheckOptions) -> Result<Self, Error> {
        Error::unless_in(&POSITIVE, "closure", options.closure)?;
        Error::unless_in(&AGREEMENT, "tolerance", options.tolerance)?;
        let [times, _] = options.samples.times(&loaded)?;
        let check = asked_check(&loaded, options, &times);
        let begun = Stopwatch::start();
        let (trajectory, proved) = check.solve(&|| false)?;
        let solving = begun.seconds();
        let (answer, clearances) = if trajectory.poses().next().is_none() {
            (check.without_pose(&trajectory, None), None)
        } else {
            let mut covered = check.cover(&trajectory, proved);
            let found = check.clearances(&mut covered, &|_, _| {})?;
            let answer = check.answer(&trajectory, &mut covered, found.as_ref(), solving);
            (answer, found)
        };
        let pairs = clearances.as_ref().map(|found| pairs(&loaded, found));
        Ok(Self {
            json: format!("{:#}\n", answer.document),
            seconds: begun.seconds(),
            pairs: pairs.unwrap_or_default(),
            loaded,
            trajectory,
            clearances,
            answer,
        })
    }

    /// Whether all requirements are met, and proved if they need a proof.
    ///
    /// ```
    /// let check = mechanim::Scene::builtin("gearshift")?.check(&Default::default())?;
    /// assert!(check.passed());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn passed(&self) -> bool {
        matches!(
            self.answer.verdict.result(),
            Status::Passed | Status::Skipped
        )
    }

    /// The pairs of bodies that were judged, the worst first.
    ///
    /// ```
    /// let check = mechanim::Scene::builtin("gearshift")?.check(&Default::default())?;
    /// assert!(check.pairs().iter().all(|pair| pair.passed && pair.bound <= pair.distance));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn pairs(&self) -> &[PairClearance] {
        &self.pairs
    }

    /// The report that `mechanim check` prints.
    ///
    /// ```
    /// let check = mechanim::Scene::builtin("four-bar")?.check(&Default::default())?;
    /// assert!(check.text().contains("passed"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn text(&self) -> &str {
        &self.answer.text
    }

    /// The same as a JSON document.
    ///
    /// ```
    /// let check = mechanim::Scene::builtin("four-bar")?.check(&Default::default())?;
    /// assert!(check.to_json().contains("mechanim-check/1"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn to_json(&self) -> &str {
        &self.json
    }

    /// The verdict as JUnit XML, with one case per requirement.
    ///
    /// ```
    /// let check = mechanim::Scene::builtin("four-bar")?.check(&Default::default())?;
    /// assert!(check.to_junit().contains("<testsuite"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn to_junit(&self) -> String {
        to_junit(&[SceneVerdict {
            source: &self.answer.verdict.title,
            verdict: &self.answer.verdict,
            seconds: self.seconds,
        }])
    }

    /// The page that `mechanim report` writes: a self-contained HTML text with the motion in three dimensions, curves,
    /// clearances and proofs.
    ///
    /// Errors: the picture of the mechanism cannot be drawn.
    ///
    /// ```
    /// let check = mechanim::Scene::builtin("four-bar")?.check(&Default::default())?;
    /// assert!(check.to_html()?.starts_with("<!DOCTYPE html>"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn to_html(&self) -> Result<String, Error> {
        let article = article_of(
            &CheckedMotion {
                source: &self.loaded.text.name,
                scene: &self.loaded.scene,
                system: &self.loaded.system,
                trajectory: &self.trajectory,
                clearances: self.clearances.as_ref(),
                answer: &self.answer,
            },
            1,
        )?;
        Ok(page_text("", &[article], None))
    }
}

/// The requirements of a check. All pairs are examined one by one.
fn asked_check<'a>(
    loaded: &'a Loaded,
    options: &CheckOptions,
    times: &'a [f64],
) -> MotionCheck<'a> {
    MotionCheck {
        scene: &loaded.scene,
        system: &loaded.system,
        times,
        asked: CheckRequirements {
            closure: options.closure,
            poses: true,
            motion: options.motion,
            estimates: false,
            empty: false,
            band: None,
        },
        closely: ClearanceEffort {
            tolerance: options.tolerance,
            pairs: usize::MAX,
            times: true,
        },
        is_swept: false,
        worst: usize::MAX,
    }
}

fn pairs(loaded: &Loaded, found: &ClearanceReport) -> Vec<PairClearance> {
    let mechanism = &loaded.scene.mechanism;
    let pair = |p: &PairReport| PairClearance {
        bodies: clearance::body_names(mechanism, p).map(str::to_owned),
        minimum: p.minimum,
        distance: p.least.distance,
        time: p.least.time,
        bound: p.known_bound().unwrap_or(f64::NEG_INFINITY),
        is_proved: p.least.is_certified,
        apart: p.touching.as_ref().map(|t| t.apart.distance),
        passed: p.judgement.is_kept() && p.least.is_certified,
    };
    found.judged.iter().map(pair).collect()
}
