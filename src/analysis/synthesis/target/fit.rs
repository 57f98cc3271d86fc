//! A mechanism compared with its targets: poses at all rows, deviations, and their derivatives by dimensions and free
//! inputs.

use super::asked::Target;
use crate::analysis::optimise::least_squares::Residuals;
use crate::analysis::study::ParametricMechanism;
use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::numbers::series::Series;
use std::f64::consts::PI;

/// A number and its rate.
type Rated = Series<f64, 2>;

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
    pub solver: PoseSolver<'f>,
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
            solver: PoseSolver::new(family.system()),
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
        let signs = self.solver.observe(pose).signs;
        let next = match self.solver.step(pose, inputs, 1) {
            Some(next) => next,
            None => self.far(pose, inputs)?,
        };
        // Another sign of a determinant means another assembly.
        (self.solver.observe(&next).signs == signs).then_some(next)
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
        self.solver.followed(&pose[..unknowns], between)
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

    /// Rates of the targets' quantities at a pose for the rates of its inputs.
    fn rates(&mut self, pose: &[f64], input_rates: &[f64], row: usize) -> Vec<f64> {
        let mechanism = self.family.mechanism();
        let unknowns = mechanism.unknowns.len();
        // Implicit differentiation of the loops, then series of first order through the observed values.
        let mut rates = [vec![0.0; unknowns], input_rates.to_vec()].concat();
        self.solver.tangent(pose, &mut rates);
        let pairs = pose.iter().zip(&rates);
        let rated: Vec<Rated> = pairs.map(|(v, r)| Rated::from([*v, *r])).collect();
        let slots = observed_slots(mechanism, &rated);
        let weight = self.target.rows[row].weight.sqrt();
        let columns = self.target.columns.iter();
        columns
            .map(|column| weight * column.reach * slots[column.slot].derivative(1))
            .collect()
    }
}

impl Residuals for Fitting<'_> {
    type Point = Fit;

    fn at(&mut self, from: &Fit, x: &[f64]) -> Option<Fit> {
        let rows = 0..self.target.rows.len();
        let poses: Option<Vec<Vec<f64>>> = rows
            .map(|row| {
                let inputs = self.inputs(x, row);
                self.follow(&from.poses[row], &inputs)
            })
            .collect();
        let fit = self.fit(x.to_vec(), poses?);
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
        let mut jacobian = vec![0.0; fit.missed.len() * columns];
        for (row, pose) in fit.poses.iter().enumerate() {
            // The variables, and the row's own input if that is free.
            let free = self.target.free_input.map(|free| (free.input, count + row));
            let moved = (0..count).map(|k| (own + k, k)).chain(free);
            for (input, column) in moved {
                let mut along = vec![0.0; own + count];
                along[input] = 1.0;
                for (k, rate) in self.rates(pose, &along, row).into_iter().enumerate() {
                    jacobian[(row * width + k) * columns + column] = rate;
                }
            }
        }
        jacobian.iter().all(|v| v.is_finite()).then_some(jacobian)
    }

    fn goes_on(&mut self, _sum: f64) -> bool {
        (self.goes_on)()
    }
}
