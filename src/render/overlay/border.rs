//! The hatched border that marks a picture without a pose.

use super::paint::OverlayPainter;

/// Width of the band in 480ths of the picture's shorter side, and its least width in pixels.
const BAND_PER_480: u32 = 16;
const BAND_LEAST: u32 = 4;

/// Distance from stripe to stripe along a row, in band widths.
const PITCH_IN_BANDS: u32 = 2;

/// Colours of the stripes, sRGB: the amber and the near black of warning tape.
const AMBER: [u8; 3] = [0xf2, 0xa9, 0x1c];
const DARK: [u8; 3] = [0x2e, 0x2c, 0x2a];

/// Both.
pub const COLOURS: [[u8; 3]; 2] = [AMBER, DARK];

/// Draws the band along the four edges.
pub fn draw_border(painter: &mut OverlayPainter) {
    let [width, height] = painter.size();
    let band = (width.min(height) / 480 * BAND_PER_480
        + width.min(height) % 480 * BAND_PER_480 / 480)
        .max(BAND_LEAST);
    for y in painter.rows() {
        let in_rows = y < band || y >= height.saturating_sub(band);
        if in_rows {
            for x in 0..width {
                paint_pixel(painter, x, y, band);
            }
            continue;
        }
        for x in (0..band.min(width)).chain(width.saturating_sub(band).max(band.min(width))..width)
        {
            paint_pixel(painter, x, y, band);
        }
    }
}

fn paint_pixel(painter: &mut OverlayPainter<'_>, x: u32, y: u32, band: u32) {
    painter.blend(x, y, DARK, 1.0);
    painter.blend(x, y, AMBER, stripe_coverage(x, y, band * PITCH_IN_BANDS));
}

/// How much of a pixel the amber half of the stripes covers; they run at 45 degrees, `pitch` pixels apart along
/// a row. The edge is a ramp one pixel wide across the stripe.
fn stripe_coverage(x: u32, y: u32, pitch: u32) -> f32 {
    let along = (u64::from(x) + u64::from(y) + 1) % u64::from(pitch);
    // Distance along the row from the middle of the amber half, at most half a pitch.
    let off = (along as f32 - 0.25 * pitch as f32).abs();
    let off = off.min(pitch as f32 - off);
    // Across the stripe a row's pixel is 1/√2 wide.
    let across = (0.25 * pitch as f32 - off) * std::f32::consts::FRAC_1_SQRT_2;
    (across + 0.5).clamp(0.0, 1.0)
}
