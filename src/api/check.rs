//! Everything that a scene asks for, answered at once.

use super::error::Error;
use super::loaded::Loaded;
use super::motion::Samples;
use crate::clearance::check::{ClearanceReport, Closely, PairReport};
use crate::jobs::Stopwatch;
use crate::report::clearance;
use crate::report::junit::to_junit;
use crate::report::motion_check::{MotionAnswer, MotionCheck};
use crate::report::verdict::{Asked, Judged, Status, Verdict};

/// What is asked of a check beside what the scene asks.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckOptions {
    /// At which times the motion is sampled; the verdict on clearances covers all times between them.
    pub samples: Samples,
    /// Largest closure error that passes, relative to the mechanism's size.
    pub closure: f64,
    /// Whether the motion between the samples must be proved, too.
    pub motion: bool,
    /// How near the proved bound of a distance must come to the distance found, as a part of the pair's minimum.
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

/// How near two bodies come over the whole motion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PairClearance {
    /// Names of the bodies.
    pub bodies: [String; 2],
    /// Least distance that passes.
    pub minimum: f64,
    /// Least distance found, in the scene's length unit; negative if they are in each other.
    pub distance: f64,
    /// When that is, in seconds.
    pub time: f64,
    /// They never come nearer than this, where `is_proved`; negative infinity where nothing is known, or they are in each other.
    pub bound: f64,
    /// The bound is proved for the whole motion.
    pub is_proved: bool,
    /// The pair keeps its minimum, proved.
    pub passed: bool,
}

/// The answers to a check.
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

    /// Whether everything that was asked is so, and proved where a proof belongs to it.
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

    /// The verdict as JUnit XML, one case for everything that was asked.
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
        bound: p.known_bound().unwrap_or(f64::NEG_INFINITY),
        is_proved: p.least.is_certified,
        passed: p.judgement.is_kept() && p.least.is_certified,
    };
    found.judged.iter().map(pair).collect()
}
