//! Solids of clearance tests: their short names, and random ones that are the same in every run.

mod machine_parts;
pub mod parry;

use glam::{DMat3, DQuat, DVec3};
use mechanim::distance::mesh_tree::MeshTrees;
use mechanim::distance::primitive::{Element, shape_elements};
use mechanim::math::Pose;
use mechanim::model::shape::{Shape, Solid};

/// Triangles of a box, outside out, whose corners are counted by bits: x, y, z from the lowest on. Two a face.
pub const BOX_TRIANGLES: [[usize; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

/// Corner `k` of the box from -1 to 1.
pub fn box_corner(k: usize) -> DVec3 {
    let side = |bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
    v(side(1), side(2), side(4))
}

/// Triangles as STL text.
pub fn stl_text(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> String {
    let mut text = String::from("solid part\n");
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for p in triangle {
            text += &format!("vertex {:.17e} {:.17e} {:.17e}\n", p.x, p.y, p.z);
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid part\n"
}

pub fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

pub fn element(solid: Solid) -> Element {
    let shape = Shape {
        solid,
        body_from_shape: Pose::IDENTITY,
        colour: [0; 3],
        opacity: 1.0,
    };
    shape_elements(&[shape], &mut MeshTrees::default()).remove(0)
}

pub fn sphere(centre: DVec3, radius: f64) -> Element {
    element(Solid::Sphere { centre, radius })
}

pub fn capsule(from: DVec3, to: DVec3, radius: f64) -> Element {
    element(Solid::Capsule { from, to, radius })
}

pub fn cylinder(from: DVec3, to: DVec3, radius: f64) -> Element {
    element(Solid::Cylinder { from, to, radius })
}

pub fn cone(from: DVec3, to: DVec3, radius_from: f64, radius_to: f64) -> Element {
    element(Solid::Cone {
        from,
        to,
        radius_from,
        radius_to,
    })
}

pub fn cuboid(centre: DVec3, size: DVec3) -> Element {
    element(Solid::Box { centre, size })
}

pub fn torus(centre: DVec3, axis: DVec3, ring: f64, tube: f64) -> Element {
    let axis = axis.normalize();
    element(Solid::Torus {
        centre,
        axis,
        ring,
        tube,
    })
}

pub fn half_space(point: DVec3, normal: DVec3) -> Element {
    let normal = normal.normalize();
    element(Solid::HalfSpace {
        point,
        normal,
        size: 1.0,
    })
}

/// SplitMix64: the same pairs in every run.
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn vector(&mut self, reach: f64) -> DVec3 {
        v(
            self.range(-reach, reach),
            self.range(-reach, reach),
            self.range(-reach, reach),
        )
    }

    pub fn pose(&mut self, reach: f64) -> Pose {
        let axis = self.vector(1.0).normalize_or(DVec3::X);
        let angle = self.range(-3.0, 3.0);
        Pose {
            rotation: DMat3::from_quat(DQuat::from_axis_angle(axis, angle)),
            translation: self.vector(reach),
        }
    }

    pub fn solid(&mut self, kind: usize) -> Element {
        let (a, b) = (self.vector(2.0), self.vector(2.0));
        let r = self.range(0.05, 1.0);
        match kind {
            0 => sphere(a, r),
            1 => capsule(a, b, r),
            2 => cylinder(a, b, r),
            3 => {
                let other = if r < 0.3 { 0.0 } else { self.range(0.0, 1.0) };
                cone(a, b, r, other)
            }
            4 => cuboid(a, b.abs() + 0.1),
            5 => torus(a, b, self.range(0.5, 3.0), 0.4 * r),
            _ => half_space(a, b),
        }
    }
}
