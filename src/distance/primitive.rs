//! The elements that bodies are made of for distances: a core (point, segment, circle, box, frustum, triangle, half-space, mesh)
//! grown by a radius. Holds no distances.
//!
//! A sphere is a grown point, a capsule a grown segment, a torus a grown circle, a tube one grown segment a piece:
//! each of them exactly. Nothing round is replaced by facets.

use super::mesh_tree::{MeshTree, MeshTrees};
use crate::math::{Pose, square_to};
use crate::model::shape::{Shape, Solid};
use glam::DVec3;
use std::cmp::Ordering;
use std::sync::Arc;

/// All points within `radius` of the core. Lengths in the scene's unit.
#[derive(Clone, Debug)]
pub struct Element {
    /// The core.
    pub core: Primitive,
    /// The radius by which it is inflated.
    pub radius: f64,
    /// Index of the body's shape that it represents.
    pub shape: usize,
}

/// A circle in space.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    /// Centre.
    pub centre: DVec3,
    /// Unit normal of its plane.
    pub axis: DVec3,
    /// Radius; zero gives a point.
    pub radius: f64,
}

/// A box: `from_box` maps its own axes, `half` are half edge lengths.
#[derive(Clone, Copy, Debug)]
pub struct BoxCore {
    /// Pose of the box's own frame, origin in the centre.
    pub from_box: Pose,
    /// Half edge lengths.
    pub half: DVec3,
}

/// A flat-ended cylinder or cone frustum.
#[derive(Clone, Copy, Debug)]
pub struct Frustum {
    /// Centre of the first end.
    pub from: DVec3,
    /// Unit vector to the other end.
    pub axis: DVec3,
    /// Distance of the ends.
    pub length: f64,
    /// Radii at both ends.
    pub radii: [f64; 2],
}

/// Everything below a plane.
#[derive(Clone, Copy, Debug)]
pub struct HalfSpace {
    /// A point of the plane.
    pub point: DVec3,
    /// Unit normal, out of the solid.
    pub normal: DVec3,
}

/// The core that an element inflates.
#[derive(Clone, Debug)]
pub enum Primitive {
    /// A point.
    Point(DVec3),
    /// A segment.
    Segment([DVec3; 2]),
    /// A circle (the line, not the disk).
    Circle(Circle),
    /// A solid box.
    Box(BoxCore),
    /// A solid cylinder or frustum.
    Frustum(Frustum),
    /// A flat triangle.
    Triangle([DVec3; 3]),
    /// A half-space, which is unbounded.
    HalfSpace(HalfSpace),
    /// Triangles of a file, placed by a pose.
    Mesh(Arc<MeshTree>, Pose),
}

impl Frustum {
    /// The circles at both ends.
    pub fn rims(&self) -> [Circle; 2] {
        [0, 1].map(|k| Circle {
            centre: self.from + self.axis * (self.length * k as f64),
            axis: self.axis,
            radius: self.radii[k],
        })
    }

    /// The axis between the ends.
    pub fn spine(&self) -> [DVec3; 2] {
        [self.from, self.from + self.axis * self.length]
    }
}

impl Circle {
    /// The unit vector of its plane nearest to `n`; zero along its axis.
    pub fn outward(&self, n: DVec3) -> DVec3 {
        square_to(self.axis, n)
    }

    /// Two unit vectors in its plane, perpendicular to each other.
    pub fn directions(&self) -> [DVec3; 2] {
        let frame = Pose::from_z_axis(self.axis).rotation;
        [frame.x_axis, frame.y_axis]
    }
}

/// Corner `k` of eight, as signs.
fn corner_signs(k: usize) -> DVec3 {
    let sign = |bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
    DVec3::new(sign(1), sign(2), sign(4))
}

/// Indices of corners that are joined by the edges of a box: they differ in one bit.
pub const BOX_EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [2, 3],
    [4, 5],
    [6, 7],
    [0, 2],
    [1, 3],
    [4, 6],
    [5, 7],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

impl BoxCore {
    /// The corners; edges join them as in [`BOX_EDGES`].
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|k| self.from_box.transform_point(self.half * corner_signs(k)))
    }
}

impl Primitive {
    /// The circle, if it is one.
    pub fn circle(&self) -> Option<&Circle> {
        match self {
            Self::Circle(circle) => Some(circle),
            _ => None,
        }
    }

    /// The same core after a motion.
    pub fn moved(&self, pose: &Pose) -> Self {
        // A rigid motion moves points and turns directions; sizes stay.
        let point = |p: &DVec3| pose.transform_point(*p);
        match self {
            Self::Point(p) => Self::Point(point(p)),
            Self::Segment(ends) => Self::Segment(ends.each_ref().map(point)),
            Self::Triangle(corners) => Self::Triangle(corners.each_ref().map(point)),
            Self::Circle(c) => Self::Circle(Circle {
                centre: point(&c.centre),
                axis: pose.transform_vector(c.axis),
                radius: c.radius,
            }),
            // A box has a frame of its own, which is moved as a whole, ...
            Self::Box(b) => Self::Box(BoxCore {
                from_box: *pose * b.from_box,
                half: b.half,
            }),
            Self::Frustum(f) => Self::Frustum(Frustum {
                from: point(&f.from),
                axis: pose.transform_vector(f.axis),
                ..*f
            }),
            Self::HalfSpace(h) => Self::HalfSpace(HalfSpace {
                point: point(&h.point),
                normal: pose.transform_vector(h.normal),
            }),
            // ... and so has a mesh: its tree of triangles is shared, not moved.
            Self::Mesh(tree, placed) => Self::Mesh(Arc::clone(tree), *pose * *placed),
        }
    }

