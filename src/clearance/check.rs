//! The whole check: every pair of bodies, judged, excluded by rule or by the scene, and in what order to report them.

use super::asked::{AskedPair, BoundSearch};
use super::broad_phase::BroadPhase;
pub use super::contact::BETWEEN_SAMPLES;
pub use super::found::{
    ClearanceClass, ClearanceReport, FarPairs, Judgement, PairReport, Violation, Violations,
};
use super::mesh_faults::{mesh_warnings, without_inside};
use super::motion::ProvedMotion;
use super::neighbours::Neighbours;
use super::violations::looks_of_each;
use crate::distance::bodies::BodyElements;
use crate::jobs::Stopwatch;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::limits::Deadline;
use crate::model::actuation::Actuation;
use crate::model::clearance::{ClearanceRules, Ignored};
use crate::model::mechanism::Mechanism;
use crate::sorting::{sort_by, sort_by_key};
use std::collections::{HashMap, HashSet};

/// The effort of a check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearanceEffort {
    /// Relative agreement required between the least distance found and its bound.
    pub tolerance: f64,
    /// With more pairs of bodies than this, distant ones are proved together and only counted.
    pub pairs: usize,
    /// Whether to locate the times at which a pair is below its minimum.
    pub times: bool,
}

impl ClearanceEffort {
    /// Number of pairs examined one by one: nobody reads longer reports line by line.
    pub const PAIRS: usize = 200;

    /// Time limit of the search for one pair, seconds: it ends with the bound proved so far.
    pub const SECONDS: f64 = 120.0;

    /// Default agreement of bound and distance: a report shows three digits.
    pub const TOLERANCE: f64 = 1e-3;

    /// With the given tolerance, and no times.
    pub const fn to(tolerance: f64) -> Self {
        Self {
            tolerance,
            pairs: Self::PAIRS,
            times: false,
        }
    }
}

/// Checks the clearances of a mechanism over a motion of certified poses, between them as well, but not
/// before and after them.
pub fn check_clearance(
    system: &System,
    actuation: &Actuation,
    rules: &ClearanceRules,
    trajectory: &Trajectory,
    closely: ClearanceEffort,
    progress: &dyn Fn(usize, usize),
) -> ClearanceReport {
    // Proving the motion and sorting the triangles of meshes may take a while.
    progress(0, 1);
    let mut motion = ProvedMotion::new(system, actuation, trajectory);
    check_over(&mut motion, rules, closely, progress)
}

/// The same over a motion that is covered already.
pub fn check_over(
    motion: &mut ProvedMotion,
    rules: &ClearanceRules,
    closely: ClearanceEffort,
    progress: &dyn Fn(usize, usize),
) -> ClearanceReport {
    let mechanism = motion.system.mechanism();
    let hulls: Vec<Option<BodyElements>> = BodyElements::of_bodies(&mechanism.bodies);
    // Of several patterns the first one counts.
    let ignored = rules.ignored.iter().rev();
    let ignored: HashMap<[usize; 2], &Ignored> = ignored.map(|i| (i.pair, i)).collect();
    let selection = Selection::new(motion, &hulls, rules, &ignored, closely.pairs);
    let instants = motion.samples.iter().map(|k| motion.instants[*k].time);
    let mut report = ClearanceReport {
        judged: Vec::new(),
        excluded: Vec::new(),
        far: selection.far,
        counted: selection.counted,
        times: instants.collect(),
        gaps: motion.gaps.clone(),
        warnings: mesh_warnings(mechanism, &hulls),
        without_inside: Vec::new(),
        tolerance: closely.tolerance,
        parts: Vec::new(),
        pieces: None,
    };
    let searches = Searches {
        rules,
        hulls: &hulls,
        ignored: &ignored,
        closely,
        pairs: &selection.pairs,
    };
    let (found, cut_off) = searches.all(motion, progress);
    for found in found {
        report.judged.extend(found.judged);
        report.excluded.extend(found.excluded);
        report.warnings.extend(found.warning);
        report.parts.extend(found.parts);
    }
    report
        .warnings
        .extend(cut_off.warnings(mechanism, &selection.pairs));
    report.warnings.extend(report.nothing_judged());
    let is_judged = |body: usize| report.judged.iter().any(|p| p.pair.contains(&body));
    report.without_inside = without_inside(mechanism, &hulls, is_judged);
    let reasons = report.without_inside.iter().map(|(_, text)| text.clone());
    report.warnings.extend(reasons);
    sort_report(&mut report);
    report
}

