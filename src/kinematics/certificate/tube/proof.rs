//! The Newton-Kantorovich test of one block for all poses of a stretch at once.
//!
//! With the path x(s), the residual F and its Jacobian J along it, and a matrix R(s) = R₀ + s R₁ + s² R₂ near the inverse
//! of J(x(s)): the product with R is taken coefficient by coefficient before s ranges over the stretch, so that what
//! cancels along the path cancels in the bound. The path itself is made by Newton's method on polynomials.

use super::form::Form;
use super::model::{Polynomial, TERMS, size};
use super::path::Path;
use super::rows::{Bends, JACOBIAN_TERMS, Layout, Rows};
use crate::kinematics::certificate::neighbourhood::BALL;
use crate::kinematics::results::certificate::Reason;
use crate::kinematics::solve::closure::CLOSURE_TOLERANCE;
use crate::linalg::gauss_jordan::Elimination;
use crate::linalg::lanes::{LaneMatrix, Lanes, combine, dot, groups};
use crate::numbers::rounding::{GROW, OPERATION};

/// A trace below this could belong to a half-turn (trace -1) as well as to the identity (trace 3).
const LEAST_TRACE: f64 = 1e-6;

/// Coefficients of R.
const INVERSE_TERMS: usize = 3;

/// Most corrections of a path. From a straight line two or three leave what the polynomials cannot follow.
const CORRECTIONS: usize = 6;

/// A correction below this part of what the polynomials leave out changes no bound.
const SMALL_CORRECTION: f64 = 0.3;

/// A path that is corrected by more radians or sizes leads elsewhere.
const LARGEST_CORRECTION: f64 = 0.5;

/// Factor between the balls that are tried where a formula has no bounds in the largest.
const BALL_STEP: f64 = 16.0;

/// No smaller ball is tried: a motion so close to a kink is as good as on it.
const SMALLEST_BALL: f64 = 1e-6;

/// What is proved of the unknowns of earlier blocks.
#[derive(Clone, Debug)]
pub struct Earlier {
    /// Distance from the path, per unknown of the mechanism, in radians and sizes.
    pub rest: Vec<f64>,
    /// The largest of them.
    pub largest: f64,
    /// Distance within which the motion is the only one.
    pub unique: f64,
}

/// Buffers of the test.
#[derive(Debug, Default)]
pub struct Workspace {
    pub rows: Rows,
    elimination: Elimination,
    square: LaneMatrix,
    inverse: LaneMatrix,
    /// Row by row: R₀, R₁, R₂ beside each other.
    factors: Vec<f64>,
    /// The coefficients of J on the rows of the basis, the highest on top.
    stacked: Vec<Lanes>,
    /// What J leaves out and what its products round.
    slack: Vec<Lanes>,
    /// Coefficients of F on the rows of the basis.
    residuals: Vec<Lanes>,
    /// What F leaves out and what its products round.
    open: Vec<f64>,
    n: usize,
    /// Groups of a row of J.
    stride: usize,
}

/// Groups that the coefficients of a polynomial take.
const POLYNOMIAL: usize = TERMS.div_ceil(4);

/// Bounds for one unknown.
struct Constants {
    eta: f64,
    q: f64,
    k: f64,
}

/// Adds what is proved of a block to what is proved of the earlier ones. `may_move`: the path is first brought to the
/// motion.
pub fn prove(
    layout: &Layout,
    forms: &[Form],
    path: &mut Path,
    basis: &[usize],
    earlier: &mut Earlier,
    may_move: bool,
    work: &mut Workspace,
) -> Result<(), Reason> {
    work.n = layout.own;
    layout.rows(forms, path, &mut work.rows)?;
    if layout.own > 0 {
        for attempt in 0.. {
            work.lay_out(basis, layout.columns.len());
            work.invert()?;
            if !may_move || work.correct(layout, path, attempt)? {
                break;
            }
            layout.rows(forms, path, &mut work.rows)?;
        }
    }
    let bends = bends(layout, forms, path)?;
    if layout.own > 0 {
        work.follow_inverse();
        let constants = work.constants(layout, basis, &bends, earlier);
        accept(layout, &constants, bends.ball, earlier)?;
    }
    let gaps = (0..work.rows.residual.len()).filter(|row| !basis.contains(row));
    if gaps.into_iter().any(|row| work.is_open(row, earlier)) {
        return Err(Reason::Open);
    }
    for (trace, turn) in work.rows.traces.iter().zip(&bends.turns) {
        let along_the_path = trace.c[0] - trace.size_of_change();
        if along_the_path - 2.0 * turn * earlier.largest <= LEAST_TRACE {
            return Err(Reason::HalfTurn);
        }
    }
    Ok(())
}

