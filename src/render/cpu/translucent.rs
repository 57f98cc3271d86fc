//! Translucent facets over an opaque tile: every sample blends the surfaces in front of it by its own depths.
//!
//! The order is determined sample by sample, so bodies may intersect or enclose each other, and the order of the
//! instances does not matter. Where all samples of a vector agree on the order, they are blended together.

use super::assembly::{TileBin, TriangleAssembly};
use super::cell::{NOTHING, PixelCell};
use super::mask::{PixelMask, TilePart};
use super::rasterise::rasterise_block;
use super::samples::{LANES, SamplePattern};
use super::shading::ShadingBatch;
use super::view::RasterView;
use super::window::{AREA, TILE, Window};
use crate::render::look::{self, Rgb};
use wide::{f32x4, i32x4};

/// Ends a list.
const NONE: u32 = u32::MAX;

/// So many layers of a pixel are tried for another facet.
const RECENT: usize = 2;

/// Nearness of a layer at samples that it does not cover.
const UNCOVERED: f32 = f32::NEG_INFINITY;

/// A smooth surface in a pixel: lit once for all samples there, at the facet that was drawn first.
#[derive(Clone, Copy, Debug)]
struct Layer<const G: usize> {
    facet: i32,
    pixel: u32,
    /// The one before it in its pixel.
    before: u32,
    /// Nearness at the samples of its cell, and the facet there.
    depth: [[f32; LANES]; G],
    facets: [[i32; LANES]; G],
}

impl<const G: usize> Layer<G> {
    /// The lanes of a vector that it covers.
    #[inline(always)]
    fn covered(&self, g: usize) -> f32x4 {
        f32x4::from(self.depth[g]).simd_gt(f32x4::splat(UNCOVERED))
    }
}

/// The translucent layers of one tile. Kept for its memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Layers<const G: usize> {
    samples: usize,
    layers: Vec<Layer<G>>,
    /// The last layer of each pixel.
    latest: Vec<u32>,
    /// The last facet, its pixel, and its layer there.
    last: [u32; 3],
    /// The opaque surfaces of the pixels that are touched: facet and pixel.
    under: Vec<(i32, u32)>,
    /// The one of them behind each sample.
    behind: Vec<u32>,
    /// Linear colours and opacities of the layers, then of the opaque surfaces.
    colours: Vec<[f32; 4]>,
    /// Layers of a pixel with their nearness, from the farthest to the nearest.
    order: Vec<(f32, u32)>,
}

impl<const G: usize> Layers<G> {
    /// Whether a pixel shows anything translucent.
    #[inline(always)]
    pub(super) fn touch(&self, pixel: usize) -> bool {
        self.latest[pixel] != NONE
    }

    /// The nearest translucent facets at vector `g` of a pixel's cell and their nearness; [`NOTHING`] where there is none.
    pub(super) fn nearest(&self, pixel: usize, g: usize) -> ([i32; LANES], [f32; LANES]) {
        let (mut found, mut nearest) = (i32x4::splat(NOTHING), f32x4::splat(UNCOVERED));
        let mut at = self.latest[pixel];
        // Of equally near ones the last.
        while let Some(layer) = self.layers.get(at as usize) {
            let depth = f32x4::from(layer.depth[g]);
            let is_nearer = depth.simd_gt(nearest);
            nearest = is_nearer.bitselect(depth, nearest);
            let mask = is_nearer.to_bits().cast_signed();
            found = mask.bitselect(i32x4::from(layer.facets[g]), found);
            at = layer.before;
        }
        (found.to_array(), nearest.to_array())
    }

