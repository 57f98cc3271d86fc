//! Bounds of the rates of all unknowns over a stretch of time around a proved pose.
//!
//! With z the pose in the middle, A the derivatives of the residual by everything that moves, R near the inverse of
//! their part by the unknowns, and w the rates in the middle, the rates differ from w by
//! R (A(z(t)) - A(z)) (rates), where
//!
//! ```text
//! A(z + tau w + e) - A(z) = tau A' + (second derivatives)(e) + 1/2 (third derivatives)(tau w + e, tau w + e)
//! ```
//!
//! with A' the exact derivative of A along w. If these terms, taken for a box of deviations D (so |e| <= D half), are
//! below D for every unknown, the rates stay within D of w, the unknowns within D half of the straight line, and no
//! other pose closes so near to it: what multiplies the deviations is then a contraction. Blocks are taken in their
//! order; unknowns of earlier blocks count as inputs of later ones.

use super::chain::{ArgumentDouble, LoopAtPose, LoopPlan};
use super::{BALL, Certificate, Certifier};
use crate::kinematics::structure::Block;
use crate::model::expression::Affine;

/// What a coordinate does over a stretch of time. Radians or the scene's unit, per second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drift {
    /// Its rate ...
    pub rate: f64,
    /// ... never differs from that by more than this.
    pub deviation: f64,
    /// It never is farther from its value in the middle than this.
    pub play: f64,
    /// No other closed pose is nearer to the straight line through the middle at the end of the stretch.
    pub tube: f64,
}

impl Drift {
    /// Largest rate.
    pub fn speed(&self) -> f64 {
        self.rate.abs() + self.deviation
    }
}

/// Largest error of a pose, in radians and sizes, that those who use the bounds may neglect as [`POSE_SLACK`] says.
const WELL_PROVED: f64 = 1e-12;

/// No point of a body, a hundred sizes of chain away, is farther from its exact place than this, in sizes.
pub const POSE_SLACK: f64 = 1e-10;

/// Deviation that is granted to unknowns of none, as a part of the largest one.
const LEAST_SHARE: f64 = 1e-3;

/// Rounding of the columns and of their products with the inverse, relative: far more than they need.
const SLACK: f64 = 1e-12;

/// How often the box of speeds is enlarged.
const ATTEMPTS: usize = 12;

/// A form (argument or affine equation) over the stretch.
#[derive(Clone, Default)]
struct FormDrift {
    /// Rate by the block's own unknowns in scaled form.
    own: Vec<(usize, f64)>,
    own_sum: f64,
    /// Rate that comes from elsewhere, its deviation, and the way it makes.
    rate: f64,
    deviation: f64,
    play: f64,
}

/// A form for a given box of deviations: of its rate, of its value from the straight line; its speed, its whole way.
#[derive(Clone, Copy)]
struct Way {
    deviation: f64,
    off: f64,
    speed: f64,
    play: f64,
}

/// One row of the block: which loop and kind it is of, and its derivative by every form.
struct FlowRow {
    /// Loop and component (0 to 2 rotation, 3 to 5 translation); `None` for affine equations.
    place: Option<(usize, usize)>,
    columns: Vec<f64>,
}

impl Certifier<'_> {
    /// Bounds for every coordinate (unknowns, then inputs) over `half` seconds before and after the pose at
    /// `coordinates`, whose inputs move as `inputs` says. `None` where nothing can be proved: the stretch is too long, or
    /// the pose is not proved itself.
    pub fn drift(
        &mut self,
        coordinates: &[f64],
        bases: &[Vec<usize>],
        inputs: &[Drift],
        half: f64,
    ) -> Option<Vec<Drift>> {
        let error = match self.certify(coordinates, bases) {
            Certificate::Certified { error_bound, .. } => error_bound / self.mechanism.size,
            Certificate::Refused { .. } => return None,
        };
        if error > WELL_PROVED {
            return None;
        }
        let error = WELL_PROVED;
        let blank = Affine::default();
        let arguments: Vec<ArgumentDouble> = self.forms[..self.mechanism.arguments.len()]
            .iter()
            .map(|form| ArgumentDouble::new(form.as_ref().unwrap_or(&blank), coordinates))
            .collect();
        let mut all = vec![Drift::default(); self.mechanism.unknowns.len()];
        all.extend_from_slice(inputs);
        for (block, basis) in self.structure.blocks.iter().zip(bases) {
            let flow = BlockFlow::new(self, block, basis, &arguments, &all)?;
            let found = flow.solve(half, error)?;
            for (unknown, mut drift) in block.unknowns.iter().zip(found) {
                let scale = self.mechanism.scale_of(*unknown);
                drift.rate *= scale;
                drift.deviation *= scale;
                drift.play *= scale;
                drift.tube *= scale;
                all[*unknown] = drift;
            }
        }
        Some(all)
    }
}

