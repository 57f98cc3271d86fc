//! Cameras of a motion: a fixed one that includes everything tightly, or one per frame along a path.
//!
//! A moving camera keeps its distance, so that nothing seems to grow or shrink unless a zoom is requested: the distance
//! is the smallest from which the whole motion is visible from every point of the path.

use super::bounds;
use crate::math::{Pose, sin_cos};
use crate::model::view::{NamedView, View, ViewProjection};
use crate::render::camera::{NEAR_SHARE, ViewDirection, fit_within};
use crate::render::{Camera, Projection};
use crate::scene::Scene;
use crate::sorting::sort_by_number;
use glam::DVec3;
use std::borrow::Cow;

/// Number of directions in which the outline of the motion is taken; between them less than a percent of it is missed.
const OUTLINE: usize = 256;

/// Number of positions on the path from which the whole motion must be visible.
const PLACES: usize = 256;

/// Free space in front of the eye, relative to the motion's half extent.
const EYE_CLEARANCE: f64 = 0.05;

/// Height of a line of captions plus its distance from the border, as a fraction of the height.
const CAPTIONS: f64 = 0.08;

/// Largest elevation, in radians: straight above and below.
const ZENITH: f64 = std::f64::consts::FRAC_PI_2;

/// Points are flat along an axis if they extend along it by less than this share of how far they extend along the others.
const FLAT: f64 = 1e-9;

/// The view of a scene whose motion stays within `points`: a flat mechanism that draws itself is looked at squarely, in a
/// parallel view, unless a direction is given.
pub fn view_of<'v>(scene: &'v Scene, points: &[DVec3]) -> Cow<'v, View> {
    let view = &*scene.view;
    let is_own = scene.mechanism.has_no_shapes() && !view.is_aimed;
    let flat = flat_axis(points).filter(|_| is_own && view.camera_path.is_empty());
    let Some(axis) = flat else {
        return Cow::Borrowed(view);
    };
    let up = view.up.axis().to_array().iter().position(|x| *x == 1.0);
    let named = match (axis + 3 - up.unwrap_or(2)) % 3 {
        0 => NamedView::Top,
        1 => NamedView::Side,
        _ => NamedView::Front,
    };
    let mut view = view.clone();
    view.look_from(named);
    Cow::Owned(view)
}

/// The axis along which points do not extend, if they do along both others.
fn flat_axis(points: &[DVec3]) -> Option<usize> {
    let [low, high] = bounds::box_of(points)?;
    let extents = (high - low).to_array();
    let mut order = [0, 1, 2];
    sort_by_number(&mut order, |i| extents[*i]);
    let [least, middle, most] = order.map(|axis| extents[axis]);
    (least <= FLAT * most && middle > FLAT * most).then_some(order[0])
}

/// The cameras of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Cameras {
    /// The camera of the first frame, or of all.
    pub first: Camera,
    /// One per frame if the camera moves, otherwise none.
    pub moving: Vec<Camera>,
}

impl Cameras {
    /// Cameras for a picture `aspect` times as wide as high, at the instants `times` of a motion that lasts `duration`
    /// and stays within `points`.
    pub fn new(
        view: &View,
        up: DVec3,
        points: &[DVec3],
        aspect: f64,
        (times, duration): (&[f64], f64),
    ) -> Self {
        if view.camera_path.is_empty() {
            return Self {
                first: still_camera(view, up, points, aspect),
                moving: Vec::new(),
            };
        }
        let path = CameraOrbit::new(view, up, points, (view_projection(view), aspect), duration);
        let reach = path.reach(times);
        let moving: Vec<Camera> = times.iter().map(|t| path.camera_at(*t, reach)).collect();
        Self {
            first: moving
                .first()
                .copied()
                .unwrap_or(path.camera_at(0.0, reach)),
            moving,
        }
    }

    /// All cameras.
    pub fn all(&self) -> &[Camera] {
        if self.moving.is_empty() {
            std::slice::from_ref(&self.first)
        } else {
            &self.moving
        }
    }
}

/// The fixed camera in the direction of the view that includes the points tightly; a path of the view is ignored.
pub fn still_camera(view: &View, up: DVec3, points: &[DVec3], aspect: f64) -> Camera {
    let direction = ViewDirection {
        azimuth: view.azimuth,
        elevation: view.elevation,
        up,
    };
    let points = points.iter().copied();
    fit_within(
        points,
        &direction,
        view_projection(view),
        aspect,
        view_margins(view),
    )
}

fn view_projection(view: &View) -> Projection {
    match view.projection {
        ViewProjection::Perspective { fov_y } => Projection::Perspective { fov_y },
        ViewProjection::Orthographic => Projection::Orthographic { height: 1.0 },
    }
}

