//! Lines between the surfaces of one tile: finds the samples on a line, and mixes their colours with that of the line.

use super::assembly::TriangleAssembly;
use super::cell::{NOTHING, PixelCell};
use super::lens::Lens;
use super::mask::{PixelMask, TilePart};
use super::near_samples::{NearPixel, near_pixels};
use super::samples::{LANES, SamplePattern};
use super::translucent::Layers;
use super::view::RasterView;
use super::window::{AREA, TILE, Window, line_apron};
use crate::render::Stage;
use crate::render::colour::ToneCurve;
use crate::render::edges::{BACKDROP, EdgeStyle, FIRST, JUMP, NO_LINES, STRENGTH, TRANSLUCENT};
use crate::render::look::{Rgb, mix_values};
use wide::{f32x4, u32x4};

/// The samples of a pixel show several surfaces.
const MIXED: u32 = 2;

/// Finds the lines of tiles; kept for its memory.
#[derive(Clone, Debug)]
pub(super) struct OutlineFinder {
    samples: usize,
    /// Pixels that a line covers on each side of the border that it follows.
    reach: i32,
    ink: Rgb,
    /// A pixel and those around it that have samples within half a line's width of its own.
    near: Vec<NearPixel>,
    /// Surface and nearness of every sample.
    surface: Vec<u32>,
    depth: Vec<f32>,
    /// The surface of each pixel, or `MIXED`.
    whole: Vec<u32>,
    /// The surface of a pixel if those beside it in its row show it too, or `MIXED`.
    steady: Vec<u32>,
    /// The surface of all pixels of a row, or `MIXED`.
    rows: [u32; TILE],
    /// For each pixel the samples on a line, a bit each.
    marks: Vec<u16>,
}

impl OutlineFinder {
    pub(super) fn new<const G: usize>(stage: &Stage, pattern: &SamplePattern<G>) -> Option<Self> {
        let edges = stage.edges?;
        let reach = line_apron(stage);
        let half_width = EdgeStyle::half_width(stage.size[1], stage.samples);
        let samples = pattern.samples;
        Some(Self {
            samples,
            reach,
            ink: ToneCurve::shared().decode_rgb(edges.ink),
            near: near_pixels(pattern, reach, half_width),
            surface: vec![BACKDROP; AREA * samples],
            depth: vec![0.0; AREA * samples],
            whole: vec![BACKDROP; AREA],
            steady: vec![MIXED; AREA],
            rows: [MIXED; TILE],
            marks: vec![0; AREA],
        })
    }

    /// Reads the surfaces of the opaque samples of these pixels of a tile.
    pub(super) fn read<const G: usize>(
        &mut self,
        assembly: &TriangleAssembly,
        cells: &[PixelCell<G>],
        pixels: &PixelMask,
    ) {
        let mut known = (NOTHING, BACKDROP);
        let (surfaces, depths) = (&mut self.surface, &mut self.depth);
        let lanes = LANES * G;
        let samples = self.samples;
        pixels.for_runs(|first, count| {
            // Whole cells, which may have several pixels.
            let [first, end] = [
                first * samples / lanes,
                ((first + count) * samples).div_ceil(lanes),
            ];
            let own = surfaces[first * lanes..end * lanes].chunks_exact_mut(lanes);
            let own = own.zip(depths[first * lanes..end * lanes].chunks_exact_mut(lanes));
            for ((surfaces, depths), cell) in own.zip(&cells[first..end]) {
                depths.copy_from_slice(cell.depth.as_flattened());
                // Adjacent samples mostly show the same facet, whose surface is kept.
                for (surface, facet) in surfaces.iter_mut().zip(cell.facet.as_flattened()) {
                    if *facet != known.0 {
                        known = (*facet, assembly.surface(*facet));
                    }
                    *surface = known.1;
                }
            }
        });
    }

