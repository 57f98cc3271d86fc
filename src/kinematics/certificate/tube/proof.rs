//! The Newton-Kantorovich test of one block for all poses of a stretch at once.
//!
//! With the path x(s), the residual F and its Jacobian J along it, and a matrix R(s) = R₀ + s R₁ + s² R₂ near the inverse
//! of J(x(s)): the product with R is taken coefficient by coefficient before s ranges over the stretch, so that what
//! cancels along the path cancels in the bound. The path itself is made by Newton's method on polynomials.
//!
//! A row G that the proof leaves out is treated like an unknown, with L(s) = G' R(s) in place of a row of R: at the exact
//! motion F = 0, so that G is there within the bounds of L F - G. What G is open by along the path for want of digits or
//! of coefficients cancels against F.

use super::constants::{EarlierTube, TubeConstants, accept_constants};
use super::form::Form;
use super::path::TubePath;
use super::rows::{Bends, JACOBIAN_TERMS, TubeLayout, TubeRows};
use super::taylor_model::{Polynomial, TERMS, polynomial_size};
use crate::kinematics::certificate::gaps::LARGEST_GAP;
use crate::kinematics::certificate::neighbourhood::{BALL, LEAST_TRACE};
use crate::kinematics::results::certificate::Reason;
use crate::linalg::gauss_jordan::GaussJordan;
use crate::linalg::lanes::{LaneMatrix, Lanes, add_scaled, combine_rows, dot_lanes, lane_groups};
use crate::numbers::rounding::{GROW, OPERATION};
use std::f64::consts::TAU;

/// Coefficients of R if anything moves.
const INVERSE_TERMS: usize = 3;

/// Most corrections of a path. From a straight line two or three suffice up to the truncation error of the polynomials.
const CORRECTIONS: usize = 6;

/// A correction below this fraction of the truncation error changes no bound.
const SMALL_CORRECTION: f64 = 0.3;

/// A path corrected by more radians or sizes leads elsewhere.
const LARGEST_CORRECTION: f64 = 0.5;

/// Factor between the balls that are tried where a formula has no bounds in the largest, or bends too much there.
const BALL_STEP: f64 = 16.0;

/// Smallest ball that is tried: closer to a kink there is no proof.
const SMALLEST_BALL: f64 = 1e-6;

/// Buffers of the test.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub rows: TubeRows,
    elimination: GaussJordan,
    square: LaneMatrix,
    pub(super) inverse: LaneMatrix,
    /// Row by row: R₀, R₁, R₂ beside each other.
    pub(super) factors: Vec<f64>,
    /// The coefficients of J on the rows of the basis, the highest on top.
    stacked: Vec<Lanes>,
    /// Truncation error of J and rounding of its products.
    slack: Vec<Lanes>,
    /// Coefficients of F on the rows of the basis.
    residuals: Vec<Lanes>,
    /// Truncation error of F and rounding of its products.
    open: Vec<f64>,
    pub(super) n: usize,
    /// Coefficients of J that are not all zero, the constant one among them.
    pub(super) terms: usize,
    /// Coefficients of R.
    pub(super) inverse_terms: usize,
    /// Groups of a row of J.
    pub(super) stride: usize,
}

/// Groups that the coefficients of a polynomial take.
const POLYNOMIAL: usize = TERMS.div_ceil(4);

/// The target of a row of factors times J.
#[derive(Clone, Copy)]
enum Aim {
    /// The identity's row of an unknown.
    Unknown(usize),
    /// A redundant row of J.
    Row(usize),
}

