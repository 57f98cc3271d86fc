//! One tile of the picture: nearest facet of every sample, then light, then bytes.

use super::assembly::{TileBin, TriangleAssembly};
use super::cell::{NOTHING, PixelCell, facets_of};
use super::outlines::OutlineFinder;
use super::rasterise::rasterise_block;
use super::samples::{LANES, SUBPIXELS, SamplePattern};
use super::shading::{ShadingBatch, normal_at};
use super::translucent::Layers;
use super::view::RasterView;
use super::window::{AREA, TILE, Window, for_inner, for_pixels};
use crate::render::Stage;
use crate::render::colour::ToneCurve;
use crate::render::look::ALL_OPEN;
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
        }
    }

    /// Draws the pixels `inner` of tile number `number`, all of them or some of its rows. `bytes` are the picture's from
    /// the first of these rows on, `stride` bytes a row.
    pub(super) fn draw(
        &mut self,
        view: &RasterView,
        number: usize,
        inner: Window,
        bytes: &mut [u8],
        stride: usize,
    ) {
        let bin = &view.assembly.bins[number];
        let shadow = view
            .shadow
            .filter(|_| view.backdrop.shaded(number, view.shadow));
        let view = RasterView { shadow, ..*view };
        // A tile without triangles is background.
        if bin.opaque.is_empty() && bin.translucent.is_empty() {
            fill_background(&view, inner, bytes, stride);
            return;
        }
        // That of the whole tile whatever rows are drawn: depths are rounded from its first pixel on.
        let window = view.assembly.with_apron(view.assembly.window(number));
        let parts = (window, inner);
        // Depth and facet of every sample, then lines, then translucent layers over them.
        self.clear(&view, window);
        self.cover_bin(&view, bin, window);
        if let Some(outlines) = &mut self.outlines {
            outlines.read(view.assembly, &self.cells);
            outlines.find(view.lens, window, inner, false);
        }
        let translucent = !bin.translucent.is_empty();
        if translucent {
            let cells = &self.cells;
            self.layers
                .collect(&view, bin, window, &self.pattern, cells);
        }
        // Colours: opaque surfaces, lines, layers, and the encoded bytes.
        self.light(&view, parts, translucent);
        self.ink(&view, parts);
        if translucent {
            self.blend_layers(&view, parts);
        }
        self.write(&view, parts, bytes, stride);
    }

    fn ink(&mut self, view: &RasterView, (window, inner): (Window, Window)) {
        if let Some(outlines) = &self.outlines {
            outlines.ink(view, window, inner, (&mut self.colour, BARE));
        }
    }

    /// Blends the translucent layers over the opaque samples, and finds the lines of the nearest surfaces of both.
    fn blend_layers(&mut self, view: &RasterView, parts: (Window, Window)) {
        self.lay_under(view.assembly, parts);
        let lines = self.outlines.as_ref();
        let inked =
            |pixel: usize, rgb: [f32; 3]| lines.map_or(rgb, |lines| lines.with_ink(pixel, rgb));
        self.layers
            .blend(view, parts, inked, &mut self.batch, &mut self.colour);
        if let Some(outlines) = &mut self.outlines {
            outlines.read_over(view.assembly, &self.layers);
            outlines.find(view.lens, parts.0, parts.1, true);
        }
        self.ink(view, parts);
    }

    fn clear(&mut self, view: &RasterView, window: Window) {
        self.cells.fill(PixelCell::BARE);
        if !view.below_ground {
            return;
        }
        let Some(ground) = &view.backdrop.view else {
            return;
        };
        let samples = self.pattern.samples;
        // The ground hides what is below it: its depth is the first in every sample.
        let [right, down, start] = ground.nearness(view.lens.perspective);
        for_pixels(window, |pixel, x, y| {
            let (x, y) = (f64::from(x), f64::from(y));
            if !ground.is_seen(x + 0.5, y + 0.5) {
                return;
            }
            for s in 0..samples {
                let place = |p: f64, offset: &[[i32; LANES]; G]| {
                    p + f64::from(offset.as_flattened()[s]) / f64::from(SUBPIXELS)
                };
                let (x, y) = (place(x, &self.pattern.x), place(y, &self.pattern.y));
                let lane = pixel * samples + s;
                let cell = &mut self.cells[lane / (LANES * G)];
                cell.depth.as_flattened_mut()[lane % (LANES * G)] =
                    (right * x + down * y + start) as f32;
            }
        });
    }

    fn lay_under(&mut self, assembly: &TriangleAssembly, parts: (Window, Window)) {
        let (layers, cells) = (&mut self.layers, self.cells.as_slice());
        match (G, self.pattern.samples) {
            (1, 1) => layers.lay_under(assembly, parts, |pixel| facets_of::<1, G>(cells, pixel)),
            (1, 2) => layers.lay_under(assembly, parts, |pixel| facets_of::<2, G>(cells, pixel)),
            (1, _) => layers.lay_under(assembly, parts, |pixel| facets_of::<4, G>(cells, pixel)),
            (2, _) => layers.lay_under(assembly, parts, |pixel| facets_of::<8, G>(cells, pixel)),
            _ => layers.lay_under(assembly, parts, |pixel| facets_of::<16, G>(cells, pixel)),
        }
    }

    /// Finds the nearest opaque facet of every sample; of equally near ones the first.
    #[inline(never)]
    fn cover_bin(&mut self, view: &RasterView, bin: &TileBin, window: Window) {
        for number in &bin.opaque {
            let facet = &view.assembly.facets[*number as usize];
            let corners = view.assembly.corners(&facet.corners);
            let own = i32x4::splat(*number as i32);
            let cells = self.cells.as_mut_slice();
            rasterise_block(corners, &window, &self.pattern, |cell, g, covered, new| {
                let cell = &mut cells[cell];
                let old = f32x4::from(cell.depth[g]);
                // Depth test: nearness grows towards the viewer, and the earlier instance wins a tie.
                let wins = new.simd_gt(old) & covered;
                cell.depth[g] = wins.bitselect(new, old).to_array();
                let mask = wins.to_bits().cast_signed();
                cell.facet[g] = mask.bitselect(own, i32x4::from(cell.facet[g])).to_array();
            });
        }
    }

    /// Lights each smooth surface once per pixel in which it is visible, weighted by its samples.
    ///
    /// If something translucent is visible, the layers do this.
    fn light(&mut self, view: &RasterView, parts: (Window, Window), layers: bool) {
        // So many vectors have so many samples: nothing else is compiled.
        match (G, self.pattern.samples) {
            (1, 1) => self.light_samples::<1>(view, parts, layers),
            (1, 2) => self.light_samples::<2>(view, parts, layers),
            (1, _) => self.light_samples::<4>(view, parts, layers),
            (2, _) => self.light_samples::<8>(view, parts, layers),
            _ => self.light_samples::<16>(view, parts, layers),
        }
    }

    #[inline(never)]
    fn light_samples<const S: usize>(
        &mut self,
        view: &RasterView,
        (window, inner): (Window, Window),
        layers: bool,
    ) {
        let cells = self.cells.as_slice();
        let colour = self.colour.as_mut_slice();
        for_inner(window, inner, |pixel, x, y| {
            let own = &facets_of::<S, G>(cells, pixel);
            let first = own[0];
            if *own == [NOTHING; S] && !(layers && self.layers.touch(pixel)) {
                colour[pixel] = BARE;
                return;
            }
            colour[pixel] = [0.0; 3];
            if layers && self.layers.touch(pixel) {
                return;
            }
            // Most pixels show one surface: one evaluation of the light.
            if one_surface(view.assembly, own) {
                self.batch.add(view, first, x, y, 1.0, pixel, colour);
                return;
            }
            let mut seen = SeenFacets::of(own);
            seen.merge(view.assembly);
            // At borders, each surface counts by its share of the samples.
            for (facet, count) in &seen.facets[..seen.count] {
                let weight = *count as f32 / S as f32;
                if *facet == NOTHING {
                    let (rgb, _) = view.backdrop.linear(x as usize, y as usize, view.shadow);
                    for k in 0..3 {
                        colour[pixel][k] += rgb[k] * weight;
                    }
                } else {
                    self.batch.add(view, *facet, x, y, weight, pixel, colour);
                }
            }
        });
        self.batch.flush(&view.around, colour);
    }

    #[inline(never)]
    fn write(
        &self,
        view: &RasterView,
        (window, inner): (Window, Window),
        bytes: &mut [u8],
        stride: usize,
    ) {
        let curve = ToneCurve::shared();
        let first = inner.x[0] as usize;
        let count = (inner.x[1] - inner.x[0] + 1) as usize;
        for y in inner.y[0]..=inner.y[1] {
            let start = (y - inner.y[0]) as usize * stride + first * 4;
            let Some(target) = bytes.get_mut(start..start + count * 4) else {
                continue;
            };
            let own = (y - window.y[0]) as usize * TILE + (inner.x[0] - window.x[0]) as usize;
            let colours = &self.colour[own..own + count];
            let targets = target.as_chunks_mut::<4>().0;
            for (k, (target, colour)) in targets.iter_mut().zip(colours).enumerate() {
                let [r, g, b] = *colour;
                // A negative colour marks a bare pixel, whose bytes are prepared.
                *target = if r < 0.0 {
                    bare_pixel(view, first + k, y as usize)
                } else {
                    [curve.encode(r), curve.encode(g), curve.encode(b), 255]
                };
            }
        }
    }
}

