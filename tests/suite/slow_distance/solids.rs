//! Cores in either arithmetic: the signed distance of a point, and the farthest point in a direction.

use super::number::{Number, Vector};
use mechanim::distance::primitive::{Element, Primitive};

/// A core; unit vectors are made unit in its own arithmetic.
pub enum Solid<N> {
    Point(Vector<N>),
    Segment([Vector<N>; 2]),
    Triangle([Vector<N>; 3]),
    Circle(Circle<N>),
    Box {
        centre: Vector<N>,
        axes: [Vector<N>; 3],
        half: [N; 3],
    },
    Frustum {
        from: Vector<N>,
        axis: Vector<N>,
        length: N,
        radii: [N; 2],
    },
    HalfSpace {
        point: Vector<N>,
        normal: Vector<N>,
    },
}

/// A circle with two directions in its plane.
#[derive(Clone, Copy)]
pub struct Circle<N> {
    pub centre: Vector<N>,
    pub axis: Vector<N>,
    pub across: [Vector<N>; 2],
    pub radius: N,
}

impl<N: Number> Solid<N> {
    /// The core of an element; meshes are not known here.
    pub fn of(element: &Element) -> Self {
        let one = Vector::<N>::of;
        match &element.core {
            Primitive::Point(p) => Self::Point(one(*p)),
            Primitive::Segment([a, b]) => Self::Segment([one(*a), one(*b)]),
            Primitive::Circle(c) => {
                let axis = one(c.axis).unit();
                let x = axis.cross(one(c.axis.any_orthonormal_vector())).unit();
                Self::Circle(Circle {
                    centre: one(c.centre),
                    axis,
                    across: [x, axis.cross(x)],
                    radius: N::from(c.radius),
                })
            }
            Primitive::Box(b) => {
                let r = b.from_box.rotation;
                Self::Box {
                    centre: one(b.from_box.translation),
                    axes: [r.x_axis, r.y_axis, r.z_axis].map(|a| one(a).unit()),
                    half: b.half.to_array().map(N::from),
                }
            }
            Primitive::Frustum(f) => Self::Frustum {
                from: one(f.from),
                axis: one(f.axis).unit(),
                length: N::from(f.length),
                radii: f.radii.map(N::from),
            },
            Primitive::HalfSpace(h) => Self::HalfSpace {
                point: one(h.point),
                normal: one(h.normal).unit(),
            },
            Primitive::Triangle(corners) => Self::Triangle(corners.map(one)),
            Primitive::Mesh(..) => panic!("a mesh is given triangle by triangle"),
        }
    }

    /// Signed distance of a point from the core.
    pub fn to_point(&self, p: Vector<N>) -> N {
        let zero = N::from(0.0);
        match self {
            Self::Point(q) => (p - *q).length(),
            Self::Segment(ends) => to_segment(*ends, p),
            Self::Triangle([a, b, c]) => {
                let (u, v, w) = (*b - *a, *c - *a, p - *a);
                let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
                let (wu, wv, size) = (w.dot(u), w.dot(v), uu * vv - uv * uv);
                let s = (wu * vv - wv * uv).over(size);
                let t = (wv * uu - wu * uv).over(size);
                let rest = N::from(1.0) - s - t;
                if [s, t, rest].iter().all(|share| share.rounded() >= 0.0) {
                    return (w - u * s - v * t).length();
                }
                let edges = [[*a, *b], [*b, *c], [*c, *a]].map(|edge| to_segment(edge, p));
                edges[0].lesser(edges[1]).lesser(edges[2])
            }
            Self::Circle(c) => {
                let offset = p - c.centre;
                let height = offset.dot(c.axis);
                let out = (offset - c.axis * height).length() - c.radius;
                (out * out + height * height).root()
            }
            Self::Box { centre, axes, half } => {
                let offset = p - *centre;
                let beyond: [N; 3] = std::array::from_fn(|k| offset.dot(axes[k]).size() - half[k]);
                let [x, y, z] = beyond;
                let out = Vector(beyond.map(|b| b.greater(zero))).length();
                out + x.greater(y).greater(z).lesser(zero)
            }
            Self::Frustum {
                from,
                axis,
                length,
                radii,
            } => {
                let offset = p - *from;
                let height = offset.dot(*axis);
                let rho = (offset - *axis * height).length();
                to_profile([rho, height], *length, *radii)
            }
            Self::HalfSpace { point, normal } => normal.dot(p - *point),
        }
    }

