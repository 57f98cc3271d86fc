//! Where a point of the world falls in the picture.

use crate::render::{Camera, Projection};
use glam::DVec3;

/// Pixel coordinates (from the top left corner, y down) of a world point in a picture of `picture` pixels.
///
/// `None` when the point lies nearer than the near plane or behind the camera, or is not a finite place.
pub fn to_pixels(camera: &Camera, point: DVec3, picture: [f64; 2]) -> Option<[f64; 2]> {
    let seen = camera.world_from_camera.inverse().transform_point(point);
    let depth = -seen.z;
    if !seen.is_finite() || depth < camera.near {
        return None;
    }
    let pixels_per_unit = match camera.projection {
        Projection::Perspective { fov_y } => {
            let (sin, cos) = crate::math::sin_cos(0.5 * fov_y);
            0.5 * picture[1] * cos / (sin * depth)
        }
        Projection::Orthographic { height } => picture[1] / height,
    };
    let x = 0.5 * picture[0] + seen.x * pixels_per_unit;
    let y = 0.5 * picture[1] - seen.y * pixels_per_unit;
    (x.is_finite() && y.is_finite()).then_some([x, y])
}
