//! Sums of lists of coefficients, in the widest registers of the processor. Every sum takes its terms in the same order whatever
//! their width, and no product is fused with a sum, so that the bits are the same everywhere.

use super::form_room::{LANES, packed_length};
use pulp::{Arch, Simd, WithSimd};
use smallvec::SmallVec;
use std::cmp::Ordering;

/// Some coefficients that are processed together.
pub type CoefficientGroup = [f64; LANES];

/// Lists that are summed at once.
const ROWS: usize = 4;

/// Number of parallel partial sums: in a single sum every addition would wait for the previous one.
const AT_ONCE: usize = 8;

/// Σ |value|, not rounded up.
#[inline(always)]
pub fn sum_of_magnitudes(list: &[f64]) -> f64 {
    let (groups, rest) = list.as_chunks::<AT_ONCE>();
    let mut parts = [0.0; AT_ONCE];
    for group in groups {
        for (part, value) in parts.iter_mut().zip(group) {
            *part += value.abs();
        }
    }
    let rest: f64 = rest.iter().map(|value| value.abs()).sum();
    rest + parts.iter().sum::<f64>()
}

/// The same for a long list.
pub fn long_sum_of_magnitudes(list: &[f64]) -> f64 {
    Arch::new().dispatch(Magnitudes(list))
}

struct Magnitudes<'a>(&'a [f64]);

impl WithSimd for Magnitudes<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (lanes, rest) = self.0.as_chunks::<LANES>();
        let (fours, last) = lanes.as_chunks::<4>();
        let zero = [0.0; LANES];
        let (mut a, mut b, mut c, mut d) = (zero, zero, zero, zero);
        for [p, q, r, s] in fours {
            add_magnitudes(simd, &mut a, p);
            add_magnitudes(simd, &mut b, q);
            add_magnitudes(simd, &mut c, r);
            add_magnitudes(simd, &mut d, s);
        }
        for lanes in last {
            add_magnitudes(simd, &mut a, lanes);
        }
        let parts = [a, b, c, d].map(|part| part.iter().sum::<f64>());
        parts.iter().sum::<f64>() + rest.iter().map(|value| value.abs()).sum::<f64>()
    }
}

/// Adds the magnitudes of some coefficients.
#[inline(always)]
fn add_magnitudes<S: Simd>(simd: S, sum: &mut CoefficientGroup, list: &CoefficientGroup) {
    let (sums, last) = S::as_mut_simd_f64s(sum);
    let (values, others) = S::as_simd_f64s(list);
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum = simd.add_f64s(*sum, simd.abs_f64s(*value));
    }
    let rest = last.iter_mut().zip(others);
    rest.for_each(|(sum, value)| *sum += value.abs());
}

/// Adds `factor` times a list, which may be longer than the sum.
#[inline(always)]
pub fn add_list(sum: &mut Vec<f64>, factor: f64, list: &[f64]) {
    let (own, more) = list.split_at(sum.len().min(list.len()));
    for (sum, added) in sum.iter_mut().zip(own) {
        *sum += factor * added;
    }
    sum.extend(more.iter().map(|added| factor * added));
}

/// The same for a long list.
pub fn add_long_list(sum: &mut Vec<f64>, factor: f64, list: &[f64]) {
    if sum.len() < list.len() {
        sum.resize(list.len(), 0.0);
    }
    let sum = &mut sum[..list.len()];
    Arch::new().dispatch(Scaled { sum, factor, list });
}

struct Scaled<'a> {
    sum: &'a mut [f64],
    factor: f64,
    list: &'a [f64],
}

impl WithSimd for Scaled<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (sums, last) = S::as_mut_simd_f64s(self.sum);
        let (values, others) = S::as_simd_f64s(self.list);
        let factors = simd.splat_f64s(self.factor);
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum = simd.add_f64s(*sum, simd.mul_f64s(*value, factors));
        }
        let rest = last.iter_mut().zip(others);
        rest.for_each(|(sum, value)| *sum += value * self.factor);
    }
}

