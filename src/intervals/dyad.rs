//! Dyads: two bars and the point they connect. The velocity of the point is J v + J' v', where v and v' are those of
//! the bars' other ends.
//!
//! J = [f_y; -f_x] eᵀ / (e × f) and J' = 1 - J, with e and f the bars from those ends to the point: complementary
//! oblique projectors, so that i₄ = 1 - i₁ and i₁ i₄ = i₂ i₃. They have a pole where the bars are collinear and nowhere
//! else, unlike the tangents in the printed form.

use super::centre::largest_fitting;
use super::kaucher::Kaucher;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::{Ring, Scalar};
use std::ops::{Add, Mul, Neg};

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

/// J and J' of a point and the far ends of its bars; `None` if these are collinear.
pub fn j_matrices(point: [f64; 2], ends: [[f64; 2]; 2]) -> Option<[Coefficients; 2]> {
    let [e, f] = ends.map(|end| [point[0] - end[0], point[1] - end[1]]);
    let cross = e[0] * f[1] - e[1] * f[0];
    let first = [f[1] * e[0], f[1] * e[1], -f[0] * e[0], -f[0] * e[1]].map(|v| v / cross);
    let second = [-e[1] * f[0], -e[1] * f[1], e[0] * f[0], e[0] * f[1]].map(|v| v / cross);
    let is_finite = first.iter().chain(&second).all(|v| v.is_finite());
    is_finite.then_some([first, second])
}

/// The coefficients for positions instead of velocities, those of the velocity polygon. The source prints i₂' = i₃ and
/// i₃' = i₂, which belongs to a reflection.
pub fn conjugate_coefficients([a, b, c, d]: Coefficients) -> Coefficients {
    [d, -c, -b, a]
}

/// The exact ranges of the coefficients if the first bar has a direction in `first` and the second is rotated from it
/// by an angle in `delta` (radians), rounded outwards; `None` if the bars can be collinear.
///
/// With s = 2 φ + δ, i₁ = ½ + sin s / (2 sin δ) and i₂ = (cos δ - cos s) / (2 sin δ). For a fixed direction both are
/// monotone in δ, so that every extreme is attained at an end of δ.
pub fn exact_ranges(first: Kaucher, delta: Kaucher) -> Option<[Kaucher; 4]> {
    let half = Interval::point(0.5);
    if delta.interval().sin_cos().0.holds_zero() {
        return None;
    }
    let [low, high] = [delta.lo, delta.hi].map(|end| {
        let (sine, cosine) = Interval::point(end).sin_cos();
        let sum = first.interval().scale(2.0) + Interval::point(end);
        let (sin, cos) = sum.sin_cos();
        let shifted = half * sin / sine;
        let two = half * (cosine - cos) / sine;
        let three = -(half * (cosine + cos) / sine);
        [half + shifted, two, three, half - shifted]
    });
    let all = [0, 1, 2, 3].map(|k| low[k].hull(high[k]));
    Some(all.map(Kaucher::from))
}

/// Interval arithmetic for sin φ₁₃ cos φ₁₂ / sin δ and the other coefficients, with independent angles: an
/// overestimate.
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

/// Interval arithmetic for the formulas as printed, with tangents of φ₁₂ and φ₁₃: unbounded if the angles can pass a
/// quarter turn.
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

/// The exact ranges if both bars have directions in intervals of their own, rounded outwards; `None` if they can be
/// collinear. Every coefficient is monotone in each direction whatever the other is, so its extremes are at corners.
pub fn corner_ranges(first: Kaucher, second: Kaucher) -> Option<[Kaucher; 4]> {
    // The bars can be collinear where the sine of the angle between them can vanish.
    let sine = (second.interval() - first.interval()).sin_cos().0;
    if sine.holds_zero() {
        return None;
    }
    let mut found: Option<[Kaucher; 4]> = None;
    for a in [first.lo, first.hi] {
        for b in [second.lo, second.hi] {
            // Each corner is computed with outward rounding and joined to the range.
            let (s12, c12) = Interval::point(a).sin_cos();
            let (s13, c13) = Interval::point(b).sin_cos();
            let cross = s13 * c12 - c13 * s12;
            let here = [s13 * c12, s13 * s12, -(c13 * c12), -(c13 * s12)];
            let here = here.map(|v| Kaucher::from(v / cross));
            found = Some(match found {
                None => here,
                Some(known) => [0, 1, 2, 3].map(|k| known[k].join(here[k])),
            });
        }
    }
    found
}

