//! Lower bound of the distance of a moving point, segment or circle during a short time, to second order in the time.
//!
//! Unlike the planes of `gap` it does not depend on how the point of contact slides along both surfaces, and a
//! torus may pass through the hole of another one.
//!
//! Let f be the distance from the fixed core. Along the path q + u X, -1 ≤ u ≤ 1, of a point the function
//! f + K u² |X|²/2 is convex: for convex cores with K = 0; for a circle f is concave only inside of it, with the curvature that
//! [`ring_bends`] bounds. So f is at least 2 f(q) - f(q ± X) - K |X|² on the path, or f(q) - K |X|².

use super::followed::{Followed, following};
use super::meeting::Meeting;
use super::relative::RelativeMove;
use crate::distance::curve_bend::{CurveBend, ring_bends};
use crate::distance::point::{PointHit, point_to, to_circle, to_disc};
use crate::distance::primitive::{Circle, Element, Primitive};
use crate::distance::search::{
    CurveSpot, Nearness, Spot, least_between, least_on_circle, lowest_of_bent,
};
use crate::math::sin_cos;
use glam::DVec3;
use std::f64::consts::TAU;

/// The fixed core, and the largest concave curvature of f.
struct Still<'a> {
    core: &'a Primitive,
    /// For a circle, its whole disc: then f is convex and no larger.
    is_filled: bool,
    /// K.
    bends: f64,
}

impl Still<'_> {
    fn hit(&self, point: DVec3) -> Option<PointHit> {
        match self.core {
            Primitive::Circle(circle) if self.is_filled => Some(to_disc(circle, point)),
            core => point_to(core, point),
        }
    }

    /// The circle inside of which f is concave.
    fn ring(&self) -> Option<&Circle> {
        self.core.circle().filter(|_| !self.is_filled)
    }

    /// Whether a moving circle is searched: none that is larger than the fixed one.
    fn takes(&self, moving: &Circle) -> bool {
        let largest = self.core.circle().map_or(f64::INFINITY, |own| own.radius);
        moving.radius > 0.0 && moving.radius <= largest
    }
}

/// Lower bound of the distance of two elements while the second one, a sphere, capsule or torus, moves; `None` for others, and
/// where it cannot reach the first goal. It need not be better than the second.
pub fn lower_bound(meeting: &Meeting, [goal, enough]: [f64; 2]) -> Option<f64> {
    let moved = &following(meeting);
    let meeting = &Meeting { moved, ..*meeting };
    let a = meeting.a;
    let apart = meeting.found.distance + meeting.radii();
    let near = NearPart::new(meeting, apart);
    let way = moved.distance(near.ball);
    let mut still = Still {
        core: &a.core,
        is_filled: false,
        bends: 0.0,
    };
    let mut third = None;
    match &a.core {
        Primitive::Circle(circle) => {
            // Points farther away than this cannot come closer than the nearest one.
            let off_axis = nearest_to_axis(circle, &near.core, apart + 2.0 * way) - way;
            still.is_filled = off_axis_of(circle, meeting.core_points()[1]) >= circle.radius;
            still.bends = match still.is_filled {
                true => 0.0,
                false => ring_bends(circle.radius, off_axis.max(0.0), apart - way),
            };
            let followed = Followed::new(circle, moved);
            let lost = followed.lost(near.ball, off_axis, apart - way);
            third = Some((followed, lost));
        }
        Primitive::Mesh(..) | Primitive::HalfSpace(_) => return None,
        _ => {}
    }
    let second = still.bends * way * way + moved.bending(near.ball) + moved.deviation(near.ball);
    // To the order of time that loses less.
    let third = third.filter(|(_, lost)| *lost < second && !near.is_segment());
    let lost = third.as_ref().map_or(second, |(_, lost)| *lost);
    if !lost.is_finite() || apart - lost - meeting.radii() < goal {
        return None;
    }
    let search = CoreSearch {
        still: &still,
        moved,
        way,
        enough: enough + meeting.radii() + lost,
    };
    let lowest = match (&near.core, &third) {
        (Primitive::Point(p), Some((followed, _))) => followed.of_point(*p)[0],
        (Primitive::Point(p), None) => of_point(&still, *p, moved)?,
        (Primitive::Segment(ends), _) => search.of_segment(ends),
        // Of a small ring at a large one the least is looked for along the small one, as its distance is.
        (Primitive::Circle(circle), third) if still.takes(circle) => match third {
            Some((followed, _)) => followed.of_circle(circle, way, search.nearness(circle.radius)),
            None => search.of_circle(circle),
        },
        _ => return None,
    };
    let apart = lowest.min(apart) - lost;
    // The depth of a segment in a solid is not determined by its deepest point alone.
    let is_solid = matches!(
        a.core,
        Primitive::Box(_) | Primitive::Frustum(_) | Primitive::Triangle(_)
    );
    if is_solid && near.is_segment() && apart <= 0.0 {
        return None;
    }
    Some(apart - meeting.radii())
}

