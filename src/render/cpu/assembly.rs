//! From instances to the triangles that each tile has to draw: transform, cull, clip, sort into tiles.

mod renewal;
mod tile_bin;
mod tiles;

use super::clip::{ClipCorner, clip_triangle};
use super::lens::{Lens, LensVertex, OUTSIDE};
use super::mask::PixelMask;
use super::raster::DIRECT_REACH;
use super::samples::SamplePattern;
use super::window::{Window, line_apron, pitch};
use crate::render::colour::ToneCurve;
use crate::render::edges::{self, BACKDROP};
use crate::render::last_frame::LastFrame;
use crate::render::look::Rgb;
use crate::render::{Camera, Frame, Instance, MeshList, Stage, StageMesh};
use std::ops::Range;
pub(super) use tile_bin::TileBin;

/// Set in [`Facet::instance`] when the back of the triangle is seen.
const BACK: u32 = 1 << 31;
/// Set there when a side of the triangle is longer than [`DIRECT_REACH`] along an axis.
const LONG: u32 = 1 << 30;

/// A visible triangle, its corners counter-clockwise on the screen.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Facet {
    /// Indices into [`TriangleAssembly::vertices`].
    pub(super) corners: [u32; 3],
    instance: u32,
    /// The attributes that separate surfaces for lines.
    surface: u32,
    /// First and last column and row of the pixels in which it can have a sample.
    columns: [u16; 2],
    rows: [u16; 2],
}

impl Facet {
    #[inline(always)]
    pub(super) fn instance(&self) -> usize {
        (self.instance & !(BACK | LONG)) as usize
    }

    /// The pixels in which it can have a sample.
    #[inline(always)]
    pub(super) fn pixels(&self) -> Window {
        Window {
            x: self.columns.map(i32::from),
            y: self.rows.map(i32::from),
        }
    }

    /// Whether all sides are shorter than [`DIRECT_REACH`] along both axes.
    #[inline(always)]
    pub(super) fn is_short(&self) -> bool {
        self.instance & LONG == 0
    }

    /// The sign of normals on the visible side.
    #[inline(always)]
    pub(super) fn side(&self) -> f32 {
        if self.instance & BACK == 0 { 1.0 } else { -1.0 }
    }
}

/// The properties of an instance needed for shading.
#[derive(Clone, Copy, Debug)]
pub(super) struct Paint {
    pub(super) albedo: Rgb,
    pub(super) flat: f32,
    pub(super) opacity: f32,
}

/// Where an instance is in the lists of a frame.
#[derive(Clone, Debug, PartialEq)]
struct InstancePlace {
    vertices: Range<u32>,
    /// Its first surface, and the step from patch to patch.
    surface: [u32; 2],
    /// Triangles of its mesh: there is room for as many facets.
    triangles: u32,
    facets: Range<u32>,
}

/// Everything of one frame between the scene and its tiles. Kept between frames for its memory.
#[derive(Clone, Debug, Default)]
pub(super) struct TriangleAssembly {
    pub(super) vertices: Vec<LensVertex>,
    pub(super) facets: Vec<Facet>,
    pub(super) paints: Vec<Paint>,
    /// The tiles that are drawn.
    pub(super) bins: Vec<TileBin>,
    columns: usize,
    size: [i32; 2],
    /// First and last row of the tiles that are drawn, both as a number of tiles.
    tile_rows: [i32; 2],
    /// First and last row of pixels that these tiles depend on.
    reach: [i32; 2],
    /// Size of a tile in pixels, and the width of the apron that its lines depend on.
    pitch: i32,
    pub(super) apron: i32,
    /// Whether lines are drawn at creases, too.
    creases: bool,
    places: Vec<InstancePlace>,
    /// Where the next facet is stored.
    next: usize,
    /// Whether still instances are as they were in the frame before.
    is_renewed: bool,
    /// Whether any triangle was clipped, whose facets have vertices of their own.
    is_clipped: bool,
    last: LastFrame,
    /// Number of the stage's meshes.
    of_stage: usize,
}

/// The faces of an instance that a sweep processes.
#[derive(Clone, Copy, PartialEq)]
enum FacesDrawn {
    Front,
    Both,
}

