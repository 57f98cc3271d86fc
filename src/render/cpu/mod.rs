//! The built-in renderer: no driver, no window, the same bytes on every machine.
//!
//! A frame is drawn in three steps. TriangleAssembly transforms the vertices, removes invisible triangles and sorts the
//! rest into tiles that fit the cache. Each tile then finds the nearest facet of every sample, lights each facet once
//! per pixel, and encodes the mean of a pixel's samples. Tiles in which nothing changed since the last frame keep their
//! pixels. A renderer works on one thread; frames are distributed by giving each thread its own renderer.

mod assembly;
mod backdrop;
mod blocks;
mod cell;
mod clip;
mod kept;
mod lens;
mod mask;
mod near_samples;
mod outlines;
mod raster;
mod rasterise;
mod samples;
mod shading;
mod tile;
mod translucent;
mod view;
mod window;

use super::contact_shadow::{ContactShadow, ShadowCaster};
use super::look::Surroundings;
use super::mutual_shade::MutualShade;
use super::{Camera, Frame, MeshList, RenderError, Renderer, Stage, allow_drawing, colour};
use assembly::TriangleAssembly;
use backdrop::Backdrop;
use image::RgbaImage;
use kept::KeptTiles;
use lens::Lens;
use std::ops::Range;
use std::sync::Arc;
use tile::{TileSamples, fill_background};
use view::RasterView;

/// Longest side of a picture in pixels: screen coordinates keep 8 bits of fraction in 22 bits, and the guard band
/// around the picture has its share of them.
pub const MAX_SIDE: u32 = 15_360;

/// Places of `samples` in a pixel from its top left corner, in pixels: those of graphics interfaces.
#[cfg(feature = "gpu")]
pub(super) fn sample_places(samples: u32) -> Vec<[f32; 2]> {
    samples::sample_places(samples)
}

/// Draws frames of a stage on the processor.
#[derive(Clone, Debug)]
pub struct CpuRenderer {
    stage: Arc<Stage>,
    /// The camera that the lens and the backdrop are made for.
    camera: Camera,
    lens: Lens,
    backdrop: Backdrop,
    assembly: TriangleAssembly,
    tile: AnyTile,
    kept: KeptTiles,
    caster: Option<ShadowCaster>,
    shade: Option<MutualShade>,
    /// The frame of reference of the lights.
    around: Surroundings,
}

/// A tile's samples, by the number of vectors that a pixel's fill.
#[derive(Clone, Debug)]
enum AnyTile {
    One(TileSamples<1>),
    #[cfg(feature = "fine-samples")]
    Two(TileSamples<2>),
    #[cfg(feature = "fine-samples")]
    Four(TileSamples<4>),
}

impl CpuRenderer {
    /// A renderer of whole pictures with its own working memory.
    ///
    /// Errors: a picture with no pixels or a side above [`MAX_SIDE`]; a number of samples other than 1, 2,
    /// 4, 8 and 16; more pixels than the run may draw.
    pub fn new(stage: Arc<Stage>) -> Result<Self, RenderError> {
        allow_drawing(stage.size)?;
        let mut renderer = Self::for_strips(stage)?;
        // Copies of this renderer share what is prepared here.
        let (camera, rows) = (renderer.camera, renderer.all_rows());
        renderer.backdrop.see(&renderer.stage, &camera, rows);
        Ok(renderer)
    }

