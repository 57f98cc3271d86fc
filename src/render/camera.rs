//! Cameras that fit given points as tightly as possible, and the projection of points to pixels.
//!
//! Computes in f64, without pixels or matrices of a graphics interface.

use super::depth_order::Eye;
use super::{Camera, Projection};
use crate::math::{Pose, sin_cos};
use glam::{DMat3, DVec3};

/// Clearance between the eye and the nearest point, as a share of the points' extent, when the frame
/// itself would let the eye touch them (all points on one line of sight).
const EYE_CLEARANCE: f64 = 0.05;
/// Extent assumed for a single point, in the scene's unit, so that it can be shown.
const POINT_EXTENT: f64 = 1.0;
/// Points that are closer together than this fraction of their distance from the origin coincide in f64.
const EXTENT_RESOLUTION: f64 = 1e-12;
/// Margin between the points and the near and far planes, as a fraction of the extent, so that parts which move between
/// the fitted points or lie below them are not clipped.
const DEPTH_SLACK: f64 = 0.05;
/// The near plane is never closer than this share of the far plane's distance: f32 depth keeps
/// four digits at the far end.
pub const NEAR_SHARE: f64 = 1e-4;
/// Largest share of the frame that a margin may take.
const MAX_MARGIN: f64 = 0.9;

/// The direction from which a scene is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewDirection {
    /// Angle of the eye about `up`, in radians. With z up, 0 is on the x axis and π/2 on the y axis.
    pub azimuth: f64,
    /// Angle of the eye above the horizon, in radians, -π/2 to π/2.
    pub elevation: f64,
    /// The direction that is up in the picture; unit length.
    pub up: DVec3,
}

impl ViewDirection {
    /// The camera's axes in the world: x right, y up, z towards the viewer.
    pub fn axes(&self) -> DMat3 {
        let (sin_azimuth, cos_azimuth) = sin_cos(self.azimuth);
        let (sin_elevation, cos_elevation) = sin_cos(self.elevation);
        let right = DVec3::new(-sin_azimuth, cos_azimuth, 0.0);
        let back = DVec3::new(
            cos_elevation * cos_azimuth,
            cos_elevation * sin_azimuth,
            sin_elevation,
        );
        Pose::from_z_axis(self.up).rotation * DMat3::from_cols(right, back.cross(right), back)
    }
}

/// The tightest camera from a direction: every finite point is inside the frame minus its margin, and at least two
/// touch it.
///
/// `aspect` is width over height; `margin` is the fraction of the frame's half width and half height that is kept free.
/// The height of an orthographic `projection` is ignored. Closed form: each side of the frame is a plane that supports
/// the points, and the eye is where opposite planes meet. Without points: a unit around the origin.
pub fn fit_camera(
    points: impl Iterator<Item = DVec3> + Clone,
    view: &ViewDirection,
    projection: Projection,
    aspect: f64,
    margin: f64,
) -> Camera {
    fit_within(points, view, projection, aspect, [margin; 2])
}

/// The same with margins of their own for the width and the height.
pub fn fit_within(
    points: impl Iterator<Item = DVec3> + Clone,
    view: &ViewDirection,
    projection: Projection,
    aspect: f64,
    margins: [f64; 2],
) -> Camera {
    let axes = view.axes();
    let free = margins.map(|margin| 1.0 - margin.clamp(0.0, MAX_MARGIN));
    // Slopes of the planes through the sides of the frame less its margin; zero in a parallel projection.
    let slope = match projection {
        Projection::Perspective { fov_y } => {
            let (sin, cos) = sin_cos(0.5 * fov_y);
            sin / cos
        }
        Projection::Orthographic { .. } => 0.0,
    };
    let slopes = [slope * aspect * free[0], slope * free[1]];
    // These planes support the points, as the camera's axes see them.
    let inside = points
        .filter(|point| point.is_finite())
        .map(|point| axes.transpose() * point);
    let support = Support::of(inside, slopes);
    let (projection, eye) = match projection {
        Projection::Perspective { fov_y } => (
            Projection::Perspective { fov_y },
            support.perspective_eye(slopes),
        ),
        Projection::Orthographic { .. } => {
            // The frame is as high as both spans ask for; a single point has an assumed extent.
            let spans = [0, 1].map(|k| support.reach[k][0] + support.reach[k][1]);
            let height = (spans[0] / (aspect * free[0])).max(spans[1] / free[1]);
            let height = if height > support.extent * EXTENT_RESOLUTION {
                height
            } else {
                support.extent
            };
            (
                Projection::Orthographic { height },
                support.eye_at(support.back + support.extent),
            )
        }
    };
    // Near and far enclose the points with some slack, and are not too far apart for a depth in f32.
    let slack = DEPTH_SLACK * support.extent;
    let far = eye.z - support.front + slack;
    Camera {
        world_from_camera: Pose {
            rotation: axes,
            translation: axes * eye,
        },
        projection,
        near: (eye.z - support.back - slack).max(far * NEAR_SHARE),
        far,
    }
}