    /// Finds the layers of a bin's translucent facets in front of the opaque samples of `cells`, as far as they are
    /// needed.
    pub(super) fn collect(
        &mut self,
        view: &RasterView,
        bin: &TileBin,
        (window, needed): (Window, &PixelMask),
        pattern: &SamplePattern<G>,
        cells: &[PixelCell<G>],
    ) {
        self.samples = pattern.samples;
        self.layers.clear();
        self.last = [NONE; 3];
        self.latest.clear();
        self.latest.resize(AREA, NONE);
        for number in &bin.translucent {
            let facet = &view.assembly.facets[*number as usize];
            if !needed.meets(window.corner(), &facet.pixels()) {
                continue;
            }
            let drawn = *number as i32;
            rasterise_block(
                view.assembly,
                facet,
                (&window, needed),
                pattern,
                |cell, g, covered, new| {
                    // In front of all opaque surfaces.
                    let seen = new.simd_gt(f32x4::from(cells[cell].depth[g])) & covered;
                    if seen.to_bitmask() == 0 {
                        return;
                    }
                    let first = cell << pattern.cell_bits;
                    if pattern.cell_bits == 0 {
                        if !needed.contains(first) {
                            return;
                        }
                        return self.cover(view.assembly, drawn, first, (g, seen, new));
                    }
                    for pixel in first..first + (1 << pattern.cell_bits) {
                        let own = seen & pixel_lanes(pixel, pattern.samples);
                        if own.to_bitmask() != 0 {
                            self.cover(view.assembly, drawn, pixel, (g, own, new));
                        }
                    }
                },
            );
        }
    }

    /// Covers lanes of vector `g` of a pixel with a facet.
    #[inline(always)]
    fn cover(
        &mut self,
        assembly: &TriangleAssembly,
        facet: i32,
        pixel: usize,
        (g, lanes, depth): (usize, f32x4, f32x4),
    ) {
        let at = self.layer_of(assembly, facet, pixel as u32, (g, lanes));
        let layer = &mut self.layers[at as usize];
        let mask = lanes.to_bits().cast_signed();
        layer.depth[g] = lanes
            .bitselect(depth, f32x4::from(layer.depth[g]))
            .to_array();
        let own = i32x4::splat(facet);
        layer.facets[g] = mask.bitselect(own, i32x4::from(layer.facets[g])).to_array();
    }

    /// The layer for lanes of a facet in a pixel, which it shares with the facets that are smoothly connected to it.
    #[inline(always)]
    fn layer_of(
        &mut self,
        assembly: &TriangleAssembly,
        facet: i32,
        pixel: u32,
        (g, lanes): (usize, f32x4),
    ) -> u32 {
        // A surface that folds over itself within a pixel needs another layer.
        let is_free = |layer: &Layer<G>| (layer.covered(g) & lanes).to_bitmask() == 0;
        // The samples of a facet in a pixel come one after the other.
        let [last, its_pixel, its_layer] = self.last;
        if last == facet as u32 && its_pixel == pixel && is_free(&self.layers[its_layer as usize]) {
            return its_layer;
        }
        let known = self.known_layer(assembly, facet, pixel, is_free);
        let layer = known.unwrap_or_else(|| {
            let new = self.layers.len() as u32;
            self.layers.push(Layer {
                facet,
                pixel,
                before: std::mem::replace(&mut self.latest[pixel as usize], new),
                depth: [[UNCOVERED; LANES]; G],
                facets: [[NOTHING; LANES]; G],
            });
            new
        });
        self.last = [facet as u32, pixel, layer];
        layer
    }

    /// The one of the last layers of a pixel to which a facet belongs: its neighbours are drawn shortly before it.
    #[inline(always)]
    fn known_layer(
        &self,
        assembly: &TriangleAssembly,
        facet: i32,
        pixel: u32,
        is_free: impl Fn(&Layer<G>) -> bool,
    ) -> Option<u32> {
        let mut at = self.latest[pixel as usize];
        for _ in 0..RECENT {
            let known = self.layers.get(at as usize)?;
            let is_same = known.facet == facet || is_one_side(assembly, known.facet, facet);
            if is_same && is_free(known) {
                return Some(at);
            }
            at = known.before;
        }
        None
    }

