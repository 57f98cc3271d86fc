//! Textures computed on the CPU for every frame: the contact shadow and the shades between bodies.

use super::device::Device;
use crate::render::mutual_shade::{KEY_MAP_SIDE, MutualShade};

/// A texture that is replaced each frame, and its view.
pub struct MapTexture {
    size: [u32; 2],
    texture: wgpu::Texture,
    /// What is bound.
    pub view: wgpu::TextureView,
}

impl MapTexture {
    /// A texture of `size` texels, all zero.
    pub fn new(device: &Device, size: [u32; 2], format: wgpu::TextureFormat) -> Self {
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("map"),
            size: map_extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self {
            size,
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            texture,
        }
    }

    /// Whether texels of this size fit without a new texture.
    pub fn fits(&self, size: [u32; 2]) -> bool {
        self.size == size
    }

    /// Replaces the texels, row by row.
    pub fn write(&self, device: &Device, texels: &[u8]) {
        let row = texels.len() as u32 / self.size[1];
        device.queue.write_texture(
            self.texture.as_image_copy(),
            texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: None,
            },
            map_extent(self.size),
        );
    }
}

/// The maps of a stage; one texel each where bodies do not shade each other.
pub struct ShadeTextures {
    /// What the key light sees.
    pub key: MapTexture,
    /// How open the nearest surfaces are.
    pub sky: MapTexture,
}

impl ShadeTextures {
    /// Textures for the maps of `shade`.
    pub fn new(device: &Device, shade: Option<&MutualShade>) -> Self {
        let sizes = shade.map_or([[1; 2]; 2], |shade| {
            [[KEY_MAP_SIDE; 2], shade.sky.size].map(|size| size.map(|n| n as u32))
        });
        Self {
            key: MapTexture::new(device, sizes[0], wgpu::TextureFormat::R32Float),
            sky: MapTexture::new(device, sizes[1], wgpu::TextureFormat::Rg32Float),
        }
    }

    /// Replaces both.
    pub fn write(&self, device: &Device, shade: &MutualShade) {
        self.key
            .write(device, bytemuck::cast_slice(&shade.key.heights));
        self.sky
            .write(device, bytemuck::cast_slice(&shade.sky.cells));
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

fn map_extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    }
}
