//! The test of one block: for all dimensions in their intervals there is one pose in a box, and how it changes with them.
//!
//! Parametric Krawczyk with the mean value form in the dimensions. With x the pose of δ = 0, S = dx/dδ there, R near the
//! inverse of the Jacobian J, and J and Fₖ = dF/dδₖ as affine forms over the box |x(δ) - x - S δ| ≤ w:
//!
//! ```text
//! A = R J - I    G = S + A S + R Fₖ    η = |R F(x)| + Σₖ (|G| + ½ Σⱼ |slopes of G| + error of G)
//! one pose in the box for every δ, if η + |A| w < w;    dx/dδ = S - G - A (dx/dδ - S)
//! ```
//!
//! η is taken along x + S δ, A over the box. G vanishes at δ = 0, so that η is of second order, and what the derivatives leave
//! open of third.

use super::region::Region;
use super::rows::{Layout, Rows};
use crate::kinematics::results::certificate::Reason;
use crate::linalg::gauss_jordan::Elimination;
use crate::linalg::lanes::LaneMatrix;
use crate::model::mechanism::Mechanism;
use crate::numbers::affine_form::AffineForm;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::{Ring, Scalar};

/// The first box, as a multiple of η.
const FIRST_SHARE: f64 = 2.0;

/// No box is narrower, in scaled unknowns: rounding of the residual takes as much.
const NARROWEST: f64 = 1e-13;

/// By how much a box that fails is widened beyond what it was mapped to.
const WIDENED: f64 = 1.5;

/// By how much a box that passes may be narrowed, beyond what it was mapped to.
const NARROWED: f64 = 1.1;

/// Boxes that are tried.
const ATTEMPTS: usize = 10;

/// A box that was mapped to more than this share of itself is good enough.
const SHARP: f64 = 0.6;

/// How often bounds are put through the contraction that they follow from.
const SWEEPS: usize = 6;

/// Why there is no box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unbounded {
    /// In the words of certificates.
    pub reason: Reason,
    /// The dimension that takes the Jacobian farthest away.
    pub dimension: Option<usize>,
}

impl From<Reason> for Unbounded {
    fn from(reason: Reason) -> Self {
        Self {
            reason,
            dimension: None,
        }
    }
}

/// The block at δ = 0.
struct Centre {
    /// Number of unknowns.
    n: usize,
    /// Inverse of the Jacobian of the basis, row after row.
    inverse: Vec<f64>,
    /// |R F(x)|
    newton: Vec<f64>,
    /// S, unknown after unknown.
    rates: Vec<f64>,
}

/// What the box is mapped by.
struct Mapped<const N: usize> {
    /// G, unknown after unknown.
    g: Vec<AffineForm<N>>,
    /// |A|, row after row.
    a: Vec<f64>,
    /// η
    eta: Vec<f64>,
    /// How far each dimension takes A, summed.
    by_dimension: Vec<f64>,
}

/// Encloses the block's unknowns in `region`, where what the block depends on is enclosed already. The rows of `basis` are
/// as many as the unknowns.
pub fn enclose_block<const N: usize>(
    mechanism: &Mechanism,
    layout: &Layout,
    basis: &[usize],
    region: &mut Region<N>,
) -> Result<(), Unbounded> {
    let centre = Centre::new(layout, basis, region)?;
    let (n, m) = (centre.n, region.count);
    // Along x + S δ itself: what the box adds to it is in |A| w.
    centre.place(layout, region, &vec![0.0; n]);
    let mut farthest = centre.farthest(layout, mechanism, m);
    let refused = |reason: Reason, dimension| Unbounded { reason, dimension };
    let eta = centre.map(layout, basis, region);
    let eta = eta.map_err(|reason| refused(reason, farthest))?.eta;
    // A first box from what the rows are off along the tangent.
    let mut box_of: Vec<f64> = (0..n)
        .map(|i| {
            let slot = layout.block.unknowns[i];
            FIRST_SHARE * eta[i] + NARROWEST * mechanism.scale_of(slot)
        })
        .collect();
    let mut passed: Option<(Mapped<N>, Vec<f64>)> = None;
    for _ in 0..ATTEMPTS {
        // The map of the whole box; where its image lies inside, every piece has a root there.
        centre.place(layout, region, &box_of);
        let Ok(mut mapped) = centre.map(layout, basis, region) else {
            break;
        };
        mapped.eta.clone_from(&eta);
        farthest = mapped.farthest().or(farthest);
        let image = mapped.image(&box_of);
        let inside = image.iter().zip(&box_of).all(|(y, w)| y < w);
        if !inside && passed.is_some() {
            break;
        }
        // Not inside: the box is widened. Inside: it is narrowed while that pays.
        let share = image_ratio(&image, &box_of);
        if !inside {
            if !share.is_finite() {
                break;
            }
            // Sides that hold stay: if all grew, those that do not hold would be run after for ever.
            let wider = image.iter().zip(&box_of);
            box_of = wider
                .map(|(y, w)| if y < w { *w } else { WIDENED * y })
                .collect();
            continue;
        }
        let swept = (0..SWEEPS).fold(image, |w, _| mapped.image(&w));
        passed = Some((mapped, box_of));
        if share > SHARP {
            break;
        }
        box_of = swept.iter().map(|w| NARROWED * w).collect();
    }
    let Some((mapped, box_of)) = passed else {
        return Err(refused(Reason::Singular, farthest));
    };
    centre.settle(layout, region, &mapped, &box_of);
    Ok(())
}

