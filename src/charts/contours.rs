//! Contour lines on a grid, and the map of an objective of two variables with the path of a search.

use crate::plot::chart::{Axis, Chart, Panel, PlotSeries, PointWord, SeriesStyle};

/// Values on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueGrid {
    /// Ascending places along both variables.
    pub places: [Vec<f64>; 2],
    /// `values[i][j]` at `places[0][i]`, `places[1][j]`; not finite where the objective has no value.
    pub values: Vec<Vec<f64>>,
}

/// Maximum number of contour lines. The levels form a geometric sequence.
const LEVELS: usize = 13;

/// Values nearer to the least than this share of the span are one level.
const LOWEST: f64 = 1e-4;

/// Minimum distance of a number from the border, from the path of the search and from other numbers, as a fraction of
/// the area's sides; a line without such a place has no number.
const ROOM: f64 = 0.035;

/// Ratio of a number's width to its height.
const WIDE: f64 = 2.5;

/// The map of an objective: contours, and the points of a search.
pub fn search_map(title: &str, axes: [Axis; 2], grid: &ValueGrid, path: &[[f64; 2]]) -> Chart {
    let levels = grid.levels();
    let mut panel = Panel::default();
    for level in &levels {
        let lines = grid.contour(*level);
        let taken: Vec<[f64; 2]> = panel.words.iter().map(|word| word.at).collect();
        let place = grid.free_place(lines.iter().flatten(), path, &taken);
        panel.words.extend(place.map(|at| PointWord {
            at,
            text: format!("{level:.1e}"),
        }));
        panel
            .cloud
            .extend(lines.into_iter().map(|ends| ends.to_vec()));
    }
    let [x, y] = axes;
    (panel.x, panel.y) = (x, y);
    (panel.x.tight, panel.y.tight) = (true, true);
    panel.series.push(PlotSeries {
        name: "points of the search".to_owned(),
        points: path.iter().copied().map(Some).collect(),
        style: SeriesStyle::Dots,
        ..PlotSeries::default()
    });
    panel.marks.extend(path.last());
    Chart {
        title: title.to_owned(),
        description: format!(
            "{} contours and {} points of a search",
            levels.len(),
            path.len()
        ),
        panels: vec![panel],
        ..Chart::default()
    }
}

impl ValueGrid {
    /// Levels that are close together near the least value, where a search ends.
    fn levels(&self) -> Vec<f64> {
        let finite = self.values.iter().flatten().filter(|v| v.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(*v), h.max(*v))
        });
        if high <= low {
            return Vec::new();
        }
        let share = |k: usize| libm::pow(LOWEST, 1.0 - (k + 1) as f64 / (LEVELS + 1) as f64);
        (0..LEVELS).map(|k| low + (high - low) * share(k)).collect()
    }

    /// The point among `points` with the most free space for a number.
    fn free_place<'p>(
        &self,
        points: impl Iterator<Item = &'p [f64; 2]>,
        path: &[[f64; 2]],
        taken: &[[f64; 2]],
    ) -> Option<[f64; 2]> {
        let share = |point: &[f64; 2]| {
            [0, 1].map(|axis| {
                let places = &self.places[axis];
                let (first, last) = (places[0], places[places.len() - 1]);
                (point[axis] - first) / (last - first)
            })
        };
        let path: Vec<[f64; 2]> = path.iter().map(share).collect();
        let taken: Vec<[f64; 2]> = taken.iter().map(share).collect();
        let room = |point: &[f64; 2]| {
            let at = share(point);
            let border = [at[0] / WIDE, (1.0 - at[0]) / WIDE, at[1], 1.0 - at[1]];
            let ways = path.windows(2).map(|ends| way_off(at, [ends[0], ends[1]]));
            let numbers = taken.iter().map(|other| way_off(at, [*other, *other]));
            let all = border.into_iter().chain(ways).chain(numbers);
            all.fold(f64::INFINITY, f64::min)
        };
        let rooms = points.map(|point| (room(point), *point));
        let best = rooms.max_by(|a, b| a.0.total_cmp(&b.0));
        best.filter(|(room, _)| *room > ROOM).map(|(_, at)| at)
    }

    /// Pieces of the line at which the value is `level`: a straight one through every triangle of the grid that it crosses.
    pub fn contour(&self, level: f64) -> Vec<[[f64; 2]; 2]> {
        let [xs, ys] = &self.places;
        let corner = |i: usize, j: usize| ([xs[i], ys[j]], self.values[i][j] - level);
        let mut pieces = Vec::new();
        for i in 1..xs.len() {
            for j in 1..ys.len() {
                let [a, b, c, d] = [
                    corner(i - 1, j - 1),
                    corner(i, j - 1),
                    corner(i, j),
                    corner(i - 1, j),
                ];
                pieces.extend(crossing_piece([a, b, c]));
                pieces.extend(crossing_piece([a, c, d]));
            }
        }
        pieces
    }
}

