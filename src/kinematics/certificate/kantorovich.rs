//! The Newton-Kantorovich test of one square system.

use super::super::elimination::Elimination;
use super::super::lanes::{LaneMatrix, Lanes, combine, dot, dot_of_sizes, groups};
use super::chain::U;
use super::system::{BlockSystem, Row};
use super::{BALL, Reason};

/// What is proved of the unknowns of earlier blocks, in radians and sizes.
#[derive(Clone, Debug, Default)]
pub struct Earlier {
    /// Newton step: the exact unknown is nearer to the pose less this step than to the pose itself.
    pub step: Vec<f64>,
    /// How near.
    pub rest: Vec<f64>,
    /// Largest distance of any such unknown from the pose.
    pub largest: f64,
}

impl Earlier {
    /// Forgets all.
    pub fn reset(&mut self, unknowns: usize) {
        for list in [&mut self.step, &mut self.rest] {
            list.clear();
            list.resize(unknowns, 0.0);
        }
        self.largest = 0.0;
    }

    /// Notes what is proved of an unknown.
    fn note(&mut self, unknown: usize, step: f64, rest: f64) {
        self.step[unknown] = step;
        self.rest[unknown] = rest;
        self.largest = self.largest.max(step.abs() + rest);
    }
}

/// Makes up for the rounding of sums of positive terms in the bounds themselves: far more than they need.
const GROW: f64 = 1.0 + 1e-12;

/// Bounds for one unknown.
#[derive(Clone, Copy, Debug, Default)]
struct Constants {
    /// The Newton step.
    newton: f64,
    /// The part of eta that is not the step.
    rest: f64,
    q: f64,
    k: f64,
}

impl Constants {
    fn eta(&self) -> f64 {
        (self.newton.abs() + self.rest) * GROW
    }
}

/// Weights of a row in the sums over |R|: for the rest of eta, for q, for K; the fourth is not used.
type RowWeights = Lanes;

/// Buffers of the test.
#[derive(Clone, Debug, Default)]
pub struct Kantorovich {
    matrix: LaneMatrix,
    /// R: any matrix serves the proof; how good it is is measured.
    inverse: LaneMatrix,
    elimination: Elimination,
    /// Rows of the basis by forms.
    columns: LaneMatrix,
    /// Residuals at the earlier blocks' Newton steps.
    residuals: Vec<f64>,
    weights: Vec<RowWeights>,
    /// Per form: step and drift by earlier blocks, own rate.
    stepped: Vec<Lanes>,
    drifts: Vec<Lanes>,
    own_rates: Vec<Lanes>,
    product: Vec<Lanes>,
    identity: Vec<f64>,
    before: Vec<f64>,
    constants: Vec<Constants>,
}

impl Kantorovich {
    /// Proves a block on its rows `basis` and notes its bounds; returns its radius of uniqueness and its error bound,
    /// in radians and sizes.
    pub fn prove(
        &mut self,
        system: &BlockSystem,
        basis: &[usize],
        inverse: Option<&LaneMatrix>,
        earlier: &mut Earlier,
    ) -> Result<(f64, f64), Reason> {
        let n = basis.len();
        if n == 0 {
            return Ok((f64::INFINITY, 0.0));
        }
        self.columns.reset(n, system.forms.len());
        for (row, from) in basis.iter().enumerate() {
            let columns = system.columns.row(*from);
            self.columns.row_mut(row).copy_from_slice(columns);
        }
        match inverse {
            Some(inverse) => self.inverse.copy_transposed(inverse, n, n),
            None => self.invert(system, n)?,
        }
        self.weigh(system, basis, earlier);
        self.constants.clear();
        let (mut eta, mut q, mut k) = (0.0, 0.0, 0.0);
        for i in 0..n {
            let constants = self.constants_of(i, n, system, earlier);
            eta = worse(eta, constants.eta());
            q = worse(q, constants.q);
            k = worse(k, constants.k);
            self.constants.push(constants);
        }
        let discriminant = (1.0 - q) * (1.0 - q) * (1.0 - 8.0 * U) - 2.0 * k * eta;
        if !(q < 1.0 && discriminant > 0.0) {
            return Err(Reason::Singular);
        }
        let error = 2.0 * eta / (1.0 - q + discriminant.sqrt()) * GROW;
        let radius = ((1.0 - q) / k).min(BALL);
        if !(error <= BALL && error < radius) {
            return Err(Reason::Singular);
        }
        for (c, unknown) in self.constants.iter().zip(&system.unknowns) {
            let rest = (c.rest + c.q * error + 0.5 * c.k * error * error) * GROW;
            earlier.note(*unknown, c.newton, rest);
        }
        Ok((radius, error))
    }