    /// Reads the nearest surfaces of the translucent layers.
    pub(super) fn read_over<const G: usize>(
        &mut self,
        assembly: &TriangleAssembly,
        layers: &Layers<G>,
    ) {
        let mut known = (NOTHING, BACKDROP);
        for pixel in (0..AREA).filter(|pixel| layers.touch(*pixel)) {
            // Vector by vector, of which a pixel may have several, or a part of one.
            let (mut sample, end) = (pixel * self.samples, (pixel + 1) * self.samples);
            while sample < end {
                let (facets, depths) = layers.nearest(pixel, sample / LANES % G);
                let own = sample..(sample / LANES * LANES + LANES).min(end);
                let surfaces = self.surface[own.clone()].iter_mut();
                let lanes = surfaces.zip(&mut self.depth[own.clone()]);
                let start = sample % LANES;
                let nearest = facets[start..].iter().zip(&depths[start..]);
                for ((surface, depth), (facet, nearness)) in lanes.zip(nearest) {
                    if *facet == NOTHING {
                        continue;
                    }
                    if *facet != known.0 {
                        known = (*facet, assembly.surface(*facet));
                    }
                    (*surface, *depth) = (known.1, *nearness);
                }
                sample = own.end;
            }
        }
    }

    /// The colour of a pixel with this share covered by a line.
    #[inline(always)]
    pub(super) fn with_ink(&self, pixel: usize, rgb: Rgb) -> Rgb {
        if self.marks[pixel] == 0 {
            return rgb;
        }
        let share = self.marks[pixel].count_ones() as f32 / self.samples as f32;
        [0, 1, 2].map(|k| mix_values(rgb[k], self.ink[k], STRENGTH * share))
    }

    /// Finds the samples of a part of a tile that are on a line; with `over` only lines with a translucent side.
    pub(super) fn find(&mut self, lens: &Lens, part: &TilePart, over: bool) {
        match self.samples {
            4 => self.find_of::<4>(lens, part, over),
            8 => self.find_of::<8>(lens, part, over),
            16 => self.find_of::<16>(lens, part, over),
            2 => self.find_of::<2>(lens, part, over),
            _ => self.find_of::<1>(lens, part, over),
        }
    }

    fn find_of<const S: usize>(&mut self, lens: &Lens, part: &TilePart, over: bool) {
        let least = if over { TRANSLUCENT } else { FIRST };
        let window = part.window;
        self.read_pixels::<S>(window, part.pixels.grown(self.reach).rows());
        let limit = DepthLimit {
            jump: JUMP * lens.pixel(),
            perspective: lens.perspective,
        };
        for row in (0..TILE).filter(|row| part.pixels.has_row(*row)) {
            let y = window.y[0] + row as i32;
            // Rows without any drawn surface have no lines.
            let is_bare = self.is_bare(window, y, least);
            part.pixels.for_runs_of(row, |first, count| {
                for pixel in first..first + count {
                    let at = (pixel, window.x[0] + (pixel % TILE) as i32, y);
                    self.marks[pixel] = if is_bare {
                        0
                    } else {
                        self.line::<S>(window, at, &limit, least)
                    };
                }
            });
        }
    }

    /// The samples of a pixel that are on a line.
    #[inline(always)]
    fn line<const S: usize>(
        &self,
        window: Window,
        at: (usize, i32, i32),
        limit: &DepthLimit,
        least: u32,
    ) -> u16 {
        let own = self.whole[at.0];
        // Inside one surface only a step in depth can make a line; elsewhere borders do as well.
        let calm = self.is_calm(window, at.0, at.2, own);
        match own {
            _ if calm && own < least => 0,
            _ if calm => self.steps::<S>(window, at, limit),
            _ => {
                self.border_samples::<S>(window, at, least == TRANSLUCENT)
                    | self.jumps::<S>(window, at, limit, least)
            }
        }
    }

    /// Whether no line can cross a row: it and all rows within reach of a line show one surface below `least`.
    fn is_bare(&self, window: Window, y: i32, least: u32) -> bool {
        let first = (y - self.reach).max(window.y[0]) - window.y[0];
        let last = (y + self.reach).min(window.y[1]) - window.y[0];
        let rows = &self.rows[first as usize..=last as usize];
        rows[0] != MIXED && rows[0] < least && rows.iter().all(|row| *row == rows[0])
    }

