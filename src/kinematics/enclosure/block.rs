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
//! The Jacobian is enclosed to the first order in δ, and to the second where that leaves much open: an inverse that is large multiplies
//! every error of J by magnitudes, though what J changes by cancels in R J.
//!
//! Where a form has room for them, the sides of the box are numbers of their own beside δ, so that what the box changes J by cancels
//! in R J as well.
//!
//! η is taken along x + S δ, A over the box. G vanishes at δ = 0, so that η is of second order, and what the derivatives leave
//! open of third.

use super::form::DimensionForm;
use super::mapped::{Mapped, SWEEPS, image_ratio};
use super::region::Region;
use super::rows::{Layout, Rows};
use crate::kinematics::results::certificate::Reason;
use crate::linalg::gauss_jordan::Elimination;
use crate::linalg::lanes::LaneMatrix;
use crate::model::mechanism::Mechanism;
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

/// How often the maps are taken again over what is known of the unknowns to the second order.
const POLISHING: usize = 2;

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
    /// Points that the loops are seen about.
    about: Vec<[f64; 3]>,
}

/// Encloses the block's unknowns in `region`, where what the block depends on is enclosed already. The rows of `basis` are
/// as many as the unknowns. Says which share of the unknowns' way is left open, at most.
pub fn enclose_block<F: DimensionForm>(
    mechanism: &Mechanism,
    layout: &Layout,
    basis: &[usize],
    region: &mut Region<F>,
) -> Result<f64, Unbounded> {
    let centre = Centre::new(layout, basis, region)?;
    let (mut mapped, box_of) = centre.proved_box(mechanism, layout, basis, region)?;
    centre.settle(layout, region, &mapped, &box_of);
    // What is known of the unknowns now is of higher order than the box: the same maps over it are narrower.
    let rounds = if F::BENT { POLISHING } else { 0 };
    for _ in 0..rounds {
        let known = region.slots.clone();
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            region.slots[*slot] = region.slots[*slot].marked(region.count + i);
        }
        let narrower = centre.map(layout, basis, region);
        region.slots = known;
        let Ok(narrower) = narrower else { break };
        // The bounds that follow need a contraction.
        if image_ratio(&narrower.times(&box_of), &box_of) >= 1.0 {
            break;
        }
        mapped = Mapped {
            eta: mapped.eta,
            ..narrower
        };
        centre.settle(layout, region, &mapped, &box_of);
    }
    Ok(centre.roughness(layout, region))
}

