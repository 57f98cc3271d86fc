//! The whole check: every pair of bodies, judged, excluded by rule or by the scene, and in what order to report them.

use super::bodies::Hull;
use super::contact::AT_LEAST;
pub use super::contact::BETWEEN_SAMPLES;
use super::mesh_faults::{mesh_warnings, without_inside};
use super::motion::Motion;
use super::neighbours::{Neighbours, neighbours};
use super::sweep::{Least, PairSweep};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::clearance::ClearanceRules;
use std::time::Instant;

/// Most instants at which an excluded pair is looked at: it is reported, not judged.
const LOOKS_AT_EXCLUDED: usize = 24;

/// Bodies that are meant to touch may be this far apart or in each other at the sampled times, in mechanism sizes: far more
/// than rounding.
const CONTACT: f64 = 1e-10;

/// How a pair was judged.
#[derive(Clone, Debug, PartialEq)]
pub enum Judgement {
    /// Never nearer than its minimum, and the bound says so too.
    Passed,
    /// Nearer than its minimum.
    Failed,
    /// The same, but the bound is an estimate: nothing is proved.
    Estimated,
    /// The distances found pass, but the bound below them does not, and could not be made finer.
    Undecided,
    /// Joined by this joint: not judged.
    Neighbours(&'static str),
    /// Left out by the scene for this reason.
    Ignored(String),
}

impl Judgement {
    /// Of a pair that passes, with a proof of that or without.
    const fn kept(is_certified: bool) -> Self {
        match is_certified {
            true => Self::Passed,
            false => Self::Estimated,
        }
    }

    /// Whether the minimum is kept, as far as is known.
    pub const fn is_kept(&self) -> bool {
        matches!(self, Self::Passed | Self::Estimated)
    }
}

/// A pair of bodies over the motion.
#[derive(Clone, Debug)]
pub struct PairReport {
    /// Indices of the bodies, ascending.
    pub pair: [usize; 2],
    /// Least distance that passes.
    pub minimum: f64,
    /// Where they are nearest.
    pub least: Least,
    /// What that means.
    pub judgement: Judgement,
    /// Distances at the sampled times; empty for excluded pairs.
    pub distances: Vec<f64>,
    /// Of pairs that are meant to touch, and do so at all samples: between them they are never farther apart. How deep they
    /// may be in each other there is the bound of `least`.
    pub farthest: Option<f64>,
    /// Seconds that looking at it took.
    pub seconds: f64,
    /// By how much its bound may stay below the minimum of a pair that passes: rounding of the poses.
    pub slack: f64,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct ClearanceReport {
    /// Judged pairs: failed, undecided and estimated ones first, then by distance above their minimum.
    pub judged: Vec<PairReport>,
    /// Excluded pairs, those of the scene first.
    pub excluded: Vec<PairReport>,
    /// Sampled times, seconds.
    pub times: Vec<f64>,
    /// Stretches of time that could not be checked.
    pub gaps: Vec<[f64; 2]>,
    /// What is odd: exclusions that are not needed, meshes that are inside out or have no inside.
    pub warnings: Vec<String>,
    /// Judged bodies with a mesh that should have an inside and has none, and what is wrong: no check passes with one.
    pub without_inside: Vec<(usize, String)>,
    /// Asked nearness of distance and bound, relative.
    pub tolerance: f64,
}

impl ClearanceReport {
    /// Every judged pair keeps its minimum, as far as is known.
    pub fn is_kept(&self) -> bool {
        self.without_inside.is_empty() && self.judged.iter().all(|p| p.judgement.is_kept())
    }

    /// That a check has looked at nothing, and why.
    pub fn nothing_judged(&self) -> Option<String> {
        let why = match self.excluded.len() {
            0 => "fewer than two bodies have shapes".to_owned(),
            1 => "the only one is excluded".to_owned(),
            all => format!("all {all} are excluded"),
        };
        (self.judged.is_empty() && self.gaps.is_empty())
            .then(|| format!("no pair of bodies was judged: {why}"))
    }

    /// The pair to look at first.
    pub fn worst(&self) -> Option<&PairReport> {
        self.judged.first()
    }

