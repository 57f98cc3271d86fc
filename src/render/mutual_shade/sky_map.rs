//! The fraction of ambient light that reaches the visible surfaces: ambient occlusion from a small picture of
//! distances.
//!
//! Cells have two pixels or more. Every cell is compared with the same pattern of cells around it, so that there is no
//! noise to smooth; surfaces within reach that rise above its own hide part of the ambient light. Cells are smoothed
//! along rows and columns with cells of similar distance, and interpolated between four cells in the same way.

use super::caster::{Caster, row_value};
use super::rays::Rays;
use super::scan::scan_rows;
use crate::math::sin_cos;
use crate::render::look::{LEAST_DIVISOR, clamp_unit, dot_product, larger_of, smaller_of};

/// Rows of cells that a picture has at most, so that large pictures cost no more.
const MOST_ROWS: u32 = 540;
/// Least side of a cell in pixels.
const LEAST_CELL: u32 = 2;
/// Distance up to which bodies hide light, as a fraction of the extent of the motion.
const REACH: f64 = 0.07;
/// The same in cells, at most: beyond it the pattern would be too sparse.
const MOST_CELLS: f32 = 32.0;
/// Number of cells in the pattern.
const TAPS: usize = 12;
/// Sine of the elevation above a surface from which on light is hidden: facets rise by less.
const LEAST_SINE: f32 = 0.12;
/// What the whole pattern would hide if every cell rose vertically next to the surface.
const STRENGTH: f32 = 6.0;
/// Cells whose distances differ by this fraction of the reach do not influence each other.
const LIKENESS: f64 = 0.5;
/// Weight of cells without information, which count as open.
pub const UNKNOWN: f32 = 0.02;
/// Cells to either side that are smoothed together.
const SMOOTHED: usize = 2;
/// Distance where there is nothing.
const FAR: f32 = 1e30;
/// Nearness where there is nothing.
const NOWHERE: f32 = f32::MIN;

/// Distances and openness of the nearest surfaces.
#[derive(Clone, Debug)]
pub struct SkyMap {
    picture: [u32; 2],
    /// Width and height in cells.
    pub size: [usize; 2],
    /// Side of a cell in pixels.
    pub cell: f32,
    /// One over it.
    share: f32,
    /// Distance along the camera's axis and openness 0..=1 of each cell, row by row.
    pub cells: Vec<[f32; 2]>,
    /// One over the difference of distances at which cells no longer influence each other.
    pub likeness: f32,
    reach: f32,
    taps: [[f32; 2]; TAPS],
    nearness: Vec<f32>,
    /// The point that each cell shows, in camera space.
    places: Vec<[f32; 3]>,
    /// The facet in each cell.
    facet: Vec<u32>,
    smoothed: Vec<f32>,
    facets: Vec<[u32; 3]>,
    /// Corners of facets: their place in the grid with nearness, and their normals.
    corners: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    /// First and last column, then row, that are not empty.
    used: Option<[[usize; 2]; 2]>,
}

impl SkyMap {
    /// A map for pictures of `picture` pixels of a motion of this extent.
    pub(super) fn new(picture: [u32; 2], extent: f64) -> Self {
        let cell = picture[1].div_ceil(MOST_ROWS).max(LEAST_CELL);
        let size = picture.map(|n| n.div_ceil(cell) as usize);
        let area = size[0] * size[1];
        Self {
            picture,
            size,
            cell: cell as f32,
            share: 1.0 / cell as f32,
            cells: vec![[FAR, 1.0]; area],
            likeness: (1.0 / (LIKENESS * REACH * extent)) as f32,
            reach: (REACH * extent) as f32,
            taps: std::array::from_fn(disc_place),
            nearness: vec![NOWHERE; area],
            places: vec![[FAR; 3]; area],
            facet: vec![0; area],
            smoothed: vec![1.0; area],
            facets: Vec::new(),
            corners: Vec::new(),
            normals: Vec::new(),
            used: None,
        }
    }

    /// Size of the pictures.
    pub(super) fn picture(&self) -> [u32; 2] {
        self.picture
    }

    /// Empties the map.
    pub(super) fn clear(&mut self) {
        self.nearness.fill(NOWHERE);
        self.places.fill([FAR; 3]);
        self.cells.fill([FAR, 1.0]);
        self.facets.clear();
        self.corners.clear();
        self.normals.clear();
        self.used = None;
    }

