//! Closed poses near known ones: predicted, corrected, observed. Everything that follows a motion, varies dimensions or
//! examines the times between two samples uses it, with one rule for the steps that may be trusted.
//!
//! Near a pose where a ball joint is in gimbal lock everything is solved in a [`BallChart`]; the scene's angles are
//! computed from the result.

use super::along_drive::AlongDrive;
use super::assembly::{Assembled, NotClosed, assemble_pose};
use super::between::KeptJacobians;
use super::branch::{BranchState, BranchWatch, best_rows};
use super::newton::{Correction, Corrector, Pace};
use super::predictor::{HIGHEST_ORDER, Prediction, Predictor};
use super::wishes::assemble_as_meant;
use crate::kinematics::ball::chart::BallChart;
use crate::kinematics::structure::system::System;

/// Largest correction of a prediction, in scaled unknowns. A larger one could have reached another branch.
pub const MAX_CORRECTION: f64 = 0.05;

/// A correction may be this fraction of the predicted step (plus a floor for tiny steps): the tangent is then a good
/// approximation of the path.
const CORRECTION_OF_STEP: f64 = 0.25;

/// Floor of the above: corrections of this size are rounding at a badly conditioned pose.
const CORRECTION_FLOOR: f64 = 1e-9;

/// Shortest step along a way, as a fraction of it.
const SHORTEST_PART: f64 = 1.0 / 1024.0;

/// Solves poses of one system; one per thread.
#[derive(Clone, Debug)]
pub struct PoseSolver<'s> {
    system: &'s System,
    /// `None` without ball joints.
    chart: Option<BallChart<'s>>,
    corrector: Corrector,
    predictor: Predictor,
    watch: BranchWatch,
    kept: KeptJacobians,
    /// The rows with which the last pose is to be proved, if a block has a choice.
    chosen: Option<Vec<Vec<usize>>>,
    /// Newton iterations so far.
    pub iterations: u32,
}

/// Whether a corrected prediction is consistent with the tangent of the path: the correction and the deviation of the
/// prediction from the tangent are small compared with the step.
pub fn follows_prediction(correction: &Correction, prediction: &Prediction) -> bool {
    let off = correction.first_step + prediction.bend;
    correction.converged && off <= largest_correction(prediction.length)
}

/// The largest accepted correction of a prediction this far along the tangent, in scaled unknowns.
pub fn largest_correction(length: f64) -> f64 {
    (CORRECTION_OF_STEP * length + CORRECTION_FLOOR).min(MAX_CORRECTION)
}

impl<'s> PoseSolver<'s> {
    /// Buffers for `system`.
    pub fn new(system: &'s System) -> Self {
        Self {
            system,
            chart: BallChart::new(system),
            corrector: Corrector::new(system),
            predictor: Predictor::default(),
            watch: BranchWatch::default(),
            kept: KeptJacobians::default(),
            chosen: None,
            iterations: 0,
        }
    }

