//! Changes of a closed pose's rates when further inputs change: first derivatives along inputs, and mixed second
//! derivatives along two of them, with the factors shared by all linearisations of the pose.
//!
//! Along two tangents of the motion the loop's product is I + st C to the mixed order, and C is skew: its three entries
//! are the mixed derivative of the rotation vector, which the mixed derivative of the unknowns must cancel.

use super::residual_part;
use crate::kinematics::solve::linearisation::REFINEMENTS;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::lanes::lane_groups;
use crate::model::chain::ArgumentValue;
use crate::model::walk::WalkFrame;
use crate::numbers::hyper_dual::HyperDual;

/// Derivatives at closed poses of a mechanism; one per thread.
#[derive(Clone, Debug)]
pub struct Variation<'m> {
    system: &'m System,
    corrector: Corrector,
    slots: Vec<HyperDual>,
    turns: Vec<ArgumentValue<HyperDual>>,
    scratch: Vec<HyperDual>,
    bend: Vec<f64>,
    weakest: SmallestSingular,
}

/// The smallest singular value of the worst block with its singular vectors.
#[derive(Clone, Debug, Default)]
struct SmallestSingular {
    sigma: f64,
    block: usize,
    left: Vec<f64>,
    right: Vec<f64>,
}

/// The iteration for the smallest singular value ends when it changes by less than this fraction.
const SETTLED: f64 = 1e-9;

/// Most iterations; if two singular values are nearly equal, any combination of their vectors is acceptable.
const MAX_TURNS: usize = 40;

impl<'m> Variation<'m> {
    /// Buffers for a mechanism.
    pub fn new(system: &'m System) -> Self {
        let mechanism = system.mechanism();
        Self {
            system,
            corrector: Corrector::new(system),
            slots: Vec::new(),
            turns: vec![ArgumentValue::default(); mechanism.arguments.len()],
            scratch: Vec::new(),
            bend: Vec::new(),
            weakest: SmallestSingular::default(),
        }
    }

    /// Rates of all coordinates at a closed pose with input `moving` at unit rate and the others constant.
    pub fn tangent(&mut self, pose: &[f64], moving: usize, rates: &mut Vec<f64>) {
        rates.clear();
        rates.resize(pose.len(), 0.0);
        rates[self.system.mechanism().unknowns.len() + moving] = 1.0;
        self.corrector.tangent(self.system, pose, rates);
    }

    /// The slots that formulas of a pose may use (coordinates, x, y, z of traces, outputs), at least `count` of them,
    /// along the tangents `first` and `second`.
    pub fn slots(
        &mut self,
        pose: &[f64],
        first: &[f64],
        second: &[f64],
        count: usize,
    ) -> &[HyperDual] {
        let system = self.system;
        let mechanism = system.mechanism();
        let structure = system.structure();
        self.slots.clear();
        let rates = first.iter().zip(second);
        self.slots
            .extend(pose.iter().zip(rates).map(|(q, (s, t))| HyperDual {
                value: *q,
                first: *s,
                second: *t,
                mixed: 0.0,
            }));
        for (index, block) in structure.blocks.iter().enumerate() {
            // Second derivatives block by block: J q'' = -(the terms of the first derivatives).
            self.corrector.blocks[index].linearise(mechanism, block, pose);
            self.solve_block(index, block);
        }
        if count > pose.len() {
            self.add_traces();
        }
        let outputs = count.saturating_sub(self.slots.len());
        for output in mechanism.outputs.iter().take(outputs) {
            let value = output.value_with(mechanism, &self.slots, &mut self.scratch);
            self.slots.push(value);
        }
        &self.slots
    }

    fn solve_block(&mut self, index: usize, block: &Block) {
        self.fill_bend(block);
        let buffers = &mut self.corrector.blocks[index];
        let drift = &mut buffers.workspace.drift;
        drift.clear();
        drift.resize(lane_groups(self.bend.len()), [0.0; 4]);
        drift.as_flattened_mut()[..self.bend.len()].copy_from_slice(&self.bend);
        buffers.solve_drift();
        buffers.refine(REFINEMENTS);
        for (unknown, change) in buffers.changes(block) {
            self.slots[unknown].mixed = change;
        }
    }

