//! Lower bound of the distance of a moving point, segment or circle during a short time, to second order in the time.
//!
//! Unlike the planes of `gap` it does not depend on how the point of contact slides along both surfaces, and a
//! torus may pass through the hole of another one.
//!
//! Let f be the distance from the fixed core. Along the path q + u X, -1 ≤ u ≤ 1, of a point the function
//! f + K u² |X|²/2 is convex: for convex cores with K = 0; for a circle f is concave only inside of it, with a curvature of at
//! most the inverse distance from its axis. So f is at least 2 f(q) - f(q ± X) - K |X|² on the path, or f(q) - K |X|².

use super::meeting::Meeting;
use super::relative::RelativeMove;
use crate::distance::curve_bend::CurveBend;
use crate::distance::point::{PointHit, point_to, to_circle, to_disc};
use crate::distance::primitive::{Circle, Element, Primitive};
use crate::distance::search::{
    CurveSpot, Spot, angle_grid, least_between, least_on_circle, lowest_of_bent,
};
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

    /// Larger moving circles are not searched.
    fn largest(&self) -> f64 {
        match self.core {
            Primitive::Circle(circle) => circle.radius,
            _ => f64::INFINITY,
        }
    }
}

/// Lower bound of the distance of two elements while the second one, a sphere, capsule or torus, moves; `None` for others, and
/// where it cannot reach `goal`.
pub fn lower_bound(meeting: &Meeting, goal: f64) -> Option<f64> {
    let Meeting { a, moved, .. } = *meeting;
    let apart = meeting.found.distance + meeting.radii();
    let near = NearPart::new(meeting, apart);
    let way = moved.distance(near.ball);
    let mut still = Still {
        core: &a.core,
        is_filled: false,
        bends: 0.0,
    };
    match &a.core {
        Primitive::Circle(circle) => {
            still.is_filled = off_axis(circle, meeting.core_points()[1]) >= circle.radius;
            if !still.is_filled {
                // Points farther away than this cannot come closer than the nearest one.
                let off_axis = nearest_to_axis(circle, &near.core, apart + 2.0 * way) - way;
                if off_axis <= 0.0 {
                    return None;
                }
                still.bends = off_axis.recip();
            }
        }
        Primitive::Mesh(..) | Primitive::HalfSpace(_) => return None,
        _ => {}
    }
    let lost = still.bends * way * way + moved.bending(near.ball) + moved.deviation(near.ball);
    if apart - lost - meeting.radii() < goal {
        return None;
    }
    let lowest = match &near.core {
        Primitive::Point(p) => of_point(&still, *p, moved)?,
        Primitive::Segment(ends) => of_segment(&still, ends, moved),
        // Of a small ring at a large one the least is looked for along the small one, as its distance is.
        Primitive::Circle(circle) if circle.radius > 0.0 && circle.radius <= still.largest() => {
            of_circle(&still, circle, moved)
        }
        _ => return None,
    };
    let apart = lowest.min(apart) - lost;
    // The depth of a segment in a solid is not determined by its deepest point alone.
    let is_solid = matches!(
        a.core,
        Primitive::Box(_) | Primitive::Frustum(_) | Primitive::Triangle(_)
    );
    if is_solid && matches!(near.core, Primitive::Segment(_)) && apart <= 0.0 {
        return None;
    }
    Some(apart - meeting.radii())
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
fn off_axis(circle: &Circle, point: DVec3) -> f64 {
    let offset = point - circle.centre;
    offset.reject_from_normalized(circle.axis).length()
}

/// No point of a core that is nearer to a circle than `limit` is nearer than this to the circle's axis. Curves are cut.
fn nearest_to_axis(circle: &Circle, core: &Primitive, limit: f64) -> f64 {
    let look = |q: DVec3| [to_circle(circle, q).distance, off_axis(circle, q)];
    let parts = (angle_grid().len() - 1) as f64;
    let (ends, arc): (Vec<[f64; 2]>, f64) = match core {
        Primitive::Point(p) => return off_axis(circle, *p),
        Primitive::Segment([from, to]) => {
            let at = |k: usize| *from + (*to - *from) * (k as f64 / parts);
            let ends = (0..angle_grid().len()).map(|k| look(at(k))).collect();
            (ends, from.distance(*to) / parts)
        }
        Primitive::Circle(moving) => {
            let [x, y] = moving.directions().map(|d| d * moving.radius);
            let at = |(sin, cos): &(f64, f64)| moving.centre + x * *cos + y * *sin;
            let ends = angle_grid().iter().map(|place| look(at(place))).collect();
            (ends, TAU * moving.radius / parts)
        }
        _ => return 0.0,
    };
    // Lipschitz along the core: only arcs that can come nearer than the limit count.
    let near = ends.windows(2).filter_map(|pair| {
        let [[f, first], [g, second]] = [pair[0], pair[1]];
        (0.5 * (f + g - arc) < limit).then_some(0.5 * (first + second - arc))
    });
    near.fold(f64::INFINITY, f64::min)
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
    fn new(still: &Still, moved: &RelativeMove, here: CurveBend) -> Self {
        let stretched = 1.0 + moved.spin.length();
        Self([here, CurveBend::elsewhere(still.ring(), &here, stretched)])
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

/// The least of 2 f(q) - f(q ± X) over the points q of a segment.
fn of_segment(still: &Still, ends: &[DVec3; 2], moved: &RelativeMove) -> f64 {
    let span = ends[1] - ends[0];
    let bends = MovedBends::new(
        still,
        moved,
        CurveBend::of_segment(still.ring(), span.length()),
    );
    let missed = MISSED * span.length();
    let lowest = |a: &MovedSpot, b: &MovedSpot| bends.lowest_between(a, b);
    let towards = |sign: f64| {
        let at = |t: f64| moved_spot(still, moved, sign, t, ends[0] + span * t, span);
        least_between([0.0, 1.0], lowest, missed, at).floor
    };
    towards(1.0).min(towards(-1.0))
}

/// The same over those of a circle. Of a circle along which f hardly changes no bound is near enough, so that what was found
/// counts: what may be missed is then narrower than the places looked at, and no deeper than a circle leaves its chord there.
fn of_circle(still: &Still, circle: &Circle, moved: &RelativeMove) -> f64 {
    let [x, y] = circle.directions().map(|d| d * circle.radius);
    let bends = MovedBends::new(still, moved, CurveBend::of_circle(still.ring(), circle));
    let missed = MISSED * circle.radius;
    let lowest = |a: &MovedSpot, b: &MovedSpot| bends.lowest_between(a, b);
    let towards = |sign: f64| {
        let at = |angle: f64, (sin, cos): (f64, f64)| {
            let (q, tangent) = (circle.centre + x * cos + y * sin, y * cos - x * sin);
            moved_spot(still, moved, sign, angle, q, tangent)
        };
        least_on_circle(lowest, missed, at).spot.value - missed
    };
    towards(1.0).min(towards(-1.0))
}
