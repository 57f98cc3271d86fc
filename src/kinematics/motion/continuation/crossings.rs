//! Locates a singular pose that was passed: the smallest singular value, with the determinant's sign, is a smooth
//! function of time with a zero there. It is evaluated at some distance, where poses still have their digits.

use crate::kinematics::motion::tracker::path_tracker::{PathPoint, PathTracker};
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::MAX_CORRECTION;

/// Nodes on either side of the singular pose.
const SIDE: usize = 3;

/// The nodes come closer by this factor from one round to the next.
const CLOSER: f64 = 0.125;

/// Rounds end when the nearest node's singular value falls below this fraction of the best one: at a fraction s a pose
/// is known to about u / s, and the error of the interpolation is of the order of s to the power 2 SIDE.
const NEAR_ENOUGH: f64 = 3e-3;

/// Most rounds; each takes three binary digits off the distance.
const ROUNDS: usize = 12;

/// A crossing that waits for a pose after it.
#[derive(Clone, Debug)]
pub(crate) struct SignChange {
    /// The event that reports it.
    pub event: usize,
    /// A regular pose before it.
    pub before: PathPoint,
}

/// A place on the path with the tangent there.
struct CrossingNode {
    point: PathPoint,
    rates: Vec<f64>,
    /// Signed singular value.
    value: f64,
}

/// Time at which the determinant of a block vanishes between two poses; `None` if none changes its sign, or if poses
/// between them cannot be found.
pub(crate) fn zero_between(
    tracker: &mut PathTracker,
    before: PathPoint,
    after: PathPoint,
) -> Option<f64> {
    let mut pairs = before.branch.signs.iter().zip(&after.branch.signs);
    let block = pairs.position(|(a, b)| a * b < 0)?;
    let mut low = crossing_node(tracker, before, block);
    let mut high = crossing_node(tracker, after, block);
    // Secant first, then inverse interpolation through points on both sides, nearer every round.
    let mut zero =
        low.point.time + (high.point.time - low.point.time) * low.value / (low.value - high.value);
    let mut spread = CLOSER * (high.point.time - low.point.time);
    for _ in 0..ROUNDS {
        let room = (zero - low.point.time).min(high.point.time - zero) / SIDE as f64;
        spread = spread.min(room);
        let mut nodes = Vec::with_capacity(2 * SIDE);
        for k in 1..=SIDE {
            for sign in [-1.0, 1.0] {
                let time = zero + sign * spread * k as f64;
                nodes.push(crossing_between(tracker, &low, &high, time, block)?);
            }
        }
        let found = inverse_at_zero(&nodes);
        let values = nodes.iter().map(|n| n.value.abs());
        let nearest = values.fold(f64::INFINITY, f64::min);
        let on_side = |side: f64| nodes.iter().any(|n| n.value * side > 0.0);
        let is_around = on_side(low.value) && on_side(high.value);
        // Signs keep the zero between two poses: in a drive that comes to rest there, time is not a smooth function of
        // the value, and the interpolation may fail.
        for node in nodes {
            let is_between = (low.point.time..high.point.time).contains(&node.point.time);
            match node.value * low.value > 0.0 {
                true if is_between => low = node,
                false if is_between => high = node,
                _ => {}
            }
        }
        let bracket = low.point.time..=high.point.time;
        let middle = 0.5 * (low.point.time + high.point.time);
        zero = found
            .filter(|zero| is_around && bracket.contains(zero))
            .unwrap_or(middle);
        if is_around && nearest < NEAR_ENOUGH * tracker.regularity.largest() {
            break;
        }
        // Nodes that are all on one side of it were too close.
        let width = match is_around {
            true => spread,
            false => high.point.time - low.point.time,
        };
        spread = CLOSER * width;
    }
    Some(zero)
}

fn crossing_node(tracker: &mut PathTracker, point: PathPoint, block: usize) -> CrossingNode {
    // The iterated value at every pose is accurate to a millionth, which would affect the location.
    let exact = tracker.solver.exact_sigma(&point.coordinates, block);
    let sigma = exact.unwrap_or(point.branch.sigma_min);
    CrossingNode {
        value: f64::from(point.branch.signs[block]) * sigma,
        rates: tracker.rates(&point),
        point,
    }
}

/// The pose at `time`, from the cubic through two others.
fn crossing_between(
    tracker: &mut PathTracker,
    low: &CrossingNode,
    high: &CrossingNode,
    time: f64,
    block: usize,
) -> Option<CrossingNode> {
    let width = high.point.time - low.point.time;
    let s = (time - low.point.time) / width;
    // Cubic Hermite interpolation of the unknowns, then Newton.
    let (a, b) = (s * s * (3.0 - 2.0 * s), s * (1.0 - s));
    let inputs = tracker.inputs(time).ok()?;
    let mut coordinates: Vec<f64> = (0..tracker.unknowns())
        .map(|k| {
            let (p, q) = (low.point.coordinates[k], high.point.coordinates[k]);
            let bend = b * width * ((1.0 - s) * low.rates[k] - s * high.rates[k]);
            p + a * (q - p) + bend
        })
        .collect();
    coordinates.extend(inputs);
    let correction = tracker.solver.correct(&mut coordinates, Pace::Brisk);
    if !correction.converged || correction.first_step > MAX_CORRECTION {
        return None;
    }
    let point = tracker.point(time, coordinates);
    Some(crossing_node(tracker, point, block))
}

/// Time at value zero of the polynomial through (value, time): Neville's scheme.
fn inverse_at_zero(nodes: &[CrossingNode]) -> Option<f64> {
    let x: Vec<f64> = nodes.iter().map(|n| n.value).collect();
    let mut p: Vec<f64> = nodes.iter().map(|n| n.point.time).collect();
    for level in 1..nodes.len() {
        for i in 0..nodes.len() - level {
            p[i] = (x[i + level] * p[i] - x[i] * p[i + 1]) / (x[i + level] - x[i]);
        }
    }
    p[0].is_finite().then_some(p[0])
}
