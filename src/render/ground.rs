//! The ground seen through a camera: the point of the plane that a pixel shows, and its appearance without bodies.

use super::{Camera, Ground, look};
use crate::math::Pose;
use glam::{DMat3, DVec3};

/// How far below its plane the ground is drawn, so that a face that rests exactly on the ground is in front of it,
/// whatever the rounding. In radii: ten times the error of a vertex in f32 at a distance of two radii. In pixels: five
/// times the error of a slanted face's depth when its corners are rounded to 1/256 pixel.
const SINK_RADII: f64 = 4e-6;
/// See [`SINK_RADII`]; the sum of both is far too small to be visible.
const SINK_PIXELS: f64 = 1.0 / 64.0;
/// Pixels from the middle of a grid line within which it covers any part of a pixel.
const LINE_REACH: f64 = look::GRID_HALF_WIDTH as f64 + 0.5;
/// More than the rounding of coordinates in f32, in pitches or radii.
const ROUNDING: f64 = 1e-3;

/// A plane through the pixels of one picture.
///
/// Each form `[a, b, c]` is `a x + b y + c` of a pixel coordinate (x right, y down, pixel centres at half
/// integers): the plane's coordinates are `u / w` and `v / w` in units of the ground's radius, which is
/// what perspective makes of a plane. `w` is positive where the plane is in front of the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundView {
    /// First coordinate times `w`.
    pub u: [f64; 3],
    /// Second coordinate times `w`.
    pub v: [f64; 3],
    /// The common divisor.
    pub w: [f64; 3],
    /// Distance along the line of sight times this is 1 for the perspective's `w`; for a parallel
    /// projection the distance itself is the form `distance`.
    pub distance: [f64; 3],
    /// Radii between grid lines; 0 for none.
    pitch: f64,
}

/// The ground's axes in the world: columns are first, second and normal.
pub fn ground_axes(ground: &Ground) -> DMat3 {
    Pose::from_z_axis(ground.normal).rotation
}

/// How far below its plane the ground is drawn.
fn ground_sink(ground: &Ground, camera: &Camera, size: [u32; 2]) -> f64 {
    let away = if camera.is_perspective() {
        (ground.centre - camera.world_from_camera.translation).length()
    } else {
        1.0
    };
    SINK_RADII * ground.radius + SINK_PIXELS * away / camera.pixels_per_unit(size)
}

fn form_value(form: &[f64; 3], x: f64, y: f64) -> f64 {
    form[0] * x + form[1] * y + form[2]
}

impl GroundView {
    /// The ground through a camera; `None` if its upper side is not visible.
    pub fn new(ground: &Ground, camera: &Camera, size: [u32; 2]) -> Option<Self> {
        let axes = camera.world_from_camera.rotation.transpose() * ground_axes(ground);
        let centre = camera
            .world_from_camera
            .inverse()
            .transform_point(ground.centre);
        let centre = centre - axes.z_axis * ground_sink(ground, camera, size);
        let normal = axes.z_axis;
        // The line of sight of a pixel is origin + s direction; both are affine in the pixel.
        let scale = 1.0 / camera.pixels_per_unit(size);
        let plane_at = [
            DVec3::X * scale,
            DVec3::NEG_Y * scale,
            DVec3::new(
                -0.5 * f64::from(size[0]) * scale,
                0.5 * f64::from(size[1]) * scale,
                0.0,
            ),
        ];
        let seen_from_above = if camera.is_perspective() {
            -normal.dot(centre)
        } else {
            normal.z
        };
        // Not a number, edge-on and seen from below are all refused by the one comparison.
        let visible = seen_from_above > 0.0 && ground.radius > 0.0 && centre.is_finite();
        if !visible {
            return None;
        }
        let (origin, direction): ([DVec3; 3], [DVec3; 3]) = if camera.is_perspective() {
            let [x, y, corner] = plane_at;
            ([DVec3::ZERO; 3], [x, y, corner - DVec3::Z])
        } else {
            (plane_at, [DVec3::ZERO, DVec3::ZERO, DVec3::NEG_Z])
        };
        Some(Self::from_sight(ground, &axes, centre, origin, direction))
    }

    /// Intersects the lines of sight with the plane, form by form.
    fn from_sight(
        ground: &Ground,
        axes: &DMat3,
        centre: DVec3,
        origin: [DVec3; 3],
        direction: [DVec3; 3],
    ) -> Self {
        let normal = axes.z_axis;
        let parallel = direction[0] == DVec3::ZERO;
        // s = numerator / fall, where both are at most affine and one of them is constant.
        let fall = direction.map(|d| -normal.dot(d));
        let mut numerator = origin.map(|o| normal.dot(o));
        numerator[2] -= normal.dot(centre);
        let (height, drop) = (numerator[2], fall[2]);
        let along = |axis: DVec3| -> [f64; 3] {
            std::array::from_fn(|k| {
                let offset = if k == 2 { axis.dot(centre) } else { 0.0 };
                let value = if parallel {
                    axis.dot(origin[k]) + numerator[k] / drop * axis.dot(direction[2]) - offset
                } else {
                    height * axis.dot(direction[k]) - axis.dot(centre) * fall[k]
                };
                value / ground.radius
            })
        };
        let pitch = if ground.grid > 0.0 {
            ground.grid / ground.radius
        } else {
            0.0
        };
        Self {
            u: along(axes.x_axis),
            v: along(axes.y_axis),
            w: if parallel { [0.0, 0.0, 1.0] } else { fall },
            distance: if parallel {
                numerator.map(|n| n / drop)
            } else {
                [0.0, 0.0, height]
            },
            pitch,
        }
    }

