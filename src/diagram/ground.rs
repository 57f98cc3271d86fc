//! The frame where it bears a joint: a short post on hatched ground, or a hatched rail under what slides.

use super::ink::Ink;
use super::plane::{
    DrawingPlane, DrawnSpot, quarter_turn, spot_ahead, spot_difference, spot_length, unit_direction,
};
use super::scheme::SchemeJoint;
use super::symbols::OUTLINE;
use crate::model::joints::JointKind;
use crate::plot::theme::Dashes;

/// Length of a post, half width of the ground under it, pitch and length of its hatching, in units of the drawing.
const POST: f64 = 24.0;
const HALF: f64 = 17.0;
const PITCH: f64 = 6.0;
const HATCH: f64 = 7.0;

/// Distance of a rail from the line on which its slider moves, and its length beyond the slider.
const RAIL: f64 = 12.5;
const BEYOND: f64 = 26.0;

/// Draws the ground of a joint whose sign is at `at`; the middle of the ground.
pub fn draw_ground(
    joint: &SchemeJoint,
    at: DrawnSpot,
    plane: &DrawingPlane,
    ink: &mut Ink,
) -> DrawnSpot {
    let axis = joint.axes.first().copied().unwrap_or_default();
    let seen = plane.direction(axis);
    if joint.kind == JointKind::Prismatic && spot_length(seen) > 0.15 {
        return draw_rail(joint, at, seen, plane, ink);
    }
    let down = freest_side(at, ink);
    let end = spot_ahead(at, down, POST * ink.unit);
    let text = ink.theme.text;
    ink.line(&[at, end], text, 1.3 * OUTLINE, Dashes::None);
    draw_hatched(end, quarter_turn(down), HALF * ink.unit, down, ink);
    end
}

/// The direction with the least drawing in it: down, if nothing is there.
fn freest_side(at: DrawnSpot, ink: &Ink) -> DrawnSpot {
    let directions = [[0.0, 1.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0]];
    let cost = |k: usize, d: DrawnSpot| {
        let far = spot_ahead(at, d, (POST + HATCH) * ink.unit);
        let side = spot_ahead([0.0; 2], quarter_turn(d), HALF * ink.unit);
        let base = [spot_ahead(far, side, 1.0), spot_ahead(far, side, -1.0)];
        let near = spot_ahead(at, d, 0.3 * POST * ink.unit);
        ink.covered([near, far], 4.0 * ink.unit)
            + ink.covered(base, 4.0 * ink.unit)
            + 3.0 * ink.unit * k as f64
    };
    let costs = directions
        .into_iter()
        .enumerate()
        .map(|(k, d)| (cost(k, d), d));
    costs
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or([0.0, 1.0], |best| best.1)
}

fn draw_rail(
    joint: &SchemeJoint,
    at: DrawnSpot,
    seen: DrawnSpot,
    plane: &DrawingPlane,
    ink: &mut Ink,
) -> DrawnSpot {
    let along = unit_direction(seen).unwrap_or([1.0, 0.0]);
    let side = quarter_turn(along);
    // Under the slider, or left of it.
    let down = if side[1] > 0.05 || (side[1].abs() <= 0.05 && side[0] < 0.0) {
        side
    } else {
        [-side[0], -side[1]]
    };
    let from = plane.spot(joint.from);
    let axis_line = [spot_ahead(from, along, 0.0), at];
    ink.line(&axis_line, ink.theme.event, 0.7, Dashes::Long);
    let middle = spot_ahead(at, down, RAIL * ink.unit);
    draw_hatched(middle, along, (BEYOND + 8.0) * ink.unit, down, ink);
    middle
}

/// A line through `middle` with hatching on the side of `down`.
fn draw_hatched(middle: DrawnSpot, along: DrawnSpot, half: f64, down: DrawnSpot, ink: &mut Ink) {
    let (unit_length, text) = (ink.unit, ink.theme.text);
    let ends = [
        spot_ahead(middle, along, -half),
        spot_ahead(middle, along, half),
    ];
    ink.line(&ends, text, OUTLINE, Dashes::None);
    let count = (2.0 * half / (PITCH * unit_length)) as usize;
    for k in 0..count {
        let from = spot_ahead(ends[0], along, (k as f64 + 0.7) * PITCH * unit_length);
        let slant = spot_difference(spot_ahead(down, along, -0.8), [0.0; 2]);
        ink.mark(
            &[from, spot_ahead(from, slant, 0.8 * HATCH * unit_length)],
            text,
            0.7,
            Dashes::None,
        );
    }
    let rim = 0.5 * HATCH * unit_length;
    let low = spot_ahead(middle, down, rim);
    ink.reserve_circle(low, 9.0);
}
