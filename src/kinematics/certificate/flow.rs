//! Bounds of the rates of all unknowns over a stretch of time around a proved pose.
//!
//! With x the pose in the middle and R near the inverse of its Jacobian J, the rate anywhere in the stretch is
//! v + (I - R J) rate + R (change of the derivatives) (rate, rates of the inputs), v the rate in the middle. For a box of
//! speeds s and the way that these make, the last terms are bounded by the second derivatives of [`chain`]. If
//! |v| + these bounds < s for every unknown, then I - (what multiplies the rate) has an inverse everywhere in the box
//! around x that the speeds can reach, the rate stays below s, the unknowns stay in the box, and no other pose closes in
//! it. Blocks are taken in their order; unknowns of earlier blocks count as inputs of later ones.

use super::chain::{ArgumentDouble, LoopAtPose, evaluate};
use super::kantorovich::invert;
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
    /// No other closed pose is within this distance of the middle, for the same inputs.
    pub ball: f64,
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

/// Speed that is granted to unknowns that stand still in the middle, as a part of the fastest one.
const LEAST_SPEED: f64 = 1e-3;

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
    /// Rate that comes from elsewhere, its deviation, its largest size, and the way it makes.
    rate: f64,
    deviation: f64,
    speed: f64,
    play: f64,
}

/// One row of the block: which loop and kind it is of, and its derivative by every form.
struct FlowRow {
    /// Loop and kind (0 rotation, 1 translation); `None` for affine equations.
    place: Option<(usize, usize)>,
    columns: Vec<f64>,
}

impl Certifier<'_> {
    /// Bounds for every coordinate (unknowns, then inputs) over `half` seconds before and after the pose at
    /// `coordinates`, whose inputs move as `inputs` says. `None` where nothing can be proved: the stretch is too long, or
    /// the pose is not proved itself.
    pub fn drift(
        &self,
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
                drift.ball *= scale;
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
        let used: Vec<usize> = used.chain(certifier.equations_of(block)).collect();
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
                    form.speed += c.abs() * drift.speed();
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
            let item = evaluate(steps, arguments, reach, mechanism.size);
            let start = rows.len();
            rows.extend(part.components.iter().map(|component| FlowRow {
                place: Some((loops.len(), component / 3)),
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
            let exponent = mechanism.equations[*index].length_exponent;
            let mut columns = vec![0.0; forms.len()];
            columns[first + k] = mechanism.size.powf(-exponent);
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
                form.own.iter().for_each(|(c, rate)| out[*c] += value * rate);
            }
        }
        self.inverse = invert(jacobian, n)?;
        self.products = vec![0.0; n * m];
        for i in 0..n {
            for (r, row) in self.inverse[i * n..(i + 1) * n].iter().zip(&self.rows) {
                let out = &mut self.products[i * m..(i + 1) * m];
                out.iter_mut().zip(&row.columns).for_each(|(p, c)| *p += r * c);
            }
        }
        Some(())
    }

    /// For every loop and kind of row, a bound of the second derivative along two directions in which the forms change
    /// by at most the two numbers of `ways`.
    fn bends(&self, ways: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let way = |a: usize| ways[self.position[a]];
        let bend = |item: &LoopAtPose| {
            let both = item.second_derivatives(|a| way(a)[0] + way(a)[1]);
            let first = item.second_derivatives(|a| way(a)[0]);
            let second = item.second_derivatives(|a| way(a)[1]);
            [0, 1].map(|k| (0.5 * (both[k] - first[k] - second[k])).max(0.0) + SLACK * both[k])
        };
        self.loops.iter().map(bend).collect()
    }

    /// Sums bounds over the rows, weighted with row `i` of the inverse.
    fn weighted(&self, i: usize, bends: &[[f64; 2]]) -> f64 {
        let weights = &self.inverse[i * self.n..(i + 1) * self.n];
        let of = |row: &FlowRow| row.place.map_or(0.0, |(item, kind)| bends[item][kind]);
        weights.iter().zip(&self.rows).map(|(w, row)| w.abs() * of(row)).sum()
    }

    /// Rates, deviations and plays of the block's unknowns in scaled form.
    fn solve(&self, half: f64, error: f64) -> Option<Vec<Drift>> {
        let (n, m) = (self.n, self.forms.len());
        let product = |i: usize| self.products[i * m..(i + 1) * m].iter().zip(&self.forms);
        let rates: Vec<f64> = (0..n)
            .map(|i| -product(i).map(|(p, f)| p * f.rate).sum::<f64>())
            .collect();
        let loose: Vec<f64> = (0..n)
            .map(|i| product(i).map(|(p, f)| p.abs() * f.deviation).sum())
            .collect();
        let identity: Vec<Vec<f64>> = (0..n).map(|i| self.identity_error(i)).collect();
        let fastest = rates.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        let least = LEAST_SPEED * fastest + error + f64::MIN_POSITIVE;
        let mut speeds: Vec<f64> = rates.iter().map(|r| 1.1 * r.abs() + least).collect();
        for _ in 0..ATTEMPTS {
            let ball = |j: usize| speeds[j] * half + error;
            if !(0..n).all(|j| ball(j) <= BALL) {
                return None;
            }
            let sum = |f: &FormDrift, of: &dyn Fn(usize) -> f64| -> f64 {
                f.own.iter().map(|(j, c)| c.abs() * of(*j)).sum()
            };
            let ways: Vec<[f64; 2]> = self
                .forms
                .iter()
                .map(|f| [f.play + sum(f, &ball), f.speed + sum(f, &|j| speeds[j])])
                .collect();
            let bends = self.bends(&ways);
            let deviation = |i: usize| {
                let rounding: f64 = product(i).zip(&ways).map(|((p, _), w)| p.abs() * w[1]).sum();
                let mixed: f64 = identity[i].iter().zip(&speeds).map(|(e, s)| e * s).sum();
                loose[i] + self.weighted(i, &bends) + mixed + SLACK * rounding
            };
            let deviations: Vec<f64> = (0..n).map(deviation).collect();
            let fits = (0..n).all(|i| rates[i].abs() + deviations[i] < speeds[i]);
            if fits {
                let drift = |i: usize| Drift {
                    rate: rates[i],
                    deviation: deviations[i],
                    play: (rates[i].abs() + deviations[i]) * half + error,
                    ball: ball(i),
                };
                return Some((0..n).map(drift).collect());
            }
            let larger = |i: usize| 1.1 * (rates[i].abs() + deviations[i]) + least;
            speeds = (0..n).map(larger).collect();
        }
        None
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
