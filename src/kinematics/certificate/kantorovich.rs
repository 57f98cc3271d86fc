//! The Newton-Kantorovich test of one square system, for all of its unknowns side by side.

use super::super::elimination::Elimination;
use super::super::lanes::{LaneMatrix, Lanes, add_scaled, add_scaled_sizes, combine, groups};
use super::chain::U;
use super::system::BlockSystem;
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

/// Numbers of all unknowns, or of all rows, in whole groups.
#[derive(Clone, Debug, Default)]
struct Constants {
    /// The Newton step; of rows the residual at the earlier blocks' Newton steps.
    newton: Vec<Lanes>,
    /// The part of eta that is not the step.
    rest: Vec<Lanes>,
    q: Vec<Lanes>,
    k: Vec<Lanes>,
}

impl Constants {
    fn reset(&mut self, count: usize) {
        for list in [&mut self.newton, &mut self.rest, &mut self.q, &mut self.k] {
            list.clear();
            list.resize(groups(count), [0.0; 4]);
        }
    }
}

/// Buffers of the test.
#[derive(Clone, Debug, Default)]
pub struct Kantorovich {
    matrix: LaneMatrix,
    /// R with one row an equation: any matrix serves the proof; how good it is is measured.
    inverse: LaneMatrix,
    elimination: Elimination,
    /// Derivatives of the rows of the basis, one form after the other.
    columns: LaneMatrix,
    /// Residuals and weights of the rows: residual, and weights for the rest of eta, for q, for K.
    rows: Constants,
    unknowns: Constants,
    /// Sizes of the rows' rates by the forms: by what the forms drift, and by their own rates.
    drifts: Vec<Lanes>,
    own_rates: Vec<Lanes>,
    /// R times the column of a form.
    product: Vec<Lanes>,
    /// R times the Jacobian less the identity, column by column.
    identity: LaneMatrix,
    /// R times the derivative by unknowns of earlier blocks.
    before: LaneMatrix,
}

