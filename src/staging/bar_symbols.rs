//! Bars in pictures: a rod from end to end, in two parts that slide in each other where its length changes, and a ball at every
//! end.

use super::joints::{AT_REST, PlacedLinks, few_of};
use crate::math::Pose;
use crate::model::bar_ends::BarEnds;
use crate::model::chain::Chain;
use crate::model::mechanism::{Bar, BarEnd, Mechanism};
use crate::model::shape::Solid;
use glam::DVec3;

/// A length that changes by less than this fraction does not.
const CONSTANT: f64 = 1e-9;

/// Each part of a bar that changes its length has this share of the greatest one, so that they overlap in a tenth of it; unless
/// the bar is shorter than that at its shortest: then the parts do not meet where it is longest.
const PART: f64 = 0.55;

/// Radius of the outer one of these parts over that of a rod.
const BARREL: f64 = 1.5;

/// Radius of a ball at an end over that of a pin.
const BALL: f64 = 1.7;

/// A piece along a bar: solids along z from the first of two ends towards the second.
pub struct DrawnBar {
    /// The ends as points.
    pub ends: [Chain; 2],
    /// In the frame of the first end.
    pub solids: Vec<Solid>,
    /// Index of the bar.
    pub bar: usize,
}

/// The frame at `a` whose z axis points to `b`.
pub fn frame_along([a, b]: &[Chain; 2], at: &PlacedLinks) -> Pose {
    let [a, b] = [a, b].map(|end| end.pose(&at.arguments).translation);
    Pose::from_translation(a) * Pose::from_z_axis(b - a)
}

/// All bars as rods of the radius `radius`, over some poses of the motion.
pub fn drawn_bars(mechanism: &Mechanism, poses: &[PlacedLinks], radius: f64) -> Vec<DrawnBar> {
    let bars = mechanism.bars.iter().enumerate();
    let drawn = bars.flat_map(|(bar, Bar { ends, .. })| {
        let [a, b] = ends.each_ref().map(|end| end.point.clone());
        let length = |at: &PlacedLinks| {
            let [a, b] = [&a, &b].map(|end| end.pose(&at.arguments).translation);
            a.distance(b)
        };
        // The range of the bar's length over the motion.
        let lengths = poses.iter().map(length);
        let range = lengths.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], l| {
            [low.min(l), high.max(l)]
        });
        let [low, high] = range;
        let rod = |length: f64, radius: f64| {
            vec![Solid::Capsule {
                from: DVec3::ZERO,
                to: DVec3::Z * length,
                radius,
            }]
        };
        // A bar of constant length is a rod; any other is a barrel from one end and a rod from the other.
        let parts = match high - low <= CONSTANT * high {
            true => vec![([a, b], rod(high, radius))],
            false => {
                // No part is longer than the bar at its shortest.
                let part = (PART * high).min(low);
                vec![
                    ([a.clone(), b.clone()], rod(part, BARREL * radius)),
                    ([b, a], rod(part, radius)),
                ]
            }
        };
        let piece = move |(ends, solids)| DrawnBar { ends, solids, bar };
        parts.into_iter().map(piece)
    });
    drawn.collect()
}

/// Whether every bar has no body that shows it: one with shapes that moves with the bar.
pub fn bars_without_bodies(mechanism: &Mechanism, poses: &[PlacedLinks]) -> Vec<bool> {
    let shaped = mechanism
        .bodies
        .iter()
        .filter(|body| !body.shapes.is_empty());
    let shaped: Vec<&Chain> = shaped.map(|body| &body.world_from_body).collect();
    let slack = AT_REST * mechanism.size;
    let is_shown = |[a, b]: [&Chain; 2], body: &Chain| {
        // One end, and the direction to the other, as the body sees them.
        let mut seen = few_of(poses).map(|at| {
            let body_from_world = body.pose(&at.arguments).inverse();
            let [a, b] = [a, b].map(|end| end.pose(&at.arguments).translation);
            let along = body_from_world.rotation * (b - a).normalize_or_zero();
            (
                body_from_world.transform_point(a),
                body_from_world.transform_point(b),
                along,
            )
        });
        let Some((first, second, way)) = seen.next() else {
            return true;
        };
        seen.all(|(a, b, along)| {
            let rests = a.distance(first) <= slack || b.distance(second) <= slack;
            rests && along.distance(way) <= AT_REST
        })
    };
    let shown = |Bar { ends, .. }: &Bar| {
        let ends = ends.each_ref().map(|end| &end.point);
        shaped.iter().any(|body| is_shown(ends, body))
    };
    mechanism.bars.iter().map(|bar| !shown(bar)).collect()
}

/// A ball for the end of a bar; `radius` is that of a pin.
pub fn end_ball(radius: f64) -> Vec<Solid> {
    vec![Solid::Sphere {
        centre: DVec3::ZERO,
        radius: BALL * radius,
    }]
}

/// The different ends of all bars, each with whether it belongs to the frame.
pub fn bar_ends(mechanism: &Mechanism) -> Vec<(&BarEnd, bool)> {
    let all = BarEnds::new(mechanism);
    let mut ends: Vec<(&BarEnd, bool)> = Vec::new();
    for end in all.bars().flatten() {
        if ends.iter().all(|(known, _)| known.point != end.point) {
            ends.push((end, all.link_of(end) == Some(0)));
        }
    }
    ends
}
