//! Positions in camera space of the points that pixels show, in single precision.

use crate::render::Camera;

/// The lines of sight of a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rays {
    perspective: bool,
    centre: [f32; 2],
    /// Size of a pixel: at distance 1 of a perspective, or anywhere.
    pixel: f32,
    near: f32,
}

impl Rays {
    pub(super) fn new(camera: &Camera, size: [u32; 2]) -> Self {
        Self {
            perspective: camera.is_perspective(),
            centre: size.map(|n| 0.5 * n as f32),
            pixel: (1.0 / camera.pixels_per_unit(size)) as f32,
            near: camera.near as f32,
        }
    }

    /// Pixel coordinates of a place and its nearness, which is affine over the screen; not numbers behind the near
    /// plane.
    #[inline(always)]
    pub(super) fn project(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let (scale, nearness) = if self.perspective {
            (1.0 / (-z * self.pixel), -1.0 / z)
        } else {
            (1.0 / self.pixel, z)
        };
        if -z < self.near {
            return [f32::NAN; 3];
        }
        [
            self.centre[0] + x * scale,
            self.centre[1] - y * scale,
            nearness,
        ]
    }

    /// Distance along the camera's axis.
    #[inline(always)]
    pub(super) fn distance(&self, nearness: f32) -> f32 {
        if self.perspective {
            1.0 / nearness
        } else {
            -nearness
        }
    }

    /// How the normals of corners are weighted where their nearness is `nearness`.
    #[inline(always)]
    pub(super) fn weight(&self, nearness: f32) -> f32 {
        if self.perspective { nearness } else { 1.0 }
    }

    /// The place that a pixel shows at a distance.
    #[inline(always)]
    pub(super) fn place(&self, [x, y]: [f32; 2], distance: f32) -> [f32; 3] {
        let scale = self.pixels(distance);
        [
            (x - self.centre[0]) / scale,
            (self.centre[1] - y) / scale,
            -distance,
        ]
    }

    /// Pixels in a unit of length at a distance.
    #[inline(always)]
    pub(super) fn pixels(&self, distance: f32) -> f32 {
        if self.perspective {
            1.0 / (self.pixel * distance)
        } else {
            1.0 / self.pixel
        }
    }
}
