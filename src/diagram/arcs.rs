//! Angles as arcs in space, from where they are measured to where they lead.

use super::ink::{Ink, WantedLabel};
use super::lettering::{QuantityLettering, source_colour};
use super::plane::{DrawingPlane, DrawnSpot, spot_ahead, spot_difference, spot_length};
use super::scheme::{QuantitySource, SchemeAngle};
use crate::math::sin_cos;
use crate::plot::theme::Dashes;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Radius of the first arc about a place, and the increment of every further one, in units of the drawing.
const RADIUS: f64 = 27.0;
const STEP: f64 = 10.0;

/// The lines from which, and to which, an angle is measured reach so far beyond its arc.
const BEYOND: f64 = 9.0;

/// An arc of one turn or more is drawn up to this angle.
const MOST: f64 = 0.97 * TAU;

/// Corners of an arc.
const CORNERS: usize = 48;

/// Draws an angle; `level` is the number of arcs already drawn about its place.
pub fn draw_angle(
    angle: &SchemeAngle,
    level: usize,
    plane: &DrawingPlane,
    lettering: &QuantityLettering,
    ink: &mut Ink,
) {
    let radius = (RADIUS + STEP * level as f64) * ink.unit;
    let centre = plane.spot(angle.at);
    let colour = source_colour(angle.source, &ink.theme);
    // The arc in space: it turns from zero about the axis, and is seen as an ellipse.
    let across = angle.axis.cross(angle.zero);
    let shown = wrapped_angle(angle);
    let direction = |share: f64| {
        let (sin, cos) = sin_cos(shown * share);
        plane.direction(angle.zero * cos + across * sin)
    };
    let arc: Vec<DrawnSpot> = (0..=CORNERS)
        .map(|k| spot_ahead(centre, direction(k as f64 / CORNERS as f64), radius))
        .collect();
    // Dashed lines where the angle begins and ends.
    for share in [0.0, 1.0] {
        let from = spot_ahead(centre, direction(share), 0.35 * radius);
        let to = spot_ahead(centre, direction(share), radius + BEYOND * ink.unit);
        ink.line(&[from, to], colour, 0.7, Dashes::Short);
    }
    draw_arc(&arc, shown * radius, colour, ink);
    // The label at the middle of the arc, away from the centre.
    let middle = spot_ahead(centre, direction(0.5), radius);
    ink.labels.push(WantedLabel {
        text: lettering.angle(angle),
        anchor: middle,
        wish: spot_difference(middle, centre),
        size: lettering.size,
        colour,
        ringed: false,
        least: 0.0,
    });
}

fn draw_arc(arc: &[DrawnSpot], length: f64, colour: [u8; 4], ink: &mut Ink) {
    ink.line(arc, colour, 1.1, Dashes::None);
    // An arrowhead longer than its arc is left out.
    let [.., _, tip] = arc else { return };
    if length.abs() > 11.0 * ink.unit {
        let back = arc
            .iter()
            .rev()
            .find(|p| spot_length(spot_difference(*tip, **p)) > 6.0 * ink.unit);
        if let Some(back) = back {
            ink.head(*tip, spot_difference(*tip, *back), colour);
        }
    }
}

/// An angle as drawn: a driven angle as far as it has moved within its turn, a dependent one the shorter way.
fn wrapped_angle(angle: &SchemeAngle) -> f64 {
    let within = angle.value % TAU;
    let short = match angle.source {
        QuantitySource::Unknown if within > PI => within - TAU,
        QuantitySource::Unknown if within < -PI => within + TAU,
        _ => within,
    };
    short.clamp(-MOST, MOST)
}

/// How many of the first angles have the same vertex as the one at `index`.
pub fn arc_level(angles: &[SchemeAngle], index: usize, plane: &DrawingPlane, near: f64) -> usize {
    let at = |place: DVec3| plane.spot(place);
    let own = at(angles[index].at);
    let earlier = angles[..index].iter();
    earlier
        .filter(|a| spot_length(spot_difference(at(a.at), own)) < near)
        .count()
}
