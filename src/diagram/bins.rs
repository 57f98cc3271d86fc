//! Spatial index of a sheet: lines and boxes filed by the squares that they cross, so that queries for what is near
//! stay cheap however much is drawn.

use super::plane::DrawnSpot;
use crate::math::segment_distance;
use crate::plot::primitive::Rect;
use std::collections::HashMap;

/// Edge of a square in units of the drawing: about a letter.
const SIDE: f64 = 12.0;

/// Squares on either side of the first one beyond which all are one: sheets are far smaller.
const MOST: f64 = 2000.0;

/// Lines and boxes, each in the order in which they came.
#[derive(Default)]
pub struct SpatialBins {
    side: f64,
    lines: Vec<[DrawnSpot; 2]>,
    boxes: Vec<Rect>,
    filed: HashMap<[i32; 2], Filed>,
}

/// What reaches into a square.
#[derive(Default)]
struct Filed {
    lines: Vec<u32>,
    boxes: Vec<u32>,
}

impl SpatialBins {
    /// For a drawing whose lengths are multiples of `unit`.
    pub fn new(unit: f64) -> Self {
        Self {
            side: SIDE * unit,
            ..Self::default()
        }
    }

    /// Adds a line.
    pub fn push_line(&mut self, ends: [DrawnSpot; 2]) {
        let index = self.lines.len() as u32;
        self.lines.push(ends);
        for square in self.along(ends) {
            self.filed.entry(square).or_default().lines.push(index);
        }
    }

    /// Adds a box.
    pub fn push_box(&mut self, bounds: Rect) {
        let index = self.boxes.len() as u32;
        self.boxes.push(bounds);
        for square in self.squares(&bounds) {
            self.filed.entry(square).or_default().boxes.push(index);
        }
    }

    /// Lines that may reach into a box, each once, in their order.
    pub fn lines_in(&self, bounds: &Rect) -> impl Iterator<Item = [DrawnSpot; 2]> {
        self.lines_of(self.squares(bounds))
    }

    /// Lines that may meet a line, each once, in their order.
    pub fn lines_across(&self, ends: [DrawnSpot; 2]) -> impl Iterator<Item = [DrawnSpot; 2]> {
        self.lines_of(self.along(ends).into_iter())
    }

    fn lines_of(
        &self,
        squares: impl Iterator<Item = [i32; 2]>,
    ) -> impl Iterator<Item = [DrawnSpot; 2]> {
        let filed = squares.filter_map(|square| self.filed.get(&square));
        let mut found: Vec<u32> = filed.flat_map(|f| f.lines.iter().copied()).collect();
        found.sort_unstable();
        found.dedup();
        found.into_iter().map(|k| self.lines[k as usize])
    }

    /// Whether a line is nearer to a point than this.
    pub fn is_line_within(&self, at: DrawnSpot, within: f64) -> bool {
        let around = box_around(at, within);
        self.squares(&around).any(|square| {
            let filed = self.filed.get(&square);
            let mut lines = filed.into_iter().flat_map(|f| &f.lines);
            lines.any(|k| segment_distance(at, self.lines[*k as usize]) < within)
        })
    }

    /// Whether a box that reaches into these bounds is such.
    pub fn any_box(&self, bounds: &Rect, is_such: impl Fn(&Rect) -> bool) -> bool {
        self.squares(bounds).any(|square| {
            let filed = self.filed.get(&square);
            let mut boxes = filed.into_iter().flat_map(|f| &f.boxes);
            boxes.any(|k| is_such(&self.boxes[*k as usize]))
        })
    }

    /// Distance of a point from the nearest line or box, at most `most`. The search stops once `enough` accepts the
    /// distance found so far, and returns that.
    pub fn room(&self, at: DrawnSpot, most: f64, enough: impl Fn(f64) -> bool) -> f64 {
        let own = self.square(at);
        let mut room = most;
        let rings = (most / self.side).ceil() as i32 + 1;
        for ring in 0..=rings {
            // The squares of a ring are at least as far away as the number of whole squares between.
            if f64::from(ring - 1) * self.side >= room || enough(room) {
                break;
            }
            for square in ring_around(own, ring) {
                let Some(filed) = self.filed.get(&square) else {
                    continue;
                };
                for k in &filed.lines {
                    room = room.min(segment_distance(at, self.lines[*k as usize]));
                }
                for k in &filed.boxes {
                    room = room.min(from_box(at, &self.boxes[*k as usize]));
                }
            }
        }
        room
    }

    fn cell(&self, v: f64) -> i32 {
        (v / self.side).floor().clamp(-MOST, MOST) as i32
    }