    /// The mixed derivative of a block's residual with the present slots. One of the directions must be a tangent of
    /// the motion.
    fn fill_bend(&mut self, block: &Block) {
        let mechanism = self.system.mechanism();
        self.fill_turns(&block.arguments);
        let mut bend = std::mem::take(&mut self.bend);
        bend.clear();
        for part in &block.loops {
            let item = &mechanism.loops[part.index];
            let end = WalkFrame::at_end_of(&item.chain.steps, &self.turns);
            // Mixed part of the loop's product: second derivatives by both directions at once.
            let six = residual_part(end.map(|c| c.mixed), item.size);
            bend.extend(part.components.iter().map(|c| six[*c]));
        }
        for equation in &block.equations {
            let expression = &mechanism.equations[*equation].expression;
            let value = expression.value_with(&self.slots, &mut self.scratch);
            bend.push(value.mixed * mechanism.equations[*equation].weight);
        }
        self.bend = bend;
    }

    /// The smallest singular value of all blocks at a closed pose: its distance from a singular pose. Zero if a block
    /// has no inverse.
    pub fn regularity(&mut self, pose: &[f64]) -> f64 {
        let system = self.system;
        let mechanism = system.mechanism();
        let structure = system.structure();
        let mut weakest = SmallestSingular {
            sigma: f64::INFINITY,
            ..SmallestSingular::default()
        };
        for (index, block) in structure.blocks.iter().enumerate() {
            if block.unknowns.is_empty() {
                continue;
            }
            // One Jacobian per block; the mechanism is as regular as its weakest block.
            self.corrector.blocks[index].linearise(mechanism, block, pose);
            let found = self.weakest_of(index, block);
            if found.sigma < weakest.sigma {
                weakest = found;
            }
        }
        self.weakest = weakest;
        self.weakest.sigma
    }

    /// Power iteration with the inverse.
    fn weakest_of(&self, index: usize, block: &Block) -> SmallestSingular {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let mut found = SmallestSingular {
            block: index,
            ..SmallestSingular::default()
        };
        let Some(inverse) = self.corrector.inverse(index) else {
            return found;
        };
        let mut right = vec![1.0 / (columns as f64).sqrt(); columns];
        let mut last = 0.0;
        for _ in 0..MAX_TURNS {
            // Power iteration with (J Jᵀ)⁻¹ towards the smallest singular value.
            let left: Vec<f64> = (0..rows)
                .map(|i| (0..columns).map(|j| right[j] * inverse.at(i, j)).sum())
                .collect();
            let product = |j: usize| (0..rows).map(|i| inverse.at(i, j) * left[i]).sum::<f64>();
            let next: Vec<f64> = (0..columns).map(product).collect();
            let growth = next.iter().map(|v| v * v).sum::<f64>().sqrt();
            right = next.into_iter().map(|v| v / growth).collect();
            let settled = (growth - last).abs() <= SETTLED * growth;
            last = growth;
            if settled {
                break;
            }
        }
        let jacobian = &self.corrector.blocks[index].workspace.jacobian;
        let along = |i: usize| {
            (0..columns)
                .map(|j| jacobian[j * rows + i] * right[j])
                .sum()
        };
        let left: Vec<f64> = (0..rows).map(along).collect();
        // One product with J itself gives the value and the left vector.
        found.sigma = left.iter().map(|v: &f64| v * v).sum::<f64>().sqrt();
        found.left = left.into_iter().map(|v| v / found.sigma).collect();
        found.right = right;
        found
    }

    /// Rate of the last [`regularity`](Self::regularity), at the same pose, along a tangent.
    pub fn regularity_rate(&mut self, pose: &[f64], tangent: &[f64]) -> f64 {
        let (mechanism, index) = (self.system.mechanism(), self.weakest.block);
        let block = &self.system.structure().blocks[index];
        self.slots.clear();
        let rates = pose.iter().zip(tangent);
        self.slots.extend(rates.map(|(q, t)| HyperDual {
            value: *q,
            first: 0.0,
            second: *t,
            mixed: 0.0,
        }));
        for (unknown, v) in block.unknowns.iter().zip(&self.weakest.right) {
            self.slots[*unknown].first = mechanism.scale_of(*unknown) * v;
        }
        self.fill_bend(block);
        // dσ = uᵀ dJ v, where dJ v is the mixed derivative along v and the tangent.
        let pairs = self.weakest.left.iter().zip(&self.bend);
        pairs.map(|(u, b)| u * b).sum()
    }

    fn fill_turns(&mut self, used: &[usize]) {
        for index in used {
            let argument = &self.system.mechanism().arguments[*index];
            let value = argument.value(&self.slots, &mut self.scratch);
            self.turns[*index] = ArgumentValue::new(value);
        }
    }

