//! From instances to the triangles that each tile has to draw: transform, cull, clip, sort into tiles.

use super::clip::{ClipCorner, clip_triangle};
use super::lens::{Lens, LensVertex, OUTSIDE};
use super::samples::SamplePattern;
use super::solid::SolidPixels;
use super::window::TILE;
use crate::math::narrow_pose;
use crate::render::colour::ToneCurve;
use crate::render::look::Rgb;
use crate::render::{Frame, Instance};

/// Set in [`Facet::instance`] when the back of the triangle is seen.
const BACK: u32 = 1 << 31;

/// A triangle that is seen, its corners counter-clockwise on the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    /// Indices into [`Assembly::vertices`].
    pub(super) corners: [u32; 3],
    instance: u32,
}

impl Facet {
    #[inline(always)]
    pub(super) fn instance(&self) -> usize {
        (self.instance & !BACK) as usize
    }

    /// The sign of normals on the side that is seen.
    #[inline(always)]
    pub(super) fn side(&self) -> f32 {
        if self.instance & BACK == 0 { 1.0 } else { -1.0 }
    }
}

/// What shading needs to know of an instance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Paint {
    pub(super) albedo: Rgb,
    pub(super) flat: f32,
    pub(super) opacity: f32,
}

/// Facets of one tile, as indices into [`Assembly::facets`].
#[derive(Clone, Debug, Default)]
pub(super) struct TileBin {
    pub(super) opaque: Vec<u32>,
    /// In drawing order, farthest instance first, its back faces before its front faces.
    pub(super) translucent: Vec<u32>,
}

/// Everything of one frame between the scene and its tiles. Kept between frames for its memory.
#[derive(Clone, Debug, Default)]
pub(super) struct TriangleAssembly {
    pub(super) vertices: Vec<LensVertex>,
    pub(super) facets: Vec<Facet>,
    pub(super) paints: Vec<Paint>,
    pub(super) bins: Vec<TileBin>,
    columns: usize,
    size: [i32; 2],
    first_vertex: Vec<u32>,
    order: Vec<(f64, usize)>,
}

/// Which faces of an instance a sweep takes.
#[derive(Clone, Copy, PartialEq)]
enum FacesDrawn {
    Front,
    Back,
    Both,
}

impl TriangleAssembly {
    pub(super) fn new(size: [u32; 2]) -> Self {
        let columns = size[0].div_ceil(TILE as u32) as usize;
        let rows = size[1].div_ceil(TILE as u32) as usize;
        Self {
            bins: vec![TileBin::default(); columns * rows],
            columns,
            size: size.map(|n| n as i32),
            ..Self::default()
        }
    }

    /// The vertices of a facet.
    #[inline(always)]
    pub(super) fn corners(&self, [a, b, c]: &[u32; 3]) -> [&LensVertex; 3] {
        [
            &self.vertices[*a as usize],
            &self.vertices[*b as usize],
            &self.vertices[*c as usize],
        ]
    }

    /// Top left pixel of a tile.
    pub(super) fn origin(&self, tile: usize) -> [i32; 2] {
        [tile % self.columns, tile / self.columns].map(|k| (k * TILE) as i32)
    }

    /// Fills the bins with a frame's facets. Instances of meshes that do not exist are left out.
    pub(super) fn assemble<const G: usize>(
        &mut self,
        frame: &Frame,
        solids: &[SolidPixels],
        lens: &Lens,
        pattern: &SamplePattern<G>,
    ) {
        self.clear();
        for instance in &frame.instances {
            self.place(instance, solids.get(instance.mesh), lens);
        }
        for (index, instance) in frame.instances.iter().enumerate() {
            let Some(solid) = solids.get(instance.mesh) else {
                continue;
            };
            if instance.opacity >= 1.0 {
                // A part of a closed mesh is open.
                let whole = instance.triangles.start == 0
                    && instance.triangles.end as usize >= solid.triangles.len();
                let faces = if solid.closed && whole {
                    FacesDrawn::Front
                } else {
                    FacesDrawn::Both
                };
                self.sweep(index, instance, solid, lens, pattern, faces);
            } else if instance.opacity > 0.0 {
                let middle = (solid.bounds[0] + solid.bounds[1]) * 0.5;
                let pose = lens.camera_from_world * instance.world_from_mesh;
                let height = pose.transform_point(middle).z;
                if height.is_finite() {
                    self.order.push((height, index));
                }
            }
        }
        // Lowest along the viewer's axis is farthest; equal ones keep the order of the frame.
        self.order
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for k in 0..self.order.len() {
            let index = self.order[k].1;
            let instance = &frame.instances[index];
            let solid = &solids[instance.mesh];
            self.sweep(index, instance, solid, lens, pattern, FacesDrawn::Back);
            self.sweep(index, instance, solid, lens, pattern, FacesDrawn::Front);
        }
    }

    fn clear(&mut self) {
        self.vertices.clear();
        self.facets.clear();
        self.paints.clear();
        self.first_vertex.clear();
        self.order.clear();
        for bin in &mut self.bins {
            bin.opaque.clear();
            bin.translucent.clear();
        }
    }

