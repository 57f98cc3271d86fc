//! The four ways of drawing: bodies with and without their back faces, translucent faces, and the ground.

use super::device::Device;
use super::formats::{COLOUR_FORMAT, DEPTH_FORMAT};
use super::layout::{GpuVertex, InstanceData};
use wgpu::Face;

/// All pipelines of one number of samples; clones are the same ones.
#[derive(Clone)]
pub struct Pipelines {
    /// Opaque and closed: back faces are never seen.
    pub closed: wgpu::RenderPipeline,
    /// Opaque, both sides.
    pub open: wgpu::RenderPipeline,
    /// Translucent, the sides that look away.
    pub translucent_back: wgpu::RenderPipeline,
    /// Translucent, the sides that face the viewer.
    pub translucent_front: wgpu::RenderPipeline,
    /// The ground.
    pub ground: wgpu::RenderPipeline,
    /// Layout of group 0: globals, shadow, sampler.
    pub bindings: wgpu::BindGroupLayout,
}

/// What tells one pipeline from another.
struct Recipe {
    label: &'static str,
    vertex: &'static str,
    fragment: &'static str,
    cull: Option<Face>,
    blend: Option<wgpu::BlendState>,
    instanced: bool,
}

const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
const INSTANCE_ATTRIBUTES: [wgpu::VertexAttribute; 5] = wgpu::vertex_attr_array![
    2 => Float32x4, 3 => Float32x4, 4 => Float32x4, 5 => Float32x4, 6 => Float32
];

impl Pipelines {
    /// Compiles the shaders; failures are the device's to report (`Device::check`).
    pub fn new(device: &Device, sample_count: u32) -> Self {
        let module = device
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("mechanim"),
                source: wgpu::ShaderSource::Wgsl(super::shader::shader_source().into()),
            });
        let bindings = bind_layout(&device.device);
        let layout = device
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("scene"),
                bind_group_layouts: &[Some(&bindings)],
                immediate_size: 0,
            });
        let make = |recipe: &Recipe| {
            render_pipeline(&device.device, &layout, &module, sample_count, recipe)
        };
        let opaque = |label, cull| Recipe {
            label,
            vertex: "body_vertex",
            fragment: "body_opaque",
            cull,
            blend: None,
            instanced: true,
        };
        let translucent = |label, cull| Recipe {
            fragment: "body_translucent",
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            ..opaque(label, Some(cull))
        };
        Self {
            closed: make(&opaque("closed bodies", Some(Face::Back))),
            open: make(&opaque("open bodies", None)),
            translucent_back: make(&translucent("translucent back faces", Face::Front)),
            translucent_front: make(&translucent("translucent front faces", Face::Back)),
            ground: make(&Recipe {
                vertex: "ground_vertex",
                fragment: "ground_fragment",
                instanced: false,
                ..opaque("ground", None)
            }),
            bindings,
        }
    }
}

fn bind_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty,
        count: None,
    };
    let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let fragment = wgpu::ShaderStages::FRAGMENT;
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("scene"),
        entries: &[
            entry(0, both, uniform),
            entry(1, fragment, texture),
            entry(2, fragment, sampler),
        ],
    })
}

fn render_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    sample_count: u32,
    recipe: &Recipe,
) -> wgpu::RenderPipeline {
    let buffers = [
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
    ];
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
            // Reversed depth: greater is nearer.
            depth_compare: Some(wgpu::CompareFunction::Greater),
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
            targets: &[Some(wgpu::ColorTargetState {
                format: COLOUR_FORMAT,
                blend: recipe.blend,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
