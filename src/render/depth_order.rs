//! The order of surfaces at equal depth. Rounding must not decide it, or renderers and frames would differ.
//!
//! Instances are drawn a little nearer to the eye the earlier they are listed, by far less than a pixel. The picture
//! does not change otherwise: scaling about the eye leaves every point at its place on the screen.

use super::Instance;
use crate::math::{Pose, narrow_pose};
use glam::DVec3;

/// Step from one instance to the next, in pixels of depth. Corners are rounded to 1/256 of a pixel on the screen, which
/// changes the depth of a surface by as much times its slope.
const STEP: f64 = 1.0 / 50.0;

/// Smallest step as a fraction of the distance: depths in f32 have relative errors of about 1e-7.
const LEAST_STEP: f64 = 1e-6;

/// Number of instances after which the steps start again, so that their sum stays below a pixel.
const LEVELS: usize = 50;

/// Where instances are looked at from.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    /// Placement of the world in front of the camera.
    pub camera_from_world: Pose,
    /// Whether lines of sight meet in the eye.
    pub perspective: bool,
    /// Size of a pixel in units of length: at distance 1 of a perspective, or anywhere.
    pub pixel: f64,
}

impl Eye {
    /// Rows of the map from the positions of an instance's mesh, whose origin is given, to the camera; `number` is its index in
    /// the frame.
    pub fn camera_from_mesh(
        &self,
        (instance, origin): (&Instance, DVec3),
        number: usize,
    ) -> [[f32; 4]; 3] {
        let camera_from_mesh = self.camera_from_world * instance.world_from_positions(origin);
        let mut rows = narrow_pose(&camera_from_mesh);
        let steps = (LEVELS - 1 - number % LEVELS) as f64;
        if self.perspective {
            let share = 1.0 - steps * (STEP * self.pixel).max(LEAST_STEP);
            for value in rows.as_flattened_mut() {
                *value = (f64::from(*value) * share) as f32;
            }
        } else {
            let z = camera_from_mesh.translation.z;
            let step = (STEP * self.pixel).max(LEAST_STEP * z.abs());
            rows[2][3] = (z + steps * step) as f32;
        }
        rows
    }
}
