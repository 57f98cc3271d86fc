//! Bounds of the rates of all unknowns over a stretch of time around a proved pose.
//!
//! With x the pose in the middle, R near the inverse of its Jacobian, and the unknowns within rho of x for the whole
//! stretch: q >= |I - R J| there, by the second derivatives of [`chain`]; the rate is then -R F_t to within
//! g + q |rate|, where g is what R F_t changes over the stretch. A speed that cannot carry the unknowns out of the ball
//! before the stretch ends proves that they stay in it. Blocks are taken in their order; unknowns of earlier blocks
//! count as inputs of later ones.

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

/// Contraction that is still accepted.
const MAX_Q: f64 = 0.5;

/// Rounding of the columns and of their products with the inverse, relative: far more than they need.
const SLACK: f64 = 1e-12;

/// How often the radius of the ball is enlarged.
const ATTEMPTS: usize = 8;

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
    /// by at most `one` and `two`.
    fn bends(
        &self,
        one: impl Fn(&FormDrift) -> f64,
        two: impl Fn(&FormDrift) -> f64,
    ) -> Vec<[f64; 2]> {
        let form = |a: usize| &self.forms[self.position[a]];
        let bend = |item: &LoopAtPose| {
            let both = item.second_derivatives(|a| one(form(a)) + two(form(a)));
            let (p, q) = (
                item.second_derivatives(|a| one(form(a))),
                item.second_derivatives(|a| two(form(a))),
            );
            [0, 1].map(|k| (0.5 * (both[k] - p[k] - q[k])).max(0.0) + SLACK * both[k])
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
        let product = |i: usize| &self.products[i * m..(i + 1) * m];
        let rates: Vec<f64> = (0..n)
            .map(|i| -product(i).iter().zip(&self.forms).map(|(p, f)| p * f.rate).sum::<f64>())
            .collect();
        let rounding = |i: usize| {
            let terms = product(i).iter().zip(&self.forms);
            SLACK * terms.map(|(p, f)| p.abs() * (f.own_sum + f.speed)).sum::<f64>()
        };
        let identity: Vec<f64> = (0..n).map(|i| self.identity_error(i) + rounding(i)).collect();
        let fastest = rates.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        let mut ball = 1.5 * fastest * half + 2.0 * error + f64::MIN_POSITIVE;
        for _ in 0..ATTEMPTS {
            if !(ball <= BALL) {
                return None;
            }
            let way = |f: &FormDrift| f.play + f.own_sum * ball;
            let of_own = self.bends(|f| f.own_sum, way);
            let of_time = self.bends(|f| f.speed, way);
            let mut contraction: f64 = 0.0;
            let mut speed: f64 = 0.0;
            let bounds: Vec<[f64; 2]> = (0..n)
                .map(|i| {
                    let q = identity[i] + self.weighted(i, &of_own);
                    let loose = product(i).iter().zip(&self.forms);
                    let loose: f64 = loose.map(|(p, f)| p.abs() * f.deviation).sum();
                    let g = loose + self.weighted(i, &of_time) + rounding(i);
                    contraction = contraction.max(q);
                    speed = speed.max(rates[i].abs() + g);
                    [q, g]
                })
                .collect();
            if !(contraction < MAX_Q && speed.is_finite()) {
                return None;
            }
            let speed = speed / (1.0 - contraction);
            if speed * half + error <= ball {
                let drift = |(i, [q, g]): (usize, &[f64; 2])| {
                    let deviation = g + q * speed;
                    Drift {
                        rate: rates[i],
                        deviation,
                        play: ((rates[i].abs() + deviation) * half + error).min(ball),
                        ball,
                    }
                };
                return Some(bounds.iter().enumerate().map(drift).collect());
            }
            ball = 1.3 * (speed * half + error);
        }
        None
    }

    fn identity_error(&self, i: usize) -> f64 {
        let mut row = vec![0.0; self.n];
        row[i] = -1.0;
        let m = self.forms.len();
        for (p, form) in self.products[i * m..(i + 1) * m].iter().zip(&self.forms) {
            form.own.iter().for_each(|(c, rate)| row[*c] += p * rate);
        }
        row.iter().map(|v| v.abs()).sum()
    }
}