/// Sets a sum to two lists times their factors; behind both it is zero.
pub fn set_to_two(sum: &mut [f64], a: (f64, &[f64]), b: (f64, &[f64])) {
    let (longer, shorter) = match a.1.len() < b.1.len() {
        true => (b, a),
        false => (a, b),
    };
    let (both, more) = sum.split_at_mut(shorter.1.len());
    let (beside, others) = longer.1.split_at(both.len());
    let (alone, none) = more.split_at_mut(others.len());
    Arch::new().dispatch(TwoScaled {
        sum: both,
        factors: [longer.0, shorter.0],
        lists: [beside, shorter.1],
    });
    let pairs = alone.iter_mut().zip(others);
    pairs.for_each(|(sum, value)| *sum = longer.0 * value);
    none.fill(0.0);
}

struct TwoScaled<'a> {
    sum: &'a mut [f64],
    factors: [f64; 2],
    lists: [&'a [f64]; 2],
}

impl WithSimd for TwoScaled<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [p, q] = self.factors;
        let [x, y] = self.lists;
        let (sums, last) = S::as_mut_simd_f64s(self.sum);
        let ((xs, x), (ys, y)) = (S::as_simd_f64s(x), S::as_simd_f64s(y));
        let [ps, qs] = [p, q].map(|factor| simd.splat_f64s(factor));
        for (sum, (x, y)) in sums.iter_mut().zip(xs.iter().zip(ys)) {
            *sum = simd.add_f64s(simd.mul_f64s(*x, ps), simd.mul_f64s(*y, qs));
        }
        for (sum, (x, y)) in last.iter_mut().zip(x.iter().zip(y)) {
            *sum = x * p + y * q;
        }
    }
}

/// Adds to sum `i` of `sums`, each at least as long as all lists, list `k` times `factors[i * lists.len() + k]`. What sums that are
/// `unset` contain is ignored.
pub fn add_combinations(
    sums: &mut [&mut [f64]],
    factors: &[f64],
    lists: &[&[f64]],
    are_unset: bool,
) {
    let count = lists.len();
    let length = lists.iter().map(|list| list.len()).max().unwrap_or(0);
    if count == 0 || length == 0 {
        return;
    }
    // All lists side by side, filled up with zeros.
    let mut packed = vec![[0.0; LANES]; length.div_ceil(LANES) * count];
    Arch::new().dispatch(SideBySide {
        packed: &mut packed,
        lists,
    });
    let mut by_row = vec![[0.0; ROWS]; count];
    for (rows, factors) in sums.chunks_mut(ROWS).zip(factors.chunks(ROWS * count)) {
        for (r, factors) in factors.chunks_exact(count).enumerate() {
            let places = by_row.iter_mut().zip(factors);
            places.for_each(|(place, factor)| place[r] = *factor);
        }
        Arch::new().dispatch(Combinations {
            sums: rows,
            factors: &by_row,
            packed: &packed,
            end: length,
            are_unset,
        });
    }
}

/// Lists that are copied beside each other.
struct SideBySide<'a, 'l> {
    packed: &'a mut [CoefficientGroup],
    lists: &'a [&'l [f64]],
}

impl WithSimd for SideBySide<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let count = self.lists.len();
        for (k, list) in self.lists.iter().enumerate() {
            let (whole, rest) = list.as_chunks::<LANES>();
            let mut places = self.packed[k..].iter_mut().step_by(count);
            for (lanes, place) in whole.iter().zip(places.by_ref()) {
                *place = *lanes;
            }
            if let (false, Some(place)) = (rest.is_empty(), places.next()) {
                place[..rest.len()].copy_from_slice(rest);
            }
        }
    }
}

