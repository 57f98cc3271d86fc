//! Gauges of the inputs: a bar with the range of the motion, filled up to the present value.

use super::fitting;
use super::quantity_names::written_symbol;
use super::value_text::{VALUE_SIZE, value_text};
use crate::kinematics::motion::sampling::knot_times;
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::mechanism::Mechanism;
use crate::model::theme::Theme;
use crate::render::{Label, LabelAnchor, Patch};
use crate::scene::Scene;

/// Width of a bar as a share of the picture's height, and its height.
const WIDTH: f64 = 0.20;
const HEIGHT: f64 = 0.012;

/// From row to row, as a share of the picture's height.
const PITCH: f64 = 0.055;

/// Room between a bar and its text, as a share of the picture's height.
const GAP: f64 = 0.02;

/// Colour of the filled part.
const FILL: [u8; 3] = [0x2b, 0x74, 0xb8];

/// Opacity of a bar's empty part.
const EMPTY: f64 = 0.25;

/// The greatest distance of the gauges from the border, as a share of the picture's height.
const FARTHEST_INSET: f64 = 0.05;

/// Texts lose their range before they become smaller than this fraction of their usual size.
const READABLE: f64 = 0.8;

/// Colours of the bars, if there are any.
pub fn flat_colours(shown: bool) -> Option<[u8; 3]> {
    shown.then_some(FILL)
}

/// The gauges of all inputs, as they fit into a picture.
pub struct Gauges {
    size: [f64; 2],
    ranges: Vec<[f64; 2]>,
    /// Height of the texts in pixels.
    text_size: f64,
    /// Whether the ranges are written as well.
    with_range: bool,
}

impl Gauges {
    /// Gauges with these ranges in a picture of `size` pixels.
    pub fn new(mechanism: &Mechanism, ranges: Vec<[f64; 2]>, size: [f64; 2]) -> Self {
        let room = size[0] - (2.0 * FARTHEST_INSET + WIDTH + GAP) * size[1];
        let usual = VALUE_SIZE * size[1];
        let mut gauges = Self {
            size,
            ranges,
            text_size: usual,
            with_range: true,
        };
        for with_range in [true, false] {
            gauges.with_range = with_range;
            let texts = (0..gauges.ranges.len()).flat_map(|row| {
                let ends = gauges.ranges[row];
                ends.map(|end| gauges.text(mechanism, row, end))
            });
            let widest = texts
                .map(|text| fitting::text_extent(&text, usual)[0])
                .fold(room.min(1.0), f64::max);
            gauges.text_size = usual * (room / widest).min(1.0);
            if gauges.text_size >= READABLE * usual {
                break;
            }
        }
        gauges
    }

    /// Height of all rows in pixels.
    pub fn height(&self) -> f64 {
        PITCH * self.ranges.len() as f64 * self.size[1]
    }

    fn text(&self, mechanism: &Mechanism, row: usize, value: f64) -> String {
        let input = &mechanism.inputs[row];
        let own = value_text(mechanism, input, value);
        let name = written_symbol(&input.name);
        if !self.with_range {
            return format!("{name} = {own}");
        }
        let [low, high] = self.ranges[row].map(|v| value_text(mechanism, input, v));
        format!("{name} = {own}   ({low} … {high})")
    }

    /// Bars and texts at the values `inputs`, in the lower left corner, `inset` heights from it.
    pub fn at(
        &self,
        mechanism: &Mechanism,
        inputs: &[f64],
        inset: f64,
        theme: Theme,
    ) -> (Vec<Patch>, Vec<Label>) {
        let [width, height] = self.size;
        // Heights of the picture as shares of its width.
        let across = |heights: f64| heights * height / width;
        let (mut patches, mut labels) = (Vec::new(), Vec::new());
        let count = self.ranges.len();
        for (row, (value, [low, high])) in inputs.iter().zip(&self.ranges).enumerate() {
            // Rows from the bottom up, the last input lowest.
            let middle = 1.0 - inset - PITCH * ((count - row) as f64 - 0.5);
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
            // An empty bar, and over it the part up to the value.
            bar(WIDTH, theme.faint_ink(), EMPTY);
            bar(WIDTH * share, FILL, 1.0);
            let top = middle - 0.5 * self.text_size / height;
            labels.push(Label {
                text: self.text(mechanism, row, *value),
                anchor: LabelAnchor::Screen([across(inset + WIDTH + GAP), top]),
                size: self.text_size,
                colour: theme.faint_ink(),
                plate: false,
                yields: false,
            });
        }
        (patches, labels)
    }
}

/// Number of instants at which the drive is evaluated in addition to the samples, its ends and its keys: between them
/// an input changes by less than a gauge can show.
const LOOKS: usize = 1000;

/// Least and greatest value of every input over the whole drive, whatever its samples are.
pub fn ranges(scene: &Scene, trajectory: &Trajectory) -> Vec<[f64; 2]> {
    let actuation = &scene.actuation;
    let looks = (0..=LOOKS).map(|k| actuation.duration * k as f64 / LOOKS as f64);
    let driven = knot_times(&scene.mechanism, actuation, &looks.collect::<Vec<_>>());
    let driven = driven.iter().map(|time| actuation.inputs_at(*time));
    let sampled = trajectory
        .samples
        .iter()
        .map(|sample| sample.inputs.clone());
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; scene.mechanism.inputs.len()];
    for inputs in driven.chain(sampled) {
        for ([low, high], value) in ranges.iter_mut().zip(inputs) {
            (*low, *high) = (low.min(value), high.max(value));
        }
    }
    ranges
}
