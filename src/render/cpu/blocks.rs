//! Triangles that are too large for a test of every cell: block by block, and row by row within a block.
//!
//! As exact as for small triangles: the sign of an edge function is decided in 64 bits.

use super::lens::LensVertex;
use super::raster::{EdgeFunctions, EdgeSide, Plane, RasterCells, Visit, scan_triangle};
use super::samples::{LANES, SUBPIXEL_BITS, SUBPIXELS, SamplePattern};
use super::window::{TILE, Window};
use wide::{f32x4, i32x4};

/// Side of the smallest block in pixels.
const LEAST_BLOCK: i32 = 8;
/// An edge whose steps add up to less than this over a block that it crosses stays below 2^31 there.
const BLOCK_REACH: i64 = 1 << 31;
/// Guard in cells around a computed range, against the rounding of f32.
const RANGE_GUARD: f32 = 0.01;

/// A triangle of any size: blocks outside an edge are skipped, and within a block only the edges that cross it are
/// tested.
pub(super) fn by_blocks<const G: usize>(
    corners: [&LensVertex; 3],
    window: &Window,
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
    for row in block(area.y[0], window.y[0])..=block(area.y[1], window.y[0]) {
        for column in block(area.x[0], window.x[0])..=block(area.x[1], window.x[0]) {
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
            in_block(&moved, span, &cells, &plane, corner, pattern, &mut visit);
        }
    }
}

/// The part of a triangle in one block of `span` screen units.
fn in_block<const G: usize>(
    sides: &[EdgeSide<i64>; 3],
    span: i64,
    cells: &RasterCells,
    plane: &Plane,
    corner: [i32; 2],
    pattern: &SamplePattern<G>,
    visit: &mut impl Visit,
) {
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
            in_vast_block(sides, cells, plane, corner, pattern, visit);
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
    let inverse = step.map(|step| 1.0 / step as f32);
    for row in cells.y[0]..=cells.y[1] {
        let down = (row - cells.y[0]) * SUBPIXELS;
        let start = crossing.map(|side| side.start.saturating_add(side.y * down));
        let mut range = [0.0, (cells.x[1] - cells.x[0]) as f32];
        for k in 0..3 {
            let most = i64::from(start[k]) + i64::from(highest[k]);
            let zero = -(most as f32) * inverse[k];
            if step[k] > 0 {
                range[0] = (zero - RANGE_GUARD).max(range[0]);
            } else if step[k] < 0 {
                range[1] = (zero + RANGE_GUARD).min(range[1]);
            } else if most < 0 {
                range[1] = -2.0;
            }
        }
        // Truncation adds at most one cell in front, which is found to be uncovered.
        let (from, to) = (range[0] as i32, range[1] as i32);
        if range[0] > range[1] {
            continue;
        }
        let edges = EdgeFunctions {
            at: std::array::from_fn(|k| {
                std::array::from_fn(|g| {
                    i32x4::from(offsets[k][g]) + i32x4::splat(start[k].wrapping_add(step[k] * from))
                })
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
        scan_triangle(edges, &part, plane, origin, pattern, visit);
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
    pattern: &SamplePattern<G>,
    visit: &mut impl Visit,
) {
    let columns = TILE as i32 >> pattern.cell_bits;
    let offsets = plane.offsets(pattern);
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
