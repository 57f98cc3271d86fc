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

use super::block_box::BlockBox;
use super::centre::{Centre, Varying};
use super::form::{DimensionForm, StoredForm};
use super::mapped::{Mapped, SWEEPS, image_ratio};
use super::region::Region;
use super::rows::Layout;
use crate::kinematics::results::certificate::Reason;
use crate::model::mechanism::Mechanism;
use crate::numbers::form_room::FormRoom;
use crate::numbers::form_sum::FormSum;
use crate::numbers::rounding::GROW;

/// The first box, as a multiple of its image if the Jacobian varied as along the tangent.
const FIRST_SHARE: f64 = 1.2;

/// Narrowest box, in scaled unknowns: about the rounding of the residual.
const NARROWEST: f64 = 1e-13;

/// Factor by which a box that fails is widened beyond its image.
const WIDENED: f64 = 1.5;

/// Factor by which a box that passes is narrowed, but not below its image.
const NARROWED: f64 = 1.1;

/// Boxes that are tried.
const ATTEMPTS: usize = 10;

/// A box whose image takes more than this share of it is tight enough.
const SHARP: f64 = 0.6;

/// How often the maps are repeated with the unknowns known to second order.
const POLISHING: usize = 2;

/// Another round must leave less than this share of what was open before.
const GAINED: f64 = 0.9;

/// Why there is no box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unbounded {
    /// In the words of certificates.
    pub reason: Reason,
    /// The dimension that changes the Jacobian most.
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

/// Encloses the block's unknowns in `region`, which contains the enclosures of everything the block depends on. `basis`
/// has as many rows as unknowns. Returns the largest share of the unknowns' range that remains open.
pub fn enclose_block<'r, F: StoredForm<'r>>(
    mechanism: &Mechanism,
    layout: &Layout,
    basis: &[usize],
    region: &mut Region<'r, F>,
) -> Result<f64, Unbounded> {
    let centre = Centre::new(layout, basis, region)?;
    let (mapped, box_of) = centre.proved_box(mechanism, layout, basis, region)?;
    centre.settle(layout, region, &mapped, &box_of);
    if F::BENT {
        centre.polish(layout, basis, region, (&box_of, POLISHING));
    }
    let roughness = centre.roughness(layout, region);
    region.boxes.push(BlockBox {
        inverse: centre.inverse,
        rates: centre.rates,
        about: centre.about,
        basis: basis.to_vec(),
        contraction: mapped.a,
        sides: box_of,
        roughness,
    });
    Ok(roughness)
}

/// Encloses the block's unknowns again in at most so many rounds, with all slots known: to second order if the first left
/// much open.
pub fn refine_block<'r, F: StoredForm<'r>>(
    layout: &Layout,
    known: &BlockBox,
    region: &mut Region<'r, F>,
    rounds: usize,
) {
    let open = region.open.clone();
    let centre = Centre::of_box(layout, known, region);
    if !centre.polish(layout, &known.basis, region, (&known.sides, rounds)) {
        region.open = open;
    }
}

