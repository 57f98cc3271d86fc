//! Blending of coverage into a picture, in linear light and clipped to its edges.

use crate::render::colour::ToneCurve;
use crate::render::text::Mask;
use image::RgbaImage;

/// Writes into one picture.
pub struct OverlayPainter<'a> {
    image: &'a mut RgbaImage,
    curve: &'static ToneCurve,
}

impl<'a> OverlayPainter<'a> {
    /// A painter on `image`.
    pub fn new(image: &'a mut RgbaImage) -> Self {
        Self {
            image,
            curve: ToneCurve::shared(),
        }
    }

    /// The part of columns `left..right` and rows `top..bottom` that lies in the picture, as `[x0, y0, x1, y1]`.
    pub fn clip(&self, left: i32, top: i32, right: i32, bottom: i32) -> [u32; 4] {
        let (width, height) = self.image.dimensions();
        let within = |value: i32, limit: u32| value.max(0).unsigned_abs().min(limit);
        [
            within(left, width),
            within(top, height),
            within(right, width),
            within(bottom, height),
        ]
    }

    /// Moves the pixel at (x, y), which must lie in the picture, towards `colour` by `share` 0 to 1.
    pub fn blend(&mut self, x: u32, y: u32, colour: [u8; 3], share: f32) {
        let Some(pixel) = self.image.get_pixel_mut_checked(x, y) else {
            return;
        };
        for (code, target) in pixel.0.iter_mut().zip(colour) {
            let own = self.curve.decode(*code);
            let mixed = own + (self.curve.decode(target) - own) * share;
            *code = self.curve.encode(mixed);
        }
    }

    /// Blends a glyph of `colour` whose origin is at the pixel `origin`.
    pub fn blend_mask(&mut self, mask: &Mask, origin: [i32; 2], colour: [u8; 3]) {
        let left = origin[0].saturating_add(mask.left);
        let top = origin[1].saturating_add(mask.top);
        let right = left.saturating_add_unsigned(mask.width);
        let bottom = top.saturating_add_unsigned(mask.height);
        let [x0, y0, x1, y1] = self.clip(left, top, right, bottom);
        for y in y0..y1 {
            let row = y.wrapping_sub(top as u32);
            for x in x0..x1 {
                let coverage = mask.at(x.wrapping_sub(left as u32), row);
                if coverage > 0 {
                    self.blend(x, y, colour, f32::from(coverage) / 255.0);
                }
            }
        }
    }
}
