//! Translucent facets over an opaque tile: a colour for every sample, blended far to near.

use super::assembly::TileBin;
use super::cell::{NOTHING, PixelCell};
use super::rasterise::rasterise_block;
use super::samples::{LANES, SamplePattern};
use super::shading::{light_surface, normal_at, unit_vector};
use super::view::RasterView;
use super::window::{AREA, TILE, Window, for_pixels};
use crate::render::look::{self, Rgb};
use wide::f32x4;

/// Linear colours of the samples of one tile, pixel by pixel.
#[derive(Clone, Debug, Default)]
pub(super) struct Layers {
    colour: Vec<Rgb>,
}

/// Light on a facet in a pixel, and the cosine between its normal and the line of sight.
fn lit_colour(view: &RasterView, number: usize, x: i32, y: i32) -> (Rgb, f32) {
    let facet = &view.assembly.facets[number];
    let paint = &view.assembly.paints[facet.instance()];
    let normal = normal_at(view.assembly, facet, view.lens, x, y);
    let to_viewer = view.lens.viewer_from(x as f32 + 0.5, y as f32 + 0.5);
    let cosine = look::clamp_unit(look::dot_product(
        unit_vector(normal),
        unit_vector(to_viewer),
    ));
    let rgb = light_surface(normal, to_viewer, &view.around, paint.albedo, paint.flat);
    (rgb, cosine)
}

impl Layers {
    /// Takes over the opaque facets of a tile, `S` for each pixel.
    pub(super) fn begin<const S: usize>(
        &mut self,
        view: &RasterView,
        window: Window,
        facets: impl Fn(usize) -> [i32; S],
    ) {
        self.colour.resize(AREA * S, [0.0; 3]);
        for_pixels(window, |pixel, x, y| {
            let own = self.colour[pixel * S..(pixel + 1) * S].iter_mut();
            let mut last: Option<(i32, Rgb)> = None;
            for (colour, facet) in own.zip(&facets(pixel)) {
                let rgb = match last {
                    Some((known, rgb)) if known == *facet => rgb,
                    _ if *facet == NOTHING => {
                        view.backdrop.linear(x as usize, y as usize, view.shadow).0
                    }
                    _ => lit_colour(view, *facet as usize, x, y).0,
                };
                last = Some((*facet, rgb));
                *colour = rgb;
            }
        });
    }

    /// Blends the translucent facets of a bin in its order; `cells` hold the depth of the opaque samples.
    pub(super) fn blend<const G: usize>(
        &mut self,
        view: &RasterView,
        bin: &TileBin,
        window: Window,
        pattern: &SamplePattern<G>,
        cells: &[PixelCell<G>],
    ) {
        for number in &bin.translucent {
            let facet = &view.assembly.facets[*number as usize];
            let paint = view.assembly.paints[facet.instance()];
            let corners = view.assembly.corners(&facet.corners);
            rasterise_block(corners, &window, pattern, |cell, g, covered, new| {
                let seen = new.simd_gt(f32x4::from(cells[cell].depth[g])) & covered;
                let mut lanes = seen.to_bitmask();
                while lanes != 0 {
                    let lane = (cell * G + g) * LANES + lanes.trailing_zeros() as usize;
                    let pixel = lane / pattern.samples;
                    // The lanes of one pixel are neighbours and share its light.
                    let last = (pixel + 1) * pattern.samples;
                    let x = window.x[0] + (pixel % TILE) as i32;
                    let y = window.y[0] + (pixel / TILE) as i32;
                    let (rgb, cosine) = lit_colour(view, *number as usize, x, y);
                    let curved = look::edge_opacity(paint.opacity, cosine);
                    let opacity = look::mix_values(curved, paint.opacity, paint.flat);
                    while lanes != 0 {
                        let bit = lanes.trailing_zeros();
                        let sample = (cell * G + g) * LANES + bit as usize;
                        if sample >= last {
                            break;
                        }
                        lanes &= lanes - 1;
                        let below = &mut self.colour[sample];
                        *below = [0, 1, 2].map(|k| look::mix_values(below[k], rgb[k], opacity));
                    }
                }
            });
        }
    }

    /// Mean colour of each pixel's samples.
    pub(super) fn resolve(&self, samples: usize, pixels: &mut [Rgb]) {
        for (pixel, own) in pixels.iter_mut().zip(self.colour.chunks_exact(samples)) {
            let sum = own.iter().fold([0.0; 3], |sum: Rgb, c| {
                [sum[0] + c[0], sum[1] + c[1], sum[2] + c[2]]
            });
            *pixel = sum.map(|c| c / samples as f32);
        }
    }
}
