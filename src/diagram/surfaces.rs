//! Surfaces in contact as outlines: a torus by its ring and the parallels of the ring, a sphere by its rim.

use super::ink::Ink;
use super::plane::{
    DrawingPlane, DrawnSpot, quarter_turn, spot_ahead, spot_difference, spot_length, unit_direction,
};
use super::scheme::SchemeSurface;
use crate::math::sin_cos;
use crate::plot::theme::{Colour, Dashes};
use std::f64::consts::TAU;

/// Corners of a round.
const CORNERS: usize = 720;

/// Half side of a plane and half length of a cylinder, in sizes of the mechanism.
const REACH: f64 = 0.35;

/// Draws the outline of a surface.
pub fn draw_surface(surface: &SchemeSurface, size: f64, plane: &DrawingPlane, ink: &mut Ink) {
    let colour = ink.theme.event;
    let sizes: Vec<f64> = surface.sizes.iter().map(|(_, value)| *value).collect();
    match (surface.word, sizes.as_slice()) {
        ("torus", [ring, tube]) => draw_torus(surface, *ring, *tube, plane, ink, colour),
        ("sphere", [radius]) => {
            let centre = plane.spot(surface.frame.translation);
            // A sphere looks like a circle in any parallel view.
            let rim = |k: usize| {
                let (sin, cos) = sin_cos(TAU * k as f64 / CORNERS as f64);
                spot_ahead(centre, [cos, sin], radius * plane.scale)
            };
            let rim: Vec<DrawnSpot> = (0..=CORNERS).map(rim).collect();
            ink.mark(&rim, colour, 1.0, Dashes::None);
        }
        ("cylinder", [radius]) => {
            // A cylinder by its two outermost lines, along its axis as seen.
            let seen = plane.direction(surface.frame.rotation.z_axis);
            let centre = plane.spot(surface.frame.translation);
            let side = unit_direction(quarter_turn(seen)).unwrap_or([1.0, 0.0]);
            for sign in [1.0, -1.0] {
                let edge = spot_ahead(centre, side, sign * radius * plane.scale);
                let ends =
                    [1.0, -1.0].map(|s| spot_ahead(edge, seen, s * REACH * size * plane.scale));
                ink.mark(&ends, colour, 1.0, Dashes::None);
            }
        }
        _ => {
            // A plane by a square around its origin.
            let corner = |k: usize| {
                let (x, y) = ([1.0, 1.0, -1.0, -1.0][k % 4], [1.0, -1.0, -1.0, 1.0][k % 4]);
                let r = &surface.frame.rotation;
                plane.spot(surface.frame.translation + (r.x_axis * x + r.y_axis * y) * REACH * size)
            };
            let square: Vec<DrawnSpot> = (0..=4).map(corner).collect();
            ink.mark(&square, colour, 1.0, Dashes::None);
        }
    }
}

/// The outline of a torus is the parallel curve of its projected ring, at the radius of the tube.
fn draw_torus(
    surface: &SchemeSurface,
    ring: f64,
    tube: f64,
    plane: &DrawingPlane,
    ink: &mut Ink,
    colour: Colour,
) {
    let frame = &surface.frame;
    let point = |k: usize| {
        let (sin, cos) = sin_cos(TAU * k as f64 / CORNERS as f64);
        plane.spot(
            frame.translation + (frame.rotation.x_axis * cos + frame.rotation.y_axis * sin) * ring,
        )
    };
    let circle: Vec<DrawnSpot> = (0..=CORNERS).map(point).collect();
    ink.mark(&circle, colour, 0.8, Dashes::Long);
    for sign in [1.0, -1.0] {
        let parallel: Vec<DrawnSpot> = (0..=CORNERS)
            .filter_map(|k| {
                let [before, after] = [(k + CORNERS - 1) % CORNERS, (k + 1) % CORNERS];
                let along = spot_difference(circle[after], circle[before]);
                let side =
                    unit_direction(quarter_turn(along)).filter(|_| spot_length(along) > 1e-9)?;
                Some(spot_ahead(circle[k], side, sign * tube * plane.scale))
            })
            .collect();
        ink.mark(&parallel, colour, 1.0, Dashes::None);
    }
}
