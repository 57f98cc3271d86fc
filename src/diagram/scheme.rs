//! The scheme of a mechanism at a pose, as values in space: links as lines between joint places, joints with their
//! axes, named lengths and angles, loops. It does not depend on the viewpoint.

use crate::math::Pose;
use crate::model::joints::JointKind;
use glam::DVec3;

/// A scheme.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scheme {
    /// The links of the table of joints, in its order: the frame first.
    pub links: Vec<SchemeLink>,
    /// The joints of the table, those that a chain passes.
    pub joints: Vec<SchemeJoint>,
    /// Named lengths, each once, and lengths that move.
    pub lengths: Vec<SchemeLength>,
    /// Named constant angles, each once, and angles of single axes.
    pub angles: Vec<SchemeAngle>,
    /// Loops in the order of the scene.
    pub loops: Vec<SchemeLoop>,
    /// Surfaces in contact.
    pub surfaces: Vec<SchemeSurface>,
    /// Traced points: name, place, number of the link.
    pub points: Vec<(String, DVec3, usize)>,
    /// What the mechanism measures: a length to compare others with.
    pub size: f64,
}

/// A rigid part.
#[derive(Clone, Debug, PartialEq)]
pub struct SchemeLink {
    /// As lectures count: the frame is 1, the others follow in the order of their bodies.
    pub number: usize,
    /// Names of its bodies.
    pub names: Vec<String>,
    /// From joint to joint, with the corners that its chains have in between.
    pub paths: Vec<Vec<DVec3>>,
    /// Frame of its first body.
    pub frame: Pose,
    /// Whether it belongs to the mechanism: a loop passes it, or a body rides on it by joints alone.
    pub is_shown: bool,
}

/// A joint.
#[derive(Clone, Debug, PartialEq)]
pub struct SchemeJoint {
    /// What it lets move.
    pub kind: JointKind,
    /// Where its sign stands.
    pub at: DVec3,
    /// Where the guide of a sliding joint begins; otherwise the same place.
    pub from: DVec3,
    /// Directions of its motions, in their order.
    pub axes: Vec<DVec3>,
    /// Links before and behind it.
    pub links: [usize; 2],
    /// Its coordinates as written, where they have no arc or line of their own.
    pub names: Vec<String>,
    /// Whether all of them are driven.
    pub is_driven: bool,
}

/// A length with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct SchemeLength {
    /// As typed, without sign.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Where it begins.
    pub from: DVec3,
    /// Where it ends.
    pub to: DVec3,
    /// Directions in which its line may be drawn aside.
    pub aside: [DVec3; 2],
    /// What changes it.
    pub source: QuantitySource,
    /// Whether it is part of a loop.
    pub in_loop: bool,
}

/// What changes a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuantitySource {
    /// Nothing: a dimension.
    Constant,
    /// A drive.
    Input,
    /// The loops.
    Unknown,
}

/// An angle with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct SchemeAngle {
    /// As typed, without sign.
    pub name: String,
    /// The vertex.
    pub at: DVec3,
    /// Axis of the rotation.
    pub axis: DVec3,
    /// Where it is measured from.
    pub zero: DVec3,
    /// Radians.
    pub value: f64,
    /// What changes it.
    pub source: QuantitySource,
}

/// A closed loop.
#[derive(Clone, Debug, PartialEq)]
pub struct SchemeLoop {
    /// Name in the scene.
    pub name: String,
    /// The joints along it.
    pub points: Vec<DVec3>,
}

/// A surface of a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct SchemeSurface {
    /// `torus`, `sphere`, `cylinder` or `plane`.
    pub word: &'static str,
    /// Its sizes.
    pub sizes: Vec<(String, f64)>,
    /// Where it is; the axis is z.
    pub frame: Pose,
}

impl SchemeSurface {
    /// Its outermost points along the axes of its frame; none for unbounded surfaces.
    fn extent(&self) -> impl Iterator<Item = DVec3> + '_ {
        let sizes = self.sizes.iter().map(|(_, value)| value.abs());
        let reach = match self.word {
            "torus" | "sphere" => sizes.sum(),
            _ => 0.0,
        };
        let ends = (0..3).flat_map(move |k| [1.0, -1.0].map(|s| (k, s * reach)));
        ends.map(|(k, reach)| self.frame.translation + self.frame.rotation.col(k) * reach)
    }
}

impl Scheme {
    /// The normal of the plane in which everything moves, if there is one.
    pub fn normal(&self) -> Option<DVec3> {
        let turns = |joint: &&SchemeJoint| joint.kind == JointKind::Revolute;
        let normal = *self.joints.iter().find(turns)?.axes.first()?;
        let is_plane = |joint: &SchemeJoint| match joint.kind {
            JointKind::Revolute => joint.axes.iter().all(|a| a.cross(normal).length() < FLAT),
            JointKind::Prismatic => joint.axes.iter().all(|a| a.dot(normal).abs() < FLAT),
            _ => false,
        };
        self.joints.iter().all(is_plane).then_some(normal)
    }

    /// How much its loops enclose: poses at which links lie on each other show little.
    pub fn spread(&self) -> f64 {
        let enclosed = |item: &SchemeLoop| {
            let next = item.points.iter().cycle().skip(1);
            let pieces = item.points.iter().zip(next).map(|(a, b)| a.cross(*b));
            pieces.sum::<DVec3>().length()
        };
        self.loops.iter().map(enclosed).sum()
    }

    /// All places that a picture must hold.
    pub fn places(&self) -> impl Iterator<Item = DVec3> + '_ {
        let joints = self.joints.iter().flat_map(|j| [j.at, j.from]);
        let lengths = self.lengths.iter().flat_map(|l| [l.from, l.to]);
        // The frame has no lines of its own.
        let moving = self.links.iter().skip(1);
        let paths = moving.flat_map(|l| l.paths.iter().flatten());
        let points = self.points.iter().map(|(_, at, _)| *at);
        let surfaces = self.surfaces.iter().flat_map(SchemeSurface::extent);
        joints
            .chain(lengths)
            .chain(paths.copied())
            .chain(points)
            .chain(surfaces)
    }

    /// The longest side of the box around them; not above zero if there are none.
    pub fn extent(&self) -> f64 {
        let places = self.places().filter(|place| place.is_finite());
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [low, high] = places.fold(none, |[low, high], p| [low.min(p), high.max(p)]);
        (high - low).max_element()
    }
}

/// Sine below which two directions of a scheme are one, or square to each other.
pub const FLAT: f64 = 1e-6;
