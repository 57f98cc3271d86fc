//! The Newton-Kantorovich test of one square block, for all of its unknowns side by side.

use super::block_rows::BlockRows;
use super::lane_rows::{add_part, add_sizes, put_groups, row_part};
use crate::kinematics::certificate::gaps::LARGEST_GAP;
use crate::kinematics::certificate::majorant::{Root, root_within};
use crate::kinematics::certificate::neighbourhood::BALL;
use crate::kinematics::results::certificate::Reason;
use crate::linalg::gauss_jordan::GaussJordan;
use crate::linalg::lanes::{LaneMatrix, Lanes, add_scaled, all_lanes, lane_groups};
use crate::linalg::sparse_lu::{LEAST, SparseLu};
use crate::numbers::rounding::{GROW, U, largest_or_nan};
use wide::f64x4;

/// Proved bounds on the unknowns of earlier blocks, in radians and sizes.
#[derive(Clone, Debug, Default)]
pub struct EarlierPose {
    /// Newton step: the exact unknown is nearer to the pose minus this step than to the pose itself.
    pub step: Vec<f64>,
    /// How near.
    pub rest: Vec<f64>,
    /// Largest distance of any such unknown from the pose.
    pub largest: f64,
    /// Proved bound on the closure errors of redundant equations.
    pub closes_to: f64,
}

impl EarlierPose {
    /// Forgets all.
    pub fn reset(&mut self, unknowns: usize) {
        for list in [&mut self.step, &mut self.rest] {
            list.clear();
            list.resize(unknowns, 0.0);
        }
        self.largest = 0.0;
        self.closes_to = 0.0;
    }

    /// Records the bounds of an unknown.
    fn note(&mut self, unknown: usize, step: f64, rest: f64) {
        self.step[unknown] = step;
        self.rest[unknown] = rest;
        self.largest = self.largest.max(step.abs() + rest);
    }
}

/// Numbers of all unknowns and redundant rows, or of all rows, in whole groups.
#[derive(Clone, Debug, Default)]
struct PoseConstants {
    /// The Newton step; for rows the residual at the earlier blocks' Newton steps.
    newton: Vec<Lanes>,
    /// The part of eta that is not the step.
    rest: Vec<Lanes>,
    q: Vec<Lanes>,
    k: Vec<Lanes>,
}

impl PoseConstants {
    fn reset(&mut self, count: usize) {
        for list in [&mut self.newton, &mut self.rest, &mut self.q, &mut self.k] {
            list.clear();
            list.resize(lane_groups(count), [0.0; 4]);
        }
    }
}

/// The change of a form.
#[derive(Clone, Copy, Debug)]
struct JacobianChange {
    /// Less the Newton steps of earlier blocks.
    step: f64,
    /// Largest change within the bounds of its coordinates.
    drift: f64,
    /// Largest rate by the block's unknowns.
    own_rate: f64,
}

/// Calls a step that is compiled for one to four groups at a time, so that sums stay in registers, over all groups.
macro_rules! in_blocks {
    ($groups:expr, |$count:ident, $first:ident| $step:expr) => {{
        let (mut $first, groups) = (0, $groups);
        macro_rules! run {
            ($n:literal) => {{
                const $count: usize = $n;
                $step;
                $first += $n;
            }};
        }
        while $first < groups {
            match groups - $first {
                1 => run!(1),
                2 => run!(2),
                3 => run!(3),
                _ => run!(4),
            }
        }
    }};
}

/// Buffers of the test.
#[derive(Clone, Debug, Default)]
pub struct Kantorovich {
    matrix: LaneMatrix,
    /// R with one row per equation: any matrix serves the proof; its quality is measured.
    inverse: LaneMatrix,
    elimination: GaussJordan,
    sparse: SparseLu,
    /// The rows in order: those of the basis, then the redundant ones.
    order: Vec<usize>,
    widened: LaneMatrix,
    /// Derivatives of these rows, one form after the other.
    columns: LaneMatrix,
    /// Of a large block: rows and values of each form's derivatives that are not zero.
    entries: Vec<Vec<(usize, f64)>>,
    /// Residuals and weights of the rows: residual, and weights for the rest of eta, for q, for K.
    rows: PoseConstants,
    unknowns: PoseConstants,
    changes: Vec<JacobianChange>,
    /// R times the Jacobian less the identity, column by column.
    identity: LaneMatrix,
    /// R times the derivative by unknowns of earlier blocks.
    before: LaneMatrix,
}

