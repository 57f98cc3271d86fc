//! A mechanism compared with its targets: poses at all rows, deviations, and their derivatives by dimensions and free
//! inputs.

use super::asked::Target;
use crate::analysis::optimise::least_squares::Residuals;
use crate::analysis::study::{MeasureSlopes, ParametricMechanism};
use crate::kinematics::abreast::pose_group::PoseGroup;
use crate::kinematics::loops::observed::{dependencies, observed_slots};
use crate::numbers::octet::LANES;
use std::f64::consts::PI;

/// A mechanism at all rows of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The variables, then the free input of every row.
    pub x: Vec<f64>,
    /// The pose of every row: unknowns, then inputs.
    pub poses: Vec<Vec<f64>>,
    /// Deviations, row after row, weighted.
    pub missed: Vec<f64>,
}

/// Fits of one family, reached from each other by following poses.
pub struct Fitting<'f> {
    pub family: &'f ParametricMechanism,
    pub target: &'f Target,
    pub group: PoseGroup<'f>,
    /// Asked between steps.
    pub goes_on: &'f (dyn Fn() -> bool + Sync),
    /// Poses asked for.
    pub poses: usize,
}

impl<'f> Fitting<'f> {
    /// With a solver of its own.
    pub fn new(
        family: &'f ParametricMechanism,
        target: &'f Target,
        goes_on: &'f (dyn Fn() -> bool + Sync),
    ) -> Self {
        Self {
            family,
            target,
            group: PoseGroup::new(family.system()),
            goes_on,
            poses: 0,
        }
    }

    fn variables(&self) -> usize {
        self.family.study.variables.len()
    }

    /// All inputs of a row: the scene's own, then the variables.
    pub fn inputs(&self, x: &[f64], row: usize) -> Vec<f64> {
        let count = self.variables();
        let own = self.family.own_inputs();
        let mut inputs = match &self.target.rows[row].inputs {
            Some(inputs) => inputs.clone(),
            None => self.family.actuation.inputs_at(0.0)[..own].to_vec(),
        };
        if let Some(free) = self.target.free_input {
            inputs[free.input] = x[count + row];
        }
        inputs.extend(&x[..count]);
        inputs
    }

    /// A closed pose at other inputs, connected to a known one by steps that can be trusted.
    pub fn follow(&mut self, pose: &[f64], inputs: &[f64]) -> Option<Vec<f64>> {
        self.poses += 1;
        let unknowns = self.family.mechanism().unknowns.len();
        if pose[unknowns..] == *inputs {
            return Some(pose.to_vec());
        }
        let signs = self.group.solver.observe(pose).signs;
        let next = match self.group.solver.step(pose, inputs, 1) {
            Some(next) => next,
            None => self.far(pose, inputs)?,
        };
        // Another sign of a determinant means another assembly.
        (self.group.solver.observe(&next).signs == signs).then_some(next)
    }

    /// The same in steps that are halved where they cannot be trusted.
    fn far(&mut self, pose: &[f64], inputs: &[f64]) -> Option<Vec<f64>> {
        let unknowns = self.family.mechanism().unknowns.len();
        let from = pose[unknowns..].to_vec();
        let between = |share: f64| {
            let pairs = from.iter().zip(inputs);
            let along = pairs.map(|(a, b)| a + share * (b - a));
            match share < 1.0 {
                true => along.collect(),
                false => inputs.to_vec(),
            }
        };
        self.group.solver.followed(&pose[..unknowns], between)
    }

    /// The weighted deviations of a pose from a row.
    pub fn missed(&self, pose: &[f64], row: usize) -> Vec<f64> {
        let slots = observed_slots(self.family.mechanism(), pose);
        let row = &self.target.rows[row];
        let pairs = self.target.columns.iter().zip(&row.values);
        let weight = row.weight.sqrt();
        pairs
            .map(|(column, value)| {
                // Angles differ by less than half a turn; the reach turns them into a length.
                let off = slots[column.slot] - value;
                let off = match column.is_angle {
                    true => libm::remainder(off, 2.0 * PI),
                    false => off,
                };
                weight * column.reach * off
            })
            .collect()
    }

    /// The fit with these poses.
    pub fn fit(&self, x: Vec<f64>, poses: Vec<Vec<f64>>) -> Fit {
        let rows = poses.iter().enumerate();
        let missed = rows.flat_map(|(row, pose)| self.missed(pose, row));
        Fit {
            missed: missed.collect(),
            x,
            poses,
        }
    }
}

impl Residuals for Fitting<'_> {
    type Point = Fit;

    fn at(&mut self, from: &Fit, x: &[f64]) -> Option<Fit> {
        let rows = self.target.rows.len();
        let mut poses = Vec::with_capacity(rows);
        for first in (0..rows).step_by(LANES) {
            let known = &from.poses[first..rows.min(first + LANES)];
            let rows = first..first + known.len();
            let inputs: Vec<Vec<f64>> = rows.map(|row| self.inputs(x, row)).collect();
            // Side by side where one step suffices, else one after the other.
            let trusted = self
                .group
                .step(known, |lane, k| inputs[lane][k], &[0.0; LANES]);
            for (lane, (pose, inputs)) in known.iter().zip(&inputs).enumerate() {
                poses.push(match trusted.has(lane) {
                    true => self.group.pose(lane),
                    false => self.follow(pose, inputs)?,
                });
                self.poses += usize::from(trusted.has(lane));
            }
        }
        let fit = self.fit(x.to_vec(), poses);
        fit.missed.iter().all(|v| v.is_finite()).then_some(fit)
    }

    fn x<'p>(&self, fit: &'p Fit) -> &'p [f64] {
        &fit.x
    }

    fn values<'p>(&self, fit: &'p Fit) -> &'p [f64] {
        &fit.missed
    }

    fn jacobian(&mut self, fit: &Fit) -> Option<Vec<f64>> {
        let (own, count, width) = (
            self.family.own_inputs(),
            self.variables(),
            self.target.columns.len(),
        );
        let columns = fit.x.len();
        let mechanism = self.family.mechanism();
        let mut jacobian = vec![0.0; fit.missed.len() * columns];
        // The variables, and the row's own input if that is free.
        let free = self.target.free_input.map(|free| free.input);
        let moved: Vec<usize> = (own..own + count).chain(free).collect();
        let targets: Vec<usize> = self.target.columns.iter().map(|c| c.slot).collect();
        let needed = dependencies(mechanism, &targets);
        let sensitivities = self.group.sensitivities(&fit.poses, &moved);
        for (row, (pose, sensitivity)) in fit.poses.iter().zip(&sensitivities).enumerate() {
            let slots = observed_slots(mechanism, pose);
            let slots = (&slots[..], &needed[..]);
            let slopes = MeasureSlopes::new(mechanism, &moved, slots, sensitivity);
            let places = (0..count).chain(free.map(|_| count + row));
            let weight = self.target.rows[row].weight.sqrt();
            for (slopes, column) in slopes.rows.iter().zip(places) {
                for (k, target) in self.target.columns.iter().enumerate() {
                    let entry = &mut jacobian[(row * width + k) * columns + column];
                    *entry = weight * target.reach * slopes[target.slot];
                }
            }
        }
        jacobian.iter().all(|v| v.is_finite()).then_some(jacobian)
    }

    fn goes_on(&mut self, _sum: f64) -> bool {
        (self.goes_on)()
    }
}
