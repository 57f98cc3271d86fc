//! Plain rectangles and the leaders of labels.

use super::paint::OverlayPainter;
use crate::math::segment_distance;
use crate::render::Patch;

/// Half the width of a leader in pixels.
const LEADER_HALF_WIDTH: f64 = 0.6;

/// Draws a rectangle with edges between pixels.
pub fn draw_patch(painter: &mut OverlayPainter<'_>, patch: &Patch, picture: [f64; 2]) {
    let low = [0, 1].map(|k| patch.corner[k] * picture[k]);
    let high = [0, 1].map(|k| low[k] + patch.size[k] * picture[k]);
    if !low.iter().chain(&high).all(|edge| edge.abs() < 1e9) {
        return;
    }
    let [x0, y0, x1, y1] = painter.clip(
        low[0].floor() as i32,
        low[1].floor() as i32,
        high[0].ceil() as i32,
        high[1].ceil() as i32,
    );
    let cover = |at: u32, k: usize| {
        let start = f64::from(at);
        (high[k].min(start + 1.0) - low[k].max(start)).clamp(0.0, 1.0)
    };
    for y in y0..y1 {
        for x in x0..x1 {
            let share = cover(x, 0) * cover(y, 1) * patch.opacity;
            painter.blend(x, y, patch.colour, share as f32);
        }
    }
}

/// Draws a thin line between two places in pixels.
pub fn draw_leader(painter: &mut OverlayPainter<'_>, [from, to]: [[f64; 2]; 2], colour: [u8; 3]) {
    let low = [0, 1].map(|k| from[k].min(to[k]) - 2.0);
    let high = [0, 1].map(|k| from[k].max(to[k]) + 2.0);
    let [x0, y0, x1, y1] =
        painter.clip(low[0] as i32, low[1] as i32, high[0] as i32, high[1] as i32);
    for y in y0..y1 {
        for x in x0..x1 {
            let away = segment_distance([f64::from(x) + 0.5, f64::from(y) + 0.5], [from, to]);
            let share = (LEADER_HALF_WIDTH + 0.5 - away).clamp(0.0, 1.0);
            painter.blend(x, y, colour, share as f32);
        }
    }
}
