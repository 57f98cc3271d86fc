//! Triangles over a grid of texels, one sample in the middle of each.

use crate::render::look::{larger_of, smaller_of};

/// Texels by which a triangle is enlarged, so that neighbours leave no gaps.
const GUARD: f32 = 1e-3;
/// Coordinates beyond this have too few digits left to be of use.
const FARTHEST: f32 = 1e6;
/// Twice the area below which a triangle is a line.
const LEAST_AREA: f32 = 1e-9;

/// The texels of one row that a triangle covers.
pub(super) struct TexelRun {
    /// Index of the first one in the grid, and how many.
    pub(super) first: usize,
    pub(super) count: usize,
    /// The third coordinate at the first, and its step.
    pub(super) start: f32,
    pub(super) step: f32,
}

/// Calls `visit` with the texels under a triangle, row by row. Corners are in texels, with a third coordinate that is
/// affine over the grid; `size` is its width and height.
#[inline(always)]
pub(super) fn scan_rows(
    [a, b, c]: [[f32; 3]; 3],
    [width, height]: [usize; 2],
    mut visit: impl FnMut(TexelRun),
) {
    let range = |k: usize| {
        let low = smaller_of(smaller_of(a[k], b[k]), c[k]);
        [low, larger_of(larger_of(a[k], b[k]), c[k])]
    };
    let [[left, right], [top, bottom]] = [range(0), range(1)];
    // Not a number fails the comparisons.
    if !(left > -FARTHEST && right < FARTHEST && top > -FARTHEST && bottom < FARTHEST) {
        return;
    }
    let (Some([y0, y1]), Some(_)) = (
        covered_centres(top, bottom, height),
        covered_centres(left, right, width),
    ) else {
        return;
    };
    let (p, q) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let area = p[0] * q[1] - q[0] * p[1];
    if area.abs() < LEAST_AREA {
        return;
    }
    let (rise, other) = (b[2] - a[2], c[2] - a[2]);
    let step = (rise * q[1] - other * p[1]) / area;
    let down = (other * p[0] - rise * q[0]) / area;
    let [low, high] = range(2);
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| {
        let slope = (to[0] - from[0]) / (to[1] - from[1]);
        (
            from,
            smaller_of(from[1], to[1]),
            larger_of(from[1], to[1]),
            slope,
        )
    });
    for row in y0..=y1 {
        let y = row as f32 + 0.5;
        let (mut first, mut last) = (right, left);
        for (from, upper, lower, slope) in &sides {
            // A horizontal side has no slope, and its ends are those of the other sides.
            if *upper <= y && y <= *lower && upper < lower {
                let x = from[0] + (y - from[1]) * slope;
                (first, last) = (smaller_of(first, x), larger_of(last, x));
            }
        }
        let Some([x0, x1]) = covered_centres(first - GUARD, last + GUARD, width) else {
            continue;
        };
        let at = a[2] + step * (x0 as f32 + 0.5 - a[0]) + down * (y - a[1]);
        visit(TexelRun {
            first: row * width + x0,
            count: x1 - x0 + 1,
            start: smaller_of(larger_of(at, low), high),
            step,
        });
    }
}

/// First and last of `count` cells whose middles lie within `low..=high`.
#[inline(always)]
fn covered_centres(low: f32, high: f32, count: usize) -> Option<[usize; 2]> {
    let (low, high) = (larger_of(low - 0.5, 0.0), high - 0.5);
    if high < low || high.is_nan() || low.is_nan() {
        return None;
    }
    let floor = low as i32;
    let first = (floor + i32::from((floor as f32) < low)) as usize;
    let last = (high as i32 as usize).min(count.wrapping_sub(1));
    (first <= last && last < count).then_some([first, last])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(size: [usize; 2], triangles: &[[[f32; 3]; 3]]) -> Vec<f32> {
        let mut texels = vec![0.0; size[0] * size[1]];
        for triangle in triangles {
            scan_rows(*triangle, size, |run| {
                for k in 0..run.count {
                    texels[run.first + k] = run.start + run.step * k as f32;
                }
            });
        }
        texels
    }

    /// Two triangles of a square leave nothing open, whatever the slope, and carry the plane through its corners.
    #[test]
    fn a_plane_is_itself_at_every_texel() {
        let plane = |x: f32, y: f32| 3.0 + 0.25 * x - 0.5 * y;
        let corner = |x: f32, y: f32| [x, y, plane(x, y)];
        let corners = [
            corner(-3.3, 1.2),
            corner(17.8, -2.0),
            corner(19.1, 22.0),
            corner(-1.0, 25.5),
        ];
        let [a, b, c, d] = corners;
        let size = [16, 16];
        let texels = grid(size, &[[a, b, c], [a, c, d]]);
        for (k, texel) in texels.iter().enumerate() {
            let (x, y) = ((k % 16) as f32 + 0.5, (k / 16) as f32 + 0.5);
            let inside = x > -3.3 && y > 1.3;
            if inside {
                assert!((texel - plane(x, y)).abs() < 1e-4, "{x} {y}: {texel}");
            }
        }
    }

    #[test]
    fn what_covers_no_middle_or_has_no_place_is_left_out() {
        let small = [[2.1, 2.1, 1.0], [2.4, 2.1, 1.0], [2.1, 2.4, 1.0]];
        let far = [[f32::NAN, 0.0, 1.0], [9.0, 0.0, 1.0], [0.0, 9.0, 1.0]];
        let beside = [[-9.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, 9.0, 1.0]];
        assert!(
            grid([8, 8], &[small, far, beside])
                .iter()
                .all(|t| *t == 0.0)
        );
    }
}
