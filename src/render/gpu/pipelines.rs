//! The pipelines: bodies with and without their back faces, translucent layers, the ground, and lines.

use super::device::Device;
use super::formats::COLOUR_FORMAT;
use super::peel::Peel;
use super::recipe::{BODY, Recipe, colour_target, render_pipeline};
use wgpu::Face;

/// All pipelines of one number of samples; clones are the same ones.
#[derive(Clone)]
pub struct Pipelines {
    /// Opaque and closed: back faces are never seen.
    pub closed: wgpu::RenderPipeline,
    /// Opaque, both sides.
    pub open: wgpu::RenderPipeline,
    /// The ground.
    pub ground: wgpu::RenderPipeline,
    /// Translucent bodies layer by layer.
    pub peel: Peel,
    /// Lines between the surfaces that were drawn.
    pub lines: wgpu::RenderPipeline,
    /// Lines with a translucent side.
    pub lines_over: wgpu::RenderPipeline,
    /// Layout of group 0: globals, contact shadow, sampler, the maps of how bodies shade each other.
    pub bindings: wgpu::BindGroupLayout,
    /// Layout of group 1, for lines: the surfaces and the depths of what is opaque.
    pub surfaces: wgpu::BindGroupLayout,
}

impl Pipelines {
    /// Compiles the shaders; failures are the device's to report (`Device::check`).
    pub fn new(device: &Device, sample_count: u32) -> Self {
        // One module has all entry points.
        let module = device
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("mechanim"),
                source: wgpu::ShaderSource::Wgsl(super::shader::shader_source(sample_count).into()),
            });
        let bindings = bind_layout(&device.device);
        let layout = device
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("scene"),
                bind_group_layouts: &[Some(&bindings)],
                immediate_size: 0,
            });
        // Lines read what earlier passes have written, by a second group of bindings.
        let surfaces = surface_layout(&device.device, sample_count > 1);
        let ink = |fragment| {
            let layouts = [&bindings, &surfaces];
            lines_pipeline(&device.device, &module, layouts, (fragment, sample_count))
        };
        let make = |recipe: &Recipe| {
            render_pipeline(&device.device, &layout, &module, sample_count, recipe)
        };
        // Pipelines of opaque things differ from that of open bodies in few parameters.
        let opaque = |label, cull| Recipe {
            label,
            cull,
            ..BODY
        };
        Self {
            closed: make(&opaque("closed bodies", Some(Face::Back))),
            open: make(&BODY),
            ground: make(&Recipe {
                vertex: "ground_vertex",
                fragment: "ground_fragment",
                instanced: false,
                ..opaque("ground", None)
            }),
            peel: Peel::new(device, &bindings, (&layout, &module), sample_count),
            lines: ink("lines_fragment"),
            lines_over: ink("lines_over_fragment"),
            bindings,
            surfaces,
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
    let texture = |filterable| wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("scene"),
        entries: &[
            entry(0, both, uniform),
            entry(1, fragment, texture(true)),
            entry(2, fragment, sampler),
            entry(3, fragment, texture(false)),
            entry(4, fragment, texture(false)),
        ],
    })
}

fn surface_layout(device: &wgpu::Device, multisampled: bool) -> wgpu::BindGroupLayout {
    let texture = |binding, sample_type| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled,
        },
        count: None,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("surfaces"),
        entries: &[
            texture(0, wgpu::TextureSampleType::Uint),
            texture(1, wgpu::TextureSampleType::Depth),
        ],
    })
}

/// One triangle over the whole picture, without depth.
fn lines_pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    layouts: [&wgpu::BindGroupLayout; 2],
    (fragment, sample_count): (&str, u32),
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("lines"),
        bind_group_layouts: &layouts.map(Some),
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("lines"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("lines_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState {
            count: sample_count,
            ..wgpu::MultisampleState::default()
        },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[colour_target(
                COLOUR_FORMAT,
                Some(wgpu::BlendState::ALPHA_BLENDING),
            )],
        }),
        multiview_mask: None,
        cache: None,
    })
}
