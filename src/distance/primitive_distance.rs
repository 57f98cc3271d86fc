//! Distance of two cores that do not overlap: which candidates there are, and the best of them.
//!
//! The nearest points of two convex cores lie on a vertex or edge of one of them, on the rim of one, or on two curved
//! sides whose common normal is known in closed form. Each candidate is a point of one core and its nearest point on
//! the other, so none can be too small, and one of them is the nearest pair. A circle is searched along its angle.

use super::curve_bend::CurveBend;
use super::point::{PointHit, on_segment, point_to, to_segment};
use super::primitive::{BOX_EDGES, Circle, Frustum, Primitive};
use super::primitive_pair::CorePair;
use super::search::{CurveSpot, least_convex, least_near, least_on_circle};
use super::triangles;
use crate::math::sin_cos;
use crate::sorting::sort_by_number;
use glam::DVec3;

/// The nearest points of two cores, neither of which is a mesh.
///
/// Where two solid cores overlap the distance is negative or zero, but no depth yet.
pub fn nearest_cores(a: &Primitive, b: &Primitive) -> CorePair {
    match (a, b) {
        (_, Primitive::Point(p)) => of_point(a, *p),
        (Primitive::Point(p), _) => of_point(b, *p).swapped(),
        // Along the smaller one: two minima that a small ring has at a large one are near each other on the large one only.
        (Primitive::Circle(first), Primitive::Circle(second)) if first.radius < second.radius => {
            of_circle(b, first).swapped()
        }
        (_, Primitive::Circle(circle)) => of_circle(a, circle),
        (Primitive::Circle(circle), _) => of_circle(b, circle).swapped(),
        (Primitive::Segment(s), Primitive::Segment(t)) => of_segments(s, t),
        (_, Primitive::Segment(ends)) => of_edge(a, ends),
        (Primitive::Segment(ends), _) => of_edge(b, ends).swapped(),
        (Primitive::Triangle(t), Primitive::Triangle(u)) => triangles::to_triangle(t, u),
        (Primitive::Triangle(t), Primitive::Box(block)) => triangles::to_box(t, block),
        (Primitive::Box(block), Primitive::Triangle(t)) => triangles::to_box(t, block).swapped(),
        _ => of_solids(a, b),
    }
}

fn of_point(a: &Primitive, point: DVec3) -> CorePair {
    point_to(a, point).map_or(CorePair::FAR, |hit| CorePair::onto_first(point, hit))
}

/// Segments whose lines pass by each other as near as this, in their lengths, and are not as parallel as this ...
const CROSSED: f64 = 1e-6;

/// Nearest points of two segments, parallel ones included.
pub fn of_segments(a: &[DVec3; 2], b: &[DVec3; 2]) -> CorePair {
    // Of the four ends only the nearest one needs a normal.
    let ends = [(a[0], b), (a[1], b), (b[0], a), (b[1], a)];
    let far = ends.map(|(end, other)| end.distance(on_segment(other, end)));
    let k = (1..4).fold(0, |k, j| if far[j] < far[k] { j } else { k });
    let (end, other) = ends[k];
    let mut best = CorePair::onto_first(end, to_segment(other, end));
    if k < 2 {
        best = best.swapped();
    }
    // Inside both: only where the lines are not parallel, and then the cross product says it without cancellation.
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], b[0] - a[0]);
    let across = u.cross(v);
    let size = across.length_squared();
    let s = w.cross(v).dot(across) / size;
    let t = w.cross(u).dot(across) / size;
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        // The foot, since of almost parallel lines the crossing is known along them but roughly.
        let on_first = a[0] + u * s;
        let far = on_first.distance(on_segment(b, on_first));
        let is_near = far <= CROSSED * (u.length() + v.length());
        if !is_near && far >= best.distance {
            return best;
        }
        let mut crossing = CorePair::onto_first(on_first, to_segment(b, on_first)).swapped();
        let extent = u.length() * v.length();
        if is_near && size > (CROSSED * extent).powi(2) {
            // ... have the common normal of both, since the way itself is mostly rounding.
            let span = crossing.points[1] - crossing.points[0];
            crossing.normal = across * (span.dot(across).signum() / size.sqrt());
            crossing.distance = span.dot(crossing.normal);
        }
        best.take(crossing);
    }
    best
}

/// Nearest points of a convex core and a segment: the distance is convex along the segment.
fn of_edge(a: &Primitive, ends: &[DVec3; 2]) -> CorePair {
    if let Primitive::Triangle(corners) = a {
        return triangles::to_segment(corners, ends);
    }
    if let Primitive::Box(block) = a
        && let Some(apart) = triangles::box_to_segment(block, ends)
    {
        return apart;
    }
    let span = ends[1] - ends[0];
    let at = |t: f64| ends[0] + span * t;
    let spot = least_convex(0.0, 1.0, |t| core_spot(a, t, at(t), span));
    of_point(a, at(spot.at))
}

