//! One pair of bodies: the requirements of the scene, and the result.

use super::contact::{AT_LEAST, Contact};
use super::found::{Judgement, PairReport, Violation, Violations};
use super::joint_region::JointRegion;
use super::motion::ProvedMotion;
use super::neighbours::{Neighbours, joint_neighbours};
use super::part::JudgedPart;
use super::sweep::{Least, PairSweep};
use super::touching::MustTouch;
use crate::distance::bodies::BodyElements;
use crate::model::clearance::{ClearanceRules, Ignored};

/// Bodies in contact may be this far apart or overlap by this at the sampled times, on the scale of the contact and besides
/// what poses are off: much more than rounding.
const CONTACT: f64 = 1e-10;

/// Two bodies and the requirements on them.
pub(super) struct AskedPair<'a> {
    pub(super) rules: &'a ClearanceRules,
    pub(super) bodies: [usize; 2],
    pub(super) hulls: [&'a BodyElements; 2],
    pub(super) ignored: Option<&'a Ignored>,
    pub(super) tolerance: f64,
    /// Intervals that may be examined for the times of violations, if these are requested, too.
    pub(super) looks_for_times: Option<usize>,
}

/// The result for a pair: neighbours are judged without the shapes at their joint.
#[derive(Default)]
pub(super) struct BoundSearch {
    pub(super) judged: Vec<PairReport>,
    pub(super) excluded: Vec<PairReport>,
    pub(super) warning: Option<String>,
    /// What is judged, pair by pair of bodies.
    pub(super) parts: Vec<JudgedPart>,
}

impl BoundSearch {
    /// Adds the result for the shapes of a sweep.
    fn take(&mut self, report: Option<PairReport>, sweep: &PairSweep) {
        let nominal = report
            .as_ref()
            .map(|report| [report.least.distance, report.least.time]);
        self.parts
            .extend(nominal.map(|nominal| sweep.part(nominal)));
        self.judged.extend(report);
    }
}

impl<'a> AskedPair<'a> {
    fn minimum(&self) -> f64 {
        self.rules.minimum_of(self.bodies)
    }

