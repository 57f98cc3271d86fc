//! The solids a body is drawn and checked with. Plain data; meshes are made in `geometry`.

use crate::math::Pose;
use glam::DVec3;
use std::sync::Arc;

/// A solid in its own frame. Lengths in the scene's unit, all radii positive.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid {
    /// Ball around `centre`.
    Sphere {
        /// Centre in the shape's frame.
        centre: DVec3,
        /// Radius.
        radius: f64,
    },
    /// All points within `radius` of the segment.
    Capsule {
        /// One end of the segment.
        from: DVec3,
        /// The other end.
        to: DVec3,
        /// Radius.
        radius: f64,
    },
    /// Flat-ended cylinder between two centres.
    Cylinder {
        /// Centre of one end.
        from: DVec3,
        /// Centre of the other end.
        to: DVec3,
        /// Radius.
        radius: f64,
    },
    /// Cone frustum between two centres; a radius of zero gives a point.
    Cone {
        /// Centre of the first end.
        from: DVec3,
        /// Centre of the other end.
        to: DVec3,
        /// Radius at `from`.
        radius_from: f64,
        /// Radius at `to`.
        radius_to: f64,
    },
    /// Axis-parallel box.
    Box {
        /// Centre.
        centre: DVec3,
        /// Full edge lengths.
        size: DVec3,
    },
    /// Torus around `axis`. A spindle torus (`tube` > `ring`) is accepted.
    Torus {
        /// Centre.
        centre: DVec3,
        /// Direction of the axis, unit length.
        axis: DVec3,
        /// Radius of the centre circle.
        ring: f64,
        /// Radius of the tube.
        tube: f64,
    },
    /// Round tube along a polyline, with round joints and ends.
    Tube {
        /// Points of the centre line, at least two.
        points: Vec<DVec3>,
        /// Radius.
        radius: f64,
        /// Whether the last point joins the first.
        closed: bool,
    },
    /// Everything below a plane; drawn as a thin square sheet.
    HalfSpace {
        /// A point of the plane: the middle of the sheet.
        point: DVec3,
        /// Unit normal of the plane, out of the solid.
        normal: DVec3,
        /// Edge length of the sheet.
        size: f64,
    },
    /// Triangles read from a file.
    Triangles(Arc<TriangleSoup>),
}

impl Solid {
    /// Its key in scene files.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Sphere { .. } => "sphere",
            Self::Capsule { .. } => "capsule",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Box { .. } => "box",
            Self::Torus { .. } => "torus",
            Self::Tube { .. } => "tube",
            Self::HalfSpace { .. } => "half_space",
            Self::Triangles(_) => "stl",
        }
    }
}

/// Triangles as a file holds them.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleSoup {
    /// Where they came from, for messages.
    pub source: String,
    /// Vertices in the scene's unit.
    pub vertices: Vec<DVec3>,
    /// Corner indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Whether the scene declares them as a surface without an inside.
    pub is_surface: bool,
}

/// A solid, its position in its body, and its appearance.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The solid in its own frame.
    pub solid: Solid,
    /// Placement in the body.
    pub body_from_shape: Pose,
    /// sRGB colour, 0 to 255.
    pub colour: [u8; 3],
    /// 1 opaque, below 1 translucent.
    pub opacity: f64,
}
