//! Projection from camera space to screen units, and from pixels to directions.

use super::samples::SUBPIXELS;
use crate::render::Camera;
use crate::render::depth_order::Eye;

/// Screen coordinates beyond this many units are clipped: the rounding below holds up to 2^22, with a margin for the
/// rounding of the clipped corners themselves.
pub(super) const GUARD: f32 = 4_100_000.0;
/// Adding this to a number below 2^22 leaves its nearest integer in the low bits.
const ROUNDING: f32 = 12_582_912.0;
/// Marks a vertex that needs clipping.
pub(super) const OUTSIDE: i32 = i32::MIN;

/// A vertex on the screen.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LensVertex {
    /// Screen units to the right of the picture's left edge, or [`OUTSIDE`].
    pub(super) x: i32,
    /// Screen units below the picture's top edge.
    pub(super) y: i32,
    /// Nearness, affine over the screen: inverse distance in a perspective, else minus the distance.
    pub(super) depth: f32,
    /// Camera-space unit normal.
    pub(super) normal: [f32; 3],
}

/// A camera's projection in f32.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    pub(super) eye: Eye,
    pub(super) perspective: bool,
    pub(super) near: f32,
    /// Screen units per unit at distance 1, or anywhere.
    scale: f32,
    centre: [f32; 2],
    /// Camera units at distance 1 per pixel.
    slope: f32,
}

impl Lens {
    pub(super) fn new(camera: &Camera, size: [u32; 2]) -> Self {
        let pixels = camera.pixels_per_unit(size);
        Self {
            eye: camera.eye(size),
            perspective: camera.is_perspective(),
            near: camera.near as f32,
            scale: (pixels * f64::from(SUBPIXELS)) as f32,
            centre: size.map(|n| 0.5 * n as f32),
            slope: (1.0 / pixels) as f32,
        }
    }

    /// Size of a pixel in camera units: at distance 1 of a perspective, or anywhere.
    #[inline(always)]
    pub(super) fn pixel(&self) -> f32 {
        self.slope
    }

    /// Screen place of a point of camera space with its normal; `x` is [`OUTSIDE`] where it must be clipped first.
    #[inline(always)]
    pub(super) fn project(&self, point: [f32; 3], normal: [f32; 3]) -> LensVertex {
        let distance = -point[2];
        let inverse = 1.0 / distance;
        let (scale, depth) = if self.perspective {
            (self.scale * inverse, inverse)
        } else {
            (self.scale, point[2])
        };
        let x = self.centre[0] * SUBPIXELS as f32 + scale * point[0];
        let y = self.centre[1] * SUBPIXELS as f32 - scale * point[1];
        // Not a number fails every comparison.
        let inside = distance >= self.near && x > -GUARD && x < GUARD && y > -GUARD && y < GUARD;
        // Values outside may be anything, and are not used.
        let round = |v: f32| (v + ROUNDING).to_bits().wrapping_sub(ROUNDING.to_bits()) as i32;
        LensVertex {
            x: if inside { round(x) } else { OUTSIDE },
            y: round(y),
            depth,
            normal,
        }
    }

    /// Camera-space planes `n·p + d ≥ 0` that keep what [`project`](Self::project) accepts.
    pub(super) fn planes(&self) -> [[f32; 4]; 5] {
        // A little inside the guard band, so that clipped corners pass the test.
        let reach = |k: usize| (GUARD * 0.99 - self.centre[k] * SUBPIXELS as f32) / self.scale;
        let (x, y) = (reach(0), reach(1));
        let sides = if self.perspective {
            [
                [1.0, 0.0, -x, 0.0],
                [-1.0, 0.0, -x, 0.0],
                [0.0, 1.0, -y, 0.0],
                [0.0, -1.0, -y, 0.0],
            ]
        } else {
            [
                [1.0, 0.0, 0.0, x],
                [-1.0, 0.0, 0.0, x],
                [0.0, 1.0, 0.0, y],
                [0.0, -1.0, 0.0, y],
            ]
        };
        let near = [0.0, 0.0, -1.0, -self.near * (1.0 + 1e-5)];
        [near, sides[0], sides[1], sides[2], sides[3]]
    }

    /// The point that a pixel shows at a nearness, in camera space.
    #[inline(always)]
    pub(super) fn place(&self, x: f32, y: f32, nearness: f32) -> [f32; 3] {
        let distance = if self.perspective {
            1.0 / nearness
        } else {
            -nearness
        };
        let scale = self.slope * if self.perspective { distance } else { 1.0 };
        [
            (x - self.centre[0]) * scale,
            (self.centre[1] - y) * scale,
            -distance,
        ]
    }

    /// Direction from the point that a pixel shows to the eye, in camera space, not normalised.
    #[inline(always)]
    pub(super) fn viewer_from(&self, x: f32, y: f32) -> [f32; 3] {
        if self.perspective {
            [
                (self.centre[0] - x) * self.slope,
                (y - self.centre[1]) * self.slope,
                1.0,
            ]
        } else {
            [0.0, 0.0, 1.0]
        }
    }
}
