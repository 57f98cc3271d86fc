//! Texts of a frame: labels of the scene, title, values of the inputs, and why there is no pose.

use super::gauge;
use super::value_text::{VALUE_SIZE, value_text};
use crate::kinematics::results::trajectory::{ClosedPose, Trajectory};
use crate::model::mechanism::Mechanism;
use crate::model::theme::Theme;
use crate::model::view::{LabelPlace, SceneLabel};
use crate::render::{Anchor, Frame, Label};
use crate::scene::Scene;
use glam::DVec3;

/// Heights of the lines as fractions of the picture's height.
const TITLE_SIZE: f64 = 0.036;

/// Distance of the captions from the border, as a fraction of the height.
const INSET: f64 = 0.02;

/// The same where the border carries the hatching of a missing pose.
const INSET_IN_HATCHING: f64 = 0.05;

/// Smallest height in pixels at which captions can be read; smaller pictures go without.
const SMALLEST_READABLE: f64 = 7.0;

/// Adds title, input values (as text or gauges) and the notice of a missing pose to `frame`.
pub fn add_captions(
    scene: &Scene,
    trajectory: &Trajectory,
    index: usize,
    size: [u32; 2],
    frame: &mut Frame,
) {
    let height = f64::from(size[1]);
    if VALUE_SIZE * height < SMALLEST_READABLE {
        return;
    }
    let sample = &trajectory.samples[index];
    let (view, theme) = (&scene.view, scene.view.theme);
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
        yields: false,
    };
    let values = input_captions(&scene.mechanism, &sample.inputs);
    if view.captions {
        let title = scene.mechanism.title.clone();
        frame
            .labels
            .push(line(title, inset, TITLE_SIZE, theme.ink()));
    }
    if view.decor.gauge {
        let place = (size.map(f64::from), inset);
        let inputs = &sample.inputs;
        let gauges = gauge::of_inputs(&scene.mechanism, trajectory, inputs, place, theme);
        frame.patches.extend(gauges.0);
        frame.labels.extend(gauges.1);
    } else if view.captions && !values.is_empty() {
        let y = 1.0 - inset - 1.6 * VALUE_SIZE;
        let values = values.clone();
        frame
            .labels
            .push(line(values, y, VALUE_SIZE, theme.faint_ink()));
    }
    if view.captions && sample.pose.is_none() {
        let text = format!("no pose here: {values}");
        let y = inset + 1.8 * TITLE_SIZE;
        frame
            .labels
            .push(line(text, y, VALUE_SIZE, theme.warning()));
    }
}

/// `p = -17.0 mm   phi = 0.200 rad`.
fn input_captions(mechanism: &Mechanism, inputs: &[f64]) -> String {
    let inputs = mechanism.inputs.iter().zip(inputs);
    let texts =
        inputs.map(|(input, v)| format!("{} = {}", input.name, value_text(mechanism, input, *v)));
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
    theme: Theme,
) -> Option<Label> {
    let point = match label.place {
        LabelPlace::OnBody { body, point } => pose.bodies[body].transform_point(point),
        LabelPlace::OnTrace { .. } => on_trace?,
    };
    Some(Label {
        text: label.text.clone(),
        anchor: if label.leader {
            Anchor::Beside(point)
        } else {
            Anchor::World(point)
        },
        size: label.size * height,
        colour: label.colour.unwrap_or(theme.ink()),
        plate: false,
        yields: label.yields,
    })
}
