//! The distance of two bodies, or of groups of them, as a named scalar of every pose.
//!
//! The measuring of solids is an interface here.

use crate::math::Pose;
use glam::DVec3;
use std::fmt::Debug;
use std::sync::Arc;

/// The nearest points of two solids, or those of deepest penetration.
#[derive(Clone, Copy, Debug)]
pub struct NearestPoints {
    /// Signed distance in the scene's unit.
    pub distance: f64,
    /// The point of each solid in the first one's frame.
    pub points: [DVec3; 2],
    /// Unit vector from the first to the second, in the first one's frame; zero if unknown.
    pub normal: DVec3,
}

/// The solids of two bodies.
pub trait Solids: Debug + Send + Sync {
    /// Their nearest points, with the second placed relative to the first. Coordinates that shape them are passed.
    fn nearest(&self, coordinates: &[f64], first_from_second: &Pose) -> Option<NearestPoints>;

    /// Coordinates that their shapes depend on.
    fn shaped_by(&self) -> &[usize];
}

/// The solids of two bodies, and which bodies these are.
#[derive(Clone, Debug)]
pub struct SolidPair {
    /// Indices.
    pub bodies: [usize; 2],
    /// Shapes of the first and the second that count; all if there are none.
    pub shapes: Vec<[usize; 2]>,
    /// What they look like.
    pub solids: Arc<dyn Solids>,
}

/// The least of the distances of some pairs of bodies.
#[derive(Clone, Debug)]
pub struct Distance {
    /// The pairs, at least one.
    pub gaps: Vec<SolidPair>,
}

impl PartialEq for Distance {
    /// Of one mechanism: the bodies tell.
    fn eq(&self, other: &Self) -> bool {
        let bodies = |d: &Self| d.gaps.iter().map(|g| g.bodies).collect::<Vec<_>>();
        bodies(self) == bodies(other)
    }
}