/// Upper bound of the distance of a fixed circle from a moving point or circle: along the path of the point that is nearest in the middle;
/// `None` for others.
pub fn upper_bound(meeting: &Meeting) -> Option<f64> {
    let Primitive::Circle(circle) = &meeting.a.core else {
        return None;
    };
    if !matches!(meeting.b.core, Primitive::Point(_) | Primitive::Circle(_)) {
        return None;
    }
    let moved = following(meeting);
    let point = meeting.core_points()[1];
    let ball = (moved.pose.inverse().transform_point(point), 0.0);
    let way = moved.distance(ball);
    let [off_axis, apart] = [
        off_axis_of(circle, point),
        to_circle(circle, point).distance,
    ];
    let followed = Followed::new(circle, &moved);
    let high = followed.of_point(point)[1] + followed.lost(ball, off_axis - way, apart - way);
    high.is_finite().then_some(high - meeting.radii())
}

/// The part of the moving core whose points can come closer than the nearest one: for a long rod at a ring the part
/// near the ring, which may move much less than the ends.
struct NearPart {
    /// In the middle of the time.
    core: Primitive,
    /// The ball around it in its own frame.
    ball: (DVec3, f64),
}

impl NearPart {
    fn is_segment(&self) -> bool {
        matches!(self.core, Primitive::Segment(_))
    }

