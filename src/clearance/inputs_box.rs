//! Clearances over a box of inputs: every pair at all values of two of them, not along one motion.
//!
//! The box is cut into strips across the second input. Along a strip the first input goes from end to end, and the second
//! one may be anywhere in the strip at every instant: the proofs of the motion take its play in, and so all that rests on
//! them. Strips that leave a pair open are halved.

use super::check::{ClearanceEffort, Judgement, PairReport, check_over};
use super::motion::ProvedMotion;
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::structure::system::System;
use crate::limits::search_deadline;
use crate::model::actuation::Actuation;
use crate::model::clearance::ClearanceRules;
use crate::numbers::rounding::GROW;

/// Strips to begin with.
const STRIPS: usize = 4;

/// How often a strip is halved.
const HALVINGS: u32 = 7;

/// Maximum number of strips examined; undecided ones are reported.
const MOST_STRIPS: usize = 600;

/// Samples along a strip.
const SAMPLES: usize = 41;

/// Pairs whose nearest pose is looked for beside the strips.
const MOST_DESCENTS: usize = 16;

/// Times that both inputs are moved, one after the other, to come nearer.
const ROUNDS: usize = 4;

/// A range of an input in internal units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputRange {
    /// Which input.
    pub input: usize,
    /// Lowest and highest value.
    pub range: [f64; 2],
}

/// A pair of bodies over the box.
#[derive(Clone, Debug)]
pub struct BoxPair {
    /// Indices of the bodies, ascending.
    pub pair: [usize; 2],
    /// Least distance that passes.
    pub minimum: f64,
    /// Least distance found, ...
    pub distance: f64,
    /// ... and the inputs there.
    pub inputs: Vec<f64>,
    /// Whether they must touch, everywhere.
    pub must_touch: bool,
    /// Where bodies that must touch were found farthest apart, and too far: the distance and the inputs there.
    pub parted: Option<(f64, Vec<f64>)>,
    /// Lower bound over the covered part of the box; minus infinity if unknown.
    pub bound: f64,
    /// A pose of the box breaks the minimum.
    pub is_broken: bool,
    /// Parts of the box, a range for each side, over which the minimum is not proved.
    pub uncovered: Vec<[[f64; 2]; 2]>,
}

/// What was found over a box.
#[derive(Clone, Debug, Default)]
pub struct BoxReport {
    /// The judged pairs.
    pub pairs: Vec<BoxPair>,
    /// Parts of the box to which no motion leads, or along which none could be followed.
    pub unreached: Vec<[[f64; 2]; 2]>,
    /// Parts that the time of the run was over for.
    pub late: Vec<[[f64; 2]; 2]>,
    /// Number of strips examined.
    pub strips: usize,
    /// Pairs that were wholly left out in a strip.
    left_out: Vec<([usize; 2], [[f64; 2]; 2])>,
}

/// A part of the box: a range of the second input, and the pairs that are open there; all at first.
struct Strip {
    range: [f64; 2],
    halvings: u32,
    open: Option<Vec<[usize; 2]>>,
}

/// Checks all pairs over the box of one or two inputs; the others rest where the drives begin.
pub fn check_box(
    system: &System,
    actuation: &Actuation,
    rules: &ClearanceRules,
    sides: [InputRange; 2],
    tolerance: f64,
) -> BoxReport {
    let [low, high] = sides[1].range;
    let edge = |k: usize| low + (high - low) * k as f64 / STRIPS as f64;
    // A second side without extent is one strip.
    let count = if low == high { 1 } else { STRIPS };
    let first = (0..count).map(|k| Strip {
        range: if count == 1 {
            [low, high]
        } else {
            [edge(k), edge(k + 1)]
        },
        halvings: 0,
        open: None,
    });
    let mut waiting: Vec<Strip> = first.collect();
    let mut report = BoxReport::default();
    let until = search_deadline();
    while let Some(strip) = waiting.pop() {
        if until.is_over() {
            report.give_up(&strip, sides[0].range);
            continue;
        }
        report.strips += 1;
        let is_last = report.strips + waiting.len() >= MOST_STRIPS
            || strip.halvings >= HALVINGS
            || low == high;
        let open = look(
            system,
            actuation,
            (rules, tolerance),
            sides,
            &strip,
            is_last,
            &mut report,
        );
        if let Some(open) = open {
            let middle = 0.5 * (strip.range[0] + strip.range[1]);
            let halves = [[strip.range[0], middle], [middle, strip.range[1]]];
            waiting.extend(halves.map(|range| Strip {
                range,
                halvings: strip.halvings + 1,
                open: Some(open.clone()),
            }));
        }
    }
    report.uncover_left_out();
    if sides[0].input != sides[1].input && low != high {
        descend(system, actuation, (rules, tolerance), sides, &mut report);
    }
    report
}