    fn read_pixels<const S: usize>(&mut self, window: Window, rows: [usize; 2]) {
        let columns = (window.x[1] - window.x[0] + 1) as usize;
        let reach = self.reach as usize;
        let (samples, _) = self.surface.as_chunks::<S>();
        for row in (rows[0]..rows[1]).take((window.y[1] - window.y[0] + 1) as usize - rows[0]) {
            let pixels = row * TILE..row * TILE + columns;
            let whole = &mut self.whole[pixels.clone()];
            for (whole, own) in whole.iter_mut().zip(&samples[pixels.clone()]) {
                *whole = if *own == [own[0]; S] { own[0] } else { MIXED };
            }
            let steady = &mut self.steady[pixels];
            self.rows[row] = whole[0];
            // Within a run of one surface only the ends can change, unless they are those of the picture.
            let mut start = 0;
            while start < columns {
                let own = whole[start];
                let run = whole[start..].iter().take_while(|w| **w == own);
                let end = start + run.count();
                steady[start..end].fill(MIXED);
                let first = if start == 0 { 0 } else { start + reach };
                let last = if end == columns {
                    end
                } else {
                    end.saturating_sub(reach)
                };
                if first < last {
                    steady[first..last].fill(own);
                }
                if start > 0 {
                    self.rows[row] = MIXED;
                }
                start = end;
            }
        }
    }

    /// Whether all pixels that a line could come from show the surface `own`.
    #[inline(always)]
    fn is_calm(&self, window: Window, pixel: usize, y: i32, own: u32) -> bool {
        let up = (y - window.y[0]).min(self.reach) as usize;
        let down = (window.y[1] - y).min(self.reach) as usize;
        let column = &self.steady[pixel - up * TILE..pixel + down * TILE + 1];
        own != MIXED && column.chunks(TILE).all(|row| row[0] == own)
    }

    /// Samples near to another surface.
    fn border_samples<const S: usize>(
        &self,
        window: Window,
        (pixel, x, y): (usize, i32, i32),
        over: bool,
    ) -> u16 {
        let (surfaces, _) = self.surface.as_chunks::<S>();
        let own = &surfaces[pixel];
        // Samples that may have a line, and those that have one over an opaque surface.
        let drawn = !equal_bits(own, NO_LINES);
        let is_translucent = |(s, own): (usize, &u32)| u16::from(*own >= TRANSLUCENT) << s;
        let above = match over {
            true => drawn & own.iter().enumerate().map(is_translucent).sum::<u16>(),
            false => drawn,
        };
        // The samples of this pixel that have a line towards another surface.
        let lined = |other: u32| {
            let own = match other {
                NO_LINES => 0,
                TRANSLUCENT.. => drawn & !equal_bits(own, other),
                _ => above & !equal_bits(own, other),
            };
            (other, own)
        };
        let (mut marks, mut known) = (0, (NO_LINES, 0));
        for near in &self.near {
            let (x, y) = (x + near.away[0], y + near.away[1]);
            let within =
                window.x[0] <= x && x <= window.x[1] && window.y[0] <= y && y <= window.y[1];
            if !within {
                continue;
            }
            let there = (pixel as i32 + near.away[1] * TILE as i32 + near.away[0]) as usize;
            let mut add = |surface: u32, reached: u16| {
                if surface != known.0 {
                    known = lined(surface);
                }
                marks |= known.1 & reached;
            };
            match self.whole[there] {
                MIXED => {
                    let others = surfaces[there].iter().zip(&near.reached);
                    others.for_each(|(surface, reached)| add(*surface, *reached));
                }
                surface => add(surface, near.by_any),
            }
        }
        marks
    }

    /// The result of [`Self::jumps`] in a pixel that is surrounded by one surface.
    #[inline(always)]
    fn steps<const S: usize>(
        &self,
        window: Window,
        (pixel, x, y): (usize, i32, i32),
        limit: &DepthLimit,
    ) -> u16 {
        let step = self.reach;
        let (depths, _) = self.depth.as_chunks::<S>();
        let own = &depths[pixel];
        let bends = |away: usize| {
            let (before, after) = (&depths[pixel - away], &depths[pixel + away]);
            let mut least = [0.0f32; S];
            for s in 0..S {
                // Second difference of the depth across the sample, against the limit of a smooth surface: negative
                // at a step.
                least[s] = before[s] + after[s] - 2.0 * own[s] + limit.at(own[s]);
            }
            below_zero(&least)
        };
        let mut marks = 0;
        // Across and along the picture, where the neighbours lie in the window.
        if x - step >= window.x[0] && x + step <= window.x[1] {
            marks |= bends(step as usize);
        }
        if y - step >= window.y[0] && y + step <= window.y[1] {
            marks |= bends(step as usize * TILE);
        }
        marks
    }