/// Second derivatives in the largest ball in which the formulas of the block are smooth.
fn bends(layout: &Layout, forms: &[Form], path: &Path) -> Result<Bends, Reason> {
    let mut ball = BALL;
    loop {
        let bends = layout.bends(forms, path, ball);
        if bends.is_ok() || ball < SMALLEST_BALL {
            return bends;
        }
        ball /= BALL_STEP;
    }
}

impl Workspace {
    /// Whether a row that the proof leaves out does not hold: in the middle of the stretch, or anywhere if there are no
    /// unknowns that could keep it closed.
    fn is_open(&self, row: usize, earlier: &Earlier) -> bool {
        let residual = &self.rows.residual[row];
        let gap = if self.n == 0 {
            residual.size()
        } else {
            let slopes = self.rows.jacobian[0].row(row).as_flattened().iter();
            let play = slopes.map(|v| v.abs()).sum::<f64>() * earlier.largest;
            residual.c[0].abs() - 2.0 * play - residual.rest
        };
        gap.is_nan() || gap > CLOSURE_TOLERANCE
    }

    /// Takes the rows of the basis.
    fn lay_out(&mut self, basis: &[usize], width: usize) {
        let n = self.n;
        self.stride = groups(width);
        let products = (3 * n + 8) as f64 * OPERATION;
        self.stacked.clear();
        for matrix in self.rows.jacobian.iter().rev() {
            for row in basis {
                self.stacked.extend_from_slice(matrix.row(*row));
            }
        }
        self.slack.clear();
        self.residuals.clear();
        self.open.clear();
        for row in basis {
            for g in 0..self.stride {
                let mut sum = self.rows.rest.row(*row)[g];
                for matrix in &self.rows.jacobian {
                    let entries = matrix.row(*row)[g];
                    sum.iter_mut()
                        .zip(entries)
                        .for_each(|(s, e)| *s += products * e.abs());
                }
                self.slack.push(sum);
            }
            let residual = &self.rows.residual[*row];
            let mut padded = [[0.0; 4]; POLYNOMIAL];
            for (k, c) in residual.c.iter().enumerate() {
                padded[k / 4][k % 4] = *c;
            }
            self.residuals.extend(padded);
            self.open.push(residual.rest + products * size(&residual.c));
        }
    }

    /// Rows of coefficient `k` of J and of all lower ones.
    fn coefficients_from(&self, k: usize) -> &[Lanes] {
        &self.stacked[(JACOBIAN_TERMS - 1 - k) * self.n * self.stride..]
    }

