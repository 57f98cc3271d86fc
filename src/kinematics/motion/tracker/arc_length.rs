//! Continuation from a pose at which no step in time is reliable: the path in arc length, with time as an additional unknown.
//!
//! At a fold the path is smooth in arc length, and time has an extremum along it; at an inflection such as that of
//! x³ = t the derivative of time vanishes for an instant. The bordered Jacobian, of the first singular block and time with the
//! tangent as its last row, is regular at both. (Keller's pseudo-arclength method: Allgower and Georg, Numerical
//! Continuation Methods, chapters 2 and 6.)

use super::path_tracker::{PathPoint, PathTracker};
use crate::kinematics::solve::newton::Pace;
use crate::linalg::pivoted_qr::PivotedQr;

/// First step, in scaled unknowns: smaller than the gap between two folds that face each other.
const FIRST_STEP: f64 = 1e-7;

/// A step that is refused at this length ends the path: a corner.
const SHORTEST_STEP: f64 = 1e-10;

/// Longest step, as long as a prediction along the drive may be off.
const LONGEST_STEP: f64 = 0.05;

/// Maximum number of steps: from the first to the longest one, and a few hundred of that length.
const MOST_STEPS: usize = 400;

/// A regular pose this far away has left the singular one behind.
const FAR_ENOUGH: f64 = 1e-2;

/// How far from a fold, in scaled unknowns, time is seen to be earlier on both sides: it changes with the square.
const BESIDE_FOLD: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// Maximum number of steps back to the near side of a fold, each twice as long.
const MOST_STEPS_BACK: usize = 12;

/// Smallest cosine between the tangents of neighbouring points: sharper turns are resolved by shorter steps.
const LEAST_COSINE: f64 = 0.95;

/// Largest correction of the pose at which steps in time ended.
const START_CORRECTION: f64 = 1e-5;

/// A correction may be this share of its step.
const CORRECTION_OF_STEP: f64 = 0.25;

/// Floor of the above: rounding.
const CORRECTION_FLOOR: f64 = 1e-13;

/// A change by this share of a step shorter than the second number is rounding between two folds that nearly meet.
const NOISE: f64 = 1e-3;
const NOISY: f64 = 1e-6;

/// Maximum number of iterations of a correction.
const MOST_ITERATIONS: usize = 8;

/// Maximum number of halvings that locate a fold, or an instant, between two points.
const MOST_HALVINGS: usize = 100;

/// Width of the last bracket in arc length: time is right to its square.
const LAST_WIDTH: f64 = 1e-12;

/// Time goes back along the path where its share of the unit tangent is below minus this: nearer to zero is rounding.
const BACKWARD: f64 = 1e-12;

/// Where the path leads.
#[derive(Clone, Debug)]
pub enum Onward {
    /// To this pose, later on the drive.
    Passed(PathPoint),
    /// To a fold, where the drive turns back along it.
    Fold(Fold),
    /// Nobody knows.
    Lost,
}

/// A fold with the path on both of its sides.
#[derive(Clone, Debug)]
pub struct Fold {
    /// The pose at the extremum of time.
    pub at: PathPoint,
    /// Coordinates of poses before and behind it in arc length.
    pub beside: [Vec<f64>; 2],
}

/// A point of the path with its tangent: the block's scaled unknowns, then time.
#[derive(Clone)]
struct ArcPoint {
    time: f64,
    coordinates: Vec<f64>,
    tangent: Vec<f64>,
}

/// A walk along the path.
struct ArcWalk<'t, 's> {
    tracker: &'t mut PathTracker<'s>,
    /// The singular block. Those before it follow time.
    block: usize,
    /// Seconds that count as one, negative on the way back.
    unit: f64,
    qr: PivotedQr,
    matrix: Vec<f64>,
    residual: Vec<f64>,
}

