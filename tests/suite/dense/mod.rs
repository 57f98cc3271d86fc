//! An independent reference for clearances: its own solids, its own nearest points (Gilbert, Johnson and Keerthi), nothing of
//! the crate.

use glam::{DMat3, DVec3};

/// Points within `radius` of the convex hull of something.
#[derive(Clone, Debug)]
pub enum Solid {
    /// Points: sphere, capsule, box, mesh of one.
    Hull(Vec<DVec3>, f64),
    /// Discs of these radii around two points.
    Discs([DVec3; 2], [f64; 2]),
    /// A torus around z of the given centre: ring, tube.
    Ring(DVec3, f64, f64),
    /// Everything below z = 0.
    Ground,
    /// All of these together.
    Union(Vec<Solid>),
}

/// A pose: rotation and shift.
#[derive(Clone, Copy, Debug)]
pub struct Place(pub DMat3, pub DVec3);

impl Place {
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.0 * p + self.1
    }
}

const AXIS_STEPS: usize = 24;

/// Whether circles are searched to rounding, or on a grid only.
#[derive(Clone, Copy, PartialEq)]
pub enum Fine {
    Yes,
    No,
}

impl Solid {
    fn support(&self, place: &Place, n: DVec3) -> DVec3 {
        let local = place.0.transpose() * n;
        let best = match self {
            Self::Hull(points, _) => points
                .iter()
                .copied()
                .max_by(|p, q| p.dot(local).total_cmp(&q.dot(local)))
                .unwrap(),
            Self::Discs(ends, radii) => {
                let axis = (ends[1] - ends[0]).normalize();
                // Twice: what is left of a direction along the axis is rounding.
                let square = |v: DVec3| (v - axis * v.dot(axis)).normalize_or_zero();
                let across = square(square(local));
                let rims = [0, 1].map(|k| ends[k] + across * radii[k]);
                if rims[0].dot(local) > rims[1].dot(local) {
                    rims[0]
                } else {
                    rims[1]
                }
            }
            Self::Ring(..) | Self::Ground | Self::Union(_) => unreachable!(),
        };
        place.point(best)
    }

    fn radius(&self) -> f64 {
        match self {
            Self::Hull(_, r) => *r,
            Self::Ring(_, _, tube) => *tube,
            _ => 0.0,
        }
    }

    /// The lowest point's height.
    fn lowest(&self, place: &Place) -> f64 {
        match self {
            Self::Ring(centre, ring, tube) => {
                let axis = place.0 * DVec3::Z;
                place.point(*centre).z - ring * (1.0 - axis.z * axis.z).max(0.0).sqrt() - tube
            }
            Self::Union(parts) => {
                let lowest = parts.iter().map(|part| part.lowest(place));
                lowest.fold(f64::INFINITY, f64::min)
            }
            _ => self.support(place, -DVec3::Z).z - self.radius(),
        }
    }
}

/// The distance of two solids; zero or less where they meet (how deep is not told).
pub fn distance(a: (&Solid, &Place), b: (&Solid, &Place), fine: Fine) -> f64 {
    let least = |parts: &[Solid], of: &dyn Fn(&Solid) -> f64| {
        parts.iter().map(of).fold(f64::INFINITY, f64::min)
    };
    match (a.0, b.0) {
        (Solid::Union(parts), _) => least(parts, &|part| distance((part, a.1), b, fine)),
        (_, Solid::Union(parts)) => least(parts, &|part| distance(a, (part, b.1), fine)),
        (Solid::Ground, _) => b.0.lowest(b.1),
        (_, Solid::Ground) => a.0.lowest(a.1),
        (Solid::Ring(centre, ring, tube), _) => from_ring((*centre, *ring), a.1, b, fine) - tube,
        (_, Solid::Ring(centre, ring, tube)) => from_ring((*centre, *ring), b.1, a, fine) - tube,
        _ => cores(a, b) - a.0.radius() - b.0.radius(),
    }
}

/// From a circle to a solid: the least over the angle, by a grid and golden sections around its lowest places.
fn from_ring(
    (centre, ring): (DVec3, f64),
    place: &Place,
    other: (&Solid, &Place),
    fine: Fine,
) -> f64 {
    let at = |angle: f64| {
        let point = place.point(centre + DVec3::new(angle.cos(), angle.sin(), 0.0) * ring);
        let probe = Solid::Hull(vec![point], 0.0);
        let still = Place(DMat3::IDENTITY, DVec3::ZERO);
        distance((&probe, &still), other, fine)
    };
    let step = std::f64::consts::TAU / AXIS_STEPS as f64;
    let values: Vec<f64> = (0..AXIS_STEPS).map(|k| at(step * k as f64)).collect();
    if fine == Fine::No {
        return values.into_iter().fold(f64::INFINITY, f64::min);
    }
    let mut order: Vec<usize> = (0..AXIS_STEPS).collect();
    order.sort_by(|p, q| values[*p].total_cmp(&values[*q]));
    let places = order.into_iter().take(3);
    let least = places.map(|k| golden(step * (k as f64 - 1.0), step * (k as f64 + 1.0), &at));
    least.map(|(_, value)| value).fold(f64::INFINITY, f64::min)
}

