//! The complete check of a scene.

use super::error::Error;
use super::loaded::Loaded;
use super::motion::Samples;
use crate::clearance::check::{ClearanceReport, Closely, PairReport};
use crate::jobs::Stopwatch;
use crate::report::clearance;
use crate::report::junit::to_junit;
use crate::report::motion_check::{MotionAnswer, MotionCheck};
use crate::report::verdict::{Asked, Judged, Status, Verdict};

/// Options of a check, in addition to the requirements of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckOptions {
    /// Times at which the motion is sampled; the verdict on clearances covers all times in between.
    pub samples: Samples,
    /// Largest permitted closure error, relative to the mechanism's size.
    pub closure: f64,
    /// Whether the motion between the samples must be proved as well.
    pub motion: bool,
    /// Required agreement of the proved bound with the distance found, as a fraction of the pair's minimum.
    pub tolerance: f64,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self {
            samples: Samples::Frames,
            closure: Asked::CLOSURE,
            motion: false,
            tolerance: Closely::TOLERANCE,
        }
    }
}

/// The smallest distance of two bodies over the whole motion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PairClearance {
    /// Names of the bodies.
    pub bodies: [String; 2],
    /// Smallest permitted distance.
    pub minimum: f64,
    /// Smallest distance found, in the scene's length unit; negative if the bodies penetrate each other.
    pub distance: f64,
    /// Time of this distance in seconds.
    pub time: f64,
    /// Lower bound of the distance over the whole motion; proved if `is_proved`.
    pub bound: f64,
    /// Whether the bound is proved for the whole motion.
    pub is_proved: bool,
    /// Whether it is proved that the pair keeps its minimum.
    pub passed: bool,
}

/// The result of a check.
pub struct Check {
    text: String,
    json: String,
    verdict: Verdict,
    seconds: f64,
    pairs: Vec<PairClearance>,
}

impl Check {
    pub(super) fn run(loaded: &Loaded, options: &CheckOptions) -> Result<Self, Error> {
        let [times, _] = options.samples.times(loaded)?;
        let check = MotionCheck {
            scene: &loaded.scene,
            system: &loaded.system,
            times: &times,
            asked: Asked {
                closure: options.closure,
                poses: true,
                motion: options.motion,
                estimates: false,
                empty: false,
                band: None,
            },
            // All pairs are handed out, one by one.
            closely: Closely {
                tolerance: options.tolerance,
                pairs: usize::MAX,
                times: true,
            },
            is_swept: false,
            worst: usize::MAX,
        };
        let begun = Stopwatch::start();
        let trajectory = check.solve(&|| false)?;
        let solving = begun.seconds();
        let (answer, pairs) = if trajectory.poses().next().is_none() {
            (check.without_pose(&trajectory, None), Vec::new())
        } else {
            let mut covered = check.cover(&trajectory);
            let found = check.clearances(&mut covered, &|_, _| {})?;
            let answer = check.answer(&trajectory, &mut covered, found.as_ref(), solving);
            (
                answer,
                found.map_or_else(Vec::new, |found| pairs(loaded, &found)),
            )
        };
        let MotionAnswer {
            text,
            document,
            verdict,
            ..
        } = answer;
        Ok(Self {
            text,
            json: format!("{document:#}\n"),
            seconds: begun.seconds(),
            verdict,
            pairs,
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
        matches!(self.verdict.result(), Status::Passed | Status::Skipped)
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
        &self.text
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
        to_junit(&[Judged {
            source: &self.verdict.title,
            verdict: &self.verdict,
            seconds: self.seconds,
        }])
    }
}

fn pairs(loaded: &Loaded, found: &ClearanceReport) -> Vec<PairClearance> {
    let mechanism = &loaded.scene.mechanism;
    let pair = |p: &PairReport| PairClearance {
        bodies: clearance::body_names(mechanism, p).map(str::to_owned),
        minimum: p.minimum,
        distance: p.least.distance,
        time: p.least.time,
        bound: p.least.bound,
        is_proved: p.least.is_certified,
        passed: p.judgement.is_kept() && p.least.is_certified,
    };
    found.judged.iter().map(pair).collect()
}
