//! The shares of the pixels that a shape covers.
//!
//! A line covers a pixel by its distance from the pixel's centre, as if the pixel were a square that faces the line: exact along
//! the axes, and nearly so across them. A polygon covers it by the area inside.

use super::primitive::Rect;
use ab_glyph_rasterizer::{Point, Rasterizer, point};

/// Half the side of a pixel.
const HALF: f64 = 0.5;

/// Shares from 0 to 1 for the pixels of a part of a picture, row by row.
pub(super) struct Coverage {
    corner: [usize; 2],
    size: [usize; 2],
    shares: Vec<f64>,
}

impl Coverage {
    /// Nothing, in the pixels of a picture of this size that `bounds` touches.
    fn none(bounds: &Rect, [width, height]: [u32; 2]) -> Self {
        let within = |value: f64, side: u32| value.clamp(0.0, f64::from(side)) as usize;
        let corner = [
            within(bounds.left.floor(), width),
            within(bounds.top.floor(), height),
        ];
        let end = [
            within(bounds.right.ceil(), width),
            within(bounds.bottom.ceil(), height),
        ];
        let size = [0, 1].map(|k| end[k].saturating_sub(corner[k]));
        Self {
            corner,
            size,
            shares: vec![0.0; size[0] * size[1]],
        }
    }

    /// Of a rectangle.
    pub(super) fn of_rect(rect: &Rect, picture: [u32; 2]) -> Self {
        let mut all = Self::none(rect, picture);
        let shared = |from: f64, to: f64, pixel: f64| {
            ((pixel + 1.0).min(to) - pixel.max(from)).clamp(0.0, 1.0)
        };
        all.raise(|[x, y]| {
            shared(rect.left, rect.right, x - HALF) * shared(rect.top, rect.bottom, y - HALF)
        });
        all
    }

    /// Of a disc.
    pub(super) fn of_disc(centre: [f64; 2], radius: f64, picture: [u32; 2]) -> Self {
        let mut all = Self::none(&around(&[centre], radius + HALF), picture);
        all.raise(|[x, y]| shared_width(length([x - centre[0], y - centre[1]]), radius));
        all
    }

    /// Of a polygon whose edges do not cross each other. What they go round twice counts once, but for the pixels on the edges.
    pub(super) fn of_polygon(corners: &[[f64; 2]], picture: [u32; 2]) -> Self {
        let mut all = Self::none(&around(corners, 0.0), picture);
        let [width, height] = all.size;
        let mut raster = Rasterizer::new(width, height);
        let local = |p: [f64; 2]| [0, 1].map(|k| p[k] - all.corner[k] as f64);
        let next = corners.iter().cycle().skip(1);
        for (from, to) in corners.iter().zip(next) {
            draw_within(local(*from), local(*to), all.size, &mut raster);
        }
        raster.for_each_pixel(|k, share| all.shares[k] = f64::from(share).min(1.0));
        all
    }

    /// Of a line with round corners. Its ends are cut across or round.
    pub(super) fn of_line(
        points: &[[f64; 2]],
        width: f64,
        is_cut: bool,
        picture: [u32; 2],
    ) -> Self {
        let half = HALF * width;
        let mut all = Self::none(&around(points, half + HALF), picture);
        if let [only] = points {
            all.add_segment([*only, *only], half, [false; 2]);
        }
        let last = points.len().saturating_sub(2);
        for (k, ends) in points.windows(2).enumerate() {
            all.add_segment(
                [ends[0], ends[1]],
                half,
                [is_cut && k == 0, is_cut && k == last],
            );
        }
        all
    }

