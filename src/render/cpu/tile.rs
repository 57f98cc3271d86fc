//! One tile of the picture: nearest facet of every sample, then light, then bytes.

use super::assembly::{TileBin, TriangleAssembly};
use super::cell::{NOTHING, PixelCell, facets_of};
use super::mask::{PixelMask, TilePart};
use super::outlines::OutlineFinder;
use super::rasterise::rasterise_block;
use super::samples::{LANES, SUBPIXELS, SamplePattern};
use super::shading::{Receive, ShadingBatch};
use super::translucent::Layers;
use super::view::RasterView;
use super::window::{AREA, TILE, Window};
use crate::render::Stage;
use crate::render::colour::ToneCurve;
use wide::{f32x4, i32x4};

/// Marks a pixel without any facet.
const BARE: [f32; 3] = [-1.0; 3];
/// Most samples of a pixel.
const MOST_SAMPLES: usize = 16;

/// The samples of one tile, reused for all, row by row.
#[derive(Clone, Debug)]
pub(super) struct TileSamples<const G: usize> {
    pub(super) pattern: SamplePattern<G>,
    cells: Vec<PixelCell<G>>,
    /// Linear colours of the pixels.
    colour: Vec<[f32; 3]>,
    batch: ShadingBatch,
    layers: Layers<G>,
    outlines: Option<OutlineFinder>,
    /// Of the pixels drawn last those that show something of the backdrop, and those that show nothing else.
    pub(super) seen_backdrop: PixelMask,
    pub(super) bare: PixelMask,
}

/// Facets seen in a pixel, with the number of samples of each.
struct SeenFacets {
    facets: [(i32, u32); MOST_SAMPLES],
    count: usize,
}

impl SeenFacets {
    #[inline(always)]
    fn of(samples: &[i32]) -> Self {
        let mut seen = Self {
            facets: [(NOTHING, 0); MOST_SAMPLES],
            count: 0,
        };
        for facet in samples {
            let known = seen.facets[..seen.count]
                .iter_mut()
                .find(|(f, _)| f == facet);
            match known {
                Some((_, count)) => *count += 1,
                None => {
                    seen.facets[seen.count % MOST_SAMPLES] = (*facet, 1);
                    seen.count += 1;
                }
            }
        }
        seen
    }

    /// Merges facets of one smooth surface into the one with most samples: their light differs only by the curvature
    /// within a pixel.
    #[inline(always)]
    fn merge(&mut self, assembly: &TriangleAssembly) {
        let mut i = 0;
        while i + 1 < self.count {
            let (first, mut sum) = self.facets[i];
            let mut most = self.facets[i];
            let mut j = i + 1;
            while j < self.count {
                let other = self.facets[j];
                // Facets of one smooth surface are shaded as one, at the facet with most samples.
                if first != NOTHING && other.0 != NOTHING && assembly.is_smooth(first, other.0) {
                    sum += other.1;
                    if other.1 > most.1 {
                        most = other;
                    }
                    self.count -= 1;
                    self.facets[j] = self.facets[self.count];
                } else {
                    j += 1;
                }
            }
            self.facets[i] = (most.0, sum);
            i += 1;
        }
    }
}

/// Whether all samples of a pixel show the first facet or one that is smoothly connected to it.
#[inline(always)]
fn one_surface<const S: usize>(assembly: &TriangleAssembly, samples: &[i32; S]) -> bool {
    let first = samples[0];
    samples[1..].iter().all(|facet| {
        *facet == first
            || (first != NOTHING && *facet != NOTHING && assembly.is_smooth(first, *facet))
    })
}

impl<const G: usize> TileSamples<G> {
    pub(super) fn new(stage: &Stage) -> Self {
        let pattern = SamplePattern::new(stage.samples);
        let cells = AREA >> pattern.cell_bits;
        Self {
            outlines: OutlineFinder::new(stage, &pattern),
            pattern,
            cells: vec![PixelCell::BARE; cells],
            colour: vec![[0.0; 3]; AREA],
            batch: ShadingBatch::new(),
            layers: Layers::default(),
            seen_backdrop: PixelMask::NONE,
            bare: PixelMask::NONE,
        }
    }

    /// Draws a part of tile number `number`. `bytes` are the picture's from its row `first` on, `stride` bytes a row.
    pub(super) fn draw(
        &mut self,
        view: &RasterView,
        number: usize,
        part: &TilePart,
        (bytes, first, stride): (&mut [u8], i32, usize),
    ) {
        let bin = &view.assembly.bins[number];
        self.seen_backdrop = part.pixels;
        self.bare = part.pixels;
        // A tile without triangles is background.
        if bin.is_empty() {
            fill_background(view, part, (bytes, first, stride));
            return;
        }
        // What the lines of these pixels depend on.
        let needed = part.pixels.grown(view.assembly.apron);
        // Depth and facet of every sample, then lines, then translucent layers over them.
        self.clear(view, part.window, &needed);
        self.cover_bin(view, bin, part.window, &needed);
        if let Some(outlines) = &mut self.outlines {
            outlines.read(view.assembly, &self.cells, &needed);
            outlines.find(view.lens, part, false);
        }
        let translucent = !bin.translucent.is_empty();
        if translucent {
            let cells = &self.cells;
            self.layers
                .collect(view, bin, (part.window, &needed), &self.pattern, cells);
        }
        // Colours: opaque surfaces, lines, layers, and the encoded bytes.
        self.light(view, part, translucent);
        self.ink(view, part);
        if translucent {
            self.blend_layers(view, part);
        }
        self.write(view, part, (bytes, first, stride));
    }