    /// Adds a body.
    pub(super) fn add(&mut self, caster: &Caster, rays: &Rays) {
        let base = self.corners.len() as u32;
        let share = self.share;
        let place = |p: &[f32; 3]| {
            let [x, y, nearness] = rays.project(caster.rows.map(|row| row_value(&row, *p)));
            [x * share, y * share, nearness]
        };
        self.corners.extend(caster.mesh.positions.iter().map(place));
        let turned = |n: &[f32; 3]| caster.rows.map(|[x, y, z, _]| dot_product([x, y, z], *n));
        self.normals.extend(caster.mesh.normals.iter().map(turned));
        for triangle in caster.triangles {
            let corners = triangle.map(|i| i + base);
            let [a, b, c] = corners.map(|i| self.corners[i as usize]);
            // Rows go down: what faces the viewer turns the other way round.
            let turn = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
            if caster.closed && turn >= 0.0 {
                continue;
            }
            let number = self.facets.len() as u32;
            let [width, _] = self.size;
            let mut used = false;
            scan_rows([a, b, c], self.size, |run| {
                let mut nearness = run.start;
                for k in run.first..run.first + run.count {
                    if nearness > self.nearness[k] {
                        self.nearness[k] = nearness;
                        self.facet[k] = number;
                        used = true;
                    }
                    nearness += run.step;
                }
                let (row, first) = (run.first / width, run.first % width);
                let [columns, rows] = self.used.unwrap_or([[first, first], [row, row]]);
                let last = first + run.count - 1;
                self.used = Some([
                    [columns[0].min(first), columns[1].max(last)],
                    [rows[0].min(row), rows[1].max(row)],
                ]);
            });
            if used {
                self.facets.push(corners);
            }
        }
    }

    /// From nearness to openness.
    pub(super) fn finish(&mut self, rays: &Rays) {
        let Some(used) = self.used else { return };
        // Distance and place of every cell that shows something.
        self.for_used(used, |map, k, at| {
            if map.nearness[k] > NOWHERE {
                let distance = rays.distance(map.nearness[k]);
                let pixel = at.map(|c| (c as f32 + 0.5) * map.cell);
                map.cells[k][0] = distance;
                map.places[k] = rays.place(pixel, distance);
            }
        });
        // How open its surroundings are, then the mean along rows and columns.
        self.for_used(used, |map, k, at| {
            if map.nearness[k] > NOWHERE {
                map.smoothed[k] = map.cell_openness(rays, k, at);
            }
        });
        let [width, _] = self.size;
        let [columns, rows] = used;
        self.for_used(used, |map, k, [x, _]| {
            let along = [x - columns[0], columns[1] - x];
            map.cells[k][1] = map.mean(k, 1, along, |map, k| map.smoothed[k]);
        });
        self.for_used(used, |map, k, [_, y]| {
            let along = [y - rows[0], rows[1] - y];
            map.smoothed[k] = map.mean(k, width, along, |map, k| map.cells[k][1]);
        });
        self.for_used(used, |map, k, _| map.cells[k][1] = map.smoothed[k]);
    }

    /// Calls `visit` with index, column and row of every cell in the used rectangle.
    #[inline(always)]
    fn for_used(
        &mut self,
        [columns, rows]: [[usize; 2]; 2],
        mut visit: impl FnMut(&mut Self, usize, [usize; 2]),
    ) {
        for row in rows[0]..=rows[1] {
            for column in columns[0]..=columns[1] {
                visit(self, row * self.size[0] + column, [column, row]);
            }
        }
    }

    /// The unit normal in the middle of a cell, on the side that is seen.
    #[inline(always)]
    fn normal(&self, rays: &Rays, cell: usize, [x, y]: [f32; 2]) -> [f32; 3] {
        let corners = self.facets[self.facet[cell] as usize].map(|i| i as usize);
        let [a, b, c] = corners.map(|i| self.corners[i]);
        let edge =
            |p: [f32; 3], q: [f32; 3]| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
        let weights = [
            edge(b, c) * rays.weight(a[2]),
            edge(c, a) * rays.weight(b[2]),
            edge(a, b) * rays.weight(c[2]),
        ];
        let [p, q, r] = corners.map(|i| self.normals[i]);
        let sum = [0, 1, 2].map(|k| weights[0] * p[k] + weights[1] * q[k] + weights[2] * r[k]);
        let length = larger_of(dot_product(sum, sum), LEAST_DIVISOR).sqrt();
        // The weights of a front add up to less than nothing, and those of a back, whose normals point away, to more.
        sum.map(|n| -n / length)
    }