    fn sweep(&self, motion: &ProvedMotion) -> PairSweep<'a> {
        self.sweep_of(motion, self.hulls)
    }

    /// With the shapes in other parts.
    fn sweep_of<'h>(&self, motion: &ProvedMotion, hulls: [&'h BodyElements; 2]) -> PairSweep<'h> {
        PairSweep::new(motion, self.bodies, hulls, self.tolerance, self.minimum())
    }

    /// The rules in their order: what the scene says of the pair itself comes first.
    pub(super) fn look(&self, motion: &mut ProvedMotion) -> BoundSearch {
        let mut found = BoundSearch::default();
        let minimum = self.minimum();
        let whole = self.sweep(motion);
        if self.rules.touching.contains(&self.bodies) {
            let report = judge_touching(motion, &whole);
            found.take(report, &whole.with_minimum(0.0));
            return found;
        }
        if self.rules.has_own_minimum(self.bodies) {
            found.take(self.judge(motion, &whole), &whole);
            return found;
        }
        let joints = &motion.system.mechanism().joints;
        // Neighbours leave out what touches at their joint; all other parts are judged.
        let near = joint_neighbours(motion, joints, self.bodies, self.hulls, minimum);
        if let Some(ignored) = self.ignored {
            self.ignore(motion, ignored, near.as_ref(), &mut found);
            return found;
        }
        match near {
            None => found.take(self.judge(motion, &whole), &whole),
            Some(Neighbours::Rigid) => {
                let judgement = Judgement::Neighbours(Neighbours::Rigid.words());
                let first = motion.samples.first().copied();
                let least = first.and_then(|k| whole.sampled(motion, &[k], None));
                let report = least.map(|least| PairReport::of(&whole, minimum, least, judgement));
                found.excluded.extend(report);
            }
            Some(Neighbours::Joined { words, region }) => {
                let rest = self
                    .sweep_of(motion, region.hulls.each_ref())
                    .without(&region.touching);
                found.take(self.judge(motion, &rest), &rest);
                self.look_at_joint(motion, words, &region, &[], &mut found);
            }
        }
        found
    }

    /// What touches at a joint is left out as long as it does not come deeper into each other than it is at the first pose:
    /// each pair of parts for itself, but for those in `without`.
    fn look_at_joint(
        &self,
        motion: &mut ProvedMotion,
        words: &'static str,
        region: &JointRegion,
        without: &[[usize; 2]],
        found: &mut BoundSearch,
    ) {
        let Some(first) = motion.assembled() else {
            return;
        };
        let hulls = region.hulls.each_ref();
        let judgement = Judgement::Neighbours(words);
        let mut kept: Vec<PairReport> = Vec::new();
        let mut left_out: Vec<[usize; 2]> = Vec::new();
        // Parts that touch at the joint may come no deeper than they are as assembled, but for what they grow.
        for pair in region
            .touching
            .iter()
            .filter(|pair| !without.contains(pair))
        {
            let only = self.sweep_of(motion, hulls).without(&[*pair]).complement();
            let Some(assembled) = only.sampled(motion, &[first], None) else {
                continue;
            };
            left_out.push(assembled.shapes);
            let least = match region.is_constant(*pair) {
                true => Some(assembled.clone()),
                false => only.searched(motion),
            };
            let Some(least) = least else {
                continue;
            };
            let growth = region.growth(*pair);
            let allowed = assembled.distance.min(0.0) - growth;
            // A mesh has no depth: the translation that separates it decides.
            let is_mesh = only.hulls.iter().any(|hull| hull.has_mesh());
            let cut = match is_mesh {
                true => only.cut_deeper(motion, growth),
                false => None,
            };
            if let Some(cut) = cut {
                let report = PairReport::of(&only, 0.0, cut, Judgement::Failed);
                found.judged.push(report);
                continue;
            }
            match least.distance < allowed {
                true => {
                    let report = PairReport::of(&only, allowed, least, Judgement::Failed);
                    found.judged.push(report);
                }
                false => kept.push(PairReport::of(
                    &only,
                    self.minimum(),
                    least,
                    judgement.clone(),
                )),
            }
        }
        left_out.sort_unstable();
        left_out.dedup();
        // Of those that stay out, the nearest one is reported.
        let lowest = |p: &PairReport, q: &PairReport| p.least.distance.total_cmp(&q.least.distance);
        found.excluded.extend(
            kept.into_iter()
                .min_by(lowest)
                .map(|report| PairReport { left_out, ..report }),
        );
    }

    /// A pair that the scene leaves out: with all of its shapes or some, down to any depth or not.
    fn ignore(
        &self,
        motion: &mut ProvedMotion,
        ignored: &Ignored,
        near: Option<&Neighbours>,
        found: &mut BoundSearch,
    ) {
        let minimum = self.minimum();
        let mut out = self.sweep(motion);
        // Some shapes only: the others of the pair are judged as if nothing were ignored.
        if !ignored.shapes.is_empty() {
            let left_out = self.elements_of(&ignored.shapes);
            let excluded = self.sweep(motion).without(&left_out).complement_pairs();
            match near {
                Some(Neighbours::Rigid) => {}
                Some(Neighbours::Joined { words, region }) => {
                    let parts = region.hulls.each_ref();
                    let asked = |pair| ignored.shapes.contains(&pair);
                    let mut without: Vec<_> = BodyElements::pairs_of(parts, asked).collect();
                    self.look_at_joint(motion, words, region, &without, found);
                    without.extend(&region.touching);
                    let rest = self.sweep_of(motion, parts).without(&without);
                    found.take(self.judge(motion, &rest), &rest);
                }
                None => {
                    let rest = self.sweep(motion).without(&left_out);
                    found.take(self.judge(motion, &rest), &rest);
                }
            }
            out = out.without(&excluded);
        }
        // A depth that is allowed is a minimum of its own.
        if let Some(down_to) = ignored.down_to {
            let deep = out.with_minimum(down_to);
            let report = judge_minimum(motion, &deep, down_to);
            let nominal = report
                .as_ref()
                .map(|report| [report.least.distance, report.least.time]);
            found
                .parts
                .extend(nominal.map(|nominal| deep.part(nominal)));
            out = deep.with_minimum(minimum);
            if let Some(report) = report.filter(PairReport::is_deeper) {
                found.judged.push(report);
                return;
            }
        }
        let judgement = Judgement::Ignored(ignored.reason.clone());
        let least = out.searched(motion);
        let report = least.map(|least| PairReport::of(&out, minimum, least, judgement));
        found.excluded.extend(report);
        let is_all = ignored.shapes.is_empty() && ignored.down_to.is_none();
        if is_all && !ignored.is_one_of_many {
            found.warning = self.needless(motion, near);
        }
    }

    /// Pairs of elements that belong to pairs of shapes.
    fn elements_of(&self, shapes: &[[usize; 2]]) -> Vec<[usize; 2]> {
        BodyElements::pairs_of(self.hulls, |pair| shapes.contains(&pair)).collect()
    }

    /// Judges the pair, and finds out when it is too near.
    fn judge(&self, motion: &mut ProvedMotion, sweep: &PairSweep) -> Option<PairReport> {
        let mut report = judge_minimum(motion, sweep, self.minimum())?;
        if let Some(looks) = self.looks_for_times.filter(|_| !report.judgement.is_kept()) {
            let mut violations = sweep.violations(motion, report.least.is_enclosed, looks);
            reconcile_reports(motion, sweep, &mut report, &mut violations);
            report.violations = Some(violations);
        }
        Some(report)
    }

    /// Warns of an exclusion that is unnecessary because the excluded shapes would pass.
    fn needless(&self, motion: &mut ProvedMotion, near: Option<&Neighbours>) -> Option<String> {
        let [a, b] = self
            .bodies
            .map(|k| &motion.system.mechanism().bodies[k].name);
        let needless = format!("`{a}` and `{b}` need no `ignore`: ");
        let rest = match near {
            Some(Neighbours::Rigid) => return Some(needless + "they are one rigid part"),
            Some(Neighbours::Joined { region, .. }) => self
                .sweep_of(motion, region.hulls.each_ref())
                .without(&region.touching),
            None => self.sweep(motion),
        };
        // At the samples first, which is cheap; the proof comes last.
        let samples = motion.samples.clone();
        match rest.sampled(motion, &samples, None) {
            Some(least) if least.distance < self.minimum() => return None,
            Some(_) => {}
            None => return Some(needless + "only shapes at their joint touch"),
        }
        if let Some(Neighbours::Joined { words, region }) = near {
            let mut at_joint = BoundSearch::default();
            self.look_at_joint(motion, words, region, &[], &mut at_joint);
            if !at_joint.judged.is_empty() {
                return None;
            }
        }
        let found = judge_minimum(motion, &rest, self.minimum())?;
        (found.judgement == Judgement::Passed).then(|| needless + "without it they pass")
    }
}