    fn ink(&mut self, view: &RasterView, part: &TilePart) {
        if let Some(outlines) = &self.outlines {
            outlines.ink(view, part, (&mut self.colour, BARE));
        }
    }

    /// Blends the translucent layers over the opaque samples, and finds the lines of the nearest surfaces of both.
    fn blend_layers(&mut self, view: &RasterView, part: &TilePart) {
        self.lay_under(view.assembly, part);
        let lines = self.outlines.as_ref();
        let inked =
            |pixel: usize, rgb: [f32; 3]| lines.map_or(rgb, |lines| lines.with_ink(pixel, rgb));
        self.layers
            .blend(view, part, inked, &mut self.batch, &mut self.colour);
        if let Some(outlines) = &mut self.outlines {
            outlines.read_over(view.assembly, &self.layers);
            outlines.find(view.lens, part, true);
        }
        self.ink(view, part);
    }

    fn clear(&mut self, view: &RasterView, window: Window, needed: &PixelMask) {
        let [first, end] = needed
            .rows()
            .map(|row| (row * TILE) >> self.pattern.cell_bits);
        self.cells[first..end].fill(PixelCell::BARE);
        if !view.below_ground {
            return;
        }
        let Some(ground) = &view.backdrop.view else {
            return;
        };
        let samples = self.pattern.samples;
        let places = |places: &[[i32; LANES]; G]| {
            let mut offsets = [0.0; MOST_SAMPLES];
            for (offset, place) in offsets.iter_mut().zip(places.as_flattened()) {
                *offset = f64::from(*place) / f64::from(SUBPIXELS);
            }
            offsets
        };
        let offsets = [places(&self.pattern.x), places(&self.pattern.y)];
        // The ground hides what is below it: its depth is the first in every sample.
        let [right, down, start] = ground.nearness(view.lens.perspective);
        let part = TilePart {
            window,
            pixels: *needed,
        };
        part.for_each(|pixel, x, y| {
            let (x, y) = (f64::from(x), f64::from(y));
            if !ground.is_seen(x + 0.5, y + 0.5) {
                return;
            }
            let lane = pixel * samples;
            let cell = &mut self.cells[lane / (LANES * G)];
            let own = &mut cell.depth.as_flattened_mut()[lane % (LANES * G)..][..samples];
            for ((depth, along), below) in own.iter_mut().zip(offsets[0]).zip(offsets[1]) {
                *depth = (right * (x + along) + down * (y + below) + start) as f32;
            }
        });
    }

    fn lay_under(&mut self, assembly: &TriangleAssembly, part: &TilePart) {
        let (layers, cells) = (&mut self.layers, self.cells.as_slice());
        match (G, self.pattern.samples) {
            (1, 1) => layers.lay_under(assembly, part, |pixel| facets_of::<1, G>(cells, pixel)),
            (1, 2) => layers.lay_under(assembly, part, |pixel| facets_of::<2, G>(cells, pixel)),
            (1, _) => layers.lay_under(assembly, part, |pixel| facets_of::<4, G>(cells, pixel)),
            (2, _) => layers.lay_under(assembly, part, |pixel| facets_of::<8, G>(cells, pixel)),
            _ => layers.lay_under(assembly, part, |pixel| facets_of::<16, G>(cells, pixel)),
        }
    }

    /// Finds the nearest opaque facet of every sample of the pixels that are needed; of equally near ones the first.
    #[inline(never)]
    fn cover_bin(&mut self, view: &RasterView, bin: &TileBin, window: Window, needed: &PixelMask) {
        for number in &bin.opaque {
            let facet = &view.assembly.facets[*number as usize];
            if !needed.meets(window.corner(), &facet.pixels()) {
                continue;
            }
            let own = i32x4::splat(*number as i32);
            let cells = self.cells.as_mut_slice();
            rasterise_block(
                view.assembly,
                facet,
                (&window, needed),
                &self.pattern,
                |cell, g, covered, new| {
                    let cell = &mut cells[cell];
                    let old = f32x4::from(cell.depth[g]);
                    // Depth test: nearness grows towards the viewer, and the earlier instance wins a tie.
                    let wins = new.simd_gt(old) & covered;
                    cell.depth[g] = wins.bitselect(new, old).to_array();
                    let mask = wins.to_bits().cast_signed();
                    cell.facet[g] = mask.bitselect(own, i32x4::from(cell.facet[g])).to_array();
                },
            );
        }
    }

