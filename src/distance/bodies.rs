//! Distance of two bodies: the minimum over all pairs of their elements.

use super::mesh;
use super::mesh_tree::{MeshTrees, ShellEnclosure};
use super::pair::{Proximity, signed_distance_below};
use super::point::point_to;
use super::primitive::{Element, Primitive, shape_elements};
use crate::math::Pose;
use crate::model::mechanism::Body;
use crate::sorting::sort_by_number;
use glam::DVec3;
use std::collections::BTreeSet;

/// A body's elements in its frame, and a ball around them.
#[derive(Clone, Debug)]
pub struct BodyElements {
    /// The elements.
    pub elements: Vec<Element>,
    /// Centre and radius of the ball.
    pub ball: (DVec3, f64),
}

/// The nearest, or deepest, elements of two bodies.
#[derive(Clone, Copy, Debug)]
pub struct BodyProximity {
    /// Their nearest points, in the first body's frame.
    pub proximity: Proximity,
    /// The indices of the elements.
    pub elements: [usize; 2],
}

impl BodyProximity {
    /// The nearer of two pairs of elements; of neither anything is nearer than what it then tells.
    pub fn or(self, other: Self) -> Self {
        let lowest = self.proximity.lowest().min(other.proximity.lowest());
        let mut nearer = match other.proximity.distance < self.proximity.distance {
            true => other,
            false => self,
        };
        // The difference of infinite distances is no number.
        nearer.proximity.missed = (nearer.proximity.distance - lowest).max(0.0);
        nearer
    }
}

impl BodyElements {
    /// The hull of a body; `None` if it has no solids.
    pub fn new(body: &Body) -> Option<Self> {
        Self::with_trees(body, &mut MeshTrees::default())
    }

    /// The hulls of several bodies, which share the trees of their meshes.
    pub fn of_bodies<'b>(bodies: impl IntoIterator<Item = &'b Body>) -> Vec<Option<Self>> {
        let mut trees = MeshTrees::default();
        let bodies = bodies.into_iter();
        bodies
            .map(|body| Self::with_trees(body, &mut trees))
            .collect()
    }

    /// The same body with every element made smaller about its own centre, so that no point moves farther than a length.
    pub fn smaller(&self, by: f64) -> Self {
        let elements = self.elements.iter();
        Self {
            elements: elements.map(|element| element.smaller(by)).collect(),
            ball: self.ball,
        }
    }

    fn with_trees(body: &Body, trees: &mut MeshTrees) -> Option<Self> {
        let elements = shape_elements(&body.shapes, trees);
        let balls: Vec<(DVec3, f64)> = elements.iter().map(Element::bounds).collect();
        let low = balls.iter().map(|(c, r)| *c - *r).reduce(DVec3::min)?;
        let high = balls.iter().map(|(c, r)| *c + *r).reduce(DVec3::max)?;
        let centre = (low + high) * 0.5;
        if !centre.is_finite() {
            let ball = (DVec3::ZERO, f64::INFINITY);
            return Some(Self { elements, ball });
        }
        let far = balls.iter().map(|(c, r)| c.distance(centre) + r);
        Some(Self {
            ball: (centre, far.fold(0.0, f64::max)),
            elements,
        })
    }

    /// Pairs of elements of two hulls that belong to the given pairs of shapes.
    pub fn pairs_of<'h>(
        hulls: [&'h Self; 2],
        is_wanted: impl Fn([usize; 2]) -> bool + Copy + 'h,
    ) -> impl Iterator<Item = [usize; 2]> + 'h {
        let [first, second] = hulls.map(|hull| hull.elements.iter().enumerate());
        first.flat_map(move |(i, a)| {
            let wanted = second
                .clone()
                .filter(move |(_, b)| is_wanted([a.shape, b.shape]));
            wanted.map(move |(j, _)| [i, j])
        })
    }

    /// Whether a mesh is among its elements.
    pub fn has_mesh(&self) -> bool {
        self.elements
            .iter()
            .any(|e| matches!(e.core, Primitive::Mesh(..)))
    }

    /// Whether one of its meshes should have an inside and has none.
    pub fn is_open(&self) -> bool {
        let is_open = |e: &Element| {
            matches!(&e.core, Primitive::Mesh(tree, _)
                if matches!(tree.enclosure, ShellEnclosure::Open | ShellEnclosure::Tangled))
        };
        self.elements.iter().any(is_open)
    }

    /// Lower bound of the distance from another hull placed by `here_from_other`.
    pub fn apart(&self, other: &Self, here_from_other: &Pose) -> f64 {
        let centre = here_from_other.transform_point(other.ball.0);
        centre.distance(self.ball.0) - self.ball.1 - other.ball.1
    }
}