    /// Samples at which their own surface jumps back in depth: the part of the nearness that is not affine over the
    /// screen.
    #[inline(always)]
    fn jumps<const S: usize>(
        &self,
        window: Window,
        (pixel, x, y): (usize, i32, i32),
        limit: &DepthLimit,
        least: u32,
    ) -> u16 {
        let step = self.reach;
        let (depths, _) = self.depth.as_chunks::<S>();
        let (surfaces, _) = self.surface.as_chunks::<S>();
        let own = &depths[pixel];
        let falls = |away: usize| {
            let (before, after) = (pixel - away, pixel + away);
            let mut below = [0.0f32; S];
            for s in 0..S {
                let bend = depths[before][s] + depths[after][s] - 2.0 * own[s];
                // Negative at a sudden drop; equal numbers differ by zero.
                below[s] = bend - -limit.at(own[s]);
            }
            let falls = below_zero(&below);
            if falls == 0 {
                return 0;
            }
            // Only between neighbours that belong to the same surface.
            let is_one = |s: &usize| {
                let surface = surfaces[pixel][*s];
                let same = surfaces[before][*s] == surface && surfaces[after][*s] == surface;
                surface >= least && same
            };
            (0..S).filter(is_one).fold(0, |all, s| all | falls & 1 << s)
        };
        let mut marks = 0;
        if x - step >= window.x[0] && x + step <= window.x[1] {
            marks |= falls(step as usize);
        }
        if y - step >= window.y[0] && y + step <= window.y[1] {
            marks |= falls(step as usize * TILE);
        }
        marks
    }

    /// Mixes the ink into the pixels of a part of a tile; `bare` marks a pixel whose colour is still the backdrop's.
    pub(super) fn ink(
        &self,
        view: &RasterView,
        part: &TilePart,
        (colours, bare): (&mut [Rgb], Rgb),
    ) {
        part.for_each(|pixel, x, y| {
            let marks = self.marks[pixel];
            if marks == 0 {
                return;
            }
            let colour = &mut colours[pixel];
            // Bare pixels have no colour yet.
            if *colour == bare {
                *colour = view.backdrop.linear(x as usize, y as usize, view.shadow).0;
            }
            *colour = self.with_ink(pixel, *colour);
        });
    }
}

/// From which step of its depth on a surface has a silhouette.
struct DepthLimit {
    jump: f32,
    perspective: bool,
}

impl DepthLimit {
    #[inline(always)]
    fn at(&self, depth: f32) -> f32 {
        if self.perspective {
            self.jump * depth
        } else {
            self.jump
        }
    }
}

/// The samples that show a surface, a bit each.
#[inline(always)]
fn equal_bits<const S: usize>(own: &[u32; S], surface: u32) -> u16 {
    let (fours, rest) = own.as_chunks::<LANES>();
    let vectors = fours.iter().enumerate().map(|(k, four)| {
        let equal = u32x4::from(*four).simd_eq(u32x4::splat(surface));
        (equal.to_bitmask() as u16) << (k * LANES)
    });
    let rest = rest.iter().enumerate();
    let rest = rest.map(|(k, own)| u16::from(*own == surface) << k);
    vectors.chain(rest).fold(0, |all, bits| all | bits)
}

/// The samples with negative values, a bit each.
#[inline(always)]
fn below_zero<const S: usize>(values: &[f32; S]) -> u16 {
    let (fours, rest) = values.as_chunks::<LANES>();
    let vectors = fours.iter().enumerate().map(|(k, four)| {
        let below = f32x4::from(*four).simd_lt(f32x4::splat(0.0));
        (below.to_bitmask() as u16) << (k * LANES)
    });
    let rest = rest.iter().enumerate();
    let rest = rest.map(|(k, value)| u16::from(*value < 0.0) << k);
    vectors.chain(rest).fold(0, |all, bits| all | bits)
}