fn core_spot(a: &Primitive, at: f64, point: DVec3, tangent: DVec3) -> CurveSpot {
    point_to(a, point).map_or(CurveSpot::default(), |hit| CurveSpot {
        at,
        value: hit.distance,
        slope: hit.normal.dot(tangent),
    })
}

/// Nearest points of any core and a circle.
fn of_circle(a: &Primitive, circle: &Circle) -> CorePair {
    if circle.radius <= 0.0 {
        return of_point(a, circle.centre);
    }
    if is_coaxial(a, circle) {
        return of_point(a, circle.centre + circle.directions()[0] * circle.radius);
    }
    if let Some(found) = of_disc(a, circle) {
        return found;
    }
    let [x, y] = circle.directions().map(|d| d * circle.radius);
    let point = |(sin, cos): (f64, f64)| circle.centre + x * cos + y * sin;
    let bend = CurveBend::of_circle(a.circle(), circle).beside(a, circle.centre, [x, y]);
    let lowest = |p: &CurveSpot, q: &CurveSpot| bend.lowest_between(p, q);
    let found = least_on_circle(lowest, bend.missed(circle.centre), |angle, (sin, cos)| {
        core_spot(a, angle, point((sin, cos)), y * cos - x * sin)
    });
    let pair = of_point(a, point(sin_cos(found.spot.at)));
    let missed = match found.is_cut_off {
        // A plane may part the core from the whole disc.
        true => found
            .missed()
            .min(pair.distance - parted_by(a, &Primitive::Circle(*circle), pair.normal)),
        false => 0.0,
    };
    CorePair {
        missed: missed.max(0.0),
        ..pair
    }
}

/// How far apart two planes square to `n`, from the first core to the second, keep them.
fn parted_by(a: &Primitive, b: &Primitive, n: DVec3) -> f64 {
    match (a.support(n), b.support(-n)) {
        (Some(reach), Some(back)) if n != DVec3::ZERO => -reach - back,
        _ => f64::NEG_INFINITY,
    }
}

/// Whether a core turns into itself about a circle's axis, to rounding: all points of the circle are as near then.
pub fn is_coaxial(a: &Primitive, circle: &Circle) -> bool {
    let (on_axis, axis) = match a {
        Primitive::Circle(other) => (other.centre, other.axis),
        Primitive::Frustum(frustum) => (frustum.from, frustum.axis),
        _ => return false,
    };
    let offset = circle.centre - on_axis;
    let aside = offset.cross(axis).length() + circle.radius * circle.axis.cross(axis).length();
    aside <= LEAST * (circle.radius + offset.length())
}

/// A value is the least if it provably could fall by no more than this, relative to the lengths it is made of: rounding.
const LEAST: f64 = 2.0 * f64::EPSILON;

/// The first step along a circle, as the tangent of half its angle: at least, and at most.
const FIRST_STEP: [f64; 2] = [3e-6, 0.2];

/// The tangent of half a quarter of a turn: where it is looked for the least value beside the place that seems nearest.
const FARTHEST: f64 = 1.0;

/// Nearest points of a convex core and a disc if they lie on its circle, where one provably is nearest.
///
/// The signed distance f of a convex core is convex, so that no point x of the disc is nearer than f(p) + n · (x - p) with the
/// normal n at a point p of the circle. If n has λ inwards and s along the circle of radius r, that is no less than
/// f(p) - r (√(λ² + s²) - λ).
fn of_disc(a: &Primitive, circle: &Circle) -> Option<CorePair> {
    if matches!(a, Primitive::Circle(_)) {
        return None;
    }
    let (centre, radius) = (circle.centre, circle.radius);
    let start = match circle.outward(-point_to(a, centre)?.normal) {
        DVec3::ZERO => circle.directions()[0],
        outward => outward,
    };
    let side = circle.axis.cross(start);
    // Outward and along the circle, by the tangent t of half the angle from the start, and how fast the angle goes with t.
    let at = |t: f64| {
        let fast = 2.0 / (1.0 + t * t);
        let (sin, cos) = (fast * t, fast - 1.0);
        (start * cos + side * sin, side * cos - start * sin, fast)
    };
    let spot = |t: f64, hit: &PointHit, tangent: DVec3| CurveSpot {
        at: t,
        value: hit.distance,
        slope: hit.normal.dot(tangent),
    };
    // Of a small core the nearest point hardly moves.
    let here = point_to(a, centre + start * radius)?;
    let ahead = here.nearest - centre;
    let (along, aside) = (ahead.dot(start), ahead.dot(side).abs());
    let turn = aside / (along + (along * along + aside * aside).sqrt());
    // Without a way along or aside there is no turn.
    let step = match turn.is_nan() {
        true => FIRST_STEP[1],
        false => (2.0 * turn).clamp(FIRST_STEP[0], FIRST_STEP[1]),
    };
    let first = spot(0.0, &here, side * (2.0 * radius));
    let best = least_near(first, step, FARTHEST, |t| {
        let (outward, along, fast) = at(t);
        let hit = point_to(a, centre + outward * radius);
        hit.map_or(CurveSpot::default(), |hit| {
            spot(t, &hit, along * (radius * fast))
        })
    })?;
    let (outward, along, _) = at(best.at);
    let point = centre + outward * radius;
    let hit = point_to(a, point)?;
    let (inwards, aside) = (-hit.normal.dot(outward), hit.normal.dot(along));
    let falls = radius * aside * aside / (libm::hypot(inwards, aside) + inwards);
    let is_least = inwards > 0.0 && falls <= LEAST * (radius + hit.distance.abs());
    is_least.then(|| CorePair::onto_first(point, hit))
}

