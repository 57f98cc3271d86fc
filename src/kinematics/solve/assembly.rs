//! Finding a first closed pose from start values that may be far off: Levenberg-Marquardt, then Newton.

use super::newton::{CLOSURE_TOLERANCE, Corrector, Pace};
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::model::chain::{Argument, Motion, Step};
use crate::model::mechanism::{Kind, Mechanism};
use std::f64::consts::{PI, TAU};

/// Most iterations per block and start.
const MAX_ITERATIONS: u32 = 200;

/// Most iterations per block and weight for a remaining gap: far from closing, the linear model sees one part of the
/// curvature only, and convergence is linear.
const GAP_ITERATIONS: u32 = 3000;

/// Longest step in scaled unknowns (radians, or mechanism sizes): beyond it the linear model says nothing.
const MAX_STEP: f64 = 0.5;

/// Newton takes over below this residual.
const HAND_OVER: f64 = 1e-7;

/// Damping starts small, so that a good start converges like Newton from the first step on.
const FIRST_DAMPING: f64 = 1e-3;

/// Damping at which no step can reduce the residual any more: a local minimum.
const LAST_DAMPING: f64 = 1e10;

/// Weights of rotations against distances over the size when the remaining distance is measured: what is left of the
/// compromise is one over the last one's square. The valley is too narrow to be followed at once.
const TURNS_FIRST: [f64; 4] = [1e1, 1e2, 1e3, 1e4];

/// Perturbed starts that are tried after the given one, with growing amplitude.
const EXTRA_STARTS: usize = 24;

/// A pose could not be found.
#[derive(Clone, Debug, PartialEq)]
pub struct NotClosed {
    /// Name of the loop or equation with the largest remaining gap.
    pub name: String,
    /// Smallest remaining rotation found, radians (zero for an equation).
    pub angle: f64,
    /// Smallest remaining distance found, in the scene's unit (or the value of an equation).
    pub distance: f64,
    /// Unknowns, then inputs, of the best pose found.
    pub coordinates: Vec<f64>,
}

/// A closed pose and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembled {
    /// Unknowns, then inputs.
    pub coordinates: Vec<f64>,
    /// Iterations of all tries.
    pub iterations: u32,
    /// Zero for the given start, else the number of the perturbed start that succeeded.
    pub start: usize,
}

/// Closes all loops from the unknowns in `start` (unknowns, then inputs), trying perturbed starts if `persist`.
pub fn assemble(
    system: &System,
    corrector: &mut Corrector,
    start: &[f64],
    persist: bool,
) -> Result<Assembled, NotClosed> {
    let mechanism = system.mechanism();
    let mut best: Option<NotClosed> = None;
    let mut iterations = 0;
    for attempt in 0..=if persist { EXTRA_STARTS } else { 0 } {
        let mut coordinates = start.to_vec();
        perturb(mechanism, attempt, &mut coordinates);
        match close(system, corrector, &mut coordinates, &mut iterations) {
            Ok(()) => {
                return Ok(Assembled {
                    coordinates,
                    iterations,
                    start: attempt,
                });
            }
            Err(gap) => {
                let size = |g: &NotClosed| g.angle.max(g.distance / mechanism.size);
                if best.as_ref().is_none_or(|b| size(&gap) < size(b)) {
                    best = Some(gap);
                }
            }
        }
    }
    Err(best.unwrap_or(NotClosed {
        name: String::new(),
        angle: 0.0,
        distance: 0.0,
        coordinates: start.to_vec(),
    }))
}

/// How much is lacking where a mechanism cannot be closed: from the best pose found, rotations are closed first,
/// then the distance is made small. A plain least-squares pose trades one for the other.
pub fn smallest_gap(system: &System, best: NotClosed) -> NotClosed {
    let mechanism = system.mechanism();
    let structure = system.structure();
    let mut descent = Descent {
        most: GAP_ITERATIONS,
        enough: CLOSURE_TOLERANCE,
        ..Descent::default()
    };
    let mut coordinates = best.coordinates.clone();
    for block in &structure.blocks {
        let mut left = f64::INFINITY;
        for weight in TURNS_FIRST {
            descent.turn_weight = weight;
            left = descent.minimise(mechanism, block, &mut coordinates).1;
        }
        if left > CLOSURE_TOLERANCE {
            return gap(mechanism, block, &coordinates);
        }
    }
    best
}

