//! Gauges of the inputs: a bar with the range of the motion, filled up to the present value.

use super::value_text::{VALUE_SIZE, value_text};
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::mechanism::Mechanism;
use crate::model::theme::Theme;
use crate::render::{Anchor, Label, Patch};

/// Width of a bar as a share of the picture's height, and its height.
const WIDTH: f64 = 0.20;
const HEIGHT: f64 = 0.012;

/// From row to row, as a share of the picture's height.
const PITCH: f64 = 0.055;

/// Room between a bar and its text, as a share of the picture's height.
const GAP: f64 = 0.02;

/// Colour of the filled part.
const FILL: [u8; 3] = [0x2b, 0x74, 0xb8];

/// How much of a bar's empty part is seen.
const EMPTY: f64 = 0.25;

/// Bars and texts of all inputs at the values `inputs`, in the lower left corner, `inset` heights from it.
pub fn of_inputs(
    mechanism: &Mechanism,
    trajectory: &Trajectory,
    inputs: &[f64],
    (size, inset): ([f64; 2], f64),
    theme: Theme,
) -> (Vec<Patch>, Vec<Label>) {
    let across = |heights: f64| heights * size[1] / size[0];
    let (mut patches, mut labels) = (Vec::new(), Vec::new());
    let count = mechanism.inputs.len();
    for (row, (input, value)) in mechanism.inputs.iter().zip(inputs).enumerate() {
        let middle = 1.0 - inset - PITCH * ((count - row) as f64 - 0.5);
        let [low, high] = input_range(trajectory, row);
        let share = if high > low {
            ((value - low) / (high - low)).clamp(0.0, 1.0)
        } else {
            1.0
        };
        let corner = [across(inset), middle - 0.5 * HEIGHT];
        let mut bar = |width: f64, colour, opacity| {
            patches.push(Patch {
                corner,
                size: [across(width), HEIGHT],
                colour,
                opacity,
            });
        };
        bar(WIDTH, theme.faint_ink(), EMPTY);
        bar(WIDTH * share, FILL, 1.0);
        let [low, high] = [low, high].map(|v| value_text(mechanism, input, v));
        let own = value_text(mechanism, input, *value);
        labels.push(Label {
            text: format!("{} = {own}   ({low} … {high})", input.name),
            anchor: Anchor::Screen([across(inset + WIDTH + GAP), middle - 0.5 * VALUE_SIZE]),
            size: VALUE_SIZE * size[1],
            colour: theme.faint_ink(),
            plate: false,
            yields: false,
        });
    }
    (patches, labels)
}

/// Least and greatest value of input `input` over the motion.
fn input_range(trajectory: &Trajectory, input: usize) -> [f64; 2] {
    let values = trajectory.samples.iter().map(|sample| sample.inputs[input]);
    let values = values.filter(|value| value.is_finite());
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
        [low.min(v), high.max(v)]
    })
}