impl Kantorovich {
    /// Proves a block on its rows `basis` and records its bounds; returns its radius of uniqueness and its error bound,
    /// in radians and sizes. The inverse has one row per equation.
    ///
    /// A row G outside the basis is treated like an unknown, with L = G' R in place of a row of R and L F - G in place
    /// of R F. The exact pose of the basis has F = 0, so that G is there within the bounds of L F - G.
    pub fn prove(
        &mut self,
        block: &BlockRows,
        basis: &[usize],
        inverse: Option<&LaneMatrix>,
        earlier: &mut EarlierPose,
    ) -> Result<(f64, f64), Reason> {
        let (n, all) = (basis.len(), block.rows.len());
        if all == 0 {
            return Ok((f64::INFINITY, 0.0));
        }
        // An approximate inverse A of the chosen rows; any one serves.
        self.order.clear();
        self.order.extend_from_slice(basis);
        self.take_columns(block);
        match inverse {
            Some(inverse) => self.inverse.copy(inverse),
            None => self.invert(block, n)?,
        }
        if n < all {
            self.take_redundant_rows(block);
        }
        // Bounds of |A F|, |I - A J| and of A times the second derivatives, unknown by unknown.
        self.list_entries(block.of.forms.len());
        self.weigh(block, earlier);
        self.bound_unknowns(n, block, earlier);
        let PoseConstants { newton, rest, q, k } = &self.unknowns;
        let [newton, rest, q, k] = [newton, rest, q, k].map(|list| &list.as_flattened()[..all]);
        let eta = largest_or_nan((0..n).map(|i| (newton[i].abs() + rest[i] * GROW) * GROW));
        let most = |list: &[f64]| largest_or_nan(list[..n].iter().map(|v| v * GROW));
        // A root exists within the error; up to the radius the pose is alone.
        let bounds = [eta, most(q), most(k)];
        let Root { error, unique } = root_within(BALL, bounds).ok_or(Reason::Singular)?;
        let rest = |i: usize| {
            let (q, k) = (q[i] * GROW, k[i] * GROW);
            (rest[i] * GROW + q * error + 0.5 * k * error * error) * GROW
        };
        // Data for the later blocks: the step, and the remaining error of every unknown after it.
        for (i, unknown) in block.of.unknowns.iter().enumerate() {
            earlier.note(*unknown, newton[i], rest(i));
        }
        // Redundant rows: each must be explained by the errors of the others.
        for (i, gap) in newton.iter().enumerate().skip(n) {
            // Effect of the last digits of the dimensions on the row at the exact pose of the others.
            let digits = self.order.iter().enumerate();
            let digits =
                digits.map(|(r, row)| self.inverse.at(r, i).abs() * block.rows[*row].last_units);
            let (gap, explained) = (gap.abs(), rest(i) + digits.sum::<f64>());
            let closes_to = (gap + explained) * GROW;
            if gap > explained {
                return Err(Reason::Open);
            }
            if closes_to.is_nan() || closes_to > LARGEST_GAP {
                return Err(Reason::Singular);
            }
            earlier.closes_to = earlier.closes_to.max(closes_to);
        }
        Ok((unique, error))
    }

    /// The derivatives of the rows in their order.
    fn take_columns(&mut self, block: &BlockRows) {
        if self.order.len() == block.rows.len() && self.order.is_sorted() {
            self.columns.copy(&block.columns);
            return;
        }
        self.columns.reset(block.of.forms.len(), self.order.len());
        for (from, to) in block.columns.rows().zip(self.columns.rows_mut()) {
            let to = to.as_flattened_mut();
            for (to, row) in to.iter_mut().zip(&self.order) {
                *to = from.as_flattened()[*row];
            }
        }
    }

    /// A form stands in a few rows of a large block.
    fn list_entries(&mut self, forms: usize) {
        let all = self.order.len();
        let count = if all < LEAST { 0 } else { forms };
        self.entries.resize(count, Vec::new());
        for (entries, column) in self.entries.iter_mut().zip(self.columns.rows()) {
            let column = column.as_flattened()[..all].iter().enumerate();
            entries.clear();
            entries.extend(column.filter(|(_, v)| **v != 0.0).map(|(row, v)| (row, *v)));
        }
    }

