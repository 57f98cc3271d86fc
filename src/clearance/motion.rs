//! The motion between the samples: poses at any time on the branch of the samples, in stretches over which the rate of
//! every joint is bounded.
//!
//! A stretch is proved when the unknowns provably stay in a ball around its middle pose in which no other pose
//! closes, and the poses at both its ends lie in that ball: then they belong to the same motion. Where nothing can be
//! proved (general formulas, singular poses) the rates are estimated from differences, and are said to be.

use super::drive_rate;
use crate::kinematics::branch::BranchWatch;
use crate::kinematics::certificate::Certifier;
use crate::kinematics::certificate::flow::Drift;
use crate::kinematics::continuation::solve;
use crate::kinematics::forward::body_poses;
use crate::kinematics::newton::{Corrector, Pace};
use crate::kinematics::structure::{Structure, StructureError};
use crate::math::Pose;
use crate::model::chain::{Argument, ArgumentValue};
use crate::model::expression::Affine;
use crate::model::mechanism::Mechanism;

/// After a proof one of this many times the length is tried.
const GROWTH: f64 = 2.5;

/// How often a stretch is halved for the sake of a proof before its rates are estimated.
const MAX_DEPTH: u32 = 10;

/// Most stretches of one motion; bounds are as good as they are by then.
const MAX_SPANS: usize = 60_000;

/// Times nearer than this (relative to the duration) are one.
const SAME_TIME: f64 = 1e-12;

/// Inputs that agree within this part of their value do not jump.
const SAME_INPUT: f64 = 1e-9;

/// Estimated rates may differ from the mean rate by this times the difference that three poses show ...
const ESTIMATE_FACTOR: f64 = 2.0;

/// ... plus this part of the rate.
const ESTIMATE_SHARE: f64 = 0.1;

/// A pose at a time.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Seconds.
    pub time: f64,
    /// Unknowns, then inputs.
    pub coordinates: Vec<f64>,
    /// `world_from_body` of every body.
    pub bodies: Vec<Pose>,
    /// Values of all arguments.
    pub arguments: Vec<ArgumentValue>,
}

/// A stretch of time between two poses.
#[derive(Clone, Debug)]
pub struct Span {
    /// Index of the pose at its start.
    pub start: usize,
    /// Index of the pose at its end.
    pub end: usize,
    /// Index of the pose in the middle.
    pub middle: usize,
    /// Half its length in seconds.
    pub half: f64,
    /// Drift of every argument.
    pub arguments: Vec<Drift>,
    /// The drifts are proved.
    pub is_certified: bool,
    /// Halving it could make it provable.
    pub wants_halving: bool,
    depth: u32,
    /// First of its two halves, once made.
    halves: Option<usize>,
}

/// The motion of a mechanism over its drive.
pub struct Motion<'m> {
    /// Whose motion.
    pub mechanism: &'m Mechanism,
    structure: &'m Structure,
    corrector: Corrector,
    certifier: Certifier<'m>,
    bases: Vec<Vec<usize>>,
    can_be_proved: bool,
    /// Stretches of half this length or less are likely to be proved: no others are tried.
    provable: f64,
    /// All poses solved.
    pub instants: Vec<Instant>,
    /// Indices of the poses at the sampled times.
    pub samples: Vec<usize>,
    /// All stretches; the first ones cover the motion.
    pub spans: Vec<Span>,
    /// How many of them do.
    pub roots: usize,
    /// Stretches between samples that could not be followed, as times.
    pub gaps: Vec<[f64; 2]>,
}

/// The given times, the ends of the drive, and every key of an input, ascending.
fn knots(mechanism: &Mechanism, times: &[f64]) -> Vec<f64> {
    let last = mechanism.duration;
    let breaks = mechanism
        .drives
        .iter()
        .flat_map(drive_rate::breaks)
        .copied();
    let mut all: Vec<f64> = times
        .iter()
        .copied()
        .chain(breaks)
        .chain([0.0, last])
        .collect();
    all.retain(|t| (0.0..=last).contains(t));
    all.sort_by(f64::total_cmp);
    all.dedup_by(|b, a| *b - *a <= SAME_TIME * last);
    all
}