impl Centre {
    /// The present bounds on the unknowns are of higher order than the box, so that the same maps over them are
    /// tighter. Returns whether anything was gained.
    fn polish<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        basis: &[usize],
        region: &mut Region<'r, F>,
        (box_of, rounds): (&[f64], usize),
    ) -> bool {
        let mut open = self.open(layout, region);
        for round in 0..rounds {
            let known = region.slots.clone();
            for (i, slot) in layout.block.unknowns.iter().enumerate() {
                region.slots[*slot] = region.slots[*slot].marked(self.span + i);
            }
            let narrower = self
                .varying(layout, basis, region)
                .map(|varying| self.map(layout, basis, region, varying));
            region.slots = known;
            // The bounds that follow need a contraction.
            match narrower {
                Ok(narrower) if image_ratio(&narrower.a.times(box_of), box_of) < 1.0 => {
                    self.settle(layout, region, &narrower, box_of);
                }
                _ => return round > 0,
            }
            let before = std::mem::replace(&mut open, self.open(layout, region));
            if round > 0 && open > GAINED * before {
                break;
            }
        }
        true
    }

    /// What the derivatives of the unknowns leave open, in all.
    fn open<F: DimensionForm>(&self, layout: &Layout, region: &Region<F>) -> f64 {
        let unknowns = layout.block.unknowns.iter();
        let rates = unknowns.flat_map(|slot| region.rates_of(*slot));
        rates.map(DimensionForm::beyond).sum()
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
    fn proved_box<'r, F: StoredForm<'r>>(
        &self,
        mechanism: &Mechanism,
        layout: &Layout,
        basis: &[usize],
        region: &mut Region<'r, F>,
    ) -> Result<(Mapped<F>, Vec<f64>), Unbounded> {
        let (n, m) = (self.n, region.count);
        let mut farthest = self.farthest(layout, mechanism, m);
        let refused = |reason: Reason, dimension| Unbounded { reason, dimension };
        // Along x + S δ itself: the effect of the box is in |A| w.
        self.place(layout, region, &vec![0.0; n]);
        let along = self.varying(layout, basis, region);
        let along = along.map_err(|reason| refused(reason, farthest))?;
        let along = self.map(layout, basis, region, along);
        let eta = along.eta;
        // A first box from the residual along the tangent.
        let mut box_of = (0..SWEEPS).fold(eta.clone(), |w, _| along.a.image(&eta, &w));
        for (side, slot) in box_of.iter_mut().zip(&layout.block.unknowns) {
            *side = FIRST_SHARE * *side + NARROWEST * mechanism.scale_of(*slot);
        }
        let mut passed: Option<(Varying<F>, Vec<f64>)> = None;
        for _ in 0..ATTEMPTS {
            // The map of the whole box; where its image lies inside, every piece has a root there.
            self.place(layout, region, &box_of);
            let Ok(varying) = self.varying(layout, basis, region) else {
                break;
            };
            farthest = varying.farthest(m.min(self.span)).or(farthest);
            let image = varying.a.image(&eta, &box_of);
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
                // Sides that pass are kept: if all grew, the others might never be reached.
                let wider = image.iter().zip(&box_of);
                box_of = wider
                    .map(|(y, w)| if y < w { *w } else { WIDENED * y })
                    .collect();
                continue;
            }
            let swept = (0..SWEEPS).fold(image, |w, _| varying.a.image(&eta, &w));
            passed = Some((varying, box_of));
            if share > SHARP {
                break;
            }
            box_of = swept.iter().map(|w| NARROWED * w).collect();
        }
        let (varying, box_of) = passed.ok_or_else(|| refused(Reason::Singular, farthest))?;
        self.place(layout, region, &box_of);
        let mapped = self.map(layout, basis, region, varying);
        Ok((Mapped { eta, ..mapped }, box_of))
    }

    /// Largest share of the unknowns' range that is neither of first nor of second order.
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
        let (n, m) = (self.n, self.rates.len() / self.n.max(1));
        let mut all = vec![0.0; n * m];
        for k in 0..m.min(self.span) {
            let own: Vec<f64> = (0..n).map(|i| from(i, k)).collect();
            let solved = mapped.a.solved(&own, box_of);
            (0..n).for_each(|i| all[i * m + k] = solved[i]);
        }
        all
    }

    /// z = dx/dδ - S = -G + A G - A A z as forms, unknown after unknown: with the product A G if forms have a second
    /// order, otherwise with bounds.
    fn rate_bends<'r, F: StoredForm<'r>>(
        &self,
        room: &'r FormRoom,
        mapped: &Mapped<F>,
        box_of: &[f64],
    ) -> Vec<F> {
        let (n, m) = (self.n, self.rates.len() / self.n.max(1));
        let g = |i: usize, k: usize| &mapped.g[i * m + k];
        let column =
            |of: &dyn Fn(usize) -> f64| mapped.a.times(&(0..n).map(of).collect::<Vec<_>>());
        let mut all = vec![F::number(0.0); n * m];
        if !F::BENT {
            // |A G| and what follows from it.
            let moved: Vec<Vec<f64>> = (0..m).map(|k| column(&|i| g(i, k).radius())).collect();
            let open = |i: usize, k: usize| {
                (g(i, k).nominal().abs() + g(i, k).beyond() + moved[k][i]) * GROW
            };
            let beyond = self.solved_columns(mapped, box_of, open);
            for (form, (own, open)) in all.iter_mut().zip(mapped.g.iter().zip(beyond)) {
                *form = F::linear(room, 0.0, own.slopes(), open);
            }
            return all.into_iter().map(|form| -form).collect();
        }
        let sizes = self.solved_columns(mapped, box_of, |i, k| g(i, k).magnitude());
        let span = m.min(self.span);
        let rows = mapped.entries.chunks_exact(n.max(1));
        let rows: Vec<_> = rows
            .map(|row| F::Sum::factors(row.to_vec(), span))
            .collect();
        for k in 0..span {
            let once = column(&|i| sizes[i * m + k]);
            let twice = mapped.a.times(&once);
            let of_unknowns = mapped.g.iter().skip(k).step_by(m);
            let by_unknown = F::Sum::factors(of_unknowns.copied().collect(), span);
            for i in 0..n {
                let mut sum = F::Sum::new(0.0);
                sum.add_scaled(-1.0, g(i, k));
                sum.add_products(&rows[i], &by_unknown);
                all[i * m + k] = sum.finish().opened(twice[i]);
            }
        }
        all
    }

    /// Sets the region in which the block's unknowns are sought.
    fn place<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        region: &mut Region<'r, F>,
        box_of: &[f64],
    ) {
        let m = region.count;
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            let rates = &self.rates[i * m..][..m];
            let form = F::linear(region.room, region.slots[*slot].nominal(), rates, box_of[i]);
            region.slots[*slot] = form.marked(self.span + i);
        }
    }

    /// Writes the unknowns and their derivatives into the region.
    fn settle<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        region: &mut Region<'r, F>,
        mapped: &Mapped<F>,
        box_of: &[f64],
    ) {
        let m = region.count;
        // A few more Krawczyk steps shrink the box that maps into itself.
        let narrowed = (0..SWEEPS).fold(box_of.to_vec(), |w, _| mapped.a.image(&mapped.eta, &w));
        let open = mapped.a.solved(&self.newton, box_of);
        let bends = self.rate_bends(region.room, mapped, box_of);
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            let tangent = &self.rates[i * m..][..m];
            for (k, rate) in tangent.iter().enumerate() {
                region.rates[slot * m + k] = F::number(*rate) + bends[i * m + k];
            }
            region.open[*slot] = open[i];
            let value = region.slots[*slot].nominal();
            let mut form = F::integral(region.room, value, open[i], region.rates_of(*slot));
            // For first-order forms the plain tangent with the box may be tighter than the mean value form.
            if !F::BENT && form.beyond() > narrowed[i] {
                form = F::linear(region.room, value, tangent, narrowed[i]);
            }
            region.slots[*slot] = form;
        }
    }
}
