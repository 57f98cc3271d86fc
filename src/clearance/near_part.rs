//! The part of a moving core that can come closest to a fixed one, and how near it comes to the axis of a circle.

use super::meeting::Meeting;
use super::relative::{LOST, RelativeMove, WIDER};
use crate::distance::point::to_circle;
use crate::distance::primitive::{Circle, Element, Primitive};
use crate::math::sin_cos;
use crate::numbers::rounding::GROW;
use glam::DVec3;
use std::f64::consts::TAU;

/// The part of the moving core whose points can come closer than the nearest one: for a long rod at a ring the part
/// near the ring, which may move much less than the ends.
pub(super) struct NearPart {
    /// In the middle of the time.
    pub core: Primitive,
    /// The ball around it in its own frame.
    pub ball: (DVec3, f64),
}

impl NearPart {
    pub fn is_segment(&self) -> bool {
        matches!(self.core, Primitive::Segment(_))
    }

    pub fn new(meeting: &Meeting, apart: f64) -> Self {
        let Meeting {
            a, b, mine, moved, ..
        } = *meeting;
        let (centre, radius) = mine.bounds();
        let whole = Self {
            core: b.core.clone(),
            ball: (centre, radius - mine.radius),
        };
        let (Primitive::Circle(circle), Primitive::Segment(there), Primitive::Segment(here)) =
            (&a.core, &b.core, &mine.core)
        else {
            return whole;
        };
        let mut part = whole;
        // First with the displacement of the whole rod, then with that of the remaining part.
        for _ in 0..2 {
            let reach = circle.radius + apart + 2.0 * moved.distance(part.ball);
            let Some([low, high]) = shares_within(there, circle.centre, reach) else {
                break;
            };
            let [from, to] = [low, high].map(|t| here[0].lerp(here[1], t));
            part = Self {
                core: Primitive::Segment([low, high].map(|t| there[0].lerp(there[1], t))),
                ball: (0.5 * (from + to), 0.5 * from.distance(to) * GROW),
            };
        }
        part
    }
}

/// Between which shares of its length a segment is within `reach` of a point, and a little more; `None` if nowhere.
fn shares_within([from, to]: &[DVec3; 2], centre: DVec3, reach: f64) -> Option<[f64; 2]> {
    let span = *to - *from;
    let size = span.length_squared();
    let middle = (centre - *from).dot(span) / size;
    let aside = centre.distance_squared(*from + span * middle);
    let half = ((reach * reach - aside) / size).sqrt() * WIDER + LOST;
    let shares = [middle - half, middle + half].map(|share| share.clamp(0.0, 1.0));
    (shares[0] < shares[1]).then_some(shares)
}

/// Smallest part into which a rod is divided, as a fraction of its length.
const SHORTEST: f64 = 1.0 / 256.0;

/// Lower bound of the distance of a ring and a rod that moves, in the frame of the ring and in its own: where a long rod is
/// near the ring it may move much less than its ends do. `None` of other pairs; no better than `goal`.
pub fn in_parts(
    [ring, placed, own]: [&Element; 3],
    moved: &RelativeMove,
    goal: f64,
) -> Option<f64> {
    let (Primitive::Circle(circle), Primitive::Segment(there), Primitive::Segment(here)) =
        (&ring.core, &placed.core, &own.core)
    else {
        return None;
    };
    let length = here[0].distance(here[1]);
    // A part is in the ball around its middle; that of no size cannot be bettered by shorter parts.
    let below = |middle: f64, half: f64| {
        let apart = to_circle(circle, there[0].lerp(there[1], middle)).distance - half;
        apart - moved.distance((here[0].lerp(here[1], middle), half))
    };
    let goal = goal + ring.radius + placed.radius;
    let lowest = lowest_part(&below, [0.5, 0.5], length, goal);
    Some(lowest - ring.radius - placed.radius)
}

fn lowest_part(
    below: &impl Fn(f64, f64) -> f64,
    [middle, half]: [f64; 2],
    length: f64,
    goal: f64,
) -> f64 {
    let low = below(middle, half * length);
    if low >= goal || half < SHORTEST || below(middle, 0.0) < goal {
        return low;
    }
    let half = 0.5 * half;
    let first = lowest_part(below, [middle - half, half], length, goal);
    match first < goal {
        true => low,
        false => first.min(lowest_part(below, [middle + half, half], length, goal)),
    }
}

/// How far a point is from the axis of a circle.
pub(super) fn off_axis_of(circle: &Circle, point: DVec3) -> f64 {
    let offset = point - circle.centre;
    offset.reject_from_normalized(circle.axis).length()
}

/// Arcs of a core are halved until they are no longer than this share of the distance from the axis, or that many times.
const FINE_ARC: f64 = 0.125;
const ARC_HALVINGS: u32 = 4;

/// The number of arcs at first.
const ARCS: usize = 8;

/// No point of a core that is nearer to a circle than `limit` is nearer than this to the circle's axis.
pub(super) fn nearest_to_axis(circle: &Circle, core: &Primitive, limit: f64) -> f64 {
    match core {
        Primitive::Point(p) => off_axis_of(circle, *p),
        Primitive::Segment([from, to]) => {
            let span = *to - *from;
            nearest_arc_to_axis(circle, span.length(), limit, |t| *from + span * t)
        }
        Primitive::Circle(moving) => {
            let [x, y] = moving.directions().map(|d| d * moving.radius);
            nearest_arc_to_axis(circle, TAU * moving.radius, limit, |t| {
                let (sin, cos) = sin_cos(TAU * t);
                moving.centre + x * cos + y * sin
            })
        }
        _ => 0.0,
    }
}

/// The same of a curve of this length, given on [0, 1]: Lipschitz along its arcs, of which only those count that can come nearer
/// than the limit.
fn nearest_arc_to_axis(
    circle: &Circle,
    length: f64,
    limit: f64,
    curve: impl Fn(f64) -> DVec3,
) -> f64 {
    let look = |t: f64| {
        let point = curve(t);
        [
            t,
            to_circle(circle, point).distance,
            off_axis_of(circle, point),
        ]
    };
    let ends: [[f64; 3]; ARCS + 1] = std::array::from_fn(|k| look(k as f64 / ARCS as f64));
    let mut open: Vec<[[f64; 3]; 2]> = ends.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    let (mut arc, mut nearest) = (length / ARCS as f64, f64::INFINITY);
    for halving in 0..=ARC_HALVINGS {
        let mut halves = Vec::new();
        for [a, b] in open {
            let sum = a[2] + b[2];
            if 0.5 * (a[1] + b[1] - arc) >= limit {
                continue;
            }
            if halving == ARC_HALVINGS || arc <= FINE_ARC * sum {
                nearest = nearest.min(0.5 * (sum - arc));
            } else {
                let middle = look(0.5 * (a[0] + b[0]));
                halves.extend([[a, middle], [middle, b]]);
            }
        }
        (open, arc) = (halves, 0.5 * arc);
    }
    nearest
}
