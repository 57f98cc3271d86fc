//! A block at δ = 0, and the quantities of its test: A, G and η.

use super::block_box::BlockBox;
use super::form::DimensionForm;
use super::mapped::{Contraction, Mapped};
use super::region::Region;
use super::rows::{Layout, Rows};
use crate::kinematics::results::certificate::Reason;
use crate::linalg::gauss_jordan::GaussJordan;
use crate::linalg::lanes::LaneMatrix;
use crate::numbers::form_sum::FormSum;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::{Ring, Scalar};

/// The block at δ = 0.
pub struct Centre {
    /// Number of unknowns.
    pub n: usize,
    /// Inverse of the Jacobian of the basis, row after row.
    pub inverse: Vec<f64>,
    /// |R F(x)|
    pub newton: Vec<f64>,
    /// S, unknown after unknown.
    pub rates: Vec<f64>,
    /// Points about which the loops are expressed.
    pub about: Vec<[f64; 3]>,
    /// How many of the first δ the block depends on; the sides of its box are the numbers that follow.
    pub span: usize,
}

/// The Jacobian where the unknowns are sought.
pub struct Varying<F> {
    rows: Rows<F>,
    /// A, row after row.
    entries: Vec<F>,
    /// |A|
    pub a: Contraction,
}

impl<F: DimensionForm> Varying<F> {
    /// The dimension that changes A most; behind the first `m` numbers are the sides of the box.
    pub fn farthest(&self, m: usize) -> Option<usize> {
        let mut moved = vec![0.0; m];
        for entry in &self.entries {
            let slopes = moved.iter_mut().zip(entry.slopes());
            slopes.for_each(|(sum, slope)| *sum += slope.abs());
        }
        (0..m).max_by(|a, b| moved[*a].total_cmp(&moved[*b]))
    }
}

impl Centre {
    pub fn new<F: DimensionForm>(
        layout: &Layout,
        basis: &[usize],
        region: &Region<F>,
    ) -> Result<Self, Reason> {
        let (n, m, columns) = (layout.own(), region.count, layout.slots.len());
        if basis.len() != n {
            return Err(Reason::Singular);
        }
        let nominal: Vec<f64> = region.slots.iter().map(|form| form.nominal()).collect();
        let about = layout.middles(&nominal);
        let rows: Rows<Interval> = layout.rows(&region.centre(), &about);
        if !rows.jacobian.iter().all(|entry| entry.is_finite()) {
            return Err(Reason::Formula);
        }
        let entry = |row: usize, column: usize| rows.jacobian[row * columns + column].middle();
        let (mut matrix, mut inverse) = (LaneMatrix::default(), LaneMatrix::default());
        matrix.reset(n, n);
        for (i, row) in basis.iter().enumerate() {
            for column in 0..n {
                *matrix.at_mut(i, column) = entry(*row, column);
            }
        }
        GaussJordan::default()
            .invert_matrix(&matrix, &mut inverse)
            .ok_or(Reason::Singular)?;
        let inverse: Vec<f64> = (0..n * n).map(|k| inverse.at(k / n, k % n)).collect();
        let newton = newton_steps(&inverse, basis, &rows.residual);
        // -R Fₖ with the values of the rates.
        let mut rates = vec![0.0; n * m];
        for (column, slot) in layout.slots.iter().enumerate().skip(n) {
            let moved = region.rates_of(*slot).iter().enumerate();
            for (k, rate) in moved.filter(|(_, rate)| rate.nominal() != 0.0) {
                for (l, row) in basis.iter().enumerate() {
                    let by_slot = entry(*row, column) * rate.nominal();
                    for i in 0..n {
                        rates[i * m + k] -= inverse[i * n + l] * by_slot;
                    }
                }
            }
        }
        Ok(Self {
            n,
            inverse,
            newton,
            rates,
            about,
            span: region.span_of(&layout.slots[n..]),
        })
    }

    /// Those of a box that is proved already.
    pub fn of_box<F: DimensionForm>(
        layout: &Layout,
        known: &BlockBox,
        region: &mut Region<F>,
    ) -> Self {
        for slot in &layout.block.unknowns {
            // The centre of the box is exactly this pose.
            region.open[*slot] = 0.0;
        }
        let residual = layout.residuals(&region.centre(), &known.about);
        Self {
            n: layout.own(),
            newton: newton_steps(&known.inverse, &known.basis, &residual),
            inverse: known.inverse.clone(),
            rates: known.rates.clone(),
            about: known.about.clone(),
            span: region.span_of(&layout.slots[layout.own()..]),
        }
    }

