//! The soft shadow of bodies on the ground, as a small texture for both renderers.
//!
//! It is computed on the CPU once per frame from the instances that cast shadows: the darkening below a body, which is
//! softer the higher the body is, and the oblique shadow of the key light.

use super::ground::ground_axes;
use super::look::{KEY_DIRECTION, larger_of, smaller_of};
use super::{Camera, Frame, Ground, Instance, MeshList, Stage, StageMesh};
use crate::math::{Pose, narrow_pose};
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// Texels along each side of the map. A texel is 1/64 of the ground's radius, and the blur hides this.
pub const SHADOW_SIZE: u32 = 128;
/// Height above which a body causes no darkening, in radii: for the narrow shadow close to a contact, and for the wide
/// one.
const REACH: [f32; 2] = [0.12, 0.60];
/// Darkness right at the ground.
const DEPTH: [f32; 2] = [0.70, 0.50];
/// Darkness of a translucent body's shadow relative to that of an opaque one.
const PALE: f32 = 0.45;
/// Half width of the averaging window in texels; it is applied twice along each axis.
const BLUR: [usize; 2] = [1, 4];
/// The same for the shadow of the key light: maximum height, darkness and averaging.
const KEY_REACH: f32 = 1.6;
const KEY_DEPTH: f32 = 0.30;
const KEY_BLUR: usize = 1;
/// Sine of the key light's elevation below which its shadow would not end on the map and is omitted.
const LEAST_HEIGHT: f64 = 0.3;
/// The largest half width of all averaging windows.
const MOST_BLUR: usize = 4;

/// Darkness over the square that circumscribes the ground's disc.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactShadow {
    /// Texels along each side.
    pub size: u32,
    /// `size * size` darknesses, 0 none to 255 full; row-major, first axis of the ground along a row.
    pub texels: Vec<u8>,
    /// First and last texel column, then row, that are not all zero, so that the rest can be skipped.
    pub dark: Option<[[u32; 2]; 2]>,
}

/// A position on the map, computed once and used in many frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TexelPlace {
    /// Index of the nearest texel to the upper left.
    index: u16,
    /// Shares of the next column and the next row in 256ths.
    share: [u8; 2],
}

impl TexelPlace {
    /// The position of a point of the ground in a map of [`SHADOW_SIZE`]; coordinates as for [`ContactShadow::sample`].
    pub fn new(u: f32, v: f32) -> Self {
        let fixed = |c: f32| {
            let texel = (0.5 + 0.5 * c) * SHADOW_SIZE as f32 - 0.5;
            let last = (SHADOW_SIZE - 1) * 256 - 1;
            ((larger_of(texel, 0.0) * 256.0) as u32).min(last)
        };
        let (x, y) = (fixed(u), fixed(v));
        Self {
            index: ((y >> 8) * SHADOW_SIZE + (x >> 8)) as u16,
            share: [x as u8, y as u8],
        }
    }

    /// Column and row of its texel to the upper left.
    pub fn corner(&self) -> [usize; 2] {
        let index = usize::from(self.index);
        [index % SHADOW_SIZE as usize, index / SHADOW_SIZE as usize]
    }
}

impl ContactShadow {
    /// Darkness 0..=1 at a place; the same as [`sample`](Self::sample) to a 256th of a texel.
    #[inline(always)]
    pub fn at(&self, place: TexelPlace) -> f32 {
        const WIDTH: usize = SHADOW_SIZE as usize;
        let index = place.index as usize;
        let Some(texels) = self.texels.get(index..index + WIDTH + 2) else {
            return 0.0;
        };
        let [a, b, c, d] = [texels[0], texels[1], texels[WIDTH], texels[WIDTH + 1]].map(u32::from);
        if a | b | c | d == 0 {
            return 0.0;
        }
        let [x, y] = place.share.map(u32::from);
        let (top, bottom) = (a * (256 - x) + b * x, c * (256 - x) + d * x);
        (top * (256 - y) + bottom * y) as f32 * (1.0 / (65_536.0 * 255.0))
    }

    /// Darkness 0..=1 at a point of the ground, bilinear between texel centres.
    ///
    /// `u` and `v` are the coordinates along the ground's two axes divided by its radius, -1..=1. A GPU
    /// gets the same with a linear, edge-clamped sampler at `0.5 + 0.5 * (u, v)`.
    #[inline]
    pub fn sample(&self, u: f32, v: f32) -> f32 {
        let size = self.size as usize;
        let last = self.size as f32 - 1.0;
        let place = |c: f32| {
            smaller_of(
                larger_of((0.5 + 0.5 * c) * self.size as f32 - 0.5, 0.0),
                last,
            )
        };
        let (x, y) = (place(u), place(v));
        let (column, row) = (x as usize, y as usize);
        let (fx, fy) = (x - column as f32, y - row as f32);
        let next = (column + 1).min(size - 1);
        let below = (row + 1).min(size - 1);
        let at = |c: usize, r: usize| f32::from(self.texels[r * size + c]);
        let top = at(column, row) + (at(next, row) - at(column, row)) * fx;
        let bottom = at(column, below) + (at(next, below) - at(column, below)) * fx;
        (top + (bottom - top) * fy) / 255.0
    }