    /// The system whose poses are solved.
    pub fn system(&self) -> &'s System {
        self.system
    }

    /// The other description of its ball joints; `None` if it has none.
    pub fn chart(&self) -> Option<BallChart<'s>> {
        self.chart
    }

    /// The chart, if the scene's angles are bad coordinates.
    fn chart_at(&self, coordinates: &[f64]) -> Option<BallChart<'s>> {
        self.chart.filter(|c| c.is_needed(coordinates))
    }

    /// Assembles from the scene's angles and, if that fails, in the chart. If unknowns are `named`, their start values
    /// are tried exactly and from perturbed starts, too.
    ///
    /// # Errors
    /// The pose with the smallest closure error.
    pub fn assembled(
        &mut self,
        start: &[f64],
        named: Option<&[bool]>,
    ) -> Result<Assembled, NotClosed> {
        let found = match named {
            Some(named) => assemble_as_meant(self.system, &mut self.corrector, start, named),
            None => assemble_pose(self.system, &mut self.corrector, start, false),
        };
        let Some(chart) = self.chart else {
            return found;
        };
        let mut found = match found {
            Ok(found) => found,
            Err(gap) => {
                let own = chart.base(start);
                let mut corrector = Corrector::new(chart.system);
                let again = assemble_pose(chart.system, &mut corrector, &own, named.is_some());
                let again = again.map_err(|_| gap)?;
                let coordinates = chart.scene(&again.coordinates, start);
                Assembled {
                    coordinates,
                    ..again
                }
            }
        };
        // Angles that converge to a locked pose lose half of their digits.
        if chart.is_needed(&found.coordinates) {
            let correction = self.correct(&mut found.coordinates, Pace::Patient);
            found.iterations += correction.iterations;
        }
        Ok(found)
    }

    /// Corrects the unknowns until all loops close; the inputs stay.
    pub fn correct(&mut self, coordinates: &mut [f64], pace: Pace) -> Correction {
        let correction = match self.chart_at(coordinates) {
            None => self.corrector.correct(self.system, coordinates, pace),
            Some(chart) => {
                // Near a gimbal lock: to the chart's coordinates, Newton there, and back to the nearest angles.
                let mut own = chart.base(coordinates);
                let mut corrector = Corrector::new(chart.system);
                let correction = corrector.correct(chart.system, &mut own, pace);
                let found = chart.scene(&own, coordinates);
                coordinates.copy_from_slice(&found);
                correction
            }
        };
        self.iterations += correction.iterations;
        correction
    }

    /// Prediction at new inputs from a closed pose: the tangent, or a polynomial of higher order.
    pub fn predict(
        &mut self,
        from: &[f64],
        inputs: &[f64],
        order: usize,
    ) -> (Vec<f64>, Prediction) {
        if let Some(chart) = self.chart_at(from) {
            return predict_in(chart, from, inputs);
        }
        let mut coordinates = from.to_vec();
        let (corrector, place) = (&mut self.corrector, &mut coordinates);
        let prediction = self
            .predictor
            .predict(self.system, corrector, place, inputs, order);
        (coordinates, prediction)
    }

    /// One step to new inputs: predicted, corrected, and rejected if the correction is not small compared with the
    /// step.
    pub fn step(&mut self, from: &[f64], inputs: &[f64], order: usize) -> Option<Vec<f64>> {
        let (mut coordinates, mut prediction) = self.predict(from, inputs, order);
        if !(prediction.length + prediction.bend).is_finite() {
            prediction = self.without_tangent(from, &mut coordinates);
        }
        let correction = self.correct(&mut coordinates, Pace::Brisk);
        follows_prediction(&correction, &prediction).then_some(coordinates)
    }

    /// Replaces the unknowns of a prediction that have no tangent, as at the kink of a length at zero, by those of the pose
    /// itself.
    fn without_tangent(&self, from: &[f64], predicted: &mut [f64]) -> Prediction {
        let mechanism = self.system.mechanism();
        let mut length: f64 = 0.0;
        let own = predicted.iter_mut().zip(from).enumerate();
        for (k, (predicted, from)) in own.take(mechanism.unknowns.len()) {
            match predicted.is_finite() {
                true => length = length.max((*predicted - from).abs() / mechanism.scale_of(k)),
                false => *predicted = *from,
            }
        }
        Prediction { length, bend: 0.0 }
    }

    /// The closed pose at `inputs` that is corrected from the straight line between two others, at the fraction
    /// `share`.
    pub fn between(
        &mut self,
        [a, b]: [&[f64]; 2],
        share: f64,
        inputs: &[f64],
        pace: Pace,
    ) -> Option<Vec<f64>> {
        let unknowns = self.system.mechanism().unknowns.len();
        let pairs = a.iter().zip(b).take(unknowns);
        let mut coordinates: Vec<f64> = pairs.map(|(a, b)| a + share * (b - a)).collect();
        coordinates.extend(inputs);
        self.closed(&mut coordinates, pace).then_some(coordinates)
    }

    /// The same between coordinates with their inputs, unless a determinant has another sign there than at both ends: the
    /// correction may lead to another assembly, where a drive goes far between them.
    pub fn between_on_branch(
        &mut self,
        ends: [&[f64]; 2],
        share: f64,
        inputs: &[f64],
        pace: Pace,
    ) -> Option<Vec<f64>> {
        let found = self.between(ends, share, inputs, pace)?;
        let [a, b] = ends.map(|end| self.observe(end).signs);
        let is_other = |(a, b): (&i8, &i8)| a * b < 0;
        let turns = a == b && a.iter().zip(&self.observe(&found).signs).any(is_other);
        (!turns).then_some(found)
    }

    /// Follows the motion from a closed pose in steps that are halved where they cannot be trusted, along `inputs` as a
    /// function of the fraction 0 to 1.
    pub fn followed(
        &mut self,
        unknowns: &[f64],
        inputs: impl Fn(f64) -> Vec<f64>,
    ) -> Option<Vec<f64>> {
        let mut here = [unknowns, &inputs(0.0)].concat();
        let (mut part, mut step) = (0.0, 0.5);
        while part < 1.0 {
            let next = f64::min(part + step, 1.0);
            // A trusted step is kept; one that is not is tried at half its length.
            match self.step(&here, &inputs(next), HIGHEST_ORDER) {
                Some(pose) => (here, part) = (pose, next),
                None => step *= 0.5,
            }
            if step < SHORTEST_PART {
                return None;
            }
        }
        Some(here)
    }

    /// Corrects `coordinates`; whether that closed them.
    pub fn closed(&mut self, coordinates: &mut [f64], pace: Pace) -> bool {
        coordinates.iter().all(|v| v.is_finite()) && self.correct(coordinates, pace).converged
    }

    /// Corrects one block, the ones before it being closed.
    pub fn correct_block(
        &mut self,
        coordinates: &mut [f64],
        block: usize,
        pace: Pace,
    ) -> Correction {
        let corrector = &mut self.corrector;
        let correction = corrector.correct_block(self.system, block, coordinates, pace);
        self.iterations += correction.iterations;
        correction
    }

    /// Linearises one block along the drive, with the rates of the inputs in the tail of `rates`.
    pub fn along_drive(
        &mut self,
        coordinates: &[f64],
        rates: &mut [f64],
        block: usize,
    ) -> AlongDrive<'_> {
        self.corrector
            .along_drive(self.system, block, coordinates, rates)
    }

    /// Rates of the unknowns for the rates of the inputs in the tail of `rates`. Those of gimbal-locked angles are NaN.
    pub fn tangent(&mut self, coordinates: &[f64], rates: &mut [f64]) {
        let Some(chart) = self.chart_at(coordinates) else {
            return self.corrector.tangent(self.system, coordinates, rates);
        };
        let own = chart.base(coordinates);
        let mut own_rates = rates.to_vec();
        // The base pose of the chart is constant.
        own_rates.resize(own.len(), 0.0);
        Corrector::new(chart.system).tangent(chart.system, &own, &mut own_rates);
        rates.copy_from_slice(&own_rates[..rates.len()]);
        chart.scene_rates(coordinates, rates);
    }

    /// Singular values and signs with ball joints as rotations: signs of angles do not matter, nor do singularities of
    /// angles near locked poses.
    pub fn observe(&mut self, coordinates: &[f64]) -> BranchState {
        if let Some(chart) = self.chart_at(coordinates) {
            let own = chart.base(coordinates);
            let mut corrector = Corrector::new(chart.system);
            return self.watch.observe(chart.system, &mut corrector, &own);
        }
        let mut state = self.observe_angles(coordinates);
        // The sign of a ball joint's angle map is taken out of its block's determinant.
        for ball in self.system.balls() {
            state.signs[ball.block] *= ball.orientation(coordinates);
        }
        state
    }

    /// Signs and singular values of the scene's own coordinates.
    fn observe_angles(&mut self, coordinates: &[f64]) -> BranchState {
        let corrector = &mut self.corrector;
        self.watch.observe(self.system, corrector, coordinates)
    }

    /// Stores the Jacobians of a closed pose for [`stays_regular`](Self::stays_regular) on the next step.
    pub fn keep_jacobians(&mut self, coordinates: &[f64]) {
        if self.chart_at(coordinates).is_none() {
            self.kept
                .keep(self.system, &mut self.corrector, coordinates);
        }
    }

    /// Whether no block becomes singular on a step from one regular pose to another, as far as their Jacobians tell; the
    /// smallest singular values of the two are added in `sigmas`.
    pub fn stays_regular(&mut self, [from, to]: [&[f64]; 2], sigmas: f64) -> bool {
        let chart = self.chart_at(from).or_else(|| self.chart_at(to));
        let Some(chart) = chart else {
            return (self.kept).stay_regular(self.system, &mut self.corrector, [from, to], sigmas);
        };
        let own = [from, to].map(|pose| chart.base(pose));
        let mut corrector = Corrector::new(chart.system);
        let ends = [&own[0][..], &own[1]];
        KeptJacobians::default().stay_regular(chart.system, &mut corrector, ends, sigmas)
    }

    /// Has the rows of over-determined blocks replaced where they are worn out.
    pub fn renew_rows(&mut self, coordinates: &[f64]) {
        if self.chart.is_none() {
            let corrector = &mut self.corrector;
            self.watch.renew_rows(self.system, corrector, coordinates);
        }
    }

    /// The rows of every block that are the most independent at a pose.
    pub fn best_rows(&mut self, coordinates: &[f64]) -> Vec<Vec<usize>> {
        best_rows(self.system, &mut self.corrector, coordinates)
    }

    /// Linearises at a pose that is to be proved: the rows that each block is proved on, and the inverses that serve it.
    pub fn proof_basis(&mut self, coordinates: &[f64]) -> (&[Vec<usize>], &Corrector) {
        if self.chart_at(coordinates).is_some() {
            // The pose was observed in the chart; the proof is about the scene's angles.
            self.observe_angles(coordinates);
        }
        let mut blocks = self.system.blocks().iter();
        // The rows of the signs stay as long as they serve: a proof on them may be many times too loose.
        self.chosen = blocks
            .any(|b| b.rows() > b.unknowns.len())
            .then(|| self.best_rows(coordinates));
        // Other poses may have been evaluated since this one was observed.
        self.corrector.prepare(self.system, coordinates);
        let rows = self.chosen.as_deref();
        (rows.unwrap_or(self.watch.bases()), &self.corrector)
    }

    /// Smallest singular value of a block to all digits: those of every pose are iterated, to a millionth. `None` where
    /// the scene's angles are bad coordinates.
    pub fn exact_sigma(&mut self, coordinates: &[f64], block: usize) -> Option<f64> {
        if self.chart_at(coordinates).is_some() {
            return None;
        }
        let system = self.system;
        let (rows, columns) = (
            system.blocks()[block].rows(),
            system.blocks()[block].unknowns.len(),
        );
        let mut sigma = None;
        self.corrector
            .conditions(system, coordinates, |index, jacobian, _, _| {
                if index == block {
                    sigma = Some(
                        crate::linalg::svd::jacobian_conditioning(jacobian, rows, columns)
                            .sigma_min,
                    );
                }
            });
        sigma
    }

    /// Largest difference of two poses in scaled unknowns.
    pub fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        let mechanism = self.system.mechanism();
        let pairs = a.iter().zip(b).take(mechanism.unknowns.len()).enumerate();
        let scaled = pairs.map(|(k, (a, b))| (a - b).abs() / mechanism.scale_of(k));
        scaled.fold(0.0, f64::max)
    }
}

/// The tangent in the chart: new coordinates and the length of the step.
fn predict_in(chart: BallChart, from: &[f64], inputs: &[f64]) -> (Vec<f64>, Prediction) {
    let mechanism = chart.system.mechanism();
    let n = mechanism.unknowns.len();
    let own = chart.base(from);
    let mut change = vec![0.0; own.len()];
    for (k, input) in inputs.iter().enumerate() {
        change[n + k] = input - own[n + k];
    }
    Corrector::new(chart.system).tangent(chart.system, &own, &mut change);
    // The length of the step in scaled unknowns is what a correction is compared with.
    let scaled = (0..n).map(|k| (change[k] / mechanism.scale_of(k)).abs());
    let length = scaled.fold(0.0, f64::max);
    let moved: Vec<f64> = own.iter().zip(&change).map(|(q, d)| q + d).collect();
    let mut coordinates = chart.scene(&moved, from);
    coordinates[n..].copy_from_slice(inputs);
    (coordinates, Prediction { length, bend: 0.0 })
}