/// Distance of a point from a line segment.
fn way_off(at: [f64; 2], [from, to]: [[f64; 2]; 2]) -> f64 {
    let [at, from, to] = [at, from, to].map(|p| [p[0] / WIDE, p[1]]);
    let (along, there) = (
        [to[0] - from[0], to[1] - from[1]],
        [at[0] - from[0], at[1] - from[1]],
    );
    let length = along[0] * along[0] + along[1] * along[1];
    let share = match length > 0.0 {
        true => ((there[0] * along[0] + there[1] * along[1]) / length).clamp(0.0, 1.0),
        false => 0.0,
    };
    libm::hypot(there[0] - share * along[0], there[1] - share * along[1])
}

/// The piece of a triangle on which a linear function vanishes.
fn crossing_piece(corners: [([f64; 2], f64); 3]) -> Option<[[f64; 2]; 2]> {
    if corners.iter().any(|(_, v)| !v.is_finite()) {
        return None;
    }
    let mut ends = (0..3).filter_map(|k| {
        let ((a, u), (b, v)) = (corners[k], corners[(k + 1) % 3]);
        let share = u / (u - v);
        ((u < 0.0) != (v < 0.0)).then(|| [0, 1].map(|i| a[i] + share * (b[i] - a[i])))
    });
    Some([ends.next()?, ends.next()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contours_of_a_bowl_are_circles() {
        let places: Vec<f64> = (0..=40).map(|k| -2.0 + 0.1 * f64::from(k)).collect();
        let row = |x: &f64| places.iter().map(|y| x * x + y * y).collect();
        let mut grid = ValueGrid {
            values: places.iter().map(row).collect(),
            places: [places.clone(), places.clone()],
        };
        let circle = grid.contour(1.0);
        assert!(circle.len() > 50);
        let length: f64 = circle
            .iter()
            .map(|[a, b]| libm::hypot(a[0] - b[0], a[1] - b[1]))
            .sum();
        assert!((length - std::f64::consts::TAU).abs() < 0.01, "{length}");
        let off = circle
            .iter()
            .flatten()
            .map(|p| (libm::hypot(p[0], p[1]) - 1.0).abs());
        assert!(off.fold(0.0, f64::max) < 3e-3);
        let levels = grid.levels();
        assert!(levels.len() == LEVELS && levels.is_sorted() && levels[0] < 0.01);
        // Numbers keep away from the path of the search, from the border and from each other.
        let axes = [Axis::default(), Axis::default()];
        let way = [[-1.9, -1.9], [0.0, 0.0]];
        let map = search_map("bowl", axes, &grid, &way);
        let words = &map.panels[0].words;
        assert!(words.len() > 5, "{}", words.len());
        for (k, word) in words.iter().enumerate() {
            let at = word.at.map(|v| 0.25 * v + 0.5);
            assert!(at.iter().all(|v| *v > ROOM && *v < 1.0 - ROOM));
            assert!(way_off(at, way.map(|p| p.map(|v| 0.25 * v + 0.5))) > ROOM);
            for other in &words[..k] {
                let other = other.at.map(|v| 0.25 * v + 0.5);
                assert!(way_off(at, [other, other]) > ROOM);
            }
        }
        // Where there is no value there is no line.
        grid.values[20][30] = f64::INFINITY;
        assert!(grid.contour(1.0).len() < circle.len());
    }
}