    /// Adds a piece of a line. Cut ends stop at the end; others are round.
    fn add_segment(&mut self, [from, to]: [[f64; 2]; 2], half: f64, is_cut: [bool; 2]) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let whole = length([dx, dy]);
        let [ux, uy] = if whole > 0.0 {
            [dx / whole, dy / whole]
        } else {
            [1.0, 0.0]
        };
        let reach = half + HALF;
        let share = |[x, y]: [f64; 2]| {
            let (rx, ry) = (x - from[0], y - from[1]);
            let (along, across) = (rx * ux + ry * uy, rx * uy - ry * ux);
            let (mut beyond, mut kept) = (0.0_f64, 1.0_f64);
            for (rest, is_cut) in [along, whole - along].into_iter().zip(is_cut) {
                if is_cut {
                    kept *= (rest + HALF).clamp(0.0, 1.0);
                } else {
                    beyond = beyond.max(-rest);
                }
            }
            kept * shared_width(length([across, beyond]), half)
        };
        let [top, bottom] = [from[1].min(to[1]) - reach, from[1].max(to[1]) + reach];
        for row in self.places(1, top, bottom) {
            // The part of the piece that is near enough to this row.
            let centre = (self.corner[1] + row) as f64 + HALF;
            let at = |y: f64| {
                if dy == 0.0 {
                    None
                } else {
                    Some(((y - from[1]) / dy).clamp(0.0, 1.0))
                }
            };
            let [a, b] = [
                at(centre - reach).unwrap_or(0.0),
                at(centre + reach).unwrap_or(1.0),
            ]
            .map(|part| from[0] + part * dx);
            for column in self.places(0, a.min(b) - reach, a.max(b) + reach) {
                let place = [(self.corner[0] + column) as f64 + HALF, centre];
                let share_so_far = &mut self.shares[row * self.size[0] + column];
                *share_so_far = share_so_far.max(share(place));
            }
        }
    }

    /// The columns (0) or rows (1) that an interval of the picture touches.
    fn places(&self, axis: usize, from: f64, to: f64) -> std::ops::Range<usize> {
        let within =
            |v: f64| (v - self.corner[axis] as f64).clamp(0.0, self.size[axis] as f64) as usize;
        within(from.floor())..within(to.ceil())
    }

    /// Raises every share to the one that `share` gives for the centre of the pixel.
    fn raise(&mut self, share: impl Fn([f64; 2]) -> f64) {
        for (k, own) in self.shares.iter_mut().enumerate() {
            let place = [k % self.size[0], k / self.size[0]];
            *own = own.max(share(
                [0, 1].map(|i| (self.corner[i] + place[i]) as f64 + HALF),
            ));
        }
    }

    /// The pixels that are covered at all, each with its share.
    pub(super) fn pixels(&self) -> impl Iterator<Item = ([u32; 2], f64)> {
        let place = |k: usize| {
            [
                k % self.size[0] + self.corner[0],
                k / self.size[0] + self.corner[1],
            ]
        };
        let covered = self
            .shares
            .iter()
            .enumerate()
            .filter(|(_, share)| **share > 0.0);
        covered.map(move |(k, share)| (place(k).map(|v| v as u32), *share))
    }
}

/// The part of a pixel that is covered by a strip whose middle passes at a distance and that reaches `half` to both sides.
fn shared_width(distance: f64, half: f64) -> f64 {
    ((distance + HALF).min(half) - (distance - HALF).max(-half)).clamp(0.0, 1.0)
}

fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

/// The bounds of points, wider by a margin on all sides.
fn around(points: &[[f64; 2]], margin: f64) -> Rect {
    let least = |k: usize| points.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min) - margin;
    let most = |k: usize| {
        points
            .iter()
            .map(|p| p[k])
            .fold(f64::NEG_INFINITY, f64::max)
            + margin
    };
    Rect {
        left: least(0),
        top: least(1),
        right: most(0),
        bottom: most(1),
    }
}

