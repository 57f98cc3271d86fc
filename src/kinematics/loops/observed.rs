//! The quantities of a pose that a table shows, in any arithmetic: unknowns, traced points, outputs.

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
    let mut slots = coordinates.to_vec();
    for trace in &mechanism.traces {
        let path = &mechanism.bodies[trace.body].world_from_body;
        let arguments = output_arguments(mechanism, &path.arguments(), coordinates);
        let end = WalkFrame::at_end_of(&path.steps, &arguments);
        slots.extend(end.point(trace.point.to_array()));
    }
    let mut scratch = Vec::new();
    for output in &mechanism.outputs {
        // Outputs may use earlier ones, which are slots by now.
        let value = output.value_with(mechanism, &slots, &mut scratch);
        slots.push(value);
    }
    slots
}
