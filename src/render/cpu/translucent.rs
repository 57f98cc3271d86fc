//! Translucent facets over an opaque tile: every sample stores the facets in front of it and blends them by its own
//! depths.
//!
//! The order is determined sample by sample, so bodies may intersect or enclose each other, and the order of the
//! instances does not matter.

use super::assembly::{TileBin, TriangleAssembly};
use super::cell::{NOTHING, PixelCell};
use super::rasterise::rasterise_block;
use super::samples::{LANES, SamplePattern};
use super::shading::{ShadingBatch, unit_vector};
use super::view::RasterView;
use super::window::{AREA, TILE, Window, for_inner};
use crate::render::look::{self, Rgb};
use wide::f32x4;

/// Ends a list of fragments.
const NONE: u32 = u32::MAX;

/// So many surfaces of a pixel are tried for another facet.
const RECENT: usize = 2;

/// A facet at a sample.
#[derive(Clone, Copy, Debug)]
struct Fragment {
    depth: f32,
    facet: i32,
    /// The surface, an index into the surfaces.
    surface: u32,
    /// The next nearer one.
    next: u32,
}

/// A smooth surface in a pixel: it is lit once for all samples there, at the facet that was drawn first.
#[derive(Clone, Copy, Debug)]
struct LitSurface {
    facet: i32,
    pixel: u32,
    opacity: f32,
    /// The one before it in its pixel.
    before: u32,
}

/// The translucent fragments of one tile. Kept for its memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Layers {
    /// The farthest fragment of each sample.
    farthest: Vec<u32>,
    fragments: Vec<Fragment>,
    surfaces: Vec<LitSurface>,
    /// Linear colours of the surfaces.
    colours: Vec<Rgb>,
    /// The opaque surface behind each sample of the pixels that are touched.
    behind: Vec<u32>,
    /// The last surface of each pixel.
    latest: Vec<u32>,
    /// The last facet, its pixel, and its surface there.
    last: [u32; 3],
}

impl Layers {
    /// Whether a pixel shows anything translucent.
    #[inline(always)]
    pub(super) fn touch(&self, pixel: usize) -> bool {
        self.latest[pixel] != NONE
    }

    /// The nearest translucent facet at a sample and its nearness.
    pub(super) fn nearest(&self, sample: usize) -> Option<(i32, f32)> {
        let mut found = None;
        let mut at = self.farthest[sample];
        while let Some(fragment) = self.fragments.get(at as usize) {
            found = Some((fragment.facet, fragment.depth));
            at = fragment.next;
        }
        found
    }

