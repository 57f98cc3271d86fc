//! Poses at which the size of numbers is learned. Start values may be orders of magnitude away from any solution, and with them
//! the terms of the equations: what is rounding there would be a large error at the solution. So equations are solved roughly first.

use super::magnitudes::unknown_magnitude;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::model::actuation::{Actuation, INSTANTS};
use crate::model::equation_terms::FAR;
use crate::model::mechanism::{Equation, Mechanism};

/// An equation is roughly solved where its value is this fraction of its terms.
const SOLVED: f64 = 1e-6;

/// Most Newton steps: a cube root from a start value of 1e9 takes fifty.
const STEPS: usize = 200;

/// Halvings of a step that does not improve the equations.
const HALVINGS: i32 = 30;

/// Powers of two by which an unknown is moved where no step leads on.
const POWERS: std::ops::Range<i32> = -40..40;

/// Most such moves for an instant.
const JUMPS: usize = 4;

/// Columns that are smaller than this fraction of the largest are no direction of a step.
const DEPENDENT: f64 = 1e-12;

/// Most unknowns of equations that are solved here.
const MOST_UNKNOWNS: usize = 40;

/// Start values with the inputs at [`INSTANTS`]; the unknowns of the equations named in `own` are near a solution if that changes
/// the magnitude of a term. If it does at the start of the drive, the start values themselves are moved there.
pub fn start_poses(
    mechanism: &Mechanism,
    actuation: &mut Actuation,
    own: &[&str],
) -> Vec<Vec<f64>> {
    let starts = INSTANTS.map(|share| actuation.start_at(share * actuation.duration));
    let equations = mechanism.equations.iter();
    let unknowns = mechanism.unknowns.len();
    // Those between inputs cannot be solved.
    let has_unknowns = |equation: &&Equation| {
        let slots = equation.expression.slots();
        slots.into_iter().any(|slot| slot < unknowns)
    };
    let equations: Vec<&Equation> = equations
        .filter(|equation| own.contains(&equation.name.as_str()))
        .filter(has_unknowns)
        .collect();
    let slots = equations.iter().flat_map(|e| e.expression.slots());
    let mut slots: Vec<usize> = slots.filter(|slot| *slot < unknowns).collect();
    slots.sort_unstable();
    slots.dedup();
    if slots.is_empty() || slots.len() > MOST_UNKNOWNS {
        return starts.to_vec();
    }
    let mut settled: Vec<Vec<f64>> = Vec::with_capacity(starts.len());
    for start in &starts {
        let mut pose = start.clone();
        // Each from the one before, as a motion goes on.
        if let Some(before) = settled.last() {
            pose[..unknowns].copy_from_slice(&before[..unknowns]);
        }
        if !settle(&mut pose, &equations, &slots) {
            return starts.to_vec();
        }
        settled.push(pose);
    }
    // A term that vanishes far away, v⁻⁴, shows nothing of it.
    let is_moved = |slot: &usize| {
        let using = equations.iter().copied();
        let using = using.filter(|equation| equation.expression.slots().contains(slot));
        let using: Vec<&Equation> = using.collect();
        let magnitude = unknown_magnitude(&using, &mut settled[..1].to_vec(), *slot);
        (starts[0][*slot] - settled[0][*slot]).abs() > FAR * magnitude
    };
    let is_moved = slots.iter().any(is_moved);
    let begins_far = is_moved || are_far(&equations, &starts[..1], &settled[..1]);
    if begins_far {
        actuation.guess.copy_from_slice(&settled[0][..unknowns]);
    }
    match begins_far || are_far(&equations, &starts, &settled) {
        true => settled,
        false => starts.to_vec(),
    }
}

/// Whether the largest terms of an equation differ by magnitudes between some poses and others.
fn are_far(equations: &[&Equation], some: &[Vec<f64>], others: &[Vec<f64>]) -> bool {
    equations.iter().any(|equation| {
        let [a, b] = [some, others].map(|poses| {
            let terms = poses.iter().map(|pose| equation.terms(&mut pose.clone()));
            terms.fold(0.0, f64::max)
        });
        a > FAR * b || b > FAR * a
    })
}

