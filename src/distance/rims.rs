//! The places at which two rims are nearest to each other: candidates for the direction that separates two solids.

use super::curve_bend::CurveBend;
use super::point::to_circle;
use super::primitive::{Circle, Primitive};
use super::primitive_distance::is_coaxial;
use super::search::{CurveSpot, FINEST, angle_grid};
use crate::math::sin_cos;
use crate::numbers::bracket::Bracket;
use glam::DVec3;
use std::f64::consts::TAU;

/// Parts into which the turn is divided first, ...
const PARTS: usize = 8;

/// ... and how often a part is halved that may hold a minimum. The first four times the halves are parts of
/// [`angle_grid`].
const HALVINGS: usize = 11;

/// So many parts are not halved any more: they only are so many where the distance hardly changes over the turn, of rims
/// that are nearly coaxial, and then its minima are as wide as the turn.
const MOST_PARTS: usize = 64;

/// Steps of one search for a foot; bisection, every third of them, needs 53 to exhaust f64.
const MOST_STEPS: usize = 160;

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
    let hides = |[a, b]: &[CurveSpot; 2]| {
        bend.lowest_between(a, b) < limit && !bend.has_no_minimum_between(a, b)
    };
    let spot = |k: usize| f(TAU * (k as f64 / FINEST as f64), angle_grid()[k]);
    let ends: [CurveSpot; PARTS + 1] = std::array::from_fn(|k| spot(k * (FINEST / PARTS)));
    let mut pieces: Vec<[CurveSpot; 2]> = ends.windows(2).map(|two| [two[0], two[1]]).collect();
    pieces.retain(hides);
    let f = |angle: f64| f(angle, sin_cos(angle));
    for halving in 1..=HALVINGS {
        if pieces.len() > MOST_PARTS {
            break;
        }
        let halves = pieces.into_iter().flat_map(|[a, b]| {
            let at = 0.5 * (a.at + b.at);
            let middle = match (PARTS << halving) <= FINEST {
                true => spot((at * (FINEST as f64 / TAU)).round() as usize),
                false => f(at),
            };
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

/// Zero of the slope between a falling and a rising point. Only slopes count: next to a minimum of zero the values are
/// rounding long before them. False position, and bisection for kinks.
fn perpendicular_foot(a: CurveSpot, b: CurveSpot, f: &impl Fn(f64) -> CurveSpot) -> CurveSpot {
    let mut bracket = Bracket::new([a.at, a.slope], [b.at, b.slope]);
    let mut last = a;
    for step in 1..=MOST_STEPS {
        let share = match step % 3 {
            0 => 0.5,
            _ => bracket.secant_share(),
        };
        let spot = f(bracket.at(share));
        let is_settled = (spot.at - last.at).abs() <= f64::EPSILON * spot.at.abs();
        last = spot;
        let [low, high] = bracket.ends;
        if is_settled || spot.at <= low || spot.at >= high || spot.slope == 0.0 {
            break;
        }
        bracket.replace(spot.slope < 0.0, spot.at, spot.slope);
    }
    last
}
