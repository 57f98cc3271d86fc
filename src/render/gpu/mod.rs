//! The renderer on a graphics adapter: wgpu with Vulkan, Metal or DX12, off-screen.
//!
//! GL is not used: there wgpu cannot read multisampled textures, which lines and translucent layers need. The order is:
//! opaque bodies and the ground, lines, translucent bodies layer by layer, lines again. This is the only room that uses
//! wgpu. The look comes from `look`: constants are generated from it, formulas are in `shaders/look.wgsl`.

pub mod adapter;
mod buffers;
mod device;
mod formats;
mod frame;
mod layout;
mod peel;
mod pipelines;
mod recipe;
mod shader;
mod shadow;
mod target;

use super::adapter::{AdapterChoice, AdapterInfo};
use super::colour::mark_no_pose;
use super::contact_shadow::ShadowCaster;
use super::ground::GroundView;
use super::mutual_shade::MutualShade;
use super::{Camera, Frame, RenderError, Renderer, Stage};
use buffers::{InstanceBuffer, Meshes};
use bytemuck::bytes_of;
use device::{Device, nearest_sample_count};
use frame::DrawPlan;
use image::RgbaImage;
use layout::Globals;
use pipelines::Pipelines;
use shadow::{MapTexture, ShadeTextures};
use std::sync::Arc;
use target::DrawTarget;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// Draws one stage on one adapter.
pub struct GpuRenderer {
    stage: Arc<Stage>,
    info: AdapterInfo,
    device: Device,
    pipelines: Pipelines,
    target: DrawTarget,
    meshes: Meshes,
    /// Meshes of the present frame alone, if it has any.
    of_frame: Option<Meshes>,
    instances: InstanceBuffer,
    globals: Globals,
    globals_buffer: wgpu::Buffer,
    sampler: wgpu::Sampler,
    shadow: MapTexture,
    caster: Option<ShadowCaster>,
    shade: Option<MutualShade>,
    shades: ShadeTextures,
    bindings: wgpu::BindGroup,
    surfaces: wgpu::BindGroup,
    /// Depths of translucent layers.
    layers: peel::PeeledLayers,
    /// The camera of the globals.
    camera: Camera,
    /// Whether the ground's upper side is seen through it.
    ground_seen: bool,
}

impl GpuRenderer {
    /// Opens an adapter and uploads the stage.
    ///
    /// Every adapter draws 1 or 4 samples a pixel, many also 2, 8 or 16; another number is replaced by the nearest
    /// supported one. Errors: no such adapter; the device refuses; a picture or mesh beyond its limits.
    pub fn open(stage: Arc<Stage>, choice: AdapterChoice) -> Result<Self, RenderError> {
        let (adapter, info) = adapter::choose_adapter(&choice)?;
        let device = Device::open(&adapter)?;
        let samples = nearest_sample_count(stage.samples, &device.sample_counts);
        let pipelines = Pipelines::new(&device, samples);
        let meshes = Meshes::new(&device, &stage.meshes, false)?;
        Self::on(device, stage, info, (samples, pipelines, meshes))
    }

    /// A second renderer of the same stage on the same device: while one picture is drawn and read back, the next is
    /// prepared and the previous one is encoded.
    ///
    /// Errors: the device refuses.
    pub fn sibling(&self) -> Result<Self, RenderError> {
        let (pipelines, meshes) = (self.pipelines.clone(), self.meshes.clone());
        let shared = (self.target.samples(), pipelines, meshes);
        let stage = Arc::clone(&self.stage);
        Self::on(self.device.clone(), stage, self.info.clone(), shared)
    }

