//! Translucent bodies layer by layer, from the farthest to the nearest of every sample (depth peeling: Everitt,
//! Interactive Order-Independent Transparency, 2001, here from behind), so that bodies may intersect.
//!
//! A layer takes two passes: its depths, found by comparison with those of the layer behind it, and its colours,
//! blended where the depth is equal.

use super::device::Device;
use super::formats::DEPTH_FORMAT;
use super::frame::Draw;
use super::recipe::{BODY, Recipe, body_buffers, render_pipeline};
use super::target::DrawTarget;

/// A convex body has two layers, a torus four; the nearest layers of a body with more are lost.
const LAYERS_OF_BODY: usize = 4;

/// Most layers of a picture.
const MOST_LAYERS: usize = 32;

/// Pipelines of one number of samples; clones are the same ones.
#[derive(Clone)]
pub struct Peel {
    /// Finds the depths of a layer.
    pub depths: wgpu::RenderPipeline,
    /// Blends its colours.
    pub colours: wgpu::RenderPipeline,
    /// Layout of group 1: the depths of the layer behind.
    behind: wgpu::BindGroupLayout,
}

impl Peel {
    /// Compiles the pipelines.
    pub fn new(
        device: &Device,
        bindings: &wgpu::BindGroupLayout,
        (scene, module): (&wgpu::PipelineLayout, &wgpu::ShaderModule),
        sample_count: u32,
    ) -> Self {
        let own = &device.device;
        let behind = own.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("layer behind"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 1,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Depth,
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: sample_count > 1,
                },
                count: None,
            }],
        });
        let colours = Recipe {
            label: "translucent layer",
            fragment: "body_translucent",
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            compare: wgpu::CompareFunction::Equal,
            ..BODY
        };
        Self {
            depths: depth_pipeline(own, module, [bindings, &behind], sample_count),
            colours: render_pipeline(own, scene, module, sample_count, &colours),
            behind,
        }
    }

    /// The depths of two layers, and those with which the next one is compared.
    pub fn layers(&self, device: &Device, target: &DrawTarget) -> PeeledLayers {
        let depths = [0, 1].map(|_| target.depths(device));
        let group = |view: &wgpu::TextureView| {
            device.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("layer behind"),
                layout: &self.behind,
                entries: &[wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(view),
                }],
            })
        };
        PeeledLayers {
            behind: [group(&target.depth), group(&depths[0]), group(&depths[1])],
            depths,
        }
    }
}

/// Depths of the layers, alternating.
pub struct PeeledLayers {
    /// Of the present layer and the one behind it, which are swapped.
    pub depths: [wgpu::TextureView; 2],
    /// The depths of the opaque surfaces and of the two layers.
    pub behind: [wgpu::BindGroup; 3],
}

/// Layers that a picture with these translucent draws needs.
pub fn layers_of(translucent: &[Draw]) -> usize {
    let bodies: u32 = translucent.iter().map(|draw| draw.instances).sum();
    LAYERS_OF_BODY
        .saturating_mul(bodies as usize)
        .min(MOST_LAYERS)
}

fn depth_pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    layouts: [&wgpu::BindGroupLayout; 2],
    sample_count: u32,
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("peel"),
        bind_group_layouts: &layouts.map(Some),
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("depths of a layer"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("body_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &body_buffers(),
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            // Reversed depth: the farthest is the least.
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: sample_count,
            ..wgpu::MultisampleState::default()
        },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("peel"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}