/// Largest share of the box that its image takes.
fn image_ratio(image: &[f64], box_of: &[f64]) -> f64 {
    let pairs = image.iter().zip(box_of);
    pairs.map(|(y, w)| y / w).fold(0.0, f64::max)
}

impl Centre {
    fn new<const N: usize>(
        layout: &Layout,
        basis: &[usize],
        region: &Region<N>,
    ) -> Result<Self, Unbounded> {
        let (n, m, columns) = (layout.own(), region.count, layout.slots.len());
        if basis.len() != n {
            return Err(Reason::Singular.into());
        }
        let rows: Rows<Interval> = layout.rows(&region.centre());
        if !rows.jacobian.iter().all(|entry| entry.is_finite()) {
            return Err(Reason::Formula.into());
        }
        let entry = |row: usize, column: usize| rows.jacobian[row * columns + column].middle();
        let (mut matrix, mut inverse) = (LaneMatrix::default(), LaneMatrix::default());
        matrix.reset(n, n);
        for (i, row) in basis.iter().enumerate() {
            for column in 0..n {
                *matrix.at_mut(i, column) = entry(*row, column);
            }
        }
        Elimination::default()
            .invert_matrix(&matrix, &mut inverse)
            .ok_or(Reason::Singular)?;
        let inverse: Vec<f64> = (0..n * n).map(|k| inverse.at(k / n, k % n)).collect();
        let newton = (0..n).map(|i| {
            let terms = basis.iter().enumerate();
            let sum = terms.fold(Interval::ZERO, |sum, (l, row)| {
                sum + rows.residual[*row].scale(inverse[i * n + l])
            });
            sum.magnitude()
        });
        let newton = newton.collect();
        // -R Fₖ with the values of the rates.
        let mut rates = vec![0.0; n * m];
        for (column, slot) in layout.slots.iter().enumerate().skip(n) {
            for (k, rate) in region.rates_of(*slot).iter().enumerate() {
                for (l, row) in basis.iter().enumerate() {
                    let by_slot = entry(*row, column) * rate.value;
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
        })
    }

    /// The dimension that moves the unknowns most.
    fn farthest(&self, layout: &Layout, mechanism: &Mechanism, m: usize) -> Option<usize> {
        let moved = |k: usize| {
            let slots = layout.block.unknowns.iter().enumerate();
            let scaled =
                slots.map(|(i, slot)| self.rates[i * m + k].abs() / mechanism.scale_of(*slot));
            scaled.fold(0.0, f64::max)
        };
        (0..m).max_by(|a, b| moved(*a).total_cmp(&moved(*b)))
    }

    /// Puts the block's unknowns where they are to be looked for.
    fn place<const N: usize>(&self, layout: &Layout, region: &mut Region<N>, box_of: &[f64]) {
        let m = region.count;
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            let form = &mut region.slots[*slot];
            form.slopes[..m].copy_from_slice(&self.rates[i * m..][..m]);
            form.error = box_of[i];
        }
    }

