//! The textures a picture is drawn into and the buffer it is read back through.

use super::device::Device;
use super::formats::{COLOUR_FORMAT, DEPTH_FORMAT};
use crate::render::RenderError;
use image::RgbaImage;

/// Bytes of a pixel.
const PIXEL: u32 = 4;

/// Everything of one picture size.
pub struct DrawTarget {
    size: [u32; 2],
    sample_count: u32,
    /// Many samples a pixel; `None` when there is one.
    samples: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
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
        let picture = texture("picture", COLOUR_FORMAT, 1, copied);
        let depth = texture("depth", DEPTH_FORMAT, sample_count, drawn);
        let samples = (sample_count > 1)
            .then(|| view(&texture("samples", COLOUR_FORMAT, sample_count, drawn)));
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
            picture_view: view(&picture),
            picture,
            buffer,
        })
    }

    /// Samples a pixel.
    pub fn samples(&self) -> u32 {
        self.sample_count
    }

    /// Begins the one pass of a picture, cleared to `background` (linear).
    pub fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        background: [f32; 4],
    ) -> wgpu::RenderPass<'e> {
        let [r, g, b, a] = background.map(f64::from);
        let (view, resolve_target, store) = match &self.samples {
            Some(samples) => (samples, Some(&self.picture_view), wgpu::StoreOp::Discard),
            None => (&self.picture_view, None, wgpu::StoreOp::Store),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                    store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
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
    Ok(())
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
