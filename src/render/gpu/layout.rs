//! The structs the shaders read, byte for byte, and how a stage's camera and ground fill them.
//!
//! Mirrors `Globals` of `shaders/scene.wgsl` and the vertex inputs of `shaders/body.wgsl`.

use crate::render::colour::ToneCurve;
use crate::render::edges::{EdgeStyle, JUMP};
use crate::render::ground::{GroundView, ground_axes};
use crate::render::mutual_shade::MutualShade;
use crate::render::{Camera, Instance, Projection, Stage};
use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// A mesh's vertex, in the mesh's frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GpuVertex {
    /// Place, in the scene's unit.
    pub position: [f32; 3],
    /// Outward unit normal.
    pub normal: [f32; 3],
    /// Smooth patch of its mesh.
    pub patch: u32,
}

/// One instance, ready for the vertex shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct InstanceData {
    /// Rows of `camera_from_mesh`; multiplied in f64 so that no digits are lost far from the origin.
    pub camera_from_mesh: [[f32; 4]; 3],
    /// Linear colour and opacity.
    pub colour: [f32; 4],
    /// 0 lit, 1 flat colour.
    pub flatness: f32,
    /// The surface of its first patch, and the step from patch to patch.
    pub surface: [u32; 2],
    /// Fills up to sixteen bytes.
    pub padding: u32,
}

/// What all draws of a stage share.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Globals {
    /// Clip-space x and y per unit in camera space, and gain and loss of the rim.
    pub scale: [f32; 4],
    /// Factors of the depth and of the divisor, see the shader.
    pub depth: [f32; 4],
    /// Up in camera space, and 1 for a perspective.
    pub up: [f32; 4],
    /// Linear background, alpha 1.
    pub background: [f32; 4],
    /// Forms of the ground in pixel coordinates; the last entry is the ground's shade.
    pub ground_u: [f32; 4],
    /// Second form, and the grid's shade.
    pub ground_v: [f32; 4],
    /// Divisor.
    pub ground_w: [f32; 4],
    /// Depth of the ground in clip coordinates, and the grid's pitch in radii.
    pub ground_depth: [f32; 4],
    /// Linear colour of lines.
    pub ink: [f32; 4],
    /// Square of half a line's width, its reach in whole pixels, and the depth that is a step.
    pub lines: [f32; 4],
    /// Rows of the map from camera space to what the key light sees: texels and height.
    pub key: [[f32; 4]; 3],
    /// Side of a cell of the sky map in pixels, one over the distance at which cells no longer influence each other,
    /// and 1 if bodies shade each other.
    pub sky: [f32; 4],
}

// WGSL lays these out without gaps: vec4s in the uniform, tightly packed vertex attributes.
const _: () = assert!(size_of::<Globals>() == 14 * 16);
const _: () = assert!(size_of::<InstanceData>() == 80);
const _: () = assert!(size_of::<GpuVertex>() == 28);

/// Depth as the buffer stores it: `(a d + b) / (c d + e)` of the distance d, 1 at the near plane and smaller
/// behind (reversed, because floats are densest at 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthMap {
    /// a, b, c, e.
    pub factors: [f64; 4],
}

impl DepthMap {
    /// A perspective has no far plane: near / d. A parallel projection falls linearly from the near plane to the
    /// far plane or to the ground's farthest point, whichever is farther.
    pub fn new(camera: &Camera, ground_reach: f64) -> Self {
        let factors = match camera.projection {
            Projection::Perspective { .. } => [0.0, camera.near, 1.0, 0.0],
            Projection::Orthographic { .. } => {
                let far = camera.far.max(ground_reach);
                let span = far - camera.near;
                [-1.0 / span, far / span, 0.0, 1.0]
            }
        };
        Self { factors }
    }
}

impl Globals {
    /// The globals of a stage seen through `camera` and drawn with `samples` a pixel; `ground` is the stage's ground seen
    /// through it.
    pub fn new(stage: &Stage, camera: &Camera, ground: Option<&GroundView>, samples: u32) -> Self {
        let size = stage.size.map(f64::from);
        let per_unit = camera.pixels_per_unit(stage.size);
        let depth = DepthMap::new(camera, ground_reach(stage, camera));
        let up = up_in_camera(stage, camera);
        let [r, g, b] = ToneCurve::shared().decode_rgb(stage.background);
        let perspective = if camera.is_perspective() { 1.0 } else { 0.0 };
        let mut globals = Self {
            scale: [
                (2.0 * per_unit / size[0]) as f32,
                (2.0 * per_unit / size[1]) as f32,
                stage.rim.gain,
                stage.rim.loss,
            ],
            depth: depth.factors.map(|f| f as f32),
            up: matrix_row(up.to_array(), perspective),
            background: [r, g, b, 1.0],
            ..Self::zeroed()
        };
        if let Some(edges) = stage.edges {
            let [r, g, b] = ToneCurve::shared().decode_rgb(edges.ink);
            let half = EdgeStyle::half_width(stage.size[1], samples);
            globals.ink = [r, g, b, 0.0];
            globals.lines = matrix_row([half * half, half.ceil(), f64::from(JUMP) / per_unit], 0.0);
        }
        if let (Some(view), Some(ground)) = (ground, &stage.ground) {
            globals.ground_u = matrix_row(view.u, f64::from(ground.shade[0]));
            globals.ground_v = matrix_row(view.v, f64::from(ground.shade[1]));
            globals.ground_w = matrix_row(view.w, 0.0);
            let pitch = (ground.grid / ground.radius).max(0.0);
            globals.ground_depth = matrix_row(ground_depth(view, &depth, size), pitch);
        }
        globals
    }
}

