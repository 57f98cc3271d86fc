//! How deep two convex cores overlap: the shortest translation that parts them.
//!
//! For a direction n the translation that parts them along n is known exactly from the support functions. The least of
//! these is searched from every direction in which polyhedra can be parted (exact for two boxes), then by a compass
//! search: a translation that is found always parts the cores; that none is shorter is not proved for curved ones (in
//! tests with random pairs it was never 2 % longer).

use super::core::Core;
use super::cores::CorePair;
use crate::math::sin_cos;
use glam::DVec3;

/// Smallest step of the compass search, radians: the translation is then as short as it gets to 1e-9 of the extent.
const SMALLEST_TURN: f64 = 1e-9;

/// How many of the best directions are refined.
const REFINED: usize = 6;

/// Cosine of the angle within which two starts would come to the same end.
const SAME_START: f64 = 0.95;

/// Turns of the compass without success before its step is halved.
const MISSES: u32 = 1;

/// Directions spread evenly over the sphere that are tried beside those of the faces.
const SPREAD: usize = 40;

/// The golden angle, radians: turns that never meet again.
const GOLDEN: f64 = 2.399_963_229_728_653;

/// Directions at right angles to faces, and along edges and axes.
fn directions(core: &Core) -> Vec<DVec3> {
    match core {
        Core::Segment([a, b]) => vec![(*b - *a).normalize_or_zero()],
        Core::Box(block) => {
            let r = block.from_box.rotation;
            vec![r.x_axis, r.y_axis, r.z_axis]
        }
        Core::Frustum(frustum) => vec![frustum.axis],
        Core::Triangle([a, b, c]) => {
            let edges = [*b - *a, *c - *b, *a - *c].map(DVec3::normalize_or_zero);
            let normal = edges[0].cross(edges[1]).normalize_or_zero();
            vec![normal, edges[0], edges[1], edges[2]]
        }
        Core::Point(_) | Core::Circle(_) | Core::HalfSpace(_) | Core::Mesh(..) => Vec::new(),
    }
}

/// Way by which `b` must be moved along `n` to leave `a`.
fn way(a: &Core, b: &Core, n: DVec3) -> f64 {
    match (a.support(n), b.support(-n)) {
        (Some(a), Some(b)) => a + b,
        _ => f64::INFINITY,
    }
}

/// The shortest translation that parts two convex cores; `near` is the pair of points that showed the overlap.
pub fn overlap(a: &Core, b: &Core, near: CorePair) -> CorePair {
    let (first, second) = (directions(a), directions(b));
    let mut tried: Vec<(f64, DVec3)> = Vec::new();
    let mut try_both = |n: DVec3| {
        if let Some(n) = n.try_normalize() {
            tried.push((way(a, b, n), n));
            tried.push((way(a, b, -n), -n));
        }
    };
    for u in &first {
        second.iter().for_each(|v| try_both(u.cross(*v)));
    }
    let between = b.bounds().0 - a.bounds().0;
    for u in first.iter().chain(&second) {
        try_both(*u);
        try_both(between - *u * between.dot(*u));
    }
    try_both(near.normal);
    try_both(between);
    for k in 0..SPREAD {
        // Half a sphere, since both signs are tried.
        let z = (k as f64 + 0.5) / SPREAD as f64;
        let (sin, cos) = sin_cos(GOLDEN * k as f64);
        let across = (1.0 - z * z).sqrt();
        try_both(DVec3::new(across * cos, across * sin, z));
    }
    tried.sort_by(|p, q| p.0.total_cmp(&q.0));
    let mut starts: Vec<(f64, DVec3)> = Vec::new();
    for t in tried {
        if starts.len() < REFINED && starts.iter().all(|s| s.1.dot(t.1) < SAME_START) {
            starts.push(t);
        }
    }
    let refined = starts.iter().map(|t| refine(a, b, *t));
    let best = refined.fold(
        (f64::INFINITY, DVec3::Z),
        |p, q| if q.0 < p.0 { q } else { p },
    );
    CorePair {
        distance: -best.0.max(0.0),
        points: near.points,
        normal: best.1,
    }
}

/// Turns the direction while that shortens the way.
fn refine(a: &Core, b: &Core, start: (f64, DVec3)) -> (f64, DVec3) {
    let mut best = start;
    let mut turn = 0.2;
    let (mut twist, mut misses) = (0.0, 0);
    while turn > SMALLEST_TURN {
        let (u, v) = best.1.any_orthonormal_pair();
        // The compass turns too, so that it does not get caught between two faces.
        twist += 0.7;
        let (sin, cos) = sin_cos(twist);
        let (p, q) = (u * cos + v * sin, v * cos - u * sin);
        let compass = [
            p,
            q,
            (p + q) * std::f64::consts::FRAC_1_SQRT_2,
            (p - q) * std::f64::consts::FRAC_1_SQRT_2,
        ];
        let mut better = best;
        for d in compass.into_iter().flat_map(|d| [d, -d]) {
            let n = (best.1 + d * turn).normalize();
            let way = way(a, b, n);
            if way < better.0 {
                better = (way, n);
            }
        }
        if better.0 < best.0 {
            (best, misses) = (better, 0);
        } else if misses < MISSES {
            misses += 1;
        } else {
            (turn, misses) = (0.5 * turn, 0);
        }
    }
    best
}