    /// How open a cell's surface is.
    #[inline(always)]
    fn cell_openness(&self, rays: &Rays, cell: usize, at: [usize; 2]) -> f32 {
        let middle = at.map(|c| c as f32 + 0.5);
        let distance = self.cells[cell][0];
        let place = self.places[cell];
        let normal = self.normal(rays, cell, middle);
        let around = smaller_of(self.reach * rays.pixels(distance) / self.cell, MOST_CELLS);
        let [width, height] = self.size.map(|n| n as i32);
        let farthest = self.reach * self.reach;
        let mut hidden = 0.0;
        for tap in &self.taps {
            let x = (middle[0] + tap[0] * around) as i32;
            let y = (middle[1] + tap[1] * around) as i32;
            if x < 0 || y < 0 || x >= width || y >= height {
                continue;
            }
            let other = self.places[(y * width + x) as usize];
            let way = [0, 1, 2].map(|k| other[k] - place[k]);
            let (squared, above) = (dot_product(way, way), dot_product(way, normal));
            // Most of the surroundings lie below.
            let is_low = above <= 0.0 || above * above <= LEAST_SINE * LEAST_SINE * squared;
            if !is_low && squared < farthest {
                let near = 1.0 - squared / farthest;
                hidden += (above / squared.sqrt() - LEAST_SINE) * near;
            }
        }
        clamp_unit(1.0 - hidden * (STRENGTH / TAPS as f32))
    }

    /// The mean over cells of like distance, `step` apart, of which there are so many before and after.
    #[inline(always)]
    fn mean(
        &self,
        cell: usize,
        step: usize,
        [before, after]: [usize; 2],
        value: impl Fn(&Self, usize) -> f32,
    ) -> f32 {
        let distance = self.cells[cell][0];
        if distance >= FAR {
            return 1.0;
        }
        let first = cell - before.min(SMOOTHED) * step;
        let last = cell + after.min(SMOOTHED) * step;
        // Nothing to be smoothed.
        if (first..=last)
            .step_by(step)
            .all(|other| value(self, other) == 1.0)
        {
            return 1.0;
        }
        let (mut sum, mut weights) = (0.0, 0.0);
        for other in (first..=last).step_by(step) {
            let weight = self.likeness(self.cells[other][0], distance);
            sum += weight * value(self, other);
            weights += weight;
        }
        sum / weights
    }

    /// The mutual influence of two distances, from 1 to 0.
    #[inline(always)]
    fn likeness(&self, one: f32, other: f32) -> f32 {
        larger_of(1.0 - (one - other).abs() * self.likeness, 0.0)
    }

    /// How open the surface is that pixel coordinates show at a distance.
    #[inline(always)]
    pub fn open(&self, at: [f32; 2], distance: f32) -> f32 {
        // The two cells around the place along an axis, and how far it is from the first to the second.
        let place = |k: usize| {
            let last = self.size[k] - 1;
            let cell = larger_of(at[k] * self.share - 0.5, 0.0);
            let clamped = smaller_of(cell, last as f32);
            let first = clamped as usize;
            (first, (first + 1).min(last), clamped - first as f32)
        };
        let ((left, right, x), (top, bottom, y)) = (place(0), place(1));
        let [upper, lower] = [top, bottom].map(|row| row * self.size[0]);
        let around = [upper + left, upper + right, lower + left, lower + right];
        let cells = around.map(|cell| self.cells.get(cell).copied().unwrap_or([FAR, 1.0]));
        // In most places nothing hides any light.
        if cells.iter().all(|[_, open]| *open == 1.0) {
            return 1.0;
        }
        // Bilinear weights, less where the cell shows a surface at another distance.
        let across = [1.0 - x, x, 1.0 - x, x];
        let down = [1.0 - y, 1.0 - y, y, y];
        // A small weight of an open cell decides where all four are unlike.
        let (mut sum, mut weights) = (UNKNOWN, UNKNOWN);
        for (k, [there, open]) in cells.into_iter().enumerate() {
            let weight = across[k] * down[k] * self.likeness(there, distance);
            sum += weight * open;
            weights += weight;
        }
        sum / weights
    }
}

/// Place number `k` of a disc of radius 1, all of which fill it evenly.
fn disc_place(k: usize) -> [f32; 2] {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let out = ((k as f64 + 0.5) / TAPS as f64).sqrt();
    let (sin, cos) = sin_cos(golden * k as f64);
    [(out * cos) as f32, (out * sin) as f32]
}
