//! First derivatives of a pose's quantities by some of its inputs: coordinates from the factorised loops, traced points from
//! the twists of their chains, outputs by the chain rule.

use crate::math::Pose;
use crate::model::chain::{Argument, ArgumentValue, Chain, ElementaryMotion};
use crate::model::mechanism::Mechanism;
use crate::model::walk::walk_chain;
use glam::DVec3;

/// Derivatives of the slots of a pose: coordinates, x, y, z of the traces, outputs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeasureSlopes {
    /// One row per input.
    pub rows: Vec<Vec<f64>>,
}

impl MeasureSlopes {
    /// The slopes of the `needed` ones of the quantities `slots` of a pose by some of its inputs; those of other traced
    /// points and outputs are zero. `sensitivity` contains d(unknown)/d(input), input after input.
    pub fn new(
        mechanism: &Mechanism,
        inputs: &[usize],
        (slots, needed): (&[f64], &[bool]),
        sensitivity: &[f64],
    ) -> Self {
        let (unknowns, coordinates) = (mechanism.unknowns.len(), mechanism.coordinate_count());
        let mut rows = vec![vec![0.0; slots.len()]; inputs.len()];
        for (k, (row, input)) in rows.iter_mut().zip(inputs).enumerate() {
            row[..unknowns].copy_from_slice(&sensitivity[k * unknowns..(k + 1) * unknowns]);
            row[unknowns + input] = 1.0;
        }
        let mut slopes = Self { rows };
        slopes.add_traces(mechanism, &slots[..coordinates], needed);
        slopes.add_outputs(mechanism, slots, needed);
        slopes
    }

    fn add_traces(&mut self, mechanism: &Mechanism, coordinates: &[f64], needed: &[bool]) {
        let arguments = mechanism.argument_values(coordinates);
        let mut shares = ArgumentShares::new(coordinates.len());
        for (index, trace) in mechanism.traces.iter().enumerate() {
            let first = coordinates.len() + 3 * index;
            if !needed[first..first + 3].contains(&true) {
                continue;
            }
            let chain = &mechanism.bodies[trace.body].world_from_body;
            // Chain rule: the point by every joint argument, the argument by its coordinates, these by the variables.
            for (argument, by_argument) in point_by_arguments(chain, &arguments, trace.point) {
                let gradient = shares.of(&mechanism.arguments[argument], coordinates);
                for row in &mut self.rows {
                    let rate: f64 = gradient
                        .iter()
                        .map(|(slot, share)| share * row[*slot])
                        .sum();
                    let moved = by_argument * rate;
                    for (entry, part) in row[first..first + 3].iter_mut().zip(moved.to_array()) {
                        *entry += part;
                    }
                }
            }
        }
    }

    fn add_outputs(&mut self, mechanism: &Mechanism, slots: &[f64], needed: &[bool]) {
        let first = slots.len() - mechanism.outputs.len();
        let mut gradient = vec![0.0; slots.len()];
        let (mut values, mut adjoints) = (Vec::new(), Vec::new());
        let outputs = mechanism.outputs.iter().enumerate();
        for (index, output) in outputs.filter(|(index, _)| needed[first + index]) {
            gradient.fill(0.0);
            let buffers = [&mut values, &mut adjoints];
            output.add_gradient(mechanism, slots, 1.0, &mut gradient, buffers);
            let used = output.slots(mechanism);
            for row in &mut self.rows {
                row[first + index] = used.iter().map(|slot| gradient[*slot] * row[*slot]).sum();
            }
        }
    }
}

/// Derivatives of arguments by coordinates.
struct ArgumentShares {
    gradient: Vec<f64>,
    values: Vec<f64>,
    adjoints: Vec<f64>,
    shares: Vec<(usize, f64)>,
}

impl ArgumentShares {
    fn new(coordinates: usize) -> Self {
        Self {
            gradient: vec![0.0; coordinates],
            values: Vec::new(),
            adjoints: Vec::new(),
            shares: Vec::new(),
        }
    }

    /// Coordinates that the argument depends on, each with its derivative.
    fn of(&mut self, argument: &Argument, coordinates: &[f64]) -> &[(usize, f64)] {
        self.shares.clear();
        match argument {
            Argument::Affine(affine) => self.shares.extend(affine.numbers()),
            Argument::Formula(expression) => {
                let (values, adjoints) = (&mut self.values, &mut self.adjoints);
                expression.add_gradient(coordinates, 1.0, &mut self.gradient, values, adjoints);
                for slot in expression.slots() {
                    let share = std::mem::take(&mut self.gradient[slot]);
                    self.shares.push((slot, share));
                }
            }
        }
        &self.shares
    }
}

/// The derivative of a chain's end point by every argument of the chain, joint after joint.
fn point_by_arguments(
    chain: &Chain,
    arguments: &[ArgumentValue],
    point: DVec3,
) -> Vec<(usize, DVec3)> {
    let mut pose = Pose::IDENTITY;
    let mut joints = Vec::with_capacity(chain.steps.len());
    // The axis and origin of every joint in the world.
    walk_chain(&chain.steps, &mut pose, arguments, |here, joint| {
        let axis = here.rotation.col(joint.axis) * joint.sign;
        joints.push((joint.argument, joint.motion, axis, here.translation));
    });
    let end = pose.transform_point(point);
    // A translation moves the point along its axis; a rotation, by the cross product with the lever arm.
    let moved = joints.into_iter().map(|(argument, motion, axis, origin)| {
        let by_argument = match motion {
            ElementaryMotion::Translation => axis,
            ElementaryMotion::Rotation => axis.cross(end - origin),
        };
        (argument, by_argument)
    });
    moved.collect()
}
