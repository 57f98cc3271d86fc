//! Meshes of traced paths whose triangles come in the order of time.

use super::mesh::Mesh;
use super::tube::RingFrame;
use crate::math::sin_cos;
use glam::DVec3;
use std::f64::consts::TAU;

/// Fewest segments around a trace.
const MIN_TRACE_SEGMENTS: u32 = 3;
/// Triangles of one step for each side of the tube: three for the round start, two for the side, one for
/// the tip.
const TRIANGLES_PER_SEGMENT: u32 = 6;
/// Sine of the latitude of the ring that rounds the start of a step: 45 degrees, halfway to the pole.
const ROUND: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A traced path: the first `k * triangles_per_step` triangles are the path up to point k.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TraceMesh {
    /// The whole path.
    pub mesh: Mesh,
    /// Triangles that each step from one point to the next takes.
    pub triangles_per_step: u32,
}

/// The tube of `radius` with `segments` sides along a path, one step for each point after the first.
///
/// Every step is a closed piece with the same number of triangles, round at its start (the joint with the previous
/// step) and pointed at its end, so that a growing range draws a growing trace. A step to or from a missing point
/// (`None`, or not finite) and one without length has triangles without area.
pub fn trace_mesh(points: &[Option<DVec3>], radius: f64, segments: u32) -> TraceMesh {
    let segments = segments.max(MIN_TRACE_SEGMENTS);
    let triangles_per_step = TRIANGLES_PER_SEGMENT * segments;
    let mut trace = TraceTube {
        radius,
        segments,
        mesh: Mesh::default(),
    };
    let mut frame: Option<RingFrame> = None;
    for pair in points.windows(2) {
        let ends = match pair {
            [Some(from), Some(to)] if from.is_finite() && to.is_finite() => Some([*from, *to]),
            _ => None,
        };
        let direction = ends.and_then(|[from, to]| (to - from).try_normalize());
        // The ring's frame is carried along without twist; missing points keep the last frame.
        if let (Some(ends), Some(direction)) = (ends, direction) {
            let carried = frame.map_or_else(
                || RingFrame::across(direction),
                |before| before.carried_to(direction),
            );
            trace.step(ends, &carried);
            frame = Some(carried);
        } else {
            trace.skip_triangles(triangles_per_step);
        }
    }
    TraceMesh {
        mesh: trace.mesh,
        triangles_per_step,
    }
}

struct TraceTube {
    radius: f64,
    segments: u32,
    mesh: Mesh,
}

impl TraceTube {
    /// Triangles without area, so that later ones keep their index.
    fn skip_triangles(&mut self, count: u32) {
        if self.mesh.positions.is_empty() {
            self.mesh.push_vertex(DVec3::ZERO, DVec3::Z);
        }
        let none = [0; 3];
        self.mesh
            .triangles
            .extend(std::iter::repeat_n(none, count as usize));
    }

    fn step(&mut self, [from, to]: [DVec3; 2], frame: &RingFrame) {
        let direction = frame.direction();
        let shoulder = self.push_ring(from, frame, -ROUND);
        let start = self.push_ring(from, frame, 0.0);
        let end = self.push_ring(to, frame, 0.0);
        self.close_tip(from, -direction, shoulder, true);
        self.join(shoulder, start);
        self.join(start, end);
        self.close_tip(to, direction, end, false);
    }

    /// A ring on the ball around `centre`, `height` radii along the direction of the tube.
    fn push_ring(&mut self, centre: DVec3, frame: &RingFrame, height: f64) -> u32 {
        let first = self.mesh.positions.len() as u32;
        let width = (1.0 - height * height).sqrt();
        for k in 0..self.segments {
            let (sin, cos) = sin_cos(TAU * f64::from(k) / f64::from(self.segments));
            let outward = frame.first * cos + frame.second * sin;
            let normal = outward * width + frame.direction() * height;
            self.mesh.push_vertex(centre + normal * self.radius, normal);
        }
        first
    }

    fn join(&mut self, from: u32, to: u32) {
        for k in 0..self.segments {
            let next = (k + 1) % self.segments;
            let [a, b] = [from + k, from + next];
            let [d, c] = [to + k, to + next];
            self.mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }

    fn close_tip(&mut self, centre: DVec3, outward: DVec3, ring: u32, start: bool) {
        let pole = self
            .mesh
            .push_vertex(centre + outward * self.radius, outward);
        for k in 0..self.segments {
            let (a, b) = (ring + k, ring + (k + 1) % self.segments);
            self.mesh
                .triangles
                .push(if start { [b, a, pole] } else { [a, b, pole] });
        }
    }
}