/// Moves the unknowns in `slots` until the equations are roughly solved; whether they are.
fn settle(pose: &mut [f64], equations: &[&Equation], slots: &[usize]) -> bool {
    let mut factors = PivotedQr::default();
    let mut jumps = 0;
    for _ in 0..STEPS {
        let values: Vec<f64> = equations.iter().map(|e| e.expression.value(pose)).collect();
        let mut rows = equations.iter().zip(&values);
        if rows.all(|(equation, value)| value.abs() <= SOLVED * equation.terms(pose)) {
            return true;
        }
        let rows = ScaledRows::at(pose, equations, slots);
        let misfit = |pose: &[f64]| rows.misfit(equations, pose);
        let step = rows.newton_step(&mut factors, &values);
        let moved = step.and_then(|step| shortened(pose, slots, &step, &misfit));
        // A jump tries hundreds of places for every unknown.
        let may_jump = moved.is_none() && jumps < JUMPS;
        jumps += usize::from(may_jump);
        let jumped = || may_jump.then(|| jumped(pose, slots, &rows.units, &misfit));
        let Some(next) = moved.or_else(|| jumped().flatten()) else {
            return false;
        };
        pose.copy_from_slice(&next);
    }
    false
}

/// The derivatives of equations in units of the unknowns, every row in units of its gradient.
struct ScaledRows {
    /// Of the unknowns.
    units: Vec<f64>,
    /// The largest entry of every row before it was divided by it.
    scales: Vec<f64>,
    /// Entries, one unknown after the other.
    columns: Vec<f64>,
}

impl ScaledRows {
    /// At a pose, by the unknowns in `slots`.
    fn at(pose: &[f64], equations: &[&Equation], slots: &[usize]) -> Self {
        let unit = |slot: &usize| match pose[*slot] {
            0.0 => 1.0,
            value => value.abs(),
        };
        let units: Vec<f64> = slots.iter().map(unit).collect();
        let (count, mut columns) = (equations.len(), vec![0.0; equations.len() * slots.len()]);
        let mut scales = vec![0.0_f64; count];
        for (i, equation) in equations.iter().enumerate() {
            let gradient = equation.expression.gradient(pose);
            for (j, slot) in slots.iter().enumerate() {
                columns[j * count + i] = gradient[*slot] * units[j];
                scales[i] = scales[i].max(columns[j * count + i].abs());
            }
        }
        Self {
            units,
            scales,
            columns,
        }
    }

    /// The Newton step from the equations' values; none where one of them has no gradient.
    fn newton_step(&self, factors: &mut PivotedQr, values: &[f64]) -> Option<Vec<f64>> {
        let count = self.scales.len();
        if !self.scales.iter().all(|scale| scale.is_normal()) {
            return None;
        }
        let entries = self.columns.iter().enumerate();
        let columns: Vec<f64> = entries
            .map(|(k, entry)| entry / self.scales[k % count])
            .collect();
        factors.factor(&columns, count, self.units.len(), DEPENDENT);
        let pairs = values.iter().zip(&self.scales);
        let mut right: Vec<f64> = pairs.map(|(value, scale)| -value / scale).collect();
        let mut step = vec![0.0; self.units.len()];
        factors.solve(&mut right, &mut step);
        let step = step.iter().zip(&self.units);
        Some(step.map(|(step, unit)| step * unit).collect())
    }

    /// Sum of the squares of all equations in units of their gradients here.
    fn misfit(&self, equations: &[&Equation], pose: &[f64]) -> f64 {
        let rows = equations.iter().zip(&self.scales);
        let squares = rows.map(|(equation, scale)| {
            let scale = if scale.is_normal() { *scale } else { 1.0 };
            (equation.expression.value(pose) / scale).powi(2)
        });
        squares.sum()
    }
}

/// The pose after as much of a step as improves the equations.
fn shortened(
    pose: &[f64],
    slots: &[usize],
    step: &[f64],
    misfit: &impl Fn(&[f64]) -> f64,
) -> Option<Vec<f64>> {
    let before = misfit(pose);
    let after = |halvings: i32| {
        let mut next = pose.to_vec();
        let share = 2f64.powi(-halvings);
        let moved = slots.iter().zip(step);
        moved.for_each(|(slot, step)| next[*slot] += share * step);
        next
    };
    (0..HALVINGS).map(after).find(|next| misfit(next) < before)
}

/// The best pose that a single unknown leads to by far or near, where there is no direction.
fn jumped(
    pose: &[f64],
    slots: &[usize],
    units: &[f64],
    misfit: &impl Fn(&[f64]) -> f64,
) -> Option<Vec<f64>> {
    let before = misfit(pose);
    let mut best: Option<(f64, Vec<f64>)> = None;
    for (slot, unit) in slots.iter().zip(units) {
        let powers = POWERS.map(|power| unit * 2f64.powi(power));
        let places = powers.flat_map(|by| [pose[*slot] + by, pose[*slot] - by, by, -by]);
        for place in places {
            let mut next = pose.to_vec();
            next[*slot] = place;
            let there = misfit(&next);
            // Where the equations have no value yet, any value is better.
            let is_better = there < before || (before.is_nan() && there.is_finite());
            if is_better && best.as_ref().is_none_or(|(known, _)| there < *known) {
                best = Some((there, next));
            }
        }
    }
    best.map(|(_, next)| next)
}
