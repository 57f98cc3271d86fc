//! What a proved box says: the unknowns and their derivatives, and how both become tighter.
//!
//! z = dx/dδ - S is -G - A z. To the second order it is -G + A G - A A z with the product of slopes multiplied out.
//! The bounds on the unknowns that follow are of higher order than the box. Over them A and G hold as they are, only the
//! effects of the box's sides shrink with these.

use super::centre::Centre;
use super::form::{DimensionForm, StoredForm};
use super::mapped::{Contraction, Mapped, SWEEPS, image_ratio};
use super::region::Region;
use super::rows::Layout;
use super::sided::SidedBounds;
use crate::numbers::form_sum::FormSum;
use crate::numbers::rounding::{GROW, UNDERFLOW};

/// Another round must leave less than this share of what was open before.
const GAINED: f64 = 0.9;

/// Coefficients that differ by less than this share of the sides do not need another evaluation.
const ALIKE: f64 = 1e-3;

/// Nor do sides that are at least this share of what they were: what they change to the second order hardly matters.
const NEAR: f64 = 0.8;

impl Centre {
    /// The present bounds on the unknowns are of higher order than the box, so that the same maps over them are
    /// tighter. Returns whether anything was gained.
    pub fn polish<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        basis: &[usize],
        region: &mut Region<'r, F>,
        (box_of, rounds): (&[f64], usize),
    ) -> bool {
        let own = &layout.block.unknowns;
        let mut open = self.open(layout, region);
        let mut last: Option<Evaluated<F>> = None;
        for round in 0..rounds {
            let known: Vec<F> = own.iter().map(|slot| region.slots[*slot]).collect();
            let shares = last.as_ref().and_then(|last| last.shares(&known));
            let evaluated = match (last.take(), shares) {
                (Some(last), Some(shares)) => Some((last, shares)),
                _ => self.evaluated(layout, basis, region, known),
            };
            let Some((evaluated, shares)) = evaluated else {
                return round > 0;
            };
            if !self.narrow(layout, region, (&evaluated, &shares), box_of) {
                return round > 0;
            }
            last = Some(evaluated);
            let before = std::mem::replace(&mut open, self.open(layout, region));
            if round > 0 && open > GAINED * before {
                break;
            }
        }
        true
    }

    /// The maps over the present bounds on the block's unknowns; all sides have their full length.
    fn evaluated<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        basis: &[usize],
        region: &mut Region<'r, F>,
        known: Vec<F>,
    ) -> Option<(Evaluated<F>, Vec<f64>)> {
        let own = &layout.block.unknowns;
        for (i, slot) in own.iter().enumerate() {
            region.slots[*slot] = known[i].marked(self.span + i);
        }
        let varying = self.varying(layout, basis, region);
        let mapped = varying.map(|varying| {
            let g = self.changes(layout, basis, region, &varying);
            self.mapped(varying, g)
        });
        for (slot, form) in own.iter().zip(&known) {
            region.slots[*slot] = *form;
        }
        let mapped = mapped.ok()?;
        let has_sides = self.span + self.n <= region.room.count();
        let evaluated = Evaluated {
            bends: self.bends(&mapped),
            mapped,
            known,
            has_sides,
        };
        Some((evaluated, vec![1.0; self.n]))
    }

    /// Unknowns and derivatives from maps over sides of some lengths; `false` if they are no contraction, which all bounds
    /// need.
    fn narrow<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        region: &mut Region<'r, F>,
        (evaluated, shares): (&Evaluated<F>, &[f64]),
        box_of: &[f64],
    ) -> bool {
        let Mapped { g, entries, .. } = &evaluated.mapped;
        let (by_entry, by_g) = (entries.bounds(shares), g.bounds(shares));
        let a = Contraction(by_entry.sizes.clone());
        let is_narrower = image_ratio(&a.times(box_of), box_of) < 1.0;
        if is_narrower {
            let beyond =
                self.beyond_second_order(&evaluated.mapped, (&by_entry, &by_g), &a, box_of);
            self.write_rates(layout, region, &evaluated.bends, &beyond);
            self.write_slots(layout, region, &a, box_of);
        }
        is_narrower
    }

    /// What the derivatives of the unknowns leave open, in all.
    fn open<F: DimensionForm>(&self, layout: &Layout, region: &Region<F>) -> f64 {
        let unknowns = layout.block.unknowns.iter();
        let rates = unknowns.flat_map(|slot| region.rates_of(*slot));
        rates.map(DimensionForm::beyond).sum()
    }

    /// Writes the unknowns and their derivatives into the region.
    pub fn settle<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        region: &mut Region<'r, F>,
        (mapped, eta): (&Mapped<F>, &[f64]),
        box_of: &[f64],
    ) {
        let m = region.count;
        let shares = vec![1.0; self.n];
        let by_g = mapped.g.bounds(&shares);
        if F::BENT {
            let bounds = (&mapped.entries.bounds(&shares), &by_g);
            let beyond = self.beyond_second_order(mapped, bounds, &mapped.a, box_of);
            self.write_rates(layout, region, &self.bends(mapped), &beyond);
            self.write_slots(layout, region, &mapped.a, box_of);
            return;
        }
        let bends: Vec<F> = mapped.g.list.iter().map(|g| -g.bare()).collect();
        let beyond = self.beyond_first_order(mapped, &by_g, box_of);
        self.write_rates(layout, region, &bends, &beyond);
        self.write_slots(layout, region, &mapped.a, box_of);
        // A few more Krawczyk steps shrink the box that maps into itself. The plain tangent with this box may be tighter
        // than the mean value form.
        let narrowed = (0..SWEEPS).fold(box_of.to_vec(), |w, _| mapped.a.image(eta, &w));
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            let form = &mut region.slots[*slot];
            if form.beyond() > narrowed[i] {
                let tangent = &self.rates[i * m..][..m];
                *form = F::linear(region.room, form.nominal(), tangent, narrowed[i]);
            }
        }
    }

    /// -G + A G without what is bounded, unknown after unknown.
    fn bends<F: DimensionForm>(&self, mapped: &Mapped<F>) -> Vec<F> {
        let Mapped { g, entries, .. } = mapped;
        let prepared = |list: Vec<&F>| F::Sum::factors(&list, self.span);
        let rows = entries.list.chunks_exact(self.n.max(1));
        let rows: Vec<_> = rows.map(|row| prepared(row.iter().collect())).collect();
        let column = |k: usize| prepared(g.list.iter().skip(k).step_by(g.columns).collect());
        let columns: Vec<_> = (0..g.columns).map(column).collect();
        let of = |(place, own): (usize, &F)| {
            let mut sum = F::Sum::new(0.0);
            sum.add_scaled(-1.0, &own.bare());
            sum.add_products_of_slopes(&rows[place / g.columns], &columns[place % g.columns]);
            sum.finish()
        };
        g.list.iter().enumerate().map(of).collect()
    }

    /// Bounds of z + G: of -A z.
    fn beyond_first_order<F: DimensionForm>(
        &self,
        mapped: &Mapped<F>,
        by_g: &SidedBounds,
        box_of: &[f64],
    ) -> Vec<f64> {
        let columns = mapped.g.columns;
        let mut all = vec![0.0; self.n * columns];
        for k in 0..columns {
            let of = |list: &[f64]| list.iter().skip(k).step_by(columns).copied().collect();
            let (radii, rests): (Vec<f64>, Vec<f64>) = (of(&mapped.g.radii), of(&by_g.rests));
            let moved = rests.iter().zip(mapped.a.times(&radii));
            let open: Vec<f64> = moved.map(|(rest, moved)| (rest + moved) * GROW).collect();
            let solved = mapped.a.solved(&open, box_of);
            (0..self.n).for_each(|i| all[i * columns + k] = solved[i]);
        }
        all
    }

    /// Bounds of z + G - A G without the products of slopes: of what these leave of A G, and of A A z.
    fn beyond_second_order<F: DimensionForm>(
        &self,
        mapped: &Mapped<F>,
        (by_entry, by_g): (&SidedBounds, &SidedBounds),
        a: &Contraction,
        box_of: &[f64],
    ) -> Vec<f64> {
        let (n, columns) = (self.n, mapped.g.columns);
        let mut all = by_g.opens.clone();
        for k in 0..columns {
            let sizes = by_g.sizes.iter().skip(k).step_by(columns).copied();
            let sizes = a.solved(&sizes.collect::<Vec<_>>(), box_of);
            let twice = a.times(&a.times(&sizes));
            (0..n).for_each(|i| all[i * columns + k] += twice[i]);
        }
        for (i, sums) in all.chunks_exact_mut(columns.max(1)).enumerate() {
            for j in 0..n {
                let (radius, rest) = (mapped.entries.radii[i * n + j], by_entry.rests[i * n + j]);
                let at = j * columns..(j + 1) * columns;
                let of_g = by_g.rests[at.clone()].iter().zip(&by_g.sizes[at]);
                for (sum, (open, size)) in sums.iter_mut().zip(of_g) {
                    *sum += radius * open + rest * size + UNDERFLOW;
                }
            }
        }
        all.iter().map(|sum| sum * GROW).collect()
    }

    /// Derivatives S + z of the unknowns.
    fn write_rates<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        region: &mut Region<'r, F>,
        bends: &[F],
        beyond: &[f64],
    ) {
        let (m, columns) = (region.count, self.asked.len());
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            for (place, k) in (i * columns..).zip(&self.asked) {
                let rate = F::number(self.rates[i * m + k]);
                region.rates[slot * m + k] = rate + bends[place].opened(beyond[place]);
            }
        }
    }

    /// The unknowns as integrals of their derivatives, from where they are at δ = 0.
    fn write_slots<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        region: &mut Region<'r, F>,
        a: &Contraction,
        box_of: &[f64],
    ) {
        let open = a.solved(&self.newton, box_of);
        for (open, slot) in open.iter().zip(&layout.block.unknowns) {
            region.open[*slot] = *open;
            let value = region.slots[*slot].nominal();
            let rates = region.rates_of(*slot);
            region.slots[*slot] = F::integral(region.room, value, *open, rates);
        }
    }
}

/// The maps of a block, and the bounds on its unknowns over which they hold.
struct Evaluated<F> {
    mapped: Mapped<F>,
    /// -G + A G without what is bounded.
    bends: Vec<F>,
    known: Vec<F>,
    /// Whether the effects of the sides are apart.
    has_sides: bool,
}

impl<F: DimensionForm> Evaluated<F> {
    /// The shares of the sides that the unknowns' bounds take now; `None` if their coefficients have changed.
    fn shares(&self, now: &[F]) -> Option<Vec<f64>> {
        let share = |(before, now): (&F, &F)| {
            let (side, apart) = (before.rest(), before.apart(now));
            let reach = (now.rest() + apart) * GROW;
            let share = if side > 0.0 { reach / side * GROW } else { 1.0 };
            let is_near = share >= NEAR && apart <= ALIKE * reach;
            (self.has_sides && is_near).then(|| share.min(1.0))
        };
        self.known.iter().zip(now).map(share).collect()
    }
}