impl<'m> Motion<'m> {
    /// Solves the motion at the given times and covers it with stretches.
    ///
    /// # Errors
    /// Only where the mechanism itself is ill-posed; gaps are in `gaps`.
    pub fn new(
        mechanism: &'m Mechanism,
        structure: &'m Structure,
        times: &[f64],
    ) -> Result<Self, StructureError> {
        let trajectory = solve(mechanism, &knots(mechanism, times))?;
        let mut motion = Self {
            mechanism,
            structure,
            corrector: Corrector::new(structure),
            certifier: Certifier::new(mechanism, structure),
            bases: Vec::new(),
            can_be_proved: false,
            provable: f64::INFINITY,
            instants: Vec::new(),
            samples: Vec::new(),
            spans: Vec::new(),
            roots: 0,
            gaps: Vec::new(),
        };
        let mut last: Option<(usize, f64)> = None;
        let mut pairs = Vec::new();
        for sample in &trajectory.samples {
            let here = sample.pose.as_ref().map(|pose| {
                let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
                motion.instant(sample.time, coordinates)
            });
            match (last, here) {
                (Some((before, _)), Some(index)) => pairs.push([before, index]),
                (Some((_, time)), None) => motion.gaps.push([time, sample.time]),
                (None, _) => {}
            }
            motion.samples.extend(here);
            last = here.map(|index| (index, sample.time));
        }
        if let Some(&first) = motion.samples.first() {
            motion.fix_bases(first);
        }
        for [start, end] in pairs {
            motion.add_span(start, end, 0);
        }
        motion.roots = motion.spans.len();
        Ok(motion)
    }

    fn fix_bases(&mut self, first: usize) {
        let mut watch = BranchWatch::default();
        let coordinates = &self.instants[first].coordinates;
        watch.observe(
            self.mechanism,
            self.structure,
            &mut self.corrector,
            coordinates,
        );
        self.bases = watch.bases().to_vec();
        // Formulas are refused at every pose; then there is no use in halving.
        let affine = |a: &Argument| match a {
            Argument::Affine(_) => true,
            Argument::Formula(e) => e.affine().is_some(),
        };
        self.can_be_proved = self.mechanism.arguments.iter().all(affine)
            && self
                .mechanism
                .equations
                .iter()
                .all(|e| e.expression.affine().is_some());
    }

    fn instant(&mut self, time: f64, coordinates: Vec<f64>) -> usize {
        self.instants.push(Instant {
            time,
            bodies: body_poses(self.mechanism, &coordinates),
            arguments: self.mechanism.argument_values(&coordinates),
            coordinates,
        });
        self.instants.len() - 1
    }

    /// Solves the middle of a stretch; a stretch whose middle cannot be solved is a gap.
    fn add_span(&mut self, start: usize, end: usize, depth: u32) -> Option<usize> {
        let (t0, t1) = (self.instants[start].time, self.instants[end].time);
        let time = 0.5 * (t0 + t1);
        let n = self.mechanism.unknowns.len();
        let (a, b) = (&self.instants[start], &self.instants[end]);
        let mut coordinates: Vec<f64> = a
            .coordinates
            .iter()
            .zip(&b.coordinates)
            .map(|(p, q)| 0.5 * (p + q))
            .collect();
        coordinates[n..].copy_from_slice(&self.mechanism.inputs_at(time));
        let finite = coordinates.iter().all(|v| v.is_finite());
        let closed = finite
            && self
                .corrector
                .correct(
                    self.mechanism,
                    self.structure,
                    &mut coordinates,
                    Pace::Brisk,
                )
                .converged;
        if !closed {
            self.gaps.push([t0, t1]);
            return None;
        }
        let middle = self.instant(time, coordinates);
        let half = 0.5 * (t1 - t0);
        let may_halve = self.can_be_proved && depth < MAX_DEPTH;
        let proved = if half <= self.provable || !may_halve {
            self.prove([start, middle, end], half)
        } else {
            None
        };
        self.provable = match proved {
            Some(_) => self.provable.max(GROWTH * half),
            None => self.provable.min(half),
        };
        self.spans.push(Span {
            start,
            end,
            middle,
            half,
            is_certified: proved.is_some(),
            wants_halving: proved.is_none() && may_halve,
            arguments: proved.unwrap_or_else(|| self.estimate([start, middle, end], half)),
            depth,
            halves: None,
        });
        Some(self.spans.len() - 1)
    }