    /// Combines what renderers share with what each has of its own.
    fn on(
        device: Device,
        stage: Arc<Stage>,
        info: AdapterInfo,
        (samples, pipelines, meshes): (u32, Pipelines, Meshes),
    ) -> Result<Self, RenderError> {
        // What depends on the size of the picture and on the camera.
        let target = DrawTarget::new(&device, stage.size, samples)?;
        let (globals, ground_seen) = globals_of(&stage, &stage.camera, samples);
        let globals_buffer = device.device.create_buffer_init(&BufferInitDescriptor {
            label: Some("globals"),
            contents: bytes_of(&globals),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        });
        let sampler = shadow::shadow_sampler(&device);
        // Shadow and shade maps are uploaded once a frame; until the first the shadow is a single texel.
        let shadow = MapTexture::new(&device, [1; 2], formats::SHADOW_FORMAT);
        let shade = MutualShade::new(&stage);
        let shades = ShadeTextures::new(&device, shade.as_ref());
        let bindings = bind_group(
            &device,
            &pipelines.bindings,
            &globals_buffer,
            &[&shadow, &shades.key, &shades.sky],
            &sampler,
        );
        // Lines and layers read the surfaces and depths of what is drawn before them.
        let surfaces = device.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surfaces"),
            layout: &pipelines.surfaces,
            entries: &[(0, &target.surfaces), (1, &target.depth)].map(|(binding, view)| {
                wgpu::BindGroupEntry {
                    binding,
                    resource: wgpu::BindingResource::TextureView(view),
                }
            }),
        });
        let layers = pipelines.peel.layers(&device, &target);
        // Errors of the device in all of this are found here.
        device.check()?;
        Ok(Self {
            layers,
            camera: stage.camera,
            ground_seen,
            caster: ShadowCaster::new(&stage),
            instances: InstanceBuffer::new(&device),
            stage,
            info,
            device,
            pipelines,
            target,
            meshes,
            of_frame: None,
            globals,
            globals_buffer,
            sampler,
            shadow,
            shade,
            shades,
            bindings,
            surfaces,
        })
    }

    /// The adapter that draws.
    pub fn adapter(&self) -> &AdapterInfo {
        &self.info
    }

    /// Makes `camera` the one of the next frame.
    fn look_through(&mut self, camera: Camera) {
        if camera == self.camera {
            return;
        }
        self.camera = camera;
        (self.globals, self.ground_seen) = globals_of(&self.stage, &camera, self.target.samples());
        let queue = &self.device.queue;
        queue.write_buffer(&self.globals_buffer, 0, bytes_of(&self.globals));
    }

    /// Computes the frame's shadow and uploads it.
    fn cast_shadow(&mut self, frame: &Frame) {
        let Some(caster) = self.caster.as_mut().filter(|_| self.ground_seen) else {
            return;
        };
        let shadow = caster.cast(frame, &self.camera);
        if !self.shadow.fits([shadow.size; 2]) {
            self.shadow = MapTexture::new(&self.device, [shadow.size; 2], formats::SHADOW_FORMAT);
            self.bindings = bind_group(
                &self.device,
                &self.pipelines.bindings,
                &self.globals_buffer,
                &[&self.shadow, &self.shades.key, &self.shades.sky],
                &self.sampler,
            );
        }
        self.shadow.write(&self.device, &shadow.texels);
    }

    /// Computes the maps of the shades between the frame's bodies and uploads them.
    fn cast_shade(&mut self, frame: &Frame) {
        let Some(shade) = &mut self.shade else {
            return;
        };
        shade.cast(frame, &self.camera);
        self.shades.write(&self.device, shade);
        self.globals.look_up(shade);
        let queue = &self.device.queue;
        queue.write_buffer(&self.globals_buffer, 0, bytes_of(&self.globals));
    }

    fn record(&mut self, plan: &DrawPlan) -> wgpu::CommandEncoder {
        let instances = self.instances.write(&self.device, &plan.instances).clone();
        let instances = &instances;
        let mut encoder =
            self.device
                .device
                .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                    label: Some("picture"),
                });
        let background = Some(self.globals.background);
        let depth = &self.target.depth;
        // First pass: opaque bodies, then the ground.
        let mut pass = self.target.begin(&mut encoder, background, depth);
        self.bind_bodies(&mut pass, instances);
        let (closed, open) = (&self.pipelines.closed, &self.pipelines.open);
        let pipeline = |draw: &frame::Draw| if draw.closed { closed } else { open };
        self.run(&mut pass, &plan.opaque, pipeline);
        if self.ground_seen {
            pass.set_pipeline(&self.pipelines.ground);
            pass.draw(0..3, 0..self.globals.ground_layers());
        }
        drop(pass);
        // Then lines between them; these end the picture if nothing is translucent, ...
        let over = !plan.translucent.is_empty();
        self.draw_lines(&mut encoder, &self.pipelines.lines, !over);
        // ... else translucent layers follow, and the lines over them.
        if over {
            self.draw_translucent(&mut encoder, plan, instances);
        }
        if over {
            self.draw_lines(&mut encoder, &self.pipelines.lines_over, true);
        }
        encoder
    }

    /// Draws the translucent bodies, layer by layer.
    fn draw_translucent(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        plan: &DrawPlan,
        instances: &wgpu::Buffer,
    ) {
        let (peel, layers) = (&self.pipelines.peel, &self.layers);
        for layer in 0..peel::layers_of(&plan.translucent) {
            let own = &layers.depths[layer % 2];
            // The opaque surfaces are behind the first layer.
            let behind = &layers.behind[if layer == 0 { 0 } else { 1 + (layer + 1) % 2 }];
            let mut pass = self.target.begin_layer(encoder, own);
            self.bind_bodies(&mut pass, instances);
            pass.set_bind_group(1, behind, &[]);
            self.run(&mut pass, &plan.translucent, |_| &peel.depths);
            drop(pass);
            let mut pass = self.target.begin(encoder, None, own);
            self.bind_bodies(&mut pass, instances);
            self.run(&mut pass, &plan.translucent, |_| &peel.colours);
        }
    }

    fn bind_bodies(&self, pass: &mut wgpu::RenderPass<'_>, instances: &wgpu::Buffer) {
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.set_vertex_buffer(1, instances.slice(..));
    }

    /// Runs draws in their order, each with its pipeline, from the buffers that hold its mesh.
    fn run<'s>(
        &'s self,
        pass: &mut wgpu::RenderPass<'_>,
        draws: &[frame::Draw],
        pipeline: impl Fn(&frame::Draw) -> &'s wgpu::RenderPipeline,
    ) {
        let mut bound = None;
        for draw in draws {
            let meshes = match &self.of_frame {
                Some(meshes) if draw.of_frame => meshes,
                _ => &self.meshes,
            };
            if bound != Some(draw.of_frame) {
                bound = Some(draw.of_frame);
                pass.set_vertex_buffer(0, meshes.vertices.slice(..));
                pass.set_index_buffer(meshes.indices.slice(..), wgpu::IndexFormat::Uint32);
            }
            pass.set_pipeline(pipeline(draw));
            pass.draw_indexed(
                draw.first_index..draw.first_index + draw.indices,
                0,
                draw.first_instance..draw.first_instance + draw.instances,
            );
        }
    }

    /// Draws lines between the surfaces so far, if the stage has any; the `last` pass ends the picture.
    fn draw_lines(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipeline: &wgpu::RenderPipeline,
        last: bool,
    ) {
        let mut pass = self.target.begin_lines(encoder, last);
        if self.stage.edges.is_some() {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &self.bindings, &[]);
            pass.set_bind_group(1, &self.surfaces, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

/// The globals of a stage seen through `camera`, and whether its ground is visible.
fn globals_of(stage: &Stage, camera: &Camera, samples: u32) -> (Globals, bool) {
    let ground = stage.ground.as_ref();
    let ground = ground.and_then(|ground| GroundView::new(ground, camera, stage.size));
    (
        Globals::new(stage, camera, ground.as_ref(), samples),
        ground.is_some(),
    )
}

fn bind_group(
    device: &Device,
    layout: &wgpu::BindGroupLayout,
    globals: &wgpu::Buffer,
    maps: &[&MapTexture; 3],
    sampler: &wgpu::Sampler,
) -> wgpu::BindGroup {
    let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
    device.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("scene"),
        layout,
        entries: &[
            entry(0, globals.as_entire_binding()),
            entry(1, wgpu::BindingResource::TextureView(&maps[0].view)),
            entry(2, wgpu::BindingResource::Sampler(sampler)),
            entry(3, wgpu::BindingResource::TextureView(&maps[1].view)),
            entry(4, wgpu::BindingResource::TextureView(&maps[2].view)),
        ],
    })
}

