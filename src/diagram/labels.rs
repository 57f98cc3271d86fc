//! Label placement: as near to what they name as possible, clear of other labels and symbols, over few lines.

use super::ink::{Ink, WantedLabel};
use super::plane::{
    DrawnSpot, NO_LENGTH, spot_ahead, spot_difference, spot_length, unit_direction,
};
use crate::plot::layout::Ruler;
use crate::plot::primitive::{DrawnPrimitive, Rect, TextAnchor};
use crate::plot::theme::Dashes;

/// Directions that are tried, and distances in units of the drawing.
const DIRECTIONS: usize = 16;
const DISTANCES: [f64; 17] = [
    3.0, 8.0, 14.0, 21.0, 29.0, 38.0, 48.0, 60.0, 75.0, 92.0, 112.0, 135.0, 165.0, 200.0, 250.0,
    310.0, 400.0,
];

/// Beyond this distance a leader line connects a label with what it names.
const LEADER: f64 = 17.0;

/// Placement costs: per pixel of covered line, in pixels of distance, and for leaving the preferred direction.
const LINE_COST: f64 = 1.1;
const TURN_COST: f64 = 7.0;

/// Free pixels around a text.
const PAD: f64 = 2.5;

/// A label in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedLabel {
    /// Its text.
    pub text: String,
    /// The box that it takes.
    pub bounds: Rect,
}

/// Places all labels within `area` and draws them; those without room are the second list.
pub fn place_labels(ink: &mut Ink, area: Rect) -> (Vec<PlacedLabel>, Vec<String>) {
    let ruler = Ruler::default();
    let mut placed: Vec<PlacedLabel> = Vec::new();
    let mut left_out = Vec::new();
    for (text, middle, size, colour) in std::mem::take(&mut ink.letters) {
        let half = [0.5 * ruler.width(&text, size), 0.75 * size];
        let bounds = Rect {
            left: middle[0] - half[0],
            right: middle[0] + half[0],
            top: middle[1] - half[1],
            bottom: middle[1] + half[1],
        };
        let at = [middle[0], middle[1] + 0.5 * size];
        ink.text(at, &text, size, TextAnchor::Middle, colour);
        placed.push(PlacedLabel { text, bounds });
    }
    for label in std::mem::take(&mut ink.labels) {
        let size = box_size(&label, &ruler, ink.unit);
        match best_place(&label, size, ink, &area) {
            Some(bounds) => {
                draw_label(&label, bounds, ink);
                ink.bins.push_box(bounds);
                placed.push(PlacedLabel {
                    text: label.text,
                    bounds,
                });
            }
            None => left_out.push(label.text),
        }
    }
    (placed, left_out)
}

fn box_size(label: &WantedLabel, ruler: &Ruler, unit: f64) -> [f64; 2] {
    let (pad, wide) = (PAD * unit, ruler.width(&label.text, label.size));
    let high = 1.5 * label.size;
    match label.ringed {
        true => [wide.max(high) + 5.0 * pad; 2],
        false => [wide + 2.0 * pad, high + 1.4 * pad],
    }
}

/// The cheapest free place.
fn best_place(label: &WantedLabel, size: [f64; 2], ink: &Ink, area: &Rect) -> Option<Rect> {
    let wish = unit_direction(label.wish).unwrap_or([0.6, -0.8]);
    let mut best: Option<(f64, Rect)> = None;
    for distance in DISTANCES.map(|d| (d + label.least) * ink.unit) {
        // Nothing farther can be cheaper.
        if best.as_ref().is_some_and(|(cost, _)| distance >= *cost) {
            break;
        }
        for k in 0..DIRECTIONS {
            let angle = std::f64::consts::TAU * k as f64 / DIRECTIONS as f64;
            let (sin, cos) = crate::math::sin_cos(angle);
            let d = [wish[0] * cos - wish[1] * sin, wish[0] * sin + wish[1] * cos];
            let bounds = box_beside(label.anchor, d, distance, size);
            if !is_within(&bounds, area) || ink.bins.any_box(&bounds, |b| overlap(b, &bounds)) {
                continue;
            }
            let turn = TURN_COST * (1.0 - cos) * ink.unit;
            let leader = leader_of(label, &bounds, ink.unit);
            let crossed = leader.map_or(0.0, |line| crossed_lines(line, ink) * 12.0 * ink.unit);
            let cost = distance + turn + crossed + LINE_COST * covered_lines(&bounds, ink);
            if best.as_ref().is_none_or(|(known, _)| cost < *known) {
                best = Some((cost, bounds));
            }
        }
    }
    best.map(|(_, bounds)| bounds)
}

