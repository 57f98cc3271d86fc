//! One tile of the picture: nearest facet of every sample, then light, then bytes.

use super::assembly::{Assembly, Bin};
use super::backdrop::Backdrop;
use super::lens::Lens;
use super::raster::{Window, rasterise};
use super::samples::{Pattern, SUBPIXELS};
use super::shading::{Batch, normal_at};
use super::translucent::Layers;
use crate::render::colour::Curve;
use crate::render::contact_shadow::ContactShadow;

/// Pixels along a tile's sides: with four samples its depths and facets take 32 KiB, what the first-level
/// cache holds.
pub(super) const TILE: usize = 32;
/// Pixels of a tile.
pub(super) const AREA: usize = TILE * TILE;
/// No facet: the backdrop is seen.
pub(super) const NOTHING: u32 = u32::MAX;

/// What is the same for all tiles of a frame.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) assembly: &'a Assembly,
    pub(super) lens: &'a Lens,
    pub(super) backdrop: &'a Backdrop,
    pub(super) shadow: Option<&'a ContactShadow>,
    pub(super) up: [f32; 3],
    /// Whether something may be below the ground.
    pub(super) below_ground: bool,
}

/// The samples of one tile, reused for all.
#[derive(Debug)]
pub(super) struct Tile<const S: usize> {
    pub(super) pattern: Pattern<S>,
    pub(super) depth: Vec<[f32; S]>,
    pub(super) facet: Vec<[u32; S]>,
    colour: Vec<[f32; 3]>,
    batch: Batch,
    layers: Layers<S>,
}

impl<const S: usize> Tile<S> {
    pub(super) fn new() -> Self {
        Self {
            pattern: Pattern::new(),
            depth: vec![[f32::NEG_INFINITY; S]; AREA],
            facet: vec![[NOTHING; S]; AREA],
            colour: vec![[0.0; 3]; AREA],
            batch: Batch::new(),
            layers: Layers::default(),
        }
    }

    /// Draws tile number `number`, of which `window` is in the picture. `rows` are the picture's bytes
    /// from the tile's first row on, `stride` bytes a row.
    pub(super) fn draw(
        &mut self,
        view: &View,
        number: usize,
        window: Window,
        bytes: &mut [u8],
        stride: usize,
    ) {
        let bin = &view.assembly.bins[number];
        let shadow = view
            .shadow
            .filter(|_| view.backdrop.shaded(number, view.shadow));
        let view = View { shadow, ..*view };
        if bin.opaque.is_empty() && bin.translucent.is_empty() {
            bare(&view, window, bytes, stride);
            return;
        }
        self.clear(&view, window);
        self.cover(&view, bin, window);
        if bin.translucent.is_empty() {
            self.light(&view, window);
        } else {
            self.layers.begin(&view, window, &self.facet);
            self.layers
                .blend(&view, bin, window, &self.pattern, &self.depth);
            self.layers.resolve(&mut self.colour);
        }
        self.write(&view, bin.translucent.is_empty(), window, bytes, stride);
    }

    fn clear(&mut self, view: &View, window: Window) {
        self.facet.fill([NOTHING; S]);
        self.depth.fill([f32::NEG_INFINITY; S]);
        if !view.below_ground {
            return;
        }
        for_pixels(window, |pixel, x, y| {
            let samples = self.depth[pixel].iter_mut().enumerate();
            for (s, depth) in samples {
                let place =
                    |p: i32, offset: i32| f64::from(p) + f64::from(offset) / f64::from(SUBPIXELS);
                let (x, y) = (place(x, self.pattern.x[s]), place(y, self.pattern.y[s]));
                *depth = view.backdrop.depth(x, y, view.lens.perspective);
            }
        });
    }

    /// Finds the nearest opaque facet of every sample; of equally near ones the first.
    fn cover(&mut self, view: &View, bin: &Bin, window: Window) {
        for number in &bin.opaque {
            let facet = &view.assembly.facets[*number as usize];
            let corners = facet.corners.map(|i| view.assembly.vertices[i as usize]);
            let (depth, nearest) = (&mut self.depth, &mut self.facet);
            rasterise(corners, window, &self.pattern, |x, y, covered, depths| {
                let pixel = (y - window.y[0]) as usize * TILE + (x - window.x[0]) as usize;
                let (depth, nearest) = (&mut depth[pixel], &mut nearest[pixel]);
                for s in 0..S {
                    let wins = covered[s] != 0 && depths[s] > depth[s];
                    depth[s] = if wins { depths[s] } else { depth[s] };
                    nearest[s] = if wins { *number } else { nearest[s] };
                }
            });
        }
    }