    /// Finds the fragments of a bin's translucent facets in front of the opaque samples of `cells`.
    pub(super) fn collect<const G: usize>(
        &mut self,
        view: &RasterView,
        bin: &TileBin,
        window: Window,
        pattern: &SamplePattern<G>,
        cells: &[PixelCell<G>],
    ) {
        self.fragments.clear();
        self.surfaces.clear();
        self.last = [NONE; 3];
        self.farthest.clear();
        self.farthest.resize(AREA * pattern.samples, NONE);
        self.latest.clear();
        self.latest.resize(AREA, NONE);
        for number in &bin.translucent {
            let facet = &view.assembly.facets[*number as usize];
            let opacity = view.assembly.paints[facet.instance()].opacity;
            let corners = view.assembly.corners(&facet.corners);
            rasterise_block(corners, &window, pattern, |cell, g, covered, new| {
                // Fragments in front of all opaque surfaces.
                let seen = new.simd_gt(f32x4::from(cells[cell].depth[g])) & covered;
                let depths = new.to_array();
                let mut lanes = seen.to_bitmask();
                // Every covered lane becomes a fragment of its sample.
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let sample = (cell * G + g) * LANES + lane;
                    let pixel = (sample / pattern.samples) as u32;
                    let facet = *number as i32;
                    let surface = self.surface(view.assembly, facet, pixel, opacity);
                    self.insert(sample, depths[lane], facet, surface);
                }
            });
        }
    }

    /// The surface of a facet in a pixel, which it shares with the facets that are smoothly connected to it.
    fn surface(
        &mut self,
        assembly: &TriangleAssembly,
        facet: i32,
        pixel: u32,
        opacity: f32,
    ) -> u32 {
        // The samples of a facet in a pixel come one after the other.
        let [last, its_pixel, its_surface] = self.last;
        if last == facet as u32 && its_pixel == pixel {
            return its_surface;
        }
        let surface = self
            .known_surface(assembly, facet, pixel)
            .unwrap_or_else(|| {
                let new = self.surfaces.len() as u32;
                self.surfaces.push(LitSurface {
                    facet,
                    pixel,
                    opacity,
                    before: std::mem::replace(&mut self.latest[pixel as usize], new),
                });
                new
            });
        self.last = [facet as u32, pixel, surface];
        surface
    }

    /// The one of the last surfaces of a pixel to which a facet belongs: its neighbours are drawn shortly before it.
    #[inline(always)]
    fn known_surface(&self, assembly: &TriangleAssembly, facet: i32, pixel: u32) -> Option<u32> {
        let mut at = self.latest[pixel as usize];
        for _ in 0..RECENT {
            let known = self.surfaces.get(at as usize)?;
            if known.facet == facet || is_one_side(assembly, known.facet, facet) {
                return Some(at);
            }
            at = known.before;
        }
        None
    }

    /// Inserts a fragment in front of all farther ones; of equally distant ones the later is in front.
    fn insert(&mut self, sample: usize, depth: f32, facet: i32, surface: u32) {
        // A linked list per sample, from the farthest to the nearest; equal depths keep the order of drawing.
        let new = self.fragments.len() as u32;
        let (mut before, mut next) = (NONE, self.farthest[sample]);
        while let Some(other) = self.fragments.get(next as usize)
            && other.depth <= depth
        {
            (before, next) = (next, other.next);
        }
        self.fragments.push(Fragment {
            depth,
            facet,
            surface,
            next,
        });
        match self.fragments.get_mut(before as usize) {
            Some(other) => other.next = new,
            None => self.farthest[sample] = new,
        }
    }

    /// Appends the opaque surfaces behind the fragments; `facets` are those of a pixel's samples.
    pub(super) fn lay_under<const S: usize>(
        &mut self,
        assembly: &TriangleAssembly,
        (window, inner): (Window, Window),
        facets: impl Fn(usize) -> [i32; S],
    ) {
        self.behind.clear();
        self.behind.resize(AREA * S, NONE);
        for_inner(window, inner, |pixel, _, _| {
            if self.touch(pixel) {
                for (sample, facet) in facets(pixel).into_iter().enumerate() {
                    let surface = self.surface(assembly, facet, pixel as u32, 1.0);
                    self.behind[pixel * S + sample] = surface;
                }
            }
        });
    }

    /// Lights all surfaces and blends the samples of the touched pixels, far to near, into `pixels`; `inked` draws the
    /// lines of the opaque surfaces over a colour in a pixel.
    pub(super) fn blend(
        &mut self,
        view: &RasterView,
        (window, inner): (Window, Window),
        inked: impl Fn(usize, Rgb) -> Rgb,
        batch: &mut ShadingBatch,
        pixels: &mut [Rgb],
    ) {
        self.light(view, window, batch);
        let samples = self.farthest.len() / AREA;
        for_inner(window, inner, |pixel, _, _| {
            if self.touch(pixel) {
                let own = pixel * samples..(pixel + 1) * samples;
                let mut sum = [0.0; 3];
                // The mean over the samples, each blended from the back to the front.
                for rgb in own.map(|sample| self.seen(sample, |rgb| inked(pixel, rgb))) {
                    sum = [0, 1, 2].map(|k| sum[k] + rgb[k]);
                }
                pixels[pixel] = sum.map(|c| c / samples as f32);
            }
        });
    }

    /// The colour of a sample.
    fn seen(&self, sample: usize, inked: impl Fn(Rgb) -> Rgb) -> Rgb {
        let behind = self.behind[sample] as usize;
        let mut rgb = inked(self.colours.get(behind).copied().unwrap_or_default());
        let mut at = self.farthest[sample];
        while let Some(fragment) = self.fragments.get(at as usize) {
            let surface = fragment.surface as usize;
            let (over, opacity) = (self.colours[surface], self.surfaces[surface].opacity);
            rgb = [0, 1, 2].map(|k| look::mix_values(rgb[k], over[k], opacity));
            at = fragment.next;
        }
        rgb
    }

    /// Colours of all surfaces, with higher opacity for those seen edge-on.
    fn light(&mut self, view: &RasterView, window: Window, batch: &mut ShadingBatch) {
        self.colours.clear();
        self.colours.resize(self.surfaces.len(), [0.0; 3]);
        for (index, surface) in self.surfaces.iter_mut().enumerate() {
            let pixel = surface.pixel as usize;
            let x = window.x[0] + (pixel % TILE) as i32;
            let y = window.y[0] + (pixel / TILE) as i32;
            if surface.facet == NOTHING {
                self.colours[index] = view.backdrop.linear(x as usize, y as usize, view.shadow).0;
                continue;
            }
            let facet = surface.facet;
            // Each surface of a pixel is lit once, whatever number of samples shows it.
            let directions = batch.add(view, facet, x, y, 1.0, index, &mut self.colours);
            if surface.opacity < 1.0 {
                let facet = &view.assembly.facets[facet as usize];
                let flat = view.assembly.paints[facet.instance()].flat;
                surface.opacity = seen_opacity(directions, flat, surface.opacity);
            }
        }
        batch.flush(&view.around, &mut self.colours);
    }
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

/// Opacity of a surface from its normal and the direction of the viewer; flat colours have their own.
fn seen_opacity([normal, to_viewer]: [[f32; 3]; 2], flat: f32, opacity: f32) -> f32 {
    let cosine = look::clamp_unit(look::dot_product(
        unit_vector(normal),
        unit_vector(to_viewer),
    ));
    look::mix_values(look::edge_opacity(opacity, cosine), opacity, flat)
}