    /// Bodies that are nearer to another one than their minimum at the sampled time nearest to `time`.
    pub fn offenders(&self, time: f64) -> Vec<usize> {
        let off = |k: &usize| (self.times[*k] - time).abs();
        let sample = (0..self.times.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
        let is_near = |p: &&PairReport| {
            let distance = sample.and_then(|k| p.distances.get(k));
            distance.is_some_and(|d| *d < p.minimum) && !p.judgement.is_kept()
        };
        let near = self.judged.iter().filter(is_near);
        let mut list: Vec<usize> = near.flat_map(|p| p.pair).collect();
        list.sort_unstable();
        list.dedup();
        list
    }
}

/// Checks the clearances of a mechanism over a motion of certified poses: what lies between them is looked at, too, what
/// lies before and after them is not.
pub fn check(
    system: &System,
    actuation: &Actuation,
    rules: &ClearanceRules,
    trajectory: &Trajectory,
    tolerance: f64,
    progress: &dyn Fn(usize, usize),
) -> ClearanceReport {
    let mechanism = system.mechanism();
    let count = mechanism.bodies.len();
    let all = count * count.saturating_sub(1) / 2;
    // Proving the motion and sorting the triangles of meshes may take a while.
    progress(0, all);
    let mut motion = Motion::new(system, actuation, trajectory);
    let hulls: Vec<Option<Hull>> = mechanism.bodies.iter().map(Hull::new).collect();
    let mut report = ClearanceReport {
        judged: Vec::new(),
        excluded: Vec::new(),
        times: motion
            .samples
            .iter()
            .map(|k| motion.instants[*k].time)
            .collect(),
        gaps: Vec::new(),
        warnings: mesh_warnings(mechanism, &hulls),
        without_inside: Vec::new(),
        tolerance,
    };
    let mut done = 0;
    for a in 0..count {
        for b in a + 1..count {
            progress(done, all);
            done += 1;
            let (Some(first), Some(second)) = (&hulls[a], &hulls[b]) else {
                continue;
            };
            let begun = Instant::now();
            let asked = AskedPair {
                rules,
                bodies: [a, b],
                hulls: [first, second],
                tolerance,
            };
            let found = asked.look(&mut motion);
            let timed = |pair: PairReport| PairReport {
                seconds: begun.elapsed().as_secs_f64(),
                ..pair
            };
            report.judged.extend(found.judged.map(timed));
            report.excluded.extend(found.excluded.map(timed));
            report.warnings.extend(found.warning);
        }
    }
    progress(all, all);
    report.warnings.extend(report.nothing_judged());
    let is_judged = |body: usize| report.judged.iter().any(|p| p.pair.contains(&body));
    report.without_inside = without_inside(mechanism, &hulls, is_judged);
    let reasons = report.without_inside.iter().map(|(_, text)| text.clone());
    report.warnings.extend(reasons);
    report.gaps = motion.gaps;
    let rank = |p: &PairReport| match p.judgement {
        Judgement::Failed => 0,
        Judgement::Undecided => 1,
        Judgement::Estimated => 2,
        _ => 3,
    };
    let spare = |p: &PairReport| p.least.distance - p.minimum;
    report
        .judged
        .sort_by(|p, q| rank(p).cmp(&rank(q)).then(spare(p).total_cmp(&spare(q))));
    report
        .excluded
        .sort_by_key(|p| !matches!(p.judgement, Judgement::Ignored(_)));
    report
}

/// Two bodies, and what is asked of them.
struct AskedPair<'a> {
    rules: &'a ClearanceRules,
    bodies: [usize; 2],
    hulls: [&'a Hull; 2],
    tolerance: f64,
}

/// What was found of a pair: neighbours are judged but for the shapes at their joint.
#[derive(Default)]
struct Found {
    judged: Option<PairReport>,
    excluded: Option<PairReport>,
    warning: Option<String>,
}

impl<'a> AskedPair<'a> {
    fn minimum(&self) -> f64 {
        self.rules.minimum_of(self.bodies)
    }

    fn sweep(&self, motion: &Motion) -> PairSweep<'a> {
        let minimum = self.minimum();
        PairSweep::new(motion, self.bodies, self.hulls, self.tolerance, minimum)
    }

    /// The rules in their order: what the scene says of the pair itself comes first.
    fn look(&self, motion: &mut Motion) -> Found {
        let mut found = Found::default();
        let minimum = self.minimum();
        let whole = self.sweep(motion);
        if self.rules.touching.contains(&self.bodies) {
            found.judged = touching(motion, &whole);
            return found;
        }
        if self.rules.has_own_minimum(self.bodies) {
            found.judged = judge(motion, &whole, minimum);
            return found;
        }
        let joints = &motion.system.mechanism().joints;
        let near = neighbours(motion, joints, self.bodies, self.hulls, minimum);
        let mut ignored = self.rules.ignored.iter();
        if let Some(ignored) = ignored.find(|i| i.pair == self.bodies) {
            let judgement = Judgement::Ignored(ignored.reason.clone());
            found.excluded = look_at_excluded(motion, &whole, minimum, judgement);
            if !ignored.is_one_of_many {
                found.warning = self.needless(motion, near.as_ref());
            }
            return found;
        }
        match near {
            None => found.judged = judge(motion, &whole, minimum),
            Some(Neighbours::Rigid) => {
                let judgement = Judgement::Neighbours(Neighbours::Rigid.words());
                found.excluded = look_at_excluded(motion, &whole, minimum, judgement);
            }
            Some(Neighbours::Joined { words, touching }) => {
                let rest = whole.without(&touching);
                found.judged = judge(motion, &rest, minimum);
                let judgement = Judgement::Neighbours(words);
                found.excluded = look_at_excluded(motion, &rest.complement(), minimum, judgement);
            }
        }
        found
    }