    /// Distance of the plane along the line of sight, `None` above the horizon.
    pub fn distance_at(&self, x: f64, y: f64) -> Option<f64> {
        let w = form_value(&self.w, x, y);
        (w > 0.0).then(|| form_value(&self.distance, x, y) / w)
    }

    /// Nearness of the plane over the picture as vertices measure it, a form of the pixel coordinate: one over the
    /// distance, or minus the distance in a parallel projection.
    pub fn nearness(&self, perspective: bool) -> [f64; 3] {
        if perspective {
            self.w.map(|w| w / self.distance[2])
        } else {
            self.distance.map(|d| -d)
        }
    }

    /// Whether the pixel with centre (x, y) sees the ground.
    pub fn is_seen(&self, x: f64, y: f64) -> bool {
        let w = form_value(&self.w, x, y);
        let (u, v) = (form_value(&self.u, x, y), form_value(&self.v, x, y));
        // Not a number is not seen.
        w > 0.0 && u * u + v * v < w * w
    }

    /// Where pixels of one row with centres at `x` see the ground.
    // One index for several arrays: what the compiler turns into vector code.
    #[allow(clippy::needless_range_loop)]
    #[inline(always)]
    pub fn row<const N: usize>(&self, x: [f64; N], y: f64) -> GroundRow<N> {
        let mut row = GroundRow {
            seen: [false; N],
            at: [[0.0; N]; 2],
            share: [0.0; N],
            w: [0.0; N],
        };
        for k in 0..N {
            row.w[k] = form_value(&self.w, x[k], y);
            row.at[0][k] = form_value(&self.u, x[k], y) / row.w[k];
            row.at[1][k] = form_value(&self.v, x[k], y) / row.w[k];
        }
        for k in 0..N {
            let [u, v] = [row.at[0][k], row.at[1][k]];
            row.share[k] = u * u + v * v;
            // Not a number is not seen.
            row.seen[k] = row.w[k] > 0.0 && row.share[k] < 1.0;
        }
        row
    }

    /// Cover by grid lines of the pixels of a row.
    #[inline(always)]
    pub fn lines<const N: usize>(&self, row: &GroundRow<N>) -> [f32; N] {
        if self.pitch <= 0.0 {
            return [0.0; N];
        }
        let mut lines = self.lines_along(&self.u, &row.at[0], &row.w);
        let others = self.lines_along(&self.v, &row.at[1], &row.w);
        for (line, other) in lines.iter_mut().zip(others) {
            *line = look::larger_of(*line, other);
        }
        lines
    }

    /// Cover by the grid lines at whole multiples of one coordinate, whose form and values are given.
    #[allow(clippy::needless_range_loop)]
    #[inline(always)]
    fn lines_along<const N: usize>(
        &self,
        form: &[f64; 3],
        value: &[f64; N],
        w: &[f64; N],
    ) -> [f32; N] {
        let mut lines = [0.0; N];
        if self.is_between_lines(form, value, w) {
            return lines;
        }
        for k in 0..N {
            let step = |i: usize| ((form[i] - value[k] * self.w[i]) / w[k]).abs();
            let footprint = (step(0) + step(1)) / self.pitch;
            lines[k] = look::grid_line((value[k] / self.pitch) as f32, footprint as f32);
        }
        lines
    }

    /// Whether no pixel of a row can touch a grid line: along a row the coordinate has its extremes at the ends, and so
    /// have both parts of the fraction that a pixel spans.
    #[inline(always)]
    fn is_between_lines<const N: usize>(
        &self,
        form: &[f64; 3],
        value: &[f64; N],
        w: &[f64; N],
    ) -> bool {
        let ends = [0, N - 1];
        let least = w[0].min(w[N - 1]);
        let most = |i: usize| {
            let [a, b] = ends.map(|k| (form[i] - value[k] * self.w[i]).abs());
            a.max(b)
        };
        let scale = 1.0 / self.pitch;
        let footprint = (most(0) + most(1)) / least * scale;
        let reach = footprint * (LINE_REACH * (1.0 + ROUNDING)) + ROUNDING;
        let [a, b] = ends.map(|k| value[k] * scale);
        // Not a number fails the comparison.
        least > 0.0 && (a.min(b) - reach).ceil() > a.max(b) + reach
    }

