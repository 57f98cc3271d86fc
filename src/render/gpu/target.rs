//! The textures a picture is drawn into and the buffer it is read back through.

use super::device::Device;
use super::formats::{COLOUR_FORMAT, DEPTH_FORMAT, SURFACE_FORMAT};
use crate::render::edges::BACKDROP;
use crate::render::{RenderError, allow_drawing};
use image::RgbaImage;

/// Bytes of a pixel.
const PIXEL: u32 = 4;

/// Everything of one picture size.
pub struct DrawTarget {
    size: [u32; 2],
    sample_count: u32,
    /// Many samples a pixel; `None` when there is one.
    samples: Option<wgpu::TextureView>,
    /// Depth of what is opaque.
    pub depth: wgpu::TextureView,
    /// Surface and nearness of every sample.
    pub surfaces: wgpu::TextureView,
    picture: wgpu::Texture,
    picture_view: wgpu::TextureView,
    buffer: wgpu::Buffer,
}

impl DrawTarget {
    /// Allocates for a picture; refuses one the device cannot hold before anything is allocated.
    pub fn new(device: &Device, size: [u32; 2], sample_count: u32) -> Result<Self, RenderError> {
        check_size(size, &device.device.limits())?;
        let texture = |label, format, sample_count, usage| {
            device.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: target_extent(size),
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let view = |t: &wgpu::Texture| t.create_view(&wgpu::TextureViewDescriptor::default());
        let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let copied = drawn | wgpu::TextureUsages::COPY_SRC;
        // The finished picture has one sample a pixel and is copied to the buffer.
        let picture = texture("picture", COLOUR_FORMAT, 1, copied);
        let read = drawn | wgpu::TextureUsages::TEXTURE_BINDING;
        // Depths and surfaces keep all samples: later passes read them.
        let depth = texture("depth", DEPTH_FORMAT, sample_count, read);
        let surfaces = texture("surfaces", SURFACE_FORMAT, sample_count, read);
        let samples = (sample_count > 1)
            .then(|| view(&texture("samples", COLOUR_FORMAT, sample_count, drawn)));
        // Rows are padded as the copy requires.
        let buffer = device.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: u64::from(padded_row(size[0])) * u64::from(size[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        device.check()?;
        Ok(Self {
            size,
            sample_count,
            samples,
            depth: view(&depth),
            surfaces: view(&surfaces),
            picture_view: view(&picture),
            picture,
            buffer,
        })
    }

    /// Samples a pixel.
    pub fn samples(&self) -> u32 {
        self.sample_count
    }

    /// Begins a pass that draws bodies: the first, cleared to `background` (linear), or one over the existing picture.
    /// Depths are compared with `depths`.
    pub fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        background: Option<[f32; 4]>,
        depths: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'e> {
        let clear = |[r, g, b, a]: [f64; 4]| wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a });
        // The surface of the background as two words of 16 bits.
        let words = [BACKDROP & 0xffff, BACKDROP >> 16, 0, 0].map(f64::from);
        // Reversed depth: zero is farthest. A later pass goes on with what is there.
        let (colour, surface, depth) = match background {
            Some(background) => (
                clear(background.map(f64::from)),
                clear(words),
                wgpu::LoadOp::Clear(0.0),
            ),
            None => (wgpu::LoadOp::Load, wgpu::LoadOp::Load, wgpu::LoadOp::Load),
        };
        let store = wgpu::StoreOp::Store;
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[
                self.colour(colour, None),
                Some(wgpu::RenderPassColorAttachment {
                    view: &self.surfaces,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: surface,
                        store,
                    },
                }),
            ],
            depth_stencil_attachment: Some(depth_attachment(depths, depth)),
            ..wgpu::RenderPassDescriptor::default()
        })
    }

    /// One more texture for depths.
    pub fn depths(&self, device: &Device) -> wgpu::TextureView {
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("depths of a layer"),
            size: target_extent(self.size),
            mip_level_count: 1,
            sample_count: self.sample_count,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Begins a pass that finds the depths of a layer.
    pub fn begin_layer<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        depths: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("depths of a layer"),
            depth_stencil_attachment: Some(depth_attachment(depths, wgpu::LoadOp::Clear(1.0))),
            ..wgpu::RenderPassDescriptor::default()
        })
    }

    /// Begins a pass over the colours alone; the `last` one resolves them into the picture.
    pub fn begin_lines<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        last: bool,
    ) -> wgpu::RenderPass<'e> {
        let resolved = (last && self.samples.is_some()).then_some(&self.picture_view);
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("lines"),
            color_attachments: &[self.colour(wgpu::LoadOp::Load, resolved)],
            depth_stencil_attachment: None,
            ..wgpu::RenderPassDescriptor::default()
        })
    }

    fn colour<'a>(
        &'a self,
        load: wgpu::LoadOp<wgpu::Color>,
        resolve_target: Option<&'a wgpu::TextureView>,
    ) -> Option<wgpu::RenderPassColorAttachment<'a>> {
        Some(wgpu::RenderPassColorAttachment {
            view: self.samples.as_ref().unwrap_or(&self.picture_view),
            depth_slice: None,
            resolve_target,
            ops: wgpu::Operations {
                load,
                store: wgpu::StoreOp::Store,
            },
        })
    }

    /// Submits the commands, waits, and writes the picture into `image`.
    pub fn finish(
        &self,
        device: &Device,
        mut encoder: wgpu::CommandEncoder,
        image: &mut RgbaImage,
    ) -> Result<(), RenderError> {
        encoder.copy_texture_to_buffer(
            self.picture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded_row(self.size[0])),
                    rows_per_image: None,
                },
            },
            target_extent(self.size),
        );
        let submission = device.queue.submit([encoder.finish()]);
        device.read_back(&self.buffer, submission, |bytes| {
            let row = (self.size[0] * PIXEL) as usize;
            let rows = bytes.chunks_exact(padded_row(self.size[0]) as usize);
            for (to, from) in image.chunks_exact_mut(row).zip(rows) {
                if let Some(from) = from.get(..row) {
                    to.copy_from_slice(from);
                }
            }
        })
    }
}

