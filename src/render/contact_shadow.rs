//! The soft shadow that bodies throw on the ground below them, as a small texture for both renderers.
//!
//! Computed on the CPU once a frame from the triangles of the casting instances. Holds no light: it is the
//! darkening near a contact, straight below, not the shadow of the key light.

/// Darkness over the square that circumscribes the ground's disc.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactShadow {
    /// Texels along each side.
    pub size: u32,
    /// `size * size` darknesses, 0 none to 255 full; row-major, first axis of the ground along a row.
    pub texels: Vec<u8>,
}

impl ContactShadow {
    /// Darkness 0..=1 at a point of the ground, bilinear between texel centres.
    ///
    /// `u` and `v` are the coordinates along the ground's two axes divided by its radius, -1..=1. A GPU
    /// gets the same with a linear, edge-clamped sampler at `0.5 + 0.5 * (u, v)`.
    #[inline]
    pub fn sample(&self, u: f32, v: f32) -> f32 {
        let last = (self.size - 1) as f32;
        let place = |c: f32| {
            super::look::smaller(
                super::look::larger((0.5 + 0.5 * c) * self.size as f32 - 0.5, 0.0),
                last,
            )
        };
        let (x, y) = (place(u), place(v));
        let (column, row) = (x as usize, y as usize);
        let (fx, fy) = (x - column as f32, y - row as f32);
        let next = (column + 1).min(self.size as usize - 1);
        let below = (row + 1).min(self.size as usize - 1);
        let at = |c: usize, r: usize| f32::from(self.texels[r * self.size as usize + c]);
        let top = at(column, row) + (at(next, row) - at(column, row)) * fx;
        let bottom = at(column, below) + (at(next, below) - at(column, below)) * fx;
        (top + (bottom - top) * fy) / 255.0
    }
}
