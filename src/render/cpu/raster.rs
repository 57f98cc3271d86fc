//! Which samples of a tile a triangle covers, and how deep: integer edge functions with the top-left rule.
//!
//! A sample on an edge that two triangles share belongs to exactly one of them. Holds no colours.

use super::lens::Vertex;
use super::samples::{Pattern, SUBPIXEL_BITS, SUBPIXELS};

/// Triangles whose box is smaller than this many screen units are drawn with 32-bit edge functions:
/// products of two such lengths, doubled, stay below 2^31.
const SMALL: i32 = 1 << 14;

/// Pixels of the picture, first included, last included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) x: [i32; 2],
    pub(super) y: [i32; 2],
}

/// An integer wide enough for the edge functions of a triangle.
trait Edge: Copy + std::ops::Add<Output = Self> + std::ops::BitOr<Output = Self> {
    fn of(value: i64) -> Self;
    /// All ones for a negative number, else zero.
    fn sign(self) -> i32;
}

impl Edge for i32 {
    #[inline(always)]
    fn of(value: i64) -> Self {
        value as i32
    }
    #[inline(always)]
    fn sign(self) -> i32 {
        self >> 31
    }
}

impl Edge for i64 {
    #[inline(always)]
    fn of(value: i64) -> Self {
        value
    }
    #[inline(always)]
    fn sign(self) -> i32 {
        (self >> 63) as i32
    }
}

/// Calls `visit` for the pixels of `window` that the triangle may cover, with a mask a sample (all ones
/// where covered) and the depth of each sample. The corners are counter-clockwise on the screen.
#[inline(always)]
pub(super) fn rasterise<const S: usize>(
    corners: [Vertex; 3],
    window: Window,
    pattern: &Pattern<S>,
    visit: impl FnMut(i32, i32, &[i32; S], &[f32; S]),
) {
    let [a, b, c] = corners;
    let [left, right] = [a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)];
    let [top, bottom] = [a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)];
    let first = |low: i32| (low - pattern.greatest + SUBPIXELS - 1) >> SUBPIXEL_BITS;
    let last = |high: i32| (high - pattern.least) >> SUBPIXEL_BITS;
    let window = Window {
        x: [first(left).max(window.x[0]), last(right).min(window.x[1])],
        y: [first(top).max(window.y[0]), last(bottom).min(window.y[1])],
    };
    if window.x[0] > window.x[1] || window.y[0] > window.y[1] {
        return;
    }
    if right - left < SMALL && bottom - top < SMALL {
        scan::<i32, S>(corners, window, pattern, visit);
    } else {
        scan::<i64, S>(corners, window, pattern, visit);
    }
}

/// One edge: its value grows by `x` a screen unit to the right and by `y` a unit down.
#[derive(Clone, Copy)]
struct Side {
    x: i64,
    y: i64,
    /// At the window's first pixel corner, less one where points on the edge do not belong.
    start: i64,
}

impl Side {
    #[inline(always)]
    fn new(from: Vertex, to: Vertex, origin: [i32; 2]) -> Self {
        let x = i64::from(to.y - from.y);
        let y = i64::from(from.x - to.x);
        let belongs = x > 0 || (x == 0 && y > 0);
        let start = x * i64::from(origin[0] - from.x) + y * i64::from(origin[1] - from.y);
        Self {
            x,
            y,
            start: start - i64::from(!belongs),
        }
    }
}

#[inline(always)]
fn scan<E: Edge, const S: usize>(
    [a, b, c]: [Vertex; 3],
    window: Window,
    pattern: &Pattern<S>,
    mut visit: impl FnMut(i32, i32, &[i32; S], &[f32; S]),
) {
    let origin = [window.x[0] * SUBPIXELS, window.y[0] * SUBPIXELS];
    let sides = [
        Side::new(a, b, origin),
        Side::new(b, c, origin),
        Side::new(c, a, origin),
    ];
    // The depth over the screen is a plane: weights of b and c are the edges opposite to them.
    let area = sides[0].x * i64::from(c.x - a.x) + sides[0].y * i64::from(c.y - a.y);
    let inverse = 1.0 / area as f32;
    let (to_b, to_c) = ((b.depth - a.depth) * inverse, (c.depth - a.depth) * inverse);
    let slope_x = to_b * sides[2].x as f32 + to_c * sides[0].x as f32;
    let slope_y = to_b * sides[2].y as f32 + to_c * sides[0].y as f32;
    let depth_at =
        |x: i32, y: i32| a.depth + slope_x * (x - a.x) as f32 + slope_y * (y - a.y) as f32;
    let offsets: [[E; S]; 3] = sides.map(|side| {
        std::array::from_fn(|s| {
            E::of(side.x * i64::from(pattern.x[s]) + side.y * i64::from(pattern.y[s]))
        })
    });
    let depth_offsets: [f32; S] =
        std::array::from_fn(|s| slope_x * pattern.x[s] as f32 + slope_y * pattern.y[s] as f32);
    let step_x: [E; 3] = sides.map(|side| E::of(side.x << SUBPIXEL_BITS));
    let step_y: [E; 3] = sides.map(|side| E::of(side.y << SUBPIXEL_BITS));
    let mut row: [E; 3] = sides.map(|side| E::of(side.start));
    for y in window.y[0]..=window.y[1] {
        let mut at = row;
        for x in window.x[0]..=window.x[1] {
            let depth = depth_at(x << SUBPIXEL_BITS, y << SUBPIXEL_BITS);
            let mut covered = [0i32; S];
            let mut depths = [0f32; S];
            for s in 0..S {
                let outside =
                    (at[0] + offsets[0][s]) | (at[1] + offsets[1][s]) | (at[2] + offsets[2][s]);
                covered[s] = !outside.sign();
                depths[s] = depth + depth_offsets[s];
            }
            visit(x, y, &covered, &depths);
            for k in 0..3 {
                at[k] = at[k] + step_x[k];
            }
        }
        for k in 0..3 {
            row[k] = row[k] + step_y[k];
        }
    }
}
