//! Straight strokes over a picture: lines of dimensions and scales, and their arrow heads.

use super::paint::OverlayPainter;
use crate::render::OverlayStroke;

/// Longer strokes, in pixels, cannot be visible as a whole.
const FARTHEST: f64 = 1e6;

/// Draws a stroke; its ends are cut square to it.
pub fn draw_stroke(painter: &mut OverlayPainter<'_>, stroke: &OverlayStroke) {
    let [from, to] = stroke.ends;
    if !from.iter().chain(&to).all(|c| c.abs() < FARTHEST) {
        return;
    }
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
    if length <= 0.0 {
        return;
    }
    let along = along.map(|c| c / length);
    let room = stroke.half_widths[0].max(stroke.half_widths[1]) + 1.0;
    let low = [0, 1].map(|k| (from[k].min(to[k]) - room).floor() as i32);
    let high = [0, 1].map(|k| (from[k].max(to[k]) + room).ceil() as i32);
    let [x0, y0, x1, y1] = painter.clip(low[0], low[1], high[0], high[1]);
    for y in y0..y1 {
        for x in x0..x1 {
            let off = [f64::from(x) + 0.5 - from[0], f64::from(y) + 0.5 - from[1]];
            let at = off[0] * along[0] + off[1] * along[1];
            let across = (off[0] * along[1] - off[1] * along[0]).abs();
            let share = (at / length).clamp(0.0, 1.0);
            let [first, last] = stroke.half_widths;
            let half = first + (last - first) * share;
            // The coverage of a line narrower than a pixel is at most its width.
            let covered = (half + 0.5 - across).clamp(0.0, (2.0 * half).min(1.0));
            let before_ends = (at + 0.5).min(length - at + 0.5).clamp(0.0, 1.0);
            painter.blend(x, y, stroke.colour, (covered * before_ends) as f32);
        }
    }
}
