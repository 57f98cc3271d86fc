//! Links as lines between the symbols of their joints, and the placement of these symbols.

use super::ink::{Ink, WantedLabel};
use super::lettering::QuantityLettering;
use super::plane::{
    DrawingPlane, DrawnSpot, quarter_turn, spot_ahead, spot_difference, spot_length, unit_direction,
};
use super::scheme::{Scheme, SchemeJoint};
use super::symbols::{convex_hull, half_length};
use crate::model::joints::JointKind;
use crate::plot::primitive::DrawnPrimitive;
use crate::plot::theme::{Colour, Dashes};
use crate::sorting::sort_by_key;
use glam::DVec3;

/// Width of a link's line.
const LINE: f64 = 3.4;

/// Symbols closer than this are moved apart, along the axes on which they are free to move.
const APART: f64 = 12.0;

/// Free pixels between two signs on one axis, in units of the drawing.
const BETWEEN: f64 = 9.0;

/// Where the symbol of every joint stands: on its axis, and clear of other symbols if it may be moved.
pub fn sign_places(scheme: &Scheme, plane: &DrawingPlane, unit_length: f64) -> Vec<DrawnSpot> {
    let joints = &scheme.joints;
    let mut spots: Vec<DrawnSpot> = joints.iter().map(|j| plane.spot(j.at)).collect();
    // Those on the frame move first, and those that have a point do not.
    let mut order: Vec<usize> = (0..joints.len()).collect();
    sort_by_key(&mut order, |k| (!joints[*k].links.contains(&0), *k));
    for k in order {
        let near = |other: usize, spots: &[DrawnSpot]| {
            other != k && spot_length(spot_difference(spots[other], spots[k])) < APART * unit_length
        };
        let Some(other) = (0..joints.len()).find(|o| near(*o, &spots)) else {
            continue;
        };
        if let Some(along) = slide_direction(&joints[k], plane) {
            let [own, its] = [k, other].map(|j| half_length(&joints[j], plane, unit_length));
            let seen = plane.direction(joints[other].axes.first().copied().unwrap_or_default());
            // A symbol that lies across takes little space along this axis.
            let parallel =
                unit_direction(seen).map_or(0.0, |d| (d[0] * along[0] + d[1] * along[1]).abs());
            let room = own + its * parallel + (BETWEEN + 8.0 * (1.0 - parallel)) * unit_length;
            let inward = links_middle(scheme, k, plane);
            let side = spot_difference(inward, spots[k]);
            let sign = if side[0] * along[0] + side[1] * along[1] > 0.0 {
                -1.0
            } else {
                1.0
            };
            spots[k] = spot_ahead(spots[k], along, sign * room);
        }
    }
    spots
}

/// The direction in the drawing in which a sign may be moved: that of its axis, unless it is seen end-on.
fn slide_direction(joint: &SchemeJoint, plane: &DrawingPlane) -> Option<DrawnSpot> {
    let may = matches!(
        joint.kind,
        JointKind::Revolute | JointKind::Cylindrical | JointKind::Helical
    );
    let seen = plane.direction(*joint.axes.first()?);
    unit_direction(seen).filter(|_| may && spot_length(seen) > 0.3)
}

/// The middle of all joints on the links that a joint connects.
fn links_middle(scheme: &Scheme, index: usize, plane: &DrawingPlane) -> DrawnSpot {
    let links = scheme.joints[index].links;
    let on = |j: &&SchemeJoint| j.links.iter().any(|l| *l != 0 && links.contains(l));
    let spots: Vec<DrawnSpot> = scheme
        .joints
        .iter()
        .filter(on)
        .map(|j| plane.spot(j.at))
        .collect();
    let share = 1.0 / spots.len().max(1) as f64;
    spots.iter().fold([0.0; 2], |m, p| spot_ahead(m, *p, share))
}

/// Where a link reaches a joint: the frame of a sliding joint reaches the begin of its guide.
fn reached_place(joint: &SchemeJoint, link: usize) -> DVec3 {
    let slides_first = joint.links[1] == 0;
    match (joint.links[0] == link) == slides_first {
        true => joint.at,
        false => joint.from,
    }
}

/// Draws all links but the frame.
pub fn draw_links(
    scheme: &Scheme,
    signs: &[DrawnSpot],
    plane: &DrawingPlane,
    is_plane: bool,
    ink: &mut Ink,
) {
    let text = ink.theme.text;
    for (index, link) in scheme.links.iter().enumerate().skip(1) {
        let own = scheme.joints.iter().filter(|j| j.links.contains(&index));
        let points = scheme.points.iter().filter(|p| p.2 == link.number);
        let ends: Vec<DrawnSpot> = own
            .map(|j| plane.spot(reached_place(j, index)))
            .chain(points.map(|p| plane.spot(p.1)))
            .collect();
        let ends = distinct_spots(ends);
        let paths: Vec<Vec<DrawnSpot>> = link.paths.iter().map(|p| shown_path(p, plane)).collect();
        if is_plane && ends.len() > 2 {
            draw_plate(&ends, text, ink);
        } else if is_plane && ends.len() == 2 {
            ink.line(&ends, text, LINE, Dashes::None);
        } else {
            paths
                .iter()
                .for_each(|path| ink.line(path, text, LINE, Dashes::None));
        }
    }
    for (joint, sign) in scheme.joints.iter().zip(signs) {
        let at = plane.spot(joint.at);
        if spot_length(spot_difference(at, *sign)) > 0.5 {
            ink.line(&[at, *sign], text, LINE, Dashes::None);
        }
        // The guide of a slider is a part of the link that it slides on.
        if joint.from != joint.at && !joint.links.contains(&0) {
            ink.line(
                &[plane.spot(joint.from), at],
                text,
                0.8 * LINE,
                Dashes::None,
            );
        }
    }
}

