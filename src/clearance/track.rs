//! Distances of two bodies at successive poses. From pose to pose no distance changes by more than the largest displacement,
//! so that most elements need not be measured again.

use crate::distance::bodies::{
    BodyElements, BodyProximity, LeftOut, separation_along, sphere_separation,
};
use crate::distance::pair::signed_distance;
use crate::distance::primitive::Element;
use crate::math::Pose;
use glam::{DMat3, DVec3};
use std::f64::consts::FRAC_1_SQRT_2;

/// Relative rounding of distances and displacements between two poses, generously.
const SLACK: f64 = 1e-9;

/// Two bodies and lower bounds of their elements' distances.
pub struct PairTrack<'a> {
    hulls: [&'a BodyElements; 2],
    /// Balls around the elements of the second body, in its frame.
    balls: Vec<(DVec3, f64)>,
    /// Lower bounds of the distances at the last pose, one row an element of the first body.
    lower: Vec<f64>,
    /// Direction from the first element to the second at their nearest points when last measured; zero if unknown.
    normals: Vec<DVec3>,
    last: Option<Pose>,
    nearest: usize,
}

impl<'a> PairTrack<'a> {
    /// Two bodies about which nothing is known yet, except for some pairs of elements.
    pub fn new(hulls: [&'a BodyElements; 2], left_out: &LeftOut) -> Self {
        let balls: Vec<(DVec3, f64)> = hulls[1].elements.iter().map(Element::bounds).collect();
        let mut lower = vec![f64::NEG_INFINITY; hulls[0].elements.len() * balls.len()];
        for [i, j] in left_out {
            lower[i * balls.len() + j] = f64::INFINITY;
        }
        Self {
            hulls,
            lower,
            normals: vec![DVec3::ZERO; hulls[0].elements.len() * balls.len()],
            balls,
            last: None,
            nearest: 0,
        }
    }

    /// The nearest elements at a pose, if they are nearer than `limit`.
    pub fn at(&mut self, a_from_b: &Pose, limit: f64) -> Option<BodyProximity> {
        self.move_to(a_from_b);
        let columns = self.balls.len();
        let mut placed: Vec<Option<Element>> = vec![None; columns];
        let mut best: Option<BodyProximity> = None;
        let count = self.lower.len();
        let nearest = self.nearest;
        let others = (0..count).filter(|k| *k != nearest);
        for k in std::iter::once(nearest).chain(others) {
            // Bounds from the last pose leave out most pairs; separating directions that worked are tried again.
            let limit = best.map_or(limit, |b| b.proximity.distance);
            if k >= count || self.lower[k] >= limit {
                continue;
            }
            let (i, j) = (k / columns, k % columns);
            let first = &self.hulls[0].elements[i];
            let second = placed[j].get_or_insert_with(|| self.hulls[1].elements[j].moved(a_from_b));
            if limit < f64::INFINITY {
                self.lower[k] = self.lower[k].max(sphere_separation(first, second, limit));
                if self.lower[k] < limit && self.normals[k] != DVec3::ZERO {
                    self.lower[k] =
                        self.lower[k].max(separation_along(first, second, self.normals[k]));
                }
                if self.lower[k] >= limit {
                    continue;
                }
            }
            let proximity = signed_distance(first, second);
            // Depths are found by a search and known less well than distances.
            self.lower[k] = if proximity.distance > 0.0 {
                proximity.lowest()
            } else {
                f64::NEG_INFINITY
            };
            self.normals[k] = proximity.normal;
            let found = BodyProximity {
                proximity,
                elements: [i, j],
            };
            let is_nearest = proximity.distance < limit || limit == f64::INFINITY;
            if is_nearest {
                self.nearest = k;
            }
            best = match best {
                Some(best) => Some(best.or(found)),
                None => is_nearest.then_some(found),
            };
        }
        best
    }

    /// Lowers the bounds by the displacement from the last pose to this one.
    fn move_to(&mut self, pose: &Pose) {
        if let Some(last) = self.last.replace(*pose) {
            let turn: DMat3 = pose.rotation - last.rotation;
            let turn = turn.to_cols_array().iter().map(|v| v * v).sum::<f64>();
            let turn = turn.sqrt() * FRAC_1_SQRT_2;
            let columns = self.balls.len();
            for (j, (centre, radius)) in self.balls.iter().enumerate() {
                let shift = pose.transform_point(*centre) - last.transform_point(*centre);
                let turned = if turn == 0.0 { 0.0 } else { turn * radius };
                let way = shift.length() + turned + SLACK * (centre.length() + radius);
                for lower in self.lower.iter_mut().skip(j).step_by(columns) {
                    // What is left out stays infinitely far.
                    if *lower < f64::INFINITY {
                        *lower -= way + SLACK * lower.abs();
                    }
                }
            }
        }
    }
}