impl TriangleAssembly {
    pub(super) fn new(stage: &Stage) -> Self {
        let size = stage.size;
        let pitch = pitch(stage);
        Self {
            pitch: pitch as i32,
            apron: line_apron(stage),
            creases: stage.edges.is_some_and(|edges| edges.creases),
            columns: size[0].div_ceil(pitch) as usize,
            size: size.map(|n| n as i32),
            of_stage: stage.meshes.len(),
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

    /// The surface of a facet, or the background.
    #[inline(always)]
    pub(super) fn surface(&self, facet: i32) -> u32 {
        let facet = self.facets.get(facet as usize);
        facet.map_or(BACKDROP, |facet| facet.surface)
    }

    /// Fills the bins with a frame's facets. Instances of meshes that do not exist are left out.
    pub(super) fn assemble<const G: usize>(
        &mut self,
        frame: &Frame,
        solids: MeshList,
        (camera, lens): (&Camera, &Lens),
        pattern: &SamplePattern<G>,
    ) {
        let changes = self.last.replace(frame, camera, self.of_stage);
        let changes = changes.filter(|_| !self.is_clipped);
        // Whether tiles that stay empty are as they were, if everything is done again.
        let is_alike = changes.as_ref().is_some_and(|c| !self.is_worth_it(c));
        self.is_renewed = !is_alike
            && changes.is_some_and(|changes| {
                self.is_renewed = true;
                self.renew(frame, solids, lens, pattern, changes)
            });
        if !self.is_renewed {
            self.clear(is_alike);
            self.assemble_all(frame, solids, lens, pattern);
        }
    }

    fn assemble_all<const G: usize>(
        &mut self,
        frame: &Frame,
        solids: MeshList,
        lens: &Lens,
        pattern: &SamplePattern<G>,
    ) {
        self.list_instances(frame, solids);
        for (index, instance) in frame.instances.iter().enumerate() {
            if let Some(solid) = solids.get(instance.mesh) {
                self.vertices
                    .extend(on_screen(index, instance, solid, lens));
            }
        }
        for (index, instance) in frame.instances.iter().enumerate() {
            let first = self.facets.len();
            self.next = first;
            if let Some(solid) = solids.get(instance.mesh) {
                self.sweep_shape(index, instance, solid, lens, pattern, 0);
            }
            let place = &mut self.places[index];
            place.facets = first as u32..self.next as u32;
            // Room for all its facets, should it turn.
            let room = first + place.triangles as usize;
            self.facets.resize(room.max(self.next), Facet::default());
        }
        for bin in self.bins.iter_mut().filter(|bin| !bin.is_empty()) {
            bin.changed = PixelMask::ALL;
        }
    }

    fn clear(&mut self, is_alike: bool) {
        self.vertices.clear();
        self.facets.clear();
        self.is_clipped = false;
        for bin in &mut self.bins {
            bin.changed = if is_alike && bin.is_empty() {
                PixelMask::NONE
            } else {
                PixelMask::ALL
            };
            bin.opaque.clear();
            bin.translucent.clear();
        }
    }

    /// Lists the paints of all instances, and what they need of the other lists.
    fn list_instances(&mut self, frame: &Frame, solids: MeshList) {
        let curve = ToneCurve::shared();
        self.paints.clear();
        self.places.clear();
        let (mut vertex, mut surfaces) = (0, 0);
        for instance in &frame.instances {
            self.paints.push(Paint {
                albedo: curve.decode_rgb(instance.colour),
                flat: instance.flat.clamp(0.0, 1.0) as f32,
                opacity: instance.opacity.clamp(0.0, 1.0) as f32,
            });
            // Surfaces are numbered through the frame: every smooth patch of every instance has its own.
            let surface =
                edges::first_surface(instance.outline, instance.opacity, self.creases, surfaces);
            let solid = solids.get(instance.mesh);
            let count = solid.map_or(0, |solid| solid.positions.len() as u32);
            self.places.push(InstancePlace {
                vertices: vertex..vertex + count,
                surface,
                triangles: solid.map_or(0, |solid| solid.triangles.len() as u32),
                facets: 0..0,
            });
            vertex += count;
            surfaces += solid.map_or(0, |solid| solid.patch_count);
        }
    }

    /// Adds the facets of an instance, of its triangles from `from` on.
    fn sweep_shape<const G: usize>(
        &mut self,
        index: usize,
        instance: &Instance,
        solid: &StageMesh,
        lens: &Lens,
        pattern: &SamplePattern<G>,
        from: u32,
    ) {
        let Some(faces) = faces_drawn(instance, solid) else {
            return;
        };
        let base = self.places[index].vertices.start;
        let count = solid.triangles.len();
        // An instance may draw a range of the triangles of its mesh.
        let start = (instance.triangles.start.max(from) as usize).min(count);
        let end = (instance.triangles.end as usize).clamp(start, count);
        for (offset, triangle) in solid.triangles[start..end].iter().enumerate() {
            let corners = [triangle[0] + base, triangle[1] + base, triangle[2] + base];
            let [a, b, c] = self.corners(&corners);
            // A vertex outside the grid sends the triangle through the clipper.
            if a.x == OUTSIDE || b.x == OUTSIDE || c.x == OUTSIDE {
                self.clipped(index, instance, solid, lens, pattern, faces, start + offset);
            } else {
                let places = [[a.x, a.y], [b.x, b.y], [c.x, c.y]];
                let surface = self.surface_of(index, solid, triangle[0]);
                self.facet(corners, places, (index, surface), pattern, faces);
            }
        }
    }

    /// Whether two facets have a vertex, and so its normal, in common.
    #[inline(always)]
    pub(super) fn is_smooth(&self, first: i32, second: i32) -> bool {
        let [a, b, c] = self.facets[first as usize].corners;
        let other = &self.facets[second as usize].corners;
        let shared = |v: u32| (v == other[0]) | (v == other[1]) | (v == other[2]);
        shared(a) | shared(b) | shared(c)
    }

    /// The surface of the patch of an instance that a vertex belongs to.
    #[inline(always)]
    fn surface_of(&self, index: usize, solid: &StageMesh, vertex: u32) -> u32 {
        let [first, step] = self.places[index].surface;
        first + step * solid.patches[vertex as usize]
    }

    /// Adds a triangle whose corners can all be projected, if its side is requested and it can contain a sample.
    #[inline(always)]
    fn facet<const G: usize>(
        &mut self,
        [i, j, k]: [u32; 3],
        [a, b, c]: [[i32; 2]; 3],
        (index, surface): (usize, u32),
        pattern: &SamplePattern<G>,
        faces: FacesDrawn,
    ) {
        let product = |p: i32, q: i32| i64::from(p) * i64::from(q);
        // Twice the signed area, exact in 64 bits: positive where the corners run counterclockwise on the screen.
        let area = product(c[0] - a[0], b[1] - a[1]) - product(b[0] - a[0], c[1] - a[1]);
        let front = area > 0;
        if area == 0 || (faces == FacesDrawn::Front && !front) {
            return;
        }
        // The bounding box: without a sample inside, or outside the rows that are drawn, there is nothing to draw.
        let [left, right] = [a[0].min(b[0]).min(c[0]), a[0].max(b[0]).max(c[0])];
        let [top, bottom] = [a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1])];
        if !(pattern.meets(left, right) && pattern.meets(top, bottom)) {
            return;
        }
        let [x0, x1] = pattern.pixels(left, right);
        let [y0, y1] = pattern.pixels(top, bottom);
        let [x0, x1] = [x0.max(0), x1.min(self.size[0] - 1)];
        let [y0, y1] = [y0.max(self.reach[0]), y1.min(self.reach[1])];
        if x0 > x1 || y0 > y1 {
            return;
        }
        let is_short = right - left < DIRECT_REACH && bottom - top < DIRECT_REACH;
        // A back side is stored with two corners exchanged, so that all facets run the same way.
        let number = self.store(Facet {
            corners: if front { [i, j, k] } else { [i, k, j] },
            instance: index as u32 | if front { 0 } else { BACK } | if is_short { 0 } else { LONG },
            surface,
            columns: [x0, x1].map(|x| x as u16),
            rows: [y0, y1].map(|y| y as u16),
        });
        self.add_to_tiles(number);
    }