/// A pair that must touch all the time: at the sampled times to rounding, between them as near as can be proved.
fn judge_touching(motion: &mut ProvedMotion, sweep: &PairSweep) -> Option<PairReport> {
    let scale = sweep.contact_scale(motion);
    let allowed = CONTACT * scale + sweep.pose_slack();
    // At the samples: contact means a distance of 0 to within the tolerance of poses.
    let mut distances = Vec::new();
    let samples = motion.samples.clone();
    let mut least = sweep.sampled(motion, &samples, Some(&mut distances))?;
    let far = (0..distances.len()).max_by(|j, k| distances[*j].total_cmp(&distances[*k]))?;
    let mut apart = sweep.sampled(motion, &samples[far..=far], None)?.moment();
    let shift = sweep.parting_shift(motion);
    let cuts = sweep.mesh_cuts();
    let first_cut = |motion: &ProvedMotion, instants: &[usize]| {
        cuts.as_ref()
            .and_then(|cuts| cuts.first(motion, instants, shift))
    };
    let mut cut = first_cut(motion, &samples);
    let is_deep = least.distance < -allowed || least.is_enclosed || cut.is_some();
    let mut is_broken = is_deep || apart.distance > allowed;
    // Between them: the distance is enclosed over the proved motion, finely unless that changes nothing.
    let contact = sweep.contact_over(motion, !is_broken);
    if let Some((instant, between)) = broken_between(motion, sweep, &contact) {
        is_broken = true;
        cut = cut.or_else(|| first_cut(motion, &[instant]));
        if between.distance > apart.distance {
            apart = between.moment();
        }
        if between.distance < least.distance || between.is_enclosed {
            least = between;
        }
    }
    if is_broken && !least.is_enclosed {
        least = deeper(motion, sweep, least);
    }
    // Where a mesh is cut the distance is that of bodies that touch.
    if let Some(instant) = cut.filter(|_| least.distance >= -allowed) {
        least = sweep.sampled(motion, &[instant], None)?;
    }
    let judgement = match contact.is_within(AT_LEAST * scale) {
        _ if is_broken => Judgement::Failed,
        true => Judgement::kept(contact.is_certified),
        false => Judgement::Undecided,
    };
    let lowest = contact.low.min(sweep.lowest_alone(motion));
    least.bound = sweep.told(lowest.min(least.distance));
    least.is_certified = contact.is_certified;
    let touching = MustTouch {
        apart,
        farthest: contact.high.max(apart.distance),
        allowed,
        cut: cut.map(|_| shift),
    };
    Some(PairReport {
        touching: Some(touching),
        distances,
        ..PairReport::of(sweep, 0.0, least, judgement)
    })
}