impl PathTracker<'_> {
    /// Follows the path from `end`, where steps in time ended, in the direction of `time`. What this tracker knows stays as
    /// it is.
    pub fn onward(&self, end: &PathPoint, time: f64) -> Onward {
        let chart = self.solver.chart();
        if time == end.time || chart.is_some_and(|c| c.is_needed(&end.coordinates)) {
            return Onward::Lost;
        }
        let mut scout = self.clone();
        let Some(block) = scout.weakest_block(end) else {
            return Onward::Lost;
        };
        // Pseudo-arclength continuation in the block that is about to lose its rank, with time as an unknown more.
        let mut walk = ArcWalk {
            unit: (time - end.time).signum() * self.interval,
            tracker: &mut scout,
            block,
            qr: PivotedQr::default(),
            matrix: Vec::new(),
            residual: Vec::new(),
        };
        walk.run(end, time).unwrap_or(Onward::Lost)
    }

    /// The block with the smallest singular value.
    fn weakest_block(&mut self, point: &PathPoint) -> Option<usize> {
        let blocks = 0..self.system().blocks().len();
        let sigma = blocks.filter_map(|block| {
            let sigma = self.solver.exact_sigma(&point.coordinates, block)?;
            (!self.system().blocks()[block].unknowns.is_empty()).then_some((block, sigma))
        });
        let least = sigma.min_by(|a, b| a.1.total_cmp(&b.1));
        least.map(|(block, _)| block)
    }
}

impl ArcWalk<'_, '_> {
    fn run(&mut self, end: &PathPoint, time: f64) -> Option<Onward> {
        let mut here = self.start(end)?;
        here = self.before_fold(here);
        let (mut step, mut gone) = (FIRST_STEP, 0.0);
        for _ in 0..MOST_STEPS {
            if !self.tracker.budget.take() || self.tracker.is_cancelled() {
                return None;
            }
            let Some(next) = self.step(&here, step) else {
                step *= 0.5;
                if step < SHORTEST_STEP {
                    return None;
                }
                continue;
            };
            gone += step;
            // Time turns back: a fold lies in this step.
            if self.speed(&next) <= -BACKWARD {
                let fold = self.extremum(&here, step)?;
                if self.is_reached(&fold, time) {
                    return self.at_time(&here, step, time);
                }
                return self.fold(end, fold);
            }
            if self.is_reached(&next, time) {
                return self.at_time(&here, step, time);
            }
            here = next;
            // Far enough behind the singular pose, and forward in time: the drive may lead again.
            if gone >= FAR_ENOUGH && (here.time - end.time) * self.unit > 0.0 {
                let found = self.closed(&here)?;
                if self.tracker.is_trusted(&found.branch) {
                    return Some(Onward::Passed(found));
                }
            }
            step = (2.0 * step).min(LONGEST_STEP);
        }
        None
    }

    /// The first point, with a tangent that continues from the last reliable pose, or forward in time if there is none.
    fn start(&mut self, end: &PathPoint) -> Option<ArcPoint> {
        let mut point = ArcPoint {
            time: end.time,
            coordinates: end.coordinates.to_vec(),
            tangent: Vec::new(),
        };
        let count = self.unknowns().len() + 1;
        // The tangent's own largest component makes the best border; it is not known yet.
        let mut best: Option<(f64, Vec<f64>)> = None;
        for k in 0..count {
            let border: Vec<f64> = (0..count).map(|i| f64::from(i == k)).collect();
            point.tangent = self.tangent(&point, &border)?;
            let pivot = self.qr.smallest_pivot();
            let is_regular = self.qr.rank() == count && point.tangent.iter().all(|v| v.is_finite());
            if is_regular && best.as_ref().is_none_or(|(least, _)| pivot > *least) {
                best = Some((pivot, point.tangent.clone()));
            }
        }
        point.tangent = best?.1;
        let guide = self.guide(end);
        let along: f64 = guide.iter().zip(&point.tangent).map(|(a, b)| a * b).sum();
        if along < 0.0 {
            point.tangent.iter_mut().for_each(|v| *v = -*v);
        }
        // Near a fold a pose can close within the tolerance although it is off the path.
        let on_path = self.step_within(&point, 0.0, START_CORRECTION);
        Some(on_path.unwrap_or(point))
    }

    /// A point from which time still increases: steps may have ended behind the fold, where poses close within the tolerance.
    fn before_fold(&mut self, mut here: ArcPoint) -> ArcPoint {
        let mut step = FIRST_STEP;
        for _ in 0..MOST_STEPS_BACK {
            if self.speed(&here) > BACKWARD {
                break;
            }
            // Steps backwards, each twice as long.
            let Some(before) = self.step(&here, -step) else {
                break;
            };
            here = before;
            step *= 2.0;
        }
        here
    }