    /// Stores a facet and returns its number.
    #[inline(always)]
    fn store(&mut self, facet: Facet) -> u32 {
        match self.facets.get_mut(self.next) {
            Some(place) => *place = facet,
            None => self.facets.push(facet),
        }
        self.next += 1;
        self.next as u32 - 1
    }

    /// The part of a triangle that can be projected, as a fan of new vertices.
    #[cold]
    #[allow(clippy::too_many_arguments)]
    fn clipped<const G: usize>(
        &mut self,
        index: usize,
        instance: &Instance,
        solid: &StageMesh,
        lens: &Lens,
        pattern: &SamplePattern<G>,
        faces: FacesDrawn,
        triangle: usize,
    ) {
        self.is_clipped = true;
        let [x, y, z] = lens.eye.camera_from_mesh((instance, solid.origin), index);
        // The corners in camera space, clipped at the planes of the view.
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
        // The clipped polygon as a fan of triangles.
        for k in 2..polygon.len() as u32 {
            let fan = [first, first + k - 1, first + k];
            let places = fan.map(|i| &self.vertices[i as usize]).map(|v| [v.x, v.y]);
            if places.iter().all(|p| p[0] != OUTSIDE) {
                let surface = self.surface_of(index, solid, solid.triangles[triangle][0]);
                self.facet(fan, places, (index, surface), pattern, faces);
            }
        }
    }
}

/// The vertices of an instance on the screen.
fn on_screen<'a>(
    index: usize,
    instance: &Instance,
    solid: &'a StageMesh,
    lens: &'a Lens,
) -> impl Iterator<Item = LensVertex> + use<'a> {
    // Vertices to camera space and onto the sample grid, once for all triangles.
    let [x, y, z] = lens.eye.camera_from_mesh((instance, solid.origin), index);
    let row = |r: [f32; 4], p: [f32; 3]| r[0] * p[0] + r[1] * p[1] + r[2] * p[2];
    let points = solid.positions.iter().zip(&solid.normals);
    points.map(move |(p, n)| {
        lens.project(
            [row(x, *p) + x[3], row(y, *p) + y[3], row(z, *p) + z[3]],
            [row(x, *n), row(y, *n), row(z, *n)],
        )
    })
}

/// The faces of an instance that are drawn, if any.
fn faces_drawn(instance: &Instance, solid: &StageMesh) -> Option<FacesDrawn> {
    // Part of a closed mesh is an open surface.
    let whole =
        instance.triangles.start == 0 && instance.triangles.end as usize >= solid.triangles.len();
    match instance.opacity {
        opacity if opacity >= 1.0 && solid.closed && whole => Some(FacesDrawn::Front),
        opacity if opacity > 0.0 => Some(FacesDrawn::Both),
        _ => None,
    }
}
