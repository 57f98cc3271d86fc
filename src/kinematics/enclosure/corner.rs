//! One piece within the tolerances, to rounding accuracy: the box that contains one pose of every piece bounds the
//! distance between a nearly closed pose and the closed one.

use super::pose::{Encloser, PoseEnclosure};
use crate::numbers::interval::Interval;
use crate::numbers::rounding::{GROW, SUMS};
use crate::numbers::scalar::Ring;

impl Encloser<'_> {
    /// All coordinates of the piece at δ, which are nearly `coordinates`; `None` if that is not proved.
    ///
    /// From R F(x̃) = R J(ξ) (x̃ - x) = (1 + A) (x̃ - x), with ξ between two poses of the box: |x̃ - x| ≤ |R F(x̃)| +
    /// |A| |x̃ - x|.
    pub fn piece(
        &self,
        enclosure: &PoseEnclosure,
        place: &[f64],
        coordinates: &[f64],
    ) -> Option<Vec<Interval>> {
        let region = &enclosure.region;
        let mut known: Vec<Interval> = coordinates.iter().map(|c| Interval::point(*c)).collect();
        let inputs = self.system.mechanism().unknowns.len()..known.len();
        for slot in inputs {
            let form = &region.slots[slot];
            let drawn = Interval::point(form.value) + Interval::around_zero(region.open[slot]);
            let moved = form.slopes().iter().zip(place).filter(|(s, _)| **s != 0.0);
            known[slot] = moved.fold(drawn, |sum, (slope, d)| {
                sum + Interval::point(*slope).scale(*d)
            });
        }
        for (layout, own) in self.layouts.iter().zip(&region.boxes) {
            let slots = &layout.block.unknowns;
            let (n, m) = (slots.len().max(1), region.count);
            for (i, slot) in slots.iter().enumerate() {
                let (drawn, here) = (region.slots[*slot].value, coordinates[*slot]);
                let moved = own.rates[i * m..][..m].iter().zip(place);
                let (way, size) = moved.fold((0.0, 0.0), |(way, size), (rate, d)| {
                    (way + rate * d, size + (rate * d).abs())
                });
                let off = (here - drawn - way).abs();
                let slack = SUMS * (here.abs() + drawn.abs() + size);
                // What is no number is nowhere.
                let is_inside = off + slack <= own.sides[i];
                if !is_inside {
                    return None;
                }
            }
            let residual = layout.residuals(&known, &own.about);
            let newton = own.inverse.chunks_exact(n).map(|row| {
                let terms = row.iter().zip(&own.basis);
                let sum = terms.fold(Interval::ZERO, |sum, (factor, row)| {
                    sum + residual[*row].scale(*factor)
                });
                sum.magnitude()
            });
            let newton: Vec<f64> = newton.collect();
            if !newton.iter().all(|size| size.is_finite()) {
                return None;
            }
            let off = own.contraction.solved(&newton, &own.sides);
            for (slot, off) in slots.iter().zip(off) {
                known[*slot] = known[*slot] + Interval::around_zero(off * GROW);
            }
        }
        Some(known)
    }
}
