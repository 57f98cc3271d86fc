//! The scene's labels with their positions on the screen, which stay the same over a film.

use super::label_placement::{Crowd, Lettering, Paper, Rectangle, place_labels};
use super::{captions, fitting};
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::theme::Theme;
use crate::model::view::{LabelPlace, SceneLabel};
use crate::render::overlay::plate_padding;
use crate::render::{Camera, Frame, Label, LabelAnchor};
use crate::scene::Scene;
use glam::DVec3;

/// Number of frames of a film for which positions are evaluated.
const LOOKS: usize = 24;

/// Largest number of points of the bodies and paths that are considered.
const MOST_POINTS: usize = 6000;

/// Gap from which on a leader connects the text with the anchor, in heights of the text.
const NEEDS_LINE: f64 = 1.0;

/// How far right of and above its point a label with a line stands, in heights of its capitals.
const BESIDE: [f64; 2] = [2.2, -2.2];

/// Where a label stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Letters {
    /// Its point, if it stays on a trace.
    pub on_trace: Option<DVec3>,
    /// The middle of the text from the point's place on the screen, in pixels.
    offset: [f64; 2],
    /// A line leads from the text to the point.
    line: bool,
}

impl Letters {
    /// The label with its point at `point` in a picture `height` pixels high.
    pub fn label(&self, label: &SceneLabel, point: DVec3, height: f64, theme: Theme) -> Label {
        Label {
            text: label.text.clone(),
            anchor: LabelAnchor::Placed {
                point,
                offset: self.offset,
                line: self.line,
            },
            size: label.size * height,
            colour: label.colour.unwrap_or(theme.ink()),
            plate: false,
            yields: label.yields,
        }
    }
}

/// Places of all labels of a scene, clear of captions and what is reserved and, where there is room, of `points`.
pub fn place_letters(
    (scene, trajectory): (&Scene, &Trajectory),
    camera: &dyn Fn(usize) -> Camera,
    size: [u32; 2],
    (captions, reserved): (&Frame, &[Rectangle]),
    points: &[DVec3],
) -> Vec<Letters> {
    let labels = &scene.view.labels;
    if labels.is_empty() {
        return Vec::new();
    }
    let height = f64::from(size[1]);
    let closed = trajectory.samples.iter().enumerate();
    let closed: Vec<_> = closed
        .filter_map(|(k, s)| Some((k, s.pose.as_ref()?)))
        .collect();
    // At equal times, so that a still has its labels where the film has them.
    let looks = (0..LOOKS).filter_map(|k| {
        let time = scene.actuation.duration * k as f64 / LOOKS as f64;
        let off = |sample: usize| (trajectory.samples[sample].time - time).abs();
        let nearest = closed.iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0)));
        nearest.copied()
    });
    let looks: Vec<_> = looks.collect();
    let first = camera(closed.first().map_or(0, |(k, _)| *k));
    let on_screen = |camera: &Camera, point: DVec3| {
        let [x, y, _] = camera.project(point, size)?;
        (x.is_finite() && y.is_finite()).then_some([x, y])
    };
    let lettering: Vec<Lettering> = labels
        .iter()
        .map(|label| {
            let on_trace = captions::place_on_trace(label, trajectory);
            let anchors = looks.iter().map(|(k, pose)| {
                let point = captions::anchor(label, on_trace, pose)?;
                on_screen(&camera(*k), point)
            });
            let text = fitting::text_extent(&label.text, label.size * height);
            Lettering {
                anchors: anchors.collect(),
                size: text,
                wish: wished_offset(label, on_trace, height, text, &|p| on_screen(&first, p)),
            }
        })
        .collect();
    let stride = points.len().div_ceil(MOST_POINTS).max(1);
    let paths = looks.iter().flat_map(|(_, pose)| pose.traces.iter());
    let drawn = points.iter().step_by(stride).chain(paths);
    let drawn = drawn.filter_map(|p| on_screen(&first, *p));
    let paper = Paper {
        size: size.map(f64::from),
        drawn: Crowd::new(size.map(f64::from), drawn),
        taken: captions
            .labels
            .iter()
            .filter_map(|label| caption_rectangle(label, size))
            .chain(reserved.iter().copied())
            .collect(),
    };
    let offsets = place_labels(&lettering, &paper);
    let placed = labels.iter().zip(&lettering).zip(offsets);
    placed
        .map(|((label, lettering), offset)| {
            let [w, h] = lettering.size.map(|s| 0.5 * s);
            let off = [
                (offset[0].abs() - w).max(0.0),
                (offset[1].abs() - h).max(0.0),
            ];
            let gap = (off[0] * off[0] + off[1] * off[1]).sqrt();
            Letters {
                on_trace: captions::place_on_trace(label, trajectory),
                offset,
                line: label.leader || gap > NEEDS_LINE * lettering.size[1],
            }
        })
        .collect()
}

/// The preferred position of a label: as shifted by the scene, next to its point, or over it.
fn wished_offset(
    label: &SceneLabel,
    on_trace: Option<DVec3>,
    height: f64,
    [width, high]: [f64; 2],
    on_screen: &dyn Fn(DVec3) -> Option<[f64; 2]>,
) -> [f64; 2] {
    let capitals = label.size * height;
    if label.leader {
        return [BESIDE[0] * capitals + 0.5 * width, BESIDE[1] * capitals];
    }
    let LabelPlace::OnTrace { offset, .. } = label.place else {
        return [0.0; 2];
    };
    let shifted = on_trace.and_then(|at| Some((on_screen(at)?, on_screen(at + offset)?)));
    let Some((from, to)) = shifted else {
        return [0.0; 2];
    };
    // As close as possible, in the direction that the scene requests.
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
    if length < 1.0 {
        return [0.0; 2];
    }
    let reach = [0.5 * width + 0.45 * high, 0.5 * high + 0.45 * high];
    [0, 1].map(|k| along[k] / length * reach[k])
}

/// The rectangle of a caption, with its plate if it has one.
fn caption_rectangle(label: &Label, size: [u32; 2]) -> Option<Rectangle> {
    let LabelAnchor::Screen([x, y]) = label.anchor else {
        return None;
    };
    let [x, y] = [x * f64::from(size[0]), y * f64::from(size[1])];
    let [width, height] = fitting::text_extent(&label.text, label.size);
    let padding = match label.plate {
        true => 2.0 * plate_padding(label.size),
        false => 0.0,
    };
    Some([x, y, x + width + padding, y + height + padding])
}
