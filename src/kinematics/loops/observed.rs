//! The quantities of a pose that a table shows, in any arithmetic: unknowns, traced points, outputs.

use crate::model::expression::Expression;
use crate::model::mechanism::Mechanism;
use crate::model::outputs::output_arguments;
use crate::model::walk::WalkFrame;
use crate::numbers::scalar::Scalar;

/// All quantities of a table except the inputs: unknowns, x, y, z of every trace, outputs.
pub fn observed_values<S: Scalar>(mechanism: &Mechanism, coordinates: &[S]) -> Vec<S> {
    let mut slots = observed_slots(mechanism, coordinates);
    let after = slots.split_off(mechanism.coordinate_count());
    slots.truncate(mechanism.unknowns.len());
    slots.extend(after);
    slots
}

/// All slots that a formula about the motion may use: coordinates, x, y, z of every trace, outputs.
pub fn observed_slots<S: Scalar>(mechanism: &Mechanism, coordinates: &[S]) -> Vec<S> {
    needed_slots(mechanism, coordinates, |_| true)
}

/// The same slots, of which only those needed are computed; other traced points and outputs are undefined.
pub fn needed_slots<S: Scalar>(
    mechanism: &Mechanism,
    coordinates: &[S],
    is_needed: impl Fn(usize) -> bool,
) -> Vec<S> {
    let mut slots = Vec::new();
    fill_slots(mechanism, coordinates, is_needed, &mut slots);
    slots
}

/// The same in a list whose memory is used again.
pub fn fill_slots<S: Scalar>(
    mechanism: &Mechanism,
    coordinates: &[S],
    is_needed: impl Fn(usize) -> bool,
    slots: &mut Vec<S>,
) {
    slots.clear();
    slots.reserve(coordinates.len() + 3 * mechanism.traces.len() + mechanism.outputs.len());
    slots.extend_from_slice(coordinates);
    for trace in &mechanism.traces {
        if !(0..3).any(|axis| is_needed(slots.len() + axis)) {
            slots.extend([(); 3].map(|()| S::undefined()));
            continue;
        }
        let path = &mechanism.bodies[trace.body].world_from_body;
        let arguments = output_arguments(mechanism, &path.arguments(), coordinates);
        let end = WalkFrame::at_end_of(&path.steps, &arguments);
        slots.extend(end.point(trace.point.to_array()));
    }
    let mut scratch = Vec::new();
    for output in &mechanism.outputs {
        // Outputs may use earlier ones, which are slots by now.
        let value = match is_needed(slots.len()) {
            true => output.value_with(mechanism, slots, &mut scratch),
            false => S::undefined(),
        };
        slots.push(value);
    }
}

/// A formula about the motion at coordinates; `needed` are its dependencies.
pub fn formula_value<S: Scalar>(
    mechanism: &Mechanism,
    coordinates: &[S],
    (formula, needed): (&Expression, &[bool]),
) -> S {
    formula.value(&needed_slots(mechanism, coordinates, |slot| needed[slot]))
}

/// For every slot, whether the value of one of `slots` depends on it.
pub fn dependencies(mechanism: &Mechanism, slots: &[usize]) -> Vec<bool> {
    let first = mechanism.coordinate_count() + 3 * mechanism.traces.len();
    let mut needed = vec![false; first + mechanism.outputs.len()];
    for slot in slots {
        needed[*slot] = true;
    }
    // Outputs use earlier ones only.
    for (k, output) in mechanism.outputs.iter().enumerate().rev() {
        if needed[first + k] {
            let used = output.slots(mechanism).into_iter();
            used.filter(|used| *used < first + k)
                .for_each(|used| needed[used] = true);
        }
    }
    needed
}
