//! Finds the samples of a tile that a triangle covers, and their depths: integer edge functions with the top-left rule.
//!
//! A sample on an edge shared by two triangles belongs to exactly one of them.

use super::lens::LensVertex;
use super::samples::{SUBPIXEL_BITS, SUBPIXELS, SamplePattern};
use super::window::{TILE, Window};
use wide::{f32x4, i32x4};

/// Longest side in screen units of a triangle that is visited cell by cell: products of two such lengths,
/// doubled, stay below 2^31.
pub(super) const DIRECT_REACH: i32 = 1 << 14;

/// The coverage of one vector of a cell: index of the cell in its tile, number of the vector, all ones in the covered
/// lanes, depths of all lanes.
pub(super) trait Visit: FnMut(usize, usize, f32x4, f32x4) {}
impl<F: FnMut(usize, usize, f32x4, f32x4)> Visit for F {}

/// Depth as a function on the screen: value at a point, and its increase per screen unit to the right and down.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    from: [i32; 2],
    depth: f32,
    x: f32,
    y: f32,
}

impl Plane {
    /// Through the corners; `ca` and `ab` are the steps of the edges opposite b and c.
    #[inline(always)]
    pub(super) fn new([a, b, c]: [&LensVertex; 3], ab: [f32; 2], ca: [f32; 2], area: f32) -> Self {
        let inverse = 1.0 / area;
        let (to_b, to_c) = ((b.depth - a.depth) * inverse, (c.depth - a.depth) * inverse);
        Self {
            from: [a.x, a.y],
            depth: a.depth,
            x: to_b * ca[0] + to_c * ab[0],
            y: to_b * ca[1] + to_c * ab[1],
        }
    }

    /// At the corner of a pixel.
    #[inline(always)]
    pub(super) fn at(&self, x: i32, y: i32) -> f32 {
        let (dx, dy) = (
            (x << SUBPIXEL_BITS) - self.from[0],
            (y << SUBPIXEL_BITS) - self.from[1],
        );
        self.depth + self.x * dx as f32 + self.y * dy as f32
    }

    #[inline(always)]
    pub(super) fn offsets<const G: usize>(&self, pattern: &SamplePattern<G>) -> [f32x4; G] {
        std::array::from_fn(|g| {
            pattern.places_x[g] * f32x4::splat(self.x) + pattern.places_y[g] * f32x4::splat(self.y)
        })
    }
}

/// Edge functions at the lanes of a first cell, with their steps from cell to cell and from row to row.
pub(super) struct EdgeFunctions<const G: usize> {
    pub(super) at: [[i32x4; G]; 3],
    pub(super) step_x: [i32x4; 3],
    pub(super) step_y: [i32x4; 3],
}

/// Cells of a tile: first and last column, first and last row.
pub(super) struct RasterCells {
    pub(super) x: [i32; 2],
    pub(super) y: [i32; 2],
}

impl RasterCells {
    #[inline(always)]
    pub(super) fn new<const G: usize>(
        area: &Window,
        window: &Window,
        pattern: &SamplePattern<G>,
    ) -> Self {
        let column = |x: i32| (x - window.x[0]) >> pattern.cell_bits;
        Self {
            x: [column(area.x[0]), column(area.x[1])],
            y: [area.y[0] - window.y[0], area.y[1] - window.y[0]],
        }
    }

    /// First pixel of the first cell.
    #[inline(always)]
    fn origin<const G: usize>(&self, window: &Window, pattern: &SamplePattern<G>) -> [i32; 2] {
        [
            window.x[0] + (self.x[0] << pattern.cell_bits),
            window.y[0] + self.y[0],
        ]
    }
}