    /// Least and greatest coordinates (as of [`sample`](Self::sample)) between which darkness is not zero.
    pub fn reach(&self) -> Option<[[f32; 2]; 2]> {
        let dark = self.dark?;
        // The bilinear lookup spreads a texel to the centres of its neighbours.
        let edge =
            |texel: u32, spread: f32| (texel as f32 + 0.5 + spread) / self.size as f32 * 2.0 - 1.0;
        let [x, y] = dark;
        Some([
            [edge(x[0], -1.0), edge(y[0], -1.0)],
            [edge(x[1], 1.0), edge(y[1], 1.0)],
        ])
    }
}

/// Makes the contact shadows of a stage's frames. Keeps its memory between frames.
#[derive(Clone, Debug)]
pub struct ShadowCaster {
    ground: Ground,
    axes: DMat3,
    meshes: Arc<[StageMesh]>,
    /// Triangles of each mesh with an edge longer than a texel, which are rasterised; of the others only the corners
    /// count.
    coarse: Arc<[Vec<u32>]>,
    /// Size of a texel.
    texel: f32,
    /// Smallest height over each texel in radii, for opaque and for translucent bodies; infinite if nothing is above.
    heights: [Vec<f32>; 2],
    /// The same for their shadows in the direction of the key light.
    thrown: [Vec<f32>; 2],
    layers: [Vec<f32>; 3],
    scratch: Vec<f32>,
    shadow: ContactShadow,
}

impl ShadowCaster {
    /// A caster for a stage; `None` without a ground.
    pub fn new(stage: &Stage) -> Option<Self> {
        let ground = stage
            .ground
            .filter(|g| g.radius > 0.0 && g.centre.is_finite())?;
        let texel = (2.0 * ground.radius / f64::from(SHADOW_SIZE)) as f32;
        let area = (SHADOW_SIZE * SHADOW_SIZE) as usize;
        let coarse = stage.meshes.iter();
        let coarse = coarse.map(|mesh| coarse_triangles(mesh, texel));
        Some(Self {
            ground,
            axes: ground_axes(&ground),
            coarse: coarse.collect(),
            meshes: Arc::clone(&stage.meshes),
            texel,
            heights: [vec![f32::INFINITY; area], vec![f32::INFINITY; area]],
            thrown: [vec![f32::INFINITY; area], vec![f32::INFINITY; area]],
            layers: [vec![0.0; area], vec![0.0; area], vec![0.0; area]],
            scratch: vec![0.0; area],
            shadow: ContactShadow {
                size: SHADOW_SIZE,
                texels: vec![0; area],
                dark: None,
            },
        })
    }

    /// The shadow of a frame's casting instances; `camera` determines the direction of the key light.
    pub fn cast(&mut self, frame: &Frame, camera: &Camera) -> &ContactShadow {
        // In the frame of the ground height is z.
        let ground_from_world = Pose {
            rotation: self.axes,
            translation: self.ground.centre,
        }
        .inverse();
        let slant = self.shadow_slant(camera);
        let coarse = self.coarse_of_frame(frame);
        let meshes = MeshList::new(&self.meshes, &frame.meshes);
        let maps = self.heights.iter_mut().zip(&mut self.thrown);
        // Opaque and translucent bodies have maps of their own: their shadows differ in darkness.
        for ((below, thrown), translucent) in maps.zip([false, true]) {
            below.fill(f32::INFINITY);
            thrown.fill(f32::INFINITY);
            let mut below = HeightMap {
                heights: below,
                slant: [0.0; 2],
            };
            let mut thrown = slant.map(|slant| HeightMap {
                heights: thrown,
                slant,
            });
            let casts = |i: &&Instance| i.casts_shadow && (i.opacity < 1.0) == translucent;
            for instance in frame.instances.iter().filter(casts) {
                let of_frame = instance.mesh.checked_sub(self.coarse.len());
                let coarse = match of_frame {
                    Some(own) => coarse.get(own),
                    None => self.coarse.get(instance.mesh),
                };
                if let Some((mesh, coarse)) = meshes.get(instance.mesh).zip(coarse) {
                    let pose = ground_from_world * instance.world_from_positions(mesh.origin);
                    // The least height over every texel: straight below, and along the key light if that is steep
                    // enough.
                    let maps = std::iter::once(&mut below).chain(thrown.as_mut());
                    for map in maps {
                        let caster = CastMesh { mesh, coarse };
                        caster.drop_on(map, instance, &pose, self.ground.radius);
                    }
                }
            }
        }
        self.blur_darkness();
        &self.shadow
    }

