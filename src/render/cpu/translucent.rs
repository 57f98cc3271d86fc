//! Translucent facets over an opaque tile: a colour for every sample, blended far to near.

use super::assembly::Bin;
use super::raster::{Window, rasterise};
use super::samples::Pattern;
use super::shading::{light, normal_at, unit};
use super::tile::{AREA, NOTHING, TILE, View, for_pixels};
use crate::render::look::{self, Rgb};

/// Linear colours of the samples of one tile.
#[derive(Debug, Default)]
pub(super) struct Layers<const S: usize> {
    colour: Vec<[Rgb; S]>,
}

/// Light on a facet in a pixel, and the cosine between its normal and the line of sight.
fn lit(view: &View, number: u32, x: i32, y: i32) -> (Rgb, f32) {
    let facet = &view.assembly.facets[number as usize];
    let paint = &view.assembly.paints[facet.instance()];
    let normal = normal_at(view.assembly, facet, view.lens, x, y);
    let to_viewer = view.lens.to_viewer(x as f32 + 0.5, y as f32 + 0.5);
    let cosine = look::saturate(look::dot(unit(normal), unit(to_viewer)));
    let rgb = light(normal, to_viewer, view.up, paint.albedo, paint.flat);
    (rgb, cosine)
}

impl<const S: usize> Layers<S> {
    /// Takes over the opaque facets of a tile.
    pub(super) fn begin(&mut self, view: &View, window: Window, facets: &[[u32; S]]) {
        self.colour.resize(AREA, [[0.0; 3]; S]);
        for_pixels(window, |pixel, x, y| {
            let samples = &facets[pixel];
            let mut last = (NOTHING, [0.0; 3], false);
            for s in 0..S {
                if last.0 != samples[s] || !last.2 {
                    let rgb = if samples[s] == NOTHING {
                        view.backdrop.linear(x as usize, y as usize, view.shadow).0
                    } else {
                        lit(view, samples[s], x, y).0
                    };
                    last = (samples[s], rgb, true);
                }
                self.colour[pixel][s] = last.1;
            }
        });
    }

    /// Blends the translucent facets of a bin in its order; `depth` is that of the opaque samples.
    pub(super) fn blend(
        &mut self,
        view: &View,
        bin: &Bin,
        window: Window,
        pattern: &Pattern<S>,
        depth: &[[f32; S]],
    ) {
        for number in &bin.translucent {
            let facet = &view.assembly.facets[*number as usize];
            let paint = &view.assembly.paints[facet.instance()];
            let corners = facet.corners.map(|i| view.assembly.vertices[i as usize]);
            rasterise(corners, window, pattern, |x, y, covered, depths| {
                let pixel = (y - window.y[0]) as usize * TILE + (x - window.x[0]) as usize;
                let seen: [bool; S] =
                    std::array::from_fn(|s| covered[s] != 0 && depths[s] > depth[pixel][s]);
                if !seen.contains(&true) {
                    return;
                }
                let (rgb, cosine) = lit(view, *number, x, y);
                let opacity = look::mix(
                    look::edge_opacity(paint.opacity, cosine),
                    paint.opacity,
                    paint.flat,
                );
                for s in 0..S {
                    if seen[s] {
                        let below = self.colour[pixel][s];
                        self.colour[pixel][s] =
                            std::array::from_fn(|k| look::mix(below[k], rgb[k], opacity));
                    }
                }
            });
        }
    }

    /// Mean colour of each pixel's samples.
    pub(super) fn resolve(&self, pixels: &mut [Rgb]) {
        for (pixel, samples) in pixels.iter_mut().zip(&self.colour) {
            let sum = samples.iter().fold([0.0; 3], |sum: Rgb, c| {
                [sum[0] + c[0], sum[1] + c[1], sum[2] + c[2]]
            });
            *pixel = sum.map(|c| c / S as f32);
        }
    }
}