/// The operations that numbers of a system need.
pub trait SystemNumber:
    Copy + Add<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Exactly this number.
    fn of(value: f64) -> Self;
}

impl SystemNumber for f64 {
    fn of(value: f64) -> Self {
        value
    }
}

impl SystemNumber for Kaucher {
    fn of(value: f64) -> Self {
        Self::point(value)
    }
}

/// The linear system of a sequence of dyads: two rows per dyad, v = J v' + J' v'', with two columns for every point of
/// `unknowns`. All other points have their `values`, which go to the right-hand side.
pub fn dyad_system<T: SystemNumber>(
    matrices: &[[[T; 4]; 2]],
    dyads: &[Dyad],
    unknowns: &[usize],
    values: &[[T; 2]],
) -> (Vec<Vec<T>>, Vec<T>) {
    let width = 2 * unknowns.len();
    let (zero, one) = (T::of(0.0), T::of(1.0));
    let (mut rows, mut sides) = (Vec::new(), Vec::new());
    let column = |point: usize| unknowns.iter().position(|u| *u == point);
    for (dyad, both) in dyads.iter().zip(matrices) {
        let mut pair = vec![vec![zero; width]; 2];
        let own = column(dyad.point);
        // Terms of unknown velocities are on the left, so that the row of a known point is J v' + J' v'' = v.
        let is_unknown = own.is_some();
        let signed = |v: T| if is_unknown { -v } else { v };
        let mut side = match own {
            Some(_) => [zero; 2],
            None => values[dyad.point],
        };
        if let Some(k) = own {
            pair[0][2 * k] = one;
            pair[1][2 * k + 1] = one;
        }
        for (end, matrix) in dyad.ends.iter().zip(both) {
            for row in 0..2 {
                let [a, b] = [matrix[2 * row], matrix[2 * row + 1]].map(signed);
                match column(*end) {
                    Some(k) => {
                        pair[row][2 * k] = pair[row][2 * k] + a;
                        pair[row][2 * k + 1] = pair[row][2 * k + 1] + b;
                    }
                    None => {
                        let [x, y] = values[*end];
                        side[row] = side[row] + -(a * x + b * y);
                    }
                }
            }
        }
        rows.extend(pair);
        sides.extend(side);
    }
    (rows, sides)
}

/// Whether the bars of a dyad are nowhere closer to collinear than an angle with this `sine`, wherever its points are
/// in their boxes: |e x f| compared with sine |e| |f|. `None` if undecided.
pub fn are_apart(point: [Interval; 2], ends: [[Interval; 2]; 2], sine: Interval) -> Option<bool> {
    let [e, f] = ends.map(|end| [point[0] - end[0], point[1] - end[1]]);
    let cross = e[0] * f[1] - e[1] * f[0];
    let length = |u: [Interval; 2]| (u[0].square() + u[1].square()).sqrt();
    let needed = sine * length(e) * length(f);
    let least = if cross.holds_zero() {
        0.0
    } else {
        cross.lo.abs().min(cross.hi.abs())
    };
    if least >= needed.hi && needed.hi > 0.0 {
        return Some(true);
    }
    (cross.magnitude() < needed.lo).then_some(false)
}

/// No cube of velocities is searched beyond this: with nothing in the way all of them fit.
const LARGEST_CUBE: f64 = 1e12;

/// Half the side of a cube of velocities all of which belong to directions of the bars that are nowhere closer to
/// collinear than `least` (radians), proved by intervals. Points without a radius, `still`, keep theirs. Zero if the
/// test fails at the velocities themselves.
pub fn tied_cube(velocities: &[[f64; 2]], still: &[usize], dyads: &[Dyad], least: f64) -> f64 {
    let sine = Interval::point(least).sin_cos().0;
    // Whether all velocities within r of the given ones belong to admissible directions.
    let fits = |r: f64| {
        let of = |k: usize| {
            let wide = if still.contains(&k) { 0.0 } else { r };
            velocities[k].map(|v| Interval::point(v) + Interval::around_zero(wide))
        };
        dyads.iter().all(|dyad| {
            let far = dyad.ends.map(of);
            are_apart(of(dyad.point), far, sine) == Some(true)
        })
    };
    largest_fitting(fits, LARGEST_CUBE).unwrap_or(0.0)
}
