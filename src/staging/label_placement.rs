//! Places labels on the screen, next to their anchors and clear of each other, once for a whole film.
//!
//! Every label has some tens of candidate positions around its anchor. Each label in turn takes the cheapest one, and
//! then all are revised in view of the others. This code is independent of mechanisms.

/// Smallest gap between two labels, relative to the height of the lower one.
const APART: f64 = 0.3;

/// Room that is kept free along the border of the picture, in pixels.
const BORDER: f64 = 3.0;

/// Gaps between an anchor and its label that are tried, in heights of the label.
const GAPS: [f64; 6] = [0.45, 0.8, 1.3, 2.0, 3.0, 4.5];

/// Directions that are tried.
const DIRECTIONS: usize = 16;

/// Number of revisions.
const ROUNDS: usize = 3;

/// Costs of a position, in order of weight: outside the picture or over another label, over a caption, nearer to
/// another label's anchor than to its own, over something drawn, away from the preferred position, far from its anchor.
const COLLIDES: f64 = 1000.0;
const MISLEADS: f64 = 120.0;
const COVERS: f64 = 12.0;
const STRAYS: f64 = 6.0;
const FAR: f64 = 3.0;

/// A label to be placed.
#[derive(Clone, Debug, PartialEq)]
pub struct Lettering {
    /// Its point on the screen in every frame that is looked at; `None` where it cannot be seen.
    pub anchors: Vec<Option<[f64; 2]>>,
    /// Width and height of the text in pixels.
    pub size: [f64; 2],
    /// The preferred position of its centre, relative to the anchor, in pixels.
    pub wish: [f64; 2],
}

/// Left, top, right and bottom.
pub type Rectangle = [f64; 4];

/// Areas that labels must avoid.
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    /// Width and height of the picture in pixels.
    pub size: [f64; 2],
    /// Captions.
    pub taken: Vec<Rectangle>,
    /// Points where something is drawn in some frame.
    pub drawn: Crowd,
}

/// Side of a cell of a crowd in pixels.
const CELL: f64 = 6.0;

/// The parts of a picture where something is drawn, as a summed-area table of cells (Crow, Computer Graphics 18, 1984).
#[derive(Clone, Debug, PartialEq)]
pub struct Crowd {
    cells: [usize; 2],
    /// Cells with something in them above and left of each corner, row by row.
    sums: Vec<u32>,
}

impl Crowd {
    /// The cells of a picture of `size` pixels in which a point lies.
    pub fn new(size: [f64; 2], points: impl Iterator<Item = [f64; 2]>) -> Self {
        let cells = size.map(|n| (n / CELL).ceil() as usize);
        let [columns, rows] = cells;
        let stride = columns + 1;
        let mut sums = vec![0; stride * (rows + 1)];
        for point in points {
            let [x, y] = point.map(|c| (c / CELL).floor());
            if x >= 0.0 && y >= 0.0 && x < columns as f64 && y < rows as f64 {
                sums[(y as usize + 1) * stride + x as usize + 1] = 1;
            }
        }
        for row in 1..=rows {
            for column in 1..=columns {
                let at = row * stride + column;
                // In this order no difference is negative.
                sums[at] = sums[at] + sums[at - 1] + sums[at - stride] - sums[at - stride - 1];
            }
        }
        Self { cells, sums }
    }

    /// Share of a rectangle's cells that have something in them.
    fn hidden_share(&self, [left, top, right, bottom]: &Rectangle) -> f64 {
        let cell = |at: f64, most: usize| ((at / CELL).max(0.0) as usize).min(most);
        let [columns, rows] = self.cells;
        let (x0, x1) = (cell(*left, columns), cell(right + CELL, columns));
        let (y0, y1) = (cell(*top, rows), cell(bottom + CELL, rows));
        let at = |x: usize, y: usize| self.sums[y * (columns + 1) + x];
        let count = at(x1, y1) + at(x0, y0) - at(x0, y1) - at(x1, y0);
        f64::from(count) / ((x1 - x0) * (y1 - y0)).max(1) as f64
    }
}

/// Offsets of the middles of the labels from their anchors in pixels.
pub fn place_labels(labels: &[Lettering], paper: &Paper) -> Vec<[f64; 2]> {
    let mut offsets: Vec<Option<[f64; 2]>> = vec![None; labels.len()];
    for _ in 0..ROUNDS {
        for index in 0..labels.len() {
            let costs = candidate_offsets(&labels[index]).into_iter().map(|offset| {
                let cost = offset_cost(labels, &offsets, index, offset, paper);
                (cost, offset)
            });
            // Of equally good ones the first, which is nearest to the preferred position.
            let best = costs.reduce(|best, other| if other.0 < best.0 { other } else { best });
            offsets[index] = best.map(|(_, offset)| offset);
        }
    }
    let wishes = labels.iter().map(|label| label.wish);
    let placed = offsets.into_iter().zip(wishes);
    placed
        .map(|(offset, wish)| offset.unwrap_or(wish))
        .collect()
}

fn candidate_offsets(label: &Lettering) -> Vec<[f64; 2]> {
    let [width, height] = label.size;
    let mut all = vec![label.wish];
    for gap in GAPS {
        for k in 0..DIRECTIONS {
            let turn = std::f64::consts::TAU * k as f64 / DIRECTIONS as f64;
            let (sin, cos) = crate::math::sin_cos(turn);
            all.push([
                cos * (gap * height + 0.5 * width),
                sin * (gap * height + 0.5 * height),
            ]);
        }
    }
    all
}

