//! Triangles that are too large for a test of every cell: block by block, and row by row within a block.
//!
//! As exact as for small triangles: the sign of an edge function is decided in 64 bits.

use super::lens::LensVertex;
use super::mask::PixelMask;
use super::raster::{EdgeFunctions, EdgeSide, Plane, RasterCells, Visit, scan_triangle};
use super::samples::{LANES, SUBPIXEL_BITS, SUBPIXELS, SamplePattern};
use super::window::{TILE, Window};
use wide::{f32x4, i32x4};

/// Side of the smallest block in pixels.
const LEAST_BLOCK: i32 = 8;
/// An edge whose steps add up to less than this over a block that it crosses stays below 2^31 there.
const BLOCK_REACH: i64 = 1 << 31;
/// Rows whose ranges are computed at once.
const ROWS: usize = LANES;
/// Guard in cells around a computed range, against the rounding of f32.
const RANGE_GUARD: f32 = 0.01;

/// A triangle of any size: blocks outside an edge are skipped, and within a block only the edges that cross it are
/// tested.
pub(super) fn by_blocks<const G: usize>(
    corners: [&LensVertex; 3],
    (window, needed): (&Window, &PixelMask),
    area: &Window,
    pattern: &SamplePattern<G>,
    mut visit: impl Visit,
) {
    let first = [window.x[0] << SUBPIXEL_BITS, window.y[0] << SUBPIXEL_BITS];
    // Edge functions from the window's corner. Top-left rule: a zero counts as inside for one of two neighbours.
    let side = |from: &LensVertex, to: &LensVertex| {
        let (x, y) = (i64::from(to.y - from.y), i64::from(from.x - to.x));
        let belongs = (x > 0) | ((x == 0) & (y > 0));
        let start = x * i64::from(first[0] - from.x) + y * i64::from(first[1] - from.y);
        EdgeSide {
            x,
            y,
            start: start - i64::from(!belongs),
        }
    };
    let [a, b, c] = corners;
    let sides = [side(a, b), side(b, c), side(c, a)];
    // Twice the area, by which the depth's plane is scaled.
    let double = sides[0].x * i64::from(c.x - a.x) + sides[0].y * i64::from(c.y - a.y);
    let slope = |s: &EdgeSide<i64>| [s.x as f32, s.y as f32];
    let plane = Plane::new(corners, slope(&sides[0]), slope(&sides[2]), double as f32);
    let offsets = plane.offsets(pattern);
    let lanes = (pattern, &offsets);
    let steepest = sides
        .iter()
        .map(|s| s.x.abs() + s.y.abs())
        .max()
        .unwrap_or(0);
    // Blocks shrink until the edge functions fit into 32 bits within one, or to the least size.
    let mut size = TILE as i32;
    while size > LEAST_BLOCK && steepest * i64::from(size * SUBPIXELS) >= BLOCK_REACH {
        size /= 2;
    }
    let block = |at: i32, origin: i32| (at - origin) / size;
    for row in block(area.y[0], window.y[0])..block(area.y[1], window.y[0]) + 1 {
        for column in block(area.x[0], window.x[0])..block(area.x[1], window.x[0]) + 1 {
            let corner = [window.x[0] + column * size, window.y[0] + row * size];
            let part = Window {
                x: [corner[0], area.x[1].min(corner[0] + size - 1)],
                y: [corner[1], area.y[1].min(corner[1] + size - 1)],
            };
            let span = i64::from(size * SUBPIXELS);
            // The edge functions are affine: from block to block they change by constant steps.
            let moved = sides.map(|s| EdgeSide {
                start: s.start + (s.x * i64::from(column) + s.y * i64::from(row)) * span,
                ..s
            });
            let cells = RasterCells::new(&part, window, pattern);
            let cells = (&cells, needed);
            in_block(&moved, span, cells, &plane, corner, lanes, &mut visit);
        }
    }
}

