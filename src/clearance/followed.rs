//! Lower and upper bounds of the distance from a circle of a point or circle that moves, to third order in the time.
//!
//! On the path q + u X + u² Y of a point, -1 ≤ u ≤ 1, the distance f from the fixed circle is the parabola through f₋, f₀ and f₊,
//! its values at both ends and in the middle, but for max |f'''| / (9 √3). The parabola is never below
//! min(f₋, f₊, f₀ - |f₊ - f₋| / 2) and never above max(f₀, (f₋ + f₊) / 2) + |f₊ - f₋| / 2.
//!
//! With n the gradient of f, t the direction around the circle's line, φ that along it, and a and b the components of n and t off the axis,
//! D³f(v, v, v) = -3 vₙ vₜ² / f² + 3 b vₜ vᵩ² / (f ρ) - 3 a (a vₙ + b vₜ) vᵩ² / ρ², where ρ is the distance from the axis. With R the
//! circle's radius |a| = |R - ρ| / f ≤ k ρ / f, k = max(1, R / ρ). No product of a component and the square of another one exceeds 2 / (3 √3).
//! So |D³f| ≤ 2 / √3 (1 / f² + (1 + k) / (f ρ)) and |D²f| ≤ k / f.
//!
//! A circle may turn about its own axis without changing anything. Its paths follow the nearest point along it: on
//! others f₊ - f₋ would grow along the circle with the first power of the time, and its least value be missed by the second.

use super::meeting::Meeting;
use super::relative::RelativeMove;
use crate::distance::curve_bend::CurveBend;
use crate::distance::point::{beside_circle, to_circle};
use crate::distance::primitive::{Circle, Primitive};
use crate::distance::search::{CurveSpot, Nearness, Spot, least_on_circle, lowest_of_bent};
use crate::math::sin_cos;
use glam::DVec3;

/// Slightly more than 1 / (9 √3).
const PARABOLA: f64 = 0.0642;

/// Slightly more than 2 / √3.
const CUBIC: f64 = 1.1548;

/// Angle over which the change of the slope along a circle is taken, in radians.
const BESIDE: f64 = 0.01;

/// A circle is not turned by more than this to follow the nearest point, in radians.
const MOST_TURN: f64 = 0.5;

/// The paths of a point or of the points of a circle beside a fixed circle.
pub struct Followed<'a> {
    still: &'a Circle,
    moved: &'a RelativeMove,
}

impl<'a> Followed<'a> {
    pub fn new(still: &'a Circle, moved: &'a RelativeMove) -> Self {
        Self { still, moved }
    }

    /// How much the distance differs from the parabola: `off_axis` and `apart` are the least distances from the fixed circle's
    /// axis and from the circle itself on the paths of a ball.
    pub fn lost(&self, ball: (DVec3, f64), off_axis: f64, apart: f64) -> f64 {
        if !(off_axis > 0.0 && apart > 0.0) {
            return f64::INFINITY;
        }
        let bending = self.moved.bending(ball);
        let speed = self.moved.distance(ball) + bending;
        let flat = (self.still.radius / off_axis).max(1.0);
        let cubic = CUBIC * (1.0 / apart + (1.0 + flat) / off_axis) * speed.powi(3);
        let third = (cubic + 6.0 * flat * speed * bending) / apart;
        PARABOLA * third + self.moved.deviation(ball)
    }

    /// The distances along the path of a point of a curve with this tangent.
    fn spot(&self, at: f64, q: DVec3, tangent: DVec3) -> PathSpot {
        let (rate, turned) = (self.moved.rate(q), self.moved.spin.cross(tangent));
        let (bend, bent) = (self.moved.bend_of(q), self.moved.twist * tangent);
        let spot = |q: DVec3, tangent: DVec3| {
            let (hit, off_axis) = beside_circle(self.still, q);
            let (value, slope) = (hit.distance, hit.normal.dot(tangent));
            (CurveSpot { at, value, slope }, off_axis)
        };
        let (back, off_back) = spot(q - rate + bend, tangent - turned + bent);
        let (here, off_here) = spot(q, tangent);
        let (ahead, off_ahead) = spot(q + rate + bend, tangent + turned + bent);
        PathSpot {
            back,
            here,
            ahead,
            off_axis: [off_back, off_here, off_ahead],
        }
    }

    /// The parabola of a point is nowhere lower, and nowhere higher.
    pub fn of_point(&self, q: DVec3) -> [f64; 2] {
        let spot = self.spot(0.0, q, DVec3::ZERO);
        let [back, here, ahead] = [spot.back.value, spot.here.value, spot.ahead.value];
        let odd = 0.5 * (ahead - back).abs();
        let low = back.min(ahead).min(here - odd);
        [low, here.max(0.5 * (back + ahead)) + odd]
    }

    /// The parabolas of a circle's points, which move no farther than `way`, are nowhere lower.
    pub fn of_circle(&self, circle: &Circle, way: f64, nearness: Nearness) -> f64 {
        let [x, y] = circle.directions().map(|d| d * circle.radius);
        let bends = PathBends::new(self, circle, way);
        let lowest = |a: &PathSpot, b: &PathSpot| bends.lowest_between(a, b);
        let at = |angle: f64, (sin, cos): (f64, f64)| {
            let (q, tangent) = (circle.centre + x * cos + y * sin, y * cos - x * sin);
            self.spot(angle, q, tangent)
        };
        least_on_circle(lowest, nearness, at).floor
    }
}