impl Renderer for GpuRenderer {
    fn name(&self) -> String {
        self.info.to_string()
    }

    fn draw(&mut self, frame: &Frame, image: &mut RgbaImage) -> Result<(), RenderError> {
        let [width, height] = self.stage.size;
        if image.dimensions() != (width, height) {
            let (w, h) = image.dimensions();
            return Err(RenderError::Size(format!(
                "a stage of {width} x {height} pixels cannot be drawn into a picture of {w} x {h}"
            )));
        }
        self.look_through(frame.camera(&self.stage));
        let creases = self.stage.edges.is_some_and(|edges| edges.creases);
        // Most frames have no meshes of their own.
        self.of_frame = match frame.meshes.is_empty() {
            true => None,
            false => Some(Meshes::new(&self.device, &frame.meshes, true)?),
        };
        let mut spans = std::borrow::Cow::Borrowed(&self.meshes.spans);
        if let Some(meshes) = &self.of_frame {
            spans.to_mut().extend(&meshes.spans);
        }
        let plan = DrawPlan::new(frame, &spans, &self.camera.eye(self.stage.size), creases);
        self.cast_shadow(frame);
        self.cast_shade(frame);
        let encoder = self.record(&plan);
        self.target.finish(&self.device, encoder, image)?;
        if frame.no_pose {
            mark_no_pose(image, self.stage.background);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::render::Projection;
    use crate::render::camera::{ViewDirection, fit_camera};
    use crate::render::look::Rim;
    use glam::DVec3;

    #[test]
    #[ignore = "needs a graphics adapter: run with --include-ignored"]
    fn a_lost_device_is_an_error() {
        let view = ViewDirection {
            azimuth: 0.3,
            elevation: 0.3,
            up: DVec3::Z,
        };
        let corners = [DVec3::ZERO, DVec3::ONE];
        let projection = Projection::Perspective { fov_y: 0.5 };
        let stage = Arc::new(Stage {
            meshes: Arc::default(),
            size: [64, 48],
            samples: 4,
            camera: fit_camera(corners.into_iter(), &view, projection, 64.0 / 48.0, 0.1),
            background: [250, 250, 250],
            rim: Rim::DARK,
            ground: None,
            edges: None,
            mutual_shade: None,
        });
        let mut renderer = GpuRenderer::open(stage, AdapterChoice::Any).unwrap();
        let mut image = RgbaImage::new(64, 48);
        renderer.draw(&Frame::default(), &mut image).unwrap();
        assert!(image.pixels().all(|p| p.0 == [250, 250, 250, 255]));
        renderer.device.device.destroy();
        let outcome = renderer.draw(&Frame::default(), &mut image);
        assert!(
            matches!(outcome, Err(RenderError::Device(_))),
            "{outcome:?}"
        );
    }
}