/// The box of a given size whose edge lies at a distance from a point, in a given direction.
fn box_beside(at: DrawnSpot, d: DrawnSpot, distance: f64, [wide, high]: [f64; 2]) -> Rect {
    // Where the line from the middle leaves the box.
    let reach =
        (0.5 * wide / d[0].abs().max(NO_LENGTH)).min(0.5 * high / d[1].abs().max(NO_LENGTH));
    let middle = spot_ahead(at, d, distance + reach);
    Rect {
        left: middle[0] - 0.5 * wide,
        right: middle[0] + 0.5 * wide,
        top: middle[1] - 0.5 * high,
        bottom: middle[1] + 0.5 * high,
    }
}

/// Whether two boxes share more than a rim.
pub fn overlap(a: &Rect, b: &Rect) -> bool {
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom
}

fn is_within(a: &Rect, area: &Rect) -> bool {
    a.left >= area.left && a.right <= area.right && a.top >= area.top && a.bottom <= area.bottom
}

/// Pixels of lines within a box.
fn covered_lines(bounds: &Rect, ink: &Ink) -> f64 {
    ink.bins
        .lines_in(bounds)
        .map(|line| clipped_length(line, bounds))
        .sum()
}

/// Length of the part of a line that lies inside a box (Liang and Barsky).
fn clipped_length([a, b]: [DrawnSpot; 2], r: &Rect) -> f64 {
    let d = spot_difference(b, a);
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (p, q) in [
        (-d[0], a[0] - r.left),
        (d[0], r.right - a[0]),
        (-d[1], a[1] - r.top),
        (d[1], r.bottom - a[1]),
    ] {
        if p == 0.0 {
            if q < 0.0 {
                return 0.0;
            }
        } else if p < 0.0 {
            from = from.max(q / p);
        } else {
            to = to.min(q / p);
        }
    }
    if to > from {
        (to - from) * spot_length(d)
    } else {
        0.0
    }
}

/// How many lines a line crosses.
fn crossed_lines(line: [DrawnSpot; 2], ink: &Ink) -> f64 {
    let side = |[a, b]: [DrawnSpot; 2], p: DrawnSpot| {
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    };
    let crosses = |other: &[DrawnSpot; 2]| {
        side(line, other[0]) * side(line, other[1]) < 0.0
            && side(*other, line[0]) * side(*other, line[1]) < 0.0
    };
    ink.bins.lines_across(line).filter(crosses).count() as f64
}

/// The leader line from a distant label to what it names.
fn leader_of(label: &WantedLabel, bounds: &Rect, unit_length: f64) -> Option<[DrawnSpot; 2]> {
    let [x, y] = label.anchor;
    let near = [
        x.clamp(bounds.left, bounds.right),
        y.clamp(bounds.top, bounds.bottom),
    ];
    let far = spot_length(spot_difference(near, label.anchor));
    (far > (LEADER + label.least) * unit_length).then_some([label.anchor, near])
}

fn draw_label(label: &WantedLabel, bounds: Rect, ink: &mut Ink) {
    let faint = ink.theme.event;
    if let Some(ends) = leader_of(label, &bounds, ink.unit) {
        ink.mark(&ends, faint, 0.7, Dashes::None);
    }
    let middle = [
        0.5 * (bounds.left + bounds.right),
        0.5 * (bounds.top + bounds.bottom),
    ];
    let paper = ink.theme.background;
    if label.ringed {
        let radius = 0.5 * bounds.width() - 0.8 * PAD * ink.unit;
        ink.circle(middle, radius / ink.unit, paper, label.colour, 1.2);
    } else if ink.bins.is_line_within(middle, bounds.height()) {
        let [r, g, b, _] = paper;
        ink.primitives.push(DrawnPrimitive::Area {
            rect: bounds,
            fill: [r, g, b, 205],
        });
    }
    let at = [middle[0], middle[1] + 0.5 * label.size];
    ink.text(
        at,
        &label.text,
        label.size,
        TextAnchor::Middle,
        label.colour,
    );
}