/// Looks for nearer poses than those in the middle of strips: along the edges of the box, and for every pair along lines through its
/// nearest pose, in turn in both directions.
fn descend(
    system: &System,
    actuation: &Actuation,
    (rules, tolerance): (&ClearanceRules, f64),
    sides: [InputRange; 2],
    report: &mut BoxReport,
) {
    let until = search_deadline();
    let look_along = |ends: [[f64; 2]; 2], report: &mut BoxReport| {
        let line = motion_between(system, actuation, sides, ends, 0.0);
        let Some((along, mut motion)) = line.filter(|_| !until.is_over()) else {
            return;
        };
        let found = check_over(
            &mut motion,
            rules,
            ClearanceEffort::to(tolerance),
            &|_, _| {},
        );
        let is_known = |pair: &&PairReport| report.pairs.iter().any(|p| p.pair == pair.pair);
        let judged: Vec<&PairReport> = found.judged.iter().filter(is_known).collect();
        for pair in judged {
            let known = report.note(pair, &along);
            known.is_broken |= pair.judgement == Judgement::Failed;
        }
    };
    let [first, second] = [sides[0].range, sides[1].range];
    for edge in second {
        look_along(first.map(|value| [value, edge]), report);
    }
    for index in 0..report.pairs.len().min(MOST_DESCENTS) {
        for round in 0..2 * ROUNDS {
            let before = report.pairs[index].distance;
            let here = sides.map(|side| report.pairs[index].inputs.get(side.input).copied());
            let [Some(a), Some(b)] = here else { break };
            let ends = match round % 2 {
                0 => second.map(|value| [a, value]),
                _ => first.map(|value| [value, b]),
            };
            look_along(ends, report);
            if round > 0 && report.pairs[index].distance >= before {
                break;
            }
        }
    }
}

/// Looks at one strip; the pairs for which it is to be halved, if that is so.
fn look(
    system: &System,
    actuation: &Actuation,
    (rules, tolerance): (&ClearanceRules, f64),
    sides: [InputRange; 2],
    strip: &Strip,
    is_last: bool,
    report: &mut BoxReport,
) -> Option<Vec<[usize; 2]>> {
    let whole = [sides[0].range, strip.range];
    let Some((along, mut motion)) = motion_along(system, actuation, sides, strip.range) else {
        if is_last {
            report.unreached.push(whole);
            return None;
        }
        return Some(strip.open.clone().unwrap_or_default());
    };
    let gaps = motion.gaps.clone();
    let closely = ClearanceEffort {
        pairs: usize::MAX,
        ..ClearanceEffort::to(tolerance)
    };
    let found = check_over(&mut motion, rules, closely, &|_, _| {});
    // Empty after a strip that was not reached: all pairs then.
    let wanted = strip.open.as_ref().filter(|open| !open.is_empty());
    let is_judged = |pair: &[usize; 2]| found.judged.iter().any(|judged| judged.pair == *pair);
    let out = found.excluded.iter().map(|report| report.pair);
    let out =
        out.filter(|pair| !is_judged(pair) && wanted.is_none_or(|wanted| wanted.contains(pair)));
    report.left_out.extend(out.map(|pair| (pair, whole)));
    let mut open = Vec::new();
    for pair in &found.judged {
        if wanted.is_some_and(|wanted| !wanted.contains(&pair.pair)) {
            continue;
        }
        let is_open = !matches!(pair.judgement, Judgement::Passed | Judgement::Failed);
        let known = report.note(pair, &along);
        if pair.judgement == Judgement::Failed {
            known.is_broken = true;
            // What was found counts; of depths, and where the motion has gaps, nothing is proved.
            let bound = Some(pair.least.bound).filter(|_| pair.least.is_certified);
            known.bound = known.bound.min(bound.unwrap_or(f64::NEG_INFINITY));
        } else if is_open && is_last {
            known.uncovered.push(whole);
        } else if is_open && !known.is_broken {
            open.push(pair.pair);
        } else {
            known.bound = known.bound.min(pair.least.bound);
        }
    }
    if is_last {
        let value = |time: f64| along.inputs_at(time)[sides[0].input];
        let missing = gaps.iter().map(|gap| [gap.map(value), strip.range]);
        report.unreached.extend(missing);
        return None;
    }
    (!open.is_empty() || !gaps.is_empty()).then_some(open)
}

