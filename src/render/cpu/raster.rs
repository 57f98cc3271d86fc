//! Which samples of a tile a triangle covers, and how deep: integer edge functions with the top-left rule.
//!
//! A sample on an edge that two triangles share belongs to exactly one of them. Holds no colours.

use super::lens::Vertex;
use super::samples::{LANES, Pattern, SUBPIXEL_BITS, SUBPIXELS};
use super::tile::TILE;
use wide::{f32x4, i32x4};

/// A triangle whose part in the tile has at most this many rows or columns is visited cell by cell; in
/// a larger one the range of cells is computed for each row.
const DIRECT: i32 = 12;
/// Longest side in screen units of a triangle that is visited cell by cell: products of two such lengths,
/// doubled, stay below 2^31.
const DIRECT_REACH: i32 = 1 << 14;
/// Side of the smallest block in pixels.
const LEAST_BLOCK: i32 = 8;
/// An edge whose steps add up to less than this over a block that it crosses stays below 2^31 there.
const BLOCK_REACH: i64 = 1 << 31;
/// Guard in cells around a computed range, against the rounding of f32.
const RANGE_GUARD: f32 = 0.01;

/// Pixels of the picture, first included, last included. The first is the tile's own first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) x: [i32; 2],
    pub(super) y: [i32; 2],
}

/// What a triangle does in one vector of a cell: index of the cell in its tile, number of the vector, all
/// ones in the lanes that are covered, depths of all lanes.
pub(super) trait Visit: FnMut(usize, usize, f32x4, f32x4) {}
impl<F: FnMut(usize, usize, f32x4, f32x4)> Visit for F {}

/// Calls `visit` for every vector of samples of which the triangle covers any. The corners are
/// counter-clockwise on the screen.
#[inline(always)]
pub(super) fn rasterise<const G: usize>(
    corners: [&Vertex; 3],
    window: &Window,
    pattern: &Pattern<G>,
    visit: impl Visit,
) {
    let [a, b, c] = corners;
    let [left, right] = [a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)];
    let [top, bottom] = [a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)];
    let (x, y) = (pattern.pixels(left, right), pattern.pixels(top, bottom));
    let area = Window {
        x: [x[0].max(window.x[0]), x[1].min(window.x[1])],
        y: [y[0].max(window.y[0]), y[1].min(window.y[1])],
    };
    if area.x[0] > area.x[1] || area.y[0] > area.y[1] {
        return;
    }
    let small = area.x[1] - area.x[0] < DIRECT && area.y[1] - area.y[0] < DIRECT;
    if small && right - left < DIRECT_REACH && bottom - top < DIRECT_REACH {
        direct(corners, window, &area, pattern, visit);
    } else {
        by_blocks(corners, window, &area, pattern, visit);
    }
}

/// Depth over the screen: at a point, and its growth a screen unit to the right and down.
#[derive(Clone, Copy)]
struct Plane {
    from: [i32; 2],
    depth: f32,
    x: f32,
    y: f32,
}

impl Plane {
    /// Through the corners; `ca` and `ab` are the steps of the edges opposite b and c.
    #[inline(always)]
    fn new([a, b, c]: [&Vertex; 3], ab: [f32; 2], ca: [f32; 2], area: f32) -> Self {
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
    fn at(&self, x: i32, y: i32) -> f32 {
        let (dx, dy) = (
            (x << SUBPIXEL_BITS) - self.from[0],
            (y << SUBPIXEL_BITS) - self.from[1],
        );
        self.depth + self.x * dx as f32 + self.y * dy as f32
    }

    #[inline(always)]
    fn offsets<const G: usize>(&self, pattern: &Pattern<G>) -> [f32x4; G] {
        std::array::from_fn(|g| {
            let (x, y) = (
                pattern.x[g].map(|v| v as f32),
                pattern.y[g].map(|v| v as f32),
            );
            f32x4::from(x) * f32x4::splat(self.x) + f32x4::from(y) * f32x4::splat(self.y)
        })
    }
}

/// Edge functions at the lanes of a first cell, with their steps from cell to cell and from row to row.
struct Edges<const G: usize> {
    at: [[i32x4; G]; 3],
    step_x: [i32x4; 3],
    step_y: [i32x4; 3],
}

/// Cells of a tile: first and last column, first and last row.
struct Cells {
    x: [i32; 2],
    y: [i32; 2],
}

impl Cells {
    #[inline(always)]
    fn new<const G: usize>(area: &Window, window: &Window, pattern: &Pattern<G>) -> Self {
        let column = |x: i32| (x - window.x[0]) >> pattern.cell_bits;
        Self {
            x: [column(area.x[0]), column(area.x[1])],
            y: [area.y[0] - window.y[0], area.y[1] - window.y[0]],
        }
    }

