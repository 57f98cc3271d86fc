//! The places at which two rims are nearest to each other: candidates for the direction that separates two solids.

use super::curve_bend::CurveBend;
use super::point::to_circle;
use super::primitive::{Circle, Primitive};
use super::primitive_distance::is_coaxial;
use super::search::{CurveSpot, FINEST, angle_grid};
use crate::math::sin_cos;
use glam::DVec3;
use std::f64::consts::TAU;

/// Number of halvings of an interval in which a minimum other than the least one is sought.
const HALVINGS: usize = 7;

/// Directions in which two rims may be separated by less than `limit`: locally, where their circles are nearest to each
/// other. There a point of the Minkowski difference's rounded surface is nearest to the position of the second core.
pub fn rim_directions(of_first: &Circle, of_second: &Circle, limit: f64) -> Vec<DVec3> {
    let [x, y] = of_second.directions().map(|d| d * of_second.radius);
    let at = |(sin, cos): (f64, f64)| to_circle(of_first, of_second.centre + x * cos + y * sin);
    if is_coaxial(&Primitive::Circle(*of_first), of_second) {
        return vec![at((0.0, 1.0)).normal];
    }
    let bend = CurveBend::of_circle(Some(of_first), of_second);
    let minima = minima_on_circle(&bend, limit, |angle, (sin, cos)| {
        let hit = at((sin, cos));
        CurveSpot {
            at: angle,
            value: hit.distance,
            slope: hit.normal.dot(y * cos - x * sin),
        }
    });
    let direction = |spot: CurveSpot| at(sin_cos(spot.at)).normal;
    minima.into_iter().map(direction).collect()
}

/// All minima below `limit` of the distance from a core along a circle, given as a function of the circle's angle, its
/// sine and its cosine; but those that share 1/16384 of the turn with a maximum.
fn minima_on_circle(
    bend: &CurveBend,
    limit: f64,
    f: impl Fn(f64, (f64, f64)) -> CurveSpot,
) -> Vec<CurveSpot> {
    let spot = |k: usize| f(TAU * (k as f64 / FINEST as f64), angle_grid()[k]);
    let spots: Vec<CurveSpot> = (0..=FINEST).map(spot).collect();
    let mut pieces: Vec<[CurveSpot; 2]> = spots.windows(2).map(|two| [two[0], two[1]]).collect();
    let f = |angle: f64| f(angle, sin_cos(angle));
    let hides = |[a, b]: &[CurveSpot; 2]| {
        bend.lowest_between(a, b) < limit && !bend.has_no_minimum_between(a, b)
    };
    pieces.retain(hides);
    for _ in 0..HALVINGS {
        let halves = pieces.into_iter().flat_map(|[a, b]| {
            let middle = f(0.5 * (a.at + b.at));
            [[a, middle], [middle, b]]
        });
        pieces = halves.filter(hides).collect();
    }
    // Where the slope changes its sign there is a minimum between.
    let dips = pieces
        .into_iter()
        .filter(|[a, b]| a.slope <= 0.0 && b.slope > 0.0);
    dips.map(|[a, b]| perpendicular_foot(a, b, &f)).collect()
}

/// Zero of the slope between a falling and a rising point. By bisection: next to a minimum of zero the values are
/// rounding long before the slopes are.
fn perpendicular_foot(
    mut a: CurveSpot,
    mut b: CurveSpot,
    f: &impl Fn(f64) -> CurveSpot,
) -> CurveSpot {
    loop {
        let spot = f(0.5 * (a.at + b.at));
        if spot.at <= a.at || spot.at >= b.at {
            return spot;
        }
        if spot.slope <= 0.0 {
            a = spot;
        } else {
            b = spot;
        }
    }
}