/// The part of a triangle in one block of `span` screen units.
fn in_block<const G: usize>(
    sides: &[EdgeSide<i64>; 3],
    span: i64,
    (cells, needed): (&RasterCells, &PixelMask),
    plane: &Plane,
    corner: [i32; 2],
    lanes: (&SamplePattern<G>, &[f32x4; G]),
    visit: &mut impl Visit,
) {
    let (pattern, _) = lanes;
    let mut crossing = [EdgeSide {
        x: 0,
        y: 0,
        start: 0,
    }; 3];
    for (own, side) in crossing.iter_mut().zip(sides) {
        if side.start + (side.x.max(0) + side.y.max(0)) * span < 0 {
            return;
        }
        if side.start + (side.x.min(0) + side.y.min(0)) * span >= 0 {
            // The whole block is on the inner side: a constant zero counts as inside.
            continue;
        }
        if (side.x.abs() + side.y.abs()) * span >= BLOCK_REACH {
            in_vast_block(sides, cells, plane, corner, lanes, visit);
            return;
        }
        *own = EdgeSide {
            x: side.x as i32,
            y: side.y as i32,
            start: side.start as i32,
        };
    }
    let offsets: [[[i32; LANES]; G]; 3] = crossing.map(|side| {
        std::array::from_fn(|g| {
            std::array::from_fn(|lane| side.x * pattern.x[g][lane] + side.y * pattern.y[g][lane])
        })
    });
    let highest = offsets.map(|o| o.as_flattened().iter().copied().max().unwrap_or(0));
    let step = crossing.map(|side| side.x * (SUBPIXELS << pattern.cell_bits));
    let rows = CellRows {
        sides: &crossing,
        highest,
        step,
        last: (cells.x[1] - cells.x[0]) as f32,
    };
    let mut ranges = [[1, 0]; ROWS];
    for row in cells.y[0]..cells.y[1] + 1 {
        let k = (row - cells.y[0]) as usize % ROWS;
        if k == 0 {
            ranges = rows.ranges((row - cells.y[0]) * SUBPIXELS);
        }
        let [from, to] = ranges[k];
        let columns = [from, to].map(|k| (cells.x[0] + k) << pattern.cell_bits);
        let end = columns[1] + (1 << pattern.cell_bits) - 1;
        if from > to || !needed.has_any(row, [columns[0], end]) {
            continue;
        }
        let down = (row - cells.y[0]) * SUBPIXELS;
        let start = crossing.map(|side| side.start.saturating_add(side.y * down));
        let edges = EdgeFunctions {
            at: std::array::from_fn(|k| {
                let start = i32x4::splat(start[k].wrapping_add(step[k] * from));
                std::array::from_fn(|g| i32x4::from(offsets[k][g]) + start)
            }),
            step_x: step.map(i32x4::splat),
            step_y: [i32x4::splat(0); 3],
        };
        let part = RasterCells {
            x: [cells.x[0] + from, cells.x[0] + to],
            y: [row, row],
        };
        let origin = [
            corner[0] + (from << pattern.cell_bits),
            corner[1] + row - cells.y[0],
        ];
        scan_triangle(edges, &part, plane, origin, lanes, visit);
    }
}

/// Edge functions over the rows of a block that they cross; all are below 2^31 there.
struct CellRows<'a> {
    sides: &'a [EdgeSide<i32>; 3],
    /// The greatest offset of a sample of a cell.
    highest: [i32; 3],
    /// From cell to cell.
    step: [i32; 3],
    /// The last column.
    last: f32,
}

impl CellRows<'_> {
    /// First and last cell that may be covered in each of the rows from `down` screen units on; the last is before the
    /// first where there is none.
    #[inline(always)]
    fn ranges(&self, down: i32) -> [[i32; 2]; ROWS] {
        let places = i32x4::from([0, 1, 2, 3]) * i32x4::splat(SUBPIXELS) + i32x4::splat(down);
        let (mut low, mut high) = (f32x4::splat(0.0), f32x4::splat(self.last));
        for (k, side) in self.sides.iter().enumerate() {
            let most = i32x4::splat(side.start.wrapping_add(self.highest[k]));
            let most = (most + i32x4::splat(side.y) * places).round_float();
            let zero = -most * f32x4::splat(1.0 / self.step[k] as f32);
            if self.step[k] > 0 {
                low = (zero - f32x4::splat(RANGE_GUARD)).fast_max(low);
            } else if self.step[k] < 0 {
                high = (zero + f32x4::splat(RANGE_GUARD)).fast_min(high);
            } else {
                let outside = most.simd_lt(f32x4::splat(0.0));
                high = outside.bitselect(f32x4::splat(-2.0), high);
            }
        }
        // Truncation adds at most one cell in front, which is found to be uncovered.
        let [from, to] = [low, high].map(|v| v.fast_trunc_int().to_array());
        let is_empty = low.simd_gt(high).to_bitmask();
        std::array::from_fn(|k| match is_empty >> k & 1 {
            0 => [from[k], to[k]],
            _ => [1, 0],
        })
    }
}

/// The same for edges so long that they need 64 bits even within a block.
#[allow(clippy::needless_range_loop)]
#[cold]
fn in_vast_block<const G: usize>(
    sides: &[EdgeSide<i64>; 3],
    cells: &RasterCells,
    plane: &Plane,
    corner: [i32; 2],
    (pattern, offsets): (&SamplePattern<G>, &[f32x4; G]),
    visit: &mut impl Visit,
) {
    let columns = TILE as i32 >> pattern.cell_bits;
    // Every cell of the block is tested: this is rare.
    for row in cells.y[0]..=cells.y[1] {
        for column in cells.x[0]..=cells.x[1] {
            let x = (column - cells.x[0]) << pattern.cell_bits;
            let y = row - cells.y[0];
            let depth = f32x4::splat(plane.at(corner[0] + x, corner[1] + y));
            for g in 0..G {
                // Inside is where no edge function is negative; lanes become masks.
                let covered = std::array::from_fn::<f32, LANES, _>(|lane| {
                    let place = |p: i32, offset: i32| i64::from(p * SUBPIXELS + offset);
                    let (dx, dy) = (place(x, pattern.x[g][lane]), place(y, pattern.y[g][lane]));
                    let inside = sides.iter().all(|s| s.start + s.x * dx + s.y * dy >= 0);
                    f32::from_bits(if inside { u32::MAX } else { 0 })
                });
                let covered = f32x4::from(covered);
                if covered.to_bitmask() != 0 {
                    visit(
                        (row * columns + column) as usize,
                        g,
                        covered,
                        depth + offsets[g],
                    );
                }
            }
        }
    }
}
