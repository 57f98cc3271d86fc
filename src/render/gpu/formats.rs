//! How pictures and depths are stored on the device.

/// Colour as stored: the sRGB curve is applied by the hardware, after blending and averaging in linear light.
pub const COLOUR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Depth, reversed: 1 near, 0 far.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Surface and nearness of a sample for lines, two words each: formats of 32 bits a channel have one sample only.
pub const SURFACE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Uint;

/// Darkness of the contact shadow.
pub const SHADOW_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;
