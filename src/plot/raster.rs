//! A drawing as pixels. The same drawing gives the same bytes everywhere.

use super::coverage::Coverage;
use super::drawing::Drawing;
use super::primitive::{DrawnPrimitive, LineStyle, TextAnchor};
use super::theme::Colour;
use crate::math::sin_cos;
use crate::render::text::{FontFace, set_text};
use image::RgbaImage;
use std::f64::consts::{PI, TAU};

/// Draws on RGBA pixels; caches glyphs.
#[derive(Default)]
pub struct ChartPainter {
    face: FontFace,
}

impl ChartPainter {
    /// The whole drawing as an opaque picture; one transparent pixel for a drawing without any.
    pub fn picture(&mut self, drawing: &Drawing) -> RgbaImage {
        let [width, height] = drawing.size.map(|side| side.max(1));
        let background = image::Rgba(drawing.theme.background);
        let mut image = RgbaImage::from_pixel(width, height, background);
        self.paint_primitives(&drawing.primitives, &mut image);
        image
    }

    /// Draws `primitives` over an opaque picture.
    pub fn paint_primitives(&mut self, primitives: &[DrawnPrimitive], image: &mut RgbaImage) {
        for primitive in primitives {
            match primitive {
                DrawnPrimitive::Text {
                    at,
                    text,
                    size,
                    anchor,
                    colour,
                } => self.text(*at, text, *size, *anchor, *colour, image),
                shape => paint_shape(shape, image),
            }
        }
    }

    fn text(
        &mut self,
        at: [f64; 2],
        text: &str,
        size: f64,
        anchor: TextAnchor,
        colour: Colour,
        image: &mut RgbaImage,
    ) {
        let setting = set_text(&self.face, text, size);
        let back = match anchor {
            TextAnchor::Start => 0.0,
            TextAnchor::Middle => 0.5 * setting.width,
            TextAnchor::End => setting.width,
        };
        // Whole pixels: letters on a baseline between two rows would be blurred.
        let (left, baseline) = ((at[0] - back).round() as i64, at[1].round() as i64);
        for glyph in &setting.glyphs {
            let mask = self.face.mask(glyph.id, size, [glyph.phase, 0]);
            let column = left + i64::from(glyph.column) + i64::from(mask.left);
            let row = baseline + i64::from(mask.top);
            for y in 0..mask.height {
                for x in 0..mask.width {
                    let cover = mask.at(x, y);
                    blend_pixel(
                        image,
                        [column + i64::from(x), row + i64::from(y)],
                        colour,
                        cover,
                    );
                }
            }
        }
    }
}

/// Mixes `colour` over one pixel, if the picture has it.
fn blend_pixel(image: &mut RgbaImage, [x, y]: [i64; 2], colour: Colour, cover: u8) {
    let inside =
        (0..i64::from(image.width())).contains(&x) && (0..i64::from(image.height())).contains(&y);
    if cover == 0 || !inside {
        return;
    }
    let share = u32::from(cover) * u32::from(colour[3]) / 255;
    let pixel = image.get_pixel_mut(x as u32, y as u32);
    for (code, above) in pixel.0.iter_mut().zip(&colour[..3]) {
        let mixed = u32::from(*code) * (255 - share) + u32::from(*above) * share;
        *code = ((mixed + 127) / 255) as u8;
    }
}

fn paint_shape(shape: &DrawnPrimitive, image: &mut RgbaImage) {
    let size = [image.width(), image.height()];
    match shape {
        DrawnPrimitive::Area { rect, fill } => {
            paint(&Coverage::of_rect(rect, size), *fill, image);
        }
        DrawnPrimitive::Line { points, stroke, .. } => paint_line(points, *stroke, image),
        DrawnPrimitive::Region { points, fill } => {
            paint(&Coverage::of_polygon(points, size), *fill, image);
        }
        DrawnPrimitive::Circle {
            centre,
            radius,
            fill,
            stroke,
        } => {
            paint(&Coverage::of_disc(*centre, *radius, size), *fill, image);
            paint_line(&circle(*centre, *radius), *stroke, image);
        }
        DrawnPrimitive::Text { .. } => {}
    }
}

fn paint_line(points: &[[f64; 2]], look: LineStyle, image: &mut RgbaImage) {
    let size = [image.width(), image.height()];
    match look.dashes.lengths(look.width) {
        None => paint(
            &Coverage::of_line(points, look.width, false, size),
            look.colour,
            image,
        ),
        Some(lengths) => {
            for dash in dashes_of(points, lengths) {
                paint(
                    &Coverage::of_line(&dash, look.width, true, size),
                    look.colour,
                    image,
                );
            }
        }
    }
}

fn paint(coverage: &Coverage, colour: Colour, image: &mut RgbaImage) {
    for ([x, y], share) in coverage.pixels() {
        let place = [i64::from(x), i64::from(y)];
        blend_pixel(image, place, colour, (255.0 * share).round() as u8);
    }
}

/// The largest distance in pixels between a circle and the polygon that is drawn for it.
const ROUNDNESS: f64 = 0.02;

/// A closed polygon for a circle.
fn circle([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    // The middle of a chord is radius (1 - cos a) inside, where a is half its angle: about radius a² / 2.
    let half_angle = (2.0 * ROUNDNESS / radius.max(ROUNDNESS)).sqrt();
    let count = (PI / half_angle).ceil();
    (0..=count as usize)
        .map(|k| {
            let (sin, cos) = sin_cos(TAU * k as f64 / count);
            [x + radius * cos, y + radius * sin]
        })
        .collect()
}

/// No picture shows so many dashes of a piece of a line; such a piece is drawn whole.
const MOST_DASHES: f64 = 1e5;

/// The dashes of a line, the first at its begin.
fn dashes_of(points: &[[f64; 2]], [dash, gap]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let mut dashes = Vec::new();
    let (mut open, mut left) = (points.first().map(|p| vec![*p]), dash);
    for ends in points.windows(2) {
        let [from, to] = [ends[0], ends[1]];
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let whole = (dx * dx + dy * dy).sqrt();
        let mut done = 0.0;
        let is_shown = whole <= MOST_DASHES * (dash + gap);
        while is_shown && whole - done > left {
            done += left;
            let at = [from[0] + dx * done / whole, from[1] + dy * done / whole];
            (open, left) = match open {
                Some(mut corners) => {
                    corners.push(at);
                    dashes.push(corners);
                    (None, gap)
                }
                None => (Some(vec![at]), dash),
            };
        }
        left -= whole - done;
        if let Some(corners) = &mut open {
            corners.push(to);
        }
    }
    dashes.extend(open);
    dashes
}
