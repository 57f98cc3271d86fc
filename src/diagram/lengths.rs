//! Lengths with their names: dimension lines beside what they measure, or vectors along it.

use super::ink::{Ink, WantedLabel};
use super::lettering::{QuantityLettering, source_colour};
use super::plane::{
    DrawingPlane, DrawnSpot, quarter_turn, spot_ahead, spot_difference, spot_length, unit_direction,
};
use super::scheme::{QuantitySource, SchemeLength};
use crate::plot::theme::Dashes;

/// Distances of a dimension line from what it measures that are tried, in units of the drawing.
const ASIDE: [f64; 8] = [0.0, 17.0, 30.0, 43.0, 56.0, 69.0, 82.0, 95.0];

/// A dimension line is clear of anything farther away than this.
const FREE: f64 = 5.0;

/// Lines shorter than this have their heads outside.
const SHORT: f64 = 24.0;

/// Below this a length is seen end-on.
const END_ON: f64 = 2.5;

/// Cost per pixel that runs beside something else, in pixels of distance.
const COVERED: f64 = 3.0;

/// Width of dimension lines, and how far the lines to them reach beyond.
const THIN: f64 = 0.9;
const BEYOND: f64 = 4.0;

/// Draws a length beside its ends; `false` if it is seen end-on.
pub fn draw_dimension(
    length: &SchemeLength,
    plane: &DrawingPlane,
    lettering: &QuantityLettering,
    ink: &mut Ink,
) -> bool {
    let ends = [length.from, length.to].map(|p| plane.spot(p));
    let along = spot_difference(ends[1], ends[0]);
    let Some(direction) = unit_direction(along).filter(|_| spot_length(along) > END_ON * ink.unit)
    else {
        return false;
    };
    // The dimension line beside the length, where little is covered.
    let offset = cheapest_offset(length, ends, plane, ink);
    let colour = source_colour(length.source, &ink.theme);
    let line = ends.map(|end| spot_ahead(end, offset, 1.0));
    // Extension lines from the ends, if it is offset.
    if let Some(out) = unit_direction(offset) {
        let reach = spot_length(offset) + BEYOND * ink.unit;
        for end in ends {
            let to = spot_ahead(end, out, reach);
            ink.line(
                &[spot_ahead(end, out, 3.0 * ink.unit), to],
                colour,
                0.6 * THIN,
                Dashes::None,
            );
        }
    }
    // A short line has its heads outside, on tails.
    let outside = spot_length(along) < SHORT * ink.unit;
    let tail = if outside { 12.0 * ink.unit } else { 0.0 };
    ink.line(
        &[
            spot_ahead(line[0], direction, -tail),
            spot_ahead(line[1], direction, tail),
        ],
        colour,
        THIN,
        Dashes::None,
    );
    let sign = if outside { -1.0 } else { 1.0 };
    ink.head(line[1], spot_ahead([0.0; 2], direction, sign), colour);
    ink.head(line[0], spot_ahead([0.0; 2], direction, -sign), colour);
    // The value beside the middle of the line.
    let middle = spot_ahead(line[0], along, 0.5);
    let wish = unit_direction(offset).unwrap_or(quarter_turn(direction));
    ink.labels.push(WantedLabel {
        text: lettering.length(length),
        anchor: middle,
        wish,
        size: lettering.size,
        colour,
        ringed: false,
        least: 0.0,
    });
    true
}

/// Where a dimension line runs clear of everything else.
fn cheapest_offset(
    length: &SchemeLength,
    ends: [DrawnSpot; 2],
    plane: &DrawingPlane,
    ink: &Ink,
) -> DrawnSpot {
    let along = unit_direction(spot_difference(ends[1], ends[0])).unwrap_or([1.0, 0.0]);
    let mut sides: Vec<DrawnSpot> = vec![
        quarter_turn(along),
        spot_ahead([0.0; 2], quarter_turn(along), -1.0),
    ];
    for aside in length.aside {
        let seen = plane.direction(aside);
        let Some(d) = unit_direction(seen) else {
            continue;
        };
        // Extension lines cross the dimension line and do not run along it.
        if (d[0] * along[1] - d[1] * along[0]).abs() > 0.5 && spot_length(seen) > 0.3 {
            sides.extend([d, [-d[0], -d[1]]]);
        }
    }
    let mut best = (f64::INFINITY, [0.0, 0.0]);
    let inside = plane.inside(14.0 * ink.unit);
    for distance in ASIDE {
        for side in &sides {
            let offset = spot_ahead([0.0; 2], *side, distance * ink.unit);
            let line = ends.map(|end| spot_ahead(end, offset, 1.0));
            if line.iter().any(|end| !inside.contains(*end)) && distance > 0.0 {
                continue;
            }
            let covered = ink.covered(line, FREE * ink.unit);
            let cost = distance * ink.unit + COVERED * covered;
            if cost < best.0 {
                best = (cost, offset);
            }
            if distance == 0.0 {
                break;
            }
        }
    }
    best.1
}

/// Draws a length as a vector in place.
pub fn draw_vector(
    length: &SchemeLength,
    plane: &DrawingPlane,
    lettering: &QuantityLettering,
    ink: &mut Ink,
) -> bool {
    let ends = [length.from, length.to].map(|p| plane.spot(p));
    let along = spot_difference(ends[1], ends[0]);
    if spot_length(along) <= END_ON * ink.unit {
        return false;
    }
    let colour = match length.source {
        QuantitySource::Constant => ink.theme.series[0],
        source => source_colour(source, &ink.theme),
    };
    ink.arrow(&ends, colour, 2.6);
    ink.labels.push(WantedLabel {
        text: lettering.length(length),
        anchor: spot_ahead(ends[0], along, 0.5),
        wish: quarter_turn(along),
        size: 1.1 * lettering.size,
        colour,
        ringed: false,
        least: 2.0,
    });
    true
}