    /// The coarse triangles of the frame's own meshes that cast shadows.
    fn coarse_of_frame(&self, frame: &Frame) -> Vec<Vec<u32>> {
        let mut coarse = vec![Vec::new(); frame.meshes.len()];
        for instance in frame.instances.iter().filter(|i| i.casts_shadow) {
            let own = instance.mesh.checked_sub(self.coarse.len());
            if let Some(own) = own.filter(|own| *own < coarse.len()) {
                coarse[own] = coarse_triangles(&frame.meshes[own], self.texel);
            }
        }
        coarse
    }

    /// The horizontal displacement of a point's shadow per unit of its height, along the ground's axes; `None` if the
    /// light is too low.
    fn shadow_slant(&self, camera: &Camera) -> Option<[f32; 2]> {
        let light = DVec3::from(KEY_DIRECTION.map(f64::from));
        let light = self.axes.transpose() * (camera.world_from_camera.rotation * light);
        let away = [-light.x / light.z, -light.y / light.z];
        (light.z > LEAST_HEIGHT).then(|| away.map(|a| a as f32))
    }

    /// From heights to blurred darkness.
    fn blur_darkness(&mut self) {
        let size = SHADOW_SIZE as usize;
        let [contacts @ .., key] = &mut self.layers;
        let [opaque, translucent] = &self.thrown;
        for ((dark, height), pale) in key.iter_mut().zip(opaque).zip(translucent) {
            let [near, pale] = [height, pale].map(|h| larger_of(1.0 - h / KEY_REACH, 0.0));
            *dark = KEY_DEPTH * larger_of(near, PALE * pale);
        }
        for _ in 0..2 {
            blur_rows(key, &mut self.scratch, KEY_BLUR);
            blur_columns(&self.scratch, key, KEY_BLUR);
        }
        for (k, layer) in contacts.iter_mut().enumerate() {
            let [opaque, translucent] = &self.heights;
            for ((dark, height), pale) in layer.iter_mut().zip(opaque).zip(translucent) {
                let [near, pale] =
                    [height, pale].map(|height| larger_of(1.0 - height / REACH[k], 0.0));
                *dark = DEPTH[k] * larger_of(near * near, PALE * pale * pale);
            }
            for _ in 0..2 {
                blur_rows(layer, &mut self.scratch, BLUR[k]);
                blur_columns(&self.scratch, layer, BLUR[k]);
            }
        }
        let [near, wide, key] = &self.layers;
        let layers = near.iter().zip(wide).zip(key);
        for (texel, ((near, wide), key)) in self.shadow.texels.iter_mut().zip(layers) {
            let light = (1.0 - near) * (1.0 - wide) * (1.0 - key);
            // Adding 2^23 rounds to the nearest integer in the low bits.
            *texel = ((1.0 - light) * 255.0 + 8_388_608.0).to_bits() as u8;
        }
        let mut dark: Option<[[u32; 2]; 2]> = None;
        for (y, row) in (0..).zip(self.shadow.texels.chunks_exact(size)) {
            let first = row.iter().position(|t| *t > 0);
            let last = row.iter().rposition(|t| *t > 0);
            if let (Some(first), Some(last)) = (first, last) {
                let [columns, rows] = dark.unwrap_or([[first as u32, last as u32], [y, y]]);
                dark = Some([
                    [columns[0].min(first as u32), columns[1].max(last as u32)],
                    [rows[0], y],
                ]);
            }
        }
        self.shadow.dark = dark;
    }
}

/// The triangles of a mesh with an edge longer than a texel.
fn coarse_triangles(mesh: &StageMesh, texel: f32) -> Vec<u32> {
    let is_coarse = |k: &u32| is_coarse(&mesh.positions, mesh.triangles[*k as usize], texel);
    (0..mesh.triangles.len() as u32).filter(is_coarse).collect()
}

fn is_coarse(corners: &[[f32; 3]], triangle: [u32; 3], texel: f32) -> bool {
    let [a, b, c] = triangle.map(|i| corners[i as usize]);
    let longer = |p: [f32; 3], q: [f32; 3]| {
        let d = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > texel * texel
    };
    longer(a, b) || longer(b, c) || longer(c, a)
}

/// A mesh seen from the ground.
struct CastMesh<'a> {
    mesh: &'a StageMesh,
    coarse: &'a [u32],
}

