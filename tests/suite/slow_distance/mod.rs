//! Signed distances of elements the slow way: searched densely, refined and decided with about 31 digits.
//!
//! None of it is shared with the program but the numbers that describe the elements and the exact sums and products of
//! two f64.

mod circles;
mod directions;
mod number;
mod solids;

use glam::DVec3;
use mechanim::distance::primitive::Element;
use mechanim::numbers::double_double::DoubleDouble;
use number::{Number, Vector};
use solids::Solid;

/// A signed distance, known to lie between two numbers.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    pub low: DoubleDouble,
    pub high: DoubleDouble,
}

impl Known {
    /// How far a number lies outside of the bracket.
    pub fn misses(&self, distance: f64) -> f64 {
        let distance = DoubleDouble::from(distance);
        let below = (self.low - distance).rounded();
        let above = (distance - self.high).rounded();
        below.max(above).max(0.0)
    }

    pub fn width(&self) -> f64 {
        (self.high - self.low).rounded()
    }
}

/// Extent of two elements together: what rounding is measured against.
pub fn size(a: &Element, b: &Element) -> f64 {
    let ((p, r), (q, s)) = (a.bounds(), b.bounds());
    let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
    p.length() + q.length() + finite(r) + finite(s)
}

/// The signed distance, as [`mechanim::distance::pair`] defines it.
pub fn known(a: &Element, b: &Element) -> Known {
    let (first, second) = (Solid::<DoubleDouble>::of(a), Solid::<DoubleDouble>::of(b));
    let radii = DoubleDouble::sum(a.radius, b.radius);
    let [low, high] = match (&first, &second) {
        (Solid::HalfSpace { point, normal }, other)
        | (other, Solid::HalfSpace { point, normal }) => {
            let lowest = other.farthest(-*normal);
            [normal.dot(lowest - *point); 2]
        }
        (Solid::Circle(circle), other) => [of_circle(a, circle, b, other); 2],
        (other, Solid::Circle(circle)) => [of_circle(b, circle, a, other); 2],
        _ => {
            let rough = (Solid::<f64>::of(a), Solid::<f64>::of(b));
            let reach = directions::least([&rough.0, &rough.1], [&first, &second], size(a, b));
            [-reach[1], -reach[0]]
        }
    };
    Known {
        low: low - radii,
        high: high - radii,
    }
}

fn of_circle(
    ring: &Element,
    circle: &solids::Circle<DoubleDouble>,
    other: &Element,
    exact: &Solid<DoubleDouble>,
) -> DoubleDouble {
    let Solid::Circle(rough) = Solid::<f64>::of(ring) else {
        panic!("a ring's core is a circle");
    };
    let rough_other = Solid::<f64>::of(other);
    circles::least(&rough, circle, &rough_other, exact)
}

/// How far a point lies inside of an element; negative outside.
pub fn inside_by(element: &Element, point: DVec3) -> f64 {
    let core = Solid::<DoubleDouble>::of(element);
    let away = core.to_point(Vector::of(point)) - DoubleDouble::from(element.radius);
    -away.rounded()
}

/// How much the distance of two points differs from the size of a signed distance.
pub fn off_distance(points: [DVec3; 2], distance: f64) -> f64 {
    let span = Vector::<DoubleDouble>::of(points[1]) - Vector::of(points[0]);
    (span.length() - DoubleDouble::from(distance.abs()))
        .rounded()
        .abs()
}