/// The cost of label `index` at an offset, averaged over the frames.
fn offset_cost(
    labels: &[Lettering],
    offsets: &[Option<[f64; 2]>],
    index: usize,
    offset: [f64; 2],
    paper: &Paper,
) -> f64 {
    let label = &labels[index];
    let height = label.size[1];
    let air = APART * height;
    let mut sum = 0.0;
    let mut frames = 0.0;
    for (frame, anchor) in label.anchors.iter().enumerate() {
        let Some(anchor) = anchor else { continue };
        frames += 1.0;
        let own = clamped_into(label_rectangle(*anchor, offset, label.size), paper.size);
        let middle = [0.5 * (own[0] + own[2]), 0.5 * (own[1] + own[3])];
        let away = gap_to(&own, *anchor);
        sum += FAR * away / height;
        sum += STRAYS
            * (point_distance(
                middle,
                [anchor[0] + label.wish[0], anchor[1] + label.wish[1]],
            ) / height)
                .min(4.0);
        let over_caption = paper
            .taken
            .iter()
            .filter(|t| are_overlapping(&own, t, air))
            .count();
        sum += COLLIDES * over_caption as f64;
        for (other, place) in labels.iter().zip(offsets) {
            if std::ptr::eq(other, label) {
                continue;
            }
            let Some(there) = other.anchors.get(frame).copied().flatten() else {
                continue;
            };
            if gap_to(&own, there) < 1.4 * away + 0.5 * height {
                // A label nearer to another anchor is as bad as an unreadable one.
                let is_nearer = gap_to(&own, there) <= away + 1.0;
                sum += if is_nearer { COLLIDES } else { MISLEADS };
            }
            let rectangle = place
                .map(|offset| clamped_into(label_rectangle(there, offset, other.size), paper.size));
            if rectangle.is_some_and(|other| are_overlapping(&own, &other, air)) {
                sum += COLLIDES;
            }
        }
        sum += COVERS * paper.drawn.hidden_share(&own);
    }
    sum / f64::max(frames, 1.0)
}

/// The rectangle of a label.
fn label_rectangle(anchor: [f64; 2], offset: [f64; 2], size: [f64; 2]) -> Rectangle {
    let [x, y] = [anchor[0] + offset[0], anchor[1] + offset[1]];
    let [w, h] = size.map(|s| 0.5 * s);
    [x - w, y - h, x + w, y + h]
}

/// The rectangle moved into the picture, as far as it fits.
pub fn clamped_into([left, top, right, bottom]: Rectangle, size: [f64; 2]) -> Rectangle {
    let shift = |low: f64, high: f64, limit: f64| {
        let inward = (limit - BORDER - high).min(0.0);
        inward + (BORDER - (low + inward)).max(0.0)
    };
    let [x, y] = [shift(left, right, size[0]), shift(top, bottom, size[1])];
    [left + x, top + y, right + x, bottom + y]
}

fn are_overlapping(a: &Rectangle, b: &Rectangle, air: f64) -> bool {
    a[0] < b[2] + air && b[0] < a[2] + air && a[1] < b[3] + air && b[1] < a[3] + air
}

/// Distance of a point from a rectangle; 0 inside.
fn gap_to(rectangle: &Rectangle, point: [f64; 2]) -> f64 {
    let off = [0, 1].map(|k| {
        (rectangle[k] - point[k])
            .max(point[k] - rectangle[k + 2])
            .max(0.0)
    });
    point_distance(off, [0.0; 2])
}

fn point_distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [a[0] - b[0], a[1] - b[1]];
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(at: [f64; 2], wish: [f64; 2]) -> Lettering {
        Lettering {
            anchors: vec![Some(at)],
            size: [14.0, 12.0],
            wish,
        }
    }

    fn paper() -> Paper {
        Paper {
            size: [640.0, 480.0],
            taken: vec![[0.0, 0.0, 300.0, 30.0]],
            drawn: Crowd::new([640.0, 480.0], std::iter::empty()),
        }
    }

    #[test]
    fn a_label_alone_stands_where_it_wishes() {
        let labels = [label([300.0, 200.0], [40.0, -9.0])];
        assert_eq!(place_labels(&labels, &paper()), [[40.0, -9.0]]);
    }

    #[test]
    fn a_crowd_keeps_apart_and_every_label_is_nearest_to_its_own_anchor() {
        let labels: Vec<Lettering> = (0..6)
            .map(|k| label([300.0 + 17.0 * f64::from(k), 40.0], [0.0, -10.0]))
            .collect();
        let offsets = place_labels(&labels, &paper());
        let boxes: Vec<Rectangle> = labels
            .iter()
            .zip(&offsets)
            .map(|(l, o)| {
                clamped_into(
                    label_rectangle(l.anchors[0].unwrap_or_default(), *o, l.size),
                    [640.0, 480.0],
                )
            })
            .collect();
        for (i, own) in boxes.iter().enumerate() {
            assert!(own[0] >= 0.0 && own[1] >= 0.0);
            for (j, other) in boxes.iter().enumerate().filter(|(j, _)| *j != i) {
                assert!(!are_overlapping(own, other, 0.0), "{i} {j}");
                let [mine, theirs] = [i, j].map(|k| labels[k].anchors[0].unwrap_or_default());
                assert!(gap_to(own, mine) < gap_to(own, theirs), "{i} {j}");
            }
        }
    }
}