/// Pixels within which two spots are one.
const ONE_SPOT: f64 = 0.5;

/// Whether two spots are drawn as one.
pub fn is_one_spot(a: DrawnSpot, b: DrawnSpot) -> bool {
    spot_length(spot_difference(a, b)) < ONE_SPOT
}

/// The spots, without those where an earlier one is.
fn distinct_spots(spots: Vec<DrawnSpot>) -> Vec<DrawnSpot> {
    let mut kept: Vec<DrawnSpot> = Vec::new();
    for spot in spots {
        if !kept.iter().any(|other| is_one_spot(*other, spot)) {
            kept.push(spot);
        }
    }
    kept
}

/// A link with three joints and more: a plate.
fn draw_plate(ends: &[DrawnSpot], text: Colour, ink: &mut Ink) {
    let outline = convex_hull(ends);
    if outline.len() > 2 {
        let [r, g, b, _] = text;
        ink.primitives.push(DrawnPrimitive::Region {
            points: outline.clone(),
            fill: [r, g, b, 26],
        });
    }
    let closed: Vec<DrawnSpot> = outline.iter().chain(outline.first()).copied().collect();
    ink.line(&closed, text, 0.8 * LINE, Dashes::None);
}

/// Two pieces of a path whose directions are opposite up to this (one and their cosine) lie on each other.
const BACK: f64 = 1e-3;

/// The corners of a path if it never reverses; else only its ends.
fn shown_path(path: &[DVec3], plane: &DrawingPlane) -> Vec<DrawnSpot> {
    let pieces = path.windows(2).map(|p| (p[1] - p[0]).normalize_or_zero());
    let pieces: Vec<DVec3> = pieces.collect();
    let returns = |(k, a): (usize, &DVec3)| pieces[k + 1..].iter().any(|b| a.dot(*b) < BACK - 1.0);
    let ends = [path.first(), path.last()];
    match pieces.iter().enumerate().any(returns) {
        true => ends.into_iter().flatten().map(|p| plane.spot(*p)).collect(),
        false => path.iter().map(|p| plane.spot(*p)).collect(),
    }
}

/// Numbers of all links in circles.
pub fn number_links(
    scheme: &Scheme,
    (signs, grounds): (&[DrawnSpot], &[DrawnSpot]),
    (plane, is_plane): (&DrawingPlane, bool),
    lettering: &QuantityLettering,
    ink: &mut Ink,
) {
    let shown = scheme.links.iter().enumerate();
    for (index, link) in shown.filter(|(_, link)| link.is_shown) {
        let (anchor, wish) = match index {
            0 => (grounds.first().copied(), [0.9, 0.5]),
            _ => number_place(scheme, index, signs, plane, is_plane),
        };
        let Some(anchor) = anchor else { continue };
        ink.labels.push(WantedLabel {
            text: link.number.to_string(),
            anchor,
            wish,
            size: 1.05 * lettering.size,
            colour: ink.theme.text,
            ringed: true,
            least: if index == 0 { 12.0 } else { 4.0 },
        });
    }
}

/// The middle of a link's longest line, else one of its symbols.
fn number_place(
    scheme: &Scheme,
    index: usize,
    signs: &[DrawnSpot],
    plane: &DrawingPlane,
    is_plane: bool,
) -> (Option<DrawnSpot>, DrawnSpot) {
    let lines = |spots: Vec<DrawnSpot>| -> Vec<[DrawnSpot; 2]> {
        spots.windows(2).map(|s| [s[0], s[1]]).collect()
    };
    let own = (0..signs.len()).filter(|k| scheme.joints[*k].links.contains(&index));
    let ends: Vec<DrawnSpot> = own.map(|k| signs[k]).collect();
    let paths = scheme.links[index].paths.iter();
    let mut pieces: Vec<[DrawnSpot; 2]> = paths.flat_map(|p| lines(shown_path(p, plane))).collect();
    // Plates and bars of a plane go straight from sign to sign.
    if pieces.is_empty() || is_plane && ends.len() > 1 {
        pieces = lines(ends.clone());
    }
    let length = |s: &[DrawnSpot; 2]| spot_length(spot_difference(s[1], s[0]));
    let long = pieces
        .into_iter()
        .max_by(|a, b| length(a).total_cmp(&length(b)));
    match long {
        Some([a, b]) => (
            Some(spot_ahead(a, spot_difference(b, a), 0.42)),
            quarter_turn(spot_difference(b, a)),
        ),
        None => (ends.first().copied(), [0.7, -0.7]),
    }
}

/// From the symbol of a joint to the rest of the link behind it.
pub fn leaving_direction(
    scheme: &Scheme,
    index: usize,
    signs: &[DrawnSpot],
    plane: &DrawingPlane,
) -> DrawnSpot {
    let joint = &scheme.joints[index];
    let behind = joint.links[1];
    let others =
        (0..signs.len()).filter(|k| *k != index && scheme.joints[*k].links.contains(&behind));
    let far = others
        .map(|k| spot_difference(signs[k], signs[index]))
        .find(|d| spot_length(*d) > 1.0);
    far.unwrap_or_else(|| plane.direction(DVec3::Z))
}