    /// Finds the opaque surfaces behind the layers; `facets` are those of a pixel's samples.
    pub(super) fn lay_under<const S: usize>(
        &mut self,
        assembly: &TriangleAssembly,
        part: &TilePart,
        facets: impl Fn(usize) -> [i32; S],
    ) {
        self.under.clear();
        self.behind.clear();
        self.behind.resize(AREA * S, NONE);
        part.for_each(|pixel, _, _| {
            if self.touch(pixel) {
                let (first, facets) = (self.under.len(), facets(pixel));
                let behind = &mut self.behind[pixel * S..][..S];
                if facets == [facets[0]; S] {
                    self.under.push((facets[0], pixel as u32));
                    behind.fill(first as u32);
                    return;
                }
                for (behind, facet) in behind.iter_mut().zip(facets) {
                    let mut own = self.under[first..].iter();
                    let known = own.position(|(known, _)| {
                        *known == facet || is_one_side(assembly, *known, facet)
                    });
                    let at = known.map_or(self.under.len(), |known| first + known);
                    if at == self.under.len() {
                        self.under.push((facet, pixel as u32));
                    }
                    *behind = at as u32;
                }
            }
        });
    }

    /// Lights all surfaces and blends the samples of the touched pixels, far to near, into `pixels`; `inked` draws the
    /// lines of the opaque surfaces over a colour in a pixel.
    pub(super) fn blend(
        &mut self,
        view: &RasterView,
        part: &TilePart,
        inked: impl Fn(usize, Rgb) -> Rgb,
        batch: &mut ShadingBatch,
        pixels: &mut [Rgb],
    ) {
        self.light(view, part, batch);
        let samples = self.samples;
        // A vector may have samples of several pixels.
        let is_shared = samples < LANES;
        part.for_each(|pixel, _, _| {
            if !self.touch(pixel) {
                return;
            }
            self.sort(pixel);
            let mut sum = [0.0; 3];
            // The mean over the samples, each blended from the back to the front.
            for first in (0..samples).step_by(LANES) {
                let sample = pixel * samples + first;
                let start = sample / LANES * LANES;
                let behind: [u32; LANES] = std::array::from_fn(|lane| {
                    let is_own = !is_shared || (start + lane) / samples == pixel;
                    if is_own {
                        self.behind[start + lane]
                    } else {
                        NONE
                    }
                });
                let colour = |behind: u32| {
                    let under = self.colours.get(self.layers.len() + behind as usize);
                    let [r, g, b, _] = under.copied().unwrap_or_default();
                    inked(pixel, [r, g, b])
                };
                // Most samples of a pixel have the same surface behind them.
                let under = match behind == [behind[0]; LANES] {
                    true => [colour(behind[0]); LANES],
                    false => behind.map(colour),
                };
                let seen = self.blended(start / LANES % G, under);
                for sample in sample..sample + samples.min(LANES) {
                    sum = [0, 1, 2].map(|k| sum[k] + seen[k][sample % LANES]);
                }
            }
            pixels[pixel] = sum.map(|c| c / samples as f32);
        });
    }

    /// Sorts the layers of a pixel by their nearest samples; of equally near ones the later is in front.
    fn sort(&mut self, pixel: usize) {
        self.order.clear();
        let mut at = self.latest[pixel];
        while let Some(layer) = self.layers.get(at as usize) {
            let nearest = layer.depth.as_flattened().iter();
            let nearest = nearest.fold(UNCOVERED, |most, depth| look::larger_of(*depth, most));
            // The chain leads from the last to the first.
            let mut place = self.order.len();
            self.order.push((nearest, at));
            while place > 0 && self.order[place - 1].0 >= nearest {
                self.order.swap(place - 1, place);
                place -= 1;
            }
            at = layer.before;
        }
    }