/// A pose between the samples at which bodies in contact provably are too far from touching.
fn broken_between(
    motion: &mut ProvedMotion,
    sweep: &PairSweep,
    contact: &Contact,
) -> Option<(usize, Least)> {
    let (stretch, s) = contact.broken?;
    let instant = motion.pose_at(stretch, s)?;
    Some((instant, sweep.sampled(motion, &[instant], None)?))
}

/// How deep two bodies come, which the samples may miss.
fn deeper(motion: &mut ProvedMotion, sweep: &PairSweep, least: Least) -> Least {
    let searched = sweep.searched(motion);
    let lower = searched.filter(|found| found.distance < least.distance);
    lower.unwrap_or(least)
}

/// The least distance and the times of violations are looked for apart: what either has seen counts for both.
fn reconcile_reports(
    motion: &mut ProvedMotion,
    sweep: &PairSweep,
    report: &mut PairReport,
    violations: &mut Violations,
) {
    let lowest = (violations.list.iter()).min_by(|p, q| p.distance.total_cmp(&q.distance));
    let lower = lowest.filter(|v| v.distance < report.least.distance);
    let lower = lower.and_then(|v| motion.instants.iter().position(|i| i.time == v.time));
    // A violation may have seen a lower pose than the search for the least distance.
    if let Some(least) = lower.and_then(|instant| sweep.sampled(motion, &[instant], None)) {
        report.least = Least {
            bound: report.least.bound.min(least.distance),
            is_certified: report.least.is_certified,
            is_refined: report.least.is_refined,
            ..least
        };
        if report.least.distance < sweep.enough() {
            report.judgement = Judgement::Failed;
        }
    }
    // Where no time was left in which the minimum may be missed, it is kept.
    let is_kept = violations.list.is_empty() && violations.is_certified && motion.gaps.is_empty();
    if is_kept && report.judgement == Judgement::Undecided {
        report.least.bound = report.least.bound.max(sweep.enough());
        report.least.is_certified = true;
        report.judgement = Judgement::kept(true);
    }
    // And the other way round.
    let Least { distance, time, .. } = report.least;
    let holds = |v: &&mut Violation| (v.from..=v.to).contains(&time) && distance < v.distance;
    for violation in violations.list.iter_mut().filter(holds) {
        (violation.distance, violation.time) = (distance, time);
        violation.is_seen |= distance < sweep.enough();
    }
}

fn judge_minimum(motion: &mut ProvedMotion, sweep: &PairSweep, minimum: f64) -> Option<PairReport> {
    let mut distances = Vec::new();
    let mut least = sweep.least_over(motion, &mut distances)?;
    if sweep.is_endless() && least.bound == f64::NEG_INFINITY {
        // Two half-spaces that turn as seen from each other: any turn makes them overlap somewhere, even one of rounding.
        let samples = motion.samples.clone();
        least = sweep.sampled(motion, &samples, None)?;
    }
    let enough = sweep.enough();
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
        distances,
        ..PairReport::of(sweep, minimum, least, judgement)
    })
}
