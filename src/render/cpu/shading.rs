//! Lighting of covered pixels, many at a time: one item for each facet visible in a pixel.

use super::assembly::{Facet, TriangleAssembly};
use super::lens::Lens;
use super::samples::SUBPIXELS;
use crate::render::look::{self, LightShare, Rgb, Surroundings};

/// Items shaded together; the loop over them is what the compiler turns into vector code.
pub(super) const BATCH: usize = 128;

/// Items waiting to be lit, one array per quantity.
#[derive(Clone, Debug)]
pub(super) struct ShadingBatch {
    count: usize,
    normal: [[f32; BATCH]; 3],
    to_viewer: [[f32; BATCH]; 3],
    albedo: [[f32; BATCH]; 3],
    flat: [f32; BATCH],
    /// What reaches the surface.
    open: [[f32; BATCH]; 2],
    /// Share of the pixel, and which pixel.
    weight: [f32; BATCH],
    pixel: [u32; BATCH],
}

impl ShadingBatch {
    pub(super) fn new() -> Self {
        Self {
            count: 0,
            normal: [[0.0; BATCH]; 3],
            to_viewer: [[0.0; BATCH]; 3],
            albedo: [[0.0; BATCH]; 3],
            flat: [0.0; BATCH],
            open: [[1.0; BATCH]; 2],
            weight: [0.0; BATCH],
            pixel: [0; BATCH],
        }
    }

    /// Adds an item; the batch must not be full.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        [normal, to_viewer]: [[f32; 3]; 2],
        albedo: Rgb,
        flat: f32,
        open: LightShare,
        weight: f32,
        pixel: u32,
    ) {
        let i = self.count % BATCH;
        for k in 0..3 {
            self.normal[k][i] = normal[k];
            self.to_viewer[k][i] = to_viewer[k];
            self.albedo[k][i] = albedo[k];
        }
        self.flat[i] = flat;
        self.open[0][i] = open[0];
        self.open[1][i] = open[1];
        self.weight[i] = weight;
        self.pixel[i] = pixel;
        self.count += 1;
    }

    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.count == BATCH
    }

    /// Lights all items, adds them to their pixels by weight and empties the batch.
    // One index for many arrays allows vectorisation.
    #[allow(clippy::needless_range_loop)]
    pub(super) fn flush(&mut self, around: &Surroundings, pixels: &mut [[f32; 3]]) {
        let mut colour = [[0.0; BATCH]; 3];
        // Arithmetic over the whole batch, which the compiler vectorises; unused entries are discarded below.
        for i in 0..BATCH {
            let at = |a: &[[f32; BATCH]; 3]| [a[0][i], a[1][i], a[2][i]];
            let rgb = light_surface(
                at(&self.normal),
                at(&self.to_viewer),
                around,
                at(&self.albedo),
                self.flat[i],
                [self.open[0][i], self.open[1][i]],
            );
            for k in 0..3 {
                colour[k][i] = rgb[k] * self.weight[i];
            }
        }
        // Weighted colours are added to their pixels.
        for i in 0..self.count {
            if let Some(pixel) = pixels.get_mut(self.pixel[i] as usize) {
                for k in 0..3 {
                    pixel[k] += colour[k][i];
                }
            }
        }
        self.count = 0;
    }
}

/// Light on one surface; neither direction need have length 1.
#[inline(always)]
pub(super) fn light_surface(
    normal: [f32; 3],
    to_viewer: [f32; 3],
    around: &Surroundings,
    albedo: Rgb,
    flat: f32,
    open: LightShare,
) -> Rgb {
    look::shade_surface(
        unit_vector(normal),
        unit_vector(to_viewer),
        around,
        albedo,
        flat,
        open,
    )
}

/// The vector with length 1; a zero vector stays zero.
#[inline(always)]
pub(super) fn unit_vector(v: [f32; 3]) -> [f32; 3] {
    let scale = 1.0 / look::larger_of(look::dot_product(v, v), look::LEAST_DIVISOR).sqrt();
    [v[0] * scale, v[1] * scale, v[2] * scale]
}

/// The interpolated normal at the centre of a pixel, on the visible side, not normalised, and the nearness there.
///
/// If the facet covers part of the pixel but not its centre, the normal is that of an edge, and the nearness is that of
/// the facet's plane, limited to the range of its corners.
#[inline(always)]
pub(super) fn normal_at(
    assembly: &TriangleAssembly,
    facet: &Facet,
    lens: &Lens,
    x: i32,
    y: i32,
) -> ([f32; 3], f32) {
    let [a, b, c] = assembly.corners(&facet.corners);
    let (px, py) = (x * SUBPIXELS + SUBPIXELS / 2, y * SUBPIXELS + SUBPIXELS / 2);
    let edge = |from: &super::lens::LensVertex, to: &super::lens::LensVertex| {
        (to.y - from.y) as f32 * (px - from.x) as f32
            + (from.x - to.x) as f32 * (py - from.y) as f32
    };
    let depth = |v: &super::lens::LensVertex| if lens.perspective { v.depth } else { 1.0 };
    let shares = [edge(b, c), edge(c, a), edge(a, b)];
    let nearness = shares[0] * a.depth + shares[1] * b.depth + shares[2] * c.depth;
    let nearness =
        nearness / look::larger_of(shares[0] + shares[1] + shares[2], look::LEAST_DIVISOR);
    let nearness = look::smaller_of(
        look::larger_of(
            nearness,
            look::smaller_of(look::smaller_of(a.depth, b.depth), c.depth),
        ),
        look::larger_of(look::larger_of(a.depth, b.depth), c.depth),
    );
    let inner = shares.map(|share| look::larger_of(share, 0.0));
    let weights = [
        inner[0] * depth(a),
        inner[1] * depth(b),
        inner[2] * depth(c),
    ];
    let side = facet.side();
    // The weights' sum is of the size of the area; scaled to keep the squares within range.
    let scale = side / look::larger_of(weights[0] + weights[1] + weights[2], look::LEAST_DIVISOR);
    let normal = std::array::from_fn(|n| {
        (weights[0] * a.normal[n] + weights[1] * b.normal[n] + weights[2] * c.normal[n]) * scale
    });
    (normal, nearness)
}