    /// Appends the rows outside the basis, and to R their multipliers: L = G' R for the rows of the basis, -1 for their
    /// own.
    fn take_redundant_rows(&mut self, block: &BlockRows) {
        let (n, all) = (self.order.len(), block.rows.len());
        // The rows of the basis stay in front.
        for row in 0..all {
            if !self.order[..n].contains(&row) {
                self.order.push(row);
            }
        }
        self.take_columns(block);
        // One row for each unknown: first J of the basis, behind it G' of the redundant rows.
        self.derive(block, n, all);
        self.widened.reset(all, all);
        // Beside R the multipliers L = G' R, equation by equation.
        for i in 0..n {
            let of_r = &self.inverse.row(i).as_flattened()[..n];
            let wide = self.widened.row_mut(i).as_flattened_mut();
            wide[..n].copy_from_slice(of_r);
            for (factor, slopes) in of_r.iter().zip(self.matrix.rows()) {
                let slopes = &slopes.as_flattened()[n..all];
                for (sum, slope) in wide[n..].iter_mut().zip(slopes) {
                    *sum += factor * slope;
                }
            }
        }
        // -1 for the redundant row itself: what is bounded is L F - G.
        for i in n..all {
            *self.widened.at_mut(i, i) = -1.0;
        }
        std::mem::swap(&mut self.inverse, &mut self.widened);
    }

    /// Derivatives of `rows` rows by the block's `n` unknowns, one unknown after the other.
    fn derive(&mut self, block: &BlockRows, n: usize, rows: usize) {
        self.matrix.reset(n, rows);
        for (form, values) in block.of.forms.iter().zip(self.columns.rows()) {
            for (column, rate) in &form.own {
                add_scaled(self.matrix.row_mut(*column), *rate, values);
            }
        }
    }

    /// Inverts the Jacobian of the basis by the block's unknowns.
    fn invert(&mut self, block: &BlockRows, n: usize) -> Result<(), Reason> {
        // The transposed matrix has the transposed inverse.
        self.derive(block, n, n);
        let columns = self.matrix.rows().map(|row| &row.as_flattened()[..n]);
        let sparse = self.sparse.invert_columns(columns, n, &mut self.inverse);
        let dense = &mut self.elimination;
        let pivots = sparse.or_else(|| dense.invert_matrix(&self.matrix, &mut self.inverse));
        pivots.map(|_| ()).ok_or(Reason::Singular)
    }

    /// Residuals and weights of the rows.
    fn weigh(&mut self, block: &BlockRows, earlier: &EarlierPose) {
        let n = self.order.len();
        self.rows.reset(n);
        self.changes.clear();
        for (form, open) in block.of.forms.iter().zip(&block.open) {
            let mut change = JacobianChange {
                step: 0.0,
                drift: *open,
                own_rate: form.own_rate,
            };
            for (place, rate) in &form.before {
                let unknown = block.of.before[*place];
                let (step, rest) = (earlier.step[unknown], earlier.rest[unknown]);
                change.step -= rate * step;
                change.drift += rate.abs() * (step.abs() + rest);
            }
            self.changes.push(change);
        }
        in_blocks!(lane_groups(n), |G, first| self.sum_forms::<G>(first));
        let drift = earlier.largest;
        let sums = (2 * n + block.of.forms.len() + 8) as f64 * U;
        let PoseConstants { newton, rest, q, k } = &mut self.rows;
        let [residuals, rests, qs, ks] = [newton, rest, q, k].map(|l| l.as_flattened_mut());
        for (i, index) in self.order.iter().enumerate() {
            let row = &block.rows[*index];
            // Until here the sums of what the forms drift, and of their own rates.
            let (drifts, own_rates) = (rests[i], qs[i]);
            residuals[i] += row.residual;
            rests[i] = row.open
                + sums * (row.residual.abs() + drifts)
                + row.column_error * drift
                + 0.5 * row.second_all * drift * drift;
            qs[i] = row.column_error + sums * own_rates + row.second_all * drift;
            ks[i] = row.second;
        }
    }