struct BlockFlow {
    forms: Vec<FormDrift>,
    rows: Vec<FlowRow>,
    loops: Vec<LoopAtPose>,
    /// Position of every form in `forms`.
    position: Vec<usize>,
    /// Near the inverse of the Jacobian, row-major.
    inverse: Vec<f64>,
    /// Its products with the columns of all forms, row-major.
    products: Vec<f64>,
    /// Its products with the rates of these columns along the motion, row-major.
    bent: Vec<f64>,
    n: usize,
}

impl BlockFlow {
    fn new(
        certifier: &Certifier,
        block: &Block,
        basis: &[usize],
        arguments: &[ArgumentDouble],
        all: &[Drift],
    ) -> Option<Self> {
        let mechanism = certifier.mechanism;
        let used = block.arguments.iter().copied();
        let first = mechanism.arguments.len();
        let equations = block.equations.iter().map(|index| first + index);
        let used: Vec<usize> = used.chain(equations).collect();
        let mut position = vec![usize::MAX; certifier.forms.len()];
        let mut forms = Vec::with_capacity(used.len());
        for (k, &index) in used.iter().enumerate() {
            position[index] = k;
            let mut form = FormDrift::default();
            for &(slot, c) in &certifier.forms[index].as_ref()?.terms {
                if let Some(column) = block.column_of[slot] {
                    let rate = c * mechanism.scale_of(slot);
                    form.own.push((column, rate));
                    form.own_sum += rate.abs();
                } else {
                    let drift = &all[slot];
                    form.rate += c * drift.rate;
                    form.deviation += c.abs() * drift.deviation;
                    form.play += c.abs() * drift.play;
                }
            }
            forms.push(form);
        }
        let mut rows = Vec::new();
        let mut loops = Vec::new();
        for part in &block.loops {
            let steps = &mechanism.loops[part.index].chain.steps;
            let reach = |a: usize| {
                let form = &forms[position[a]];
                form.own_sum * BALL + form.play
            };
            let plan = LoopPlan::new(steps, |argument| argument);
            let mut item = LoopAtPose::default();
            item.evaluate(&plan, arguments, reach, mechanism.size);
            let start = rows.len();
            rows.extend(part.components.iter().map(|component| FlowRow {
                place: Some((loops.len(), *component)),
                columns: vec![0.0; forms.len()],
            }));
            for joint in &item.joints {
                let column = item.column(joint);
                for (row, component) in rows[start..].iter_mut().zip(&part.components) {
                    row.columns[position[joint.argument]] += column[*component];
                }
            }
            loops.push(item);
        }
        let first = forms.len() - block.equations.len();
        for (k, index) in block.equations.iter().enumerate() {
            let mut columns = vec![0.0; forms.len()];
            columns[first + k] = mechanism.weight_of(*index);
            let place = None;
            rows.push(FlowRow { place, columns });
        }
        let mut kept: Vec<Option<FlowRow>> = rows.into_iter().map(Some).collect();
        let rows: Vec<FlowRow> = basis.iter().filter_map(|k| kept[*k].take()).collect();
        let n = block.unknowns.len();
        if rows.len() != n {
            return None;
        }
        let mut flow = Self {
            forms,
            rows,
            loops,
            position,
            inverse: Vec::new(),
            products: Vec::new(),
            bent: Vec::new(),
            n,
        };
        flow.invert()?;
        Some(flow)
    }

