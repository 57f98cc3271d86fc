//! How pictures and depths are stored on the device.

/// Colour as stored: the sRGB curve is applied by the hardware, after blending and averaging in linear light.
pub const COLOUR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Depth, reversed: 1 near, 0 far.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
