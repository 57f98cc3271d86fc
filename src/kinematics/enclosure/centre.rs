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
        let span = region.span_of(&layout.slots[n..]);
        Ok(Self {
            n,
            inverse,
            newton,
            rates,
            about,
            span,
        })
    }

    /// How many dimensions the block depends on.
    pub fn columns(&self) -> usize {
        self.span.min(self.rates.len() / self.n.max(1))
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
        let span = region.span_of(&layout.slots[layout.own()..]);
        Self {
            n: layout.own(),
            newton: newton_steps(&known.inverse, &known.basis, &residual),
            inverse: known.inverse.clone(),
            rates: known.rates.clone(),
            about: known.about.clone(),
            span,
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

    /// G over the box, unknown after unknown, by the dimensions that the block depends on. What its sides change is bounded.
    pub fn changes<F: DimensionForm>(
        &self,
        layout: &Layout,
        basis: &[usize],
        region: &Region<F>,
        varying: &Varying<F>,
    ) -> Vec<F> {
        let (n, columns) = (self.n, self.columns());
        let along = self.along_tangent(layout, basis, region, &varying.rows);
        let mut g: Vec<F::Sum> = (0..n * columns).map(|_| F::Sum::new(0.0)).collect();
        for k in 0..columns {
            let by_rows: Vec<&F> = along.iter().skip(k).step_by(columns).collect();
            let mut sums: Vec<&mut F::Sum> = g.iter_mut().skip(k).step_by(columns).collect();
            F::Sum::add_scaled_to_all(&mut sums, &self.inverse, &by_rows);
        }
        let folded = |sum: F::Sum| sum.finish().folded(self.span);
        g.into_iter().map(folded).collect()
    }

    /// η, from G along the tangent.
    pub fn eta<F: DimensionForm>(&self, g: &[F]) -> Vec<f64> {
        let rows = g.chunks_exact(self.columns().max(1));
        let open = rows.map(|row| {
            let open = |g: &F| g.nominal().abs() + 0.5 * g.radius() + g.beyond();
            row.iter().map(open).sum::<f64>()
        });
        let eta = self.newton.iter().zip(open.chain(std::iter::repeat(0.0)));
        eta.map(|(newton, open)| (newton + open) * GROW).collect()
    }

    /// A and G over the box, for the dimensions alone.
    pub fn mapped<F: DimensionForm>(&self, varying: Varying<F>, g: Vec<F>) -> Mapped<F> {
        let Varying { entries, a, .. } = varying;
        // To the first order only magnitudes of A are needed.
        let entries = if F::BENT { entries } else { Vec::new() };
        let folded = entries.into_iter().map(|entry| entry.folded(self.span));
        Mapped {
            g,
            entries: folded.collect(),
            a,
        }
    }

    /// J S + Fₖ: how the rows of the basis change along the tangent with the dimensions that the block depends on.
    fn along_tangent<F: DimensionForm>(
        &self,
        layout: &Layout,
        basis: &[usize],
        region: &Region<F>,
        rows: &Rows<F>,
    ) -> Vec<F> {
        let (n, m, columns) = (self.n, region.count, layout.slots.len());
        let (span, zero) = (self.columns(), F::number(0.0));
        let mut all = Vec::with_capacity(n * span);
        for row in basis {
            let (own, others) = rows.jacobian[row * columns..][..columns].split_at(n);
            let others = layout.slots[n..]
                .iter()
                .copied()
                .zip(others.iter().copied());
            let others: Vec<(usize, F)> = others.filter(|(_, by)| *by != zero).collect();
            let by_slots = region.chain(&others);
            let by_slots = &by_slots[..span];
            let mut sums: Vec<F::Sum> = by_slots.iter().map(|_| F::Sum::new(0.0)).collect();
            for (sum, by) in sums.iter_mut().zip(by_slots) {
                sum.add_scaled(1.0, by);
            }
            let own = || own.iter().enumerate().filter(|(_, by)| **by != zero);
            let rates = (0..span).flat_map(|k| own().map(move |(j, _)| j * m + k));
            let rates: Vec<f64> = rates.map(|place| self.rates[place]).collect();
            let by_own: Vec<&F> = own().map(|(_, by)| by).collect();
            let mut list: Vec<&mut F::Sum> = sums.iter_mut().collect();
            F::Sum::add_scaled_to_all(&mut list, &rates, &by_own);
            all.extend(sums.into_iter().map(F::Sum::finish));
        }
        all
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
