//! Texts of a frame: labels of the scene, title, values of the inputs, and the reason why there is no pose.

use super::fitting::{self, Fitted, fit_pieces};
use super::gauge::{self, Gauges};
use super::quantity_names::written_symbol;
use super::ticks::path_point;
use super::value_text::{VALUE_SIZE, value_text};
use crate::kinematics::results::trajectory::{ClosedPose, Sample, Trajectory};
use crate::model::mechanism::Mechanism;
use crate::model::view::{LabelPlace, SceneLabel};
use crate::render::{Frame, Label, LabelAnchor};
use crate::scene::Scene;
use glam::DVec3;

/// Heights of the lines as fractions of the picture's height.
const TITLE_SIZE: f64 = 0.036;

/// Distance of the captions from the border, as a fraction of the height.
const INSET: f64 = 0.02;

/// The same where the border carries the hatching of a missing pose.
const INSET_IN_HATCHING: f64 = 0.05;

/// Smallest readable height in pixels; smaller pictures have no captions.
const SMALLEST_READABLE: f64 = 7.0;

/// Between the values of two inputs.
const VALUE_GAP: &str = "    ";

/// From baseline to baseline of a caption's lines, in heights of its capitals.
const LINE: f64 = 1.82;

/// Room that lines of a caption take above and below their capitals, in heights of these.
const AIR: f64 = 0.6;

/// Title, values and gauges, fitted into the picture, the same over the whole motion.
pub struct Captions {
    size: [f64; 2],
    title: Vec<String>,
    title_fit: Fitted,
    values_fit: Fitted,
    /// The widest values.
    widest: Vec<String>,
    gauges: Gauges,
}

impl Captions {
    /// Captions of a picture of `size` pixels.
    pub fn new(scene: &Scene, trajectory: &Trajectory, size: [u32; 2]) -> Self {
        let size = size.map(f64::from);
        let room = size[0] - 2.0 * INSET_IN_HATCHING * size[1];
        let mechanism = &scene.mechanism;
        let ranges = gauge::ranges(scene, trajectory);
        // The widest that the values can get.
        let [low, high] = [0, 1].map(|end| {
            let at: Vec<f64> = ranges.iter().map(|range| range[end]).collect();
            input_captions(mechanism, &at)
        });
        let wider = |(a, b): (String, String)| {
            let is_wider = fitting::text_extent(&a, 1.0)[0] > fitting::text_extent(&b, 1.0)[0];
            if is_wider { a } else { b }
        };
        let widest: Vec<String> = low.into_iter().zip(high).map(wider).collect();
        let title = fitting::split_words(&mechanism.title);
        Self {
            size,
            title_fit: fit_pieces(&title, " ", TITLE_SIZE * size[1], room),
            values_fit: fit_pieces(&widest, VALUE_GAP, VALUE_SIZE * size[1], room),
            gauges: Gauges::new(mechanism, ranges, size),
            title,
            widest,
        }
    }

    /// The lower right corner, in pixels, of a free area `needed` pixels wide: above the values if these extend so far.
    pub fn free_corner(&self, scene: &Scene, has_pose: bool, needed: f64) -> [f64; 2] {
        let [width, height] = self.size;
        let inset = border_inset(has_pose) * height;
        let view = &scene.view;
        let mut rows = 0.0;
        if view.decor.gauge {
            rows = self.gauges.height();
        } else if view.captions {
            let text = self.values_fit.text(&self.widest);
            let [wide, high] = fitting::text_extent(&text, self.values_fit.size);
            if inset + wide > width - needed {
                rows = high + AIR * self.values_fit.size;
            }
        }
        [width - inset, height - inset - rows]
    }

    /// Adds title, input values (as text or gauges) and the notice of a missing pose to `frame`.
    pub fn add_captions(&self, scene: &Scene, sample: &Sample, frame: &mut Frame) {
        let [width, height] = self.size;
        // A picture too small for its smallest text has none.
        if VALUE_SIZE * height < SMALLEST_READABLE {
            return;
        }
        let (view, theme) = (&scene.view, scene.view.theme);
        let inset = border_inset(sample.pose.is_some());
        let left = inset * height / width;
        let line = |text: String, y: f64, size: f64, colour| Label {
            text,
            anchor: LabelAnchor::Screen([left, y]),
            size,
            colour,
            plate: false,
            yields: false,
        };
        let rows = |text: &str| text.matches('\n').count() as f64;
        // From the top down: the title, and below it the notice of a missing pose.
        let mut top = inset;
        if view.captions {
            let (text, size) = (self.title_fit.text(&self.title), self.title_fit.size);
            top += (1.8 + LINE * rows(&text)) * size / height;
            frame.labels.push(line(text, inset, size, theme.ink()));
        }
        // At the bottom the values of the inputs, as gauges or as text.
        let values = input_captions(&scene.mechanism, &sample.inputs);
        if view.decor.gauge {
            let inputs = &sample.inputs;
            let gauges = self.gauges.at(&scene.mechanism, inputs, inset, theme);
            frame.patches.extend(gauges.0);
            frame.labels.extend(gauges.1);
        } else if view.captions && !values.is_empty() {
            let (text, size) = (self.values_fit.text(&values), self.values_fit.size);
            let y = 1.0 - inset - (1.0 + AIR + LINE * rows(&text)) * size / height;
            frame.labels.push(line(text, y, size, theme.faint_ink()));
        }
        if view.captions && sample.pose.is_none() {
            let mut notice = fitting::split_words("no pose here:");
            notice.extend(values);
            let room = width - 2.0 * INSET_IN_HATCHING * height;
            let fitted = fit_pieces(&notice, " ", VALUE_SIZE * height, room);
            let text = fitted.text(&notice);
            frame
                .labels
                .push(line(text, top, fitted.size, theme.warning()));
        }
    }
}

fn border_inset(has_pose: bool) -> f64 {
    match has_pose {
        true => INSET,
        false => INSET_IN_HATCHING,
    }
}

/// `p = −17.0 mm`, `φ = 0.200 rad`, one text per input.
fn input_captions(mechanism: &Mechanism, inputs: &[f64]) -> Vec<String> {
    let inputs = mechanism.inputs.iter().zip(inputs);
    let texts = inputs.map(|(input, v)| {
        let value = value_text(mechanism, input, *v);
        format!("{} = {value}", written_symbol(&input.name))
    });
    texts.collect()
}

/// The traced point at a label's time, at which the label stays; that of the nearest sample with a pose where there is none. `None`
/// for a label on a body, or if there is no pose at all.
pub fn place_on_trace(label: &SceneLabel, trajectory: &Trajectory) -> Option<DVec3> {
    let LabelPlace::OnTrace { trace, time, .. } = label.place else {
        return None;
    };
    if let Some(point) = path_point(trajectory, trace, time) {
        return Some(point);
    }
    let points = trajectory.samples.iter().filter_map(|sample| {
        let pose = sample.pose.as_ref()?;
        Some(((sample.time - time).abs(), pose.traces[trace]))
    });
    points
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, point)| point)
}

/// The point that a label of the scene belongs to at a pose; `on_trace` is its fixed place. `None` where it does not
/// exist.
pub fn anchor(label: &SceneLabel, on_trace: Option<DVec3>, pose: &ClosedPose) -> Option<DVec3> {
    match label.place {
        LabelPlace::OnBody { body, point } => Some(pose.bodies[body].transform_point(point)),
        LabelPlace::OnTrace { .. } => on_trace,
    }
}
