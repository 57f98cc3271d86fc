//! The maximum of a formula over the whole motion, with a bound: branch and bound over the time intervals.
//!
//! In an interval a formula is a polynomial plus a remainder. Where it may still exceed the best value found, a pose is solved
//! and the part is halved; where the remainder dominates, the interval itself is. Kinks and jumps are part of the
//! remainder, which shrinks with the interval around a kink, and at a jump contains the values on both sides.

use super::excluded::places_of;
use super::motion::ProvedMotion;
use crate::kinematics::certificate::tube::TaylorModel;
use crate::kinematics::loops::observed::{dependencies, formula_value};
use crate::model::expression::Expression;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::OPERATION;
use crate::numbers::scalar::Ring;
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

/// The bound is this near to the value, as a share of all values' spread, or of the value if that is less: a value of many
/// magnitudes is small where it is least, and a large one may vary by little.
const SHARE: f64 = 2e-10;

/// No nearer than this share of the value: it is rounded.
const ROUNDED: f64 = 4.0 * OPERATION;

/// Maximum number of parts examined: beyond it the bound of a formula is not refined.
const MOST_PARTS: usize = 20_000;

/// Parts of halves reach this much over their ends: the middle of a stretch is a rounded time.
const OVERLAP: f64 = 1e-9;

/// Parts are not halved below this share of the time, or of a second: jumps are known no better.
const NARROWEST: f64 = 1e-12;

/// A remainder of which halves of a tube keep more than this share is rounding: what comes from the motion goes with the
/// first power of the time at least.
const KEPT: f64 = 0.6;

/// So many halvings in a row must have kept the remainder in both halves: at a jump in the very middle of a tube they do so once.
const KEEPING: u32 = 2;

/// The same of bounds that are farther from the best value than [`NEAR`]: several kinks and jumps in one tube keep it as long as they
/// are not parted, tubes that are too long for their proof as long as they are.
const KEEPING_FAR: u32 = 12;

/// What rounding may do, as a share of all values' spread or of the value, without large numbers that cancel.
const NEAR: f64 = 1e-6;

/// Steps of the golden section that settle the value: each takes 0.6 of the width, and the value goes with its square.
const SETTLING: u32 = 40;

/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The greatest value of a formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Greatest {
    /// The greatest found: that of a solved pose, in internal units.
    pub value: f64,
    /// When, in seconds; a sum has no such moment.
    pub time: Option<f64>,
    /// It is nowhere greater on all that was followed, if certified.
    pub bound: f64,
    /// Whether the bound is proved, for the whole motion.
    pub is_certified: bool,
    /// How many parts of the motion were examined.
    pub parts: usize,
}

impl Greatest {
    /// The greater of two.
    pub fn or(self, other: Self) -> Self {
        let greater = if other.value > self.value {
            other
        } else {
            self
        };
        Self {
            bound: self.bound.max(other.bound),
            is_certified: self.is_certified && other.is_certified,
            parts: self.parts + other.parts,
            ..greater
        }
    }

    /// Their sum.
    pub fn plus(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            time: None,
            bound: (Interval::point(self.bound) + Interval::point(other.bound)).hi,
            is_certified: self.is_certified && other.is_certified,
            parts: self.parts + other.parts,
        }
    }
}

/// A part of a stretch, and what the formula cannot exceed there.
struct StretchPart {
    bound: f64,
    stretch: usize,
    from: f64,
    to: f64,
    /// What the bound owes to slope and curvature, and to the remainder of the tube.
    moves: f64,
    off: f64,
    /// How many halvings of the tube in a row have kept the remainder.
    keeping: u32,
    /// Only the ranges of the coordinates were looked at, which is far quicker than the formula's Taylor model.
    is_rough: bool,
}