/// The pairs that are examined one by one, and the requirements on them.
struct Searches<'a> {
    rules: &'a ClearanceRules,
    hulls: &'a [Option<BodyElements>],
    ignored: &'a HashMap<[usize; 2], &'a Ignored>,
    closely: ClearanceEffort,
    pairs: &'a [[usize; 2]],
}

impl Searches<'_> {
    /// What is found of all of them, in their order. Where the time of the run is limited each has a share of it; those that
    /// it cuts off have once more what the others have left.
    fn all(
        &self,
        motion: &mut ProvedMotion,
        progress: &dyn Fn(usize, usize),
    ) -> (Vec<BoundSearch>, CutOff) {
        let (all, until) = (self.pairs.len(), motion.until);
        let mut cut_off = CutOff::default();
        let mut found: Vec<BoundSearch> = Vec::with_capacity(all);
        // First pass: an equal share each of the time that is left, so that easy pairs leave theirs to later ones.
        for (place, pair) in self.pairs.iter().enumerate() {
            progress(place, all);
            motion.until = until.share(all - place);
            let (one, is_cut) = self.one(motion, *pair);
            cut_off.note(is_cut, place);
            found.push(one);
        }
        // Second pass: what is still left goes to the pairs that were cut off by their share.
        let again = std::mem::take(&mut cut_off.by_run);
        for (k, place) in again.iter().enumerate() {
            motion.until = until.share(again.len() - k);
            let (one, is_cut) = self.one(motion, self.pairs[*place]);
            cut_off.note(is_cut, *place);
            // A pair that is cut off again keeps its first result.
            if is_cut.is_none() {
                found[*place] = one;
            }
        }
        progress(all, all);
        motion.until = until;
        (found, cut_off)
    }

    /// What is found of one, and whether its search was cut off: by its own time, or sooner.
    fn one(&self, motion: &mut ProvedMotion, [a, b]: [usize; 2]) -> (BoundSearch, Option<CutBy>) {
        let (Some(first), Some(second)) = (&self.hulls[a], &self.hulls[b]) else {
            return (BoundSearch::default(), None);
        };
        let (begun, poses) = (Stopwatch::start(), motion.instants.len());
        let asked = AskedPair {
            rules: self.rules,
            bodies: [a, b],
            hulls: [first, second],
            ignored: self.ignored.get(&[a, b]).copied(),
            tolerance: self.closely.tolerance,
            looks_for_times: (self.closely.times).then(|| looks_of_each(self.pairs.len())),
        };
        // The sooner limit ends the search: the share of the run, or the pair's own.
        let of_run = motion.until;
        motion.until = of_run.or(Deadline::after(ClearanceEffort::SECONDS));
        let mut found = asked.look(motion);
        // Poses that were solved for this pair are of no use to others.
        motion.forget(poses);
        let is_cut = std::mem::take(&mut motion.is_cut_off);
        let all = found.judged.iter_mut().chain(&mut found.excluded);
        all.for_each(|pair| pair.seconds = begun.seconds());
        // Only a pair that its share of the run cut off is searched again.
        let by = match of_run.is_over() {
            true => CutBy::Run,
            false => CutBy::Own,
        };
        (found, is_cut.then_some(by))
    }
}

/// The limit that ended a search before the requested bound was proved.
#[derive(Clone, Copy, PartialEq)]
enum CutBy {
    /// Its own time.
    Own,
    /// Its share of the time of the run.
    Run,
}

/// The searches that ended before the requested bound was proved, as indices into the list of pairs.
#[derive(Default)]
struct CutOff {
    by_own: Vec<usize>,
    by_run: Vec<usize>,
}

impl CutOff {
    fn note(&mut self, is_cut: Option<CutBy>, place: usize) {
        match is_cut {
            Some(CutBy::Own) => self.by_own.push(place),
            Some(CutBy::Run) => self.by_run.push(place),
            None => {}
        }
    }

    fn warnings(&self, mechanism: &Mechanism, pairs: &[[usize; 2]]) -> Vec<String> {
        let name = |k: usize| &mechanism.bodies[k].name;
        let own = self.by_own.iter().map(|place| {
            let [a, b] = pairs[*place].map(name);
            format!(
                "the search for `{a}` and `{b}` was cut off after {} s: the report has what was proved by then",
                ClearanceEffort::SECONDS
            )
        });
        let by_run = (!self.by_run.is_empty()).then(|| {
            format!(
                "the limit `time` cut off the search for {} of {} pairs: the report has what was proved by then",
                self.by_run.len(),
                pairs.len()
            )
        });
        own.chain(by_run).collect()
    }
}

