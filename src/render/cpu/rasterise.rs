//! Small triangles cell by cell, large ones block by block.

use super::blocks::by_blocks;
use super::lens::LensVertex;
use super::mask::PixelMask;
use super::raster::{Visit, shade_direct};
use super::samples::SamplePattern;
use super::window::Window;

/// A triangle whose part in the tile has at most this many rows or columns is visited cell by cell; in
/// a larger one the range of cells is computed for each row.
const DIRECT: i32 = 12;
/// Longest side in screen units of a triangle that is visited cell by cell: products of two such lengths,
/// doubled, stay below 2^31.
const DIRECT_REACH: i32 = 1 << 14;

/// Calls `visit` for every vector of samples of which the triangle covers any, if one of its pixels is needed. The corners
/// are counter-clockwise on the screen.
#[inline(always)]
pub(super) fn rasterise_block<const G: usize>(
    corners: [&LensVertex; 3],
    (window, needed): (&Window, &PixelMask),
    pattern: &SamplePattern<G>,
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
        shade_direct(corners, window, &area, pattern, visit);
    } else {
        by_blocks(corners, (window, needed), &area, pattern, visit);
    }
}
