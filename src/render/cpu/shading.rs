//! Lighting of covered pixels, many at a time: one item for each facet visible in a pixel.

use super::lens::Lens;
use super::samples::SUBPIXELS;
use super::view::RasterView;
use crate::render::look::{self, ALL_OPEN};

/// Items computed at once; the loops over them are what the compiler turns into vector code.
const LANES: usize = 32;
const BLOCKS: usize = 4;
/// Items that wait before all are lit.
const BATCH: usize = BLOCKS * LANES;

/// Some facets in some pixels, one array per quantity; those of corners by corner.
#[derive(Clone, Copy, Debug)]
struct ItemBlock {
    /// Column and row of the pixel.
    x: [i32; LANES],
    y: [i32; LANES],
    corner_x: [[i32; LANES]; 3],
    corner_y: [[i32; LANES]; 3],
    depth: [[f32; LANES]; 3],
    corner_normal: [[[f32; LANES]; 3]; 3],
    /// The sign of normals on the visible side.
    side: [f32; LANES],
    albedo: [[f32; LANES]; 3],
    flat: [f32; LANES],
    opacity: [f32; LANES],
    /// Share of the pixel.
    weight: [f32; LANES],
    /// Where the colour goes.
    place: [usize; LANES],
}

impl ItemBlock {
    const NONE: Self = Self {
        x: [0; LANES],
        y: [0; LANES],
        corner_x: [[0; LANES]; 3],
        corner_y: [[0; LANES]; 3],
        depth: [[0.0; LANES]; 3],
        corner_normal: [[[0.0; LANES]; 3]; 3],
        side: [0.0; LANES],
        albedo: [[0.0; LANES]; 3],
        flat: [0.0; LANES],
        opacity: [0.0; LANES],
        weight: [0.0; LANES],
        place: [0; LANES],
    };
}

/// Receives the place of an item, its colour times its weight, and its opacity.
pub(super) trait Receive: FnMut(usize, [f32; 4]) {}
impl<F: FnMut(usize, [f32; 4])> Receive for F {}

/// Items waiting to be lit.
#[derive(Clone, Debug)]
pub(super) struct ShadingBatch {
    count: usize,
    blocks: [ItemBlock; BLOCKS],
}

impl ShadingBatch {
    pub(super) fn new() -> Self {
        Self {
            count: 0,
            blocks: [ItemBlock::NONE; BLOCKS],
        }
    }

    /// Adds a facet in a pixel, lighting all items when there are many.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        view: &RasterView,
        number: i32,
        [x, y]: [i32; 2],
        (weight, place): (f32, usize),
        receive: &mut impl Receive,
    ) {
        let facet = &view.assembly.facets[number as usize];
        let paint = &view.assembly.paints[facet.instance()];
        let block = &mut self.blocks[self.count / LANES % BLOCKS];
        let i = self.count % LANES;
        (block.x[i], block.y[i]) = (x, y);
        for (k, corner) in view
            .assembly
            .corners(&facet.corners)
            .into_iter()
            .enumerate()
        {
            (block.corner_x[k][i], block.corner_y[k][i]) = (corner.x, corner.y);
            block.depth[k][i] = corner.depth;
            for n in 0..3 {
                block.corner_normal[k][n][i] = corner.normal[n];
            }
        }
        for k in 0..3 {
            block.albedo[k][i] = paint.albedo[k];
        }
        (block.flat[i], block.opacity[i]) = (paint.flat, paint.opacity);
        (block.side[i], block.weight[i], block.place[i]) = (facet.side(), weight, place);
        self.count += 1;
        if self.count == BATCH {
            self.flush(view, receive);
        }
    }

    /// Lights all items and removes them.
    #[inline(never)]
    pub(super) fn flush(&mut self, view: &RasterView, receive: &mut impl Receive) {
        for (block, first) in self.blocks.iter().zip((0..self.count).step_by(LANES)) {
            let lit = block.light(view);
            let count = (self.count - first).min(LANES);
            for (i, place) in block.place.iter().enumerate().take(count) {
                receive(*place, [lit[0][i], lit[1][i], lit[2][i], lit[3][i]]);
            }
        }
        self.count = 0;
    }
}

// One index for many arrays allows vectorisation; unused entries are computed, too.
#[allow(clippy::needless_range_loop)]
impl ItemBlock {
    /// Colours times weights, and opacities, which are higher for surfaces seen edge-on.
    #[inline(always)]
    fn light(&self, view: &RasterView) -> [[f32; LANES]; 4] {
        let shares = self.shares();
        let normal = self.normals(&shares, view.lens.perspective);
        let open = self.open(view, &shares, &normal);
        let to_viewer = self.directions(view.lens);
        let around = view.around;
        let mut lit = [[0.0; LANES]; 4];
        for i in 0..LANES {
            let at = |a: &[[f32; LANES]; 3]| [a[0][i], a[1][i], a[2][i]];
            let (normal, to_viewer) = (unit_vector(at(&normal)), unit_vector(at(&to_viewer)));
            let (albedo, flat) = (at(&self.albedo), self.flat[i]);
            let open = [open[0][i], open[1][i]];
            let rgb = look::shade_surface(normal, to_viewer, &around, albedo, flat, open);
            for k in 0..3 {
                lit[k][i] = rgb[k] * self.weight[i];
            }
            let cosine = look::clamp_unit(look::dot_product(normal, to_viewer));
            let opacity = self.opacity[i];
            // Flat colours have their own.
            lit[3][i] = look::mix_values(look::edge_opacity(opacity, cosine), opacity, flat);
        }
        lit
    }

