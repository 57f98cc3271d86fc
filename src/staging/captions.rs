//! Texts of a frame: labels of the scene, title, values of the inputs, and why there is no pose.

use crate::kinematics::trajectory::{ClosedPose, Trajectory};
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::view::{LabelPlace, SceneLabel};
use crate::render::{Anchor, Label};
use crate::scene::Scene;
use glam::DVec3;

const TITLE_COLOUR: [u8; 3] = [0x2b, 0x2f, 0x36];
const VALUE_COLOUR: [u8; 3] = [0x5a, 0x62, 0x6e];
const WARNING_COLOUR: [u8; 3] = [0xb4, 0x53, 0x09];

/// Heights of the lines as fractions of the picture's height.
const TITLE_SIZE: f64 = 0.036;
const VALUE_SIZE: f64 = 0.030;

/// Distance of the captions from the border, as a fraction of the height.
const INSET: f64 = 0.02;

/// The same where the border carries the hatching of a missing pose.
const INSET_IN_HATCHING: f64 = 0.05;

/// Smallest height in pixels at which captions can be read; smaller pictures go without.
const SMALLEST_READABLE: f64 = 7.0;

/// Title, input values, and the notice of a missing pose.
pub fn of_sample(
    scene: &Scene,
    trajectory: &Trajectory,
    index: usize,
    size: [u32; 2],
) -> Vec<Label> {
    let height = f64::from(size[1]);
    if VALUE_SIZE * height < SMALLEST_READABLE {
        return Vec::new();
    }
    let sample = &trajectory.samples[index];
    let inset = if sample.pose.is_some() {
        INSET
    } else {
        INSET_IN_HATCHING
    };
    let left = inset * height / f64::from(size[0]);
    let line = |text: String, y: f64, size: f64, colour| Label {
        text,
        anchor: Anchor::Screen([left, y]),
        size: size * height,
        colour,
        plate: false,
    };
    let mut labels = vec![line(
        scene.mechanism.title.clone(),
        inset,
        TITLE_SIZE,
        TITLE_COLOUR,
    )];
    let values = values(&scene.mechanism, &sample.inputs);
    if !values.is_empty() {
        labels.push(line(
            values.clone(),
            1.0 - inset - 1.6 * VALUE_SIZE,
            VALUE_SIZE,
            VALUE_COLOUR,
        ));
    }
    if sample.pose.is_none() {
        let text = format!("no pose exists here: {values}");
        labels.push(line(
            text,
            inset + 1.8 * TITLE_SIZE,
            VALUE_SIZE,
            WARNING_COLOUR,
        ));
    }
    labels
}

/// `p = -17.0 mm   phi = 0.200 rad`, with a fixed number of digits so that the text does not jump.
fn values(mechanism: &Mechanism, inputs: &[f64]) -> String {
    let texts = mechanism.inputs.iter().zip(inputs).map(|(input, value)| {
        let in_file = value * mechanism.file_units(input.kind);
        // Half a unit of the last digit must not show as a negative zero.
        let tidy = |digits: i32| {
            let unit = 10f64.powi(digits);
            (in_file * unit).round() / unit + 0.0
        };
        match input.kind {
            Kind::Angle if mechanism.angle_unit.name == "deg" => {
                format!("{} = {:+.1}°", input.name, tidy(1))
            }
            Kind::Angle => format!("{} = {:+.3} rad", input.name, tidy(3)),
            Kind::Length => format!("{} = {:+.1} {}", input.name, tidy(1), mechanism.length_unit),
            Kind::Number => format!("{} = {:+.3}", input.name, tidy(3)),
        }
    });
    texts.collect::<Vec<_>>().join("    ")
}

/// Where a label on a trace stays: the traced point of the sample nearest to its time. `None` for a label on a body,
/// or where there is no pose at all.
pub fn place_on_trace(label: &SceneLabel, trajectory: &Trajectory) -> Option<DVec3> {
    let LabelPlace::OnTrace {
        trace,
        time,
        offset,
    } = label.place
    else {
        return None;
    };
    let points = trajectory.samples.iter().filter_map(|sample| {
        let pose = sample.pose.as_ref()?;
        Some(((sample.time - time).abs(), pose.traces[trace]))
    });
    points
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, point)| point + offset)
}

/// A label of the scene at a pose; `on_trace` is its fixed place. `None` where its point does not exist.
pub fn in_world(
    label: &SceneLabel,
    on_trace: Option<DVec3>,
    pose: &ClosedPose,
    height: f64,
) -> Option<Label> {
    let point = match label.place {
        LabelPlace::OnBody { body, point } => pose.bodies[body].transform_point(point),
        LabelPlace::OnTrace { .. } => on_trace?,
    };
    Some(Label {
        text: label.text.clone(),
        anchor: Anchor::World(point),
        size: label.size * height,
        colour: label.colour,
        plate: false,
    })
}
