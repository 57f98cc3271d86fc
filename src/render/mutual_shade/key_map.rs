//! The shadow of the key light on bodies: a map of the surfaces nearest to the light, sampled with a smooth kernel.
//!
//! Texels are squares perpendicular to the light; heights towards it are in texels, too. At each texel of the kernel a
//! surface is compared with its tangent plane, lifted by [`LIFT`] along its normal: a flat or convex face lies nowhere
//! above its own tangent plane.

use super::caster::{Caster, row_value};
use super::scan::scan_rows;
use crate::render::Camera;
use crate::render::look::{KEY_DIRECTION, KEY_GRAZING, KEY_RIGHT, KEY_UP, dot_product, larger_of};
use glam::DVec3;
use wide::f32x4;

/// Texels along each side of the map.
pub const KEY_MAP_SIDE: usize = 320;
/// Empty texels around the scene, for the kernel.
const BORDER: usize = 4;
/// How far above a surface something must be to shade it, along its normal and in texels: more than the deviation of
/// facets from their true surface, which is a fifth of a pixel.
pub const LIFT: f32 = 1.0;
/// Height in texels over which a shadow sets in.
pub const RAMP: f32 = 1.5;
/// Height of empty texels.
const EMPTY: f32 = -1e30;
/// Side of the blocks whose greatest heights are known.
const BLOCK: usize = 4;
const BLOCKS: usize = KEY_MAP_SIDE / BLOCK;

/// Heights of the surfaces nearest to the key light.
#[derive(Clone, Debug)]
pub struct KeyMap {
    /// Row by row, [`KEY_MAP_SIDE`] each.
    pub heights: Vec<f32>,
    /// Rows of the map from camera space to texels and height.
    pub rows: [[f32; 4]; 3],
    /// Greatest height in and around each block.
    blocks: Vec<f32>,
    corners: Vec<[f32; 3]>,
}

impl KeyMap {
    pub(super) fn new() -> Self {
        Self {
            heights: vec![EMPTY; KEY_MAP_SIDE * KEY_MAP_SIDE],
            rows: [[0.0; 4]; 3],
            blocks: vec![EMPTY; BLOCKS * BLOCKS],
            corners: Vec::new(),
        }
    }

    /// Places an empty map perpendicular to the light, over the whole scene.
    pub(super) fn lay_map(&mut self, [low, high]: [DVec3; 2], camera: &Camera) {
        let axes = [KEY_RIGHT, KEY_UP, KEY_DIRECTION].map(|a| DVec3::from(a.map(f64::from)));
        let to_camera = camera.world_from_camera.inverse();
        let corner = |k: usize| {
            let pick = |axis: usize| {
                if k >> axis & 1 == 0 {
                    low[axis]
                } else {
                    high[axis]
                }
            };
            to_camera.transform_point(DVec3::new(pick(0), pick(1), pick(2)))
        };
        let mut least = [f64::INFINITY; 3];
        let mut most = [f64::NEG_INFINITY; 3];
        for corner in (0..8).map(corner) {
            for (k, axis) in axes.iter().enumerate() {
                least[k] = least[k].min(axis.dot(corner));
                most[k] = most[k].max(axis.dot(corner));
            }
        }
        let span = (most[0] - least[0]).max(most[1] - least[1]);
        let texel = span / (KEY_MAP_SIDE - 2 * BORDER) as f64;
        for (k, axis) in axes.iter().enumerate() {
            let [x, y, z] = (*axis / texel).to_array();
            // In the middle of the map.
            let side = if k < 2 { KEY_MAP_SIDE as f64 } else { 0.0 };
            let start = 0.5 * (side - (most[k] + least[k]) / texel);
            self.rows[k] = [x, y, z, start].map(|v| v as f32);
        }
        self.heights.fill(EMPTY);
    }

    /// Adds a body.
    pub(super) fn add(&mut self, caster: &Caster) {
        let light = &self.rows;
        // Mesh to camera to light in one matrix.
        let rows = [0, 1, 2].map(|k| {
            let mut row: [f32; 4] =
                std::array::from_fn(|c| (0..3).map(|j| light[k][j] * caster.rows[j][c]).sum());
            row[3] += light[k][3];
            row
        });
        self.corners.clear();
        let placed = caster
            .mesh
            .positions
            .iter()
            .map(|p| rows.map(|row| row_value(&row, *p)));
        self.corners.extend(placed);
        let heights = self.heights.as_mut_slice();
        for triangle in caster.triangles {
            let [a, b, c] = triangle.map(|i| self.corners[i as usize]);
            let turn = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
            if caster.closed && turn <= 0.0 {
                continue;
            }
            // The largest height of every texel, linear along a row.
            scan_rows([a, b, c], [KEY_MAP_SIDE; 2], |run| {
                let mut height = run.start;
                for texel in &mut heights[run.first..run.first + run.count] {
                    *texel = larger_of(*texel, height);
                    height += run.step;
                }
            });
        }
    }