impl PartialEq for StretchPart {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for StretchPart {}

impl PartialOrd for StretchPart {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for StretchPart {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

/// The formula over a stretch, and what it does not exceed there.
#[derive(Clone, Copy)]
struct StretchModel {
    model: TaylorModel,
    most: f64,
}

/// The search for one formula's greatest value, or that of its negative.
struct ExtremeSearch<'a, 'm> {
    motion: &'a mut ProvedMotion<'m>,
    formula: &'a Expression,
    /// For every slot, whether the formula depends on it.
    needed: Vec<bool>,
    sign: f64,
    models: HashMap<usize, StretchModel>,
    parts: BinaryHeap<StretchPart>,
    best: Option<ExtremePose>,
    least: f64,
    /// What is bounded no better.
    stuck: f64,
    examined: usize,
}

/// The best pose, and where it was found.
#[derive(Clone, Copy)]
struct ExtremePose {
    value: f64,
    time: f64,
    place: FoundAt,
}

/// Where a pose was found.
#[derive(Clone, Copy)]
enum FoundAt {
    /// At a sample, by its index among the instants.
    Sample(usize),
    /// In a part of a stretch: its index, and the ends of the part.
    Part(usize, f64, f64),
}

/// The greatest value of `sign` times a formula; `None` where it has no value at some sampled pose.
pub fn greatest(motion: &mut ProvedMotion, formula: &Expression, sign: f64) -> Option<Greatest> {
    motion.make_room();
    let kept = motion.instants.len();
    let is_certified = motion.is_certified();
    // The slots that the formula depends on: at a pose only they are evaluated.
    let needed = dependencies(motion.system.mechanism(), &formula.slots());
    let mut search = ExtremeSearch {
        motion,
        formula,
        needed,
        sign,
        models: HashMap::new(),
        parts: BinaryHeap::new(),
        best: None,
        least: f64::INFINITY,
        stuck: f64::NEG_INFINITY,
        examined: 0,
    };
    // From below: the best value at a sampled pose.
    search.look_at_samples()?;
    // From above: branch and bound over Taylor models of the stretches.
    let bound = search.bound()?;
    // Golden section in the part of the best pose; it raises the value and leaves the bound.
    search.settle();
    let (best, parts) = (search.best?, search.examined);
    motion.forget(kept);
    Some(Greatest {
        value: best.value,
        time: Some(best.time),
        bound: bound.max(best.value),
        is_certified: is_certified && bound.is_finite(),
        parts,
    })
}

impl ExtremeSearch<'_, '_> {
    fn look_at_samples(&mut self) -> Option<()> {
        for k in 0..self.motion.samples.len() {
            let sample = self.motion.samples[k];
            let value = self.look_at(sample, FoundAt::Sample(sample));
            if !value.is_finite() {
                return None;
            }
        }
        Some(())
    }

    /// The value at a solved pose.
    fn look_at(&mut self, index: usize, place: FoundAt) -> f64 {
        let instant = &self.motion.instants[index];
        let mechanism = self.motion.system.mechanism();
        let formula = (self.formula, self.needed.as_slice());
        let value = self.sign * formula_value(mechanism, &instant.coordinates, formula);
        self.least = self.least.min(value);
        if value.is_finite() && self.best.is_none_or(|best| value > best.value) {
            let time = instant.time;
            self.best = Some(ExtremePose { value, time, place });
        }
        value
    }

    /// What the formula does not exceed.
    fn bound(&mut self) -> Option<f64> {
        for stretch in 0..self.motion.roots {
            self.push_roughly(stretch);
        }
        // Between jumps there may be poses that belong to no stretch.
        let formula = (self.formula, self.needed.as_slice());
        for range in self.motion.formula_ranges_alone(formula) {
            self.stuck = self.stuck.max(self.most_of(range));
        }
        while self.examined < MOST_PARTS && !self.motion.is_late() {
            let Some(top) = self.next_part() else {
                return Some(self.stuck);
            };
            let best = self.best?.value;
            let enough = (SHARE * (best - self.least).min(best.abs())).max(ROUNDED * best.abs());
            // Best first: no other part has a greater bound.
            if top.bound <= best + enough {
                return Some(top.bound.max(self.stuck));
            }
            self.examined += 1;
            self.part(&top);
        }
        let rest = self.next_part();
        let rest = rest.map_or(f64::NEG_INFINITY, |part| part.bound);
        Some(rest.max(self.stuck))
    }

    /// The part with the greatest bound, by its model unless its range tells enough.
    fn next_part(&mut self) -> Option<StretchPart> {
        loop {
            let top = self.parts.pop()?;
            let best = self.best.map_or(f64::INFINITY, |best| best.value);
            if !top.is_rough || top.bound <= best {
                return Some(top);
            }
            self.push(top.stretch, [top.from, top.to], top.keeping);
        }
    }

