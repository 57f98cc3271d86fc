//! Loops as circular arrows with their letters, and frames as triads.

use super::ink::{Ink, WantedLabel};
use super::lettering::QuantityLettering;
use super::plane::{DrawingPlane, DrawnSpot, spot_ahead, spot_difference, spot_length};
use super::scheme::SchemeLink;
use crate::math::sin_cos;
use crate::sorting::sort_by_key;
use glam::DVec3;
use std::f64::consts::TAU;

/// Smallest and largest radius of a loop's arrow, and its clearance from links, in units of the drawing.
const RADII: [f64; 2] = [17.0, 46.0];
const FREE: f64 = 9.0;

/// Places across the box of a loop that are tried for its arrow.
const PLACES: usize = 28;

/// Angle that the arrow spans, from the bottom.
const ROUND: f64 = 0.86 * TAU;

/// Corners of an arrow.
const CORNERS: usize = 40;

/// Length of a triad's arrows.
const TRIAD: f64 = 34.0;

/// Draws loop number `index` as a round arrow where there is most room within it, in the sense of its chain.
pub fn draw_loop(
    name: &str,
    points: &[DVec3],
    index: usize,
    plane: &DrawingPlane,
    lettering: &QuantityLettering,
    ink: &mut Ink,
) {
    let corners: Vec<DrawnSpot> = points.iter().map(|p| plane.spot(*p)).collect();
    let (centre, room) = roomiest_place(&corners, plane, ink);
    let [least, most] = RADII.map(|r| r * ink.unit);
    let radius = (room - FREE * ink.unit).clamp(least, most);
    // On the sheet y points down: a positive area is walked clockwise.
    let sense = if signed_area(&corners) >= 0.0 {
        1.0
    } else {
        -1.0
    };
    let colour = ink.theme.colour(index + 2);
    let point = |k: usize| {
        let (sin, cos) =
            sin_cos(0.25 * TAU + sense * (0.07 * TAU + ROUND * k as f64 / CORNERS as f64));
        spot_ahead(centre, [cos, sin], radius)
    };
    let arc: Vec<DrawnSpot> = (0..=CORNERS).map(point).collect();
    ink.arrow(&arc, colour, 1.8);
    ink.reserve_circle(
        centre,
        (radius / ink.unit) * std::f64::consts::FRAC_1_SQRT_2,
    );
    let size = 1.5 * lettering.size;
    ink.letters.push((name.to_owned(), centre, size, colour));
}

/// The point within a polygon, or near a degenerate one, that is farthest from all lines, and its distance.
fn roomiest_place(corners: &[DrawnSpot], plane: &DrawingPlane, ink: &Ink) -> (DrawnSpot, f64) {
    let rim = plane.inside((RADII[0] + FREE) * ink.unit);
    let fold = |k: usize, pick: fn(f64, f64) -> f64, from: f64| {
        corners.iter().map(|c| c[k]).fold(from, pick)
    };
    let low = [0, 1].map(|k| fold(k, f64::min, f64::INFINITY));
    let high = [0, 1].map(|k| fold(k, f64::max, f64::NEG_INFINITY));
    let reach = (RADII[0] + FREE) * ink.unit;
    let middle = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
    let mut best = (f64::NEG_INFINITY, middle, 0.0);
    for i in 0..=PLACES {
        for j in 0..=PLACES {
            let share = |k: usize, at: usize| {
                let wide = high[k] - low[k] + 4.0 * reach;
                low[k] - 2.0 * reach + wide * at as f64 / PLACES as f64
            };
            let at = [share(0, i), share(1, j)];
            if !rim.contains(at) {
                continue;
            }
            // Outside only where there is no room inside; then near to it.
            let outside = match is_inside(at, corners) {
                true => 0.0,
                false => 0.8 * reach,
            };
            let far = 0.05 * spot_length(spot_difference(at, middle));
            let value = |room: f64| room - outside - 3.0 * (reach - room).max(0.0) - far;
            // Space beyond the size of the largest arrow has no further benefit.
            let most = (RADII[1] + FREE) * ink.unit;
            let room = ink.bins.room(at, most, |room| value(room) <= best.0);
            if value(room) > best.0 {
                best = (value(room), at, room);
            }
        }
    }
    (best.1, best.2)
}

/// Twice the area within a polygon, with its sense.
fn signed_area(corners: &[DrawnSpot]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let pieces = corners
        .iter()
        .zip(next)
        .map(|(a, b)| a[0] * b[1] - a[1] * b[0]);
    pieces.sum()
}

/// Whether a ray to the right crosses the polygon an odd number of times.
fn is_inside(at: DrawnSpot, corners: &[DrawnSpot]) -> bool {
    let next = corners.iter().cycle().skip(1);
    let crosses = |(a, b): &(&DrawnSpot, &DrawnSpot)| {
        (a[1] > at[1]) != (b[1] > at[1])
            && at[0] < a[0] + (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1])
    };
    corners.iter().zip(next).filter(crosses).count() % 2 == 1
}

/// An arrow of a triad, shared by all frames in which it is the same.
struct TriadArrow {
    origin: DrawnSpot,
    tip: DrawnSpot,
    text: String,
}

/// Draws the axes of all links' frames.
pub fn draw_frames(
    links: &[SchemeLink],
    plane: &DrawingPlane,
    lettering: &QuantityLettering,
    ink: &mut Ink,
) {
    let mut arrows: Vec<TriadArrow> = Vec::new();
    let mut ordered: Vec<&SchemeLink> = links.iter().filter(|link| link.is_shown).collect();
    sort_by_key(&mut ordered, |link| link.number);
    for link in ordered {
        let origin = plane.spot(link.frame.translation);
        for axis in 0..3 {
            let seen = plane.direction(link.frame.rotation.col(axis));
            let tip = spot_ahead(origin, seen, TRIAD * ink.unit);
            let text = lettering.symbol(&format!("{}{}", ["x", "y", "z"][axis], link.number));
            // Axes that look the same are drawn once, with both names.
            let same = |a: &&mut TriadArrow| {
                spot_length(spot_difference(a.origin, origin)) < ink.unit
                    && spot_length(spot_difference(a.tip, tip)) < 2.0 * ink.unit
            };
            match arrows.iter_mut().find(same) {
                Some(known) => known.text = format!("{}, {text}", known.text),
                None => arrows.push(TriadArrow { origin, tip, text }),
            }
        }
    }
    let colour = ink.theme.series[2];
    for arrow in arrows {
        // An axis that points to the viewer is a dot in a circle.
        let along = spot_difference(arrow.tip, arrow.origin);
        if spot_length(along) < 0.12 * TRIAD * ink.unit {
            ink.circle(arrow.origin, 4.5, ink.theme.background, colour, 1.2);
            ink.circle(arrow.origin, 1.2, colour, colour, 0.5);
        } else {
            ink.arrow(&[arrow.origin, arrow.tip], colour, 1.3);
        }
        ink.labels.push(WantedLabel {
            text: arrow.text,
            anchor: arrow.tip,
            wish: if spot_length(along) > 1.0 {
                along
            } else {
                [-0.7, 0.7]
            },
            size: lettering.size,
            colour,
            ringed: false,
            least: 0.0,
        });
    }
}