impl CastMesh<'_> {
    fn drop_on(&self, map: &mut HeightMap, instance: &Instance, pose: &Pose, radius: f64) {
        let [x, y, z] = narrow_pose(pose);
        let radius = radius as f32;
        let half = 0.5 * SHADOW_SIZE as f32;
        let row = |r: [f32; 4], p: [f32; 3]| r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3];
        let [right, ahead] = map.slant;
        // Texel coordinates and height in radii.
        let place = |p: [f32; 3]| {
            let height = row(z, p);
            [
                (row(x, p) + right * height) / radius * half + half,
                (row(y, p) + ahead * height) / radius * half + half,
                height / radius,
            ]
        };
        let count = self.mesh.triangles.len() as u32;
        let (start, end) = (
            instance.triangles.start.min(count),
            instance.triangles.end.min(count),
        );
        if start == 0 && end == count {
            self.mesh.positions.iter().for_each(|p| map.dot(place(*p)));
        } else if start < end {
            for triangle in &self.mesh.triangles[start as usize..end as usize] {
                triangle
                    .iter()
                    .for_each(|i| map.dot(place(self.mesh.positions[*i as usize])));
            }
        }
        for k in self.coarse.iter().filter(|k| (start..end).contains(k)) {
            map.draw_triangle(
                self.mesh.triangles[*k as usize].map(|i| place(self.mesh.positions[i as usize])),
            );
        }
    }
}

struct HeightMap<'a> {
    heights: &'a mut [f32],
    /// How far a point is shifted for each unit of its height.
    slant: [f32; 2],
}

impl HeightMap<'_> {
    /// Lowers the texel under a point.
    #[inline(always)]
    fn dot(&mut self, [x, y, height]: [f32; 3]) {
        let size = SHADOW_SIZE as f32;
        if x >= 0.0 && x < size && y >= 0.0 && y < size {
            let texel = &mut self.heights[y as usize * SHADOW_SIZE as usize + x as usize];
            *texel = smaller_of(larger_of(height, 0.0), *texel);
        }
    }

    /// Lowers the texels whose centres are under a triangle.
    fn draw_triangle(&mut self, [a, b, c]: [[f32; 3]; 3]) {
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        // Triangles perpendicular to the ground have no area seen from above; their corners and neighbours suffice.
        if !(area.abs() > 1e-6 && area.abs() < 1e12) {
            return;
        }
        let last = SHADOW_SIZE as f32 - 1.0;
        let range = |k: usize| {
            let low = smaller_of(smaller_of(a[k], b[k]), c[k]);
            let high = larger_of(larger_of(a[k], b[k]), c[k]);
            let first = larger_of((low - 0.5).ceil(), 0.0);
            (first, smaller_of((high - 0.5).floor(), last))
        };
        let ((x0, x1), (y0, y1)) = (range(0), range(1));
        if !(x0 <= x1 && y0 <= y1) {
            return;
        }
        for row in y0 as usize..=y1 as usize {
            for column in x0 as usize..=x1 as usize {
                let (x, y) = (column as f32 + 0.5, row as f32 + 0.5);
                let v = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area;
                let w = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area;
                if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
                    self.dot([x, y, a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2])]);
                }
            }
        }
    }
}

/// Mean over `2 half + 1` texels along each row; zero beyond the map.
fn blur_rows(from: &[f32], to: &mut [f32], half: usize) {
    const WIDTH: usize = SHADOW_SIZE as usize;
    let share = 1.0 / (2 * half + 1) as f32;
    let mut padded = [0.0; WIDTH + 2 * MOST_BLUR];
    for (source, target) in from
        .as_chunks::<WIDTH>()
        .0
        .iter()
        .zip(to.as_chunks_mut::<WIDTH>().0)
    {
        padded[half..half + WIDTH].copy_from_slice(source);
        padded[half + WIDTH..].fill(0.0);
        target.fill(0.0);
        for shift in 0..=2 * half {
            for (texel, value) in target.iter_mut().zip(&padded[shift..]) {
                *texel += value * share;
            }
        }
    }
}

/// The same along each column.
fn blur_columns(from: &[f32], to: &mut [f32], half: usize) {
    const WIDTH: usize = SHADOW_SIZE as usize;
    let share = 1.0 / (2 * half + 1) as f32;
    let rows = from.as_chunks::<WIDTH>().0;
    for (k, target) in to.as_chunks_mut::<WIDTH>().0.iter_mut().enumerate() {
        target.fill(0.0);
        for source in &rows[k.saturating_sub(half)..(k + half + 1).min(WIDTH)] {
            for (texel, value) in target.iter_mut().zip(source) {
                *texel += value * share;
            }
        }
    }
}

#[cfg(test)]
mod tests;
