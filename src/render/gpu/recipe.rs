//! The parameters of the pipelines of bodies, and their creation.

use super::formats::{COLOUR_FORMAT, DEPTH_FORMAT, SURFACE_FORMAT};
use super::layout::{GpuVertex, InstanceData};
use wgpu::Face;

/// The parameters of a pipeline.
pub(super) struct Recipe {
    pub(super) label: &'static str,
    pub(super) vertex: &'static str,
    pub(super) fragment: &'static str,
    pub(super) cull: Option<Face>,
    pub(super) blend: Option<wgpu::BlendState>,
    pub(super) compare: wgpu::CompareFunction,
    pub(super) instanced: bool,
}

/// Opaque bodies, both sides.
pub(super) const BODY: Recipe = Recipe {
    label: "open bodies",
    vertex: "body_vertex",
    fragment: "body_opaque",
    cull: None,
    blend: None,
    // Reversed depth: greater is nearer.
    compare: wgpu::CompareFunction::Greater,
    instanced: true,
};

const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 7 => Uint32];
const INSTANCE_ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    2 => Float32x4, 3 => Float32x4, 4 => Float32x4, 5 => Float32x4, 6 => Float32, 8 => Uint32x2
];

/// Buffers of vertices and of instances.
pub(super) fn body_buffers() -> [Option<wgpu::VertexBufferLayout<'static>>; 2] {
    [
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<GpuVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &VERTEX_ATTRIBUTES,
        }),
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<InstanceData>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &INSTANCE_ATTRIBUTES,
        }),
    ]
}

/// A pipeline into colours and surfaces.
pub(super) fn render_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    sample_count: u32,
    recipe: &Recipe,
) -> wgpu::RenderPipeline {
    let buffers = body_buffers();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(recipe.label),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(recipe.vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: if recipe.instanced { &buffers } else { &[] },
        },
        primitive: wgpu::PrimitiveState {
            cull_mode: recipe.cull,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(recipe.blend.is_none()),
            depth_compare: Some(recipe.compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: sample_count,
            ..wgpu::MultisampleState::default()
        },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(recipe.fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[
                colour_target(COLOUR_FORMAT, recipe.blend),
                colour_target(SURFACE_FORMAT, None),
            ],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// A target for colours or surfaces. Blending does not change the picture's opacity: it is opaque from the start, and
/// blending eight bits need not preserve this.
pub(super) fn colour_target(
    format: wgpu::TextureFormat,
    blend: Option<wgpu::BlendState>,
) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState {
        format,
        blend,
        write_mask: blend.map_or(wgpu::ColorWrites::ALL, |_| wgpu::ColorWrites::COLOR),
    })
}