    /// Lights each smooth surface once per pixel in which it is visible, weighted by its samples.
    ///
    /// If something translucent is visible, the layers do this.
    fn light(&mut self, view: &RasterView, part: &TilePart, layers: bool) {
        // So many vectors have so many samples: nothing else is compiled.
        match (G, self.pattern.samples) {
            (1, 1) => self.light_samples::<1>(view, part, layers),
            (1, 2) => self.light_samples::<2>(view, part, layers),
            (1, _) => self.light_samples::<4>(view, part, layers),
            (2, _) => self.light_samples::<8>(view, part, layers),
            _ => self.light_samples::<16>(view, part, layers),
        }
    }

    #[inline(never)]
    fn light_samples<const S: usize>(&mut self, view: &RasterView, part: &TilePart, layers: bool) {
        let Self {
            cells,
            colour,
            batch,
            layers: over,
            seen_backdrop,
            ..
        } = self;
        let cells = cells.as_slice();
        let is_touched = |pixel: usize| layers && over.touch(pixel);
        *seen_backdrop = PixelMask::NONE;
        part.for_each(|pixel, x, y| {
            let own = &facets_of::<S, G>(cells, pixel);
            let first = own[0];
            if own.contains(&NOTHING) {
                seen_backdrop.insert(pixel);
            }
            if *own == [NOTHING; S] && !is_touched(pixel) {
                colour[pixel] = BARE;
                return;
            }
            colour[pixel] = [0.0; 3];
            if is_touched(pixel) {
                return;
            }
            // Most pixels show one surface: one evaluation of the light.
            if one_surface(view.assembly, own) {
                batch.add(view, first, [x, y], (1.0, pixel), &mut add_to(colour));
                return;
            }
            let mut seen = SeenFacets::of(own);
            seen.merge(view.assembly);
            let seen = &seen.facets[..seen.count];
            let weight = |count: u32| count as f32 / S as f32;
            // At borders, each surface counts by its share of the samples: the backdrop first, whenever the others are lit.
            if let Some((_, count)) = seen.iter().find(|(facet, _)| *facet == NOTHING) {
                let (rgb, _) = view.backdrop.linear(x as usize, y as usize, view.shadow);
                colour[pixel] = rgb.map(|c| c * weight(*count));
            }
            for (facet, count) in seen.iter().filter(|(facet, _)| *facet != NOTHING) {
                let item = (weight(*count), pixel);
                batch.add(view, *facet, [x, y], item, &mut add_to(colour));
            }
        });
        self.batch.flush(view, &mut add_to(&mut self.colour));
    }

    #[inline(never)]
    fn write(
        &mut self,
        view: &RasterView,
        part: &TilePart,
        (bytes, first, stride): (&mut [u8], i32, usize),
    ) {
        let curve = ToneCurve::shared();
        self.bare = PixelMask::NONE;
        part.for_runs(|own, count, x, y| {
            let start = (y - first) as usize * stride + x as usize * 4;
            let Some(target) = bytes.get_mut(start..start + count * 4) else {
                return;
            };
            let colours = &self.colour[own..own + count];
            let targets = target.as_chunks_mut::<4>().0;
            for (k, (target, colour)) in targets.iter_mut().zip(colours).enumerate() {
                let [r, g, b] = *colour;
                // A negative colour marks a bare pixel, whose bytes are prepared.
                *target = if r < 0.0 {
                    self.bare.insert(own + k);
                    bare_pixel(view, x as usize + k, y as usize)
                } else {
                    [curve.encode(r), curve.encode(g), curve.encode(b), 255]
                };
            }
        });
    }
}

/// Adds lit surfaces to their pixels.
fn add_to(pixels: &mut [[f32; 3]]) -> impl Receive {
    |pixel, [r, g, b, _]| {
        let own = &mut pixels[pixel];
        *own = [own[0] + r, own[1] + g, own[2] + b];
    }
}

#[inline(always)]
fn bare_pixel(view: &RasterView, x: usize, y: usize) -> [u8; 4] {
    let shaded = view.backdrop.shaded_code(x, y, view.shadow);
    shaded.unwrap_or_else(|| view.backdrop.codes(x, y, 1)[0])
}

/// Draws bare pixels of a tile. `bytes` are the picture's from its row `first` on, `stride` bytes a row.
pub(super) fn fill_background(
    view: &RasterView,
    part: &TilePart,
    (bytes, first, stride): (&mut [u8], i32, usize),
) {
    part.for_runs(|_, count, x, y| {
        let start = (y - first) as usize * stride + x as usize * 4;
        let Some(row) = bytes.get_mut(start..start + count * 4) else {
            return;
        };
        let (x, y) = (x as usize, y as usize);
        row.copy_from_slice(view.backdrop.codes(x, y, count).as_flattened());
        if view.shadow.is_some() {
            for (k, target) in row.as_chunks_mut::<4>().0.iter_mut().enumerate() {
                if let Some(code) = view.backdrop.shaded_code(x + k, y, view.shadow) {
                    *target = code;
                }
            }
        }
    });
}