    /// Inverts the Jacobian of the basis by the block's unknowns.
    fn invert(&mut self, system: &BlockSystem, n: usize) -> Result<(), Reason> {
        self.matrix.reset(n, n);
        for row in 0..n {
            let out = self.matrix.row_mut(row).as_flattened_mut();
            let values = self.columns.row(row).as_flattened();
            for (form, value) in system.forms.iter().zip(values) {
                for (column, rate) in &form.own {
                    out[*column] += value * rate;
                }
            }
        }
        let pivots = self
            .elimination
            .invert_matrix(&self.matrix, &mut self.inverse);
        pivots.map(|_| ()).ok_or(Reason::Singular)
    }

    /// Residuals, weights of the rows, and what the forms change by.
    fn weigh(&mut self, system: &BlockSystem, basis: &[usize], earlier: &Earlier) {
        let forms = &system.forms;
        for list in [&mut self.stepped, &mut self.drifts, &mut self.own_rates] {
            list.clear();
            list.resize(groups(forms.len()), [0.0; 4]);
        }
        for (f, form) in forms.iter().enumerate() {
            let (mut step, mut drift) = (0.0, system.open[f]);
            for (place, rate) in &form.before {
                let unknown = system.before[*place];
                step += rate * earlier.step[unknown];
                drift += rate.abs() * (earlier.step[unknown].abs() + earlier.rest[unknown]);
            }
            self.stepped[f / 4][f % 4] = step;
            self.drifts[f / 4][f % 4] = drift;
            self.own_rates[f / 4][f % 4] = form.own_rate;
        }
        let drift = earlier.largest;
        let sums = (2 * basis.len() + forms.len() + 8) as f64 * U;
        self.residuals.clear();
        self.weights.clear();
        for (k, index) in basis.iter().enumerate() {
            let row: &Row = &system.rows[*index];
            let columns = self.columns.row(k);
            let rounding = sums * (row.residual.abs() + dot_of_sizes(columns, &self.drifts));
            self.residuals
                .push(row.residual - dot(columns, &self.stepped));
            self.weights.push([
                row.open
                    + rounding
                    + row.column_error * drift
                    + 0.5 * row.second_all * drift * drift,
                row.column_error
                    + sums * dot_of_sizes(columns, &self.own_rates)
                    + row.second_all * drift,
                row.second,
                0.0,
            ]);
        }
    }

    /// Constants of unknown `i`.
    fn constants_of(
        &mut self,
        i: usize,
        n: usize,
        system: &BlockSystem,
        earlier: &Earlier,
    ) -> Constants {
        let inverse = &self.inverse.row(i).as_flattened()[..n];
        let mut newton = 0.0;
        let mut weighted = [0.0; 4];
        self.product.clear();
        self.product.resize(groups(system.forms.len()), [0.0; 4]);
        for (k, r) in inverse.iter().enumerate() {
            newton += r * self.residuals[k];
            for (sum, weight) in weighted.iter_mut().zip(&self.weights[k]) {
                *sum += r.abs() * weight;
            }
        }
        combine(&mut self.product, inverse, self.columns.groups());
        self.identity.clear();
        self.identity.resize(n, 0.0);
        self.before.clear();
        self.before.resize(system.before.len(), 0.0);
        let mut rest = 0.0;
        for (f, form) in system.forms.iter().enumerate() {
            let product = self.product[f / 4][f % 4];
            rest += product.abs() * system.open[f];
            for (column, rate) in &form.own {
                self.identity[*column] += product * rate;
            }
            for (place, rate) in &form.before {
                self.before[*place] += product * rate;
            }
        }
        let known = self.before.iter().zip(&system.before);
        rest += known
            .map(|(c, slot)| c.abs() * earlier.rest[*slot])
            .sum::<f64>();
        self.identity[i] -= 1.0;
        let identity: f64 = self.identity.iter().map(|s| s.abs()).sum();
        Constants {
            newton,
            rest: (rest + weighted[0]) * GROW,
            q: (identity + weighted[1]) * GROW,
            k: weighted[2] * GROW,
        }
    }
}

/// The larger, and a number that is none wins.
fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}