/// Lists that lie side by side, added to a few sums up to an end.
struct Combinations<'a, 's> {
    sums: &'a mut [&'s mut [f64]],
    factors: &'a [[f64; ROWS]],
    packed: &'a [CoefficientGroup],
    end: usize,
    are_unset: bool,
}

impl WithSimd for Combinations<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            sums,
            factors,
            packed,
            end,
            are_unset,
        } = self;
        for (index, lists) in packed.chunks_exact(factors.len()).enumerate() {
            let at = index * LANES..end.min((index + 1) * LANES);
            let mut rows = [[0.0; LANES]; ROWS];
            let known = if are_unset { 0 } else { sums.len() };
            for (row, sum) in rows.iter_mut().zip(sums.iter().take(known)) {
                match sum[at.clone()].first_chunk::<LANES>() {
                    Some(values) => *row = *values,
                    None => row[..at.len()].copy_from_slice(&sum[at.clone()]),
                }
            }
            let [mut a, mut b, mut c, mut d] = rows;
            for (list, [p, q, r, s]) in lists.iter().zip(factors) {
                add_scaled(simd, &mut a, list, *p);
                add_scaled(simd, &mut b, list, *q);
                add_scaled(simd, &mut c, list, *r);
                add_scaled(simd, &mut d, list, *s);
            }
            for (row, sum) in [a, b, c, d].iter().zip(sums.iter_mut()) {
                let places = &mut sum[at.clone()];
                match places.first_chunk_mut::<LANES>() {
                    Some(values) => *values = *row,
                    None => places.copy_from_slice(&row[..places.len()]),
                }
            }
        }
    }
}

/// Adds `factor` times some coefficients.
#[inline(always)]
fn add_scaled<S: Simd>(simd: S, sum: &mut CoefficientGroup, list: &CoefficientGroup, factor: f64) {
    let (sums, last) = S::as_mut_simd_f64s(sum);
    let (values, others) = S::as_simd_f64s(list);
    let factors = simd.splat_f64s(factor);
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum = simd.add_f64s(*sum, simd.mul_f64s(*value, factors));
    }
    // Registers that are wider than these.
    let rest = last.iter_mut().zip(others);
    rest.for_each(|(sum, value)| *sum += value * factor);
}

/// A list times a factor, filled up with zeros to so many numbers.
pub fn in_lanes(list: &[f64], factor: f64, span: usize) -> SmallVec<[CoefficientGroup; 6]> {
    let mut lanes: SmallVec<[CoefficientGroup; 6]> =
        SmallVec::from_elem([0.0; LANES], span.div_ceil(LANES));
    let places = lanes.iter_mut().flatten().zip(list);
    places.for_each(|(place, value)| *place = factor * value);
    lanes
}

/// Factors of first order of a few products that are summed together.
#[derive(Clone, Debug)]
pub struct FactorLists {
    /// So many products.
    count: usize,
    /// Of so many numbers.
    span: usize,
    /// Group by group, those of all products side by side.
    lanes: Vec<CoefficientGroup>,
    /// Number by number, those of all products side by side.
    single: Vec<f64>,
}

impl FactorLists {
    /// One factor of every product, each with at most `span` coefficients.
    pub fn new<'a>(lists: impl ExactSizeIterator<Item = &'a [f64]>, span: usize) -> Self {
        let (count, groups) = (lists.len(), span.div_ceil(LANES));
        let mut all = Self {
            count,
            span,
            lanes: vec![[0.0; LANES]; groups * count],
            single: vec![0.0; groups * LANES * count],
        };
        for (k, list) in lists.enumerate() {
            for (l, value) in list.iter().enumerate() {
                all.lanes[l / LANES * count + k][l % LANES] = *value;
                all.single[l * count + k] = *value;
            }
        }
        all
    }

    /// How many numbers they depend on.
    pub fn span(&self) -> usize {
        self.span
    }
}

