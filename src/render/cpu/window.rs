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

impl Window {
    /// Its first pixel.
    #[inline(always)]
    pub(super) fn corner(&self) -> [i32; 2] {
        [self.x[0], self.y[0]]
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