    /// The point of a bounded convex core that lies farthest along `n`, which need not be a unit vector.
    pub fn farthest(&self, n: Vector<N>) -> Vector<N> {
        match self {
            Self::Point(p) => *p,
            Self::Segment([a, b]) => {
                if n.dot(*a).is_below(n.dot(*b)) {
                    *b
                } else {
                    *a
                }
            }
            Self::Triangle([a, b, c]) => {
                let higher = |p: &Vector<N>, q: &Vector<N>| {
                    if n.dot(*p).is_below(n.dot(*q)) {
                        *q
                    } else {
                        *p
                    }
                };
                higher(&higher(a, b), c)
            }
            Self::Circle(c) => farthest_of_rim(c.centre, c.axis, c.radius, n),
            Self::Box { centre, axes, half } => {
                let side = |k: usize| {
                    let along = n.dot(axes[k]).rounded();
                    axes[k] * if along < 0.0 { -half[k] } else { half[k] }
                };
                *centre + side(0) + side(1) + side(2)
            }
            Self::Frustum {
                from,
                axis,
                length,
                radii,
            } => {
                let low = farthest_of_rim(*from, *axis, radii[0], n);
                let high = farthest_of_rim(*from + *axis * *length, *axis, radii[1], n);
                if n.dot(low).is_below(n.dot(high)) {
                    high
                } else {
                    low
                }
            }
            Self::HalfSpace { .. } => panic!("a half-space has no farthest point"),
        }
    }
}

fn to_segment<N: Number>([a, b]: [Vector<N>; 2], p: Vector<N>) -> N {
    let span = b - a;
    let t = (p - a).dot(span).over(span.dot(span));
    let t = t.greater(N::from(0.0)).lesser(N::from(1.0));
    (p - a - span * t).length()
}

fn farthest_of_rim<N: Number>(
    centre: Vector<N>,
    axis: Vector<N>,
    radius: N,
    n: Vector<N>,
) -> Vector<N> {
    // Twice: next to the axis the first remainder is mostly rounding, and must lie in the rim's plane all the same.
    let across = n - axis * n.dot(axis);
    let across = across - axis * across.dot(axis);
    let length = across.length();
    if length.rounded() == 0.0 {
        return centre;
    }
    centre + across * radius.over(length)
}

/// Signed distance of the point (radius, height) from a trapezium: the three sides that the axis does not lie on.
fn to_profile<N: Number>([rho, height]: [N; 2], length: N, radii: [N; 2]) -> N {
    let zero = N::from(0.0);
    let corners = [
        [zero, zero],
        [radii[0], zero],
        [radii[1], length],
        [zero, length],
    ];
    let mut least: Option<N> = None;
    let mut is_inside = true;
    for pair in corners.windows(2) {
        let [[ax, ay], [bx, by]] = [pair[0], pair[1]];
        let (ux, uy, px, py) = (bx - ax, by - ay, rho - ax, height - ay);
        let square = ux * ux + uy * uy;
        if square.rounded() == 0.0 {
            continue;
        }
        is_inside &= (uy * px - ux * py).rounded() <= 0.0;
        let t = (px * ux + py * uy).over(square);
        let t = t.greater(zero).lesser(N::from(1.0));
        let (dx, dy) = (px - ux * t, py - uy * t);
        let away = (dx * dx + dy * dy).root();
        least = Some(least.map_or(away, |least| least.lesser(away)));
    }
    let away = least.unwrap_or(zero);
    if is_inside { -away } else { away }
}
