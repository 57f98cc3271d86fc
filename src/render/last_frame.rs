//! What a frame has in common with the one drawn before: with a still camera, what does not change is kept.

use super::{Camera, Frame, Instance};
use crate::math::Pose;

/// The instances of the frame drawn last, and its camera.
#[derive(Clone, Debug, Default)]
pub struct LastFrame {
    camera: Option<Camera>,
    instances: Vec<Instance>,
}

/// An instance compared with that of the same number in the frame before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// It is as it was.
    Still,
    /// It was drawn up to this triangle, and goes on from there.
    Grown(u32),
    /// It is another, or elsewhere.
    Moved,
}

impl LastFrame {
    /// Nothing is known of a last frame any more.
    pub fn forget(&mut self) {
        self.camera = None;
    }

    /// Makes `frame` the last one, and compares its instances with those before; `None` if there was no frame before with
    /// this camera and so many instances. Only meshes of the stage, of which there are `of_stage`, stay the same.
    pub fn replace(
        &mut self,
        frame: &Frame,
        camera: &Camera,
        of_stage: usize,
    ) -> Option<Vec<Change>> {
        let seen = self.camera.replace(*camera);
        let alike = seen == Some(*camera) && self.instances.len() == frame.instances.len();
        let pairs = self.instances.iter().zip(&frame.instances);
        let changes = pairs.map(|(before, now)| {
            if now.mesh < of_stage {
                change(before, now)
            } else {
                Change::Moved
            }
        });
        let changes = alike.then(|| changes.collect());
        self.instances.clone_from(&frame.instances);
        changes
    }
}

fn change(before: &Instance, now: &Instance) -> Change {
    let [was, is] = [&before.triangles, &now.triangles];
    match look_of(before) == look_of(now) && was.start == is.start {
        true if was.end == is.end => Change::Still,
        true if was.end < is.end => Change::Grown(was.end),
        _ => Change::Moved,
    }
}

/// All of an instance that decides on its pixels, besides the triangles. Every field is named, so that a new one cannot be
/// forgotten.
fn look_of(instance: &Instance) -> impl PartialEq + use<> {
    let Instance {
        mesh,
        world_from_mesh: Pose {
            rotation,
            translation,
        },
        colour,
        opacity,
        triangles: _,
        casts_shadow,
        outline,
        flat,
    } = instance;
    // Numbers that are equal need not have the same bits.
    let rotation = rotation.to_cols_array().map(f64::to_bits);
    let translation = translation.to_array().map(f64::to_bits);
    let numbers = [opacity, flat].map(|number| number.to_bits());
    let marks = (*mesh, *colour, *casts_shadow, *outline);
    (rotation, translation, numbers, marks)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::render::Projection;
    use glam::DVec3;

    fn camera(near: f64) -> Camera {
        Camera {
            world_from_camera: Pose::IDENTITY,
            projection: Projection::Orthographic { height: 1.0 },
            near,
            far: 10.0,
        }
    }

    fn instance(mesh: usize, end: u32) -> Instance {
        Instance {
            mesh,
            world_from_mesh: Pose::IDENTITY,
            colour: [1, 2, 3],
            opacity: 1.0,
            triangles: 0..end,
            casts_shadow: false,
            outline: None,
            flat: 0.0,
        }
    }

    #[test]
    fn changes_are_told_apart() {
        let mut last = LastFrame::default();
        let mut frame = Frame {
            instances: vec![
                instance(0, 4),
                instance(1, 4),
                instance(2, 4),
                instance(7, 4),
            ],
            ..Frame::default()
        };
        assert_eq!(last.replace(&frame, &camera(1.0), 7), None);
        frame.instances[1].triangles = 0..9;
        frame.instances[2].world_from_mesh.translation = -DVec3::ZERO;
        let changes = last.replace(&frame, &camera(1.0), 7).unwrap();
        let expected = [
            Change::Still,
            Change::Grown(4),
            Change::Moved,
            Change::Moved,
        ];
        assert_eq!(changes, expected);
        frame.instances[1].triangles = 0..4;
        let changes = last.replace(&frame, &camera(1.0), 8).unwrap();
        let expected = [Change::Still, Change::Moved, Change::Still, Change::Still];
        assert_eq!(changes, expected);
        assert_eq!(last.replace(&frame, &camera(2.0), 8), None);
        frame.instances.pop();
        assert_eq!(last.replace(&frame, &camera(2.0), 8), None);
        last.forget();
        assert_eq!(last.replace(&frame, &camera(2.0), 8), None);
    }
}
