//! Shapes in space and their motion, ready for the writers of 3-D files. Plain data; knows nothing of mechanisms.

use crate::geometry::Mesh;
use crate::math::Pose;
use glam::{DMat3, DVec3};

/// A shape is changed visibly by corners that move by this fraction of it.
const VISIBLE: f64 = 1e-4;

/// Digits of coordinates relative to the smallest body, and most decimals of a text.
const DIGITS: f64 = 8.0;
const MOST_DECIMALS: f64 = 17.0;

/// Shapes and where they are at every key.
#[derive(Clone, Debug)]
pub struct ExportModel {
    /// Title of the scene.
    pub title: String,
    /// Rotation that puts the scene's up axis on y, which is up in glTF.
    pub upright: DMat3,
    /// Metres in the scene's unit of length; 1 where the unit is not known.
    pub metres: f64,
    /// Times of the keys in seconds, rising; one for a pose.
    pub times: Vec<f64>,
    /// What moves.
    pub bodies: Vec<ModelBody>,
    /// Paths of points, in the world.
    pub traces: Vec<ModelTrace>,
    /// Where it is seen from, if that is known.
    pub camera: Option<ModelCamera>,
}

/// A rigid body.
#[derive(Clone, Debug)]
pub struct ModelBody {
    /// Its name in the scene.
    pub name: String,
    /// Its solids.
    pub parts: Vec<ModelPart>,
    /// `world_from_body` at every key.
    pub poses: Vec<Pose>,
}

/// A solid of a body.
#[derive(Clone, Debug)]
pub struct ModelPart {
    /// Surface in the body's frame.
    pub mesh: Mesh,
    /// sRGB colour.
    pub colour: [u8; 3],
    /// 1 opaque, below 1 translucent.
    pub opacity: f64,
}

/// A path.
#[derive(Clone, Debug)]
pub struct ModelTrace {
    /// Its name in the scene.
    pub name: String,
    /// sRGB colour.
    pub colour: [u8; 3],
    /// Pieces without a gap, two points or more each.
    pub runs: Vec<Vec<DVec3>>,
}

/// A camera that looks along its own -z.
#[derive(Clone, Copy, Debug)]
pub struct ModelCamera {
    /// Its pose in the world.
    pub world_from_camera: Pose,
    /// Full vertical angle in radians; `None` for a parallel projection.
    pub fov_y: Option<f64>,
    /// Height of a parallel projection in the scene's unit.
    pub height: f64,
    /// Width over height.
    pub aspect: f64,
    /// Distances of the near and the far plane.
    pub range: [f64; 2],
}

impl ExportModel {
    /// Every solid with its body and the body's pose at the first key.
    pub fn placed_parts(&self) -> impl Iterator<Item = (&ModelBody, &ModelPart, Pose)> {
        self.bodies.iter().flat_map(|body| {
            let pose = body.poses.first().copied().unwrap_or(Pose::IDENTITY);
            body.parts.iter().map(move |part| (body, part, pose))
        })
    }

    /// Length of the diagonal of the smallest body's box, and the largest coordinate, at the first key.
    fn extent(&self) -> Option<[f64; 2]> {
        let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
        for body in &self.bodies {
            let pose = body.poses.first().copied().unwrap_or(Pose::IDENTITY);
            let positions = body.parts.iter().flat_map(|part| &part.mesh.positions);
            let mut bounds: Option<[DVec3; 2]> = None;
            for point in positions.map(|point| pose.transform_point(*point)) {
                let [low, high] = bounds.unwrap_or([point; 2]);
                bounds = Some([low.min(point), high.max(point)]);
                largest = largest.max(point.abs().max_element());
            }
            if let Some([low, high]) = bounds {
                smallest = smallest.min(low.distance(high));
            }
        }
        (smallest.is_finite() && smallest > 0.0).then_some([smallest, largest])
    }

    /// How far single precision moves a corner, if that changes the shape of the smallest body: of files that have no other.
    pub fn coarse_rounding(&self) -> Option<f64> {
        let [smallest, largest] = self.extent()?;
        let moved = largest * f64::from(f32::EPSILON) / 2.0;
        (moved > VISIBLE * smallest).then_some(moved)
    }

    /// Decimals that tell corners of the smallest body apart.
    pub fn decimals(&self) -> usize {
        let [smallest, _] = self.extent().unwrap_or([1.0; 2]);
        (DIGITS - libm::log10(smallest).floor()).clamp(0.0, MOST_DECIMALS) as usize
    }
}