    fn new(meeting: &Meeting, apart: f64) -> Self {
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
                ball: (0.5 * (from + to), 0.5 * from.distance(to) * (1.0 + 1e-12)),
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
    let half = ((reach * reach - aside) / size).sqrt() * (1.0 + 1e-9) + 1e-12;
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
fn off_axis_of(circle: &Circle, point: DVec3) -> f64 {
    let offset = point - circle.centre;
    offset.reject_from_normalized(circle.axis).length()
}

/// Arcs of a core are halved until they are no longer than this share of the distance from the axis, or that many times.
const FINE_ARC: f64 = 0.125;
const ARC_HALVINGS: u32 = 4;

/// The number of arcs at first.
const ARCS: usize = 8;

/// No point of a core that is nearer to a circle than `limit` is nearer than this to the circle's axis.
fn nearest_to_axis(circle: &Circle, core: &Primitive, limit: f64) -> f64 {
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

fn of_point(still: &Still, q: DVec3, moved: &RelativeMove) -> Option<f64> {
    let rate = moved.rate(q);
    let [back, here, ahead] = [q - rate, q, q + rate].map(|q| still.hit(q));
    Some(2.0 * here?.distance - back?.distance.max(ahead?.distance))
}

/// A place q of a core that moves: f(q) with its slope along the core, and f(q ± X).
#[derive(Clone, Copy, Default)]
struct MovedSpot {
    here: CurveSpot,
    there: CurveSpot,
}

impl Spot for MovedSpot {
    fn place(&self) -> CurveSpot {
        CurveSpot {
            at: self.here.at,
            value: 2.0 * self.here.value - self.there.value,
            slope: 2.0 * self.here.slope - self.there.slope,
        }
    }
}

fn moved_spot(
    still: &Still,
    moved: &RelativeMove,
    sign: f64,
    at: f64,
    q: DVec3,
    tangent: DVec3,
) -> MovedSpot {
    let spot = |q: DVec3, tangent: DVec3| {
        still.hit(q).map(|hit| CurveSpot {
            at,
            value: hit.distance,
            slope: hit.normal.dot(tangent),
        })
    };
    let there = q + moved.rate(q) * sign;
    let turned = tangent + moved.spin.cross(tangent) * sign;
    match [spot(q, tangent), spot(there, turned)] {
        [Some(here), Some(there)] => MovedSpot { here, there },
        _ => MovedSpot::default(),
    }
}

/// Of the curve along which f is taken, where it is and where X takes it.
struct MovedBends([CurveBend; 2]);

impl MovedBends {
    /// X changes along a core as fast as the spin takes its points.
    fn new(still: &Still, (moved, way): (&RelativeMove, f64), here: CurveBend) -> Self {
        let stretched = 1.0 + moved.spin.length();
        Self([
            here,
            CurveBend::elsewhere(still.ring(), &here, stretched, way),
        ])
    }

    /// 2 f(q) - f(q ± X) is nowhere between two places lower: f is above its tangents and below its chord, but for what it
    /// bends down.
    fn lowest_between(&self, a: &MovedSpot, b: &MovedSpot) -> f64 {
        let [here, there] = &self.0;
        let wide = b.here.at - a.here.at;
        let plain =
            2.0 * here.lowest_between(&a.here, &b.here) - there.highest_between(&a.there, &b.there);
        let bends = [
            here.between(&a.here, &b.here),
            there.between(&a.there, &b.there),
        ];
        let [Some(here), Some(there)] = bends else {
            return plain;
        };
        let rise = (b.there.value - a.there.value) / wide;
        let above_chord = |spot: &MovedSpot| CurveSpot {
            at: spot.here.at,
            value: 2.0 * spot.here.value - spot.there.value,
            slope: 2.0 * spot.here.slope - rise,
        };
        let bent = lowest_of_bent(2.0 * here, &above_chord(a), &above_chord(b));
        plain.max(bent - 0.125 * there * wide * wide)
    }
}

/// What a search along a core may miss, in its length or radius: far less than bodies in contact are proved to.
const MISSED: f64 = 1e-8;

/// The search for the least of 2 f(q) - f(q ± X) over the points q of a core.
struct CoreSearch<'a> {
    still: &'a Still<'a>,
    moved: &'a RelativeMove,
    /// No point moves farther.
    way: f64,
    /// What the least need not be better than.
    enough: f64,
}

impl CoreSearch<'_> {
    /// Along a core of this length or radius.
    fn nearness(&self, size: f64) -> Nearness {
        Nearness {
            tolerance: MISSED * size,
            enough: self.enough,
        }
    }

    fn bends(&self, here: CurveBend) -> MovedBends {
        MovedBends::new(self.still, (self.moved, self.way), here)
    }

    /// On a segment.
    fn of_segment(&self, ends: &[DVec3; 2]) -> f64 {
        let Self { still, moved, .. } = *self;
        let span = ends[1] - ends[0];
        let bends = self.bends(CurveBend::of_segment(still.ring(), span.length()));
        let lowest = |a: &MovedSpot, b: &MovedSpot| bends.lowest_between(a, b);
        let towards = |sign: f64| {
            let at = |t: f64| moved_spot(still, moved, sign, t, ends[0] + span * t, span);
            least_between([0.0, 1.0], lowest, self.nearness(span.length()), at).floor
        };
        towards(1.0).min(towards(-1.0))
    }

    /// On a circle.
    fn of_circle(&self, circle: &Circle) -> f64 {
        let Self { still, moved, .. } = *self;
        let [x, y] = circle.directions().map(|d| d * circle.radius);
        let bends = self.bends(CurveBend::of_circle(still.ring(), circle));
        let lowest = |a: &MovedSpot, b: &MovedSpot| bends.lowest_between(a, b);
        let towards = |sign: f64| {
            let at = |angle: f64, (sin, cos): (f64, f64)| {
                let (q, tangent) = (circle.centre + x * cos + y * sin, y * cos - x * sin);
                moved_spot(still, moved, sign, angle, q, tangent)
            };
            least_on_circle(lowest, self.nearness(circle.radius), at).floor
        };
        towards(1.0).min(towards(-1.0))
    }
}