    /// Colours of the four samples of vector `g`, by channels, over those `under` them.
    #[inline(always)]
    fn blended(&self, g: usize, under: [Rgb; LANES]) -> [[f32; LANES]; 3] {
        let channel = |k: usize| f32x4::from(under.map(|rgb| rgb[k]));
        let mut rgb = [channel(0), channel(1), channel(2)];
        let mut nearest = f32x4::splat(UNCOVERED);
        let mut disordered = 0;
        for (_, at) in &self.order {
            let layer = &self.layers[*at as usize];
            let (depth, covered) = (f32x4::from(layer.depth[g]), layer.covered(g));
            disordered |= (depth.simd_lt(nearest) & covered).to_bitmask();
            nearest = covered.bitselect(depth, nearest);
            let over = self.colours[*at as usize];
            let opacity = f32x4::splat(over[3]);
            for k in 0..3 {
                let mixed = rgb[k] + (f32x4::splat(over[k]) - rgb[k]) * opacity;
                rgb[k] = covered.bitselect(mixed, rgb[k]);
            }
        }
        let mut rgb = rgb.map(f32x4::to_array);
        // Where surfaces intersect within a pixel, samples are blended one by one.
        for lane in (0..LANES).filter(|lane| disordered >> lane & 1 == 1) {
            let alone = self.blended_alone((g, lane), under[lane]);
            for k in 0..3 {
                rgb[k][lane] = alone[k];
            }
        }
        rgb
    }

    /// The colour of one sample over that behind it.
    #[cold]
    fn blended_alone(&self, (g, lane): (usize, usize), behind: Rgb) -> Rgb {
        let depth = |at: &u32| self.layers[*at as usize].depth[g][lane];
        let all = self.order.iter().map(|(_, at)| *at);
        let mut own: Vec<u32> = all.filter(|at| depth(at) > UNCOVERED).collect();
        own.sort_unstable_by(|a, b| depth(a).total_cmp(&depth(b)).then(a.cmp(b)));
        own.into_iter().fold(behind, |rgb, at| {
            let over = self.colours[at as usize];
            [0, 1, 2].map(|k| look::mix_values(rgb[k], over[k], over[3]))
        })
    }

    /// Colours of all surfaces.
    fn light(&mut self, view: &RasterView, part: &TilePart, batch: &mut ShadingBatch) {
        let place = |pixel: u32| {
            let [left, top] = part.corner();
            let pixel = pixel as usize;
            [left + (pixel % TILE) as i32, top + (pixel / TILE) as i32]
        };
        let count = self.layers.len();
        let colours = &mut self.colours;
        colours.clear();
        colours.resize(count + self.under.len(), [0.0; 4]);
        // Each surface of a pixel is lit once, whatever number of samples shows it.
        let drawn = self.layers.iter().enumerate();
        for (index, layer) in drawn.filter(|(_, l)| part.pixels.contains(l.pixel as usize)) {
            let mut receive = |index: usize, colour| colours[index] = colour;
            batch.add(
                view,
                layer.facet,
                place(layer.pixel),
                (1.0, index),
                &mut receive,
            );
        }
        for (index, (facet, pixel)) in (count..).zip(&self.under) {
            let [x, y] = place(*pixel);
            if *facet == NOTHING {
                let (rgb, _) = view.backdrop.linear(x as usize, y as usize, view.shadow);
                colours[index] = [rgb[0], rgb[1], rgb[2], 1.0];
                continue;
            }
            let mut receive = |index: usize, colour| colours[index] = colour;
            batch.add(view, *facet, [x, y], (1.0, index), &mut receive);
        }
        batch.flush(view, &mut |index, colour| colours[index] = colour);
    }
}

/// The lanes of a pixel in a vector that covers several.
#[inline(always)]
fn pixel_lanes(pixel: usize, samples: usize) -> f32x4 {
    let own = pixel * samples % LANES;
    let lane = |lane: usize| {
        let is_own = (own..own + samples).contains(&lane);
        f32::from_bits(if is_own { u32::MAX } else { 0 })
    };
    f32x4::from([lane(0), lane(1), lane(2), lane(3)])
}

/// Whether two facets belong to the same side of one smooth surface.
#[inline(always)]
fn is_one_side(assembly: &TriangleAssembly, first: i32, second: i32) -> bool {
    let side = |number: i32| {
        let facet = &assembly.facets[number as usize];
        (facet.instance(), facet.side())
    };
    first != NOTHING
        && second != NOTHING
        && side(first) == side(second)
        && assembly.is_smooth(first, second)
}