    /// Proved drifts of all arguments; `None` if there is no proof.
    fn prove(&mut self, [start, middle, end]: [usize; 3], half: f64) -> Option<Vec<Drift>> {
        if !self.can_be_proved {
            return None;
        }
        let (from, to) = (self.instants[start].time, self.instants[end].time);
        let drives = self.mechanism.drives.iter();
        let inputs: Vec<Drift> = drives
            .map(|drive| drive_rate::drift(drive, from, to))
            .collect::<Option<_>>()?;
        let here = &self.instants[middle].coordinates;
        let drifts = self.certifier.drift(here, &self.bases, &inputs, half)?;
        let n = self.mechanism.unknowns.len();
        for (other, way) in [(start, -half), (end, half)] {
            let there = &self.instants[other].coordinates;
            let off = |k: usize| (there[k] - here[k] - drifts[k].rate * way).abs();
            // A step of the drive at the end of the stretch is not part of its motion.
            let still = |k: usize| 2.0 * drifts[k].play + SAME_INPUT * there[k].abs().max(1e-3);
            let jumps = (n..there.len()).any(|k| off(k) > still(k));
            if !jumps && (0..n).any(|k| off(k) > drifts[k].tube) {
                return None;
            }
        }
        let of_argument = |argument: &Argument| {
            let affine = match argument {
                Argument::Affine(affine) => affine.clone(),
                Argument::Formula(expression) => expression.affine()?,
            };
            Some(of_affine(&affine, &drifts))
        };
        self.mechanism.arguments.iter().map(of_argument).collect()
    }

    /// Drifts from the differences of three poses, with a factor for what they do not show.
    fn estimate(&self, three: [usize; 3], half: f64) -> Vec<Drift> {
        let [a, b, c] = three.map(|k| &self.instants[k].arguments);
        let of = |k: usize| {
            let rate = (c[k].value - a[k].value) / (2.0 * half);
            let bend = (c[k].value - 2.0 * b[k].value + a[k].value).abs() / half;
            let deviation = ESTIMATE_FACTOR * bend + ESTIMATE_SHARE * rate.abs();
            Drift {
                rate,
                deviation,
                play: (rate.abs() + deviation) * half,
                tube: f64::INFINITY,
            }
        };
        (0..a.len()).map(of).collect()
    }

    /// The halves of a stretch; `None` when there are too many stretches, or its halves cannot be solved.
    pub fn halves(&mut self, span: usize) -> Option<[usize; 2]> {
        if let Some(first) = self.spans[span].halves {
            return Some([first, first + 1]);
        }
        if self.spans.len() >= MAX_SPANS {
            return None;
        }
        let Span {
            start,
            middle,
            end,
            depth,
            ..
        } = self.spans[span];
        let first = self.add_span(start, middle, depth + 1)?;
        let second = self.add_span(middle, end, depth + 1)?;
        self.spans[span].halves = Some(first);
        Some([first, second])
    }
}

fn of_affine(affine: &Affine, drifts: &[Drift]) -> Drift {
    let mut sum = Drift::default();
    for &(slot, c) in &affine.terms {
        let drift = &drifts[slot];
        sum.rate += c * drift.rate;
        sum.deviation += c.abs() * drift.deviation;
        sum.play += c.abs() * drift.play;
    }
    sum
}