    /// Lights each facet once in each pixel where it is seen, weighted by its samples.
    fn light(&mut self, view: &View, window: Window) {
        let share = 1.0 / S as f32;
        for_pixels(window, |pixel, x, y| {
            let samples = &self.facet[pixel];
            self.colour[pixel] = [0.0; 3];
            let mut done = 0u32;
            for s in 0..S {
                if done >> s & 1 != 0 {
                    continue;
                }
                let number = samples[s];
                let mut count = 0;
                for t in s..S {
                    if samples[t] == number {
                        done |= 1 << t;
                        count += 1;
                    }
                }
                let weight = share * count as f32;
                if number == NOTHING {
                    if count < S {
                        let (rgb, _) = view.backdrop.linear(x as usize, y as usize, view.shadow);
                        for k in 0..3 {
                            self.colour[pixel][k] += rgb[k] * weight;
                        }
                    }
                    continue;
                }
                let facet = &view.assembly.facets[number as usize];
                let paint = &view.assembly.paints[facet.instance()];
                let normal = normal_at(view.assembly, facet, view.lens, x, y);
                let to_viewer = view.lens.to_viewer(x as f32 + 0.5, y as f32 + 0.5);
                self.batch.push(
                    normal,
                    to_viewer,
                    paint.albedo,
                    paint.flat,
                    weight,
                    pixel as u32,
                );
                if self.batch.is_full() {
                    self.batch.flush(view.up, &mut self.colour);
                }
            }
        });
        self.batch.flush(view.up, &mut self.colour);
    }

    fn write(&self, view: &View, skip_bare: bool, window: Window, bytes: &mut [u8], stride: usize) {
        let curve = Curve::shared();
        for_pixels(window, |pixel, x, y| {
            let at = (y - window.y[0]) as usize * stride + x as usize * 4;
            let Some(target) = bytes.get_mut(at..at + 4) else {
                return;
            };
            if skip_bare && self.facet[pixel] == [NOTHING; S] {
                bare_pixel(view, x as usize, y as usize, target);
                return;
            }
            let [r, g, b] = self.colour[pixel].map(|c| curve.encode(c));
            target.copy_from_slice(&[r, g, b, 255]);
        });
    }
}

/// Calls `visit` with the index in the tile, x and y of every pixel of the window, row by row.
#[inline(always)]
pub(super) fn for_pixels(window: Window, mut visit: impl FnMut(usize, i32, i32)) {
    for y in window.y[0]..=window.y[1] {
        let row = (y - window.y[0]) as usize * TILE;
        for x in window.x[0]..=window.x[1] {
            visit(row + (x - window.x[0]) as usize, x, y);
        }
    }
}

#[inline(always)]
fn bare_pixel(view: &View, x: usize, y: usize, target: &mut [u8]) {
    if view.shadow.is_some() {
        let (rgb, changed) = view.backdrop.linear(x, y, view.shadow);
        if changed {
            let [r, g, b] = rgb.map(|c| Curve::shared().encode(c));
            target.copy_from_slice(&[r, g, b, 255]);
            return;
        }
    }
    target.copy_from_slice(&view.backdrop.codes(x, y, 1)[0]);
}

/// A tile that no facet touches.
fn bare(view: &View, window: Window, bytes: &mut [u8], stride: usize) {
    for y in window.y[0]..=window.y[1] {
        let (first, count) = (
            window.x[0] as usize,
            (window.x[1] - window.x[0] + 1) as usize,
        );
        let start = (y - window.y[0]) as usize * stride + first * 4;
        let Some(row) = bytes.get_mut(start..start + count * 4) else {
            continue;
        };
        if view.shadow.is_some() {
            for (k, target) in row.chunks_exact_mut(4).enumerate() {
                bare_pixel(view, first + k, y as usize, target);
            }
        } else {
            row.copy_from_slice(view.backdrop.codes(first, y as usize, count).as_flattened());
        }
    }
}
