//! Meshes on the device, uploaded once, and the instances of the current frame.

use super::device::Device;
use super::frame::MeshSpan;
use super::layout::{GpuVertex, InstanceData};
use crate::render::{RenderError, StageMesh};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// All meshes of a stage in one vertex and one index buffer; clones are the same ones.
#[derive(Clone)]
pub struct Meshes {
    /// Vertices of all meshes.
    pub vertices: wgpu::Buffer,
    /// Indices into all vertices.
    pub indices: wgpu::Buffer,
    /// One for each mesh of the stage.
    pub spans: Vec<MeshSpan>,
}

impl Meshes {
    /// Uploads meshes of a stage, or those of a frame; indices are absolute.
    pub fn new(device: &Device, meshes: &[StageMesh], of_frame: bool) -> Result<Self, RenderError> {
        check_total(meshes, device.device.limits().max_buffer_size)?;
        let mut vertices = Vec::new();
        let mut indices = Vec::new();
        let mut spans = Vec::new();
        for mesh in meshes {
            let base = vertices.len() as u32;
            let points = mesh.positions.iter().zip(&mesh.normals).zip(&mesh.patches);
            vertices.extend(points.map(|((position, normal), patch)| GpuVertex {
                position: *position,
                normal: *normal,
                patch: *patch,
            }));
            spans.push(MeshSpan {
                first_index: indices.len() as u32,
                triangles: mesh.triangles.len() as u32,
                closed: mesh.closed,
                patches: mesh.patch_count,
                origin: mesh.origin,
                of_frame,
            });
            indices.extend(mesh.triangles.iter().flatten().map(|corner| base + corner));
        }
        Ok(Self {
            vertices: upload_buffer(device, "vertices", &vertices, wgpu::BufferUsages::VERTEX),
            indices: upload_buffer(device, "indices", &indices, wgpu::BufferUsages::INDEX),
            spans,
        })
    }
}

/// A buffer of at least one element: empty ones cannot be bound.
fn upload_buffer<T: bytemuck::Pod>(
    device: &Device,
    label: &str,
    data: &[T],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let nothing = [T::zeroed()];
    let data = if data.is_empty() { &nothing } else { data };
    device.device.create_buffer_init(&BufferInitDescriptor {
        label: Some(label),
        contents: bytemuck::cast_slice(data),
        usage,
    })
}

fn check_total(meshes: &[StageMesh], largest: u64) -> Result<(), RenderError> {
    let vertices: usize = meshes.iter().map(|m| m.positions.len()).sum();
    let corners: usize = meshes.iter().map(|m| 3 * m.triangles.len()).sum();
    let bytes = (vertices * size_of::<GpuVertex>()).max(corners * size_of::<u32>()) as u64;
    if bytes > largest || vertices > u32::MAX as usize || corners > u32::MAX as usize {
        return Err(RenderError::Size(format!(
            "the scene's meshes take {} MiB, more than the {} MiB this adapter holds in one buffer",
            bytes >> 20,
            largest >> 20
        )));
    }
    Ok(())
}

/// The instance buffer, which grows with the frames.
pub struct InstanceBuffer {
    buffer: wgpu::Buffer,
}

impl InstanceBuffer {
    /// An empty buffer.
    pub fn new(device: &Device) -> Self {
        Self {
            buffer: allocate_instances(device, 64),
        }
    }

    /// Replaces the instances and gives the buffer to bind.
    pub fn write(&mut self, device: &Device, instances: &[InstanceData]) -> &wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(instances);
        if bytes.len() as u64 > self.buffer.size() {
            self.buffer = allocate_instances(device, instances.len().next_power_of_two());
        }
        device.queue.write_buffer(&self.buffer, 0, bytes);
        &self.buffer
    }
}

fn allocate_instances(device: &Device, instances: usize) -> wgpu::Buffer {
    device.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("instances"),
        size: (instances * size_of::<InstanceData>()) as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
