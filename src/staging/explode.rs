//! Exploded views: bodies are drawn away from the middle of all of them, with dashed lines to their true places.
//!
//! Every body keeps its distance over the whole motion, so that it moves as it does in its place.

use super::solids::{merged_mesh, sign_instance};
use crate::geometry::coarse_mesh_of;
use crate::kinematics::results::trajectory::{ClosedPose, Trajectory};
use crate::math::Pose;
use crate::model::shape::Solid;
use crate::model::theme::Theme;
use crate::render::{Instance, StageMesh};
use crate::scene::Scene;
use glam::DVec3;

/// Facet error of the meshes that give the middle of a body, relative to a solid's radius.
const COARSE: f64 = 0.05;

/// Radius of a leader, and lengths of its dashes and gaps, in 480ths of the picture's height.
const RADIUS: f64 = 0.8;
const DASH: f64 = 10.0;
const GAP: f64 = 7.0;

/// Most dashes of a leader.
const MOST_DASHES: f64 = 400.0;

/// How bodies of a scene are moved apart.
pub struct ExplodedView {
    /// Of every body.
    offsets: Vec<DVec3>,
    /// Middles in the frames of the bodies, with the meshes of their leaders; bodies that stay have none.
    leaders: Vec<(usize, DVec3, usize)>,
    colour: [u8; 3],
}

/// A box with its least and greatest corner.
type Bounds = [DVec3; 2];

fn joined([low, high]: Bounds, [other_low, other_high]: Bounds) -> Bounds {
    [low.min(other_low), high.max(other_high)]
}

/// The box around what is shown of a body at a pose.
fn body_box(scene: &Scene, body: usize, pose: &ClosedPose) -> Option<Bounds> {
    let shapes = scene.view.shown_shapes(&scene.mechanism, body);
    let boxes = shapes.filter_map(|shape| {
        let world = pose.bodies[body] * shape.body_from_shape;
        let around = |points: &[DVec3]| {
            let placed = points.iter().map(|p| world.transform_point(*p));
            let boxes = placed.filter(|p| p.is_finite()).map(|p| [p, p]);
            boxes.reduce(joined)
        };
        match &shape.solid {
            Solid::Triangles(soup) => around(&soup.vertices),
            solid => around(&coarse_mesh_of(solid, COARSE).positions),
        }
    });
    boxes.reduce(joined)
}

fn middle([low, high]: Bounds) -> DVec3 {
    (low + high) * 0.5
}

/// Middles of the bodies at the first pose, and how far each is moved; nothing unless the view is exploded.
fn middles_and_offsets(scene: &Scene, trajectory: &Trajectory) -> Vec<Option<[DVec3; 2]>> {
    let count = scene.mechanism.bodies.len();
    let factor = scene.view.explode;
    let Some(first) = trajectory.poses().next().filter(|_| factor > 0.0) else {
        return vec![None; count];
    };
    let boxes: Vec<_> = (0..count)
        .map(|body| body_box(scene, body, first))
        .collect();
    let Some(whole) = boxes.iter().flatten().copied().reduce(joined) else {
        return vec![None; count];
    };
    let own = boxes.into_iter().map(|own| {
        let at = middle(own?);
        Some([at, (at - middle(whole)) * factor])
    });
    own.collect()
}

/// How far every body is drawn from its place.
pub fn body_offsets(scene: &Scene, trajectory: &Trajectory) -> Vec<DVec3> {
    let found = middles_and_offsets(scene, trajectory).into_iter();
    found
        .map(|own| own.map_or(DVec3::ZERO, |[_, offset]| offset))
        .collect()
}

impl ExplodedView {
    /// The exploded view of a scene, for a picture `height` pixels high; adds the meshes of the leaders.
    pub fn new(
        (scene, trajectory): (&Scene, &Trajectory),
        (pixel, height): (f64, f64),
        meshes: &mut Vec<StageMesh>,
    ) -> Self {
        let unit = pixel * height / 480.0;
        let found = middles_and_offsets(scene, trajectory);
        let mut leaders = Vec::new();
        for (body, own) in found.iter().enumerate() {
            let (Some([at, offset]), Some(first)) = (own, trajectory.poses().next()) else {
                continue;
            };
            let dashes = dashes_along(*offset, unit);
            if !dashes.is_empty() {
                meshes.push(merged_mesh(&dashes, 0.2 * pixel).into());
                let at = first.bodies[body].inverse().transform_point(*at);
                leaders.push((body, at, meshes.len() - 1));
            }
        }
        let offsets = found.into_iter();
        let offsets = offsets.map(|own| own.map_or(DVec3::ZERO, |[_, offset]| offset));
        Self {
            offsets: offsets.collect(),
            leaders,
            colour: Theme::faint_ink(scene.view.theme),
        }
    }

    /// How far every body is drawn from its place.
    pub fn offsets(&self) -> &[DVec3] {
        &self.offsets
    }

    /// A pose with the bodies where they are drawn; `None` if they are in their places.
    pub fn moved(&self, pose: &ClosedPose) -> Option<ClosedPose> {
        if self.leaders.is_empty() {
            return None;
        }
        let mut moved = pose.clone();
        for (body, offset) in moved.bodies.iter_mut().zip(&self.offsets) {
            body.translation += *offset;
        }
        Some(moved)
    }

    /// The leaders at a pose with the bodies in their places, with the numbers of their bodies.
    pub fn instances<'a>(
        &'a self,
        pose: &'a ClosedPose,
        meshes: &'a [StageMesh],
    ) -> impl Iterator<Item = (u32, Instance)> + 'a {
        self.leaders.iter().map(|(body, at, mesh)| {
            let at = Pose::from_translation(pose.bodies[*body].transform_point(*at));
            let leader = sign_instance(*mesh, meshes, at, self.colour, 1.0);
            (*body as u32, leader)
        })
    }

    /// Colours that appear as they are.
    pub fn flat_colours(&self) -> Option<[u8; 3]> {
        (!self.leaders.is_empty()).then_some(self.colour)
    }
}

/// Dashes from the origin to `end`.
fn dashes_along(end: DVec3, unit: f64) -> Vec<Solid> {
    let length = end.length();
    // Long leaders have longer dashes; a dash ends at either end.
    let period = ((DASH + GAP) * unit).max(length / MOST_DASHES);
    let dash = period * DASH / (DASH + GAP);
    if !(length > dash && length.is_finite() && unit > 0.0) {
        return Vec::new();
    }
    let count = ((length - dash) / period).ceil();
    let step = (length - dash) / count;
    let along = end / length;
    let dashes = (0..=count as usize).map(|k| {
        let start = k as f64 * step;
        Solid::Cylinder {
            from: along * start,
            to: along * (start + dash),
            radius: RADIUS * unit,
        }
    });
    dashes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_reach_from_end_to_end() {
        let end = DVec3::new(30.0, 40.0, 0.0);
        let dashes = dashes_along(end, 0.1);
        let ends = [dashes.first(), dashes.last()].map(|dash| match dash {
            Some(Solid::Cylinder { from, to, .. }) => [*from, *to],
            _ => [DVec3::NAN; 2],
        });
        assert_eq!(ends[0][0], DVec3::ZERO);
        assert!(ends[1][1].distance(end) < 1e-9);
        assert!((28..33).contains(&dashes.len()), "{}", dashes.len());
        assert!(dashes_along(DVec3::ZERO, 0.1).is_empty());
        assert!(dashes_along(DVec3::splat(1e9), 1e-9).len() <= 402);
    }
}
