//! Joint symbols after ISO 3952, as short solids in space drawn from the drawing's viewpoint: seen along its axis a
//! pair is the circle of the standard, from the side it is the bearing.

use super::ink::Ink;
use super::plane::{
    DrawingPlane, DrawnSpot, quarter_turn, spot_ahead, spot_length, unit_direction,
};
use super::scheme::SchemeJoint;
use crate::model::joints::JointKind;
use crate::plot::theme::Dashes;
use crate::sorting::sort_by;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Radius of pins and bearings, in units of the drawing.
const PIN: f64 = 7.5;

/// Half lengths of a bearing, and of what also slides.
const SHORT: f64 = 11.0;
const LONG: f64 = 20.0;

/// Width of outlines.
pub const OUTLINE: f64 = 1.6;

/// Radius of what labels keep away from.
const CLEAR: f64 = 15.0;

/// Corners of a round.
const CORNERS: usize = 40;

/// Draws the symbol of a joint at `at`; `away` is the direction of the link behind it.
pub fn draw_joint(
    joint: &SchemeJoint,
    at: DrawnSpot,
    away: DrawnSpot,
    plane: &DrawingPlane,
    ink: &mut Ink,
) {
    let Some(axis) = joint.axes.first() else {
        return;
    };
    match joint.kind {
        JointKind::Revolute => {
            draw_cylinder(at, *axis, SHORT, plane, ink);
            draw_collars(at, *axis, SHORT, plane, ink);
        }
        JointKind::Cylindrical => draw_cylinder(at, *axis, LONG, plane, ink),
        JointKind::Helical => {
            draw_cylinder(at, *axis, LONG, plane, ink);
            draw_thread(at, *axis, plane, ink);
        }
        JointKind::Prismatic | JointKind::Planar => draw_slider(at, *axis, plane, ink),
        JointKind::Universal => draw_cross(at, &joint.axes, plane, ink),
        JointKind::Spherical => draw_ball(at, away, ink),
    }
    ink.reserve_circle(at, CLEAR);
}

/// Half the length of a joint's sign along its first axis, in pixels.
pub fn half_length(joint: &SchemeJoint, plane: &DrawingPlane, unit: f64) -> f64 {
    let seen = joint
        .axes
        .first()
        .map_or(1.0, |a| spot_length(plane.direction(*a)));
    match joint.kind {
        JointKind::Cylindrical | JointKind::Helical => seen * LONG * unit,
        JointKind::Revolute => seen * SHORT * unit,
        _ => PIN * unit,
    }
}

/// An ellipse: a disc of radius `r` pixels square to `axis`.
fn axis_disc(at: DrawnSpot, axis: DVec3, r: f64, plane: &DrawingPlane) -> Vec<DrawnSpot> {
    let seen = plane.direction(axis);
    let along = unit_direction(seen).unwrap_or([1.0, 0.0]);
    let thin = plane.nearness(axis).abs().min(1.0);
    let side = quarter_turn(along);
    let point = |k: usize| {
        let (sin, cos) = crate::math::sin_cos(TAU * k as f64 / CORNERS as f64);
        spot_ahead(spot_ahead(at, side, r * cos), along, r * thin * sin)
    };
    (0..CORNERS).map(point).collect()
}

fn draw_cylinder(at: DrawnSpot, axis: DVec3, half: f64, plane: &DrawingPlane, ink: &mut Ink) {
    let (r, h) = (PIN * ink.unit, half * ink.unit);
    let front = if plane.nearness(axis) < 0.0 {
        -axis
    } else {
        axis
    };
    let seen = plane.direction(front);
    let [near, far] = [1.0, -1.0].map(|s| axis_disc(spot_ahead(at, seen, s * h), axis, r, plane));
    let outline = convex_hull(&[near.clone(), far].concat());
    let (paper, text) = (ink.theme.background, ink.theme.text);
    ink.shape(&outline, paper, text, OUTLINE);
    let closed: Vec<DrawnSpot> = near.iter().chain(near.first()).copied().collect();
    ink.mark(&closed, text, 0.7 * OUTLINE, Dashes::None);
}

/// Discs at both ends of a bearing: nothing slides.
fn draw_collars(at: DrawnSpot, axis: DVec3, half: f64, plane: &DrawingPlane, ink: &mut Ink) {
    let seen = plane.direction(axis);
    if spot_length(seen) < 0.2 {
        return;
    }
    let Some(side) = unit_direction(quarter_turn(seen)) else {
        return;
    };
    let text = ink.theme.text;
    for sign in [1.0, -1.0] {
        let end = spot_ahead(at, seen, sign * half * ink.unit);
        let reach = 1.55 * PIN * ink.unit;
        ink.mark(
            &[spot_ahead(end, side, reach), spot_ahead(end, side, -reach)],
            text,
            OUTLINE,
            Dashes::None,
        );
    }
}

