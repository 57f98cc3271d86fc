//! The contact shadow as a texture, replaced each frame.

use super::device::Device;
use crate::render::contact_shadow::ContactShadow;

/// The texture of one size and its view.
pub struct ShadowTexture {
    size: u32,
    texture: wgpu::Texture,
    /// What is bound.
    pub view: wgpu::TextureView,
}

impl ShadowTexture {
    /// A texture of `size` texels a side, all without shadow.
    pub fn new(device: &Device, size: u32) -> Self {
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("contact shadow"),
            size: shadow_extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self {
            size,
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            texture,
        }
    }

    /// Whether a shadow fits without a new texture.
    pub fn fits(&self, shadow: &ContactShadow) -> bool {
        self.size == shadow.size
    }

    /// Replaces the texels.
    pub fn write(&self, device: &Device, shadow: &ContactShadow) {
        device.queue.write_texture(
            self.texture.as_image_copy(),
            &shadow.texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(self.size),
                rows_per_image: None,
            },
            shadow_extent(self.size),
        );
    }
}

/// Linear between texel centres, clamped at the edges: what `ContactShadow::sample` does.
pub fn shadow_sampler(device: &Device) -> wgpu::Sampler {
    device.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("contact shadow"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..wgpu::SamplerDescriptor::default()
    })
}

fn shadow_extent(size: u32) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width: size,
        height: size,
        depth_or_array_layers: 1,
    }
}