/// Free fractions of the picture's width and height: title and values are above and below the mechanism, not on it.
fn view_margins(view: &View) -> [f64; 2] {
    let captions = if view.captions { CAPTIONS } else { 0.0 };
    [view.margin, view.margin.max(captions)].map(|margin| 2.0 * margin)
}

/// A view with its path, and the points to include.
struct CameraOrbit<'a> {
    view: &'a View,
    up: DVec3,
    duration: f64,
    projection: Projection,
    /// Slopes of the frame's sides where they keep the margin, x and y; of a parallel projection shares of its height.
    slopes: [f64; 2],
    middle: DVec3,
    outline: Vec<DVec3>,
    /// Greatest distance of a point from the middle.
    radius: f64,
}

impl<'a> CameraOrbit<'a> {
    fn new(
        view: &'a View,
        up: DVec3,
        points: &[DVec3],
        (projection, aspect): (Projection, f64),
        duration: f64,
    ) -> Self {
        let [low, high] = bounds::box_of(points).unwrap_or([-0.5 * DVec3::ONE, 0.5 * DVec3::ONE]);
        let middle = 0.5 * (low + high);
        let free = view_margins(view).map(|margin| 1.0 - margin);
        let half_height = match projection {
            Projection::Perspective { fov_y } => half_tangent(0.5 * fov_y),
            Projection::Orthographic { .. } => 0.5,
        };
        let radius = points
            .iter()
            .map(|p| p.distance(middle))
            .fold(0.0, f64::max);
        Self {
            view,
            up,
            duration,
            projection,
            slopes: [half_height * aspect * free[0], half_height * free[1]],
            middle,
            outline: bounds::point_outline(points, OUTLINE),
            radius: if radius > 0.0 { radius } else { 0.5 },
        }
    }

    /// Eye direction and target of the camera at an instant.
    fn direction(&self, time: f64) -> (ViewDirection, DVec3) {
        let now = self.view.camera_path.at(time);
        let turned = self.view.camera_path.orbit * time / self.duration;
        let elevation = now.elevation.unwrap_or(self.view.elevation);
        let direction = ViewDirection {
            azimuth: now.azimuth.unwrap_or(self.view.azimuth) + turned,
            elevation: elevation.clamp(-ZENITH, ZENITH),
            up: self.up,
        };
        (direction, now.target.unwrap_or(self.middle))
    }

    /// Smallest distance, or height of a parallel projection, from which the whole motion is visible from everywhere on
    /// the path.
    fn reach(&self, times: &[f64]) -> f64 {
        let stride = times.len().div_ceil(PLACES).max(1);
        let places = times.iter().step_by(stride).chain(times.last());
        let reaches = places.map(|time| {
            let (direction, target) = self.direction(*time);
            let camera_from_world = direction.axes().transpose();
            let points = self
                .outline
                .iter()
                .map(|p| camera_from_world * (*p - target));
            let reach = points.map(|p| {
                let aside = (p.x.abs() / self.slopes[0]).max(p.y.abs() / self.slopes[1]);
                match self.projection {
                    Projection::Perspective { .. } => p.z + aside.max(EYE_CLEARANCE * self.radius),
                    Projection::Orthographic { .. } => aside,
                }
            });
            reach.fold(0.0, f64::max)
        });
        let reach = reaches.fold(0.0, f64::max);
        if reach > 0.0 { reach } else { self.radius }
    }

    fn camera_at(&self, time: f64, reach: f64) -> Camera {
        let (direction, target) = self.direction(time);
        let now = self.view.camera_path.at(time);
        let zoom = now.zoom.unwrap_or(1.0);
        let deepest = self.radius + target.distance(self.middle);
        let (projection, distance) = match self.projection {
            Projection::Perspective { .. } => {
                (self.projection, now.distance.unwrap_or(reach / zoom))
            }
            Projection::Orthographic { .. } => {
                // A parallel projection has no distance: it is as high as a perspective would be at the target.
                let of_distance = |d: f64| 2.0 * d * half_tangent(0.5 * DEFAULT_FOV);
                let height = now.distance.map_or(reach / zoom, of_distance);
                (Projection::Orthographic { height }, 2.0 * deepest)
            }
        };
        let axes = direction.axes();
        let far = distance + deepest * (1.0 + EYE_CLEARANCE);
        let near = distance - deepest * (1.0 + EYE_CLEARANCE);
        Camera {
            world_from_camera: Pose {
                rotation: axes,
                translation: target + axes.z_axis * distance,
            },
            projection,
            near: near.max(far * NEAR_SHARE),
            far,
        }
    }
}

fn half_tangent(angle: f64) -> f64 {
    let (sin, cos) = sin_cos(angle);
    sin / cos
}

