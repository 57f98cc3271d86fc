//! Values of outputs, in any arithmetic.
//!
//! To first order the distance of two bodies changes as their nearest points move along the line between them, whatever
//! else the bodies do.

use super::chain::ArgumentValue;
use super::distance::{Distance, NearestPoints, SolidPair};
use super::mechanism::{Kind, Mechanism, MechanismOutput, OutputSource};
use super::walk::WalkFrame;
use crate::math::Pose;
use crate::numbers::hyper_dual::HyperDual;
use crate::numbers::scalar::Scalar;
use glam::DVec3;

impl MechanismOutput {
    /// The value, from coordinates, x, y, z of every trace and earlier outputs. Outputs that contain rates are
    /// undefined here: they belong to a motion, not to a pose.
    pub fn value_with<S: Scalar>(
        &self,
        mechanism: &Mechanism,
        slots: &[S],
        scratch: &mut Vec<S>,
    ) -> S {
        match &self.source {
            OutputSource::Formula(formula) => formula.value_with(slots, scratch),
            OutputSource::Distance(distance) => {
                distance.value(mechanism, &slots[..mechanism.coordinate_count()])
            }
            OutputSource::Rated(_) => S::undefined(),
        }
    }

    /// Adds `scale` times the derivatives by the slots to `gradient`.
    pub fn add_gradient(
        &self,
        mechanism: &Mechanism,
        slots: &[f64],
        scale: f64,
        gradient: &mut [f64],
        [values, adjoints]: [&mut Vec<f64>; 2],
    ) {
        match &self.source {
            OutputSource::Formula(formula) => {
                formula.add_gradient(slots, scale, gradient, values, adjoints);
            }
            OutputSource::Distance(distance) => {
                let coordinates = &slots[..mechanism.coordinate_count()];
                distance.add_gradient(mechanism, coordinates, scale, gradient);
            }
            OutputSource::Rated(_) => gradient.fill(f64::NAN),
        }
    }

    /// Slots that it depends on, ascending.
    pub fn slots(&self, mechanism: &Mechanism) -> Vec<usize> {
        match &self.source {
            OutputSource::Formula(formula) => formula.slots(),
            OutputSource::Distance(distance) => distance.slots(mechanism),
            OutputSource::Rated(formula) => formula.slots(),
        }
    }
}

/// Step for the derivative of a shape, as a fraction of the coordinate that shapes it, or of its usual size: the cube root of the
/// rounding error.
const SHAPE_STEP: f64 = 1e-5;

/// The nearest pair at a pose.
struct NearestFound<'d> {
    gap: &'d SolidPair,
    nearest: NearestPoints,
    first_from_second: Pose,
    world_from_first: Pose,
}

impl Distance {
    fn find(&self, mechanism: &Mechanism, coordinates: &[f64]) -> Option<NearestFound<'_>> {
        let arguments = mechanism.argument_values(coordinates);
        let found = self.gaps.iter().filter_map(|gap| {
            let [first, second] = gap.bodies;
            let world_from = |body: usize| mechanism.bodies[body].world_from_body.pose(&arguments);
            let world_from_first = world_from(first);
            let first_from_second = world_from_first.inverse() * world_from(second);
            let nearest = gap.solids.nearest(coordinates, &first_from_second)?;
            Some(NearestFound {
                gap,
                nearest,
                first_from_second,
                world_from_first,
            })
        });
        found.min_by(|p, q| p.nearest.distance.total_cmp(&q.nearest.distance))
    }

    /// The value at coordinates of any number type: numbers and first derivatives. Higher derivatives and enclosures
    /// are undefined: they depend on the curvature of the surfaces.
    pub fn value<S: Scalar>(&self, mechanism: &Mechanism, coordinates: &[S]) -> S {
        let numbers: Vec<f64> = coordinates.iter().map(|c| c.nominal()).collect();
        match self.find(mechanism, &numbers) {
            Some(found) => found.follow(mechanism, &numbers, coordinates),
            None => S::undefined(),
        }
    }

    /// Adds `scale` times the derivatives by the coordinates to `gradient`.
    pub fn add_gradient(
        &self,
        mechanism: &Mechanism,
        coordinates: &[f64],
        scale: f64,
        gradient: &mut [f64],
    ) {
        let Some(found) = self.find(mechanism, coordinates) else {
            gradient.fill(f64::NAN);
            return;
        };
        let mut moving: Vec<HyperDual> = coordinates
            .iter()
            .map(|c| HyperDual::constant(*c))
            .collect();
        for slot in self.slots(mechanism) {
            moving[slot].first = 1.0;
            gradient[slot] += scale * found.follow(mechanism, coordinates, &moving).first;
            moving[slot].first = 0.0;
        }
    }

    /// Coordinates it depends on, ascending.
    pub fn slots(&self, mechanism: &Mechanism) -> Vec<usize> {
        let mut slots: Vec<usize> = Vec::new();
        for gap in &self.gaps {
            slots.extend(gap.solids.shaped_by());
            for body in gap.bodies {
                let used = mechanism.bodies[body].world_from_body.arguments();
                slots.extend(
                    used.iter()
                        .flat_map(|k| mechanism.arguments[*k].coordinates()),
                );
            }
        }
        slots.sort_unstable();
        slots.dedup();
        slots
    }
}

