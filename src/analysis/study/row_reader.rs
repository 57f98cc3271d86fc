//! Evaluates rows of formulas at given poses, with their derivatives by the variables. The poses are distributed among
//! threads; the numbers do not depend on how many there are.

use super::family::ParametricMechanism;
use super::rows::{Listed, StudyRows};
use super::track_poses::{Evaluator, TrackPoses};
use crate::jobs::{core_count, share_work};
use crate::kinematics::rates::variation::Variation;
use crate::numbers::hyper_dual::HyperDual;

/// Number of poses from which on another thread pays.
const LEAST_PORTION: usize = 64;

/// What is evaluated at a pose.
#[derive(Clone, Copy)]
enum Question<'a> {
    Formula(&'a StudyRows<'a>),
    /// The smallest singular value.
    Regularity,
}

/// Evaluates formulas at poses; one for each thread.
struct Reader<'f> {
    family: &'f ParametricMechanism,
    variation: Variation<'f>,
    numbers: Vec<f64>,
    gradient: Vec<f64>,
    values: Vec<f64>,
    adjoints: Vec<f64>,
    hyper_dual: Vec<HyperDual>,
    rest: Vec<f64>,
    along: Vec<f64>,
    rates: Vec<f64>,
}

impl<'f> Reader<'f> {
    fn new(family: &'f ParametricMechanism) -> Self {
        Self {
            family,
            variation: Variation::new(family.system()),
            numbers: Vec::new(),
            gradient: Vec::new(),
            values: Vec::new(),
            adjoints: Vec::new(),
            hyper_dual: Vec::new(),
            rest: vec![0.0; family.mechanism().coordinate_count()],
            along: Vec::new(),
            rates: Vec::new(),
        }
    }

    /// The value, and its derivatives on request.
    fn answer(
        &mut self,
        question: Question,
        pose: &[f64],
        sensitivity: &[f64],
        with_slope: impl Fn(f64) -> bool,
    ) -> (f64, Vec<f64>) {
        match question {
            Question::Formula(rows) => {
                let value = self.value(rows, pose);
                let slope = with_slope(value).then(|| self.slope(rows, pose, sensitivity));
                (value, slope.unwrap_or_default())
            }
            Question::Regularity => {
                let value = self.variation.regularity(pose);
                let slope = with_slope(value).then(|| self.regularity_slope(pose, sensitivity));
                (value, slope.unwrap_or_default())
            }
        }
    }

    /// The rates of all coordinates for a unit rate of variable `k`.
    fn move_by(&mut self, k: usize, pose: &[f64], sensitivity: &[f64]) {
        let unknowns = self.family.mechanism().unknowns.len();
        self.rates.clear();
        self.rates
            .extend_from_slice(&sensitivity[k * unknowns..(k + 1) * unknowns]);
        self.rates.resize(pose.len(), 0.0);
        self.rates[unknowns + self.family.own_inputs() + k] = 1.0;
    }

    fn regularity_slope(&mut self, pose: &[f64], sensitivity: &[f64]) -> Vec<f64> {
        (0..self.family.study.variables.len())
            .map(|k| {
                self.move_by(k, pose, sensitivity);
                self.variation.regularity_rate(pose, &self.rates)
            })
            .collect()
    }

    /// The formula of `rows` at a pose.
    fn value(&mut self, rows: &StudyRows, pose: &[f64]) -> f64 {
        // A rate is the first derivative along the tangent by the input.
        if let Some(input) = rows.per {
            self.variation.tangent(pose, input, &mut self.along);
            let slots = self
                .variation
                .slots(pose, &self.along, &self.rest, rows.reach);
            return rows.formula.value_with(slots, &mut self.hyper_dual).first;
        }
        // Without traced points plain numbers suffice.
        if rows.is_free_of_traces {
            self.fill_numbers(rows, pose);
            return rows.formula.value_with(&self.numbers, &mut self.values);
        }
        let slots = self
            .variation
            .slots(pose, &self.rest, &self.rest, rows.reach);
        rows.formula.value_with(slots, &mut self.hyper_dual).value
    }

    /// Its derivatives by the variables.
    fn slope(&mut self, rows: &StudyRows, pose: &[f64], sensitivity: &[f64]) -> Vec<f64> {
        let variables = self.family.study.variables.len();
        // Coordinates alone: the formula's gradient times the rates of the pose.
        if rows.per.is_none() && rows.is_free_of_traces {
            self.fill_gradient(rows, pose);
            let count = pose.len();
            return (0..variables)
                .map(|k| {
                    self.move_by(k, pose, sensitivity);
                    let pairs = self.gradient[..count].iter().zip(&self.rates);
                    pairs.map(|(g, r)| g * r).sum()
                })
                .collect();
        }
        match rows.per {
            Some(input) => self.variation.tangent(pose, input, &mut self.along),
            None => self.along.clone_from(&self.rest),
        }
        (0..variables)
            .map(|k| {
                self.move_by(k, pose, sensitivity);
                let slots = self
                    .variation
                    .slots(pose, &self.along, &self.rates, rows.reach);
                let value = rows.formula.value_with(slots, &mut self.hyper_dual);
                if rows.per.is_some() {
                    value.mixed
                } else {
                    value.second
                }
            })
            .collect()
    }

