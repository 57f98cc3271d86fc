//! Where a picture cuts bodies, and how far it moves them apart.

use glam::DVec3;

/// A plane that cuts bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The plane.
    pub plane: SectionPlane,
    /// Indices of the bodies that are cut; all if `None`.
    pub bodies: Option<Vec<usize>>,
}

impl Section {
    /// Whether a body is cut.
    pub fn cuts(&self, body: usize) -> bool {
        let listed = |bodies: &Vec<usize>| bodies.contains(&body);
        self.bodies.as_ref().is_none_or(listed)
    }
}

/// A plane in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPlane {
    /// A point of it.
    pub point: DVec3,
    /// Unit vector to the side that is removed.
    pub normal: DVec3,
}

impl SectionPlane {
    /// The plane through `point`; `None` if the normal has no direction.
    pub fn new(point: DVec3, normal: DVec3) -> Option<Self> {
        // Scaled first: the square of a tiny or huge normal is zero or infinite.
        let largest = normal.abs().max_element();
        let normal = (normal / largest).try_normalize()?;
        let usable = point.is_finite() && normal.is_finite();
        usable.then_some(Self { point, normal })
    }
}

/// Largest factor of an exploded view.
pub const MOST_EXPLODED: f64 = 100.0;