    /// Directions to the viewer, of any length.
    #[inline(always)]
    fn directions(&self, lens: &Lens) -> [[f32; LANES]; 3] {
        let mut to_viewer = [[0.0; LANES]; 3];
        for i in 0..LANES {
            let [x, y] = [self.x[i], self.y[i]].map(|c| c as f32 + 0.5);
            [to_viewer[0][i], to_viewer[1][i], to_viewer[2][i]] = lens.viewer_from(x, y);
        }
        to_viewer
    }

    /// The edge functions opposite the corners at the centres of the pixels: the corners' shares, times the area.
    #[inline(always)]
    fn shares(&self) -> [[f32; LANES]; 3] {
        let mut shares = [[0.0; LANES]; 3];
        for (k, (from, to)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
            for i in 0..LANES {
                let [x, y] = [self.x[i], self.y[i]].map(|c| c * SUBPIXELS + SUBPIXELS / 2);
                let (from_x, from_y) = (self.corner_x[from][i], self.corner_y[from][i]);
                let (to_x, to_y) = (self.corner_x[to][i], self.corner_y[to][i]);
                shares[k][i] = (to_y - from_y) as f32 * (x - from_x) as f32
                    + (from_x - to_x) as f32 * (y - from_y) as f32;
            }
        }
        shares
    }

    /// The interpolated normals at the centres of the pixels, on the visible side, of any length.
    ///
    /// If a facet covers part of a pixel but not its centre, the normal is that of an edge.
    #[inline(always)]
    fn normals(&self, shares: &[[f32; LANES]; 3], perspective: bool) -> [[f32; LANES]; 3] {
        let mut weights = *shares;
        for (k, weights) in weights.iter_mut().enumerate() {
            for i in 0..LANES {
                let depth = if perspective { self.depth[k][i] } else { 1.0 };
                weights[i] = look::larger_of(weights[i], 0.0) * depth;
            }
        }
        // The weights' sum is of the size of the area; scaled to keep the squares within range.
        let mut scale = [0.0; LANES];
        for i in 0..LANES {
            let sum = weights[0][i] + weights[1][i] + weights[2][i];
            scale[i] = self.side[i] / look::larger_of(sum, look::LEAST_DIVISOR);
        }
        let mut normals = [[0.0; LANES]; 3];
        let [a, b, c] = &self.corner_normal;
        for (n, normals) in normals.iter_mut().enumerate() {
            for i in 0..LANES {
                let sum =
                    weights[0][i] * a[n][i] + weights[1][i] * b[n][i] + weights[2][i] * c[n][i];
                normals[i] = sum * scale[i];
            }
        }
        normals
    }

    /// How much of the light reaches the surfaces; wholly flat colours need none.
    #[inline(always)]
    fn open(
        &self,
        view: &RasterView,
        shares: &[[f32; LANES]; 3],
        normal: &[[f32; LANES]; 3],
    ) -> [[f32; LANES]; 2] {
        let mut open = ALL_OPEN.map(|all| [all; LANES]);
        let Some(shade) = view.shade else {
            return open;
        };
        for i in (0..LANES).filter(|i| self.flat[*i] < 1.0) {
            let at = [self.x[i] as f32 + 0.5, self.y[i] as f32 + 0.5];
            let depth = [0, 1, 2].map(|k| self.depth[k][i]);
            let nearness = nearness([0, 1, 2].map(|k| shares[k][i]), depth);
            let place = view.lens.place(at[0], at[1], nearness);
            let normal = [0, 1, 2].map(|k| normal[k][i]);
            [open[0][i], open[1][i]] = shade.on(at, place, normal);
        }
        open
    }
}

/// The nearness of a facet's plane, limited to the range of its corners, where they have these shares.
#[inline(always)]
fn nearness(shares: [f32; 3], depth: [f32; 3]) -> f32 {
    let sum = shares[0] * depth[0] + shares[1] * depth[1] + shares[2] * depth[2];
    let nearness = sum / look::larger_of(shares[0] + shares[1] + shares[2], look::LEAST_DIVISOR);
    let [a, b, c] = depth;
    look::smaller_of(
        look::larger_of(nearness, look::smaller_of(look::smaller_of(a, b), c)),
        look::larger_of(look::larger_of(a, b), c),
    )
}

/// The vector with length 1; a zero vector stays zero.
#[inline(always)]
fn unit_vector(v: [f32; 3]) -> [f32; 3] {
    let scale = 1.0 / look::larger_of(look::dot_product(v, v), look::LEAST_DIVISOR).sqrt();
    [v[0] * scale, v[1] * scale, v[2] * scale]
}
