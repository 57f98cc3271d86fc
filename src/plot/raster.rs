//! A drawing as pixels. The same drawing gives the same bytes everywhere.

use super::drawing::Drawing;
use super::primitive::{DrawnPrimitive, LineStyle, Rect, TextAnchor};
use super::theme::Colour;
use crate::render::text::{FontFace, set_text};
use image::RgbaImage;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, PixmapMut, Shader, StrokeDash,
    Transform,
};

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
    let (width, height) = image.dimensions();
    let Some(mut pixels) = PixmapMut::from_bytes(image, width, height) else {
        return;
    };
    match shape {
        DrawnPrimitive::Area { rect, fill } => {
            if let Some(rect) = skia_rect(rect) {
                pixels.fill_rect(rect, &solid_paint(*fill), Transform::identity(), None);
            }
        }
        DrawnPrimitive::Line { points, stroke, .. } => {
            stroke_outline(joined_path(points), *stroke, &mut pixels);
        }
        DrawnPrimitive::Region { points, fill } => {
            let mut path = joined_path(points);
            path.close();
            fill_outline(path, *fill, &mut pixels);
        }
        DrawnPrimitive::Circle {
            centre,
            radius,
            fill,
            stroke,
        } => {
            let circle = || {
                let mut path = PathBuilder::new();
                path.push_circle(centre[0] as f32, centre[1] as f32, *radius as f32);
                path
            };
            fill_outline(circle(), *fill, &mut pixels);
            stroke_outline(circle(), *stroke, &mut pixels);
        }
        DrawnPrimitive::Text { .. } => {}
    }
}

fn joined_path(points: &[[f64; 2]]) -> PathBuilder {
    let mut path = PathBuilder::new();
    for (k, [x, y]) in points.iter().enumerate() {
        match k {
            0 => path.move_to(*x as f32, *y as f32),
            _ => path.line_to(*x as f32, *y as f32),
        }
    }
    path
}

fn fill_outline(path: PathBuilder, fill: Colour, pixels: &mut PixmapMut) {
    let Some(path) = path.finish() else { return };
    pixels.fill_path(
        &path,
        &solid_paint(fill),
        FillRule::Winding,
        Transform::identity(),
        None,
    );
}

fn stroke_outline(path: PathBuilder, stroke: LineStyle, pixels: &mut PixmapMut) {
    let Some(path) = path.finish() else { return };
    let lengths = stroke.dashes.lengths(stroke.width);
    let dash = lengths.and_then(|l| StrokeDash::new(l.map(|v| v as f32).to_vec(), 0.0));
    let look = tiny_skia::Stroke {
        width: stroke.width as f32,
        line_cap: if dash.is_some() {
            LineCap::Butt
        } else {
            LineCap::Round
        },
        line_join: LineJoin::Round,
        dash,
        ..tiny_skia::Stroke::default()
    };
    pixels.stroke_path(
        &path,
        &solid_paint(stroke.colour),
        &look,
        Transform::identity(),
        None,
    );
}

fn solid_paint([r, g, b, a]: Colour) -> Paint<'static> {
    Paint {
        shader: Shader::SolidColor(Color::from_rgba8(r, g, b, a)),
        anti_alias: true,
        ..Paint::default()
    }
}

fn skia_rect(rect: &Rect) -> Option<tiny_skia::Rect> {
    let [l, t, r, b] = [rect.left, rect.top, rect.right, rect.bottom].map(|v| v as f32);
    tiny_skia::Rect::from_ltrb(l, t, r, b)
}