    /// Centre and radius of a sphere around it.
    pub fn bounds(&self) -> (DVec3, f64) {
        match self {
            Self::Point(p) => (*p, 0.0),
            Self::Segment([a, b]) => ((*a + *b) * 0.5, 0.5 * a.distance(*b)),
            Self::Circle(c) => (c.centre, c.radius),
            Self::Box(b) => (b.from_box.translation, b.half.length()),
            Self::Frustum(f) => {
                let centre = f.from + f.axis * (0.5 * f.length);
                let widest = f.radii[0].max(f.radii[1]);
                (centre, libm::hypot(0.5 * f.length, widest))
            }
            Self::Triangle(corners) => {
                let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
                let far = corners.iter().map(|c| c.distance(centre));
                (centre, far.fold(0.0, f64::max))
            }
            Self::HalfSpace(h) => (h.point, f64::INFINITY),
            Self::Mesh(tree, pose) => {
                let (centre, radius) = tree.tree.bounds();
                (pose.transform_point(centre), radius)
            }
        }
    }

    /// Largest n · p over the points p of the convex hull of a core; `None` if unbounded.
    pub fn support(&self, n: DVec3) -> Option<f64> {
        Some(match self {
            Self::Point(p) => n.dot(*p),
            Self::Segment([a, b]) => n.dot(*a).max(n.dot(*b)),
            Self::Triangle([a, b, c]) => n.dot(*a).max(n.dot(*b)).max(n.dot(*c)),
            Self::Box(b) => {
                let local = b.from_box.rotation.transpose() * n;
                n.dot(b.from_box.translation) + local.abs().dot(b.half)
            }
            // The farther of the two rims: its centre, plus its radius across the axis.
            Self::Frustum(f) => {
                let along = n.dot(f.axis);
                let across = (n - f.axis * along).length();
                let start = n.dot(f.from);
                let ends = [0.0, along * f.length];
                let [a, b] = [0, 1].map(|k: usize| start + ends[k] + f.radii[k] * across);
                a.max(b)
            }
            Self::Circle(c) => {
                let across = n - c.axis * n.dot(c.axis);
                n.dot(c.centre) + c.radius * across.length()
            }
            Self::HalfSpace(h) if n == h.normal => n.dot(h.point),
            Self::HalfSpace(_) => return None,
            Self::Mesh(tree, pose) => {
                let local = pose.rotation.transpose() * n;
                n.dot(pose.transform_point(tree.tree.farthest(local)?))
            }
        })
    }
}

impl Primitive {
    /// A point p of a bounded convex core with the largest n · p; `None` for others.
    pub fn support_point(&self, n: DVec3) -> Option<DVec3> {
        let of = |points: &[DVec3]| {
            let higher = |p: DVec3, q: DVec3| if n.dot(q) > n.dot(p) { q } else { p };
            points.iter().copied().reduce(higher)
        };
        match self {
            Self::Point(p) => Some(*p),
            Self::Segment(ends) => of(ends),
            Self::Triangle(corners) => of(corners),
            Self::Box(b) => {
                let local = b.from_box.rotation.transpose() * n;
                let sign = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
                let signs = DVec3::new(sign(local.x), sign(local.y), sign(local.z));
                Some(b.from_box.transform_point(b.half * signs))
            }
            Self::Frustum(f) => of(&f.rims().map(|rim| rim.centre + rim.outward(n) * rim.radius)),
            Self::Circle(_) | Self::HalfSpace(_) | Self::Mesh(..) => None,
        }
    }
}

impl Primitive {
    /// The order of two cores: arbitrary, so that a pair is always processed in the same order.
    pub fn order(&self, other: &Self) -> Ordering {
        let by_kind = self.kind().cmp(&other.kind());
        by_kind.then_with(|| {
            let pairs = self.numbers().into_iter().zip(other.numbers());
            let mut orders = pairs.map(|(mine, theirs)| mine.total_cmp(&theirs));
            let by_number = orders.find(|order| order.is_ne());
            by_number.unwrap_or_else(|| match (self, other) {
                // Equally many triangles at one pose: the corners tell them apart.
                (Self::Mesh(mine, _), Self::Mesh(theirs, _)) => mine.tree.order(&theirs.tree),
                _ => Ordering::Equal,
            })
        })
    }

