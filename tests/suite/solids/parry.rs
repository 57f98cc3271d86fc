//! The solids of parry, another library, and the distances that it finds.

use glam::{DQuat, DVec3};
use mechanim::math::Pose;
use mechanim::model::shape::Solid;
use parry3d_f64::math::Pose as Placement;
use parry3d_f64::query;
use parry3d_f64::shape::{Ball, Capsule, Cone, Cuboid, Cylinder, HalfSpace, Shape, TriMesh};

/// A solid where it is.
pub struct Peer {
    shape: Box<dyn Shape>,
    place: Placement,
}

impl Peer {
    /// `None` for a solid that parry has no exact shape of: frustums, tori, tubes.
    pub fn new(solid: &Solid, pose: &Pose) -> Option<Self> {
        let (shape, place): (Box<dyn Shape>, Placement) = match solid {
            Solid::Sphere { centre, radius } => (Box::new(Ball::new(*radius)), at(*centre)),
            Solid::Capsule { from, to, radius } => (
                Box::new(Capsule::new(*from, *to, *radius)),
                Placement::IDENTITY,
            ),
            Solid::Cylinder { from, to, radius } => {
                let half = 0.5 * from.distance(*to);
                (Box::new(Cylinder::new(half, *radius)), along(*from, *to))
            }
            Solid::Cone {
                from,
                to,
                radius_from,
                radius_to: 0.0,
            } => {
                let half = 0.5 * from.distance(*to);
                (Box::new(Cone::new(half, *radius_from)), along(*from, *to))
            }
            Solid::Box { centre, size } => (Box::new(Cuboid::new(*size * 0.5)), at(*centre)),
            Solid::HalfSpace { point, normal, .. } => {
                (Box::new(HalfSpace::new(*normal)), at(*point))
            }
            Solid::Triangles(soup) => {
                let mesh = TriMesh::new(soup.vertices.clone(), soup.triangles.clone());
                (Box::new(mesh.ok()?), Placement::IDENTITY)
            }
            _ => return None,
        };
        let rotation = DQuat::from_mat3(&pose.rotation);
        let place = Placement::from_parts(pose.translation, rotation) * place;
        Some(Self { shape, place })
    }

    /// The distance, or less the depth; `None` where parry finds neither.
    ///
    /// A half-space goes first: in 0.31 `contact_support_map_halfspace` takes the pose the wrong way round.
    pub fn distance(&self, other: &Self) -> Option<f64> {
        if other.is_half_space() && !self.is_half_space() {
            return other.distance(self);
        }
        let (a, b) = (&*self.shape, &*other.shape);
        let apart = query::distance(&self.place, a, &other.place, b).ok()?;
        if apart.distance > 0.0 {
            return Some(apart.distance);
        }
        let contact = query::contact(&self.place, a, &other.place, b, 0.0).ok()??;
        Some(contact.dist)
    }

    fn is_half_space(&self) -> bool {
        self.shape.as_shape::<HalfSpace>().is_some()
    }
}

fn at(centre: DVec3) -> Placement {
    Placement::from_parts(centre, DQuat::IDENTITY)
}

/// The middle between two points, with parry's axis of round solids, y, from one to the other.
fn along(from: DVec3, to: DVec3) -> Placement {
    let rotation = DQuat::from_rotation_arc(DVec3::Y, (to - from).normalize());
    Placement::from_parts(0.5 * (from + to), rotation)
}
