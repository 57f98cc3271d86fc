//! The translucent plate with round corners behind a label.

use super::paint::OverlayPainter;
use crate::render::text::Setting;

/// Room around the text in heights of the capitals; covers the accents above and the tails below.
const PADDING: f64 = 0.6;

/// Radius of the corners in heights of the capitals.
const CORNER: f64 = 0.45;

/// Opacity of the plate: text stays readable over anything, and the scene remains visible.
const OPACITY: f32 = 0.82;

/// Room in pixels between a plate's edge and the text of capitals `size` pixels high.
pub fn plate_padding(size: f64) -> f64 {
    (PADDING * size).ceil()
}

/// Draws the plate of a text whose first pixel is `corner`.
pub fn draw_plate(
    painter: &mut OverlayPainter<'_>,
    setting: &Setting,
    corner: [i32; 2],
    colour: [u8; 3],
) {
    let pad = plate_padding(setting.size);
    let half = [
        0.5 * setting.width.ceil() + pad,
        0.5 * setting.height.ceil() + pad,
    ];
    let start = [f64::from(corner[0]) - pad, f64::from(corner[1]) - pad];
    let middle = [start[0] + half[0], start[1] + half[1]];
    let radius = (CORNER * setting.size).min(half[0]).min(half[1]);
    let [x0, y0, x1, y1] = painter.clip(
        start[0] as i32,
        start[1] as i32,
        (start[0] + 2.0 * half[0]) as i32,
        (start[1] + 2.0 * half[1]) as i32,
    );
    for y in y0..y1 {
        let v = f64::from(y) + 0.5 - middle[1];
        for x in x0..x1 {
            let u = f64::from(x) + 0.5 - middle[0];
            let coverage = (0.5 - distance_outside([u, v], half, radius)).clamp(0.0, 1.0);
            painter.blend(x, y, colour, OPACITY * coverage as f32);
        }
    }
}

/// Signed distance of a point from a rectangle of half size `half` with corners of `radius`, around the origin.
fn distance_outside(point: [f64; 2], half: [f64; 2], radius: f64) -> f64 {
    let u = point[0].abs() - half[0] + radius;
    let v = point[1].abs() - half[1] + radius;
    let corner = (u.max(0.0) * u.max(0.0) + v.max(0.0) * v.max(0.0)).sqrt();
    corner + u.max(v).min(0.0) - radius
}
