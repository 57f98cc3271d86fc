//! The Newton-Kantorovich test of one square system.

use super::chain::U;
use super::system::{FormUse, Row};
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

/// What is proved of one unknown of a block, in radians and sizes.
pub struct UnknownBound {
    /// Newton step at the pose.
    pub step: f64,
    /// Distance of the exact unknown from the pose less the step.
    pub rest: f64,
}

/// Bounds per unknown, radius of uniqueness, and the error bound of the block, all in radians and sizes.
pub fn prove(
    rows: &[&Row],
    forms: &[FormUse],
    earlier: &Earlier,
) -> Result<(Vec<UnknownBound>, f64, f64), Reason> {
    let n = rows.len();
    if n == 0 {
        return Ok((Vec::new(), f64::INFINITY, 0.0));
    }
    let inverse = invert(jacobian(rows, forms), n).ok_or(Reason::Singular)?;
    let weights = RowWeights::new(rows, forms, earlier);
    let of_row = |(i, r)| Constants::new(i, r, rows, forms, earlier, &weights);
    let constants: Vec<_> = inverse.chunks_exact(n).enumerate().map(of_row).collect();
    let worst = |f: fn(&Constants) -> f64| constants.iter().map(f).fold(0.0, worse);
    let (eta, q, k) = (worst(Constants::eta), worst(|c| c.q), worst(|c| c.k));
    let discriminant = (1.0 - q) * (1.0 - q) * (1.0 - 8.0 * U) - 2.0 * k * eta;
    if !(q < 1.0 && discriminant > 0.0) {
        return Err(Reason::Singular);
    }
    let error = 2.0 * eta / (1.0 - q + discriminant.sqrt()) * GROW;
    let radius = ((1.0 - q) / k).min(BALL);
    if !(error <= BALL && error < radius) {
        return Err(Reason::Singular);
    }
    let bounds = constants.iter().map(|c| UnknownBound {
        step: c.newton,
        rest: (c.rest + c.q * error + 0.5 * c.k * error * error) * GROW,
    });
    Ok((bounds.collect(), radius, error))
}

/// Row-major Jacobian by the block's unknowns.
fn jacobian(rows: &[&Row], forms: &[FormUse]) -> Vec<f64> {
    let n = rows.len();
    let mut jacobian = vec![0.0; n * n];
    for (row, out) in rows.iter().zip(jacobian.chunks_exact_mut(n)) {
        for (form, value) in forms.iter().zip(&row.columns) {
            for (column, rate) in &form.own {
                out[*column] += value * rate;
            }
        }
    }
    jacobian
}

/// Makes up for the rounding of sums of positive terms in the bounds themselves: far more than they need.
const GROW: f64 = 1.0 + 1e-12;

/// Bounds for one unknown.
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

    /// Constants of unknown `i`, whose row of the inverse is `r`.
    fn new(
        i: usize,
        r: &[f64],
        rows: &[&Row],
        forms: &[FormUse],
        earlier: &Earlier,
        weights: &RowWeights,
    ) -> Self {
        let sums = (2 * rows.len() + forms.len() + 8) as f64 * U;
        let weighted = |f: &dyn Fn(usize) -> f64| -> f64 {
            r.iter().enumerate().map(|(k, r)| r.abs() * f(k)).sum()
        };
        let mut identity = vec![0.0; rows.len()];
        let mut before = vec![0.0; earlier.rest.len()];
        let mut rest = 0.0;
        let mut products = vec![0.0; forms.len()];
        for (r, row) in r.iter().zip(rows) {
            let terms = products.iter_mut().zip(&row.columns);
            terms.for_each(|(sum, c)| *sum += r * c);
        }
        for (form, product) in forms.iter().zip(products) {
            rest += product.abs() * form.open;
            form.own
                .iter()
                .for_each(|(c, rate)| identity[*c] += product * rate);
            form.before
                .iter()
                .for_each(|(k, rate)| before[*k] += product * rate);
        }
        let known = before.iter().zip(&earlier.rest);
        rest += known.map(|(c, bound)| c.abs() * bound).sum::<f64>();
        identity[i] -= 1.0;
        let drift = earlier.largest;
        rest += weighted(&|k| {
            let row = rows[k];
            let rounding = sums * (row.residual.abs() + weights.open[k]);
            row.open + rounding + row.column_error * drift + 0.5 * row.second_all * drift * drift
        });
        let q = identity.iter().map(|s| s.abs()).sum::<f64>()
            + weighted(&|k| {
                rows[k].column_error + sums * weights.own[k] + rows[k].second_all * drift
            });
        Self {
            newton: r.iter().zip(&weights.residual).map(|(r, f)| r * f).sum(),
            rest: rest * GROW,
            q: q * GROW,
            k: weighted(&|k| rows[k].second) * GROW,
        }
    }
}

