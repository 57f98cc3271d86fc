//! Highlighted bodies and distances of a picture. What is highlighted is decided elsewhere.

use super::solids::{merged_mesh, sign_instance};
use crate::math::Pose;
use crate::model::shape::Solid;
use crate::render::{Instance, Label, LabelAnchor, StageMesh};
use glam::DVec3;

/// Colour of bodies that are too near to another one.
const ALARM: [u8; 3] = [0xe5, 0x14, 0x1e];

/// Colours of two bodies that are too near to each other, ...
const PAIR: [[u8; 3]; 2] = [[0xe5, 0x14, 0x1e], [0x1f, 0x5f, 0xbf]];

/// ... and of two that are not.
const KEPT: [[u8; 3]; 2] = [[0x1b, 0x8f, 0x6a], [0x1f, 0x5f, 0xbf]];

/// Colour of the line between them.
const LINE: [u8; 3] = [0x11, 0x13, 0x18];

/// Opacity of the other bodies relative to their own.
const FADED: f64 = 0.25;

/// The pair itself is translucent, so that a line inside it is visible.
const PAIR_OPACITY: f64 = 0.8;

/// Radius of the line, and of the balls at its ends, in pixels.
const LINE_PIXELS: f64 = 1.6;
const BALL_PIXELS: f64 = 3.6;

/// Height of the label beside the line as a fraction of the picture's.
const LABEL_SIZE: f64 = 0.035;

/// Height of the lines at the top: smaller, because they may be long and their plate covers what is behind it.
const CAPTION_SIZE: f64 = 0.026;

/// Corner of the plate with the lines at the top of the picture, below the title: fractions of its width and height.
const CAPTION: [f64; 2] = [0.004, 0.065];

/// A distance that is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct DimensionMark {
    /// The two bodies.
    pub bodies: [usize; 2],
    /// Its ends, in the world, if it has any.
    pub points: Option<[DVec3; 2]>,
    /// What is written beside it.
    pub text: String,
    /// What is written above the picture, line by line.
    pub caption: Vec<String>,
    /// The bodies are too near to each other.
    pub is_alarm: bool,
}

/// What pictures point out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Marks {
    /// For every sample the bodies to be coloured; may be shorter than the motion.
    pub alarmed: Vec<Vec<usize>>,
    /// A distance between two bodies, the same in every frame.
    pub measure: Option<DimensionMark>,
}

impl Marks {
    /// Colours that parts turn to.
    pub fn colours(&self) -> Vec<[u8; 3]> {
        let turns = self.alarmed.iter().any(|bodies| !bodies.is_empty());
        match &self.measure {
            Some(measure) if measure.is_alarm => PAIR.to_vec(),
            Some(_) => KEPT.to_vec(),
            None => turns.then_some(ALARM).into_iter().collect(),
        }
    }

    /// Changes the appearance of a part of `body` in sample `index`.
    pub fn colour(&self, index: usize, body: usize, instance: &mut Instance) {
        if let Some(measure) = &self.measure {
            match measure.bodies.iter().position(|b| *b == body) {
                Some(k) => {
                    instance.colour = if measure.is_alarm { PAIR } else { KEPT }[k];
                    instance.opacity *= PAIR_OPACITY;
                }
                None => instance.opacity *= FADED,
            }
            instance.casts_shadow = false;
        } else if self
            .alarmed
            .get(index)
            .is_some_and(|bodies| bodies.contains(&body))
        {
            instance.colour = ALARM;
        }
    }

    /// Adds the mesh of the line; returns its index.
    pub fn mesh(&self, pixel: f64, meshes: &mut Vec<StageMesh>) -> Option<usize> {
        let [from, to] = self.measure.as_ref()?.points?;
        let radius = LINE_PIXELS * pixel;
        let mut solids: Vec<Solid> = [from, to]
            .map(|centre| Solid::Sphere {
                centre,
                radius: BALL_PIXELS * pixel,
            })
            .into();
        if from.distance(to) > radius {
            solids.insert(0, Solid::Cylinder { from, to, radius });
        }
        meshes.push(merged_mesh(&solids, 0.2 * pixel).into());
        Some(meshes.len() - 1)
    }

    /// The line as it is drawn.
    pub fn line(mesh: usize, meshes: &[StageMesh]) -> Instance {
        sign_instance(mesh, meshes, Pose::IDENTITY, LINE, 1.0)
    }

    /// The text beside the line, and those above the picture.
    pub fn labels(&self, height: f64) -> Vec<Label> {
        let Some(measure) = &self.measure else {
            return Vec::new();
        };
        let label = |text: &str, anchor: LabelAnchor, size: f64| Label {
            text: text.to_owned(),
            anchor,
            size: size * height,
            colour: LINE,
            plate: true,
            yields: false,
        };
        let beside = measure.points.map(|[from, to]| {
            let middle = (from + to) * 0.5;
            label(&measure.text, LabelAnchor::Beside(middle), LABEL_SIZE)
        });
        // Paths may pass behind these lines.
        let caption = measure.caption.join("\n");
        let above = label(&caption, LabelAnchor::Screen(CAPTION), CAPTION_SIZE);
        beside.into_iter().chain([above]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A path behind a text without a plate makes it hard to read.
    #[test]
    fn all_texts_have_a_plate() {
        let measure = Some(DimensionMark {
            bodies: [0, 1],
            points: Some([DVec3::ZERO, DVec3::X]),
            text: "1 mm".to_owned(),
            caption: vec![
                "arm / post: failed".to_owned(),
                "1 mm at t = 0 s".to_owned(),
            ],
            is_alarm: true,
        });
        let marks = Marks {
            measure,
            ..Marks::default()
        };
        let labels = marks.labels(100.0);
        let texts: Vec<&str> = labels.iter().map(|label| label.text.as_str()).collect();
        assert_eq!(texts, ["1 mm", "arm / post: failed\n1 mm at t = 0 s"]);
        assert!(labels.iter().all(|label| label.plate));
    }
}
