//! A frame as a list of draws: the instances, their order, and their pipelines. Does not use a device.

use super::layout::{InstanceData, instance_data};
use crate::render::depth_order::Eye;
use crate::render::{Frame, Instance, edges};
use glam::DVec3;

/// Where a mesh lies in the index buffer, and what drawing needs to know of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshSpan {
    /// First index.
    pub first_index: u32,
    /// Triangles.
    pub triangles: u32,
    /// Whether the outside completely hides the inside.
    pub closed: bool,
    /// Smooth patches.
    pub patches: u32,
    /// What its vertices are counted from.
    pub origin: DVec3,
    /// Whether it is a mesh of the frame, in buffers of its own.
    pub of_frame: bool,
}

/// One draw call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// First index.
    pub first_index: u32,
    /// Number of indices.
    pub indices: u32,
    /// First instance of the plan's instances.
    pub first_instance: u32,
    /// Number of instances.
    pub instances: u32,
    /// Whether back faces may be culled.
    pub closed: bool,
    /// Whether its triangles are in the buffers of the frame.
    pub of_frame: bool,
}

/// What a frame draws.
#[derive(Clone, Debug, Default)]
pub struct DrawPlan {
    /// Opaque instances in the frame's order, then translucent ones.
    pub instances: Vec<InstanceData>,
    /// Opaque draws.
    pub opaque: Vec<Draw>,
    /// Translucent draws.
    pub translucent: Vec<Draw>,
}

impl DrawPlan {
    /// Orders a frame's instances. Triangle ranges are cut to the mesh; instances of opacity 0 or less and empty
    /// ranges are left out, and so are instances of a mesh that the stage lacks.
    ///
    /// Lines stand at creases too if `creases`: then every patch is a surface of its own.
    pub fn new(frame: &Frame, spans: &[MeshSpan], eye: &Eye, creases: bool) -> Self {
        let mut plan = Self::default();
        let mut translucent = Vec::new();
        let mut surfaces = 0;
        for (number, instance) in frame.instances.iter().enumerate() {
            let Some(span) = spans.get(instance.mesh).copied() else {
                continue;
            };
            let surface =
                edges::first_surface(instance.outline, instance.opacity, creases, surfaces);
            surfaces += span.patches;
            let rows = eye.camera_from_mesh((instance, span.origin), number);
            let data = instance_data(instance, rows, surface);
            if instance.opacity >= 1.0 {
                push_draw(&mut plan.opaque, &mut plan.instances, &span, instance, data);
            } else if instance.opacity > 0.0 {
                translucent.push((span, instance, data));
            }
        }
        for (span, instance, data) in translucent {
            let draws = &mut plan.translucent;
            push_draw(draws, &mut plan.instances, &span, instance, data);
        }
        plan
    }
}

/// Appends an instance, to the last draw if that draws the same triangles.
fn push_draw(
    draws: &mut Vec<Draw>,
    instances: &mut Vec<InstanceData>,
    span: &MeshSpan,
    instance: &Instance,
    data: InstanceData,
) {
    let end = instance.triangles.end.min(span.triangles);
    let start = instance.triangles.start.min(end);
    if start == end {
        return;
    }
    let draw = Draw {
        first_index: span.first_index + 3 * start,
        indices: 3 * (end - start),
        first_instance: instances.len() as u32,
        instances: 1,
        closed: span.closed && end - start == span.triangles,
        of_frame: span.of_frame,
    };
    instances.push(data);
    match draws.last_mut() {
        Some(last) if same_triangles(last, &draw) => last.instances += 1,
        _ => draws.push(draw),
    }
}

fn same_triangles(a: &Draw, b: &Draw) -> bool {
    a.first_index == b.first_index && a.indices == b.indices && a.of_frame == b.of_frame
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::math::Pose;
    use glam::DVec3;

    const SPANS: [MeshSpan; 2] = [
        MeshSpan {
            first_index: 0,
            triangles: 10,
            closed: true,
            patches: 1,
            origin: DVec3::ZERO,
            of_frame: false,
        },
        MeshSpan {
            first_index: 30,
            triangles: 4,
            closed: false,
            patches: 1,
            origin: DVec3::ZERO,
            of_frame: false,
        },
    ];

    fn instance(mesh: usize, z: f64, opacity: f64) -> Instance {
        Instance {
            mesh,
            world_from_mesh: Pose::from_translation(DVec3::Z * z),
            colour: [200, 10, 10],
            opacity,
            triangles: 0..SPANS[mesh.min(1)].triangles,
            casts_shadow: true,
            outline: None,
            flat: 0.0,
        }
    }

    fn plan(instances: Vec<Instance>) -> DrawPlan {
        let frame = Frame {
            instances,
            ..Frame::default()
        };
        let eye = Eye {
            camera_from_world: Pose::IDENTITY,
            perspective: true,
            pixel: 0.0,
        };
        DrawPlan::new(&frame, &SPANS, &eye, true)
    }

    #[test]
    fn equal_neighbours_share_a_draw() {
        let plan = plan(vec![
            instance(0, 0.0, 1.0),
            instance(0, 1.0, 1.0),
            instance(1, 0.0, 1.0),
        ]);
        assert_eq!(plan.opaque.len(), 2);
        assert_eq!(
            (plan.opaque[0].instances, plan.opaque[1].first_instance),
            (2, 2)
        );
        assert!(plan.opaque[0].closed && !plan.opaque[1].closed);
    }

    #[test]
    fn translucent_ones_come_last() {
        let plan = plan(vec![
            instance(0, -1.0, 0.5),
            instance(0, -9.0, 0.5),
            instance(0, -5.0, 1.0),
            instance(0, -4.0, 0.0),
        ]);
        let depths: Vec<f32> = plan
            .instances
            .iter()
            .map(|i| i.camera_from_mesh[2][3].round())
            .collect();
        assert_eq!(depths, [-5.0, -1.0, -9.0]);
        let [draw] = plan.translucent[..] else {
            panic!("one mesh, one draw: {:?}", plan.translucent);
        };
        assert_eq!((draw.first_instance, draw.instances), (1, 2));
    }

    #[test]
    fn ranges_are_cut_to_the_mesh_and_partial_meshes_are_open() {
        let mut part = instance(0, 0.0, 1.0);
        part.triangles = 8..1000;
        let mut none = instance(0, 0.0, 1.0);
        none.triangles = 12..20;
        let plan = plan(vec![part, none]);
        assert_eq!(plan.opaque.len(), 1);
        let draw = plan.opaque[0];
        assert_eq!(
            (draw.first_index, draw.indices, draw.closed),
            (24, 6, false)
        );
    }

    #[test]
    fn an_unknown_mesh_is_left_out() {
        let plan = plan(vec![instance(5, 0.0, 1.0), instance(1, 0.0, 1.0)]);
        assert_eq!((plan.instances.len(), plan.opaque.len()), (1, 1));
    }
}