    /// The Jacobian and A over the box.
    pub fn varying<F: DimensionForm>(
        &self,
        layout: &Layout,
        basis: &[usize],
        region: &Region<F>,
    ) -> Result<Varying<F>, Reason> {
        let (n, columns) = (self.n, layout.slots.len());
        // J as forms of the dimensions, for all unknowns in the box.
        let rows: Rows<F> = layout.rows(&region.slots, &self.about);
        if !rows.jacobian.iter().all(|entry| entry.is_finite()) {
            return Err(Reason::Formula);
        }
        // A = R J - I with the inverse R at the centre, entry by entry: how far R J is from the identity.
        let mut sums: Vec<F::Sum> = (0..n * n)
            .map(|k| F::Sum::new(if k / n == k % n { -1.0 } else { 0.0 }))
            .collect();
        for column in 0..n {
            let of_column = basis
                .iter()
                .map(|row| &rows.jacobian[row * columns + column]);
            let of_column: Vec<&F> = of_column.collect();
            let mut sums: Vec<&mut F::Sum> = sums.iter_mut().skip(column).step_by(n).collect();
            F::Sum::add_scaled_to_all(&mut sums, &self.inverse, &of_column);
        }
        let entries: Vec<F> = sums.into_iter().map(F::Sum::finish).collect();
        // Magnitudes over all dimensions; the test needs |A| as a contraction.
        let a = Contraction(entries.iter().map(DimensionForm::magnitude).collect());
        Ok(Varying { rows, entries, a })
    }

    /// A, G and η over the box.
    pub fn map<F: DimensionForm>(
        &self,
        layout: &Layout,
        basis: &[usize],
        region: &Region<F>,
        varying: Varying<F>,
    ) -> Mapped<F> {
        let (n, m, columns) = (self.n, region.count, layout.slots.len());
        let Varying { rows, entries, a } = varying;
        // Fₖ of the rows of the basis.
        let zero = F::number(0.0);
        let mut by_dimension = Vec::with_capacity(n * m);
        for row in basis {
            let others = layout.slots.iter().zip(&rows.jacobian[row * columns..]);
            let others: Vec<(usize, F)> = (others.skip(n))
                .filter(|(_, by_slot)| **by_slot != zero)
                .map(|(slot, by_slot)| (*slot, *by_slot))
                .collect();
            by_dimension.extend(region.chain(&others));
        }
        let mut mapped = Mapped {
            g: Vec::with_capacity(n * m),
            entries: Vec::new(),
            a,
            eta: self.newton.clone(),
        };
        // S + A S + R Fₖ, for the dimensions that the block depends on.
        let span = m.min(self.span);
        let of = |i: usize, k: usize| self.rates[i * m + k];
        let mut sums: Vec<F::Sum> = (0..n * span)
            .map(|place| F::Sum::new(of(place / span, place % span)))
            .collect();
        for k in 0..span {
            let by_rows: Vec<&F> = by_dimension.iter().skip(k).step_by(m).collect();
            let mut sums: Vec<&mut F::Sum> = sums.iter_mut().skip(k).step_by(span).collect();
            F::Sum::add_scaled_to_all(&mut sums, &self.inverse, &by_rows);
        }
        let by_place = (0..n * span).map(|place| of(place % n, place / n));
        let columns: Vec<f64> = by_place.collect();
        let rows = sums
            .chunks_exact_mut(span.max(1))
            .zip(entries.chunks_exact(n.max(1)));
        for (sums, entries) in rows {
            let mut sums: Vec<&mut F::Sum> = sums.iter_mut().collect();
            let entries: Vec<&F> = entries.iter().collect();
            F::Sum::add_scaled_to_all(&mut sums, &columns, &entries);
        }
        let mut sums = sums.into_iter();
        for eta in &mut mapped.eta {
            let mut open = 0.0;
            for g in sums.by_ref().take(span).map(F::Sum::finish) {
                open += g.nominal().abs() + 0.5 * g.radius() + g.beyond();
                mapped.g.push(g.folded(self.span));
            }
            mapped.g.resize(mapped.g.len() + m - span, zero);
            *eta = (*eta + open) * GROW;
        }
        if F::BENT {
            let folded = entries.into_iter().map(|entry| entry.folded(self.span));
            mapped.entries = folded.collect();
        }
        mapped
    }
}

/// |R F| of the rows of a basis.
fn newton_steps(inverse: &[f64], basis: &[usize], residual: &[Interval]) -> Vec<f64> {
    let rows = inverse.chunks_exact(basis.len().max(1));
    rows.map(|row| {
        let terms = row.iter().zip(basis);
        let sum = terms.fold(Interval::ZERO, |sum, (factor, row)| {
            sum + residual[*row].scale(*factor)
        });
        sum.magnitude()
    })
    .collect()
}