/// Visits the cells, knowing the edge functions and the depth at the first one.
// One index for several arrays of vectors.
#[allow(clippy::needless_range_loop)]
#[inline(always)]
pub(super) fn scan_triangle<const G: usize>(
    mut edges: EdgeFunctions<G>,
    cells: &RasterCells,
    plane: &Plane,
    origin: [i32; 2],
    (pattern, offsets): (&SamplePattern<G>, &[f32x4; G]),
    visit: &mut impl Visit,
) {
    let step = plane.x * (SUBPIXELS << pattern.cell_bits) as f32;
    let columns = TILE as i32 >> pattern.cell_bits;
    // The edge functions are affine: from cell to cell and row to row they grow by constant steps.
    // Half-open ranges: loops over closed ones have another branch.
    for row in cells.y[0]..cells.y[1] + 1 {
        let mut at = edges.at;
        let start = plane.at(origin[0], origin[1] + row - cells.y[0]);
        let mut along = 0.0;
        for cell in row * columns + cells.x[0]..row * columns + cells.x[1] + 1 {
            for g in 0..G {
                // Outside is where any of the three is negative: the sign bit of their union.
                let outside: i32x4 = at[0][g] | at[1][g] | at[2][g];
                if f32x4::from_bits(outside.cast_unsigned()).to_bitmask() != 0b1111 {
                    let outside = f32x4::from_bits((outside >> 31u32).cast_unsigned());
                    // Depths are computed from the column, not summed up, so that rounding does not grow.
                    let depth = f32x4::splat(start + step * along) + offsets[g];
                    visit(cell as usize, g, !outside, depth);
                }
                for k in 0..3 {
                    at[k][g] += edges.step_x[k];
                }
            }
            along += 1.0;
        }
        for k in 0..3 {
            for g in 0..G {
                edges.at[k][g] += edges.step_y[k];
            }
        }
    }
}

/// One edge: its value grows by `x` a screen unit to the right and by `y` a unit down, and is at least
/// zero on the points that belong to the triangle.
#[derive(Clone, Copy)]
pub(super) struct EdgeSide<T> {
    pub(super) x: T,
    pub(super) y: T,
    /// At the first cell's corner.
    pub(super) start: T,
}

/// A small triangle, whose sides are shorter than [`DIRECT_REACH`]: all in 32 bits.
#[inline(always)]
pub(super) fn shade_direct<const G: usize>(
    corners: [&LensVertex; 3],
    window: &Window,
    area: &Window,
    pattern: &SamplePattern<G>,
    mut visit: impl Visit,
) {
    let cells = RasterCells::new(area, window, pattern);
    let origin = cells.origin(window, pattern);
    let side = |from: &LensVertex, to: &LensVertex| {
        let (x, y) = (to.y - from.y, from.x - to.x);
        // Without branches: the processor could not predict them.
        let belongs = (x > 0) | ((x == 0) & (y > 0));
        let (dx, dy) = (
            (origin[0] << SUBPIXEL_BITS) - from.x,
            (origin[1] << SUBPIXEL_BITS) - from.y,
        );
        EdgeSide {
            x,
            y,
            start: x * dx + y * dy - i32::from(!belongs),
        }
    };
    let [a, b, c] = corners;
    let sides = [side(a, b), side(b, c), side(c, a)];
    let double = sides[0].x * (c.x - a.x) + sides[0].y * (c.y - a.y);
    let slope = |s: &EdgeSide<i32>| [s.x as f32, s.y as f32];
    let plane = Plane::new(corners, slope(&sides[0]), slope(&sides[2]), double as f32);
    // A coordinate times a step is below 2^24, where f32 is exact and its vector product is one instruction.
    let lanes = |side: &EdgeSide<i32>| -> [i32x4; G] {
        std::array::from_fn(|g| {
            let offset = pattern.places_x[g] * f32x4::splat(side.x as f32)
                + pattern.places_y[g] * f32x4::splat(side.y as f32);
            offset.fast_trunc_int() + i32x4::splat(side.start)
        })
    };
    let cell = SUBPIXELS << pattern.cell_bits;
    let edges = EdgeFunctions {
        at: [lanes(&sides[0]), lanes(&sides[1]), lanes(&sides[2])],
        step_x: [0, 1, 2].map(|k| i32x4::splat(sides[k].x * cell)),
        step_y: [0, 1, 2].map(|k| i32x4::splat(sides[k].y * SUBPIXELS)),
    };
    let offsets = plane.offsets(pattern);
    let lanes = (pattern, &offsets);
    scan_triangle(edges, &cells, &plane, origin, lanes, &mut visit);
}