/// Adds the bounds of a block to those of the earlier ones. `may_move`: the path is first corrected onto the motion.
pub fn prove_tube(
    layout: &TubeLayout,
    forms: &[Form],
    path: &mut TubePath,
    basis: &[usize],
    earlier: &mut EarlierTube,
    may_move: bool,
    work: &mut Workspace,
) -> Result<(), Reason> {
    work.n = layout.own;
    // The residual and the Jacobian as polynomials over the tube.
    layout.rows(forms, path, &mut work.rows)?;
    for attempt in 0.. {
        work.lay_out(basis, layout.columns.len());
        if layout.own == 0 {
            break;
        }
        // Newton steps on the path itself, while they pay.
        work.invert()?;
        if !may_move || work.correct(layout, path, attempt)? {
            break;
        }
        layout.rows(forms, path, &mut work.rows)?;
    }
    // Newton-Kantorovich over the tube, with the inverse as a polynomial.
    let mut bends = path_bends(layout, forms, path, BALL)?;
    if layout.own > 0 {
        work.follow_inverse();
    }
    let error = loop {
        let mut accepted = Ok(0.0);
        if layout.own > 0 {
            let constants = work.constants(layout, basis, &bends, earlier);
            accepted = accept_constants(layout, &constants, bends.ball, earlier);
        }
        let is_small = bends.ball < SMALLEST_BALL || !layout.bends_in_ball();
        match accepted {
            Ok(found) if is_small || work.rows.keep_from_half_turn(&bends, earlier.largest) => {
                break found;
            }
            Err(reason) if is_small => return Err(reason),
            // Nearer to the path the formulas may bend less.
            _ => bends = path_bends(layout, forms, path, bends.ball / BALL_STEP)?,
        }
    };
    // Angles are exact to their last digits only: no shorter tube makes that error smaller.
    let turns = path.largest_angle(layout.mechanism) / TAU;
    let largest_gap = LARGEST_GAP * turns.max(1.0);
    for row in (0..layout.count()).filter(|row| !basis.contains(row)) {
        let bounds = work.of_redundant_row(row, layout, basis, &bends, earlier);
        let explained = bounds.explained(error);
        let closes_to = (bounds.residual + explained) * GROW;
        if bounds.residual > explained {
            return Err(Reason::Open);
        }
        if closes_to.is_nan() || closes_to > largest_gap {
            return Err(Reason::Singular);
        }
        earlier.closes_to = earlier.closes_to.max(closes_to);
    }
    match work.rows.keep_from_half_turn(&bends, earlier.largest) {
        true => Ok(()),
        false => Err(Reason::HalfTurn),
    }
}

impl TubeRows {
    /// Whether the traces keep clear of -1: no loop is half a turn open anywhere in the tube.
    fn keep_from_half_turn(&self, bends: &Bends, error: f64) -> bool {
        self.traces.iter().zip(&bends.turns).all(|(trace, turn)| {
            let along_the_path = trace.c[0] - trace.size_of_change();
            along_the_path - 2.0 * turn * error > LEAST_TRACE
        })
    }
}

/// Second derivatives in the largest ball, not larger than `ball`, in which the formulas of the block are smooth.
fn path_bends(
    layout: &TubeLayout,
    forms: &[Form],
    path: &TubePath,
    mut ball: f64,
) -> Result<Bends, Reason> {
    loop {
        let bends = layout.bends(forms, path, ball);
        if bends.is_ok() || ball < SMALLEST_BALL {
            return bends;
        }
        ball /= BALL_STEP;
    }
}

impl Workspace {
    /// Selects the rows of the basis.
    fn lay_out(&mut self, basis: &[usize], width: usize) {
        let products = self.products();
        self.stride = lane_groups(width);
        self.stacked.clear();
        // The highest coefficient of J on top: a product of polynomials then reads consecutive rows.
        for matrix in self.rows.jacobian().iter().rev() {
            for row in basis {
                self.stacked.extend_from_slice(matrix.row(*row));
            }
        }
        // Where J is constant along the path, one coefficient of J and of R is all there is.
        let moves = |m: &&LaneMatrix| m.groups().iter().any(|g| *g != [0.0; 4]);
        let last = self.rows.jacobian()[1..].iter().rposition(|m| moves(&m));
        self.terms = last.map_or(1, |k| k + 2);
        self.inverse_terms = last.map_or(1, |_| INVERSE_TERMS);
        self.residuals.clear();
        self.slack.clear();
        self.open.clear();
        // Truncation errors of J and F, with the rounding of the products to come.
        for row in basis {
            self.rows.add_slack(*row, products, &mut self.slack);
            self.open.push(self.rows.open_of(*row, products));
            let residual = &self.rows.residual[*row];
            // The residual's polynomial, padded to whole groups.
            let mut padded = [[0.0; 4]; POLYNOMIAL];
            for (k, c) in residual.c.iter().enumerate() {
                padded[k / 4][k % 4] = *c;
            }
            self.residuals.extend(padded);
        }
    }

    /// Rounding of the sums of products that an entry takes part in, over its size.
    fn products(&self) -> f64 {
        (3 * self.n + 8) as f64 * OPERATION
    }

    /// Rows of coefficient `k` of J and of all lower ones.
    pub(super) fn coefficients_from(&self, k: usize) -> &[Lanes] {
        let above = self.rows.jacobian().len() - 1 - k;
        &self.stacked[above * self.n * self.stride..]
    }

