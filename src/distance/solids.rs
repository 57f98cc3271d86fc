//! The solids of two bodies whose distance is an output.

use super::bodies::{BodyElements, LeftOut, enclosed_shell, nearest_bodies};
use crate::math::Pose;
use crate::model::distance::{NearestPoints, Solids};
use crate::model::mechanism::Body;
use glam::DVec3;

/// Two bodies whose shapes do not change.
#[derive(Debug)]
pub struct Rigid {
    hulls: [BodyElements; 2],
    left_out: LeftOut,
}

impl Rigid {
    /// The solids of two bodies, all of their shapes or some pairs of them; `None` if one has no solids.
    pub fn new([first, second]: [&Body; 2], shapes: &[[usize; 2]]) -> Option<Self> {
        let hulls = [BodyElements::new(first)?, BodyElements::new(second)?];
        let left_out = left_out(hulls.each_ref(), shapes).into_iter().collect();
        Some(Self { hulls, left_out })
    }
}

/// Pairs of elements to be ignored where only some pairs of shapes count; all count where none are named.
pub fn left_out(hulls: [&BodyElements; 2], shapes: &[[usize; 2]]) -> Vec<[usize; 2]> {
    match shapes {
        [] => Vec::new(),
        some => BodyElements::pairs_of(hulls, |pair| !some.contains(&pair)).collect(),
    }
}

impl Solids for Rigid {
    /// The depth inside a mesh is unknown: the result is zero.
    fn nearest(&self, _coordinates: &[f64], first_from_second: &Pose) -> Option<NearestPoints> {
        let ([first, second], left_out) = (&self.hulls, &self.left_out);
        let found = nearest_bodies(first, second, first_from_second, left_out)?.proximity;
        let mut nearest = NearestPoints {
            distance: found.distance,
            points: found.points,
            normal: found.normal,
        };
        if found.distance > 0.0
            && enclosed_shell(first, second, first_from_second, left_out).is_some()
        {
            (nearest.distance, nearest.normal) = (0.0, DVec3::ZERO);
        }
        Some(nearest)
    }

    fn shaped_by(&self) -> &[usize] {
        &[]
    }
}