/// Adds Σ (xₖ yₗ + yₖ xₗ) for all k < l and Σ xₗ yₗ, summed over as many products of as many numbers, to a packed list of those.
pub fn add_symmetric_products(sum: &mut [f64], x: &FactorLists, y: &FactorLists) {
    let (sums, _) = sum.as_chunks_mut::<LANES>();
    Arch::new().dispatch(SymmetricProducts { sums, x, y });
}

struct SymmetricProducts<'a> {
    sums: &'a mut [CoefficientGroup],
    x: &'a FactorLists,
    y: &'a FactorLists,
}

impl WithSimd for SymmetricProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { sums, x, y } = self;
        let FactorLists { count, span, .. } = *x;
        for l in 0..span {
            let single = l * count..(l + 1) * count;
            let (p, q) = (&x.single[single.clone()], &y.single[single]);
            let column = &mut sums[packed_length(l) / LANES..][..=l / LANES];
            for (c, place) in column.iter_mut().enumerate() {
                let lanes = c * count..(c + 1) * count;
                let (xs, ys) = (&x.lanes[lanes.clone()], &y.lanes[lanes]);
                let terms = xs.iter().zip(ys).zip(p.iter().zip(q));
                let mut both = *place;
                if c < l / LANES {
                    for ((x, y), (p, q)) in terms {
                        add_scaled(simd, &mut both, x, *q);
                        add_scaled(simd, &mut both, y, *p);
                    }
                    *place = both;
                    continue;
                }
                let mut once = *place;
                for ((x, y), (p, q)) in terms {
                    add_scaled(simd, &mut once, x, *q);
                    add_scaled(simd, &mut both, x, *q);
                    add_scaled(simd, &mut both, y, *p);
                }
                *place = to_diagonal(&both, &once, l % LANES);
            }
        }
    }
}

/// The same for one product, whose factors are filled up with zeros to as many lanes.
pub fn add_symmetric_product(
    sum: &mut [f64],
    x: &[CoefficientGroup],
    y: &[CoefficientGroup],
    span: usize,
) {
    let (sums, _) = sum.as_chunks_mut::<LANES>();
    Arch::new().dispatch(SymmetricProduct { sums, x, y, span });
}

struct SymmetricProduct<'a> {
    sums: &'a mut [CoefficientGroup],
    x: &'a [CoefficientGroup],
    y: &'a [CoefficientGroup],
    span: usize,
}

impl WithSimd for SymmetricProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { sums, x, y, span } = self;
        let mut rest = sums;
        for (group, (xs, ys)) in x.iter().zip(y).enumerate() {
            // Columns of one length.
            let length = group + 1;
            let count = LANES.min(span - group * LANES);
            let (columns, more) = rest.split_at_mut(count * length);
            rest = more;
            for (r, column) in columns.chunks_exact_mut(length).enumerate() {
                let (p, q) = (xs[r], ys[r]);
                let Some((last, others)) = column.split_last_mut() else {
                    continue;
                };
                if p == 0.0 && q == 0.0 {
                    continue;
                }
                for (sum, (x, y)) in others.iter_mut().zip(x.iter().zip(y)) {
                    add_scaled(simd, sum, x, q);
                    add_scaled(simd, sum, y, p);
                }
                let mut once = *last;
                add_scaled(simd, &mut once, xs, q);
                let mut both = once;
                add_scaled(simd, &mut both, ys, p);
                *last = to_diagonal(&both, &once, r);
            }
        }
    }
}

/// The end of a column: the diagonal counts once, and behind it is nothing.
#[inline(always)]
fn to_diagonal(
    both: &CoefficientGroup,
    once: &CoefficientGroup,
    diagonal: usize,
) -> CoefficientGroup {
    std::array::from_fn(|i| match i.cmp(&diagonal) {
        Ordering::Less => both[i],
        Ordering::Equal => once[i],
        Ordering::Greater => 0.0,
    })
}

#[cfg(test)]
mod tests;
