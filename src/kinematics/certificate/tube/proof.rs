//! The Newton-Kantorovich test of one block for all poses of a stretch at once.
//!
//! With the path x(s), the residual F and its Jacobian J along it, and a matrix R(s) = R₀ + s R₁ near the inverse of
//! J(x(s)): the product with R is taken coefficient by coefficient before s ranges over the stretch, so that what
//! cancels along the path cancels in the bound.

use super::super::Reason;
use super::super::interval::Interval;
use super::path::Path;
use super::rows::{Rows, Site};
use super::series::{Series, TERMS};
use crate::kinematics::newton::CLOSURE_TOLERANCE;
use nalgebra::DMatrix;

/// Makes up for the rounding of sums of positive terms in the bounds themselves: far more than they need.
const GROW: f64 = 1.0 + 1e-12;

/// A trace below this could belong to a half-turn (trace -1) as well as to the identity (trace 3).
const LEAST_TRACE: f64 = 1e-6;

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

/// R₀ and R₁, row by row.
struct Inverse {
    constant: Vec<f64>,
    slope: Vec<f64>,
    n: usize,
}

impl Inverse {
    /// From the Jacobian's first two coefficients on the rows of `basis`.
    fn new(rows: &Rows, basis: &[usize], width: usize) -> Option<Self> {
        let n = basis.len();
        let entry = |i: usize, j: usize, k: usize| {
            let series = rows.jacobian[basis[i] * width + j];
            series.0[k].middle()
        };
        let matrix = DMatrix::from_fn(n, n, |i, j| entry(i, j, 0));
        let inverse = matrix.try_inverse()?;
        let slope = -&inverse * DMatrix::from_fn(n, n, |i, j| entry(i, j, 1)) * &inverse;
        let by_rows = |m: &DMatrix<f64>| m.transpose().as_slice().to_vec();
        Some(Self {
            constant: by_rows(&inverse),
            slope: by_rows(&slope),
            n,
        })
    }

    /// Coefficients of row `i` of R(s) times the vector `x`.
    fn times<'s>(&self, i: usize, x: impl Fn(usize) -> &'s Series) -> [Interval; TERMS + 1] {
        let mut product = [Interval::ZERO; TERMS + 1];
        for k in 0..self.n {
            let (constant, slope) = (self.constant[i * self.n + k], self.slope[i * self.n + k]);
            for (j, c) in x(k).0.iter().enumerate() {
                product[j] = product[j] + c.scale(constant);
                product[j + 1] = product[j + 1] + c.scale(slope);
            }
        }
        product
    }

    /// Bound of row `i` of |R(s)| times a vector of magnitudes.
    fn weigh(&self, i: usize, magnitude: impl Fn(usize) -> f64) -> f64 {
        let at = |k: usize| self.constant[i * self.n + k].abs() + self.slope[i * self.n + k].abs();
        (0..self.n).map(|k| at(k) * magnitude(k)).sum()
    }
}

/// Bound of a polynomial over -1 ≤ s ≤ 1.
fn largest(coefficients: &[Interval]) -> f64 {
    coefficients.iter().map(|c| c.magnitude()).sum()
}

/// Bounds for one unknown.
struct Constants {
    eta: f64,
    q: f64,
    k: f64,
}

/// Adds what is proved of a block to what is proved of the earlier ones.
pub fn prove(
    site: Site,
    path: &Path,
    basis: &[usize],
    earlier: &mut Earlier,
) -> Result<(), Reason> {
    let rows = site.rows(path)?;
    let n = site.block.unknowns.len();
    let mut left_out = (0..rows.residual.len()).filter(|row| !basis.contains(row));
    let open = |row: usize| {
        let residual = &rows.residual[row].0;
        // Without unknowns nothing keeps a row closed away from the middle.
        let all = if n > 0 { &residual[..1] } else { residual };
        let gap = largest(all);
        gap.is_nan() || gap > CLOSURE_TOLERANCE
    };
    if left_out.any(open) {
        return Err(Reason::Open);
    }
    if n > 0 {
        let constants = constants(site, &rows, basis, earlier)?;
        accept(site, &constants, earlier)?;
    }
    for (trace, turn) in &rows.traces {
        let along_the_path = trace.0[0].lo - largest(&trace.0[1..]);
        if along_the_path - 2.0 * turn * earlier.largest <= LEAST_TRACE {
            return Err(Reason::HalfTurn);
        }
    }
    Ok(())
}

fn constants(
    site: Site,
    rows: &Rows,
    basis: &[usize],
    earlier: &Earlier,
) -> Result<Vec<Constants>, Reason> {
    let (n, width) = (site.block.unknowns.len(), site.columns.len());
    let inverse = Inverse::new(rows, basis, width).ok_or(Reason::Singular)?;
    let drift = earlier.largest;
    let of_unknown = |i: usize| {
        let column = |j: usize| {
            let mut product = inverse.times(i, |k| &rows.jacobian[basis[k] * width + j]);
            if i == j {
                product[0] = product[0] - Interval::ONE;
            }
            largest(&product)
        };
        let bend = inverse.weigh(i, |k| rows.second_all[basis[k]]);
        let residual = largest(&inverse.times(i, |k| &rows.residual[basis[k]]));
        let carried = (n..width).map(|j| column(j) * earlier.rest[site.columns[j]]);
        Constants {
            eta: (residual + carried.sum::<f64>() + 0.5 * bend * drift * drift) * GROW,
            q: ((0..n).map(column).sum::<f64>() + bend * drift) * GROW,
            k: inverse.weigh(i, |k| rows.second[basis[k]]) * GROW,
        }
    };
    Ok((0..n).map(of_unknown).collect())
}

/// The test itself: eta + q r + K r²/2 ≤ r has a solution, and the map contracts there.
fn accept(site: Site, constants: &[Constants], earlier: &mut Earlier) -> Result<(), Reason> {
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
    let unique = ((1.0 - q) / k).min(site.ball) / GROW;
    if error.is_nan() || error >= unique {
        return Err(Reason::Singular);
    }
    for (slot, c) in site.block.unknowns.iter().zip(constants) {
        let rest = (c.eta + c.q * error + 0.5 * c.k * error * error) * GROW;
        earlier.rest[*slot] = rest;
        earlier.largest = earlier.largest.max(rest);
    }
    earlier.unique = earlier.unique.min(unique);
    Ok(())
}