    /// Puts an instance's vertices on the screen.
    fn place(&mut self, instance: &Instance, solid: Option<&SolidPixels>, lens: &Lens) {
        let curve = ToneCurve::shared();
        self.first_vertex.push(self.vertices.len() as u32);
        self.paints.push(Paint {
            albedo: curve.decode_rgb(instance.colour),
            flat: instance.flat.clamp(0.0, 1.0) as f32,
            opacity: instance.opacity.clamp(0.0, 1.0) as f32,
        });
        let Some(solid) = solid else { return };
        let [x, y, z] = narrow_pose(&(lens.camera_from_world * instance.world_from_mesh));
        let row = |r: [f32; 4], p: [f32; 3]| r[0] * p[0] + r[1] * p[1] + r[2] * p[2];
        let points = solid.positions.iter().zip(&solid.normals);
        self.vertices.extend(points.map(|(p, n)| {
            lens.project(
                [row(x, *p) + x[3], row(y, *p) + y[3], row(z, *p) + z[3]],
                [row(x, *n), row(y, *n), row(z, *n)],
            )
        }));
    }

    fn sweep<const G: usize>(
        &mut self,
        index: usize,
        instance: &Instance,
        solid: &SolidPixels,
        lens: &Lens,
        pattern: &SamplePattern<G>,
        faces: FacesDrawn,
    ) {
        let base = self.first_vertex[index];
        let count = solid.triangles.len();
        let start = (instance.triangles.start as usize).min(count);
        let end = (instance.triangles.end as usize).clamp(start, count);
        for (offset, triangle) in solid.triangles[start..end].iter().enumerate() {
            let corners = [triangle[0] + base, triangle[1] + base, triangle[2] + base];
            let [a, b, c] = self.corners(&corners);
            if a.x == OUTSIDE || b.x == OUTSIDE || c.x == OUTSIDE {
                self.clipped(index, instance, solid, lens, pattern, faces, start + offset);
            } else {
                let places = [[a.x, a.y], [b.x, b.y], [c.x, c.y]];
                self.facet(corners, places, index, pattern, faces);
            }
        }
    }

    /// Adds a triangle whose corners are all on the screen's plane, if its side is asked for and it can
    /// hold a sample.
    #[inline(always)]
    fn facet<const G: usize>(
        &mut self,
        [i, j, k]: [u32; 3],
        [a, b, c]: [[i32; 2]; 3],
        index: usize,
        pattern: &SamplePattern<G>,
        faces: FacesDrawn,
    ) {
        let product = |p: i32, q: i32| i64::from(p) * i64::from(q);
        let area = product(c[0] - a[0], b[1] - a[1]) - product(b[0] - a[0], c[1] - a[1]);
        let front = area > 0;
        if area == 0
            || (faces == FacesDrawn::Front && !front)
            || (faces == FacesDrawn::Back && front)
        {
            return;
        }
        let [left, right] = [a[0].min(b[0]).min(c[0]), a[0].max(b[0]).max(c[0])];
        let [top, bottom] = [a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1])];
        if !(pattern.meets(left, right) && pattern.meets(top, bottom)) {
            return;
        }
        let [x0, x1] = pattern.pixels(left, right);
        let [y0, y1] = pattern.pixels(top, bottom);
        let [x0, x1] = [x0.max(0), x1.min(self.size[0] - 1)];
        let [y0, y1] = [y0.max(0), y1.min(self.size[1] - 1)];
        if x0 > x1 || y0 > y1 {
            return;
        }
        let number = self.facets.len() as u32;
        self.facets.push(Facet {
            corners: if front { [i, j, k] } else { [i, k, j] },
            instance: index as u32 | if front { 0 } else { BACK },
        });
        let opaque = self.paints[index].opacity >= 1.0;
        let tile = |pixel: i32| pixel as usize / TILE;
        for row in tile(y0)..=tile(y1) {
            for column in tile(x0)..=tile(x1) {
                let bin = &mut self.bins[row * self.columns + column];
                if opaque {
                    bin.opaque.push(number);
                } else {
                    bin.translucent.push(number);
                }
            }
        }
    }

    /// The part of a triangle that can be projected, as a fan of new vertices.
    #[cold]
    #[allow(clippy::too_many_arguments)]
    fn clipped<const G: usize>(
        &mut self,
        index: usize,
        instance: &Instance,
        solid: &SolidPixels,
        lens: &Lens,
        pattern: &SamplePattern<G>,
        faces: FacesDrawn,
        triangle: usize,
    ) {
        let [x, y, z] = narrow_pose(&(lens.camera_from_world * instance.world_from_mesh));
        let row = |r: [f32; 4], p: [f32; 3]| r[0] * p[0] + r[1] * p[1] + r[2] * p[2];
        let corners = solid.triangles[triangle].map(|i| {
            let (p, n) = (solid.positions[i as usize], solid.normals[i as usize]);
            ClipCorner {
                position: [row(x, p) + x[3], row(y, p) + y[3], row(z, p) + z[3]],
                normal: [row(x, n), row(y, n), row(z, n)],
            }
        });
        let polygon = clip_triangle(corners, &lens.planes());
        let polygon = polygon.corners();
        let first = self.vertices.len() as u32;
        for corner in polygon {
            self.vertices
                .push(lens.project(corner.position, corner.normal));
        }
        for k in 2..polygon.len() as u32 {
            let fan = [first, first + k - 1, first + k];
            let places = fan.map(|i| &self.vertices[i as usize]).map(|v| [v.x, v.y]);
            if places.iter().all(|p| p[0] != OUTSIDE) {
                self.facet(fan, places, index, pattern, faces);
            }
        }
    }
}
