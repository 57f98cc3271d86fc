//! Which of two surfaces at one depth is seen: rounding must not tell, or both renderers and every frame would tell otherwise.
//!
//! Instances are drawn a little nearer to the eye the earlier they are listed, by far less than a pixel. Along lines of
//! sight nothing else changes: what is scaled about the eye stays where it is on the screen.

use super::Instance;
use crate::math::{Pose, narrow_pose};

/// Step from one instance to the next, in pixels of depth. Corners are rounded to 1/256 of a pixel on the screen, which
/// moves the depth of a surface by as much times its slope.
const STEP: f64 = 1.0 / 50.0;

/// Least step as a share of the distance: depths in f32 are off by some 1e-7 of themselves.
const LEAST_STEP: f64 = 1e-6;

/// Instances after which the steps begin again, so that all of them together stay below a pixel.
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
    /// Rows of the map from an instance's mesh to the camera, `number` being its place in the frame.
    pub fn camera_from_mesh(&self, instance: &Instance, number: usize) -> [[f32; 4]; 3] {
        let camera_from_mesh = self.camera_from_world * instance.world_from_mesh;
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