impl Centre {
    fn new<F: DimensionForm>(
        layout: &Layout,
        basis: &[usize],
        region: &Region<F>,
    ) -> Result<Self, Unbounded> {
        let (n, m, columns) = (layout.own(), region.count, layout.slots.len());
        if basis.len() != n {
            return Err(Reason::Singular.into());
        }
        let nominal: Vec<f64> = region.slots.iter().map(|form| form.nominal()).collect();
        let about = layout.middles(&nominal);
        let rows: Rows<Interval> = layout.rows(&region.centre(), &about);
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

    /// A box that is mapped into itself.
    fn proved_box<F: DimensionForm>(
        &self,
        mechanism: &Mechanism,
        layout: &Layout,
        basis: &[usize],
        region: &mut Region<F>,
    ) -> Result<(Mapped<F>, Vec<f64>), Unbounded> {
        let (n, m) = (self.n, region.count);
        // Along x + S δ itself: what the box adds to it is in |A| w.
        self.place(layout, region, &vec![0.0; n]);
        let mut farthest = self.farthest(layout, mechanism, m);
        let refused = |reason: Reason, dimension| Unbounded { reason, dimension };
        let eta = self.map(layout, basis, region);
        let eta = eta.map_err(|reason| refused(reason, farthest))?.eta;
        // A first box from what the rows are off along the tangent.
        let mut box_of: Vec<f64> = (0..n)
            .map(|i| {
                let slot = layout.block.unknowns[i];
                FIRST_SHARE * eta[i] + NARROWEST * mechanism.scale_of(slot)
            })
            .collect();
        let mut passed: Option<(Mapped<F>, Vec<f64>)> = None;
        for _ in 0..ATTEMPTS {
            // The map of the whole box; where its image lies inside, every piece has a root there.
            self.place(layout, region, &box_of);
            let Ok(mut mapped) = self.map(layout, basis, region) else {
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
        passed.ok_or_else(|| refused(Reason::Singular, farthest))
    }

    /// How much of the way that unknowns go is neither of first nor of second order, at most.
    fn roughness<F: DimensionForm>(&self, layout: &Layout, region: &Region<F>) -> f64 {
        let share = |slot: &usize| {
            let rates = region.rates_of(*slot).iter();
            let (open, way) = rates.fold((0.0, 0.0), |(open, way), rate| {
                (open + rate.beyond(), way + rate.nominal().abs())
            });
            if open > 0.0 { open / way } else { 0.0 }
        };
        layout.block.unknowns.iter().map(share).fold(0.0, f64::max)
    }

    /// Bounds of the solutions z of z = v - A z, where |v| is at most `from(i, k)` for unknown i and dimension k: unknown after
    /// unknown.
    fn solved_columns<F: DimensionForm>(
        &self,
        mapped: &Mapped<F>,
        box_of: &[f64],
        from: impl Fn(usize, usize) -> f64,
    ) -> Vec<f64> {
        let (n, m) = (self.n, mapped.by_dimension.len());
        let mut all = vec![0.0; n * m];
        for k in 0..m {
            let own: Vec<f64> = (0..n).map(|i| from(i, k)).collect();
            let solved = mapped.solved(&own, box_of);
            (0..n).for_each(|i| all[i * m + k] = solved[i]);
        }
        all
    }

    /// z = dx/dδ - S = -G + A G - A A z as forms, unknown after unknown: with the product A G where forms have a second order, else
    /// with bounds.
    fn rate_bends<F: DimensionForm>(&self, mapped: &Mapped<F>, box_of: &[f64]) -> Vec<F> {
        let (n, m) = (self.n, mapped.by_dimension.len());
        let g = |i: usize, k: usize| &mapped.g[i * m + k];
        let column = |of: &dyn Fn(usize) -> f64| mapped.times(&(0..n).map(of).collect::<Vec<_>>());
        let mut all = Vec::with_capacity(n * m);
        all.resize(n * m, F::number(0.0));
        if !F::BENT {
            // |A G| and what follows from it.
            let moved: Vec<Vec<f64>> = (0..m).map(|k| column(&|i| g(i, k).radius())).collect();
            let open = |i: usize, k: usize| {
                (g(i, k).nominal().abs() + g(i, k).beyond() + moved[k][i]) * GROW
            };
            let beyond = self.solved_columns(mapped, box_of, open);
            for (form, (own, open)) in all.iter_mut().zip(mapped.g.iter().zip(beyond)) {
                *form = F::linear(0.0, own.slopes(), open);
            }
            return all.into_iter().map(|form| -form).collect();
        }
        let sizes = self.solved_columns(mapped, box_of, |i, k| g(i, k).magnitude());
        for k in 0..m {
            let once = column(&|i| sizes[i * m + k]);
            let twice = mapped.times(&once);
            for i in 0..n {
                let mut form = -*g(i, k);
                for j in 0..n {
                    form = form + mapped.entries[i * n + j] * *g(j, k);
                }
                all[i * m + k] = form.opened(twice[i]);
            }
        }
        all
    }

    /// Puts the block's unknowns where they are to be looked for.
    fn place<F: DimensionForm>(&self, layout: &Layout, region: &mut Region<F>, box_of: &[f64]) {
        let m = region.count;
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            let rates = &self.rates[i * m..][..m];
            let form = F::linear(region.slots[*slot].nominal(), rates, box_of[i]);
            region.slots[*slot] = form.marked(m + i);
        }
    }

    /// A, G and η over the box.
    fn map<F: DimensionForm>(
        &self,
        layout: &Layout,
        basis: &[usize],
        region: &Region<F>,
    ) -> Result<Mapped<F>, Reason> {
        let (n, m, columns) = (self.n, region.count, layout.slots.len());
        let rows: Rows<F> = layout.rows(&region.slots, &self.about);
        if !rows.jacobian.iter().all(|entry| entry.is_finite()) {
            return Err(Reason::Formula);
        }
        // Fₖ of the rows of the basis.
        let zero = F::number(0.0);
        let mut by_dimension = vec![zero; n * m];
        for (l, row) in basis.iter().enumerate() {
            for (column, slot) in layout.slots.iter().enumerate().skip(n) {
                let by_slot = &rows.jacobian[row * columns + column];
                if *by_slot == zero {
                    continue;
                }
                for (k, rate) in region.rates_of(*slot).iter().enumerate() {
                    let sum = &mut by_dimension[l * m + k];
                    if let Some(number) = rate.as_number() {
                        sum.add_scaled(number, by_slot);
                    } else {
                        *sum = *sum + *by_slot * *rate;
                    }
                }
            }
        }
        let mut mapped = Mapped {
            g: Vec::with_capacity(n * m),
            entries: Vec::with_capacity(n * n),
            a: vec![0.0; n * n],
            eta: self.newton.clone(),
            by_dimension: vec![0.0; m],
        };
        for i in 0..n {
            let mut row: Vec<F> = (self.rates[i * m..][..m].iter())
                .map(|rate| F::number(*rate))
                .collect();
            for l in 0..n {
                let factor = self.inverse[i * n + l];
                for (form, by) in row.iter_mut().zip(&by_dimension[l * m..]) {
                    form.add_scaled(factor, by);
                }
            }
            for column in 0..n {
                let mut entry = F::number(if i == column { -1.0 } else { 0.0 });
                for (l, row) in basis.iter().enumerate() {
                    let factor = self.inverse[i * n + l];
                    entry.add_scaled(factor, &rows.jacobian[row * columns + column]);
                }
                mapped.a[i * n + column] = entry.magnitude();
                let slopes = mapped.by_dimension.iter_mut().zip(entry.slopes());
                slopes.for_each(|(sum, slope)| *sum += slope.abs());
                for (form, rate) in row.iter_mut().zip(&self.rates[column * m..]) {
                    form.add_scaled(*rate, &entry);
                }
                mapped.entries.push(entry.folded(m));
            }
            let open = row
                .iter()
                .map(|g| g.nominal().abs() + 0.5 * g.radius() + g.beyond());
            mapped.eta[i] = (mapped.eta[i] + open.sum::<f64>()) * GROW;
            mapped.g.extend(row.into_iter().map(|form| form.folded(m)));
        }
        Ok(mapped)
    }

    /// Writes the unknowns and their derivatives into the region.
    fn settle<F: DimensionForm>(
        &self,
        layout: &Layout,
        region: &mut Region<F>,
        mapped: &Mapped<F>,
        box_of: &[f64],
    ) {
        let m = region.count;
        // A few more Krawczyk steps shrink the box that maps into itself.
        let narrowed = (0..SWEEPS).fold(box_of.to_vec(), |w, _| mapped.image(&w));
        let open = mapped.solved(&self.newton, box_of);
        let bends = self.rate_bends(mapped, box_of);
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            let tangent = &self.rates[i * m..][..m];
            for (k, rate) in tangent.iter().enumerate() {
                region.rates[slot * m + k] = F::number(*rate) + bends[i * m + k];
            }
            region.open[*slot] = open[i];
            let value = region.slots[*slot].nominal();
            let mut form = F::integral(value, open[i], region.rates_of(*slot));
            // Of first order forms the plain tangent with the box may be tighter than the mean value form.
            if !F::BENT && form.beyond() > narrowed[i] {
                form = F::linear(value, tangent, narrowed[i]);
            }
            region.slots[*slot] = form;
        }
    }
}