    /// The effect of the forms on `G` groups of rows: residuals, sums of magnitudes by drifts and by own rates.
    #[inline(always)]
    fn sum_forms<const G: usize>(&mut self, first: usize) {
        let mut sums = [[f64x4::ZERO; G]; 3];
        for (change, column) in self.changes.iter().zip(self.columns.rows()) {
            let column = row_part::<G>(column, first);
            for g in 0..G {
                let size = column[g].abs();
                sums[0][g] += column[g] * all_lanes(change.step);
                sums[1][g] += size * all_lanes(change.drift);
                sums[2][g] += size * all_lanes(change.own_rate);
            }
        }
        let rows = &mut self.rows;
        put_groups(&mut rows.newton, first, sums[0]);
        put_groups(&mut rows.rest, first, sums[1]);
        put_groups(&mut rows.q, first, sums[2]);
    }

    /// Constants of the `n` unknowns and of the redundant rows behind them, before they are grown.
    fn bound_unknowns(&mut self, n: usize, block: &BlockRows, earlier: &EarlierPose) {
        let all = self.order.len();
        self.unknowns.reset(all);
        self.identity.reset(n, all);
        for i in 0..n {
            *self.identity.at_mut(i, i) = -1.0;
        }
        self.before.reset(block.of.before.len(), all);
        in_blocks!(lane_groups(all), |G, first| self
            .bound_some::<G>(n, first, block, earlier));
    }

    /// Constants of `G` groups of unknowns.
    #[inline(always)]
    fn bound_some<const G: usize>(
        &mut self,
        n: usize,
        first: usize,
        block: &BlockRows,
        earlier: &EarlierPose,
    ) {
        let (rows, all) = (&self.rows, self.order.len());
        let weights = [&rows.newton, &rows.rest, &rows.q, &rows.k];
        let weights = weights.map(|l| &l.as_flattened()[..all]);
        let [mut newton, mut rest, mut q, mut k] = [[f64x4::ZERO; G]; 4];
        // A F and its error terms, four unknowns at a time.
        for (i, row) in self.inverse.rows().enumerate().take(all) {
            let row = row_part::<G>(row, first);
            let [residual, for_rest, for_q, for_k] = weights.map(|list| all_lanes(list[i]));
            for g in 0..G {
                let size = row[g].abs();
                newton[g] += row[g] * residual;
                rest[g] += size * for_rest;
                q[g] += size * for_q;
                k[g] += size * for_k;
            }
        }
        // A J, one column of J at a time; its sizes go to q.
        let forms = block.of.forms.iter().zip(&block.open);
        for (index, ((form, open), column)) in forms.zip(self.columns.rows()).enumerate() {
            // Where a basis leaves rows out, they do not stand in their own order.
            let rows = if n == all { form.rows.clone() } else { 0..all };
            let mut product = [f64x4::ZERO; G];
            let mut add = |row: &[Lanes], value: f64| {
                let row = row_part::<G>(row, first);
                for g in 0..G {
                    product[g] += row[g] * all_lanes(value);
                }
            };
            match self.entries.get(index) {
                Some(entries) => entries
                    .iter()
                    .for_each(|(row, value)| add(self.inverse.row(*row), *value)),
                None => {
                    let column = &column.as_flattened()[rows.clone()];
                    let inverse = self.inverse.rows().skip(rows.start);
                    inverse
                        .zip(column)
                        .for_each(|(row, value)| add(row, *value));
                }
            }
            add_sizes(&mut rest, &product, *open);
            for (column, rate) in &form.own {
                add_part(self.identity.row_mut(*column), first, &product, *rate);
            }
            for (place, rate) in &form.before {
                add_part(self.before.row_mut(*place), first, &product, *rate);
            }
        }
        // Errors of earlier blocks, weighted by their columns.
        for (rates, slot) in self.before.rows().zip(&block.of.before) {
            add_sizes(&mut rest, &row_part::<G>(rates, first), earlier.rest[*slot]);
        }
        for column in self.identity.rows() {
            add_sizes(&mut q, &row_part::<G>(column, first), 1.0);
        }
        put_groups(&mut self.unknowns.newton, first, newton);
        put_groups(&mut self.unknowns.rest, first, rest);
        put_groups(&mut self.unknowns.q, first, q);
        put_groups(&mut self.unknowns.k, first, k);
    }
}
