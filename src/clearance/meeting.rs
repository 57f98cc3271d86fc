//! Two elements, one of which moves for a short time, and their positions in the middle of it.

use super::relative::RelativeMove;
use crate::distance::pair::{Proximity, signed_distance};
use crate::distance::primitive::Element;
use glam::DVec3;

/// Two elements, the second of which moves for a short time.
#[derive(Clone, Copy)]
pub struct Meeting<'e> {
    /// The fixed one.
    pub a: &'e Element,
    /// The other one in the middle of the time.
    pub b: &'e Element,
    /// That one in its own frame.
    pub mine: &'e Element,
    /// How it moves.
    pub moved: &'e RelativeMove,
    /// Their distance in the middle.
    pub found: Proximity,
}

impl<'e> Meeting<'e> {
    /// Measures the distance in the middle.
    pub fn new(a: &'e Element, b: &'e Element, mine: &'e Element, moved: &'e RelativeMove) -> Self {
        Self::with(signed_distance(a, b), [a, b, mine], moved)
    }

    /// The same where that distance is known.
    pub fn with(found: Proximity, [a, b, mine]: [&'e Element; 3], moved: &'e RelativeMove) -> Self {
        Self {
            a,
            b,
            mine,
            moved,
            found,
        }
    }

    /// What both elements are grown by.
    pub fn radii(&self) -> f64 {
        self.a.radius + self.b.radius
    }

    /// What every point of b may deviate by from where X takes it.
    pub fn beyond_linear(&self) -> f64 {
        let ball = self.mine.bounds();
        self.moved.bending(ball) + self.moved.deviation(ball)
    }

    /// The nearest points of the cores.
    pub fn core_points(&self) -> [DVec3; 2] {
        let Proximity { points, normal, .. } = self.found;
        [
            points[0] - normal * self.a.radius,
            points[1] + normal * self.b.radius,
        ]
    }
}