    /// Inverts J₀ into the first factors.
    fn invert(&mut self) -> Result<(), Reason> {
        let n = self.n;
        self.square.reset(n, n);
        let first = (self.rows.jacobian().len() - 1) * n * self.stride;
        let constant = self.stacked[first..].chunks_exact(self.stride);
        for (i, row) in constant.enumerate() {
            let groups = lane_groups(n);
            self.square.row_mut(i).copy_from_slice(&row[..groups]);
            // Columns of earlier blocks share the last group.
            for k in n..4 * groups {
                self.square.row_mut(i)[k / 4][k % 4] = 0.0;
            }
        }
        let sign = self
            .elimination
            .invert_matrix(&self.square, &mut self.inverse);
        sign.map(|_| ()).ok_or(Reason::Singular)
    }

    /// One Newton step for all coefficients, order by order. Returns `true` if the path stays, because a step would be
    /// too small to matter.
    fn correct(
        &self,
        layout: &TubeLayout,
        path: &mut TubePath,
        attempt: usize,
    ) -> Result<bool, Reason> {
        let n = self.n;
        let mut steps = vec![[0.0; 4]; TERMS * self.stride];
        let mut right = vec![[0.0; 4]; lane_groups(n)];
        // Power series of the Newton step: J0 x_k = -r_k - (J1 x_{k-1} + ...), lowest power first.
        for k in 0..TERMS {
            for i in 0..n {
                let mut value = self.residuals[i * POLYNOMIAL + k / 4][k % 4];
                for m in 1..self.rows.jacobian().len().min(k + 1) {
                    let row = &self.coefficients_from(m)[i * self.stride..(i + 1) * self.stride];
                    value += dot_lanes(
                        row,
                        &steps[(k - m) * self.stride..(k - m + 1) * self.stride],
                    );
                }
                right[i / 4][i % 4] = -value;
            }
            for i in 0..n {
                steps[k * self.stride + i / 4][i % 4] = dot_lanes(self.inverse.row(i), &right);
            }
        }
        // The size of the correction, compared with the uncertainty of the residuals.
        let (mut largest, mut blur) = (0.0_f64, 0.0_f64);
        let step = |i: usize, k: usize| steps[k * self.stride + i / 4][i % 4];
        for i in 0..n {
            let all: Polynomial = std::array::from_fn(|k| step(i, k));
            let row = self.inverse.row(i).as_flattened();
            let open = row.iter().zip(&self.open).map(|(r, o)| r.abs() * o);
            largest = largest.max(polynomial_size(&all));
            // Nor can a coefficient be corrected by less than its own last digit.
            let unknown = layout.columns[i];
            let value = path.coordinates[unknown].c[0] / layout.mechanism.scale_of(unknown);
            blur = blur.max(open.sum::<f64>() + 2.0 * OPERATION * value.abs());
            if !largest.is_finite() {
                return Err(Reason::Singular);
            }
        }
        if largest <= SMALL_CORRECTION * blur {
            return Ok(true);
        }
        if largest > LARGEST_CORRECTION {
            return Err(Reason::Singular);
        }
        // Whether it is near enough is for the test to say.
        if attempt >= CORRECTIONS {
            return Ok(true);
        }
        // The corrected path.
        for (i, unknown) in layout.columns[..n].iter().enumerate() {
            let scale = layout.mechanism.scale_of(*unknown);
            path.add(*unknown, (0..TERMS).map(|k| scale * step(i, k)));
        }
        Ok(false)
    }

    fn constants(
        &self,
        layout: &TubeLayout,
        basis: &[usize],
        bends: &Bends,
        earlier: &EarlierTube,
    ) -> Vec<TubeConstants> {
        let of_unknown = self.factors.chunks_exact(self.inverse_terms * self.n);
        let of_unknown = of_unknown.enumerate();
        of_unknown
            .map(|(i, factors)| self.bound(factors, Aim::Unknown(i), layout, basis, bends, earlier))
            .collect()
    }

    /// Bounds for a row outside the basis: its factors are those of G' R.
    fn of_redundant_row(
        &self,
        row: usize,
        layout: &TubeLayout,
        basis: &[usize],
        bends: &Bends,
        earlier: &EarlierTube,
    ) -> TubeConstants {
        let (n, all) = (self.n, self.inverse_terms * self.n);
        let mut factors = vec![0.0; all];
        let matrices = self.rows.jacobian().iter().enumerate();
        for (k, matrix) in matrices.take(self.inverse_terms) {
            let slopes = &matrix.row(row).as_flattened()[..n];
            for (slope, of_unknown) in slopes.iter().zip(self.factors.chunks_exact(all.max(1))) {
                // Coefficients m of R go to those k + m of the product.
                for (sum, factor) in factors[k * n..].iter_mut().zip(of_unknown) {
                    *sum += slope * factor;
                }
            }
        }
        self.bound(&factors, Aim::Row(row), layout, basis, bends, earlier)
    }

