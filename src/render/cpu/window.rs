//! Tiles, and the part of a tile inside the picture.

use crate::render::Stage;
use crate::render::edges::EdgeStyle;

/// Pixels along a tile's sides: with four samples its depths and facets take 32 KiB, what the first-level
/// cache holds.
pub(super) const TILE: usize = 32;
/// Pixels of a tile.
pub(super) const AREA: usize = TILE * TILE;

/// Pixels of the picture, first included, last included. The first is the tile's own first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) x: [i32; 2],
    pub(super) y: [i32; 2],
}

/// Calls `visit` with the index in the tile, x and y of every pixel of `inner`, a part of the tile's window.
#[inline(always)]
pub(super) fn for_inner(window: Window, inner: Window, mut visit: impl FnMut(usize, i32, i32)) {
    for y in inner.y[0]..=inner.y[1] {
        let row = (y - window.y[0]) as usize * TILE;
        for x in inner.x[0]..=inner.x[1] {
            visit(row + (x - window.x[0]) as usize, x, y);
        }
    }
}

/// Calls `visit` with the index in the tile, x and y of every pixel of the window, row by row.
#[inline(always)]
pub(super) fn for_pixels(window: Window, mut visit: impl FnMut(usize, i32, i32)) {
    for y in window.y[0]..=window.y[1] {
        let row = (y - window.y[0]) as usize * TILE;
        for x in window.x[0]..=window.x[1] {
            visit(row + (x - window.x[0]) as usize, x, y);
        }
    }
}

/// Pixels from tile to tile: the samples of a tile's apron are its own as well.
pub(super) fn pitch(stage: &Stage) -> u32 {
    TILE as u32 - 2 * line_apron(stage).unsigned_abs()
}

/// Pixels around a tile that its lines depend on; 0 without lines.
pub(super) fn line_apron(stage: &Stage) -> i32 {
    match stage.edges {
        Some(_) => EdgeStyle::half_width(stage.size[1], stage.samples).ceil() as i32,
        None => 0,
    }
}