/// Moves the unknowns of start number `attempt` by a repeatable random amount; start 0 stays.
fn perturb(mechanism: &Mechanism, attempt: usize, coordinates: &mut [f64]) {
    if attempt == 0 {
        return;
    }
    let amplitude = 0.3 + 2.8 * attempt as f64 / EXTRA_STARTS as f64;
    shake(mechanism, attempt, amplitude, coordinates);
}

/// Moves every unknown by a random amount up to `amplitude` in scaled unknowns; the same for the same `attempt`.
pub fn shake(mechanism: &Mechanism, attempt: usize, amplitude: f64, coordinates: &mut [f64]) {
    let mut state = 0x2545_f491_4f6c_dd1d_u64.wrapping_mul(attempt as u64 + 1);
    for (index, value) in coordinates[..mechanism.unknowns.len()]
        .iter_mut()
        .enumerate()
    {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let random = (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
        *value += mechanism.scale_of(index) * amplitude * random;
    }
}

fn close(
    system: &System,
    corrector: &mut Corrector,
    coordinates: &mut [f64],
    iterations: &mut u32,
) -> Result<(), NotClosed> {
    let mechanism = system.mechanism();
    let structure = system.structure();
    let mut descent = Descent::default();
    for (index, block) in structure.blocks.iter().enumerate() {
        *iterations += descent.minimise(mechanism, block, coordinates).0;
        let before = coordinates.to_vec();
        let correction = corrector.correct_block(system, index, coordinates, Pace::Patient);
        *iterations += correction.iterations;
        if !correction.converged {
            coordinates.copy_from_slice(&before);
            return Err(gap(mechanism, block, coordinates));
        }
    }
    wrap_angles(mechanism, coordinates);
    Ok(())
}

/// Angles from a long search may have made whole turns; they are brought to -π..π where nothing but plain
/// rotations by whole multiples uses them.
fn wrap_angles(mechanism: &Mechanism, coordinates: &mut [f64]) {
    for (slot, (unknown, value)) in mechanism.unknowns.iter().zip(coordinates).enumerate() {
        if unknown.kind == Kind::Angle && value.abs() > PI && !turns_matter(mechanism, slot) {
            *value -= TAU * (*value / TAU).round();
        }
    }
}

/// Whether a whole turn of the coordinate changes anything: it drives a translation, a gear or an equation.
pub(crate) fn turns_matter(mechanism: &Mechanism, slot: usize) -> bool {
    let mut steps = mechanism.chains().flat_map(|c| &c.steps);
    let translated = steps.any(|step| match step {
        Step::Joint {
            motion: Motion::Translation,
            argument,
            ..
        } => mechanism.arguments[*argument].coordinates().contains(&slot),
        _ => false,
    });
    let geared = mechanism.arguments.iter().any(|argument| match argument {
        Argument::Affine(affine) => affine
            .terms
            .iter()
            .any(|(s, c)| *s == slot && c.number().fract() != 0.0),
        Argument::Formula(expression) => expression.slots().contains(&slot),
    });
    translated
        || geared
        || mechanism
            .equations
            .iter()
            .any(|e| e.expression.slots().contains(&slot))
}

struct Descent {
    most: u32,
    /// It ends when no entry of the residual is larger.
    enough: f64,
    /// Rows of rotations count this many times.
    turn_weight: f64,
    weights: Vec<f64>,
    workspace: BlockWorkspace,
    trial: BlockWorkspace,
    qr: PivotedQr,
    matrix: Vec<f64>,
    right_side: Vec<f64>,
    step: Vec<f64>,
}

impl Default for Descent {
    fn default() -> Self {
        Self {
            most: MAX_ITERATIONS,
            enough: HAND_OVER,
            turn_weight: 1.0,
            weights: Vec::new(),
            workspace: BlockWorkspace::default(),
            trial: BlockWorkspace::default(),
            qr: PivotedQr::default(),
            matrix: Vec::new(),
            right_side: Vec::new(),
            step: Vec::new(),
        }
    }
}

impl Descent {
    /// Levenberg-Marquardt on one block until Newton can take over, or nothing helps. Returns the iterations and the
    /// largest entry of the residual.
    fn minimise(
        &mut self,
        mechanism: &Mechanism,
        block: &Block,
        coordinates: &mut [f64],
    ) -> (u32, f64) {
        self.weigh(block);
        let mut damping = FIRST_DAMPING;
        let mut iterations = 0;
        self.workspace
            .evaluate(mechanism, block, coordinates, Want::Jacobian);
        let mut value = self.norm(&self.workspace.residual);
        while iterations < self.most && damping < LAST_DAMPING && !block.unknowns.is_empty() {
            if value.is_nan() || self.workspace.residual_norm() <= self.enough {
                break;
            }
            iterations += 1;
            self.damped_step(block, damping);
            let trial: Vec<f64> = self.moved(mechanism, block, coordinates);
            self.trial
                .evaluate(mechanism, block, &trial, Want::Jacobian);
            let trial_value = self.norm(&self.trial.residual);
            if trial_value < value {
                coordinates.copy_from_slice(&trial);
                std::mem::swap(&mut self.workspace, &mut self.trial);
                value = trial_value;
                damping = (damping * 0.1).max(1e-15);
            } else {
                damping *= 8.0;
            }
        }
        (iterations, self.workspace.residual_norm())
    }

    /// Weights of the block's rows.
    fn weigh(&mut self, block: &Block) {
        let turn_weight = self.turn_weight;
        let weight = |component: &usize| if *component < 3 { turn_weight } else { 1.0 };
        let components = block.loops.iter().flat_map(|part| &part.components);
        self.weights.clear();
        self.weights.extend(components.map(weight));
        self.weights.resize(block.rows(), 1.0);
    }

    /// Weighted sum of squares.
    fn norm(&self, residual: &[f64]) -> f64 {
        let pairs = residual.iter().zip(&self.weights);
        pairs.map(|(r, w)| (r * w) * (r * w)).sum()
    }

    /// Least squares of [J; √λ I] x = [-r; 0].
    fn damped_step(&mut self, block: &Block, damping: f64) {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let tall = rows + columns;
        self.matrix.clear();
        self.matrix.resize(tall * columns, 0.0);
        for j in 0..columns {
            let column = &self.workspace.jacobian[j * rows..(j + 1) * rows];
            let weighted = column.iter().zip(&self.weights).map(|(a, w)| a * w);
            for (entry, value) in self.matrix[j * tall..].iter_mut().zip(weighted) {
                *entry = value;
            }
            self.matrix[j * tall + rows + j] = damping.sqrt();
        }
        self.right_side.clear();
        self.right_side.extend(
            self.workspace
                .residual
                .iter()
                .zip(&self.weights)
                .map(|(r, w)| -r * w),
        );
        self.right_side.resize(tall, 0.0);
        self.step.resize(columns, 0.0);
        self.qr.factor(&self.matrix, tall, columns, 0.0);
        self.qr.solve(&mut self.right_side, &mut self.step);
        let longest = self.step.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
        if longest > MAX_STEP {
            self.step.iter_mut().for_each(|s| *s *= MAX_STEP / longest);
        }
    }

    fn moved(&self, mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> Vec<f64> {
        let mut trial = coordinates.to_vec();
        for (column, unknown) in block.unknowns.iter().enumerate() {
            trial[*unknown] += mechanism.scale_of(*unknown) * self.step[column];
        }
        trial
    }
}

/// The loop or equation of `block` that is farthest from closing.
fn gap(mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> NotClosed {
    let values = mechanism.argument_values(coordinates);
    let mut worst = NotClosed {
        name: String::new(),
        angle: 0.0,
        distance: 0.0,
        coordinates: coordinates.to_vec(),
    };
    let mut largest = -1.0;
    for part in &block.loops {
        let item = &mechanism.loops[part.index];
        let (angle, distance) = crate::kinematics::loops::forward::loop_gap(item, &values);
        if angle.max(distance / mechanism.size) > largest {
            largest = angle.max(distance / mechanism.size);
            worst = NotClosed {
                name: item.name.clone(),
                angle,
                distance,
                ..worst
            };
        }
    }
    for index in &block.equations {
        let equation = &mechanism.equations[*index];
        let value = equation.expression.value(coordinates).abs();
        let scaled = value * mechanism.weight_of(*index);
        if scaled > largest || scaled.is_nan() {
            largest = scaled;
            worst = NotClosed {
                name: equation.name.clone(),
                angle: 0.0,
                distance: value,
                ..worst
            };
        }
    }
    worst
}