impl Globals {
    /// Stores the maps of a frame.
    pub fn look_up(&mut self, shade: &MutualShade) {
        self.key = shade.key.rows;
        self.sky = [shade.sky.cell, shade.sky.likeness, 1.0, 0.0];
    }

    /// How often the ground's triangle is drawn: twice where a part of the ground lies in front of the near plane.
    pub fn ground_layers(&self) -> u32 {
        let [x, y, constant, _] = self.ground_depth;
        if x.abs() + y.abs() + constant > 1.0 {
            2
        } else {
            1
        }
    }
}

/// Up in camera space: the ground's normal, or the picture's own upward direction where there is no ground.
fn up_in_camera(stage: &Stage, camera: &Camera) -> DVec3 {
    let camera_from_world = camera.world_from_camera.rotation.transpose();
    stage.ground.map_or(DVec3::Y, |ground| {
        camera_from_world * ground_axes(&ground).z_axis
    })
}

/// The instance as the shader takes it; `surface` is that of its first patch and the step from patch to patch.
pub fn instance_data(
    instance: &Instance,
    camera_from_mesh: [[f32; 4]; 3],
    surface: [u32; 2],
) -> InstanceData {
    let [r, g, b] = ToneCurve::shared().decode_rgb(instance.colour);
    let flatness = (instance.flat as f32).clamp(0.0, 1.0);
    InstanceData {
        camera_from_mesh,
        colour: [r, g, b, (instance.opacity as f32).clamp(0.0, 1.0)],
        flatness,
        surface,
        padding: 0,
    }
}

/// Greatest distance of the ground's disc from the eye's plane.
fn ground_reach(stage: &Stage, camera: &Camera) -> f64 {
    stage.ground.map_or(0.0, |ground| {
        let camera_from_world = camera.world_from_camera.inverse();
        let seen = camera_from_world.transform_point(ground.centre);
        ground.radius - seen.z
    })
}

/// The ground's depth value as a form in clip coordinates x, y and 1.
///
/// The distance is `distance / w`, forms in the pixel; in both projections the depth value is then affine.
fn ground_depth(view: &GroundView, depth: &DepthMap, size: [f64; 2]) -> [f64; 3] {
    let [a, b, c, _] = depth.factors;
    let in_pixels: [f64; 3] = if c > 0.0 {
        // near / d = near w / height, where the perspective's distance form is the constant height.
        view.w.map(|w| b * w / view.distance[2])
    } else {
        [
            a * view.distance[0],
            a * view.distance[1],
            a * view.distance[2] + b,
        ]
    };
    // Pixel x = (1 + clip x) / 2 * width, pixel y = (1 - clip y) / 2 * height.
    let [x, y, constant] = in_pixels;
    let (half_width, half_height) = (0.5 * size[0], 0.5 * size[1]);
    [
        x * half_width,
        -y * half_height,
        constant + x * half_width + y * half_height,
    ]
}

fn matrix_row(v: [f64; 3], last: f64) -> [f32; 4] {
    [v[0] as f32, v[1] as f32, v[2] as f32, last as f32]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::render::Ground;
    use crate::render::camera::{ViewDirection, fit_camera};
    use crate::render::look::Rim;

    fn stage(projection: Projection) -> Stage {
        let view = ViewDirection {
            azimuth: 0.6,
            elevation: 0.5,
            up: DVec3::Z,
        };
        let corners = [DVec3::splat(-1.0), DVec3::splat(1.0)];
        Stage {
            meshes: Default::default(),
            size: [320, 200],
            samples: 4,
            camera: fit_camera(corners.into_iter(), &view, projection, 1.6, 0.1),
            background: [250, 250, 250],
            rim: Rim::DARK,
            edges: None,
            mutual_shade: None,
            ground: Some(Ground {
                centre: DVec3::new(0.0, 0.0, -1.0),
                normal: DVec3::Z,
                radius: 5.0,
                grid: 0.5,
                shade: Ground::DARKER,
            }),
        }
    }

    /// A face in the ground is in front of it, by less than is seen.
    #[test]
    fn ground_is_just_behind_what_rests_on_it() {
        for projection in [
            Projection::Perspective { fov_y: 0.6 },
            Projection::Orthographic { height: 1.0 },
        ] {
            let stage = stage(projection);
            let ground =
                GroundView::new(&stage.ground.unwrap(), &stage.camera, stage.size).unwrap();
            let globals = Globals::new(&stage, &stage.camera, Some(&ground), 4);
            for point in [DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.7, -1.2, -1.0)] {
                let seen = stage
                    .camera
                    .world_from_camera
                    .inverse()
                    .transform_point(point);
                let [x, y, z] = seen.as_vec3().to_array();
                let [a, b, c, e] = globals.depth;
                let divisor = -c * z + e;
                let clip = [
                    x * globals.scale[0] / divisor,
                    y * globals.scale[1] / divisor,
                ];
                let expected = (-a * z + b) / divisor;
                let g = globals.ground_depth;
                let found = g[0] * clip[0] + g[1] * clip[1] + g[2];
                assert!(found < expected * (1.0 - 1e-6), "{found} {expected}");
                assert!(found > expected * (1.0 - 1e-3), "{found} {expected}");
                assert!(expected > 0.0 && expected < 1.0);
            }
        }
    }

    #[test]
    fn nearer_is_greater() {
        for projection in [
            Projection::Perspective { fov_y: 0.6 },
            Projection::Orthographic { height: 1.0 },
        ] {
            let stage = stage(projection);
            let [a, b, c, e] = DepthMap::new(&stage.camera, 100.0).factors;
            let value = |d: f64| (a * d + b) / (c * d + e);
            assert!((value(stage.camera.near) - 1.0).abs() < 1e-12);
            assert!(value(stage.camera.near * 2.0) > value(stage.camera.near * 3.0));
            assert!(value(99.0) >= 0.0);
        }
    }
}