    /// From the last trusted pose to the end of the steps.
    fn guide(&self, end: &PathPoint) -> Vec<f64> {
        let mechanism = self.tracker.system().mechanism();
        let anchor = self.tracker.anchor.as_ref().unwrap_or(end);
        let slots = self.unknowns().iter();
        let moved =
            slots.map(|s| (end.coordinates[*s] - anchor.coordinates[*s]) / mechanism.scale_of(*s));
        let mut guide: Vec<f64> = moved.collect();
        let still = guide.iter().all(|v| *v == 0.0);
        // The last entry is time, over the interval between samples.
        guide.push(if still {
            1.0
        } else {
            (end.time - anchor.time) / self.unit
        });
        guide
    }

    fn unknowns(&self) -> &[usize] {
        &self.tracker.system().blocks()[self.block].unknowns
    }

    /// The rate of time along the path.
    fn speed(&self, point: &ArcPoint) -> f64 {
        point.tangent.last().copied().unwrap_or(0.0)
    }

    fn is_reached(&self, point: &ArcPoint, time: f64) -> bool {
        (point.time - time) * self.unit >= 0.0
    }

    /// The next point at this distance, or none that can be trusted.
    fn step(&mut self, here: &ArcPoint, step: f64) -> Option<ArcPoint> {
        self.step_within(
            here,
            step,
            CORRECTION_OF_STEP * step.abs() + CORRECTION_FLOOR,
        )
    }

    /// The same, corrected by no more than `allowed`.
    fn step_within(&mut self, here: &ArcPoint, step: f64, allowed: f64) -> Option<ArcPoint> {
        let mut next = here.clone();
        self.move_by(&mut next, &here.tangent, step);
        let length = step.abs().max(FIRST_STEP);
        let mut last = allowed;
        let mut converged = false;
        for _ in 0..MOST_ITERATIONS {
            let change = self.change(&mut next, &here.tangent)?;
            let size = change.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            if size.is_nan() || size > last {
                return None;
            }
            self.move_by(&mut next, &change, 1.0);
            // The curvature of the path is bounded by its steps, so that no more than this remains.
            converged = size * size <= f64::EPSILON * length || size <= NOISE * length.min(NOISY);
            if converged {
                break;
            }
            last = 0.5 * size + f64::EPSILON;
        }
        if !converged {
            return None;
        }
        self.close_beside(&mut next)?;
        next.tangent = self.tangent(&next, &here.tangent)?;
        let cosine: f64 = here
            .tangent
            .iter()
            .zip(&next.tangent)
            .map(|(a, b)| a * b)
            .sum();
        (cosine >= LEAST_COSINE).then_some(next)
    }

    fn move_by(&self, point: &mut ArcPoint, direction: &[f64], factor: f64) {
        let mechanism = self.tracker.system().mechanism();
        for (slot, d) in self.unknowns().iter().zip(direction) {
            point.coordinates[*slot] += factor * d * mechanism.scale_of(*slot);
        }
        point.time += factor * direction.last().unwrap_or(&0.0) * self.unit;
    }

    /// Inputs at the point's time, and the blocks before the singular one closed there.
    fn drive(&mut self, point: &mut ArcPoint) -> Option<()> {
        let n = self.tracker.unknowns();
        let inputs = self.tracker.inputs(point.time).ok()?;
        point.coordinates[n..].copy_from_slice(&inputs);
        self.close(point, 0..self.block)
    }

    fn close(&mut self, point: &mut ArcPoint, blocks: std::ops::Range<usize>) -> Option<()> {
        for block in blocks {
            let solver = &mut self.tracker.solver;
            let correction = solver.correct_block(&mut point.coordinates, block, Pace::Brisk);
            if !correction.converged || correction.first_step > LONGEST_STEP {
                return None;
            }
        }
        Some(())
    }

    /// Closes all other blocks.
    fn close_beside(&mut self, point: &mut ArcPoint) -> Option<()> {
        self.drive(point)?;
        self.close(point, self.block + 1..self.tracker.system().blocks().len())
    }