/// Corners of a polyhedral core, how many there are, and which of them its edges join.
type Polyhedron = ([DVec3; 8], usize, &'static [[usize; 2]]);

fn core_polyhedron(core: &Primitive) -> Option<Polyhedron> {
    match core {
        Primitive::Box(block) => Some((block.corners(), 8, &BOX_EDGES)),
        Primitive::Triangle([a, b, c]) => {
            let mut corners = [*a; 8];
            (corners[1], corners[2]) = (*b, *c);
            Some((corners, 3, &[[0, 1], [1, 2], [2, 0]]))
        }
        _ => None,
    }
}

/// Two cores are proved to be as far apart as two of their points to this, relative to the lengths it is made of.
const PROVED: f64 = 4.0 * f64::EPSILON;

/// Whether the planes square to the line between two points part the cores they lie on: none are nearer then.
fn is_proved(a: &Primitive, b: &Primitive, best: &CorePair) -> bool {
    if best.distance <= 0.0 || best.normal == DVec3::ZERO {
        return false;
    }
    let (Some(reach), Some(back)) = (a.support(best.normal), b.support(-best.normal)) else {
        return false;
    };
    let size = reach.abs() + back.abs() + best.distance;
    -reach - back >= best.distance - PROVED * size
}

/// Nearest points of two convex cores with faces: features in turn, until the best ones are proved to be nearest.
fn of_solids(a: &Primitive, b: &Primitive) -> CorePair {
    let mut best = CorePair::FAR;
    if let (Primitive::Frustum(f), Primitive::Frustum(g)) = (a, b) {
        compare_sides(f, g, &mut best);
        if !is_proved(a, b, &best) {
            rims_and_spines([(a, f), (b, g)], &mut best);
        }
        return known_by_planes(a, b, best);
    }
    let far = [
        corners_of_second(a, b, &mut best),
        with_swapped(&mut best, |best| corners_of_second(b, a, best)),
    ];
    if !is_proved(a, b, &best) && !edges_of_second(a, b, &far[0], &mut best) {
        with_swapped(&mut best, |best| edges_of_second(b, a, &far[1], best));
    }
    known_by_planes(a, b, best)
}

/// What a search along a rim has not ruled out, the planes may.
fn known_by_planes(a: &Primitive, b: &Primitive, best: CorePair) -> CorePair {
    match best.missed > 0.0 && is_proved(a, b, &best) {
        true => CorePair {
            missed: 0.0,
            ..best
        },
        false => best,
    }
}

/// Looks at a pair from the other side.
fn with_swapped<T>(best: &mut CorePair, look: impl FnOnce(&mut CorePair) -> T) -> T {
    let mut other = best.swapped();
    let found = look(&mut other);
    *best = other.swapped();
    found
}

/// Corners of `b` against the solid `a`, and how far each is.
fn corners_of_second(a: &Primitive, b: &Primitive, best: &mut CorePair) -> [f64; 8] {
    let mut far = [0.0; 8];
    if let Some((corners, count, _)) = core_polyhedron(b) {
        for k in 0..count {
            let hit = of_point(a, corners[k]);
            far[k] = hit.distance;
            best.take(hit);
        }
    }
    far
}

/// Edges, rims and spines of `b` against the solid `a`, until the best is proved to be the nearest: then this is true.
fn edges_of_second(a: &Primitive, b: &Primitive, far: &[f64; 8], best: &mut CorePair) -> bool {
    let mut is_best = |pair: CorePair| {
        let is_nearer = pair.distance < best.distance;
        best.take(pair);
        (is_nearer && is_proved(a, b, best), best.distance)
    };
    let mut least = is_best(CorePair::FAR).1;
    if let Some((corners, _, edges)) = core_polyhedron(b) {
        for &[i, j] in edges {
            // The distance falls along the edge by no more than the way.
            let lowest = 0.5 * (far[i] + far[j] - corners[i].distance(corners[j]));
            if lowest < least {
                let (is_done, nearest) = is_best(of_edge(a, &[corners[i], corners[j]]));
                if is_done {
                    return true;
                }
                least = nearest;
            }
        }
    }
    if let Primitive::Frustum(frustum) = b {
        let mut rims = frustum.rims().map(|rim| (lowest_of_disc(a, &rim), rim));
        sort_by_number(&mut rims, |p| p.0);
        for (lowest, rim) in rims {
            if lowest < least {
                let (is_done, nearest) = is_best(of_circle(a, &rim));
                if is_done {
                    return true;
                }
                least = nearest;
            }
        }
        // A thin solid may pierce this one without touching its rims.
        let spine = of_edge(a, &frustum.spine());
        if spine.distance <= 0.0 {
            is_best(spine);
        }
    }
    false
}

/// No point of a disc is nearer to a convex core: the distance lies above its plane at the middle of the disc.
fn lowest_of_disc(a: &Primitive, disc: &Circle) -> f64 {
    let hit = of_point(a, disc.centre);
    let flat = hit.normal - disc.axis * hit.normal.dot(disc.axis);
    hit.distance - disc.radius * flat.length()
}

/// Rims and spines of two frusta against each other, those first that promise most, until the best is proved to be the
/// nearest.
fn rims_and_spines(pair: [(&Primitive, &Frustum); 2], best: &mut CorePair) {
    let [(a, f), (b, g)] = pair;
    let [of_a, of_b] = [f.rims(), g.rims()];
    let mut rims = [
        (b, of_a[0], true),
        (b, of_a[1], true),
        (a, of_b[0], false),
        (a, of_b[1], false),
    ]
    .map(|(other, rim, is_first)| (lowest_of_disc(other, &rim), other, rim, is_first));
    sort_by_number(&mut rims, |p| p.0);
    for (lowest, other, rim, is_first) in rims {
        if lowest < best.distance {
            let found = of_circle(other, &rim);
            let found = if is_first { found.swapped() } else { found };
            let is_nearer = found.distance < best.distance;
            best.take(found);
            if is_nearer && is_proved(a, b, best) {
                return;
            }
        }
    }
    // A thin solid may pierce the other one without touching its rims.
    for spine in [of_edge(a, &g.spine()), of_edge(b, &f.spine()).swapped()] {
        if spine.distance <= 0.0 {
            best.take(spine);
        }
    }
}

/// Where the curved sides of two frusta face each other: the common normal makes a given angle with both axes.
fn compare_sides(f: &Frustum, g: &Frustum, best: &mut CorePair) {
    let lean = |f: &Frustum| {
        let fall = f.radii[0] - f.radii[1];
        fall / libm::hypot(fall, f.length)
    };
    let (along_f, along_g) = (lean(f), -lean(g));
    let w = f.axis.cross(g.axis);
    let size = w.length_squared();
    if size <= f64::EPSILON {
        return; // parallel: rims are as near
    }
    let c = f.axis.dot(g.axis);
    let alpha = (along_f - along_g * c) / size;
    let beta = (along_g - along_f * c) / size;
    let in_plane = f.axis * alpha + g.axis * beta;
    let rest = (1.0 - in_plane.length_squared()) / size;
    if rest < 0.0 {
        return;
    }
    for sign in [1.0, -1.0] {
        let n = in_plane + w * (sign * rest.sqrt());
        let (p, q) = (side_ruling(f, n), side_ruling(g, -n));
        let (u, v, span) = (p[1] - p[0], q[1] - q[0], q[0] - p[0]);
        let across = u.cross(v);
        let size = across.length_squared();
        let s = span.cross(v).dot(across) / size;
        let t = span.cross(u).dot(across) / size;
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            let points = [p[0] + u * s, q[0] + v * t];
            let distance = n.dot(points[1] - points[0]);
            // Seen from the wrong end the sides face away from each other; a real overlap holds the middle.
            let middle = (points[0] + points[1]) * 0.5;
            let held = |f: &Frustum| {
                let hit = point_to(&Primitive::Frustum(*f), middle);
                hit.is_some_and(|hit| hit.distance <= 0.0)
            };
            if distance > 0.0 || (held(f) && held(g)) {
                best.take(CorePair {
                    distance,
                    points,
                    normal: n,
                    missed: 0.0,
                });
            }
        }
    }
}

/// The straight line of a frustum's side whose normal is nearest to `n`.
fn side_ruling(f: &Frustum, n: DVec3) -> [DVec3; 2] {
    f.rims().map(|rim| rim.centre + rim.outward(n) * rim.radius)
}