impl NearestFound<'_> {
    /// The change of the distance as its nearest points move, and as the solids change their shapes.
    fn follow<S: Scalar>(&self, mechanism: &Mechanism, numbers: &[f64], coordinates: &[S]) -> S {
        let NearestPoints {
            distance,
            points,
            normal,
        } = self.nearest;
        if normal == DVec3::ZERO {
            return S::undefined().first_order(distance);
        }
        // The nearest points in the frames of their own bodies.
        let second_from_first = self.first_from_second.inverse();
        let own = [points[0], second_from_first.transform_point(points[1])];
        let world = self.world_from_first.rotation * normal;
        // Both points as functions of the coordinates, and the gap along the normal: to first order the points may be
        // held.
        let [first, second] = [0, 1].map(|k| {
            let chain = &mechanism.bodies[self.gap.bodies[k]].world_from_body;
            let arguments = output_arguments(mechanism, &chain.arguments(), coordinates);
            WalkFrame::at_end_of(&chain.steps, &arguments).point(own[k].to_array())
        });
        let mut change = S::number(0.0);
        for (k, n) in world.to_array().into_iter().enumerate() {
            change = change + (second[k] - first[k]).scale(n);
        }
        // The solids change by the dimensions that they are shaped by.
        for &slot in self.gap.solids.shaped_by() {
            let input = slot.checked_sub(mechanism.unknowns.len());
            let kind = input.and_then(|k| mechanism.inputs.get(k)).map(|c| c.kind);
            let scale = if kind == Some(Kind::Length) {
                mechanism.size
            } else {
                1.0
            };
            change = change + coordinates[slot].scale(self.by_shape(numbers, slot, scale));
        }
        change.first_order(distance)
    }

    /// The derivative by a coordinate through the shapes alone, with fixed bodies.
    /// `scale` is the usual size of it.
    fn by_shape(&self, numbers: &[f64], slot: usize, scale: f64) -> f64 {
        let step = SHAPE_STEP * numbers[slot].abs().max(scale);
        let mut moved = numbers.to_vec();
        let mut at = |value: f64| {
            moved[slot] = value;
            let found = self.gap.solids.nearest(&moved, &self.first_from_second);
            found.map_or(f64::NAN, |f| f.distance)
        };
        let (low, high) = (numbers[slot] - step, numbers[slot] + step);
        (at(high) - at(low)) / (high - low)
    }
}

/// Values of the arguments in `used`; the others stay zero.
pub fn output_arguments<S: Scalar>(
    mechanism: &Mechanism,
    used: &[usize],
    coordinates: &[S],
) -> Vec<ArgumentValue<S>> {
    let mut all = Vec::new();
    fill_arguments(mechanism, used, coordinates, &mut all);
    all
}

/// The same in a list whose memory is used again.
pub fn fill_arguments<S: Scalar>(
    mechanism: &Mechanism,
    used: &[usize],
    coordinates: &[S],
    all: &mut Vec<ArgumentValue<S>>,
) {
    let [zero, one] = [0.0, 1.0].map(S::number);
    let still = ArgumentValue {
        value: zero,
        sin: zero,
        cos: one,
    };
    all.clear();
    all.resize(mechanism.arguments.len(), still);
    let mut scratch = Vec::new();
    for index in used {
        let value = mechanism.arguments[*index].value(coordinates, &mut scratch);
        all[*index] = ArgumentValue::new(value);
    }
}