    fn invert(&mut self) -> Option<()> {
        let (n, m) = (self.n, self.forms.len());
        let mut jacobian = vec![0.0; n * n];
        for (row, out) in self.rows.iter().zip(jacobian.chunks_exact_mut(n.max(1))) {
            for (form, value) in self.forms.iter().zip(&row.columns) {
                form.own
                    .iter()
                    .for_each(|(c, rate)| out[*c] += value * rate);
            }
        }
        self.inverse = invert(jacobian, n)?;
        let columns: Vec<&[f64]> = self.rows.iter().map(|r| &r.columns[..]).collect();
        self.products = self.times_inverse(&columns, m);
        Some(())
    }

    /// The inverse times rows of `m` numbers.
    fn times_inverse(&self, rows: &[&[f64]], m: usize) -> Vec<f64> {
        let n = self.n;
        let mut out = vec![0.0; n * m];
        for i in 0..n {
            for (r, row) in self.inverse[i * n..(i + 1) * n].iter().zip(rows) {
                let sums = out[i * m..(i + 1) * m].iter_mut();
                sums.zip(*row).for_each(|(p, c)| *p += r * c);
            }
        }
        out
    }

    /// Rates of the columns of all rows when the forms move at `rates`.
    fn bend(&mut self, rates: &[f64]) {
        let m = self.forms.len();
        let mut all = vec![vec![0.0; m]; self.rows.len()];
        for (index, item) in self.loops.iter().enumerate() {
            let columns = item.column_rates(|a| rates[self.position[a]]);
            for (joint, column) in item.joints.iter().zip(columns) {
                let form = self.position[joint.argument];
                for (row, out) in self.rows.iter().zip(&mut all) {
                    if let Some((own, component)) = row.place
                        && own == index
                    {
                        out[form] += column[component];
                    }
                }
            }
        }
        let rows: Vec<&[f64]> = all.iter().map(Vec::as_slice).collect();
        self.bent = self.times_inverse(&rows, m);
    }

    /// For every loop and kind of row, a bound of the terms of second and third order for the given ways.
    fn remainders(&self, ways: &[Way]) -> Vec<[f64; 2]> {
        let way = |a: usize| ways[self.position[a]];
        let bound = |item: &LoopAtPose| {
            let both = item.second_derivatives(|a| way(a).off + way(a).speed);
            let first = item.second_derivatives(|a| way(a).off);
            let second = item.second_derivatives(|a| way(a).speed);
            let third = item.third_derivatives(|a| way(a).play, |a| way(a).speed);
            [0, 1].map(|k| {
                let bilinear = (0.5 * (both[k] - first[k] - second[k])).max(0.0);
                bilinear + SLACK * both[k] + 0.5 * third[k]
            })
        };
        self.loops.iter().map(bound).collect()
    }

    /// Sums bounds over the rows, weighted with row `i` of the inverse.
    fn weighted(&self, i: usize, bends: &[[f64; 2]]) -> f64 {
        let weights = &self.inverse[i * self.n..(i + 1) * self.n];
        let of = |row: &FlowRow| {
            row.place
                .map_or(0.0, |(item, component)| bends[item][component / 3])
        };
        weights
            .iter()
            .zip(&self.rows)
            .map(|(w, row)| w.abs() * of(row))
            .sum()
    }