    /// Least and greatest coordinates of the ground that pixels with centres from the first to the last `x` and `y` may
    /// see; `None` if they see nothing of it.
    pub fn reach(&self, x: [f64; 2], y: [f64; 2]) -> Option<[[f32; 2]; 2]> {
        let corners = [[x[0], y[0]], [x[1], y[0]], [x[0], y[1]], [x[1], y[1]]];
        let value = |form: &[f64; 3]| corners.map(|[x, y]| form_value(form, x, y));
        let w = value(&self.w);
        if w.iter().all(|w| *w <= 0.0) {
            return None;
        }
        // Across the horizon it may be anywhere.
        let is_below = w.iter().all(|w| *w > 0.0);
        let range = |form: &[f64; 3]| {
            let at = value(form).into_iter().zip(w).map(|(value, w)| value / w);
            let low = at.clone().fold(1.0, f64::min) - ROUNDING;
            let high = at.fold(-1.0, f64::max) + ROUNDING;
            if is_below {
                [low.max(-1.0), high.min(1.0)]
            } else {
                [-1.0, 1.0]
            }
        };
        let [u, v] = [range(&self.u), range(&self.v)];
        let is_met = u[0] <= u[1] && v[0] <= v[1];
        is_met.then(|| [0, 1].map(|k| [u[k] as f32, v[k] as f32]))
    }
}

/// Where pixels of one row see the ground.
#[derive(Clone, Copy, Debug)]
pub struct GroundRow<const N: usize> {
    /// Whether they see it; other values have a meaning only then.
    pub seen: [bool; N],
    /// Coordinates along the ground's axes in units of its radius.
    at: [[f64; N]; 2],
    /// Squares of the distances from its middle, in the same units.
    share: [f64; N],
    w: [f64; N],
}

impl<const N: usize> GroundRow<N> {
    /// Coordinates of a pixel along the ground's axes in units of its radius.
    #[inline(always)]
    pub fn at(&self, k: usize) -> [f32; 2] {
        [self.at[0][k] as f32, self.at[1][k] as f32]
    }

    /// Opacities of the ground, 0 at the radius and beyond.
    #[inline(always)]
    pub fn fade(&self) -> [f32; N] {
        let mut fade = [0.0; N];
        for (fade, share) in fade.iter_mut().zip(self.share) {
            *fade = look::ground_fade(share as f32);
        }
        fade
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::render::Projection;
    use crate::render::camera::{ViewDirection, fit_camera};

    /// A pixel's ground point, projected again, is the pixel.
    #[test]
    fn pixels_and_plane_are_inverse() {
        let ground = Ground {
            centre: DVec3::new(0.3, -0.2, -1.0),
            normal: DVec3::Z,
            radius: 4.0,
            grid: 0.5,
            shade: Ground::DARKER,
        };
        let size = [320, 240];
        let corners = [DVec3::splat(-1.0), DVec3::splat(1.0)];
        for projection in [
            Projection::Perspective { fov_y: 0.7 },
            Projection::Orthographic { height: 1.0 },
        ] {
            let view = ViewDirection {
                azimuth: 0.7,
                elevation: 0.4,
                up: DVec3::Z,
            };
            let camera = fit_camera(corners.into_iter(), &view, projection, 4.0 / 3.0, 0.1);
            let plane = GroundView::new(&ground, &camera, size).unwrap();
            let axes = ground_axes(&ground);
            let mut seen = 0;
            for (x, y) in [(160.5, 200.5), (10.0, 239.0), (300.0, 150.0)] {
                let row = plane.row([x], y);
                if !row.seen[0] {
                    continue;
                }
                seen += 1;
                let [u, v] = row.at(0).map(f64::from);
                let world = ground.centre + (axes.x_axis * u + axes.y_axis * v) * ground.radius
                    - axes.z_axis * ground_sink(&ground, &camera, size);
                let [px, py, distance] = camera.project(world, size).unwrap();
                assert!((px - x).abs() < 1e-3 && (py - y).abs() < 1e-3);
                let expected = plane.distance_at(x, y).unwrap();
                assert!((distance - expected).abs() < 1e-5 * expected);
            }
            assert!(seen > 0);
        }
    }

    #[test]
    fn ground_from_below_is_not_seen() {
        let view = ViewDirection {
            azimuth: 0.7,
            elevation: -0.4,
            up: DVec3::Z,
        };
        let ground = Ground {
            centre: DVec3::Z,
            normal: DVec3::Z,
            radius: 4.0,
            grid: 0.0,
            shade: Ground::DARKER,
        };
        let camera = fit_camera(
            [DVec3::ZERO, DVec3::ONE].into_iter(),
            &view,
            Projection::Perspective { fov_y: 0.7 },
            1.0,
            0.1,
        );
        assert_eq!(GroundView::new(&ground, &camera, [64, 64]), None);
    }
}