    /// That an exclusion excludes nothing: what it leaves out would pass.
    fn needless(&self, motion: &mut Motion, near: Option<&Neighbours>) -> Option<String> {
        let [a, b] = self
            .bodies
            .map(|k| &motion.system.mechanism().bodies[k].name);
        let needless = format!("`{a}` and `{b}` need no `ignore`: ");
        let touching: &[[usize; 2]] = match near {
            Some(Neighbours::Rigid) => return Some(needless + "they are one rigid part"),
            Some(Neighbours::Joined { touching, .. }) => touching,
            None => &[],
        };
        let rest = self.sweep(motion).without(touching);
        let samples = motion.samples.clone();
        match rest.sampled(motion, &samples, None) {
            Some(least) if least.distance < self.minimum() => return None,
            Some(_) => {}
            None => return Some(needless + "only shapes at their joint touch"),
        }
        let found = judge(motion, &rest, self.minimum())?;
        (found.judgement == Judgement::Passed).then(|| needless + "without it they pass")
    }
}

fn look_at_excluded(
    motion: &mut Motion,
    sweep: &PairSweep,
    minimum: f64,
    judgement: Judgement,
) -> Option<PairReport> {
    let stride = motion.samples.len().div_ceil(LOOKS_AT_EXCLUDED).max(1);
    let instants: Vec<usize> = motion.samples.iter().copied().step_by(stride).collect();
    let least = sweep.sampled(motion, &instants, None)?;
    Some(PairReport {
        pair: sweep.bodies(),
        minimum,
        least,
        judgement,
        distances: Vec::new(),
        farthest: None,
        seconds: 0.0,
        slack: sweep.slack(),
    })
}

/// A pair that must touch all the time: at the sampled times to rounding, between them as near as can be proved. What is
/// reported is where it is farthest from touching.
fn touching(motion: &mut Motion, sweep: &PairSweep) -> Option<PairReport> {
    let size = motion.system.mechanism().size;
    let mut distances = Vec::new();
    let samples = motion.samples.clone();
    sweep.sampled(motion, &samples, Some(&mut distances))?;
    let off = |k: &usize| distances[*k].abs();
    let worst = (0..distances.len()).max_by(|j, k| off(j).total_cmp(&off(k)))?;
    let mut least = sweep.sampled(motion, &samples[worst..=worst], None)?;
    if least.distance.abs() > CONTACT * size {
        least.bound = distances.iter().copied().fold(f64::INFINITY, f64::min);
        return Some(PairReport {
            pair: sweep.bodies(),
            minimum: 0.0,
            farthest: None,
            least,
            judgement: Judgement::Failed,
            distances,
            seconds: 0.0,
            slack: sweep.slack(),
        });
    }
    let contact = sweep.contact_over(motion);
    let mut judgement = if contact.is_within(AT_LEAST * size) {
        Judgement::kept(contact.is_certified)
    } else {
        Judgement::Undecided
    };
    if let Some((stretch, s)) = contact.broken
        && let Some(instant) = motion.pose_at(stretch, s)
        && let Some(between) = sweep.sampled(motion, &[instant], None)
    {
        (least, judgement) = (between, Judgement::Failed);
    }
    least.bound = contact.low.min(least.distance);
    least.is_certified = contact.is_certified;
    Some(PairReport {
        pair: sweep.bodies(),
        minimum: 0.0,
        farthest: Some(contact.high.max(least.distance)),
        least,
        judgement,
        distances,
        seconds: 0.0,
        slack: sweep.slack(),
    })
}

fn judge(motion: &mut Motion, sweep: &PairSweep, minimum: f64) -> Option<PairReport> {
    let mut distances = Vec::new();
    let mut least = sweep.least_over(motion, &mut distances)?;
    if sweep.is_endless() && least.bound == f64::NEG_INFINITY {
        // Two half-spaces that turn as seen from each other: any turn makes them overlap somewhere, even one of rounding.
        let samples = motion.samples.clone();
        least = sweep.sampled(motion, &samples, None)?;
    }
    // Exactly the minimum cannot be proved, only to within rounding.
    let enough = minimum - sweep.slack();
    let judgement = if least.distance < enough || least.is_enclosed {
        Judgement::Failed
    } else if least.bound >= enough {
        Judgement::kept(least.is_certified)
    } else {
        Judgement::Undecided
    };
    Some(PairReport {
        pair: sweep.bodies(),
        minimum,
        least,
        judgement,
        distances,
        farthest: None,
        seconds: 0.0,
        slack: sweep.slack(),
    })
}
