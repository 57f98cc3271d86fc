//! Bars between points: each is a link of its own from pin to pin. The coordinates of free points are no joints.

use super::guides::EndBlock;
use super::scheme::{FLAT, QuantitySource, SchemeJoint, SchemeLength, SchemeLink};
use super::walk::{ChainWalker, SAME};
use crate::math::Pose;
use crate::model::chain::{ArgumentValue, ChainStep};
use crate::model::joints::JointKind;
use crate::model::mechanism::Bar;
use glam::{DMat3, DVec3};

/// A place where bars meet, with the link that carries it.
struct Pin {
    at: DVec3,
    /// Of the scheme: the carrying link if there is one, then bars.
    links: Vec<usize>,
}

impl ChainWalker<'_> {
    /// Notes every bar as a link, its length, and the pins that bars share.
    pub(super) fn note_bars(&mut self, own: &[ArgumentValue]) {
        let mechanism = self.mechanism;
        // The ends of every bar at the pose that is drawn.
        let places: Vec<[DVec3; 2]> = (mechanism.bars.iter())
            .map(|bar| {
                bar.ends
                    .each_ref()
                    .map(|end| end.point.pose(own).translation)
            })
            .collect();
        let normal = self.bar_normal(&places, &self.guide_axes(own));
        // Bars are links, numbered after those that are shown.
        let first = self.scheme.links.len();
        let shown = self
            .scheme
            .links
            .iter()
            .filter(|link| link.is_shown)
            .count();
        for (k, (bar, ends)) in mechanism.bars.iter().zip(&places).enumerate() {
            self.scheme.links.push(SchemeLink {
                number: shown + 1 + k,
                names: vec![bar.name.clone()],
                paths: vec![ends.to_vec()],
                frame: Pose {
                    rotation: DMat3::IDENTITY,
                    translation: ends[0],
                },
                is_shown: true,
            });
            self.note_bar_length(k, bar, *ends, normal);
        }
        let number = shown + 1 + mechanism.bars.len();
        let blocks = self.note_guides(own, number);
        // Where several links meet: joints of all others with the first, hinges if the bars are planar.
        for pin in self.pins(&places, first, &blocks) {
            let (Some(base), others) = (pin.links.first(), pin.links.iter().skip(1)) else {
                continue;
            };
            let joints = others.map(|other| SchemeJoint {
                kind: normal.map_or(JointKind::Spherical, |_| JointKind::Revolute),
                at: pin.at,
                from: pin.at,
                axes: vec![normal.unwrap_or(DVec3::Z)],
                links: [*base, *other],
                names: Vec::new(),
                is_driven: false,
            });
            self.scheme.joints.extend(joints);
        }
        self.note_points_of_ends(own, &places, first);
    }

    /// The places where bars end; `first` is the link of the first bar.
    fn pins(&self, places: &[[DVec3; 2]], first: usize, blocks: &[EndBlock]) -> Vec<Pin> {
        let mut pins: Vec<Pin> = Vec::new();
        let ends = self.mechanism.bars.iter().flat_map(|bar| &bar.ends);
        for (k, (end, at)) in ends.zip(places.iter().flatten()).enumerate() {
            let near = |pin: &&mut Pin| pin.at.distance(*at) <= SAME * self.scheme.size;
            if let Some(known) = pins.iter_mut().find(near) {
                known.links.push(first + k / 2);
            } else {
                let block = || self.block_of(blocks, k / 2, k % 2);
                let carrier = self.ends.link_of(end).or_else(block);
                pins.push(Pin {
                    at: *at,
                    links: carrier.into_iter().chain([first + k / 2]).collect(),
                });
            }
        }
        pins
    }

    /// The normal of all bars, if they are planar: no end may leave its plane.
    fn bar_normal(&self, places: &[[DVec3; 2]], guides: &[DVec3]) -> Option<DVec3> {
        let bars = || places.iter().map(|[a, b]| (*b - *a).normalize_or_zero());
        let directions = || bars().chain(guides.iter().copied());
        // An axis of a hinge, or what two bars span.
        let joints = self.scheme.joints.iter();
        let hinges = joints.filter(|j| j.kind == JointKind::Revolute);
        let first = directions().next()?;
        let spanned = directions().map(|d| first.cross(d));
        let spanned = spanned.max_by(|a, b| a.length().total_cmp(&b.length()))?;
        let candidates = hinges
            .filter_map(|j| j.axes.first().copied())
            .chain([spanned]);
        let mut known = candidates.filter(|axis| axis.length() > FLAT);
        let normal = known.next()?.normalize();
        let is_flat = directions().all(|d| d.dot(normal).abs() < FLAT);
        let ends = self.mechanism.bars.iter().flat_map(|bar| &bar.ends);
        let steps = ends.flat_map(|end| &end.point.steps);
        let mut moving = steps.filter_map(ChainStep::joint);
        let stays = moving.all(|joint| normal[joint.axis].abs() < FLAT);
        (is_flat && stays).then_some(normal)
    }

    /// The length of a bar, if it has a name.
    fn note_bar_length(
        &mut self,
        k: usize,
        bar: &Bar,
        [from, to]: [DVec3; 2],
        normal: Option<DVec3>,
    ) {
        let Some(written) = self
            .notation
            .bar_lengths
            .get(k)
            .filter(|length| length.has_name)
        else {
            return;
        };
        // A name is noted once.
        let is_known = self.scheme.lengths.iter().any(|l| l.name == written.text);
        if is_known {
            return;
        }
        // Dimension lines may lie to either side in the plane of the bars, or out of it.
        let along = (to - from).normalize_or_zero();
        let across = along.cross(normal.unwrap_or_else(|| along.any_orthonormal_vector()));
        let mut inputs = self.mechanism.inputs.iter();
        self.scheme.lengths.push(SchemeLength {
            name: written.text.clone(),
            value: from.distance(to),
            from,
            to,
            aside: [across, along.cross(across)],
            source: match bar.length {
                Some(_) => QuantitySource::Constant,
                None if inputs.any(|input| input.name == written.text) => QuantitySource::Input,
                None => QuantitySource::Unknown,
            },
            in_loop: true,
        });
    }

    /// Traced points of bodies that are only drawn at ends, as points of a bar that ends there.
    fn note_points_of_ends(&mut self, own: &[ArgumentValue], places: &[[DVec3; 2]], first: usize) {
        for trace in &self.mechanism.traces {
            if !self.ends.place_link(self.joints.of_body[trace.body]) {
                continue;
            }
            let body = self.mechanism.bodies[trace.body].world_from_body.pose(own);
            let at = body.transform_point(trace.point);
            let ends_there = |ends: &[DVec3; 2]| {
                ends.iter()
                    .any(|end| end.distance(at) <= SAME * self.scheme.size)
            };
            if let Some(bar) = places.iter().position(ends_there) {
                let number = self.scheme.links[first + bar].number;
                self.scheme.points.push((trace.name.clone(), at, number));
            }
        }
    }
}