    /// Bounds of a row of factors times F and J, minus its target.
    fn bound(
        &self,
        factors: &[f64],
        aim: Aim,
        layout: &TubeLayout,
        basis: &[usize],
        bends: &Bends,
        earlier: &EarlierTube,
    ) -> TubeConstants {
        let (n, width) = (self.n, layout.columns.len());
        let drift = earlier.largest;
        // Row sums of |A|: the effect of an error of the rows on an unknown.
        let sizes: Vec<f64> = (0..n)
            .map(|r| {
                let sizes = (0..self.inverse_terms).map(|m| factors[m * n + r].abs());
                sizes.sum()
            })
            .collect();
        let weigh = |bounds: &[f64]| -> f64 {
            let pairs = sizes.iter().zip(basis);
            pairs.map(|(s, row)| s * bounds[*row]).sum()
        };
        // A J as a polynomial of s, coefficient by coefficient; the uncertainty of J comes first.
        let mut product = vec![[0.0; 4]; self.stride];
        combine_rows(&mut product, &sizes, &self.slack);
        let mut whole = product.clone();
        let all = match self.terms {
            1 => 1,
            _ => JACOBIAN_TERMS + self.inverse_terms - 1,
        };
        for k in 0..all {
            // Coefficients m of the factors meet those k - m of J.
            let least = (k + 1).saturating_sub(JACOBIAN_TERMS);
            let most = k.min(self.inverse_terms - 1);
            let rows = self.coefficients_from(k - least);
            let count = (most - least + 1) * n;
            let factors = &factors[least * n..least * n + count];
            combine_rows(&mut product, factors, &rows[..count * self.stride]);
            // Minus the identity, or minus the row that is judged: the rest is the contraction.
            match aim {
                Aim::Unknown(i) if k == 0 => product[i / 4][i % 4] -= 1.0,
                Aim::Row(row) if k < self.rows.jacobian().len() => {
                    add_scaled(&mut product, -1.0, self.rows.jacobian()[k].row(row));
                }
                _ => {}
            }
            for (whole, part) in whole.iter_mut().zip(&product) {
                for (w, p) in whole.iter_mut().zip(part) {
                    *w += p.abs();
                }
            }
        }
        // The same weights for open residuals and second derivatives.
        let mut open: f64 = sizes.iter().zip(&self.open).map(|(s, o)| s * o).sum();
        let (mut bend, mut own_bend) = (weigh(&bends.all), weigh(&bends.own));
        if let Aim::Row(row) = aim {
            let mut slack = Vec::new();
            self.rows.add_slack(row, self.products(), &mut slack);
            add_scaled(&mut whole, 1.0, &slack);
            open += self.rows.open_of(row, self.products());
            bend += bends.all[row];
            own_bend += bends.own[row];
        }
        // Unknowns of earlier blocks contribute their errors.
        let whole = &whole.as_flattened()[..width];
        let carried = whole[n..].iter().zip(&layout.columns[n..]);
        let carried: f64 = carried.map(|(c, slot)| c * earlier.rest[*slot]).sum();
        TubeConstants {
            residual: self.residual(factors, aim) * GROW,
            rest: (open + carried + 0.5 * bend * drift * drift) * GROW,
            q: (whole[..n].iter().sum::<f64>() + bend * drift) * GROW,
            k: own_bend * GROW,
        }
    }

    /// Bound of a row of factors times F as a polynomial, minus its target.
    fn residual(&self, factors: &[f64], aim: Aim) -> f64 {
        let mut all = [0.0; TERMS + INVERSE_TERMS];
        let mut part = [[0.0; 4]; POLYNOMIAL];
        for m in 0..self.inverse_terms {
            let of_r = &factors[m * self.n..(m + 1) * self.n];
            combine_rows(&mut part, of_r, &self.residuals);
            for (sum, c) in all[m..].iter_mut().zip(&part.as_flattened()[..TERMS]) {
                *sum += c;
            }
        }
        if let Aim::Row(row) = aim {
            let left_out = &self.rows.residual[row].c;
            all.iter_mut().zip(left_out).for_each(|(sum, c)| *sum -= c);
        }
        all.iter().map(|c| c.abs()).sum()
    }
}