    /// The same for pictures that are drawn in strips, with memory for one strip.
    ///
    /// Errors: as [`new`](Self::new), except that the picture may have any number of pixels.
    pub fn for_strips(stage: Arc<Stage>) -> Result<Self, RenderError> {
        samples::check_samples(stage.samples)?;
        let [width, height] = stage.size;
        if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
            return Err(RenderError::Size(format!(
                "a picture of {width} x {height} pixels cannot be drawn; sides are 1 to {MAX_SIDE}"
            )));
        }
        let lens = Lens::new(&stage.camera, stage.size);
        let backdrop = Backdrop::new(&stage);
        // 16 samples fill four vectors of four lanes, 8 fill two.
        let tile = match stage.samples {
            #[cfg(feature = "fine-samples")]
            16 => AnyTile::Four(TileSamples::new(&stage)),
            #[cfg(feature = "fine-samples")]
            8 => AnyTile::Two(TileSamples::new(&stage)),
            _ => AnyTile::One(TileSamples::new(&stage)),
        };
        Ok(Self {
            camera: stage.camera,
            around: lens_surroundings(&lens, &stage),
            lens,
            backdrop,
            assembly: TriangleAssembly::new(&stage),
            tile,
            kept: KeptTiles::default(),
            caster: ShadowCaster::new(&stage),
            shade: MutualShade::new(&stage),
            stage,
        })
    }

    fn all_rows(&self) -> Range<usize> {
        0..self.stage.size[1] as usize
    }

    /// Makes `camera` the one of the next frame, and `rows` those that are drawn.
    fn look_through(&mut self, camera: Camera, rows: Range<usize>) {
        if camera != self.camera {
            self.camera = camera;
            self.lens = Lens::new(&camera, self.stage.size);
            self.around = lens_surroundings(&self.lens, &self.stage);
        } else if rows == *self.backdrop.rows() {
            return;
        }
        self.kept.forget();
        self.backdrop.see(&self.stage, &camera, rows);
    }

    fn below_ground(&self, frame: &Frame) -> bool {
        let Some(ground) = self.stage.ground.filter(|_| self.backdrop.view.is_some()) else {
            return false;
        };
        let meshes = MeshList::new(&self.stage.meshes, &frame.meshes);
        frame.instances.iter().any(|instance| {
            let Some(solid) = meshes.get(instance.mesh) else {
                return false;
            };
            // The lowest point of the instance's box over the ground: its middle minus the extent along the normal.
            let [low, high] = solid.bounds;
            let pose = instance.world_from_mesh;
            let normal = pose.rotation.transpose() * ground.normal;
            let middle = pose.transform_point((low + high) * 0.5) - ground.centre;
            let reach = ((high - low) * 0.5).dot(normal.abs());
            middle.dot(ground.normal) < reach
        })
    }
}

/// Up is the ground's normal, or the picture's own without a ground.
fn lens_surroundings(lens: &Lens, stage: &Stage) -> Surroundings {
    let up = match &stage.ground {
        Some(ground) => lens.eye.camera_from_world.transform_vector(ground.normal),
        None => glam::DVec3::Y,
    };
    Surroundings {
        up: crate::math::narrow_vector(up),
        rim: stage.rim,
    }
}

impl Renderer for CpuRenderer {
    fn name(&self) -> String {
        "cpu".to_owned()
    }

    fn draw(&mut self, frame: &Frame, image: &mut RgbaImage) -> Result<(), RenderError> {
        let [width, height] = self.stage.size;
        if image.dimensions() != (width, height) {
            return Err(RenderError::Size(format!(
                "the picture is {} x {} pixels, the stage {width} x {height}",
                image.width(),
                image.height()
            )));
        }
        self.draw_strip(frame, 0, image)
    }

