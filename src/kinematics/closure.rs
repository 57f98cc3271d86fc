//! Residual and analytic Jacobian of a group of loops and equations.
//!
//! A loop's product T must be the identity. Its residual is the rotation vector of T and the translation of T
//! over the mechanism's size: six numbers that vanish together only at the identity. Columns come from the
//! joints' twists: a rotation about axis a through o changes the translation t by a × (t - o) and turns the
//! frame by a; the inverse left Jacobian of SO(3) maps the turn to the rate of the rotation vector.

use super::structure::Block;
use crate::math::Pose;
use crate::math::{left_jacobian_inverse, rotation_log};
use crate::model::chain::{Argument, ArgumentValue, Motion, Step};
use crate::model::mechanism::Mechanism;
use glam::{DMat3, DVec3};

/// Buffers of one block's evaluation; made once, reused for every step.
#[derive(Clone, Debug, Default)]
pub struct BlockWorkspace {
    /// Residual, one entry per row of the block.
    pub residual: Vec<f64>,
    /// Jacobian with respect to the block's unknowns in their scaled form, column-major.
    pub jacobian: Vec<f64>,
    /// Rate of the residual along a direction of the other coordinates.
    pub drift: Vec<f64>,
    arguments: Vec<ArgumentValue>,
    joints: Vec<JointTwist>,
    values: Vec<f64>,
    adjoints: Vec<f64>,
    gradient: Vec<f64>,
}

/// Axis and place of a joint in the base frame of its loop.
#[derive(Clone, Copy, Debug)]
struct JointTwist {
    motion: Motion,
    argument: usize,
    axis: DVec3,
    origin: DVec3,
}

/// What to compute besides the residual.
#[derive(Clone, Copy)]
pub enum Want<'a> {
    /// Residual only.
    Residual,
    /// Residual and Jacobian.
    Jacobian,
    /// Residual, Jacobian, and the drift along the given rates of all coordinates (those of the block's own
    /// unknowns are left out).
    Drift(&'a [f64]),
}

/// The rows that are being filled, and at what.
#[derive(Clone, Copy)]
struct Site<'a> {
    mechanism: &'a Mechanism,
    block: &'a Block,
    coordinates: &'a [f64],
    want: Want<'a>,
    /// Equations of the loop that are kept.
    components: &'a [usize],
    /// Row of the block that the first of them takes.
    row: usize,
}

impl BlockWorkspace {
    /// Largest entry of the residual; infinite if any entry is not a number.
    pub fn residual_norm(&self) -> f64 {
        self.residual.iter().fold(0.0, |m: f64, r| {
            if r.is_nan() {
                f64::INFINITY
            } else {
                m.max(r.abs())
            }
        })
    }

    /// Evaluates `block` at `coordinates` (unknowns, then inputs).
    pub fn evaluate(
        &mut self,
        mechanism: &Mechanism,
        block: &Block,
        coordinates: &[f64],
        want: Want,
    ) {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        self.residual.clear();
        self.residual.resize(rows, 0.0);
        if !matches!(want, Want::Residual) {
            self.jacobian.clear();
            self.jacobian.resize(rows * columns, 0.0);
            self.drift.clear();
            self.drift.resize(rows, 0.0);
        }
        self.evaluate_arguments(mechanism, block, coordinates);
        let mut row = 0;
        for part in &block.loops {
            let site = Site {
                mechanism,
                block,
                coordinates,
                want,
                components: &part.components,
                row,
            };
            self.evaluate_loop(site, part.index);
            row += part.components.len();
        }
        for &index in &block.equations {
            self.evaluate_equation(mechanism, block, index, row, coordinates, want);
            row += 1;
        }
    }

    fn evaluate_arguments(&mut self, mechanism: &Mechanism, block: &Block, coordinates: &[f64]) {
        self.arguments
            .resize(mechanism.arguments.len(), ArgumentValue::default());
        for &index in &block.arguments {
            let value = mechanism.arguments[index].value(coordinates, &mut self.values);
            self.arguments[index] = ArgumentValue::new(value);
        }
    }

    fn evaluate_loop(&mut self, site: Site, index: usize) {
        let size = site.mechanism.size;
        let product = self.walk(site.mechanism, index);
        let turn = rotation_log(&product.rotation);
        let translation = product.translation;
        let six = residual_of(turn, translation, size);
        for (k, component) in site.components.iter().enumerate() {
            self.residual[site.row + k] = six[*component];
        }
        if matches!(site.want, Want::Residual) {
            return;
        }
        let log_from_spin = left_jacobian_inverse(turn);
        let joints = std::mem::take(&mut self.joints);
        for joint in &joints {
            let column = column_of(joint, translation, &log_from_spin, size);
            self.add_column(site, joint.argument, &column);
        }
        self.joints = joints;
    }