impl BoxReport {
    /// Every pair keeps its minimum, proved over the whole box.
    pub fn is_kept(&self) -> bool {
        let kept = |pair: &BoxPair| !pair.is_broken && pair.uncovered.is_empty();
        let is_covered = self.unreached.is_empty() && self.late.is_empty();
        is_covered && self.pairs.iter().all(kept)
    }

    /// A strip for which no time is left: it stays undecided.
    fn give_up(&mut self, strip: &Strip, along: [f64; 2]) {
        let whole = [along, strip.range];
        let open = strip.open.as_ref().filter(|open| !open.is_empty());
        let Some(open) = open else {
            self.late.push(whole);
            return;
        };
        for known in self.pairs.iter_mut().filter(|p| open.contains(&p.pair)) {
            known.uncovered.push(whole);
        }
    }

    /// What is judged in one strip and wholly left out in another one is not known there.
    fn uncover_left_out(&mut self) {
        for (pair, strip) in &self.left_out {
            let known = self.pairs.iter_mut().find(|known| known.pair == *pair);
            if let Some(known) = known.filter(|known| !known.uncovered.contains(strip)) {
                known.uncovered.push(*strip);
            }
        }
    }

    /// Takes in what a strip says of a pair.
    fn note(&mut self, pair: &PairReport, along: &Actuation) -> &mut BoxPair {
        let known = self.pairs.iter().position(|known| known.pair == pair.pair);
        let index = known.unwrap_or_else(|| {
            self.pairs.push(BoxPair {
                pair: pair.pair,
                minimum: pair.minimum,
                distance: f64::INFINITY,
                inputs: Vec::new(),
                must_touch: pair.touching.is_some(),
                parted: None,
                bound: f64::INFINITY,
                is_broken: false,
                uncovered: Vec::new(),
            });
            self.pairs.len() - 1
        });
        let known = &mut self.pairs[index];
        if pair.least.distance < known.distance {
            known.distance = pair.least.distance;
            known.inputs = along.inputs_at(pair.least.time);
        }
        let farthest = known.parted.as_ref().map_or(0.0, |(distance, _)| *distance);
        if let Some(apart) = pair.parted().filter(|apart| apart.distance > farthest) {
            known.parted = Some((apart.distance, along.inputs_at(apart.time)));
        }
        known
    }
}

/// The motion along the middle of a strip, with the strip's width as play of the second input.
fn motion_along<'m>(
    system: &'m System,
    actuation: &Actuation,
    sides: [InputRange; 2],
    range: [f64; 2],
) -> Option<(Actuation, ProvedMotion<'m>)> {
    let middle = 0.5 * (range[0] + range[1]);
    let [from, to] = sides[0].range.map(|value| [value, middle]);
    // The second input may be anywhere in the strip at every instant.
    let half = 0.5 * (range[1] - range[0]) * GROW;
    motion_between(system, actuation, sides, [from, to], half)
}

/// The motion along a straight line of the box, with the play of the second input. Its beginning is reached straight from where the
/// drives begin.
fn motion_between<'m>(
    system: &'m System,
    actuation: &Actuation,
    sides: [InputRange; 2],
    ends: [[f64; 2]; 2],
    half: f64,
) -> Option<(Actuation, ProvedMotion<'m>)> {
    let start = actuation.inputs_at(0.0);
    let [from, to] = ends.map(|[first, second]| {
        let mut inputs = start.clone();
        inputs[sides[1].input] = second;
        inputs[sides[0].input] = first;
        inputs
    });
    let first = solve_motion(system, actuation, &[0.0])
        .samples
        .into_iter()
        .next()?
        .pose?;
    let assembled = [first.unknowns.as_slice(), &start].concat();
    let way = Actuation::straight(&start, &from, first.unknowns);
    let reached = solve_motion(system, &way, &[0.0, 1.0])
        .samples
        .into_iter()
        .nth(1)?
        .pose?;
    let along = Actuation::straight(&from, &to, reached.unknowns);
    let times: Vec<f64> = (0..SAMPLES)
        .map(|k| k as f64 / (SAMPLES - 1) as f64)
        .collect();
    let trajectory = solve_motion(system, &along, &times);
    let mut play = vec![0.0; start.len()];
    if sides[0].input != sides[1].input {
        play[sides[1].input] = half;
    }
    let motion = ProvedMotion::with_play(system, &along, &trajectory, play);
    Some((along, motion.assembled_at(assembled)))
}