fn draw_thread(at: DrawnSpot, axis: DVec3, plane: &DrawingPlane, ink: &mut Ink) {
    let seen = plane.direction(axis);
    let Some(side) = unit_direction(quarter_turn(seen)) else {
        return;
    };
    let (r, text) = (PIN * ink.unit, ink.theme.text);
    for k in [-1.0, 0.0, 1.0] {
        let middle = spot_ahead(at, seen, 11.0 * k * ink.unit);
        let (a, b) = (
            spot_ahead(middle, seen, -4.0 * ink.unit),
            spot_ahead(middle, seen, 4.0 * ink.unit),
        );
        ink.mark(
            &[spot_ahead(a, side, r), spot_ahead(b, side, -r)],
            text,
            0.8 * OUTLINE,
            Dashes::None,
        );
    }
}

/// A block that slides along its axis.
fn draw_slider(at: DrawnSpot, axis: DVec3, plane: &DrawingPlane, ink: &mut Ink) {
    let toward = plane.viewer_direction();
    let side = axis.cross(toward).normalize_or(DVec3::X);
    let third = axis.cross(side).normalize_or(DVec3::Y);
    let (half, r) = (0.85 * LONG * ink.unit, 1.15 * PIN * ink.unit);
    let corner = |k: usize| {
        let s = [0, 1, 2].map(|bit| if k >> bit & 1 == 1 { 1.0 } else { -1.0 });
        let v = axis * (half * s[0]) + side * (r * s[1]) + third * (r * s[2]);
        (spot_ahead(at, plane.direction(v), 1.0), plane.nearness(v))
    };
    let corners: Vec<(DrawnSpot, f64)> = (0..8).map(corner).collect();
    let spots: Vec<DrawnSpot> = corners.iter().map(|c| c.0).collect();
    let (paper, text) = (ink.theme.background, ink.theme.text);
    ink.shape(&convex_hull(&spots), paper, text, OUTLINE);
    let nearest = (0..8)
        .max_by(|a, b| corners[*a].1.total_cmp(&corners[*b].1))
        .unwrap_or(0);
    // Seen square to a face, only that face is visible.
    if plane.nearness(axis).abs() > 0.05 {
        for bit in 0..3 {
            ink.mark(
                &[spots[nearest], spots[nearest ^ (1 << bit)]],
                text,
                0.7 * OUTLINE,
                Dashes::None,
            );
        }
    }
}

fn draw_cross(at: DrawnSpot, axes: &[DVec3], plane: &DrawingPlane, ink: &mut Ink) {
    let (paper, text) = (ink.theme.background, ink.theme.text);
    ink.circle(at, 1.3 * PIN, paper, text, OUTLINE);
    for axis in axes.iter().take(2) {
        let seen = plane.direction(*axis);
        let reach = 1.3 * PIN * ink.unit;
        let ends = [1.0, -1.0].map(|s| spot_ahead(at, seen, s * reach));
        ink.mark(&ends, text, OUTLINE, Dashes::None);
        for end in ends {
            ink.circle(end, 1.8, text, text, 0.5);
        }
    }
}

/// A ball in its socket, open towards the link that carries the ball.
fn draw_ball(at: DrawnSpot, away: DrawnSpot, ink: &mut Ink) {
    let (paper, text) = (ink.theme.background, ink.theme.text);
    let open = unit_direction(away).unwrap_or([0.0, -1.0]);
    let begin = libm::atan2(open[1], open[0]) + 0.32 * PI;
    let r = 1.6 * PIN * ink.unit;
    let point = |k: usize| {
        let (sin, cos) =
            crate::math::sin_cos(begin + (TAU - 0.64 * PI) * k as f64 / CORNERS as f64);
        spot_ahead(at, [cos, sin], r)
    };
    let arc: Vec<DrawnSpot> = (0..=CORNERS).map(point).collect();
    ink.circle(at, 1.6 * PIN, paper, paper, 0.5);
    ink.mark(&arc, text, OUTLINE, Dashes::None);
    ink.circle(at, PIN, paper, text, OUTLINE);
}

/// The convex hull of points, in order (monotone chain).
pub fn convex_hull(points: &[DrawnSpot]) -> Vec<DrawnSpot> {
    let mut sorted = points.to_vec();
    sort_by(&mut sorted, |a, b| {
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    let half = |list: &mut dyn Iterator<Item = &DrawnSpot>| {
        let mut chain: Vec<DrawnSpot> = Vec::new();
        for p in list {
            while let [.., a, b] = chain[..] {
                let turn = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
                if turn > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(*p);
        }
        chain.pop();
        chain
    };
    let mut whole = half(&mut sorted.iter());
    whole.extend(half(&mut sorted.iter().rev()));
    whole
}