    /// Multiplies the loop's steps, noting every joint's axis and origin.
    fn walk(&mut self, mechanism: &Mechanism, index: usize) -> Pose {
        self.joints.clear();
        let mut pose = Pose::IDENTITY;
        for step in &mechanism.loops[index].chain.steps {
            if let Step::Joint {
                motion,
                axis,
                argument,
                sign,
            } = *step
            {
                let axis = pose.rotation.col(axis) * sign;
                self.joints.push(JointTwist {
                    motion,
                    argument,
                    axis,
                    origin: pose.translation,
                });
            }
            step.advance(&mut pose, &self.arguments);
        }
        pose
    }

    /// Distributes a joint's column over the coordinates of its argument.
    fn add_column(&mut self, site: Site, argument: usize, column: &[f64; 6]) {
        match &site.mechanism.arguments[argument] {
            Argument::Affine(affine) => {
                for &(slot, coefficient) in &affine.terms {
                    self.add_entry(site, slot, coefficient, column);
                }
            }
            Argument::Formula(expression) => {
                self.gradient.clear();
                self.gradient.resize(site.coordinates.len(), 0.0);
                let (values, adjoints) = (&mut self.values, &mut self.adjoints);
                expression.add_gradient(
                    site.coordinates,
                    1.0,
                    &mut self.gradient,
                    values,
                    adjoints,
                );
                for slot in expression.slots() {
                    self.add_entry(site, slot, self.gradient[slot], column);
                }
            }
        }
    }

    /// Adds a coordinate's share of a joint's column to the Jacobian, or to the drift if it is not solved here.
    fn add_entry(&mut self, site: Site, slot: usize, coefficient: f64, column: &[f64; 6]) {
        match site.block.column_of.get(slot).copied().flatten() {
            Some(j) => {
                let start = j * site.block.rows() + site.row;
                let scale = coefficient * site.mechanism.scale_of(slot);
                for (entry, component) in self.jacobian[start..].iter_mut().zip(site.components) {
                    *entry += scale * column[*component];
                }
            }
            None => {
                if let Want::Drift(rates) = site.want {
                    let rate = coefficient * rates[slot];
                    for (entry, component) in self.drift[site.row..].iter_mut().zip(site.components)
                    {
                        *entry += rate * column[*component];
                    }
                }
            }
        }
    }

    fn evaluate_equation(
        &mut self,
        mechanism: &Mechanism,
        block: &Block,
        index: usize,
        row: usize,
        coordinates: &[f64],
        want: Want,
    ) {
        let equation = &mechanism.equations[index];
        let scale = mechanism.size.powf(-equation.length_exponent);
        self.gradient.clear();
        self.gradient.resize(coordinates.len(), 0.0);
        let (values, adjoints) = (&mut self.values, &mut self.adjoints);
        let value = equation.expression.add_gradient(
            coordinates,
            scale,
            &mut self.gradient,
            values,
            adjoints,
        );
        self.residual[row] = value * scale;
        if matches!(want, Want::Residual) {
            return;
        }
        for slot in equation.expression.slots() {
            let derivative = self.gradient[slot];
            match block.column_of.get(slot).copied().flatten() {
                Some(j) => {
                    self.jacobian[j * block.rows() + row] += derivative * mechanism.scale_of(slot)
                }
                None => {
                    if let Want::Drift(rates) = want {
                        self.drift[row] += derivative * rates[slot];
                    }
                }
            }
        }
    }
}

/// The six numbers: rotation vector, then translation over the mechanism's size.
pub fn residual_of(turn: DVec3, translation: DVec3, size: f64) -> [f64; 6] {
    let t = translation / size;
    [turn.x, turn.y, turn.z, t.x, t.y, t.z]
}

fn column_of(joint: &JointTwist, translation: DVec3, log_from_spin: &DMat3, size: f64) -> [f64; 6] {
    match joint.motion {
        Motion::Translation => residual_of(DVec3::ZERO, joint.axis, size),
        Motion::Rotation => {
            let turn = *log_from_spin * joint.axis;
            residual_of(turn, joint.axis.cross(translation - joint.origin), size)
        }
    }
}