/// The least value of a function with one valley, and where it is.
pub fn golden(mut low: f64, mut high: f64, f: &impl Fn(f64) -> f64) -> (f64, f64) {
    let share = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..36 {
        let (a, b) = (high - share * (high - low), low + share * (high - low));
        if f(a) < f(b) { high = b } else { low = a }
    }
    let at = 0.5 * (low + high);
    (at, f(at))
}

/// Distance of the convex cores: of three searches one that is proved, since some end at a face that is flat.
fn cores(a: (&Solid, &Place), b: (&Solid, &Place)) -> f64 {
    let found = DVec3::AXES.map(|start| cores_from(start, a, b));
    let proved = found.iter().find(|nearest| {
        let n = nearest.normalize_or_zero();
        let plane = n.dot(a.0.support(a.1, -n) - b.0.support(b.1, n));
        (nearest.length() - plane).abs() < 1e-9
    });
    // A point of the difference is no nearer than the nearest one.
    proved.map_or_else(
        || found.map(DVec3::length).into_iter().fold(0.0, f64::max),
        |n| n.length(),
    )
}

/// The point of the difference of two cores nearest to the origin.
fn cores_from(start: DVec3, a: (&Solid, &Place), b: (&Solid, &Place)) -> DVec3 {
    let support = |n: DVec3| a.0.support(a.1, n) - b.0.support(b.1, -n);
    let mut simplex = [support(start); 4];
    let (mut count, mut nearest) = (1, simplex[0]);
    for _ in 0..200 {
        let length = nearest.length();
        if length < 1e-13 {
            return DVec3::ZERO;
        }
        let next = support(-nearest);
        // The gap between what is known from both sides.
        if nearest.dot(nearest) - nearest.dot(next) <= 1e-13 * length * length.max(1.0) {
            break;
        }
        simplex[count] = next;
        let (point, kept) = nearest_of(&simplex[..=count]);
        if point.length() >= length {
            break;
        }
        let mut corners = [DVec3::ZERO; 4];
        let chosen = (0..=count)
            .filter(|k| kept >> k & 1 == 1)
            .map(|k| simplex[k]);
        count = 0;
        for corner in chosen {
            corners[count] = corner;
            count += 1;
        }
        if count == 4 {
            return DVec3::ZERO;
        }
        (nearest, simplex) = (point, corners);
    }
    nearest
}

/// The point of a simplex nearest to the origin, and the corners that it lies between as bits: the best of all faces.
fn nearest_of(simplex: &[DVec3]) -> (DVec3, u32) {
    let mut best = (DVec3::splat(f64::INFINITY), 0);
    for mask in 1_u32..1 << simplex.len() {
        let mut corners = [DVec3::ZERO; 4];
        let mut count = 0;
        for (k, corner) in simplex.iter().enumerate() {
            if mask >> k & 1 == 1 {
                corners[count] = *corner;
                count += 1;
            }
        }
        if let Some(point) = foot(&corners[..count])
            && point.length() < best.0.length()
        {
            best = (point, mask);
        }
    }
    best
}

/// A face or a tetrahedron is flat if its content is this part of what its edges could span: its foot is rounding then.
const FLAT: f64 = 1e-11;

/// The foot of the origin on a face, if it lies within it.
fn foot(c: &[DVec3]) -> Option<DVec3> {
    let inside = |shares: &[f64]| shares.iter().all(|s| *s >= -1e-12);
    match c {
        [a] => Some(*a),
        [a, b] => {
            let way = *b - *a;
            let t = -a.dot(way) / way.length_squared();
            inside(&[t, 1.0 - t]).then(|| *a + way * t)
        }
        [a, b, c] => {
            let (u, v) = (*b - *a, *c - *a);
            let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
            let (p, q) = (-a.dot(u), -a.dot(v));
            let det = uu * vv - uv * uv;
            // Of a flat face the edges tell.
            if det <= FLAT * uu * vv {
                return None;
            }
            let (s, t) = ((p * vv - q * uv) / det, (q * uu - p * uv) / det);
            inside(&[s, t, 1.0 - s - t]).then(|| *a + u * s + v * t)
        }
        [a, b, c, d] => {
            let m = DMat3::from_cols(*b - *a, *c - *a, *d - *a);
            let shares = m.inverse() * -*a;
            let all = [shares.x, shares.y, shares.z, 1.0 - shares.element_sum()];
            let size = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
            let is_flat = m.determinant().abs() <= FLAT * size;
            (!is_flat && inside(&all)).then_some(DVec3::ZERO)
        }
        _ => None,
    }
}