    fn square(&self, [x, y]: DrawnSpot) -> [i32; 2] {
        [self.cell(x), self.cell(y)]
    }

    /// The squares of a box.
    fn squares(&self, bounds: &Rect) -> impl Iterator<Item = [i32; 2]> + use<> {
        let [left, top] = self.square([bounds.left, bounds.top]);
        let [right, bottom] = self.square([bounds.right, bounds.bottom]);
        (left..=right).flat_map(move |x| (top..=bottom).map(move |y| [x, y]))
    }

    /// The squares that a line crosses, and some beside it.
    fn along(&self, [a, b]: [DrawnSpot; 2]) -> Vec<[i32; 2]> {
        let [from, to] = if a[0] <= b[0] { [a, b] } else { [b, a] };
        let (first, last) = (self.cell(from[0]), self.cell(to[0]));
        let slope = (to[1] - from[1]) / (to[0] - from[0]);
        let height = |column: i32, or: DrawnSpot| {
            let x = f64::from(column) * self.side;
            let y = from[1] + (x - from[0]) * slope;
            // A line without width, or beyond all squares.
            if y.is_finite() { y } else { or[1] }
        };
        let mut squares = Vec::new();
        for column in first..=last {
            let enters = if column == first {
                from[1]
            } else {
                height(column, from)
            };
            let leaves = if column == last {
                to[1]
            } else {
                height(column + 1, to)
            };
            // Rounding of the heights is far less than a thousandth of a square.
            let slack = 1e-3 * self.side;
            let low = self.cell(enters.min(leaves) - slack);
            let high = self.cell(enters.max(leaves) + slack);
            squares.extend((low..=high).map(|row| [column, row]));
        }
        squares
    }
}

fn box_around([x, y]: DrawnSpot, reach: f64) -> Rect {
    Rect {
        left: x - reach,
        right: x + reach,
        top: y - reach,
        bottom: y + reach,
    }
}

fn from_box(at: DrawnSpot, b: &Rect) -> f64 {
    let beyond = |low: f64, v: f64, high: f64| (low - v).max(v - high).max(0.0);
    let [x, y] = [
        beyond(b.left, at[0], b.right),
        beyond(b.top, at[1], b.bottom),
    ];
    libm::hypot(x, y)
}

/// The squares this many steps away.
fn ring_around([x, y]: [i32; 2], ring: i32) -> impl Iterator<Item = [i32; 2]> {
    (-ring..=ring).flat_map(move |i| {
        let step = if i.abs() == ring { 1 } else { 2 * ring };
        let rows = (-ring..=ring).step_by(step.max(1) as usize);
        rows.map(move |j| [x + i, y + j])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against all lines and boxes one by one.
    #[test]
    fn what_is_near_is_found() {
        let mut state = 7u32;
        let mut draw = |wide: f64| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1u32 << 24) * wide
        };
        let mut bins = SpatialBins::new(1.0);
        for k in 0..300 {
            let from = [draw(900.0), draw(600.0)];
            let long = if k % 9 == 0 { 700.0 } else { 40.0 };
            let to = match k % 5 {
                0 => [from[0], from[1] + draw(long)],
                1 => [from[0] + draw(long), from[1]],
                _ => [from[0] + draw(long) - 0.5 * long, from[1] + draw(long)],
            };
            bins.push_line([from, to]);
            let corner = [draw(900.0), draw(600.0)];
            bins.push_box(Rect {
                left: corner[0],
                right: corner[0] + draw(30.0),
                top: corner[1],
                bottom: corner[1] + draw(90.0),
            });
        }
        bins.push_line([[f64::NAN, 1.0], [f64::INFINITY, 2.0]]);
        bins.lines.pop();
        bins.filed
            .values_mut()
            .for_each(|f| f.lines.retain(|k| *k < 300));
        for _ in 0..500 {
            let at = [draw(1000.0) - 50.0, draw(700.0) - 50.0];
            let lines = bins.lines.iter().map(|line| segment_distance(at, *line));
            let nearest = lines.clone().fold(f64::INFINITY, f64::min);
            let boxes = bins.boxes.iter().map(|b| from_box(at, b));
            let room = boxes.fold(nearest, f64::min).min(50.0);
            assert_eq!(bins.room(at, 50.0, |_| false), room);
            for within in [1.0, 8.0, 33.0] {
                assert_eq!(bins.is_line_within(at, within), nearest < within);
                let near = box_around(at, within);
                let found: Vec<_> = bins.lines_in(&near).collect();
                let missed = bins
                    .lines
                    .iter()
                    .filter(|l| segment_distance(at, **l) < within);
                assert!(missed.into_iter().all(|l| found.contains(l)));
            }
        }
    }
}