/// Contact of the points with the planes of a frame with given slopes, in coordinates along the camera's axes.
struct Support {
    /// For x and y: greatest of `+c + slope z` and of `-c + slope z`.
    reach: [[f64; 2]; 2],
    /// Greatest z, nearest to the viewer.
    back: f64,
    /// Least z.
    front: f64,
    /// Largest edge of the bounding box, or the assumed extent of a single point.
    extent: f64,
}

impl Support {
    fn of(points: impl Iterator<Item = DVec3>, slopes: [f64; 2]) -> Self {
        let mut reach = [[f64::NEG_INFINITY; 2]; 2];
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for point in points {
            for k in 0..2 {
                reach[k][0] = reach[k][0].max(point[k] + slopes[k] * point.z);
                reach[k][1] = reach[k][1].max(-point[k] + slopes[k] * point.z);
            }
            (low, high) = (low.min(point), high.max(point));
        }
        if low.x > high.x {
            return Self::of([DVec3::splat(-0.5), DVec3::splat(0.5)].into_iter(), slopes);
        }
        let extent = (high - low).max_element();
        let resolution = EXTENT_RESOLUTION * high.abs().max(low.abs()).max_element();
        Self {
            reach,
            back: high.z,
            front: low.z,
            extent: if extent > resolution {
                extent
            } else {
                POINT_EXTENT
            },
        }
    }

    fn perspective_eye(&self, slopes: [f64; 2]) -> DVec3 {
        let tight = (0..2)
            .map(|k| (self.reach[k][0] + self.reach[k][1]) / (2.0 * slopes[k]))
            .fold(f64::NEG_INFINITY, f64::max);
        let clearance = if self.back > self.front || tight > self.back {
            EYE_CLEARANCE * self.extent
        } else {
            self.extent
        };
        self.eye_at(tight.max(self.back + clearance))
    }

    /// The eye at depth `z`, with equal margins on opposite sides.
    fn eye_at(&self, z: f64) -> DVec3 {
        let [x, y] = [0, 1].map(|k| 0.5 * (self.reach[k][0] - self.reach[k][1]));
        DVec3::new(x, y, z)
    }
}

impl Camera {
    /// Pixel and distance of a world point: x to the right and y down from the picture's top left corner,
    /// and the distance in front of the eye along the line of sight.
    ///
    /// `None` for a point behind the near plane of a perspective, or not finite.
    pub fn project(&self, point: DVec3, size: [u32; 2]) -> Option<[f64; 3]> {
        let local = self.world_from_camera.inverse().transform_point(point);
        let distance = -local.z;
        let divisor = match self.projection {
            Projection::Perspective { .. } => distance,
            Projection::Orthographic { .. } => 1.0,
        };
        if !local.is_finite() || (self.is_perspective() && distance < self.near) {
            return None;
        }
        let scale = self.pixels_per_unit(size) / divisor;
        Some([
            0.5 * f64::from(size[0]) + scale * local.x,
            0.5 * f64::from(size[1]) - scale * local.y,
            distance,
        ])
    }

    /// Pixels that one unit spans: at distance 1 in a perspective, anywhere in a parallel projection.
    pub fn pixels_per_unit(&self, size: [u32; 2]) -> f64 {
        match self.projection {
            Projection::Perspective { fov_y } => {
                let (sin, cos) = sin_cos(0.5 * fov_y);
                0.5 * f64::from(size[1]) * cos / sin
            }
            Projection::Orthographic { height } => f64::from(size[1]) / height,
        }
    }

