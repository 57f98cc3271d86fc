//! Links of a scene without bodies: rods between the positions of their joints, and the space they occupy.

use super::axis_places::{axis_shifts, joint_points};
use super::floating::floating_joints;
use super::joints;
use super::sign_solids::link_colour;
use super::spherical_links::SphericalLinkage;
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::bar_ends::BarEnds;
use crate::model::mechanism::Mechanism;
use crate::model::shape::Solid;
use crate::sorting::sort_by_number;
use glam::DVec3;

/// Positions nearer together than this fraction of a rod's radius count as one.
const SAME: f64 = 1e-3;

/// Places that leave a line by less than this share of its length lie on it.
const FLAT: f64 = 1e-6;

/// A link that is drawn: its number in the table of links, its solids in the link's frame, its colour.
pub struct DrawnLink {
    /// Index of the link.
    pub link: usize,
    /// Rods between the places of its joints.
    pub solids: Vec<Solid>,
    /// sRGB.
    pub colour: [u8; 3],
}

/// All links with two joints or more except the frame, which is drawn as ground; rods have the radius `radius`. Ends of bars count
/// as joints.
pub fn drawn_links(mechanism: &Mechanism, radius: f64) -> Vec<DrawnLink> {
    let table = &mechanism.joints;
    let ends = BarEnds::new(mechanism);
    let mut places: Vec<Vec<DVec3>> = vec![Vec::new(); table.links.len()];
    let joints = table.list.iter().zip(axis_shifts(mechanism));
    let joints = joints
        .zip(floating_joints(mechanism))
        .filter(|(_, floats)| !floats);
    let joints = joints.filter(|((joint, _), _)| !ends.place_joint(joint));
    let joined = joints.flat_map(|((joint, shift), _)| joint_points(joint, shift));
    for (link, place) in joined.chain(ends.carried()).chain(ends.traced()) {
        let known = &mut places[link];
        if link != 0 && known.iter().all(|p| p.distance(place) > SAME * radius) {
            known.push(place);
        }
    }
    let links = places.iter().enumerate().skip(1);
    let links = links.filter_map(|(link, places)| {
        let solids = rods_between(places, radius);
        (!solids.is_empty()).then_some((link, solids))
    });
    let numbered = links.enumerate().map(|(k, (link, solids))| DrawnLink {
        link,
        solids,
        colour: link_colour(k),
    });
    numbered.collect()
}

/// Rods from place to place: along a line, or around their middle as a closed polygon.
pub fn rods_between(places: &[DVec3], radius: f64) -> Vec<Solid> {
    let (places, is_closed) = in_order(places);
    let count = places.len();
    let rods = count.saturating_sub(usize::from(!is_closed));
    let rod = |k: usize| Solid::Capsule {
        from: places[k],
        to: places[(k + 1) % count],
        radius,
    };
    (0..rods).map(rod).collect()
}

/// Places in the order in which rods join them, and whether the last is joined to the first.
fn in_order(places: &[DVec3]) -> (Vec<DVec3>, bool) {
    let mut places = places.to_vec();
    let middle = places.iter().sum::<DVec3>() / places.len().max(1) as f64;
    let farthest = |from: DVec3| {
        let others = places.iter().map(|p| *p - from);
        others
            .max_by(|a, b| a.length().total_cmp(&b.length()))
            .unwrap_or_default()
    };
    let along = farthest(middle);
    let normals = places.iter().map(|p| along.cross(*p - middle));
    let normal = normals
        .max_by(|a, b| a.length().total_cmp(&b.length()))
        .unwrap_or_default();
    if normal.length() <= FLAT * along.length_squared() {
        sort_by_number(&mut places, |a| a.dot(along));
        return (places, false);
    }
    let (first, second) = (along.normalize(), normal.cross(along).normalize());
    let angle = |p: &DVec3| libm::atan2((*p - middle).dot(second), (*p - middle).dot(first));
    sort_by_number(&mut places, |a| angle(a));
    (places, true)
}

/// Places of the ends of bars over the motion, and without bodies of all joints.
pub fn moving_points(mechanism: &Mechanism, trajectory: &Trajectory) -> Vec<DVec3> {
    let poses = joints::PlacedLinks::over_motion(mechanism, trajectory);
    let is_bare = mechanism.has_no_shapes();
    if let (true, Some(first)) = (is_bare, poses.first())
        && let Some(spherical) = SphericalLinkage::of(mechanism, first)
    {
        return spherical.extent(&poses);
    }
    let placed = match is_bare {
        true => joints::placed_joints(mechanism),
        false => Vec::new(),
    };
    let points = poses.iter().flat_map(|at| {
        let places = placed
            .iter()
            .flat_map(|joint| [&joint.before, &joint.after]);
        let places = places.map(|frame| frame.pose(at).translation);
        let ends = mechanism.bars.iter().flat_map(|bar| &bar.ends);
        let ends = ends.map(|end| end.point.pose(&at.arguments).translation);
        places.chain(ends).collect::<Vec<DVec3>>()
    });
    points.filter(|point| point.is_finite()).collect()
}