    /// First pixel of the first cell.
    #[inline(always)]
    fn origin<const G: usize>(&self, window: &Window, pattern: &Pattern<G>) -> [i32; 2] {
        [
            window.x[0] + (self.x[0] << pattern.cell_bits),
            window.y[0] + self.y[0],
        ]
    }
}

/// Visits the cells, knowing the edge functions and the depth at the first one.
#[inline(always)]
fn scan<const G: usize>(
    mut edges: Edges<G>,
    cells: &Cells,
    plane: &Plane,
    origin: [i32; 2],
    pattern: &Pattern<G>,
    visit: &mut impl Visit,
) {
    let offsets = plane.offsets(pattern);
    let step = plane.x * (SUBPIXELS << pattern.cell_bits) as f32;
    let columns = TILE as i32 >> pattern.cell_bits;
    for row in cells.y[0]..=cells.y[1] {
        let mut at = edges.at;
        let start = plane.at(origin[0], origin[1] + row - cells.y[0]);
        let mut along = 0.0;
        for column in cells.x[0]..=cells.x[1] {
            for g in 0..G {
                let outside: i32x4 = at[0][g] | at[1][g] | at[2][g];
                let outside = f32x4::from_bits((outside >> 31u32).cast_unsigned());
                if outside.to_bitmask() != 0b1111 {
                    let depth = f32x4::splat(start + step * along) + offsets[g];
                    visit((row * columns + column) as usize, g, !outside, depth);
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
struct Side<T> {
    x: T,
    y: T,
    /// At the first cell's corner.
    start: T,
}

/// A small triangle, all in 32 bits.
#[inline(always)]
fn direct<const G: usize>(
    corners: [&Vertex; 3],
    window: &Window,
    area: &Window,
    pattern: &Pattern<G>,
    mut visit: impl Visit,
) {
    let cells = Cells::new(area, window, pattern);
    let origin = cells.origin(window, pattern);
    let side = |from: &Vertex, to: &Vertex| {
        let (x, y) = (to.y - from.y, from.x - to.x);
        // Without short cuts: a branch here would be a coin toss for the processor.
        let belongs = (x > 0) | ((x == 0) & (y > 0));
        let (dx, dy) = (
            (origin[0] << SUBPIXEL_BITS) - from.x,
            (origin[1] << SUBPIXEL_BITS) - from.y,
        );
        Side {
            x,
            y,
            start: x * dx + y * dy - i32::from(!belongs),
        }
    };
    let [a, b, c] = corners;
    let sides = [side(a, b), side(b, c), side(c, a)];
    let double = sides[0].x * (c.x - a.x) + sides[0].y * (c.y - a.y);
    let slope = |s: &Side<i32>| [s.x as f32, s.y as f32];
    let plane = Plane::new(corners, slope(&sides[0]), slope(&sides[2]), double as f32);
    // A place times a step is below 2^24, where f32 is exact and its vector product is one instruction.
    let lanes = |side: &Side<i32>| -> [i32x4; G] {
        std::array::from_fn(|g| {
            let offset = pattern.places_x[g] * f32x4::splat(side.x as f32)
                + pattern.places_y[g] * f32x4::splat(side.y as f32);
            offset.fast_trunc_int() + i32x4::splat(side.start)
        })
    };
    let cell = SUBPIXELS << pattern.cell_bits;
    let edges = Edges {
        at: [lanes(&sides[0]), lanes(&sides[1]), lanes(&sides[2])],
        step_x: [0, 1, 2].map(|k| i32x4::splat(sides[k].x * cell)),
        step_y: [0, 1, 2].map(|k| i32x4::splat(sides[k].y * SUBPIXELS)),
    };
    scan(edges, &cells, &plane, origin, pattern, &mut visit);
}

/// A triangle of any size: blocks that an edge leaves out are skipped, and only edges that cross a block
/// are looked at in it.
fn by_blocks<const G: usize>(
    corners: [&Vertex; 3],
    window: &Window,
    area: &Window,
    pattern: &Pattern<G>,
    mut visit: impl Visit,
) {
    let first = [window.x[0] << SUBPIXEL_BITS, window.y[0] << SUBPIXEL_BITS];
    let side = |from: &Vertex, to: &Vertex| {
        let (x, y) = (i64::from(to.y - from.y), i64::from(from.x - to.x));
        let belongs = (x > 0) | ((x == 0) & (y > 0));
        let start = x * i64::from(first[0] - from.x) + y * i64::from(first[1] - from.y);
        Side {
            x,
            y,
            start: start - i64::from(!belongs),
        }
    };
    let [a, b, c] = corners;
    let sides = [side(a, b), side(b, c), side(c, a)];
    let double = sides[0].x * i64::from(c.x - a.x) + sides[0].y * i64::from(c.y - a.y);
    let slope = |s: &Side<i64>| [s.x as f32, s.y as f32];
    let plane = Plane::new(corners, slope(&sides[0]), slope(&sides[2]), double as f32);
    let steepest = sides
        .iter()
        .map(|s| s.x.abs() + s.y.abs())
        .max()
        .unwrap_or(0);
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
            let moved = sides.map(|s| Side {
                start: s.start + (s.x * i64::from(column) + s.y * i64::from(row)) * span,
                ..s
            });
            let cells = Cells::new(&part, window, pattern);
            in_block(&moved, span, &cells, &plane, corner, pattern, &mut visit);
        }
    }
}

/// The part of a triangle in one block of `span` screen units.
fn in_block<const G: usize>(
    sides: &[Side<i64>; 3],
    span: i64,
    cells: &Cells,
    plane: &Plane,
    corner: [i32; 2],
    pattern: &Pattern<G>,
    visit: &mut impl Visit,
) {
    let mut crossing = [Side {
        x: 0,
        y: 0,
        start: 0,
    }; 3];
    for (own, side) in crossing.iter_mut().zip(sides) {
        if side.start + (side.x.max(0) + side.y.max(0)) * span < 0 {
            return;
        }
        if side.start + (side.x.min(0) + side.y.min(0)) * span >= 0 {
            // The whole block is on the inner side: zero everywhere counts as inside.
            continue;
        }
        if (side.x.abs() + side.y.abs()) * span >= BLOCK_REACH {
            in_vast_block(sides, cells, plane, corner, pattern, visit);
            return;
        }
        *own = Side {
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
        // Cutting off the fraction leaves at most one cell too many in front, which is found bare.
        let (from, to) = (range[0] as i32, range[1] as i32);
        if range[0] > range[1] {
            continue;
        }
        let edges = Edges {
            at: std::array::from_fn(|k| {
                std::array::from_fn(|g| {
                    i32x4::from(offsets[k][g]) + i32x4::splat(start[k].wrapping_add(step[k] * from))
                })
            }),
            step_x: step.map(i32x4::splat),
            step_y: [i32x4::splat(0); 3],
        };
        let part = Cells {
            x: [cells.x[0] + from, cells.x[0] + to],
            y: [row, row],
        };
        let origin = [
            corner[0] + (from << pattern.cell_bits),
            corner[1] + row - cells.y[0],
        ];
        scan(edges, &part, plane, origin, pattern, visit);
    }
}

/// The same for edges so long that they need 64 bits even within a block.
#[cold]
fn in_vast_block<const G: usize>(
    sides: &[Side<i64>; 3],
    cells: &Cells,
    plane: &Plane,
    corner: [i32; 2],
    pattern: &Pattern<G>,
    visit: &mut impl Visit,
) {
    let columns = TILE as i32 >> pattern.cell_bits;
    let offsets = plane.offsets(pattern);
    for row in cells.y[0]..=cells.y[1] {
        for column in cells.x[0]..=cells.x[1] {
            let x = (column - cells.x[0]) << pattern.cell_bits;
            let y = row - cells.y[0];
            let depth = f32x4::splat(plane.at(corner[0] + x, corner[1] + y));
            for g in 0..G {
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