    /// Linearises the block: the Jacobian with the derivative by time as its last column, over `border`.
    fn linearise(&mut self, point: &ArcPoint, border: &[f64]) {
        let mut rates = vec![0.0; self.tracker.unknowns()];
        rates.extend(self.tracker.actuation().rates_at(point.time));
        let solver = &mut self.tracker.solver;
        let linear = solver.along_drive(&point.coordinates, &mut rates, self.block);
        let rows = linear.residual.len();
        self.matrix.clear();
        // The derivative by time is one column more; the border a row more.
        let by_time: Vec<f64> = linear.drift[..rows].iter().map(|d| d * self.unit).collect();
        let columns = linear
            .jacobian
            .chunks_exact(rows.max(1))
            .chain([&by_time[..]]);
        for (column, last) in columns.zip(border) {
            self.matrix.extend_from_slice(column);
            self.matrix.push(*last);
        }
        self.residual.clear();
        self.residual.extend_from_slice(linear.residual);
        self.qr
            .factor(&self.matrix, rows + 1, border.len(), f64::EPSILON);
    }

    /// Newton's step back to the path, square to `border`.
    fn change(&mut self, point: &mut ArcPoint, border: &[f64]) -> Option<Vec<f64>> {
        self.drive(point)?;
        self.linearise(point, border);
        let mut right: Vec<f64> = self.residual.iter().map(|r| -r).collect();
        right.push(0.0);
        let mut change = vec![0.0; border.len()];
        self.qr.solve(&mut right, &mut change);
        Some(change)
    }

    /// The path's direction, which goes along with `border`.
    fn tangent(&mut self, point: &ArcPoint, border: &[f64]) -> Option<Vec<f64>> {
        self.linearise(point, border);
        let mut right = vec![0.0; self.residual.len()];
        right.push(1.0);
        let mut tangent = vec![0.0; border.len()];
        self.qr.solve(&mut right, &mut tangent);
        let length = tangent.iter().map(|v| v * v).sum::<f64>().sqrt();
        tangent.iter_mut().for_each(|v| *v /= length);
        Some(tangent)
    }

    /// The point between `here` and that at `step` where `value`, positive at first, becomes zero or less.
    fn bracket(
        &mut self,
        here: &ArcPoint,
        step: f64,
        value: impl Fn(&Self, &ArcPoint) -> f64,
    ) -> Option<ArcPoint> {
        let (mut low, mut high) = (0.0, step);
        let mut found = None;
        for _ in 0..MOST_HALVINGS {
            let middle = 0.5 * (low + high);
            let Some(point) = self.step(here, middle) else {
                break;
            };
            // Bisection in arc length; every trial is a corrected point of the path.
            let beyond = value(self, &point) <= 0.0;
            found = Some(point);
            if high - low <= LAST_WIDTH {
                break;
            }
            if beyond {
                high = middle;
            } else {
                low = middle;
            }
        }
        found
    }

    /// Where time has its extremum.
    fn extremum(&mut self, here: &ArcPoint, step: f64) -> Option<ArcPoint> {
        self.bracket(here, step, |walk, point| walk.speed(point))
    }

    /// The pose at `time`, which the path reaches within `step`.
    fn at_time(&mut self, here: &ArcPoint, step: f64, time: f64) -> Option<Onward> {
        let unit = self.unit;
        let point = self.bracket(here, step, |_, point| (time - point.time) * unit)?;
        let found = self
            .tracker
            .corrected(time, point.coordinates, Pace::Patient)?;
        Some(Onward::Passed(found))
    }

    /// The same point as a pose at its own time.
    fn closed(&mut self, point: &ArcPoint) -> Option<PathPoint> {
        let coordinates = point.coordinates.clone();
        self.tracker.corrected(point.time, coordinates, Pace::Brisk)
    }

    /// The fold, if time really has an extremum there: it is earlier on both sides.
    fn fold(&mut self, end: &PathPoint, fold: ArcPoint) -> Option<Onward> {
        let rounding = f64::EPSILON * (fold.time * self.unit).abs();
        let beside = BESIDE_FOLD.iter().find_map(|reach| {
            let sides = [self.step(&fold, -reach)?, self.step(&fold, *reach)?];
            // An extremum is later than the path on both sides, by more than rounding.
            let later = |side: &ArcPoint| (fold.time - side.time) * self.unit > 2.0 * rounding;
            let is_extremum = sides.iter().all(later);
            is_extremum.then(|| sides.map(|side| side.coordinates))
        })?;
        let is_later = (fold.time - end.time) * self.unit > 0.0;
        let at = PathPoint {
            time: if is_later { fold.time } else { end.time },
            coordinates: fold.coordinates.into(),
            branch: end.branch.clone(),
        };
        Some(Onward::Fold(Fold { at, beside }))
    }
}