fn depth_attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<f32>,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations {
            load,
            store: wgpu::StoreOp::Store,
        }),
        stencil_ops: None,
    }
}

fn target_extent(size: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width: size[0],
        height: size[1],
        depth_or_array_layers: 1,
    }
}

/// Bytes of a row in the readback buffer, which copies need in multiples of 256.
fn padded_row(width: u32) -> u32 {
    (width * PIXEL).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

fn check_size(size: [u32; 2], limits: &wgpu::Limits) -> Result<(), RenderError> {
    let [width, height] = size;
    let largest = limits.max_texture_dimension_2d;
    if width == 0 || height == 0 {
        return Err(RenderError::Size(format!(
            "a picture of {width} x {height} pixels is empty"
        )));
    }
    let bytes = u64::from(width.saturating_mul(PIXEL)) * u64::from(height);
    if width > largest || height > largest || bytes > limits.max_buffer_size {
        return Err(RenderError::Size(format!(
            "a picture of {width} x {height} pixels is larger than this adapter draws: {largest} pixels a side, {} MiB \
             in all",
            limits.max_buffer_size >> 20
        )));
    }
    allow_drawing(size)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn rows_are_padded_to_256_bytes() {
        assert_eq!([1, 64, 65, 640].map(padded_row), [256, 256, 512, 2560]);
    }

    #[test]
    fn sizes_are_refused_in_words() {
        let limits = wgpu::Limits::downlevel_webgl2_defaults();
        assert!(check_size([1, 2048], &limits).is_ok());
        for size in [[0, 5], [2049, 1], [1, u32::MAX], [u32::MAX, u32::MAX]] {
            assert!(matches!(
                check_size(size, &limits),
                Err(RenderError::Size(_))
            ));
        }
    }
}
