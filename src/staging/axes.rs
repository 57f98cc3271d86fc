//! Axes of the world and of the bodies: red x, green y, blue z, in shades that colour-blind people can distinguish.

use super::solids::{arrow_solids, merged_mesh, sign_instance};
use crate::kinematics::results::trajectory::ClosedPose;
use crate::math::Pose;
use crate::model::view::ShownAxes;
use crate::render::{Instance, Label, LabelAnchor, StageMesh};
use glam::DVec3;

/// Colours of x, y and z.
pub const COLOURS: [[u8; 3]; 3] = [[0xd5, 0x5e, 0x00], [0x00, 0x9e, 0x73], [0x00, 0x72, 0xb2]];

/// Length of the world's and of the bodies' axes over the extent of the motion.
const LENGTHS: [f64; 2] = [0.16, 0.08];

/// Radius of an axis and length of its head over its length.
const SHAFT: f64 = 0.022;
const HEAD: f64 = 0.22;

/// Position of the letter, in lengths of the axis.
const LETTER_AT: f64 = 1.13;

/// Height of the letters as a fraction of the picture's.
const LETTER_SIZE: f64 = 0.03;

/// Meshes of the axes that are shown.
pub struct AxisSigns {
    world: Option<usize>,
    bodies: Option<usize>,
    length: f64,
}

/// Length of the world's axes, which the camera must include.
pub fn world_length(axes: ShownAxes, extent: f64) -> Option<f64> {
    matches!(axes, ShownAxes::World | ShownAxes::All).then_some(LENGTHS[0] * extent)
}

impl AxisSigns {
    /// Adds the meshes.
    pub fn new(axes: ShownAxes, extent: f64, meshes: &mut Vec<StageMesh>) -> Self {
        let mut add = |length: f64| {
            let first = meshes.len();
            for axis in DVec3::AXES {
                let solids = arrow_solids(axis, length, SHAFT * length, HEAD * length);
                meshes.push(merged_mesh(&solids, 2e-3 * length).into());
            }
            first
        };
        let length = LENGTHS[0] * extent;
        let bodies = matches!(axes, ShownAxes::Bodies | ShownAxes::All);
        Self {
            world: world_length(axes, extent).map(&mut add),
            bodies: bodies.then(|| add(LENGTHS[1] * extent)),
            length,
        }
    }

    /// Colours of the axes that are shown.
    pub fn colours(&self) -> impl Iterator<Item = [u8; 3]> {
        let shown = self.world.or(self.bodies).is_some();
        COLOURS.into_iter().filter(move |_| shown)
    }

    /// The axes at a pose.
    pub fn instances(&self, pose: &ClosedPose, meshes: &[StageMesh]) -> Vec<Instance> {
        let world = self.world.map(|first| (first, Pose::IDENTITY));
        let bodies = pose.bodies.iter();
        let bodies = bodies.filter_map(|at| Some((self.bodies?, *at)));
        world
            .into_iter()
            .chain(bodies)
            .flat_map(|(first, at)| {
                (0..3).map(move |k| sign_instance(first + k, meshes, at, COLOURS[k], 0.4))
            })
            .collect()
    }

    /// The letters at the world's axes, for a picture `height` pixels high.
    pub fn letters(&self, height: f64) -> Vec<Label> {
        if self.world.is_none() {
            return Vec::new();
        }
        let letters = ["x", "y", "z"].into_iter().enumerate();
        letters
            .map(|(k, text)| Label {
                text: text.to_owned(),
                anchor: LabelAnchor::World(DVec3::AXES[k] * (LETTER_AT * self.length)),
                size: LETTER_SIZE * height,
                colour: COLOURS[k],
                plate: false,
                yields: false,
            })
            .collect()
    }
}