/// Distances along the path of a point of a curve: at both ends and in the middle.
#[derive(Clone, Copy)]
struct PathSpot {
    back: CurveSpot,
    here: CurveSpot,
    ahead: CurveSpot,
    /// How far these points are from the axis of the fixed circle.
    off_axis: [f64; 3],
}

impl PathSpot {
    /// here + (from - to) / 2, with slopes.
    fn leaning(&self, from: &CurveSpot, to: &CurveSpot) -> CurveSpot {
        CurveSpot {
            at: self.here.at,
            value: self.here.value + 0.5 * (from.value - to.value),
            slope: self.here.slope + 0.5 * (from.slope - to.slope),
        }
    }
}

impl Spot for PathSpot {
    fn place(&self) -> CurveSpot {
        let leaning = match self.ahead.value > self.back.value {
            true => self.leaning(&self.back, &self.ahead),
            false => self.leaning(&self.ahead, &self.back),
        };
        let least = |a: CurveSpot, b: CurveSpot| if b.value < a.value { b } else { a };
        [self.back, self.ahead].into_iter().fold(leaning, least)
    }
}

/// The bounds of curvature along a circle at one end of its paths, in the middle and at the other end.
struct PathBends([CurveBend; 3]);

impl PathBends {
    fn new(followed: &Followed, circle: &Circle, way: f64) -> Self {
        let (still, moved) = (Some(followed.still), followed.moved);
        let here = CurveBend::of_circle(still, circle);
        let [spin, twist] = moved.turning();
        let there = CurveBend::elsewhere(still, &here, 1.0 + spin + twist, way);
        let core = Primitive::Circle(*followed.still);
        let [x, y] = circle.directions().map(|d| d * circle.radius);
        Self([-1.0, 0.0, 1.0].map(|u| {
            let placed = |q: DVec3| q + moved.rate(q) * u + moved.bend_of(q) * (u * u);
            let centre = placed(circle.centre);
            let axes = [x, y].map(|axis| placed(circle.centre + axis) - centre);
            let plain = if u == 0.0 { here } else { there };
            plain.beside(&core, centre, axes)
        }))
    }

    /// Nowhere between two places is any of the four functions lower whose least is searched.
    fn lowest_between(&self, a: &PathSpot, b: &PathSpot) -> f64 {
        let wide = b.here.at - a.here.at;
        let beside = |k: usize| {
            Between::new(
                self.0[k].beside_axis([a.off_axis[k], b.off_axis[k]], wide),
                [[a.back, a.here, a.ahead][k], [b.back, b.here, b.ahead][k]],
            )
        };
        let [back, here, ahead] = [0, 1, 2].map(beside);
        let falling = here.lowest_leaning(&back, &ahead);
        let rising = here.lowest_leaning(&ahead, &back);
        let ends = back.lowest().min(ahead.lowest());
        ends.min(falling).min(rising)
    }
}

/// A distance between two places of a curve.
struct Between {
    bend: CurveBend,
    ends: [CurveSpot; 2],
    /// The bound on its downward curvature.
    bends: Option<f64>,
}

impl Between {
    fn new(bend: CurveBend, ends: [CurveSpot; 2]) -> Self {
        let bends = bend.between(&ends[0], &ends[1]);
        Self { bend, ends, bends }
    }

    fn lowest(&self) -> f64 {
        self.bend.lowest_between(&self.ends[0], &self.ends[1])
    }

    /// Lower bound of this one + (from - to) / 2: two functions above their tangents and one below its chord, but for what they
    /// bend down.
    fn lowest_leaning(&self, from: &Self, to: &Self) -> f64 {
        let [first, second] = &to.ends;
        let plain = self.lowest() + 0.5 * (from.lowest() - to.bend.highest_between(first, second));
        let (Some(own), Some(of_from), Some(of_to)) = (self.bends, from.bends, to.bends) else {
            return plain;
        };
        let wide = second.at - first.at;
        let rise = (second.value - first.value) / wide;
        let above_chord = |k: usize| CurveSpot {
            at: self.ends[k].at,
            value: self.ends[k].value + 0.5 * (from.ends[k].value - to.ends[k].value),
            slope: self.ends[k].slope + 0.5 * (from.ends[k].slope - rise),
        };
        let bent = lowest_of_bent(own + 0.5 * of_from, &above_chord(0), &above_chord(1));
        plain.max(bent - 0.0625 * of_to * wide * wide)
    }
}

/// The motion of a meeting in which a circle also turns about its own axis, so that its nearest point to another circle stays
/// where it is on it, to first order.
pub fn following(meeting: &Meeting) -> RelativeMove {
    let Meeting { a, b, moved, .. } = *meeting;
    let (Primitive::Circle(still), Primitive::Circle(circle)) = (&a.core, &b.core) else {
        return *moved;
    };
    let radial = meeting.core_points()[1] - circle.centre;
    let tangent = circle.axis.cross(radial);
    let beside = |angle: f64| {
        let (sin, cos) = sin_cos(angle);
        let place = circle.centre + radial * cos + tangent * sin;
        to_circle(still, place)
            .normal
            .dot(tangent * cos - radial * sin)
    };
    let steepens = (beside(BESIDE) - beside(-BESIDE)) / (2.0 * BESIDE);
    let spot = Followed::new(still, moved).spot(0.0, circle.centre + radial, tangent);
    let turn = 0.5 * (spot.back.slope - spot.ahead.slope) / steepens;
    match steepens > 0.0 && turn.abs() <= MOST_TURN {
        true => moved.with_own_turn(circle, turn),
        false => *moved,
    }
}