    fn draw_strip(
        &mut self,
        frame: &Frame,
        first: u32,
        image: &mut RgbaImage,
    ) -> Result<(), RenderError> {
        let [width, height] = self.stage.size;
        if image.width() != width || first >= height || image.height() == 0 {
            return Err(RenderError::Size(format!(
                "a strip of {} x {} pixels from row {first} on is no part of {width} x {height}",
                image.width(),
                image.height()
            )));
        }
        let last = height.min(first.saturating_add(image.height()));
        // Shadows first: they depend on the frame and the camera alone.
        self.look_through(frame.camera(&self.stage), first as usize..last as usize);
        let below_ground = self.below_ground(frame);
        let seen = self.backdrop.view.is_some();
        let caster = self.caster.as_mut().filter(|_| seen);
        let shadow = caster.map(|caster| caster.cast(frame, &self.camera));
        self.backdrop.lay_spots(shadow);
        if let Some(shade) = &mut self.shade {
            shade.cast(frame, &self.camera);
        }
        let scene = DrawnScene {
            frame,
            solids: MeshList::new(&self.stage.meshes, &frame.meshes),
            camera: &self.camera,
            lens: &self.lens,
            backdrop: &self.backdrop,
            shadow,
            shade: self.shade.as_ref(),
            around: self.around,
            below_ground,
        };
        let memory = (&mut self.assembly, &mut self.kept);
        match &mut self.tile {
            AnyTile::One(tile) => scene.draw(memory, tile, image),
            #[cfg(feature = "fine-samples")]
            AnyTile::Two(tile) => scene.draw(memory, tile, image),
            #[cfg(feature = "fine-samples")]
            AnyTile::Four(tile) => scene.draw(memory, tile, image),
        }
        if frame.no_pose {
            colour::mark_no_pose(image, self.stage.background);
        }
        Ok(())
    }
}

/// Everything from which one frame is drawn.
struct DrawnScene<'a> {
    frame: &'a Frame,
    solids: MeshList<'a>,
    camera: &'a Camera,
    lens: &'a Lens,
    backdrop: &'a Backdrop,
    shadow: Option<&'a ContactShadow>,
    shade: Option<&'a MutualShade>,
    around: Surroundings,
    below_ground: bool,
}

impl DrawnScene<'_> {
    fn draw<const G: usize>(
        &self,
        (assembly, kept): (&mut TriangleAssembly, &mut KeptTiles),
        tile: &mut TileSamples<G>,
        image: &mut RgbaImage,
    ) {
        let rows = self.backdrop.rows();
        assembly.select_rows(rows);
        let seen = (self.camera, self.lens);
        assembly.assemble(self.frame, self.solids, seen, &tile.pattern);
        let view = RasterView {
            assembly,
            lens: self.lens,
            backdrop: self.backdrop,
            shadow: self.shadow,
            shade: self.shade,
            around: self.around,
            below_ground: self.below_ground,
        };
        let stride = image.width() as usize * 4;
        let image: &mut [u8] = image;
        let count = rows.len() * stride;
        match kept.start(&view, count) {
            None => draw_tiles(&view, kept, tile, (image, stride)),
            Some(mut bytes) => {
                draw_tiles(&view, kept, tile, (&mut bytes, stride));
                image[..count].copy_from_slice(&bytes);
                kept.keep(bytes);
            }
        }
    }
}

/// Draws what is not as it was, tile by tile, each with an apron for the lines; those at the ends of a strip in part.
fn draw_tiles<const G: usize>(
    view: &RasterView,
    kept: &mut KeptTiles,
    tile: &mut TileSamples<G>,
    (bytes, stride): (&mut [u8], usize),
) {
    let rows = view.backdrop.rows();
    let [first, last] = [rows.start, rows.end - 1].map(|y| y as i32);
    for number in 0..view.assembly.bins.len() {
        let mut inner = view.assembly.window(number);
        inner.y = [inner.y[0].max(first), inner.y[1].min(last)];
        let [changed, shaded] = kept.changed(view, number, &inner);
        let is_shaded = view.backdrop.shaded(number, view.shadow);
        let view = RasterView {
            shadow: view.shadow.filter(|_| is_shaded),
            ..*view
        };
        if !changed.pixels.is_empty() {
            tile.draw(&view, number, &changed, (bytes, first, stride));
            kept.renew(number, &changed, tile.seen_backdrop, tile.bare);
        }
        fill_background(&view, &shaded, (bytes, first, stride));
    }
}

#[cfg(test)]
mod tests;
