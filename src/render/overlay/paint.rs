//! Blending of coverage into a picture, in linear light and clipped to its edges.

use crate::render::colour::ToneCurve;
use crate::render::text::Mask;
use image::RgbaImage;
use std::ops::Range;

/// Writes into one picture, or into some rows of one.
pub struct OverlayPainter<'a> {
    image: &'a mut RgbaImage,
    /// Height of the picture, and its first row that `image` holds.
    height: u32,
    first: u32,
    curve: &'static ToneCurve,
}

impl<'a> OverlayPainter<'a> {
    /// A painter on `image`.
    pub fn new(image: &'a mut RgbaImage) -> Self {
        let height = image.height();
        Self::on_strip(image, 0, height)
    }

    /// A painter on `image`, the rows from `first` on of a picture `height` pixels high.
    pub fn on_strip(image: &'a mut RgbaImage, first: u32, height: u32) -> Self {
        Self {
            image,
            height,
            first,
            curve: ToneCurve::shared(),
        }
    }

    /// Width and height of the picture.
    pub fn size(&self) -> [u32; 2] {
        [self.image.width(), self.height]
    }

    /// The rows of the picture that are drawn.
    pub fn rows(&self) -> Range<u32> {
        let last = self.first.saturating_add(self.image.height());
        self.first..last.min(self.height).max(self.first)
    }

    /// The part of columns `left..right` and rows `top..bottom` that is drawn, as `[x0, y0, x1, y1]`.
    pub fn clip(&self, left: i32, top: i32, right: i32, bottom: i32) -> [u32; 4] {
        let (width, rows) = (self.image.width(), self.rows());
        let column = |value: i32| value.max(0).unsigned_abs().min(width);
        let row = |value: i32| value.max(0).unsigned_abs().clamp(rows.start, rows.end);
        [column(left), row(top), column(right), row(bottom)]
    }

    /// Moves the pixel at (x, y), which must be one of those that are drawn, towards `colour` by `share` 0 to 1.
    pub fn blend(&mut self, x: u32, y: u32, colour: [u8; 3], share: f32) {
        let row = y.checked_sub(self.first);
        let Some(pixel) = row.and_then(|row| self.image.get_pixel_mut_checked(x, row)) else {
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