    /// The viewing geometry of instances, in a picture of `size` pixels.
    pub fn eye(&self, size: [u32; 2]) -> Eye {
        Eye {
            camera_from_world: self.world_from_camera.inverse(),
            perspective: self.is_perspective(),
            pixel: 1.0 / self.pixels_per_unit(size),
        }
    }

    /// Whether lines of sight meet in the eye.
    pub fn is_perspective(&self) -> bool {
        matches!(self.projection, Projection::Perspective { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIZE: [u32; 2] = [640, 480];
    const PERSPECTIVE: Projection = Projection::Perspective { fov_y: 0.6 };
    const PARALLEL: Projection = Projection::Orthographic { height: 0.0 };

    fn view(azimuth: f64, elevation: f64) -> ViewDirection {
        ViewDirection {
            azimuth,
            elevation,
            up: DVec3::Z,
        }
    }

    /// Greatest |x| and |y| of the projected points in units of the half frame.
    fn spread(camera: &Camera, points: &[DVec3]) -> [f64; 2] {
        points.iter().fold([0.0, 0.0], |[a, b]: [f64; 2], point| {
            let Some([x, y, depth]) = camera.project(*point, SIZE) else {
                return [f64::INFINITY; 2];
            };
            assert!(depth > camera.near && depth < camera.far);
            [
                a.max((x / 320.0 - 1.0).abs()),
                b.max((y / 240.0 - 1.0).abs()),
            ]
        })
    }

    proptest! {
        #[test]
        fn fitted_points_fill_the_frame_to_its_margin(
            raw in prop::collection::vec([-20.0..20.0f64, -20.0..20.0, -20.0..20.0], 0..40),
            azimuth in -4.0..4.0f64, elevation in -1.57..1.57f64, parallel: bool,
        ) {
            // The cube makes the frame the active constraint: without it a needle along the line of sight would be
            // limited by the eye's clearance instead.
            let cube = (0..8).map(|k| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) * 40.0 - 20.0);
            let points: Vec<DVec3> = raw.into_iter().map(DVec3::from).chain(cube).collect();
            let projection = if parallel { PARALLEL } else { PERSPECTIVE };
            let camera = fit_camera(points.iter().copied(), &view(azimuth, elevation), projection, 4.0 / 3.0, 0.1);
            let [x, y] = spread(&camera, &points);
            prop_assert!(x <= 0.9 + 1e-9 && y <= 0.9 + 1e-9);
            prop_assert!((x.max(y) - 0.9).abs() < 1e-9, "nothing touches: {x} {y}");
        }
    }

    #[test]
    fn degenerate_sets_still_make_a_camera() {
        let line: Vec<DVec3> = (0..5).map(|k| DVec3::X * f64::from(k)).collect();
        let sets: [&[DVec3]; 5] = [
            &[],
            &[DVec3::new(3.0, 4.0, 5.0)],
            &[DVec3::ONE, DVec3::ONE],
            &line,
            &[DVec3::ZERO, DVec3::NAN],
        ];
        for points in sets {
            for projection in [PERSPECTIVE, PARALLEL] {
                let camera = fit_camera(
                    points.iter().copied(),
                    &view(0.0, 0.0),
                    projection,
                    1.0,
                    0.1,
                );
                assert!(camera.world_from_camera.is_finite());
                assert!(camera.near > 0.0 && camera.far > camera.near && camera.far.is_finite());
                let finite: Vec<DVec3> = points.iter().copied().filter(|p| p.is_finite()).collect();
                assert!(spread(&camera, &finite).iter().all(|c| *c <= 1.0));
            }
        }
    }

    #[test]
    fn the_eye_stands_where_the_angles_say() {
        let axes = view(0.0, 0.0).axes();
        assert!((axes.z_axis - DVec3::X).length() < 1e-15);
        assert!((axes.y_axis - DVec3::Z).length() < 1e-15);
        let above = view(0.3, std::f64::consts::FRAC_PI_2).axes();
        assert!((above.z_axis - DVec3::Z).length() < 1e-15);
        assert!((above.determinant() - 1.0).abs() < 1e-14);
    }
}