/// Lower bound of the distance of two elements in one frame; the computation stops once it reaches `enough`.
pub fn sphere_separation(a: &Element, b: &Element, enough: f64) -> f64 {
    ball_separation([(a, a.bounds()), (b, b.bounds())], enough)
}

/// The same for elements with known bounding balls.
pub fn ball_separation(
    [(a, (p, r)), (b, (q, s))]: [(&Element, (DVec3, f64)); 2],
    enough: f64,
) -> f64 {
    let mut lowest = p.distance(q) - r - s;
    // Long elements are far larger than they are thick: the distance of the element itself from the other's sphere is
    // sharper.
    for (element, centre, radius) in [(a, q, s), (b, p, r)] {
        if lowest >= enough {
            break;
        }
        let is_ball = matches!(element.core, Primitive::Point(_));
        if let Some(hit) = point_to(&element.core, centre).filter(|_| !is_ball) {
            lowest = lowest.max(hit.distance - element.radius - radius);
        }
    }
    lowest
}

/// Lower bound of the signed distance of two elements in one frame: their separation along the unit vector `n`, from
/// the first to the second. No depth exceeds the translation that separates two elements, in any direction.
pub fn separation_along(a: &Element, b: &Element, n: DVec3) -> f64 {
    match (a.core.support(n), b.core.support(-n)) {
        (Some(reach), Some(back)) => -(reach + back) - a.radius - b.radius,
        _ => f64::NEG_INFINITY,
    }
}

/// Pairs of elements that are excluded.
pub type LeftOut = BTreeSet<[usize; 2]>;

/// The nearest elements of two hulls, without the excluded pairs.
pub fn nearest_bodies(
    a: &BodyElements,
    b: &BodyElements,
    a_from_b: &Pose,
    left_out: &LeftOut,
) -> Option<BodyProximity> {
    let placed: Vec<Element> = b.elements.iter().map(|e| e.moved(a_from_b)).collect();
    // Pairs are sorted by a cheap lower bound, the distance of their bounding spheres.
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, first) in a.elements.iter().enumerate() {
        pairs.extend(
            placed
                .iter()
                .enumerate()
                .filter(|(j, _)| !left_out.contains(&[i, *j]))
                .map(|(j, second)| (sphere_separation(first, second, f64::INFINITY), i, j)),
        );
    }
    sort_by_number(&mut pairs, |p| p.0);
    let mut best: Option<BodyProximity> = None;
    for (lowest, i, j) in pairs {
        // No later pair can be nearer.
        if best.is_some_and(|b| lowest >= b.proximity.distance) {
            break;
        }
        let limit = best.map_or(f64::INFINITY, |b| b.proximity.distance);
        let proximity = signed_distance_below(&a.elements[i], &placed[j], limit);
        let found = BodyProximity {
            proximity,
            elements: [i, j],
        };
        best = Some(best.map_or(found, |best| best.or(found)));
    }
    best
}

/// Whether a mesh of one body encloses a solid of the other without touching it, or the other way round.
pub fn enclosed_shell(
    a: &BodyElements,
    b: &BodyElements,
    a_from_b: &Pose,
    left_out: &LeftOut,
) -> Option<[usize; 2]> {
    for (i, first) in a.elements.iter().enumerate() {
        for (j, second) in b.elements.iter().enumerate() {
            let placed = second.moved(a_from_b);
            if mesh::is_any([first, second])
                && !left_out.contains(&[i, j])
                && sphere_separation(first, &placed, 0.0) < 0.0
                && mesh::one_inside(&first.core, &placed.core)
            {
                return Some([i, j]);
            }
        }
    }
    None
}