    fn add_traces(&mut self) {
        for trace in &self.system.mechanism().traces {
            let path = &self.system.mechanism().bodies[trace.body].world_from_body;
            self.fill_turns(&path.arguments());
            let end = WalkFrame::at_end_of(&path.steps, &self.turns);
            self.slots.extend(end.point(trace.point.to_array()));
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::kinematics::measures::values_along;
    use crate::kinematics::motion::continuation::solve_motion;
    use crate::kinematics::solve::newton::Pace;
    use crate::numbers::series::TaylorSeries;
    use crate::scene::{Overrides, Scene, builtin, load_scene};

    /// Built-in scenes with loops of frames, loops of points and equations, with these parameters as inputs.
    fn varied(name: &str, vary: &[&str]) -> Scene {
        let overrides = Overrides {
            vary: vary.iter().map(|v| (*v).to_owned()).collect(),
            ..Overrides::default()
        };
        load_scene(&builtin::find_builtin(name).unwrap(), &overrides).unwrap()
    }

    fn each_pose(mut test: impl FnMut(&System, &[f64])) {
        let cases: [(&str, &[&str]); 4] = [
            ("torus-torus", &["r1", "gamma1", "q2", "c2"]),
            ("sphere-torus", &["b1", "c2", "gamma2", "s2"]),
            ("sphere-sphere", &["b1", "c2"]),
            ("twin-steer", &[]),
        ];
        for (name, vary) in cases {
            let scene = varied(name, vary);
            let system = System::new(scene.mechanism, &scene.actuation).unwrap();
            let times = [0.13, 0.48, 0.77].map(|share| share * scene.actuation.duration);
            for sample in solve_motion(&system, &scene.actuation, &times).samples {
                let pose = sample.pose.unwrap();
                let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
                test(&system, &coordinates);
            }
        }
    }

    #[test]
    fn mixed_derivatives_are_those_of_the_series() {
        each_pose(|system, pose| {
            let mechanism = system.mechanism();
            let mut variation = Variation::new(system);
            let n = mechanism.unknowns.len();
            let count = n + mechanism.inputs.len();
            let all = count + 3 * mechanism.traces.len() + mechanism.outputs.len();
            let (mut first, mut second) = (Vec::new(), Vec::new());
            for t in 0..mechanism.inputs.len() {
                variation.tangent(pose, 0, &mut first);
                variation.tangent(pose, t, &mut second);
                let slots = variation.slots(pose, &first, &second, all).to_vec();
                let series = |moving: &[usize]| values_along(system, pose, moving, 2).unwrap();
                let (s, alone, both) = (series(&[0]), series(&[t]), series(&[0, t]));
                for (k, slot) in slots.iter().enumerate() {
                    let part = |s: &[TaylorSeries], order: usize| s[k].coefficients()[order];
                    let mixed = part(&both, 2) - part(&s, 2) - part(&alone, 2);
                    let size = 1.0 + slot.value.abs() + mixed.abs();
                    assert!((slot.first - part(&s, 1)).abs() < 1e-10 * size);
                    assert!((slot.second - part(&alone, 1)).abs() < 1e-10 * size);
                    assert!(
                        (slot.mixed - mixed).abs() < 1e-9 * size,
                        "{} slot {k}: {} {mixed}",
                        mechanism.title,
                        slot.mixed
                    );
                }
            }
        });
    }

    #[test]
    fn the_distance_from_singular_poses_changes_as_said() {
        each_pose(|system, pose| {
            let mechanism = system.mechanism();
            let mut variation = Variation::new(system);
            let mut corrector = Corrector::new(system);
            let n = mechanism.unknowns.len();
            for moving in 0..mechanism.inputs.len() {
                let mut tangent = Vec::new();
                variation.tangent(pose, moving, &mut tangent);
                variation.regularity(pose);
                let rate = variation.regularity_rate(pose, &tangent);
                let mut at = |h: f64| {
                    let mut moved: Vec<f64> =
                        pose.iter().zip(&tangent).map(|(q, t)| q + h * t).collect();
                    moved[n + moving] = pose[n + moving] + h;
                    let done = corrector.correct(system, &mut moved, Pace::Brisk);
                    assert!(done.converged);
                    variation.regularity(&moved)
                };
                let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
                assert!(
                    (rate - difference).abs() < 1e-5 * (1.0 + rate.abs()),
                    "{} {moving}: {rate} {difference}",
                    mechanism.title
                );
            }
        });
    }
}