/// Residuals at the earlier blocks' Newton steps, and sums of magnitudes along the rows for the rounding of
/// products.
struct RowWeights {
    residual: Vec<f64>,
    own: Vec<f64>,
    open: Vec<f64>,
}

impl RowWeights {
    fn new(rows: &[&Row], forms: &[FormUse], earlier: &Earlier) -> Self {
        let stepped =
            |u: &FormUse| -> f64 { u.before.iter().map(|(k, c)| c * earlier.step[*k]).sum() };
        let drift = |u: &FormUse| -> f64 {
            let of = |k: usize| earlier.step[k].abs() + earlier.rest[k];
            u.before.iter().map(|(k, c)| c.abs() * of(*k)).sum()
        };
        let along = |row: &Row, f: &dyn Fn(&FormUse, f64) -> f64| -> f64 {
            forms.iter().zip(&row.columns).map(|(u, c)| f(u, *c)).sum()
        };
        let all = |f: &dyn Fn(&FormUse, f64) -> f64| -> Vec<f64> {
            rows.iter().map(|row| along(row, f)).collect()
        };
        let steps = all(&|u, c| c * stepped(u));
        Self {
            residual: rows
                .iter()
                .zip(steps)
                .map(|(row, s)| row.residual - s)
                .collect(),
            own: all(&|u, c| c.abs() * u.own_rate()),
            open: all(&|u, c| c.abs() * (u.open + drift(u))),
        }
    }
}

/// The larger, and a number that is none wins.
fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}

/// Inverse of a row-major `n` × `n` matrix by Gauss and Jordan with row pivots. Any result serves the proof: how
/// good it is is measured afterwards.
pub(super) fn invert(mut a: Vec<f64>, n: usize) -> Option<Vec<f64>> {
    let mut order: Vec<usize> = (0..n).collect();
    let mut row = vec![0.0; n];
    for k in 0..n {
        let pivot = (k..n).fold(k, |best, i| {
            if a[i * n + k].abs() > a[best * n + k].abs() {
                i
            } else {
                best
            }
        });
        let value = a[pivot * n + k];
        if value == 0.0 || !value.is_finite() {
            return None;
        }
        if pivot != k {
            let (upper, lower) = a.split_at_mut(pivot * n);
            upper[k * n..(k + 1) * n].swap_with_slice(&mut lower[..n]);
            order.swap(k, pivot);
        }
        a[k * n + k] = 1.0;
        a[k * n..(k + 1) * n].iter_mut().for_each(|v| *v /= value);
        row.copy_from_slice(&a[k * n..(k + 1) * n]);
        for (i, other) in a.chunks_exact_mut(n).enumerate() {
            let factor = other[k];
            if i != k && factor != 0.0 {
                other[k] = 0.0;
                other
                    .iter_mut()
                    .zip(&row)
                    .for_each(|(o, v)| *o -= factor * v);
            }
        }
    }
    let mut inverse = vec![0.0; n * n];
    for (k, column) in order.into_iter().enumerate() {
        for i in 0..n {
            inverse[i * n + column] = a[i * n + k];
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_matrix_is_the_identity() {
        let a = vec![0.0, 2.0, 1.0, 1.0, 0.5, -3.0, 4.0, 1.0, 0.25];
        let inverse = invert(a.clone(), 3).unwrap_or_default();
        for i in 0..3 {
            for j in 0..3 {
                let entry: f64 = (0..3).map(|k| inverse[i * 3 + k] * a[k * 3 + j]).sum();
                assert!((entry - f64::from(i == j)).abs() < 1e-15);
            }
        }
        assert!(invert(vec![1.0, 2.0, 2.0, 4.0], 2).is_none());
    }
}
