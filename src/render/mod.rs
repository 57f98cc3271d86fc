//! Pictures of a stage: the types that both renderers share, and the choice between them.
//!
//! A renderer is a pure function from (stage, frame) to pixels; it is independent of mechanisms and files.

pub mod adapter;
pub mod camera;
pub mod colour;
pub mod contact_shadow;
pub mod cpu;
pub mod depth_order;
pub mod edges;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod ground;
pub mod last_frame;
pub mod look;
pub mod matte;
pub mod mutual_shade;
pub mod open;
pub mod overlay;
pub mod ramp;
mod stage_mesh;
pub mod strips;
pub mod text;

use crate::limits::{LimitExceeded, allow_picture};
use crate::math::Pose;
use edges::EdgeStyle;
use glam::DVec3;
use image::RgbaImage;
use look::Rim;
pub use stage_mesh::{MeshList, StageMesh};
use std::ops::Range;
use std::sync::Arc;

/// Bytes needed for each pixel while a picture is drawn and written: colours, depths, the picture, its encoded form.
/// Measured, with a margin.
pub const BYTES_OF_DRAWN_PIXEL: f64 = 34.0;

/// Everything that is the same in all frames.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Meshes that instances refer to by index.
    pub meshes: Arc<[StageMesh]>,
    /// Picture size in pixels.
    pub size: [u32; 2],
    /// Samples per pixel: 1 or 4 (the CPU renderer also takes 2, 8 and 16).
    pub samples: u32,
    /// Where the picture is seen from.
    pub camera: Camera,
    /// Background colour, sRGB.
    pub background: [u8; 3],
    /// Light at silhouettes.
    pub rim: Rim,
    /// The ground, if any.
    pub ground: Option<Ground>,
    /// Lines between surfaces, if any.
    pub edges: Option<EdgeStyle>,
    /// Least and greatest corner of the box, in the world, within which bodies shade each other; `None` if they do not.
    pub mutual_shade: Option<[DVec3; 2]>,
}

/// Projection of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Vertical field of view in radians.
    Perspective {
        /// Full vertical angle.
        fov_y: f64,
    },
    /// Parallel projection.
    Orthographic {
        /// Height of the picture in the scene's unit.
        height: f64,
    },
}

/// A camera that looks along its -z axis, with x to the right and y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Pose of the camera in the world.
    pub world_from_camera: Pose,
    /// Kind of projection.
    pub projection: Projection,
    /// Distance of the near plane, positive.
    pub near: f64,
    /// Distance of the far plane.
    pub far: f64,
}

/// A horizontal disc that fades into the background and receives the contact shadow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// A point of the ground, the middle of the disc.
    pub centre: DVec3,
    /// Unit normal, towards the viewer's up.
    pub normal: DVec3,
    /// Radius at which the disc has faded out.
    pub radius: f64,
    /// Distance of the grid lines; 0 for none.
    pub grid: f64,
    /// How much darker than the background its middle is, and how much more a grid line takes away, in linear light;
    /// negative is lighter.
    pub shade: [f32; 2],
}

impl Ground {
    /// Shade on light backgrounds.
    pub const DARKER: [f32; 2] = [0.09, 0.11];
    /// Shade on dark backgrounds, which could hardly be darker.
    pub const LIGHTER: [f32; 2] = [-0.7, -1.6];
}

/// One mesh, drawn in one frame.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index into `Stage::meshes`; beyond them into `Frame::meshes`.
    pub mesh: usize,
    /// Placement.
    pub world_from_mesh: Pose,
    /// sRGB colour.
    pub colour: [u8; 3],
    /// 1 opaque, below 1 translucent (every sample blends what it sees, far to near).
    pub opacity: f64,
    /// Which of the mesh's triangles are drawn; a growing trace draws a growing range.
    pub triangles: Range<u32>,
    /// Whether it darkens the ground below it; palely if it is translucent.
    pub casts_shadow: bool,
    /// Its body, for lines between bodies; `None` draws no lines.
    pub outline: Option<u32>,
    /// 0 lit like matter, 1 its flat colour whatever the light (traces, markers).
    pub flat: f64,
}

