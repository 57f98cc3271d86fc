//! Which facets each tile has to draw, and where they changed since the last frame.

use super::super::lens::LensVertex;
use super::super::mask::PixelMask;
use super::super::samples::SUBPIXEL_BITS;
use super::super::window::{TILE, Window};
use super::tile_bin::TileBin;
use super::{Facet, TriangleAssembly};
use std::ops::Range;

/// Facets of more pixels than this along both axes may miss much of the rectangle around them.
const SMALL: i32 = 8;
/// Side in pixels, as a power of two, of the blocks in which the pixels of such a facet are counted.
const BLOCK_BITS: u32 = 3;
const BLOCK: i32 = 1 << BLOCK_BITS;

/// A triangle on the screen.
pub(super) struct ScreenTriangle {
    pixels: Window,
    /// Steps of the edge functions per screen unit to the right and down, and their values at the origin; none is negative
    /// inside. `None` for a triangle that fills much of the rectangle around it, or a small one.
    sides: Option<[[i64; 3]; 3]>,
}

impl ScreenTriangle {
    #[inline(always)]
    pub(super) fn new(facet: &Facet, vertices: &[LensVertex]) -> Self {
        let pixels = facet.pixels();
        let extent = |[first, last]: [i32; 2]| last - first;
        let is_small = extent(pixels.x) < SMALL || extent(pixels.y) < SMALL;
        let sides = (!is_small).then(|| sides_of(facet, vertices));
        Self { pixels, sides }
    }

    /// Whether it may have a sample in a rectangle of pixels.
    #[inline(always)]
    fn meets(&self, x: [i32; 2], y: [i32; 2]) -> bool {
        let Some(sides) = &self.sides else {
            return true;
        };
        let units = |[first, last]: [i32; 2]| {
            let [first, end] = [first, last + 1].map(|p| i64::from(p << SUBPIXEL_BITS));
            (first, end - first)
        };
        let ((left, width), (top, height)) = (units(x), units(y));
        // The greatest value within the rectangle is that at one of its corners.
        sides.iter().all(|[right, down, start]| {
            let corner = start + right * left + down * top;
            corner + right.max(&0) * width + down.max(&0) * height >= 0
        })
    }

    /// Adds its pixels in a tile to `mask`, and perhaps some more around them.
    #[inline(always)]
    pub(super) fn mark(&self, [left, top]: [i32; 2], mask: &mut PixelMask) {
        if self.sides.is_none() {
            mask.add([left, top], &self.pixels);
            return;
        }
        // Block by block: those that none of the sides keeps out.
        let part = |p: i32, [first, last]: [i32; 2]| [p.max(first), (p + BLOCK - 1).min(last)];
        let blocks = |start: i32, [first, last]: [i32; 2]| {
            let [first, last] = [first.max(start), last.min(start + TILE as i32 - 1)];
            (first - start) >> BLOCK_BITS..((last - start) >> BLOCK_BITS) + 1
        };
        for row in blocks(top, self.pixels.y) {
            for column in blocks(left, self.pixels.x) {
                let block = Window {
                    x: part(left + column * BLOCK, self.pixels.x),
                    y: part(top + row * BLOCK, self.pixels.y),
                };
                if self.meets(block.x, block.y) {
                    mask.add([left, top], &block);
                }
            }
        }
    }
}

/// The edge functions of a facet, whose corners are counter-clockwise on the screen.
fn sides_of(facet: &Facet, vertices: &[LensVertex]) -> [[i64; 3]; 3] {
    let [a, b, c] = facet.corners.map(|i| &vertices[i as usize]);
    let side = |from: &LensVertex, to: &LensVertex| {
        let (x, y) = (i64::from(to.y - from.y), i64::from(from.x - to.x));
        [x, y, -(x * i64::from(from.x) + y * i64::from(from.y))]
    };
    [side(a, b), side(b, c), side(c, a)]
}

impl TriangleAssembly {
    /// The pixels of a tile, counted from the first that is drawn on.
    pub fn window(&self, tile: usize) -> Window {
        let [column, row] = [tile % self.columns, tile / self.columns].map(|k| k as i32);
        let range = |k: i32, size: i32| [k * self.pitch, ((k + 1) * self.pitch).min(size) - 1];
        Window {
            x: range(column, self.size[0]),
            y: range(row + self.tile_rows[0], self.size[1]),
        }
    }

    /// The pixels of a tile and those around it that its lines depend on.
    pub fn with_apron(&self, inner: Window) -> Window {
        let grown = |[first, last]: [i32; 2], size: i32| {
            [
                (first - self.apron).max(0),
                (last + self.apron).min(size - 1),
            ]
        };
        Window {
            x: grown(inner.x, self.size[0]),
            y: grown(inner.y, self.size[1]),
        }
    }

    /// Selects the tiles that show any of the rows, of which there is at least one.
    pub fn select_rows(&mut self, rows: &Range<usize>) {
        let [first, last] = [rows.start, rows.end - 1].map(|y| y as i32 / self.pitch);
        if self.tile_rows != [first, last] {
            self.last.forget();
        }
        self.tile_rows = [first, last];
        self.reach = [
            (first * self.pitch - self.apron).max(0),
            ((last + 1) * self.pitch - 1 + self.apron).min(self.size[1] - 1),
        ];
        let count = (last - first + 1) as usize * self.columns;
        self.bins.resize(count, TileBin::NEW);
    }

    /// Puts a facet into the bins of all tiles that it can reach, with the aprons that their lines depend on.
    #[inline(always)]
    pub(super) fn add_to_tiles(&mut self, number: u32) {
        let facet = &self.facets[number as usize];
        let triangle = ScreenTriangle::new(facet, &self.vertices);
        let opaque = self.paints[facet.instance()].opacity >= 1.0;
        // The rectangle of tiles around it.
        let tiles = |[first, last]: [i32; 2], size: i32| {
            let first = (first - self.apron).max(0) / self.pitch;
            let last = (last + self.apron).min(size - 1) / self.pitch;
            [first, last]
        };
        let [left, right] = tiles(triangle.pixels.x, self.size[0]);
        let [top, bottom] = tiles(triangle.pixels.y, self.size[1]);
        // Of them those that the sides do not keep out.
        let [first, last] = self.tile_rows;
        for row in top.max(first)..=bottom.min(last) {
            let start = (row - first) as usize * self.columns;
            let bins = &mut self.bins[start + left as usize..=start + right as usize];
            for (column, bin) in (left..).zip(bins) {
                let corner = [column, row].map(|k| (k * self.pitch - self.apron).max(0));
                let range = |k: usize| [corner[k], corner[k] + TILE as i32 - 1];
                if !triangle.meets(range(0), range(1)) {
                    continue;
                }
                if self.is_renewed {
                    triangle.mark(corner, &mut bin.changed);
                }
                if opaque {
                    bin.opaque.push(number);
                } else {
                    bin.translucent.push(number);
                }
            }
        }
    }
}