    /// Finds the greatest heights of the blocks.
    pub(super) fn finish(&mut self) {
        for (row, own) in self.blocks.chunks_exact_mut(BLOCKS).enumerate() {
            own.fill(EMPTY);
            let first = (row * BLOCK).saturating_sub(BLOCK);
            let last = ((row + 2) * BLOCK).min(KEY_MAP_SIDE);
            for texels in
                self.heights[first * KEY_MAP_SIDE..last * KEY_MAP_SIDE].chunks_exact(KEY_MAP_SIDE)
            {
                for (block, part) in own.iter_mut().zip(texels.as_chunks::<BLOCK>().0) {
                    *block = part
                        .iter()
                        .fold(*block, |most, height| larger_of(most, *height));
                }
            }
            // Texels that the kernel reads next to a block belong to its neighbours.
            let mut before = EMPTY;
            for k in 0..BLOCKS {
                let after = own.get(k + 1).copied().unwrap_or(EMPTY);
                let here = own[k];
                own[k] = larger_of(larger_of(before, here), after);
                before = here;
            }
        }
    }

    /// Share of the key light that reaches a surface at `place` with a `normal` whose length is near 1.
    #[inline(always)]
    pub fn lit(&self, place: [f32; 3], normal: [f32; 3]) -> f32 {
        // Surfaces that face away from the light are dark by their shading already.
        let facing = dot_product(normal, KEY_DIRECTION);
        if facing <= KEY_GRAZING {
            return 1.0;
        }
        let [x, y, height] = [0, 1, 2].map(|k| row_value(&self.rows[k], place));
        let last = (KEY_MAP_SIDE - 3) as f32;
        if !(x > 2.0 && x < last && y > 2.0 && y < last) {
            return 1.0;
        }
        // The tangent plane of the surface, raised a little, in the coordinates of the map.
        let slope = [KEY_RIGHT, KEY_UP].map(|across| -dot_product(normal, across) / facing);
        let plane = height + LIFT / facing;
        let [across, down] = slope.map(f32::abs);
        let block = (y as usize / BLOCK) * BLOCKS + x as usize / BLOCK;
        // Nothing in the block rises above the plane: lit.
        if self.blocks[block] <= plane - 2.0 * (across + down) {
            return 1.0;
        }
        self.kernel([x, y], slope, plane)
    }

    /// The mean over four by four texels, weighted by a cubic B-spline.
    #[inline(never)]
    fn kernel(&self, at: [f32; 2], slope: [f32; 2], plane: f32) -> f32 {
        let [column, row] = at.map(|c| (c - 0.5) as usize - 1);
        // From the centre of the first texel to the position.
        let [x, y] = [at[0] - (column as f32 + 0.5), at[1] - (row as f32 + 0.5)];
        let (wx, wy) = (spline_weights(x - 1.0), spline_weights(y - 1.0));
        let steps = f32x4::from([0.0, 1.0, 2.0, 3.0]) - f32x4::splat(x);
        let start = steps * f32x4::splat(slope[0]) + f32x4::splat(plane);
        let mut shaded = f32x4::splat(0.0);
        for (k, weight) in wy.into_iter().enumerate() {
            let first = (row + k) * KEY_MAP_SIDE + column;
            let Some(heights) = self.heights.get(first..first + 4) else {
                continue;
            };
            let heights = f32x4::from([heights[0], heights[1], heights[2], heights[3]]);
            let above = heights - start - f32x4::splat(slope[1] * (k as f32 - y));
            let share = (above * f32x4::splat(1.0 / RAMP))
                .fast_max(f32x4::splat(0.0))
                .fast_min(f32x4::splat(1.0));
            shaded += share * f32x4::splat(weight);
        }
        let [a, b, c, d] = (shaded * f32x4::from(wx)).to_array();
        1.0 - (a + b + (c + d))
    }
}

/// Weights of a uniform cubic B-spline for four texels, at a fraction `t` between the second and the third.
fn spline_weights(t: f32) -> [f32; 4] {
    let s = 1.0 - t;
    let (t2, t3) = (t * t, t * t * t);
    [
        s * s * s / 6.0,
        (3.0 * t3 - 6.0 * t2 + 4.0) / 6.0,
        (-3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0) / 6.0,
        t3 / 6.0,
    ]
}