    /// Inverts J₀ into the first factors.
    fn invert(&mut self) -> Result<(), Reason> {
        let n = self.n;
        self.square.reset(n, n);
        let constant = &self.stacked[(JACOBIAN_TERMS - 1) * n * self.stride..];
        for (i, row) in constant.chunks_exact(self.stride).enumerate() {
            let groups = groups(n);
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

    /// One step of Newton's method for all coefficients, order by order. `true`: the path stays as it is, since a step
    /// would be too small to matter.
    fn correct(&self, layout: &Layout, path: &mut Path, attempt: usize) -> Result<bool, Reason> {
        let n = self.n;
        let mut steps = vec![[0.0; 4]; TERMS * self.stride];
        let mut right = vec![[0.0; 4]; groups(n)];
        for k in 0..TERMS {
            for i in 0..n {
                let mut value = self.residuals[i * POLYNOMIAL + k / 4][k % 4];
                for m in 1..JACOBIAN_TERMS.min(k + 1) {
                    let row = &self.coefficients_from(m)[i * self.stride..(i + 1) * self.stride];
                    value += dot(
                        row,
                        &steps[(k - m) * self.stride..(k - m + 1) * self.stride],
                    );
                }
                right[i / 4][i % 4] = -value;
            }
            for i in 0..n {
                steps[k * self.stride + i / 4][i % 4] = dot(self.inverse.row(i), &right);
            }
        }
        let (mut largest, mut blur) = (0.0_f64, 0.0_f64);
        let step = |i: usize, k: usize| steps[k * self.stride + i / 4][i % 4];
        for i in 0..n {
            let all: Polynomial = std::array::from_fn(|k| step(i, k));
            let row = self.inverse.row(i).as_flattened();
            let open = row.iter().zip(&self.open).map(|(r, o)| r.abs() * o);
            largest = largest.max(size(&all));
            blur = blur.max(open.sum());
            if !largest.is_finite() {
                return Err(Reason::Singular);
            }
        }
        if largest <= SMALL_CORRECTION * blur {
            return Ok(true);
        }
        if attempt >= CORRECTIONS || largest > LARGEST_CORRECTION {
            return Err(Reason::Singular);
        }
        for (i, unknown) in layout.columns[..n].iter().enumerate() {
            let scale = layout.mechanism.scale_of(*unknown);
            path.add(*unknown, (0..TERMS).map(|k| scale * step(i, k)));
        }
        Ok(false)
    }

    /// R₀ and, from it, R₁ = -R₀ J₁ R₀ and R₂ = -R₀ (J₂ R₀ + J₁ R₁).
    fn follow_inverse(&mut self) {
        let (n, width) = (self.n, groups(self.n));
        let mut factors = vec![0.0; n * n * INVERSE_TERMS];
        let all = INVERSE_TERMS * n;
        for (i, row) in factors.chunks_exact_mut(all).enumerate() {
            row[..n].copy_from_slice(&self.inverse.row(i).as_flattened()[..n]);
        }
        let mut product = vec![[0.0; 4]; self.stride];
        let times = |row: &[f64], k: usize, product: &mut Vec<Lanes>| {
            combine(product, row, &self.coefficients_from(k)[..n * self.stride]);
        };
        let mut first = vec![[0.0; 4]; n * width];
        let mut sum = vec![[0.0; 4]; width];
        let mut bent = vec![0.0; 2 * n];
        for i in 0..n {
            let row: Vec<f64> = factors[i * all..i * all + n].to_vec();
            times(&row, 1, &mut product);
            combine(
                &mut sum,
                &product.as_flattened()[..n],
                self.inverse.groups(),
            );
            first[i * width..(i + 1) * width].copy_from_slice(&sum);
            for (f, s) in factors[i * all + n..].iter_mut().zip(sum.as_flattened()) {
                *f = -s;
            }
            // The next coefficient needs R₁ as a whole.
            factors[i * all + 2 * n..(i + 1) * all].fill(0.0);
        }
        let mut both = Vec::with_capacity(2 * n * width);
        both.extend_from_slice(self.inverse.groups());
        both.extend(first.iter().map(|g| g.map(|v| -v)));
        for i in 0..n {
            let row: Vec<f64> = factors[i * all..i * all + n].to_vec();
            times(&row, 2, &mut product);
            bent[..n].copy_from_slice(&product.as_flattened()[..n]);
            times(&row, 1, &mut product);
            bent[n..].copy_from_slice(&product.as_flattened()[..n]);
            combine(&mut sum, &bent, &both);
            for (f, s) in factors[i * all + 2 * n..(i + 1) * all]
                .iter_mut()
                .zip(sum.as_flattened())
            {
                *f = -s;
            }
        }
        self.factors = factors;
    }

    fn constants(
        &self,
        layout: &Layout,
        basis: &[usize],
        bends: &Bends,
        earlier: &Earlier,
    ) -> Vec<Constants> {
        let (n, width) = (self.n, layout.columns.len());
        let drift = earlier.largest;
        let mut product = vec![[0.0; 4]; self.stride];
        let of_unknown = |i: usize| {
            let factors = &self.factors[i * INVERSE_TERMS * n..(i + 1) * INVERSE_TERMS * n];
            let sizes: Vec<f64> = (0..n)
                .map(|r| (0..INVERSE_TERMS).map(|m| factors[m * n + r].abs()).sum())
                .collect();
            let weigh = |bounds: &[f64]| -> f64 {
                let pairs = sizes.iter().zip(basis);
                pairs.map(|(s, row)| s * bounds[*row]).sum()
            };
            combine(&mut product, &sizes, &self.slack);
            let mut whole = product.clone();
            for k in 0..JACOBIAN_TERMS + INVERSE_TERMS - 1 {
                // Coefficients m of R meet those k - m of J.
                let least = (k + 1).saturating_sub(JACOBIAN_TERMS);
                let most = k.min(INVERSE_TERMS - 1);
                let rows = self.coefficients_from(k - least);
                let count = (most - least + 1) * n;
                let of_r = &factors[least * n..least * n + count];
                combine(&mut product, of_r, &rows[..count * self.stride]);
                if k == 0 {
                    product[i / 4][i % 4] -= 1.0;
                }
                for (whole, part) in whole.iter_mut().zip(&product) {
                    for (w, p) in whole.iter_mut().zip(part) {
                        *w += p.abs();
                    }
                }
            }
            let whole = &whole.as_flattened()[..width];
            let bend = weigh(&bends.all);
            let carried = whole[n..].iter().zip(&layout.columns[n..]);
            let carried: f64 = carried.map(|(c, slot)| c * earlier.rest[*slot]).sum();
            let open: f64 = sizes.iter().zip(&self.open).map(|(s, o)| s * o).sum();
            let residual = self.residual(factors);
            Constants {
                eta: (residual + open + carried + 0.5 * bend * drift * drift) * GROW,
                q: (whole[..n].iter().sum::<f64>() + bend * drift) * GROW,
                k: weigh(&bends.own) * GROW,
            }
        };
        let mut of_unknown = of_unknown;
        (0..n).map(&mut of_unknown).collect()
    }

    /// Bound of the polynomial that a row of R makes of F.
    fn residual(&self, factors: &[f64]) -> f64 {
        let mut all = [0.0; TERMS + INVERSE_TERMS];
        let mut part = [[0.0; 4]; POLYNOMIAL];
        for m in 0..INVERSE_TERMS {
            let of_r = &factors[m * self.n..(m + 1) * self.n];
            combine(&mut part, of_r, &self.residuals);
            for (sum, c) in all[m..].iter_mut().zip(&part.as_flattened()[..TERMS]) {
                *sum += c;
            }
        }
        all.iter().map(|c| c.abs()).sum()
    }
}

/// The test itself: eta + q r + K r²/2 ≤ r has a solution, and the map contracts there.
fn accept(
    layout: &Layout,
    constants: &[Constants],
    ball: f64,
    earlier: &mut Earlier,
) -> Result<(), Reason> {
    let worst = |f: fn(&Constants) -> f64| {
        let values = constants.iter().map(f);
        values.fold(0.0, |a: f64, b| if b.is_nan() || b > a { b } else { a })
    };
    let (eta, q, k) = (worst(|c| c.eta), worst(|c| c.q), worst(|c| c.k));
    let discriminant = (1.0 - q) * (1.0 - q) * (1.0 - 1e-15) - 2.0 * k * eta;
    if !(q < 1.0 && discriminant > 0.0) {
        return Err(Reason::Singular);
    }
    let error = 2.0 * eta / (1.0 - q + discriminant.sqrt()) * GROW;
    let unique = ((1.0 - q) / k).min(ball) / GROW;
    if error.is_nan() || error >= unique {
        return Err(Reason::Singular);
    }
    for (slot, c) in layout.block.unknowns.iter().zip(constants) {
        let rest = (c.eta + c.q * error + 0.5 * c.k * error * error) * GROW;
        earlier.rest[*slot] = rest;
        earlier.largest = earlier.largest.max(rest);
    }
    earlier.unique = earlier.unique.min(unique);
    Ok(())
}