impl Instance {
    /// World from the positions of its mesh, which are counted from `origin` on.
    pub fn world_from_positions(&self, origin: DVec3) -> Pose {
        self.world_from_mesh * Pose::from_translation(origin)
    }
}

/// Where a label is anchored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LabelAnchor {
    /// A point of the world, projected; the label is centred on it.
    World(DVec3),
    /// A point of the world, projected; the label is above and to the right of it, with a leader to it.
    Beside(DVec3),
    /// A point of the world, projected; the middle of the text is `offset` pixels right of and below it, or as close to
    /// that as the picture allows.
    Placed {
        /// The point.
        point: DVec3,
        /// In pixels.
        offset: [f64; 2],
        /// A line leads from the text to the point.
        line: bool,
    },
    /// Fractions of the picture's width and height from the top left; the label starts there.
    Screen([f64; 2]),
}

/// A rectangle over the picture, below the labels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Top left corner in fractions of the picture's width and height.
    pub corner: [f64; 2],
    /// Width and height in the same fractions.
    pub size: [f64; 2],
    /// sRGB colour.
    pub colour: [u8; 3],
    /// 1 opaque.
    pub opacity: f64,
}

/// A straight line over the picture, below the labels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlayStroke {
    /// In pixels from the top left.
    pub ends: [[f64; 2]; 2],
    /// Half its width at both ends, in pixels.
    pub half_widths: [f64; 2],
    /// sRGB colour.
    pub colour: [u8; 3],
}

/// A line of text over the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The text.
    pub text: String,
    /// Where.
    pub anchor: LabelAnchor,
    /// Height of the capitals' line in pixels.
    pub size: f64,
    /// sRGB colour.
    pub colour: [u8; 3],
    /// Draws a plate of the background's colour behind the text.
    pub plate: bool,
    /// Omitted if it would cover an earlier label.
    pub yields: bool,
}

/// The contents of one frame.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Its camera, if it differs from the stage's.
    pub camera: Option<Camera>,
    /// Meshes of this frame alone; they are numbered after those of the stage.
    pub meshes: Vec<StageMesh>,
    /// Meshes to draw.
    pub instances: Vec<Instance>,
    /// Rectangles over them.
    pub patches: Vec<Patch>,
    /// Lines over them.
    pub strokes: Vec<OverlayStroke>,
    /// Text over all of them.
    pub labels: Vec<Label>,
    /// Drawn greyed, with a hatched margin: there is no pose at this time.
    pub no_pose: bool,
}

impl Frame {
    /// The camera that sees this frame of `stage`.
    pub fn camera(&self, stage: &Stage) -> Camera {
        self.camera.unwrap_or(stage.camera)
    }
}

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// No adapter, or none of the asked kind.
    #[error("no usable graphics adapter: {0}")]
    NoAdapter(String),
    /// The device was lost or refused a request.
    #[error("the graphics device failed: {0}")]
    Device(String),
    /// The picture is larger than the adapter can draw.
    #[error("{0}")]
    Size(String),
    /// The picture is larger than the run may draw.
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
}

/// Rejects a picture that is larger than the run may draw. Called by every renderer before it allocates a picture, and
/// by everything that composes one.
pub fn allow_drawing(size: [u32; 2]) -> Result<(), RenderError> {
    Ok(allow_picture(size, BYTES_OF_DRAWN_PIXEL, "a picture")?)
}

/// Draws frames of one stage.
pub trait Renderer: Send {
    /// Name for messages: `cpu`, or the adapter, driver and backend.
    fn name(&self) -> String;

    /// Draws `frame` into `image`, which has the stage's size; every pixel is written, alpha is 255.
    fn draw(&mut self, frame: &Frame, image: &mut RgbaImage) -> Result<(), RenderError>;

    /// Draws the rows of `frame` from `first` on into `image`, which has the stage's width: the pixels that
    /// [`draw`](Self::draw) makes there. Rows of the image below the end of the picture have no meaning.
    ///
    /// Errors: a renderer that draws whole pictures only; no row of the picture.
    fn draw_strip(
        &mut self,
        frame: &Frame,
        first: u32,
        image: &mut RgbaImage,
    ) -> Result<(), RenderError> {
        let _ = (frame, first, image);
        let name = self.name();
        Err(RenderError::Size(format!("{name} draws no strips")))
    }
}
