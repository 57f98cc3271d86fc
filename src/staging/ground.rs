//! The ground under the motion.

use super::bounds;
use super::round_steps::nearest_round_length;
use crate::model::theme::Theme;
use crate::model::view::{GroundPlace, View};
use crate::render::Ground;
use glam::DVec3;

/// Distance of the ground below the lowest point, as a fraction of the motion's extent, so that nothing touches it.
const GROUND_GAP: f64 = 0.01;

/// Radius of the ground over half the extent of the motion.
const GROUND_REACH: f64 = 1.9;

/// Grid lines across the extent of the motion, about.
const GRID_LINES: f64 = 9.0;

/// The ground under the motion, or none.
pub fn view_ground(view: &View, points: &[DVec3], up: DVec3) -> Option<Ground> {
    let [low, high] = bounds::box_of(points)?;
    let extent = (high - low).length();
    let lowest = points
        .iter()
        .map(|p| p.dot(up))
        .fold(f64::INFINITY, f64::min);
    let height = match view.ground {
        GroundPlace::None => return None,
        GroundPlace::Auto => lowest - GROUND_GAP * extent,
        GroundPlace::At(height) => height,
    };
    let middle = (low + high) * 0.5;
    let centre = middle + up * (height - middle.dot(up));
    let radius = GROUND_REACH * 0.5 * extent;
    Some(Ground {
        centre,
        normal: up,
        radius,
        grid: nearest_round_length(extent / GRID_LINES),
        // Without a background nothing can be lighter than it.
        shade: if view.theme == Theme::Dark && !view.transparent {
            Ground::LIGHTER
        } else {
            Ground::DARKER
        },
    })
}
