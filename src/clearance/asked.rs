//! One pair of bodies: what the scene asks of it, and how it comes out.

use super::bodies::Hull;
use super::contact::AT_LEAST;
use super::found::{Judgement, PairReport};
use super::motion::Motion;
use super::neighbours::{Neighbours, neighbours};
use super::sweep::PairSweep;
use crate::model::clearance::{ClearanceRules, Ignored};

/// Most instants at which an excluded pair is looked at: it is reported, not judged.
const LOOKS_AT_EXCLUDED: usize = 24;

/// Bodies that are meant to touch may be this far apart or in each other at the sampled times, in mechanism sizes: far more
/// than rounding.
const CONTACT: f64 = 1e-10;

/// Two bodies, and what is asked of them.
pub(super) struct AskedPair<'a> {
    pub(super) rules: &'a ClearanceRules,
    pub(super) bodies: [usize; 2],
    pub(super) hulls: [&'a Hull; 2],
    pub(super) ignored: Option<&'a Ignored>,
    pub(super) tolerance: f64,
    /// When a pair is too near is asked, too.
    pub(super) with_times: bool,
}

/// What was found of a pair: neighbours are judged but for the shapes at their joint.
#[derive(Default)]
pub(super) struct Found {
    pub(super) judged: Vec<PairReport>,
    pub(super) excluded: Option<PairReport>,
    pub(super) warning: Option<String>,
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
    pub(super) fn look(&self, motion: &mut Motion) -> Found {
        let mut found = Found::default();
        let minimum = self.minimum();
        let whole = self.sweep(motion);
        if self.rules.touching.contains(&self.bodies) {
            found.judged.extend(touching(motion, &whole));
            return found;
        }
        if self.rules.has_own_minimum(self.bodies) {
            found.judged.extend(self.judge(motion, &whole));
            return found;
        }
        let joints = &motion.system.mechanism().joints;
        let near = neighbours(motion, joints, self.bodies, self.hulls, minimum);
        if let Some(ignored) = self.ignored {
            self.ignore(motion, ignored, near.as_ref(), &mut found);
            return found;
        }
        match near {
            None => found.judged.extend(self.judge(motion, &whole)),
            Some(Neighbours::Rigid) => {
                let judgement = Judgement::Neighbours(Neighbours::Rigid.words());
                found.excluded = look_at_excluded(motion, &whole, minimum, judgement);
            }
            Some(Neighbours::Joined { words, touching }) => {
                let rest = whole.without(&touching);
                found.judged.extend(self.judge(motion, &rest));
                let judgement = Judgement::Neighbours(words);
                found.excluded = look_at_excluded(motion, &rest.complement(), minimum, judgement);
            }
        }
        found
    }

    /// A pair that the scene leaves out: with all of its shapes or some, down to any depth or not.
    fn ignore(
        &self,
        motion: &mut Motion,
        ignored: &Ignored,
        near: Option<&Neighbours>,
        found: &mut Found,
    ) {
        let minimum = self.minimum();
        let mut out = self.sweep(motion);
        if !ignored.shapes.is_empty() {
            let mut left_out = self.elements_of(&ignored.shapes);
            let excluded = self.sweep(motion).without(&left_out).complement_pairs();
            if let Some(Neighbours::Joined { touching, .. }) = near {
                left_out.extend(touching);
            }
            if near != Some(&Neighbours::Rigid) {
                let rest = self.sweep(motion).without(&left_out);
                found.judged.extend(self.judge(motion, &rest));
            }
            out = out.without(&excluded);
        }
        if let Some(down_to) = ignored.down_to {
            let deep = out.with_minimum(down_to);
            let report = judge(motion, &deep, down_to).filter(|r| r.is_deeper());
            out = deep.with_minimum(minimum);
            if let Some(report) = report {
                found.judged.push(report);
                return;
            }
        }
        let judgement = Judgement::Ignored(ignored.reason.clone());
        found.excluded = look_at_excluded(motion, &out, minimum, judgement);
        let is_all = ignored.shapes.is_empty() && ignored.down_to.is_none();
        if is_all && !ignored.is_one_of_many {
            found.warning = self.needless(motion, near);
        }
    }

    /// Pairs of elements that belong to pairs of shapes.
    fn elements_of(&self, shapes: &[[usize; 2]]) -> Vec<[usize; 2]> {
        let [first, second] = self.hulls.map(|hull| &hull.elements);
        let mut list = Vec::new();
        for (i, a) in first.iter().enumerate() {
            for (j, b) in second.iter().enumerate() {
                list.extend(shapes.contains(&[a.shape, b.shape]).then_some([i, j]));
            }
        }
        list
    }

    /// Judges the pair, and finds out when it is too near.
    fn judge(&self, motion: &mut Motion, sweep: &PairSweep) -> Option<PairReport> {
        let mut report = judge(motion, sweep, self.minimum())?;
        let is_wanted = self.with_times && !report.judgement.is_kept();
        report.violations = is_wanted.then(|| sweep.violations(motion, report.least.is_enclosed));
        Some(report)
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
        violations: None,
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
            violations: None,
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
        violations: None,
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
    } else if minimum >= 0.0 && sweep.is_mesh_cut(motion, least.time) {
        Judgement::Failed
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
        violations: None,
    })
}
