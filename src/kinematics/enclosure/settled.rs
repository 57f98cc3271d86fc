//! What a proved box says: the unknowns and their derivatives, and how both become tighter.
//!
//! z = dx/dδ - S is -G - A z. To the second order it is -G + A G - A A z with the product of slopes multiplied out.

use super::centre::Centre;
use super::form::{DimensionForm, StoredForm};
use super::mapped::{Contraction, Mapped, SWEEPS, image_ratio};
use super::region::Region;
use super::rows::Layout;
use crate::numbers::form_sum::FormSum;
use crate::numbers::rounding::{GROW, UNDERFLOW};

/// Another round must leave less than this share of what was open before.
const GAINED: f64 = 0.9;

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
        let mut open = self.open(layout, region);
        for round in 0..rounds {
            let known = region.slots.clone();
            for (i, slot) in layout.block.unknowns.iter().enumerate() {
                region.slots[*slot] = region.slots[*slot].marked(self.span + i);
            }
            let narrower = self.varying(layout, basis, region).map(|varying| {
                let g = self.changes(layout, basis, region, &varying);
                self.mapped(varying, g)
            });
            region.slots = known;
            // The bounds that follow need a contraction.
            match narrower {
                Ok(narrower) if image_ratio(&narrower.a.times(box_of), box_of) < 1.0 => {
                    self.settle_bent(layout, region, &narrower, box_of);
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

    /// Writes the unknowns and their derivatives into the region; η is that along the tangent.
    pub fn settle<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        region: &mut Region<'r, F>,
        (mapped, eta): (&Mapped<F>, &[f64]),
        box_of: &[f64],
    ) {
        if F::BENT {
            return self.settle_bent(layout, region, mapped, box_of);
        }
        let bends: Vec<F> = mapped.g.iter().map(|g| -g.bare()).collect();
        let beyond = self.beyond_first_order(mapped, box_of);
        self.write_rates(layout, region, &bends, &beyond);
        self.write_slots(layout, region, &mapped.a, box_of);
        // A few more Krawczyk steps shrink the box that maps into itself. The plain tangent with this box may be tighter
        // than the mean value form.
        let narrowed = (0..SWEEPS).fold(box_of.to_vec(), |w, _| mapped.a.image(eta, &w));
        let m = region.count;
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            let form = &mut region.slots[*slot];
            if form.beyond() > narrowed[i] {
                let tangent = &self.rates[i * m..][..m];
                *form = F::linear(region.room, form.nominal(), tangent, narrowed[i]);
            }
        }
    }

    /// The same with terms of second order.
    fn settle_bent<'r, F: StoredForm<'r>>(
        &self,
        layout: &Layout,
        region: &mut Region<'r, F>,
        mapped: &Mapped<F>,
        box_of: &[f64],
    ) {
        let beyond = self.beyond_second_order(mapped, box_of);
        self.write_rates(layout, region, &self.bends(mapped), &beyond);
        self.write_slots(layout, region, &mapped.a, box_of);
    }

    /// -G + A G without what is bounded, unknown after unknown.
    fn bends<F: DimensionForm>(&self, Mapped { g, entries, .. }: &Mapped<F>) -> Vec<F> {
        let columns = self.columns();
        let prepared = |list: Vec<&F>| F::Sum::factors(&list, self.span);
        let rows = entries.chunks_exact(self.n.max(1));
        let rows: Vec<_> = rows.map(|row| prepared(row.iter().collect())).collect();
        let column = |k: usize| prepared(g.iter().skip(k).step_by(columns).collect());
        let of_columns: Vec<_> = (0..columns).map(column).collect();
        let of = |(place, own): (usize, &F)| {
            let mut sum = F::Sum::new(0.0);
            sum.add_scaled(-1.0, &own.bare());
            sum.add_products_of_slopes(&rows[place / columns], &of_columns[place % columns]);
            sum.finish()
        };
        g.iter().enumerate().map(of).collect()
    }

    /// Bounds of z + G: of -A z.
    fn beyond_first_order<F: DimensionForm>(
        &self,
        Mapped { g, a, .. }: &Mapped<F>,
        box_of: &[f64],
    ) -> Vec<f64> {
        let columns = self.columns();
        let mut all = vec![0.0; self.n * columns];
        for k in 0..columns {
            let own = || g.iter().skip(k).step_by(columns);
            let moved = a.times(&own().map(DimensionForm::radius).collect::<Vec<_>>());
            let open = own().zip(moved);
            let open = open.map(|(g, moved)| (g.nominal().abs() + g.beyond() + moved) * GROW);
            let solved = a.solved(&open.collect::<Vec<_>>(), box_of);
            (0..self.n).for_each(|i| all[i * columns + k] = solved[i]);
        }
        all
    }

    /// Bounds of z + G - A G without the products of slopes: of what these leave of A G, and of A A z.
    fn beyond_second_order<F: DimensionForm>(
        &self,
        Mapped { g, entries, a }: &Mapped<F>,
        box_of: &[f64],
    ) -> Vec<f64> {
        let (n, columns) = (self.n, self.columns());
        // Of everything except the linear parts, and of the magnitudes.
        let rest = |form: &F| (form.nominal().abs() + form.beyond()) * GROW;
        let rests: Vec<f64> = g.iter().map(rest).collect();
        let sizes: Vec<f64> = g.iter().map(DimensionForm::magnitude).collect();
        let mut all: Vec<f64> = g.iter().map(|g| g.nominal().abs() + g.rest()).collect();
        for k in 0..columns {
            let sizes = sizes.iter().skip(k).step_by(columns).copied();
            let sizes = a.solved(&sizes.collect::<Vec<_>>(), box_of);
            let twice = a.times(&a.times(&sizes));
            (0..n).for_each(|i| all[i * columns + k] += twice[i]);
        }
        // (line + rest) (line + rest) without line · line.
        for (i, sums) in all.chunks_exact_mut(columns.max(1)).enumerate() {
            for (j, entry) in entries[i * n..][..n].iter().enumerate() {
                let (radius, open) = (entry.radius(), rest(entry));
                let at = j * columns..(j + 1) * columns;
                let of_g = rests[at.clone()].iter().zip(&sizes[at]);
                for (sum, (rest, size)) in sums.iter_mut().zip(of_g) {
                    *sum += radius * rest + open * size + UNDERFLOW;
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
        let (m, columns) = (region.count, self.columns());
        for (i, slot) in layout.block.unknowns.iter().enumerate() {
            for (place, k) in (i * columns..).zip(0..columns) {
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