    /// Looks into a part, and parts it.
    fn part(&mut self, part: &StretchPart) {
        let StretchPart {
            stretch, from, to, ..
        } = *part;
        let middle = 0.5 * (from + to);
        if let Some(instant) = self.motion.pose_at(stretch, middle) {
            self.look_at(instant, FoundAt::Part(stretch, from, to));
        }
        let [start, end] = self.motion.times(stretch, [from, to]);
        let is_narrow = end - start <= NARROWEST * end.abs().max(1.0);
        if is_narrow || self.is_rounding(part) {
            self.stuck = self.stuck.max(part.bound);
        // Halving helps as long as the motion itself opens the bound; else the tube must get thinner.
        } else if part.moves > part.off && to - from > OPERATION {
            self.push(stretch, [from, middle], part.keeping);
            self.push(stretch, [middle, to], part.keeping);
        } else if let Some(halves) = self.motion.halves(stretch) {
            let rest = KEPT * self.model(stretch).model.rest;
            let has_kept = |half: &usize| self.model(*half).model.rest > rest;
            let keeping = match halves.iter().all(has_kept) {
                true => part.keeping + 1,
                false => 0,
            };
            for (half, shift) in halves.into_iter().zip([1.0, -1.0]) {
                let [from, to] = [2.0 * from + shift - OVERLAP, 2.0 * to + shift + OVERLAP];
                self.push(half, [from.max(-1.0), to.min(1.0)], keeping);
            }
        } else {
            self.stuck = self.stuck.max(part.bound);
        }
    }

    /// Whether halving the tube is of no more use: what remains is rounding.
    fn is_rounding(&self, part: &StretchPart) -> bool {
        let best = self.best.map_or(f64::INFINITY, |best| best.value);
        let is_near = part.bound - best <= NEAR * (best - self.least).max(best.abs());
        part.keeping >= if is_near { KEEPING } else { KEEPING_FAR }
    }

    /// The formula over a stretch.
    fn model(&mut self, stretch: usize) -> StretchModel {
        if let Some(known) = self.models.get(&stretch) {
            return *known;
        }
        let formula = (self.formula, self.needed.as_slice());
        let model = self.motion.formula(stretch, formula).scaled(self.sign);
        let most = self.most_over(stretch);
        let known = StretchModel { model, most };
        self.models.insert(stretch, known);
        known
    }

    /// What the formula does not exceed over a stretch, by the ranges of the coordinates.
    fn most_over(&self, stretch: usize) -> f64 {
        let formula = (self.formula, self.needed.as_slice());
        self.most_of(self.motion.formula_range(stretch, formula))
    }

    /// The upper end of a range of the formula; no number is no bound, which `f64::max` would pass over.
    fn most_of(&self, range: Interval) -> f64 {
        let most = range.scale(self.sign).hi;
        if most.is_nan() { f64::INFINITY } else { most }
    }

    fn push_roughly(&mut self, stretch: usize) {
        let bound = self.most_over(stretch);
        self.parts.push(StretchPart {
            bound,
            stretch,
            from: -1.0,
            to: 1.0,
            moves: 0.0,
            off: 0.0,
            keeping: 0,
            is_rough: true,
        });
    }

    fn push(&mut self, stretch: usize, [from, to]: [f64; 2], keeping: u32) {
        if from >= to {
            return;
        }
        let StretchModel { model, most } = self.model(stretch);
        let around = model.around(0.5 * (from + to), 0.5 * (to - from));
        let moves = [around.way.abs(), around.bend.abs(), around.off];
        let add = |sum: Interval, part: &f64| sum + Interval::point(*part);
        // Value in the middle plus slope, second-order term and remainder over half the part.
        let bound = moves.iter().fold(Interval::point(around.value), add).hi;
        self.parts.push(StretchPart {
            bound: if bound < most { bound } else { most },
            stretch,
            from,
            to,
            moves: around.way.abs() + around.bend.abs(),
            off: around.off,
            keeping,
            is_rough: false,
        });
    }

    /// Finds the greatest value near the best pose to all digits: in its part, or in the stretches around a sample.
    fn settle(&mut self) {
        match self.best.map(|best| best.place) {
            Some(FoundAt::Part(stretch, from, to)) => self.settle_in(stretch, [from, to]),
            Some(FoundAt::Sample(sample)) => {
                for (stretch, _) in places_of(self.motion, sample) {
                    self.settle_in(stretch, [-1.0, 1.0]);
                }
            }
            None => {}
        }
    }

    /// A golden section.
    fn settle_in(&mut self, stretch: usize, [mut from, mut to]: [f64; 2]) {
        let mut value = |s: f64| match self.motion.pose_at(stretch, s) {
            Some(instant) => self.look_at(instant, FoundAt::Part(stretch, s, s)),
            None => f64::NEG_INFINITY,
        };
        let (mut a, mut b) = (to - GOLDEN * (to - from), from + GOLDEN * (to - from));
        let (mut at_a, mut at_b) = (value(a), value(b));
        for _ in 0..SETTLING {
            if at_a >= at_b {
                (to, b, at_b) = (b, a, at_a);
                a = to - GOLDEN * (to - from);
                at_a = value(a);
            } else {
                (from, a, at_a) = (a, b, at_b);
                b = from + GOLDEN * (to - from);
                at_b = value(b);
            }
        }
    }
}