    /// Rates, deviations and plays of the block's unknowns in scaled form.
    fn solve(mut self, half: f64, error: f64) -> Option<Vec<Drift>> {
        let (n, m) = (self.n, self.forms.len());
        let rates: Vec<f64> = (0..n)
            .map(|i| {
                -self
                    .row(&self.products, i)
                    .map(|(p, f)| p * f.rate)
                    .sum::<f64>()
            })
            .collect();
        let of_forms: Vec<f64> = self
            .forms
            .iter()
            .map(|f| f.rate + f.own.iter().map(|(j, c)| c * rates[*j]).sum::<f64>())
            .collect();
        self.bend(&of_forms);
        let loose = |i: usize| -> f64 {
            let ways = self.row(&self.products, i);
            ways.map(|(p, f)| p.abs() * f.deviation).sum()
        };
        let turn = |i: usize| -> f64 {
            let terms = self.bent[i * m..(i + 1) * m].iter().zip(&of_forms);
            half * terms.map(|(p, r)| p * r).sum::<f64>().abs()
        };
        let known: Vec<f64> = (0..n).map(|i| loose(i) + turn(i)).collect();
        let identity: Vec<Vec<f64>> = (0..n).map(|i| self.identity_error(i)).collect();
        let largest = known.iter().fold(0.0, |m: f64, r| m.max(*r));
        let fastest = rates.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        let least = LEAST_SHARE * largest + SLACK * fastest + f64::MIN_POSITIVE;
        let mut box_of: Vec<f64> = known.iter().map(|d| 1.2 * d + least).collect();
        for _ in 0..ATTEMPTS {
            let far = |j: usize| (rates[j].abs() + box_of[j]) * half + error;
            if !(0..n).all(|j| far(j) <= BALL) {
                return None;
            }
            let ways: Vec<Way> = (0..m)
                .map(|k| self.way(k, of_forms[k], &box_of, half, error))
                .collect();
            let remainders = self.remainders(&ways);
            let deviation = |i: usize| {
                let mixed: f64 = (0..n)
                    .map(|j| identity[i][j] * (rates[j].abs() + box_of[j]))
                    .sum();
                let bent = self.bent[i * m..(i + 1) * m].iter().zip(&ways);
                let bent: f64 = bent.map(|(p, w)| p.abs() * w.deviation).sum();
                let rounding = self.row(&self.products, i).zip(&ways);
                let rounding: f64 = rounding.map(|((p, _), w)| p.abs() * w.speed).sum();
                known[i] + half * bent + mixed + self.weighted(i, &remainders) + SLACK * rounding
            };
            let deviations: Vec<f64> = (0..n).map(deviation).collect();
            if (0..n).all(|i| deviations[i] < box_of[i]) {
                let drift = |i: usize| Drift {
                    rate: rates[i],
                    deviation: deviations[i],
                    play: (rates[i].abs() + deviations[i]) * half + error,
                    tube: box_of[i] * half + error,
                };
                return Some((0..n).map(drift).collect());
            }
            box_of = deviations.iter().map(|d| 1.2 * d + least).collect();
        }
        None
    }

    /// Row `i` of a product with the columns, beside the forms.
    fn row<'a>(
        &'a self,
        of: &'a [f64],
        i: usize,
    ) -> impl Iterator<Item = (&'a f64, &'a FormDrift)> {
        let m = self.forms.len();
        of[i * m..(i + 1) * m].iter().zip(&self.forms)
    }

    /// What form `k` does, if the unknowns' rates deviate by `box_of`.
    fn way(&self, k: usize, rate: f64, box_of: &[f64], half: f64, error: f64) -> Way {
        let form = &self.forms[k];
        let own: f64 = form.own.iter().map(|(j, c)| c.abs() * box_of[*j]).sum();
        let deviation = form.deviation + own;
        let off = deviation * half + form.own_sum * error;
        Way {
            deviation,
            off,
            speed: rate.abs() + deviation,
            play: rate.abs() * half + off,
        }
    }

    /// Row `i` of I - R J.
    fn identity_error(&self, i: usize) -> Vec<f64> {
        let mut row = vec![0.0; self.n];
        row[i] = -1.0;
        let m = self.forms.len();
        for (p, form) in self.products[i * m..(i + 1) * m].iter().zip(&self.forms) {
            form.own.iter().for_each(|(c, rate)| row[*c] += p * rate);
        }
        row.iter().map(|v| v.abs()).collect()
    }
}

/// Inverse of a row-major `n` × `n` matrix by Gauss and Jordan with row pivots. Any result serves the proof: how
/// good it is is measured afterwards.
fn invert(mut a: Vec<f64>, n: usize) -> Option<Vec<f64>> {
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