    /// A, G and η over the box.
    fn map<const N: usize>(
        &self,
        layout: &Layout,
        basis: &[usize],
        region: &Region<N>,
    ) -> Result<Mapped<N>, Reason> {
        let (n, m, columns) = (self.n, region.count, layout.slots.len());
        let rows: Rows<AffineForm<N>> = layout.rows(&region.slots);
        if !rows.jacobian.iter().all(|entry| entry.is_finite()) {
            return Err(Reason::Formula);
        }
        // Fₖ of the rows of the basis.
        let mut by_dimension = vec![AffineForm::ZERO; n * m];
        for (l, row) in basis.iter().enumerate() {
            for (column, slot) in layout.slots.iter().enumerate().skip(n) {
                let by_slot = rows.jacobian[row * columns + column];
                if by_slot == AffineForm::ZERO {
                    continue;
                }
                for (k, rate) in region.rates_of(*slot).iter().enumerate() {
                    if *rate != AffineForm::ZERO {
                        let sum = &mut by_dimension[l * m + k];
                        *sum = *sum + by_slot * *rate;
                    }
                }
            }
        }
        let mut mapped = Mapped {
            g: vec![AffineForm::ZERO; n * m],
            a: vec![0.0; n * n],
            eta: self.newton.clone(),
            by_dimension: vec![0.0; m],
        };
        for i in 0..n {
            let g = &mut mapped.g[i * m..][..m];
            for (form, rate) in g.iter_mut().zip(&self.rates[i * m..]) {
                form.value = *rate;
            }
            for l in 0..n {
                let factor = self.inverse[i * n + l];
                for (form, by) in g.iter_mut().zip(&by_dimension[l * m..]) {
                    form.add_scaled(factor, by);
                }
            }
            for column in 0..n {
                let mut entry = AffineForm::number(if i == column { -1.0 } else { 0.0 });
                for (l, row) in basis.iter().enumerate() {
                    let factor = self.inverse[i * n + l];
                    entry.add_scaled(factor, &rows.jacobian[row * columns + column]);
                }
                mapped.a[i * n + column] = entry.magnitude();
                let slopes = mapped.by_dimension.iter_mut().zip(&entry.slopes);
                slopes.for_each(|(sum, slope)| *sum += slope.abs());
                for (form, rate) in g.iter_mut().zip(&self.rates[column * m..]) {
                    form.add_scaled(*rate, &entry);
                }
            }
            let open = g.iter().map(|g| g.value.abs() + 0.5 * g.radius() + g.error);
            mapped.eta[i] = (mapped.eta[i] + open.sum::<f64>()) * GROW;
        }
        Ok(mapped)
    }

    /// Writes the unknowns and their derivatives into the region.
    fn settle<const N: usize>(
        &self,
        layout: &Layout,
        region: &mut Region<N>,
        mapped: &Mapped<N>,
        box_of: &[f64],
    ) {
        let (n, m) = (self.n, region.count);
        let narrowed = (0..SWEEPS).fold(box_of.to_vec(), |w, _| mapped.image(&w));
        let open = mapped.solved(&self.newton, box_of);
        // What the derivatives depart from their linear part by.
        let mut beyond = vec![0.0; n * m];
        for k in 0..m {
            let wide: Vec<f64> = (0..n).map(|i| mapped.g[i * m + k].radius()).collect();
            let moved = mapped.times(&wide);
            let from = (0..n).map(|i| {
                let g = &mapped.g[i * m + k];
                (g.value.abs() + g.error + moved[i]) * GROW
            });
            let solved = mapped.solved(&from.collect::<Vec<_>>(), box_of);
            (0..n).for_each(|i| beyond[i * m + k] = solved[i]);
        }
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            for k in 0..m {
                let g = &mapped.g[i * m + k];
                region.rates[slot * m + k] = AffineForm {
                    value: self.rates[i * m + k],
                    slopes: g.slopes.map(|s| -s),
                    error: beyond[i * m + k],
                };
            }
            region.open[*slot] = open[i];
            let bend = super::region::bend_bound(region.rates_of(*slot)) + open[i];
            let form = &mut region.slots[*slot];
            form.slopes[..m].copy_from_slice(&self.rates[i * m..][..m]);
            form.error = (bend * GROW).min(narrowed[i]);
        }
    }
}

impl<const N: usize> Mapped<N> {
    /// η + |A| w
    fn image(&self, w: &[f64]) -> Vec<f64> {
        let moved = self.times(w);
        let pairs = self.eta.iter().zip(moved);
        pairs.map(|(eta, moved)| (eta + moved) * GROW).collect()
    }

    /// |A| w
    fn times(&self, w: &[f64]) -> Vec<f64> {
        let rows = self.a.chunks_exact(w.len().max(1));
        rows.map(|row| row.iter().zip(w).map(|(a, w)| a * w).sum::<f64>() * GROW)
            .collect()
    }

    /// A bound of all y ≥ 0 with y ≤ from + |A| y, where the box is mapped into itself.
    fn solved(&self, from: &[f64], box_of: &[f64]) -> Vec<f64> {
        let contraction = image_ratio(&self.times(box_of), box_of);
        let share = image_ratio(from, box_of) / (1.0 - contraction) * GROW;
        let first: Vec<f64> = box_of.iter().map(|w| share * w * GROW).collect();
        (0..SWEEPS).fold(first, |y, _| {
            let moved = self.times(&y);
            let next = from.iter().zip(moved).zip(&y);
            next.map(|((from, moved), y)| ((from + moved) * GROW).min(*y))
                .collect()
        })
    }

    /// The dimension that takes A farthest from zero.
    fn farthest(&self) -> Option<usize> {
        let all = self.by_dimension.iter().enumerate();
        all.max_by(|a, b| a.1.total_cmp(b.1)).map(|(k, _)| k)
    }
}