impl Kantorovich {
    /// Proves a block on its rows `basis` and notes its bounds; returns its radius of uniqueness and its error bound,
    /// in radians and sizes. The inverse has one row an equation.
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
        self.take_columns(system, basis);
        match inverse {
            Some(inverse) => self.inverse.copy(inverse),
            None => self.invert(system, n)?,
        }
        self.weigh(system, basis, earlier);
        self.bound_unknowns(n, system, earlier);
        let Constants { newton, rest, q, k } = &self.unknowns;
        let [newton, rest, q, k] = [newton, rest, q, k].map(|list| &list.as_flattened()[..n]);
        let (mut eta, mut most_q, mut most_k) = (0.0, 0.0, 0.0);
        for i in 0..n {
            eta = worse(eta, (newton[i].abs() + rest[i] * GROW) * GROW);
            most_q = worse(most_q, q[i] * GROW);
            most_k = worse(most_k, k[i] * GROW);
        }
        let discriminant =
            (1.0 - most_q) * (1.0 - most_q) * (1.0 - 8.0 * U) - 2.0 * most_k * eta;
        if !(most_q < 1.0 && discriminant > 0.0) {
            return Err(Reason::Singular);
        }
        let error = 2.0 * eta / (1.0 - most_q + discriminant.sqrt()) * GROW;
        let radius = ((1.0 - most_q) / most_k).min(BALL);
        if !(error <= BALL && error < radius) {
            return Err(Reason::Singular);
        }
        for (i, unknown) in system.unknowns.iter().enumerate() {
            let (q, k) = (q[i] * GROW, k[i] * GROW);
            let rest = (rest[i] * GROW + q * error + 0.5 * k * error * error) * GROW;
            earlier.note(*unknown, newton[i], rest);
        }
        Ok((radius, error))
    }

    /// The derivatives of the rows of the basis.
    fn take_columns(&mut self, system: &BlockSystem, basis: &[usize]) {
        if basis.len() == system.rows.len() {
            self.columns.copy(&system.columns);
            return;
        }
        self.columns.reset(system.forms.len(), basis.len());
        for (from, to) in system.columns.rows().zip(self.columns.rows_mut()) {
            let to = to.as_flattened_mut();
            for (to, row) in to.iter_mut().zip(basis) {
                *to = from.as_flattened()[*row];
            }
        }
    }

    /// Inverts the Jacobian of the basis by the block's unknowns.
    fn invert(&mut self, system: &BlockSystem, n: usize) -> Result<(), Reason> {
        // The transposed matrix has the transposed inverse.
        self.matrix.reset(n, n);
        for (form, values) in system.forms.iter().zip(self.columns.rows()) {
            for (column, rate) in &form.own {
                add_scaled(self.matrix.row_mut(*column), *rate, values);
            }
        }
        let pivots = self
            .elimination
            .invert_matrix(&self.matrix, &mut self.inverse);
        pivots.map(|_| ()).ok_or(Reason::Singular)
    }

    /// Residuals and weights of the rows.
    fn weigh(&mut self, system: &BlockSystem, basis: &[usize], earlier: &Earlier) {
        let n = basis.len();
        self.rows.reset(n);
        for list in [&mut self.drifts, &mut self.own_rates] {
            list.clear();
            list.resize(groups(n), [0.0; 4]);
        }
        for (f, (form, column)) in system.forms.iter().zip(self.columns.rows()).enumerate() {
            let (mut step, mut drift) = (0.0, system.open[f]);
            for (place, rate) in &form.before {
                let unknown = system.before[*place];
                step += rate * earlier.step[unknown];
                drift += rate.abs() * (earlier.step[unknown].abs() + earlier.rest[unknown]);
            }
            if step != 0.0 {
                add_scaled(&mut self.rows.newton, -step, column);
            }
            add_scaled_sizes(&mut self.drifts, drift, column);
            add_scaled_sizes(&mut self.own_rates, form.own_rate, column);
        }
        let drift = earlier.largest;
        let sums = (2 * n + system.forms.len() + 8) as f64 * U;
        let (residuals, rests) = (&mut self.rows.newton, &mut self.rows.rest);
        let [residuals, rests, qs, ks] = [residuals, rests, &mut self.rows.q, &mut self.rows.k]
            .map(|list| list.as_flattened_mut());
        let (drifts, own_rates) = (self.drifts.as_flattened(), self.own_rates.as_flattened());
        for (k, index) in basis.iter().enumerate() {
            let row = &system.rows[*index];
            let rounding = sums * (row.residual.abs() + drifts[k]);
            residuals[k] += row.residual;
            rests[k] = row.open
                + rounding
                + row.column_error * drift
                + 0.5 * row.second_all * drift * drift;
            qs[k] = row.column_error + sums * own_rates[k] + row.second_all * drift;
            ks[k] = row.second;
        }
    }

    /// Constants of all unknowns, before they are grown.
    fn bound_unknowns(&mut self, n: usize, system: &BlockSystem, earlier: &Earlier) {
        self.unknowns.reset(n);
        let Constants { newton, rest, q, k } = &mut self.unknowns;
        let by_rows = [&self.rows.newton, &self.rows.rest, &self.rows.q, &self.rows.k];
        let [residuals, rests, qs, ks] = by_rows.map(|list| list.as_flattened());
        combine(newton, &residuals[..n], self.inverse.groups());
        for (row, inverse) in self.inverse.rows().enumerate() {
            add_scaled_sizes(rest, rests[row], inverse);
            add_scaled_sizes(q, qs[row], inverse);
            add_scaled_sizes(k, ks[row], inverse);
        }
        self.identity.reset(n, n);
        for i in 0..n {
            *self.identity.at_mut(i, i) = -1.0;
        }
        self.before.reset(system.before.len(), n);
        self.product.resize(groups(n), [0.0; 4]);
        let forms = system.forms.iter().zip(&system.open);
        for ((form, open), column) in forms.zip(self.columns.rows()) {
            let column = &column.as_flattened()[..n];
            combine(&mut self.product, column, self.inverse.groups());
            add_scaled_sizes(rest, *open, &self.product);
            for (column, rate) in &form.own {
                add_scaled(self.identity.row_mut(*column), *rate, &self.product);
            }
            for (place, rate) in &form.before {
                add_scaled(self.before.row_mut(*place), *rate, &self.product);
            }
        }
        for (rates, slot) in self.before.rows().zip(&system.before) {
            add_scaled_sizes(rest, earlier.rest[*slot], rates);
        }
        for column in self.identity.rows() {
            add_scaled_sizes(q, 1.0, column);
        }
    }
}

/// The larger, and a number that is none wins.
fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}
