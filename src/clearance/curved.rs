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
use super::near_part::{NearPart, nearest_to_axis, off_axis_of};
use super::relative::RelativeMove;
use crate::distance::curve_bend::{CurveBend, ring_bends};
use crate::distance::point::{PointHit, point_to, to_circle, to_disc};
use crate::distance::primitive::{Circle, Primitive};
use crate::distance::search::{
    CurveSpot, MOST_PROVING_SPOTS, Nearness, Spot, least_between, least_on_circle, lowest_of_bent,
};
use glam::DVec3;

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
    // No point comes nearer.
    let nearest = apart - meeting.found.missed - way;
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
                false => ring_bends(circle.radius, off_axis.max(0.0), nearest),
            };
            let followed = Followed::new(circle, moved);
            let lost = followed.lost(near.ball, off_axis, nearest);
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

    /// The same along centre + x cos φ + y sin φ, moved by ± X.
    fn beside(
        &self,
        still: &Still,
        (moved, sign): (&RelativeMove, f64),
        [centre, x, y]: [DVec3; 3],
    ) -> Self {
        let [here, there] = self.0;
        let turned = |v: DVec3| v + moved.spin.cross(v) * sign;
        Self([
            here.beside(still.core, centre, [x, y]),
            there.beside(
                still.core,
                centre + moved.rate(centre) * sign,
                [turned(x), turned(y)],
            ),
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
            most: MOST_PROVING_SPOTS,
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
        let plain = self.bends(CurveBend::of_circle(still.ring(), circle));
        let towards = |sign: f64| {
            let bends = plain.beside(still, (moved, sign), [circle.centre, x, y]);
            let lowest = |a: &MovedSpot, b: &MovedSpot| bends.lowest_between(a, b);
            let at = |angle: f64, (sin, cos): (f64, f64)| {
                let (q, tangent) = (circle.centre + x * cos + y * sin, y * cos - x * sin);
                moved_spot(still, moved, sign, angle, q, tangent)
            };
            least_on_circle(lowest, self.nearness(circle.radius), at).floor
        };
        towards(1.0).min(towards(-1.0))
    }
}