    /// Coordinates and outputs; no traces.
    fn fill_numbers(&mut self, rows: &StudyRows, pose: &[f64]) {
        let mechanism = self.family.mechanism();
        self.numbers.clear();
        self.numbers.extend_from_slice(pose);
        if rows.reach <= pose.len() {
            return;
        }
        // Traces are left at zero: no relevant formula uses them.
        let base = pose.len() + 3 * mechanism.traces.len();
        self.numbers.resize(base, 0.0);
        for output in mechanism.outputs.iter().take(rows.reach - base) {
            let value = output.value_with(mechanism, &self.numbers, &mut self.values);
            self.numbers.push(value);
        }
    }

    /// Derivatives of the formula by the coordinates, backwards through the outputs.
    fn fill_gradient(&mut self, rows: &StudyRows, pose: &[f64]) {
        self.fill_numbers(rows, pose);
        let (numbers, gradient) = (&self.numbers, &mut self.gradient);
        let (values, adjoints) = (&mut self.values, &mut self.adjoints);
        gradient.clear();
        gradient.resize(numbers.len(), 0.0);
        rows.formula
            .add_gradient(numbers, 1.0, gradient, values, adjoints);
        let mechanism = self.family.mechanism();
        let base = pose.len() + 3 * mechanism.traces.len();
        for slot in (base..numbers.len()).rev() {
            // Reverse mode through the outputs, the last one first.
            let adjoint = gradient[slot];
            if adjoint != 0.0 {
                let output = &mechanism.outputs[slot - base];
                output.add_gradient(mechanism, numbers, adjoint, gradient, [values, adjoints]);
            }
        }
    }
}

/// Values of all rows at the given poses, list by list, with slopes if the poses have sensitivities and they are requested;
/// fewer after a cancellation.
pub(super) fn list_rows(
    evaluator: &Evaluator,
    rows: &[StudyRows],
    poses: &TrackPoses,
    with_slopes: bool,
) -> Vec<Listed> {
    let jobs: Vec<(Question, usize)> = rows
        .iter()
        .flat_map(|r| {
            r.poses
                .clone()
                .map(move |pose| (Question::Formula(r), pose))
        })
        .collect();
    let mut found = row_answers(evaluator, &jobs, poses, &|_| with_slopes).into_iter();
    rows.iter()
        .map(|r| one_sided(r, found.by_ref().take(r.poses.len()).collect()))
        .collect()
}

/// The distance of the given poses from singular ones, as `1 - σ/least`: not positive if the smallest singular value is
/// at least `least`. Slopes are given only below `slopes_below` times that, otherwise zeros.
pub(super) fn row_nearness(
    evaluator: &Evaluator,
    poses: &TrackPoses,
    least: f64,
    slopes_below: f64,
) -> Listed {
    // Without unknowns no pose is singular.
    let is_open = evaluator.family().mechanism().unknowns.is_empty();
    let count = if is_open { 0 } else { poses.poses.len() };
    let jobs: Vec<_> = (0..count).map(|k| (Question::Regularity, k)).collect();
    let mut listed = Listed::default();
    let is_near = |sigma: f64| sigma < slopes_below * least;
    for (sigma, mut slope) in row_answers(evaluator, &jobs, poses, &is_near) {
        listed.values.push(1.0 - sigma / least);
        // d(1 - σ/least) = -dσ/least.
        slope.iter_mut().for_each(|d| *d /= -least);
        slope.resize(evaluator.family().study.variables.len(), 0.0);
        listed.slopes.push(slope);
    }
    listed
}

fn row_answers(
    evaluator: &Evaluator,
    jobs: &[(Question, usize)],
    poses: &TrackPoses,
    with_slope: &(dyn Fn(f64) -> bool + Sync),
) -> Vec<(f64, Vec<f64>)> {
    let threads = core_count().min(jobs.len().div_ceil(LEAST_PORTION));
    let make = || Reader::new(evaluator.family());
    let sensitivities = poses.sensitivities();
    let found = share_work(jobs.len(), threads, make, |reader, job| {
        let (question, pose) = jobs[job];
        if evaluator.is_cancelled() {
            return None;
        }
        let sensitivity = sensitivities.map(|known| &known[pose][..]);
        let with_slope = |value| sensitivity.is_some() && with_slope(value);
        let pose = &poses.poses[pose];
        Some(reader.answer(question, pose, sensitivity.unwrap_or_default(), with_slope))
    });
    found.into_iter().map(|(_, answer)| answer).collect()
}

/// The values of some rows for every sign.
fn one_sided(rows: &StudyRows, found: Vec<(f64, Vec<f64>)>) -> Listed {
    let mut listed = Listed::default();
    for sign in rows.signs {
        let factor = sign * rows.factor;
        for (value, slope) in &found {
            listed.values.push(factor * value + rows.shift);
            if !slope.is_empty() {
                listed
                    .slopes
                    .push(slope.iter().map(|d| factor * d).collect());
            }
        }
    }
    listed
}