/// Full vertical angle of the perspective that corresponds to a distance in a parallel projection.
const DEFAULT_FOV: f64 = match ViewProjection::DEFAULT {
    ViewProjection::Perspective { fov_y } => fov_y,
    ViewProjection::Orthographic => 0.0,
};

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::model::camera_path::{CameraKey, CameraPath};
    use crate::scene::{Overrides, builtin, load_scene};

    const SIZE: [u32; 2] = [640, 480];

    fn view(path: CameraPath, projection: ViewProjection) -> View {
        let source = builtin::find_builtin("four-bar").unwrap();
        let scene = load_scene(&source, &Overrides::default()).unwrap();
        let mut view = View::clone(&scene.view);
        view.camera_path = path;
        view.projection = projection;
        view.margin = 0.05;
        view.captions = false;
        view
    }

    fn points() -> Vec<DVec3> {
        let corner =
            |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2));
        (0..8)
            .map(|k| corner(k) * DVec3::new(9.0, 2.0, 4.0) + DVec3::new(50.0, -7.0, 1.0))
            .collect()
    }

    fn times() -> Vec<f64> {
        (0..=100).map(|k| 0.04 * f64::from(k)).collect()
    }

    fn cameras(view: &View) -> Cameras {
        Cameras::new(view, DVec3::Z, &points(), 4.0 / 3.0, (&times(), 4.0))
    }

    const PERSPECTIVE: ViewProjection = ViewProjection::Perspective { fov_y: 0.6 };

    /// The whole motion is inside every picture, it touches the margin of one, and its size never changes.
    #[test]
    fn an_orbit_holds_everything_at_one_distance() {
        for projection in [PERSPECTIVE, ViewProjection::Orthographic] {
            let orbit = CameraPath {
                orbit: 3.0,
                ..CameraPath::default()
            };
            let cameras = cameras(&view(orbit, projection));
            let mut widest: f64 = 0.0;
            let middle = DVec3::new(54.5, -6.0, 3.0);
            for camera in &cameras.moving {
                for point in points() {
                    let [x, y, depth] = camera.project(point, SIZE).unwrap();
                    assert!(depth > camera.near && depth < camera.far);
                    let share = (x / 320.0 - 1.0).abs().max((y / 240.0 - 1.0).abs());
                    widest = widest.max(share);
                }
                let eye = camera.world_from_camera.translation;
                let first = cameras.first.world_from_camera.translation;
                assert!((eye.distance(middle) - first.distance(middle)).abs() < 1e-9);
                assert_eq!(camera.projection, cameras.first.projection);
                let [x, y, _] = camera.project(middle, SIZE).unwrap();
                assert!((x - 320.0).abs() + (y - 240.0).abs() < 1e-6);
            }
            assert!(
                (0.8..=0.9 + 1e-9).contains(&widest),
                "{projection:?}: {widest}"
            );
        }
    }

    #[test]
    fn keys_say_direction_distance_and_target() {
        let key = CameraKey {
            azimuth: Some(-0.5),
            elevation: Some(0.3),
            distance: Some(70.0),
            target: Some(DVec3::new(52.0, -6.0, 2.0)),
            ..CameraKey::default()
        };
        let path = CameraPath {
            keys: vec![key.clone()],
            orbit: 0.0,
        };
        let cameras = cameras(&view(path, PERSPECTIVE));
        let direction = ViewDirection {
            azimuth: -0.5,
            elevation: 0.3,
            up: DVec3::Z,
        };
        let eye = key.target.unwrap() + 70.0 * direction.axes().z_axis;
        for camera in &cameras.moving {
            assert!(camera.world_from_camera.translation.distance(eye) < 1e-12);
            assert_eq!(camera.world_from_camera.rotation, direction.axes());
        }
    }

    #[test]
    fn zoom_brings_everything_nearer_by_its_factor() {
        let zoomed = |zoom| CameraPath {
            keys: vec![CameraKey {
                zoom,
                ..CameraKey::default()
            }],
            orbit: 0.0,
        };
        let middle = DVec3::new(54.5, -6.0, 3.0);
        let distance = |zoom| {
            let cameras = cameras(&view(zoomed(zoom), PERSPECTIVE));
            cameras.first.world_from_camera.translation.distance(middle)
        };
        assert!((distance(Some(2.0)) * 2.0 - distance(None)).abs() < 1e-9);
    }

    /// An eye inside a body, or straight above: there is a camera, and it is finite.
    #[test]
    fn odd_places_still_make_a_camera() {
        for (elevation, distance) in [(ZENITH, None), (-ZENITH, None), (0.2, Some(1e-6))] {
            let key = CameraKey {
                elevation: Some(elevation),
                distance,
                ..CameraKey::default()
            };
            let path = CameraPath {
                keys: vec![key],
                orbit: 7.0,
            };
            for projection in [PERSPECTIVE, ViewProjection::Orthographic] {
                for camera in cameras(&view(path.clone(), projection)).all() {
                    assert!(camera.world_from_camera.is_finite());
                    assert!(camera.near > 0.0 && camera.far > camera.near);
                }
            }
        }
    }
}