/// Draws an edge of a polygon: what passes the picture on a side runs along that side, since pixels count the edges to their left.
fn draw_within(from: [f64; 2], to: [f64; 2], size: [usize; 2], raster: &mut Rasterizer) {
    let sides = size.map(|side| side as f64);
    let mut cuts = [0.0, 1.0, 0.0, 0.0, 1.0, 1.0];
    for (k, cut) in cuts[2..].iter_mut().enumerate() {
        let (axis, side) = (k % 2, if k < 2 { 0.0 } else { sides[k % 2] });
        let part = (side - from[axis]) / (to[axis] - from[axis]);
        *cut = if part.is_finite() {
            part.clamp(0.0, 1.0)
        } else {
            0.0
        };
    }
    cuts.sort_by(f64::total_cmp);
    let at = |part: f64| -> Point {
        let [x, y] = [0, 1].map(|k| (from[k] + part * (to[k] - from[k])).clamp(0.0, sides[k]));
        point(x as f32, y as f32)
    };
    for ends in cuts.windows(2) {
        raster.draw_line(at(ends[0]), at(ends[1]));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    const PICTURE: [u32; 2] = [40, 30];

    fn sum(coverage: &Coverage) -> f64 {
        coverage.pixels().map(|(_, share)| share).sum()
    }

    #[test]
    fn areas_of_shapes_are_those_of_geometry() {
        let square = [[3.25, 2.5], [12.75, 2.5], [12.75, 8.0], [3.25, 8.0]];
        let triangle = [[2.0, 2.0], [30.0, 11.0], [7.5, 25.0]];
        let rect = Rect {
            left: 3.25,
            top: 2.5,
            right: 12.75,
            bottom: 8.0,
        };
        let outside = [[-100.0, -7.0], [20.0, -7.0], [20.0, 500.0], [-100.0, 500.0]];
        let doubled: Vec<_> = square.iter().chain(&square).copied().collect();
        for (name, coverage, area, tolerance) in [
            ("rectangle", Coverage::of_rect(&rect, PICTURE), 52.25, 1e-9),
            (
                "square",
                Coverage::of_polygon(&square, PICTURE),
                52.25,
                1e-3,
            ),
            (
                "twice around",
                Coverage::of_polygon(&doubled, PICTURE),
                52.25,
                8.0,
            ),
            (
                "triangle",
                Coverage::of_polygon(&triangle, PICTURE),
                297.25,
                1e-2,
            ),
            (
                "cut on three sides",
                Coverage::of_polygon(&outside, PICTURE),
                600.0,
                1e-3,
            ),
            (
                "disc",
                Coverage::of_disc([20.0, 15.0], 7.0, PICTURE),
                153.94,
                1.0,
            ),
            (
                "point",
                Coverage::of_disc([20.5, 15.5], 0.2, PICTURE),
                0.4,
                1e-9,
            ),
        ] {
            assert!(
                (sum(&coverage) - area).abs() < tolerance,
                "{name}: {}",
                sum(&coverage)
            );
        }
    }

    #[test]
    fn lines_have_their_width_at_every_angle() {
        for turn in 0..24 {
            let (sin, cos) = crate::math::sin_cos(f64::from(turn) * 0.27);
            let ends = [
                [20.0 - 9.0 * cos, 15.0 - 9.0 * sin],
                [20.0 + 9.0 * cos, 15.0 + 9.0 * sin],
            ];
            for width in [0.5, 1.0, 1.7, 4.0] {
                let cut = sum(&Coverage::of_line(&ends, width, true, PICTURE));
                assert!(
                    (cut / (18.0 * width) - 1.0).abs() < 0.08,
                    "{turn} {width}: {cut}"
                );
                let round = sum(&Coverage::of_line(&ends, width, false, PICTURE));
                assert!(round > cut, "{turn} {width}");
            }
        }
    }

    #[test]
    fn dense_corners_do_not_thicken_a_line() {
        let sparse = [[4.0, 5.3], [36.0, 21.7]];
        let dense: Vec<_> = (0..=200)
            .map(|k| {
                [0, 1].map(|i| sparse[0][i] + (sparse[1][i] - sparse[0][i]) * f64::from(k) / 200.0)
            })
            .collect();
        let one = Coverage::of_line(&sparse, 2.0, false, PICTURE);
        let many = Coverage::of_line(&dense, 2.0, false, PICTURE);
        let pairs = one.shares.iter().zip(&many.shares);
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn nothing_is_drawn_of_what_is_no_place() {
        for far in [f64::NAN, f64::INFINITY, 1e300] {
            let points = [[far, 3.0], [far, far], [3.0, far]];
            for coverage in [
                Coverage::of_line(&points[..1], 2.0, true, PICTURE),
                Coverage::of_disc(points[1], 2.0, PICTURE),
            ] {
                assert_eq!(coverage.pixels().count(), 0, "{far}");
            }
            let _ = Coverage::of_line(&points, 2.0, false, PICTURE);
            let _ = Coverage::of_polygon(&points, PICTURE);
        }
    }
}
