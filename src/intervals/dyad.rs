//! Dyads: two bars and the point that they carry. The velocity of the point is J v + J' v' of those at the bars' other ends.
//!
//! J = [f_y; -f_x] eᵀ / (e × f) and J' = 1 - J, with e and f the bars from those ends to the point: complementary oblique
//! projectors, so that i₄ = 1 - i₁ and i₁ i₄ = i₂ i₃. They have a pole where the bars are in line and nowhere else, whatever
//! tangents in their printed form do.

use super::kaucher::Kaucher;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::{Ring, Scalar};

/// A point with the far ends of its two bars.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dyad {
    /// The point.
    pub point: usize,
    /// The far ends.
    pub ends: [usize; 2],
}

/// Coefficients i₁ i₂ / i₃ i₄ of a matrix.
pub type Coefficients = [f64; 4];

/// J and J' of a point and the far ends of its bars; `None` where these are in line.
pub fn j_matrices(point: [f64; 2], ends: [[f64; 2]; 2]) -> Option<[Coefficients; 2]> {
    let [e, f] = ends.map(|end| [point[0] - end[0], point[1] - end[1]]);
    let cross = e[0] * f[1] - e[1] * f[0];
    let first = [f[1] * e[0], f[1] * e[1], -f[0] * e[0], -f[0] * e[1]].map(|v| v / cross);
    let second = [-e[1] * f[0], -e[1] * f[1], e[0] * f[0], e[0] * f[1]].map(|v| v / cross);
    let is_finite = first.iter().chain(&second).all(|v| v.is_finite());
    is_finite.then_some([first, second])
}

/// The coefficients that positions have in place of velocities, those of the velocity polygon. The source prints i₂' = i₃ and
/// i₃' = i₂, which belongs to a reflection.
pub fn conjugate_coefficients([a, b, c, d]: Coefficients) -> Coefficients {
    [d, -c, -b, a]
}

/// The exact ranges of the coefficients where the first bar has any direction and the second is turned from it by an angle
/// in `delta` (radians), rounded outwards; `None` if the bars can be in line.
///
/// With s = 2 φ + δ free of δ, i₁ = ½ + sin s / (2 sin δ) and i₂ = (cos δ - cos s) / (2 sin δ): every value is taken at an
/// end of δ, or where |sin δ| is least.
pub fn exact_ranges(delta: Kaucher) -> Option<[Kaucher; 4]> {
    let half = Interval::point(0.5);
    let sine = delta.interval().sin_cos().0;
    if sine.holds_zero() {
        return None;
    }
    let reach = |end: f64| half / end_sine(end);
    let wide = [delta.lo, delta.hi].map(|end| {
        let reach = reach(end);
        (half - reach).hull(half + reach)
    });
    let one = wide[0].hull(wide[1]);
    let two = [delta.lo, delta.hi].map(|end| {
        let (sin, cos) = Interval::point(0.5 * end).sin_cos();
        let (tan, cot) = (sin / cos, cos / sin);
        (-tan).scale(0.5).hull(cot.scale(0.5))
    });
    let two = two[0].hull(two[1]);
    Some([one, two, -two, one].map(Kaucher::from))
}

fn end_sine(end: f64) -> Interval {
    Interval::point(end).sin_cos().0
}

/// What interval arithmetic makes of sin φ₁₃ cos φ₁₂ / sin δ and its like, with every angle taken for itself: the same
/// coefficients, overestimated.
pub fn naive_ranges(first: Kaucher, delta: Kaucher) -> Option<[Kaucher; 4]> {
    let (s12, c12) = first.interval().sin_cos();
    let (s13, c13) = (first.interval() + delta.interval()).sin_cos();
    let sine = delta.interval().sin_cos().0;
    if sine.holds_zero() {
        return None;
    }
    let all = [s13 * c12, s13 * s12, -(c13 * c12), -(c13 * s12)];
    Some(all.map(|v| Kaucher::from(v / sine)))
}

/// What interval arithmetic makes of the formulas as they are printed, with tangents of φ₁₂ and φ₁₃: nothing, where the
/// angles can pass a quarter turn.
pub fn printed_ranges(first: Kaucher, delta: Kaucher) -> Kaucher {
    let tangent = |x: Interval| {
        let (sin, cos) = x.sin_cos();
        sin / cos
    };
    let (t12, t13) = (
        tangent(first.interval()),
        tangent(first.interval() + delta.interval()),
    );
    Kaucher::from(t13 / (t13 - t12))
}

/// The linear system of the velocities of a row of dyads: two rows a dyad, v = J v' + J' v'', in unknowns whose columns
/// are two for every point of `unknowns`. Points of `fixed` stand still; what is `known` is on the right.
pub fn velocity_system(
    points: &[[f64; 2]],
    dyads: &[Dyad],
    unknowns: &[usize],
    known: (usize, [f64; 2]),
) -> Option<(Vec<Vec<f64>>, Vec<f64>)> {
    let width = 2 * unknowns.len();
    let (mut rows, mut sides) = (Vec::new(), Vec::new());
    for dyad in dyads {
        let far = dyad.ends.map(|end| points[end]);
        let matrices = j_matrices(points[dyad.point], far)?;
        let mut pair = vec![vec![0.0; width]; 2];
        let column = |point: usize| unknowns.iter().position(|u| *u == point);
        // Unknown velocities stand on the left, so that the row of a known point is J v' + J' v'' = v.
        let sign = if dyad.point == known.0 { 1.0 } else { -1.0 };
        for (end, matrix) in dyad.ends.iter().zip(&matrices) {
            if let Some(k) = column(*end) {
                for row in 0..2 {
                    pair[row][2 * k] += sign * matrix[2 * row];
                    pair[row][2 * k + 1] += sign * matrix[2 * row + 1];
                }
            }
        }
        match column(dyad.point) {
            Some(k) => {
                pair[0][2 * k] += 1.0;
                pair[1][2 * k + 1] += 1.0;
                sides.extend([0.0; 2]);
            }
            None => sides.extend(known.1),
        }
        rows.extend(pair);
    }
    Some((rows, sides))
}

/// Half the side of a cube about velocities in which every choice of them belongs to directions of the bars that are nowhere
/// nearer to each other than `least` (radians): proved by intervals. Points without a radius, `still`, keep theirs.
/// Zero if it fails at the velocities themselves.
pub fn tied_cube(velocities: &[[f64; 2]], still: &[usize], dyads: &[Dyad], least: f64) -> f64 {
    let sine = Interval::point(least).sin_cos().0;
    let fits = |r: f64| {
        let of = |k: usize| {
            let wide = if still.contains(&k) { 0.0 } else { r };
            velocities[k].map(|v| Interval::point(v) + Interval::around_zero(wide))
        };
        dyads.iter().all(|dyad| {
            let v = of(dyad.point);
            let [e, f] = dyad.ends.map(|end| {
                let w = of(end);
                [v[0] - w[0], v[1] - w[1]]
            });
            let cross = e[0] * f[1] - e[1] * f[0];
            let length = |u: [Interval; 2]| (u[0].square() + u[1].square()).sqrt();
            let needed = sine * length(e) * length(f);
            let far = if cross.lo > 0.0 { cross.lo } else { -cross.hi };
            far >= needed.hi
        })
    };
    let (mut low, mut high) = (0.0, 1.0);
    if !fits(low) {
        return 0.0;
    }
    while fits(high) && high < 1e12 {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..60 {
        let middle = 0.5 * low + 0.5 * high;
        match fits(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}