impl ShadingBatch {
    /// Adds a facet in a pixel, lighting the batch when it is full. Returns its normal and the direction of the viewer; neither has
    /// length 1.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub(super) fn add(
        &mut self,
        view: &RasterView,
        number: i32,
        x: i32,
        y: i32,
        weight: f32,
        pixel: usize,
        colour: &mut [[f32; 3]],
    ) -> [[f32; 3]; 2] {
        let facet = &view.assembly.facets[number as usize];
        let paint = &view.assembly.paints[facet.instance()];
        // Interpolated between the corners, at the centre of the pixel.
        let (normal, nearness) = normal_at(view.assembly, facet, view.lens, x, y);
        let at = [x as f32 + 0.5, y as f32 + 0.5];
        let to_viewer = view.lens.viewer_from(at[0], at[1]);
        // How much of the light reaches this place; wholly flat colours need none.
        let open = match view.shade {
            Some(shade) if paint.flat < 1.0 => {
                let place = view.lens.place(at[0], at[1], nearness);
                shade.on(at, place, normal)
            }
            _ => ALL_OPEN,
        };
        // It waits in the batch, which is lit all at once.
        self.push(
            [normal, to_viewer],
            paint.albedo,
            paint.flat,
            open,
            weight,
            pixel as u32,
        );
        if self.is_full() {
            self.flush(&view.around, colour);
        }
        [normal, to_viewer]
    }
}

#[inline(always)]
fn bare_pixel(view: &RasterView, x: usize, y: usize) -> [u8; 4] {
    if view.shadow.is_some() {
        let (rgb, changed) = view.backdrop.linear(x, y, view.shadow);
        if changed {
            let curve = ToneCurve::shared();
            return [
                curve.encode(rgb[0]),
                curve.encode(rgb[1]),
                curve.encode(rgb[2]),
                255,
            ];
        }
    }
    view.backdrop.codes(x, y, 1)[0]
}

/// A tile without facets.
fn fill_background(view: &RasterView, window: Window, bytes: &mut [u8], stride: usize) {
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
            for (k, target) in row.as_chunks_mut::<4>().0.iter_mut().enumerate() {
                *target = bare_pixel(view, first + k, y as usize);
            }
        } else {
            row.copy_from_slice(view.backdrop.codes(first, y as usize, count).as_flattened());
        }
    }
}
