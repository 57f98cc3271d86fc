//! One camera and ground for several scenes that are shown one after the other.

use super::ground::view_ground;
use super::{PictureOptions, Staging, bounds, cameras, picture_aspect};
use crate::kinematics::results::trajectory::Trajectory;
use crate::render::{Camera, Ground, Stage};
use crate::scene::Scene;
use std::sync::Arc;

/// Everything that stays the same when the mechanism changes.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedCamera {
    camera: Camera,
    ground: Option<Ground>,
}

impl SharedCamera {
    /// Includes all scenes over their motions, seen as the first one requests. `None` without scenes.
    pub fn over<'a>(
        moving: impl Iterator<Item = (&'a Scene, &'a Trajectory)> + Clone,
        options: PictureOptions,
    ) -> Option<Self> {
        let first = moving.clone().next()?.0;
        let all = moving.flat_map(|(s, t)| bounds::moving_points(s, t));
        let points: Vec<_> = all.collect();
        let view = &*cameras::view_of(first, &points);
        Some(Self {
            camera: cameras::still_camera(view, view.up.axis(), &points, picture_aspect(options)),
            ground: view_ground(view, &points, view.up.axis()),
        })
    }
}

impl Staging<'_> {
    /// The same looked at as others are.
    pub fn seen_as(mut self, outlook: &SharedCamera) -> Self {
        self.stage = Arc::new(Stage {
            camera: outlook.camera,
            ground: outlook.ground,
            ..Stage::clone(&self.stage)
        });
        // One camera for all must be fixed.
        self.cameras.clear();
        self.place_letters(&[]);
        self
    }
}
