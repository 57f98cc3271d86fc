//! What is known of a pair that must touch all the time: the pose at which the bodies are farthest apart, and what is allowed.

use super::sweep::Least;
use glam::DVec3;

/// Two bodies at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Signed distance.
    pub distance: f64,
    /// When, seconds.
    pub time: f64,
    /// The nearest points, in the world; none where two half-spaces overlap without end.
    pub points: Option<[DVec3; 2]>,
    /// The shapes that come nearest.
    pub shapes: [usize; 2],
}

/// How far apart two bodies come that must touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MustTouch {
    /// Where they were found farthest apart.
    pub apart: Moment,
    /// They are nowhere farther apart; infinite if unknown. How deep they may be in each other is the bound of the pair's
    /// least distance.
    pub farthest: f64,
    /// A gap and an overlap of this much still count as touching.
    pub allowed: f64,
    /// A mesh is cut: the bodies are in each other, and no shift of this length parts them.
    pub cut: Option<f64>,
}

impl Least {
    /// Whether the bodies are apart, or overlap down to some depth: half-spaces whose planes intersect have none.
    pub fn has_end(&self) -> bool {
        self.distance > f64::NEG_INFINITY
    }

    /// The moment of the least distance.
    pub fn moment(&self) -> Moment {
        Moment {
            distance: self.distance,
            time: self.time,
            points: self.has_end().then_some(self.points),
            shapes: self.shapes,
        }
    }
}
