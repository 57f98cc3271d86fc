//! Small triangles cell by cell, large ones block by block.

use super::assembly::{Facet, TriangleAssembly};
use super::blocks::by_blocks;
use super::mask::PixelMask;
use super::raster::{Visit, shade_direct};
use super::samples::SamplePattern;
use super::window::Window;

/// A triangle whose part in the tile has at most this many rows or columns is visited cell by cell; in
/// a larger one the range of cells is computed for each row.
const DIRECT: i32 = 12;

/// Calls `visit` for every vector of samples of which a facet covers any, if one of its pixels is needed.
#[inline(always)]
pub(super) fn rasterise_block<const G: usize>(
    assembly: &TriangleAssembly,
    facet: &Facet,
    (window, needed): (&Window, &PixelMask),
    pattern: &SamplePattern<G>,
    visit: impl Visit,
) {
    let corners = assembly.corners(&facet.corners);
    let pixels = facet.pixels();
    let area = Window {
        x: [pixels.x[0].max(window.x[0]), pixels.x[1].min(window.x[1])],
        y: [pixels.y[0].max(window.y[0]), pixels.y[1].min(window.y[1])],
    };
    if area.x[0] > area.x[1] || area.y[0] > area.y[1] {
        return;
    }
    let small = area.x[1] - area.x[0] < DIRECT && area.y[1] - area.y[0] < DIRECT;
    if small && facet.is_short() {
        shade_direct(corners, window, &area, pattern, visit);
    } else {
        by_blocks(corners, (window, needed), &area, pattern, visit);
    }
}
