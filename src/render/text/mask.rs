//! One glyph as coverage: rasterised outlines and the box of a missing character.

use ab_glyph::{Font, FontRef, Glyph, GlyphId, PxScale, point};

/// Coverage of a glyph, 0 to 255, row after row from the top.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mask {
    /// Column of the first pixel, from the glyph's origin.
    pub left: i32,
    /// Row of the first pixel from the baseline, downwards; negative above.
    pub top: i32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width` times `height` values.
    pub coverage: Vec<u8>,
}

impl Mask {
    /// Coverage of a pixel of the mask; 0 outside.
    pub fn at(&self, column: u32, row: u32) -> u8 {
        if column >= self.width {
            return 0;
        }
        let index = row as usize * self.width as usize + column as usize;
        self.coverage.get(index).copied().unwrap_or(0)
    }
}

/// Rasterises a glyph whose face is `face_height` pixels from descent to ascent, `shift` pixels to the right and down.
///
/// The rasteriser adds in f32 without fused operations, so the bytes are the same on every machine.
pub fn rasterise_glyph(
    font: &FontRef<'static>,
    glyph: GlyphId,
    face_height: f64,
    shift: [f64; 2],
) -> Mask {
    let placed = Glyph {
        id: glyph,
        scale: PxScale::from(face_height as f32),
        position: point(shift[0] as f32, shift[1] as f32),
    };
    let Some(outline) = font.outline_glyph(placed) else {
        return Mask::default(); // a space
    };
    let bounds = outline.px_bounds();
    let mut mask = Mask {
        left: bounds.min.x as i32,
        top: bounds.min.y as i32,
        width: bounds.width() as u32,
        height: bounds.height() as u32,
        coverage: Vec::new(),
    };
    mask.coverage = vec![0; mask.width as usize * mask.height as usize];
    outline.draw(|x, y, coverage| {
        let index = y as usize * mask.width as usize + x as usize;
        if let Some(value) = mask.coverage.get_mut(index) {
            *value = (coverage.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        }
    });
    mask
}

/// A hollow box on the baseline, as high as the capitals, for a character without glyph.
///
/// `advance` is the room it takes in pixels; `shift` moves it right and down by less than a pixel.
pub fn missing_box(size: f64, advance: f64, [right_by, down_by]: [f64; 2]) -> Mask {
    let stroke = (0.09 * size).max(1.0);
    let (left, right) = (right_by + 0.1 * advance, right_by + 0.9 * advance);
    let (top, bottom) = (down_by - size, down_by);
    let mut mask = Mask {
        left: left.floor() as i32,
        top: top.floor() as i32,
        width: 0,
        height: (bottom.ceil() - top.floor()) as u32,
        coverage: Vec::new(),
    };
    mask.width = (right.ceil() - left.floor()).max(1.0) as u32;
    for row in 0..mask.height {
        let y = f64::from(mask.top) + f64::from(row);
        for column in 0..mask.width {
            let x = f64::from(mask.left) + f64::from(column);
            let outer = pixel_overlap(x, left, right) * pixel_overlap(y, top, bottom);
            let inner = pixel_overlap(x, left + stroke, right - stroke)
                * pixel_overlap(y, top + stroke, bottom - stroke);
            mask.coverage.push(((outer - inner) * 255.0 + 0.5) as u8);
        }
    }
    mask
}

/// Length of the part of the pixel `start`..`start` + 1 that lies between `low` and `high`.
fn pixel_overlap(start: f64, low: f64, high: f64) -> f64 {
    (high.min(start + 1.0) - low.max(start)).clamp(0.0, 1.0)
}