    fn kind(&self) -> u8 {
        match self {
            Self::Point(_) => 0,
            Self::Segment(_) => 1,
            Self::Circle(_) => 2,
            Self::Box(_) => 3,
            Self::Frustum(_) => 4,
            Self::Triangle(_) => 5,
            Self::HalfSpace(_) => 6,
            Self::Mesh(..) => 7,
        }
    }

    /// The numbers that distinguish it from others of its kind; for meshes, their pose and number of triangles.
    fn numbers(&self) -> [f64; 12] {
        // Four rows of three numbers, zero where a kind has fewer.
        let three = |rows: [DVec3; 4]| {
            let mut all = [0.0; 12];
            for (to, row) in all.chunks_exact_mut(3).zip(rows) {
                to.copy_from_slice(&row.to_array());
            }
            all
        };
        let zero = DVec3::ZERO;
        // Two columns determine a rotation: the third is their cross product.
        let of_pose = |p: &Pose, last| {
            let axes = [p.rotation.x_axis, p.rotation.y_axis];
            three([p.translation, axes[0], axes[1], last])
        };
        match self {
            Self::Point(p) => three([*p, zero, zero, zero]),
            Self::Segment([a, b]) => three([*a, *b, zero, zero]),
            Self::Circle(c) => three([c.centre, c.axis, DVec3::splat(c.radius), zero]),
            Self::Box(b) => of_pose(&b.from_box, b.half),
            Self::Frustum(f) => {
                let sizes = DVec3::new(f.length, f.radii[0], f.radii[1]);
                three([f.from, f.axis, sizes, zero])
            }
            Self::Triangle([a, b, c]) => three([*a, *b, *c, zero]),
            Self::HalfSpace(h) => three([h.point, h.normal, zero, zero]),
            // Of a mesh the pose and the number of its triangles.
            Self::Mesh(tree, pose) => of_pose(pose, DVec3::splat(tree.len() as f64)),
        }
    }
}

impl Element {
    /// The same element after a motion.
    pub fn moved(&self, pose: &Pose) -> Self {
        Self {
            core: self.core.moved(pose),
            ..*self
        }
    }

    /// Centre and radius of a sphere around it.
    pub fn bounds(&self) -> (DVec3, f64) {
        let (centre, radius) = self.core.bounds();
        (centre, radius + self.radius)
    }
}

/// The elements of a body's shapes, in the body's frame. Translucent shapes count like all others.
pub fn shape_elements(shapes: &[Shape], trees: &mut MeshTrees) -> Vec<Element> {
    // Every solid is one or more primitives grown by a radius.
    let mut list = Vec::new();
    for (index, shape) in shapes.iter().enumerate() {
        let mut add = |core: Primitive, radius: f64| {
            list.push(Element {
                core: core.moved(&shape.body_from_shape),
                radius,
                shape: index,
            });
        };
        match &shape.solid {
            Solid::Sphere { centre, radius } => add(Primitive::Point(*centre), *radius),
            Solid::Capsule { from, to, radius } => add(segment_core([*from, *to]), *radius),
            Solid::Cylinder { from, to, radius } => {
                add(frustum_core(*from, *to, [*radius; 2]), 0.0)
            }
            Solid::Cone {
                from,
                to,
                radius_from,
                radius_to,
            } => add(frustum_core(*from, *to, [*radius_from, *radius_to]), 0.0),
            Solid::Box { centre, size } => {
                let block = BoxCore {
                    from_box: Pose::from_translation(*centre),
                    half: *size * 0.5,
                };
                add(Primitive::Box(block), 0.0);
            }
            Solid::Torus {
                centre,
                axis,
                ring,
                tube,
            } => {
                let circle = Circle {
                    centre: *centre,
                    axis: *axis,
                    radius: *ring,
                };
                add(Primitive::Circle(circle), *tube);
            }
            Solid::Tube {
                points,
                radius,
                closed,
            } => {
                for pair in points.windows(2) {
                    add(segment_core([pair[0], pair[1]]), *radius);
                }
                if let (true, Some(first), Some(last)) = (closed, points.first(), points.last()) {
                    add(segment_core([*last, *first]), *radius);
                }
            }
            Solid::HalfSpace { point, normal, .. } => {
                let (point, normal) = (*point, *normal);
                add(Primitive::HalfSpace(HalfSpace { point, normal }), 0.0);
            }
            Solid::Triangles(soup) => {
                let tree = trees.tree(soup);
                add(Primitive::Mesh(tree, Pose::IDENTITY), 0.0);
            }
        }
    }
    list
}

/// A segment, or a point where both ends are the same.
fn segment_core(ends: [DVec3; 2]) -> Primitive {
    if ends[0] == ends[1] {
        Primitive::Point(ends[0])
    } else {
        Primitive::Segment(ends)
    }
}

fn frustum_core(from: DVec3, to: DVec3, radii: [f64; 2]) -> Primitive {
    let span = to - from;
    Primitive::Frustum(Frustum {
        from,
        axis: span.try_normalize().unwrap_or(DVec3::Z),
        length: span.length(),
        radii,
    })
}