/// The worst first, and what the scene excludes before what joints do.
fn sort_report(report: &mut ClearanceReport) {
    let rank = |p: &PairReport| match p.judgement {
        Judgement::Failed => 0,
        Judgement::Undecided => 1,
        Judgement::Estimated => 2,
        _ => 3,
    };
    let spare = PairReport::margin;
    sort_by(&mut report.judged, |p, q| {
        rank(p).cmp(&rank(q)).then(spare(p).total_cmp(&spare(q)))
    });
    sort_by_key(&mut report.excluded, |p| {
        !matches!(p.judgement, Judgement::Ignored(_))
    });
}

/// Selects the pairs that are examined one by one, and classifies the others.
struct Selection {
    pairs: Vec<[usize; 2]>,
    far: Option<FarPairs>,
    counted: Vec<(Judgement, usize)>,
}

impl Selection {
    /// All pairs, if they are no more than `wanted`. Else those of one rigid part are counted, and of the others those that
    /// are far apart, unless the scene names them.
    fn new(
        motion: &ProvedMotion,
        hulls: &[Option<BodyElements>],
        rules: &ClearanceRules,
        ignored: &HashMap<[usize; 2], &Ignored>,
        wanted: usize,
    ) -> Self {
        let mut selection = Self {
            pairs: Vec::new(),
            far: None,
            counted: Vec::new(),
        };
        let joints = &motion.system.mechanism().joints;
        let is_rigid = |[a, b]: &[usize; 2]| joints.are_rigid(*a, *b);
        let is_shaped = |pair: &[usize; 2]| pair.iter().all(|k| hulls[*k].is_some());
        // Few pairs: all of them one by one.
        let phase = BroadPhase::new(motion, hulls);
        let [all, rigid] = phase.counts();
        if all <= wanted {
            selection.pairs = all_pairs(hulls.len()).filter(is_shaped).collect();
            return selection;
        }
        // Many: those that rules name, and those that the broad phase finds near.
        let mut looked_at = named_pairs(rules);
        looked_at.retain(is_shaped);
        let far = (all - rigid > wanted).then(|| phase.near(rules.largest_minimum(), wanted));
        let far = far.flatten();
        match &far {
            Some(near) => looked_at.extend(&near.pairs),
            None => {
                looked_at.extend(all_pairs(hulls.len()).filter(|p| is_shaped(p) && !is_rigid(p)))
            }
        }
        // All others are counted: rigid ones, ignored ones, far ones.
        let rigid = rigid - looked_at.iter().filter(|p| is_rigid(p)).count();
        selection.count(Judgement::Neighbours(Neighbours::Rigid.words()), rigid);
        let is_other =
            |pair: &[usize; 2]| is_shaped(pair) && !is_rigid(pair) && !looked_at.contains(pair);
        for (_, rule) in ignored.iter().filter(|(pair, _)| is_other(pair)) {
            selection.count(Judgement::Ignored(rule.reason.clone()), 1);
        }
        let counted = selection.counted.iter().map(|(_, count)| count);
        let rest = all - looked_at.len() - counted.sum::<usize>();
        selection.far = far.filter(|_| rest > 0).map(|near| FarPairs {
            count: rest,
            apart: near.apart,
            is_certified: motion.is_certified(),
        });
        selection.pairs = looked_at.into_iter().collect();
        selection.pairs.sort_unstable();
        selection
    }

    /// More pairs that are left out.
    fn count(&mut self, judgement: Judgement, more: usize) {
        match self
            .counted
            .iter_mut()
            .find(|(known, _)| *known == judgement)
        {
            Some((_, count)) => *count += more,
            None if more > 0 => self.counted.push((judgement, more)),
            None => {}
        }
    }
}

/// Pairs that the scene says something of by both names.
fn named_pairs(rules: &ClearanceRules) -> HashSet<[usize; 2]> {
    let own = rules.pairs.iter().filter(|p| !p.is_one_of_many);
    let ignored = rules.ignored.iter().filter(|i| !i.is_one_of_many);
    let touching = rules.touching.iter().copied();
    let both = own.map(|p| p.pair).chain(ignored.map(|i| i.pair));
    both.chain(touching).collect()
}

/// All pairs of numbers below `count`.
fn all_pairs(count: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..count).flat_map(move |a| (a + 1..count).map(move |b| [a, b]))
}
