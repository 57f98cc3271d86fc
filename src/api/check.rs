//! Everything that a scene asks for, answered at once.

use super::error::Error;
use super::loaded::Loaded;
use super::motion::Samples;
use crate::clearance::check::{ClearanceReport, Closely, PairReport, check_clearance};
use crate::kinematics::motion::proved::{Proofs, solve_proved};
use crate::kinematics::motion::sampling::knot_times;
use crate::report::check::{MotionReport, without_pose};
use crate::report::junit::to_junit;
use crate::report::verdict::{Asked, Status, Verdict};
use crate::report::{clearance, closure, measures};
use std::time::Instant;

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
            closure: 1e-9,
            motion: false,
            tolerance: 1e-3,
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
    /// They never come nearer than this, where `is_proved`.
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
        let (scene, system) = (&loaded.scene, &loaded.system);
        let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
        let [times, _] = options.samples.times(loaded)?;
        let proofs = match options.motion {
            true => Proofs::Motion,
            false => Proofs::Poses,
        };
        let begun = Instant::now();
        let never = || false;
        let all = knot_times(actuation, &times);
        let trajectory = solve_proved(system, actuation, &all, proofs, &never);
        let solving = begun.elapsed().as_secs_f64();
        if trajectory.poses().next().is_none() {
            let verdict = Verdict {
                title: mechanism.title.clone(),
                cases: vec![closure::closing_case(mechanism, &trajectory)],
            };
            let json = without_pose(mechanism, &trajectory, &verdict);
            return Ok(Self {
                text: format!("{}\n  result: {}\n", mechanism.title, verdict.sentence()),
                json: format!("{json:#}\n"),
                verdict,
                seconds: solving,
                pairs: Vec::new(),
            });
        }
        let tolerance = options.tolerance;
        let measured = measures::take_whole(system, scene, &trajectory, &times, tolerance);
        let clearances = scene.clearance.as_ref().map(|rules| {
            // All pairs are handed out, one by one.
            let closely = Closely {
                tolerance: options.tolerance,
                pairs: usize::MAX,
                times: true,
            };
            check_clearance(system, actuation, rules, &trajectory, closely, &|_, _| {})
        });
        let asked = Asked {
            closure: options.closure,
            poses: true,
            motion: options.motion,
            estimates: false,
            empty: false,
            band: None,
        };
        let found = clearances.as_ref();
        let report = MotionReport::new((system, actuation), &trajectory, asked, &measured, found);
        let verdict = report.verdict(solving);
        Ok(Self {
            text: report.text(&verdict, usize::MAX),
            json: format!("{:#}\n", report.json(&verdict)),
            seconds: begun.elapsed().as_secs_f64(),
            verdict,
            pairs: found.map_or_else(Vec::new, |found| pairs(loaded, found)),
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
        to_junit(&self.verdict, self.seconds)
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
