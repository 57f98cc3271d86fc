//! Bars given as bars in the scene: the coordinates that only place their ends, and the links of the ends.

use super::chain::{ArgumentValue, Chain, ChainJoint, ChainStep, ElementaryMotion};
use super::joints::Joint;
use super::mechanism::{BarEnd, Mechanism};
use crate::math::{Pose, sin_cos};
use crate::sorting::sort_by_key;
use glam::DVec3;
use std::cell::OnceCell;
use std::collections::BTreeSet;

/// The ends of all bars of a mechanism.
#[derive(Clone, Debug)]
pub struct BarEnds<'m> {
    mechanism: &'m Mechanism,
    /// Unknowns that are coordinates of ends.
    slots: BTreeSet<usize>,
    /// Chains to all links that are no coordinates of ends.
    links: OnceCell<Vec<(usize, Chain)>>,
}

impl<'m> BarEnds<'m> {
    /// Of all bars.
    pub fn new(mechanism: &'m Mechanism) -> Self {
        let mut ends = Self {
            mechanism,
            slots: BTreeSet::new(),
            links: OnceCell::new(),
        };
        let all = mechanism.bars.iter().flat_map(|bar| &bar.ends);
        ends.slots = all.flat_map(|end| ends.helpers_of(end)).collect();
        ends
    }

    /// The step by which an end slides along a line of the frame, and those before it; `None` for all other ends.
    pub fn guide_of(&self, end: &'m BarEnd) -> Option<(&'m [ChainStep], ChainJoint)> {
        let steps = &end.carrier.steps;
        let place = steps.iter().position(|step| step.joint().is_some())?;
        let is_alone = steps[place + 1..].iter().all(|step| step.joint().is_none());
        let joint = steps[place].joint().filter(|_| is_alone)?;
        let is_shift = joint.motion == ElementaryMotion::Translation;
        is_shift.then_some((&steps[..place], joint))
    }

    /// The guides of all ends that slide along lines of the frame, where no joint of the mechanism has their coordinate: an end, the
    /// steps before the one by which it slides, and that.
    pub fn guides(&self) -> Vec<(&'m BarEnd, &'m [ChainStep], ChainJoint)> {
        let table = self.mechanism.joints.list.iter().flat_map(Joint::arguments);
        let mut known: Vec<usize> = table.collect();
        let mut guides = Vec::new();
        for end in self.bars().flatten() {
            if let Some((before, joint)) = self.guide_of(end)
                && !known.contains(&joint.argument)
            {
                known.push(joint.argument);
                guides.push((end, before, joint));
            }
        }
        guides
    }

    /// The unknowns that only place an end: all of a free one, and of one on a guide those besides the way along it.
    fn helpers_of(&self, end: &'m BarEnd) -> BTreeSet<usize> {
        let mut helpers = self.unknowns_of(end);
        if self.guide_of(end).is_some() {
            for argument in end.carrier.arguments() {
                for slot in self.mechanism.arguments[argument].coordinates() {
                    helpers.remove(&slot);
                }
            }
        }
        helpers
    }

    /// Every bar's ends.
    pub fn bars(&self) -> impl Iterator<Item = &'m [BarEnd; 2]> {
        self.mechanism.bars.iter().map(|bar| &bar.ends)
    }

    /// Unknowns that place an end.
    pub fn unknowns_of(&self, end: &BarEnd) -> BTreeSet<usize> {
        let arguments = end.point.arguments().into_iter();
        let slots = arguments.flat_map(|a| self.mechanism.arguments[a].coordinates());
        slots
            .filter(|slot| *slot < self.mechanism.unknowns.len())
            .collect()
    }

    /// Whether a joint only places an end, or a body drawn at ends, and is not a real joint.
    pub fn place_joint(&self, joint: &Joint) -> bool {
        self.place(joint.coordinates.iter().copied())
    }

    /// Whether a link is only drawn at ends.
    pub fn place_link(&self, link: usize) -> bool {
        if self.slots.is_empty() {
            return false;
        }
        let chain = self.mechanism.joints.world_from_link(link);
        let arguments = chain.arguments().into_iter();
        self.place(arguments.flat_map(|a| self.mechanism.arguments[a].coordinates()))
    }

    /// Whether these are coordinates of ends and inputs only.
    fn place(&self, slots: impl Iterator<Item = usize> + Clone) -> bool {
        let is_end = |slot: usize| self.slots.contains(&slot);
        let is_input = |slot: usize| slot >= self.mechanism.unknowns.len();
        slots.clone().any(is_end) && slots.clone().all(|slot| is_end(slot) || is_input(slot))
    }

    /// The link that carries an end; `None` if the end is free.
    pub fn link_of(&self, end: &BarEnd) -> Option<usize> {
        let own = moving_steps(&end.carrier);
        if own.is_empty() {
            return Some(0);
        }
        let chains = self.links.get_or_init(|| {
            let joints = &self.mechanism.joints;
            let links = (1..joints.links.len()).filter(|link| !self.place_link(*link));
            links
                .map(|link| (link, joints.world_from_link(link)))
                .collect()
        });
        let alike = chains.iter().find(|(_, chain)| moving_steps(chain) == own);
        let resting = || {
            chains
                .iter()
                .find(|(_, chain)| self.rests_on(&end.carrier, chain))
        };
        // The centre of a rotation is a point of what turns.
        let turning = || {
            chains
                .iter()
                .find(|(_, chain)| self.is_point_of(&end.carrier, chain))
        };
        let found = alike.or_else(resting).or_else(turning);
        found.map(|(link, _)| *link)
    }

    /// The ends that links carry: the link, and the place in its frame.
    pub fn carried(&self) -> Vec<(usize, DVec3)> {
        // Where a link is does not matter.
        let arguments = self.trial_arguments(0);
        let ends = self.bars().flatten().filter_map(|end| {
            let link = self.link_of(end).filter(|link| *link != 0)?;
            let world_from_link = self.mechanism.joints.world_from_link(link).pose(&arguments);
            let place = end.carrier.pose(&arguments).translation;
            let place = world_from_link.inverse().transform_point(place);
            place.is_finite().then_some((link, place))
        });
        ends.collect()
    }

    /// The traced points and the origins of bodies that moving links carry: the link, and the place in its frame.
    pub fn traced(&self) -> Vec<(usize, DVec3)> {
        let (mechanism, arguments) = (self.mechanism, self.trial_arguments(0));
        let traces = mechanism
            .traces
            .iter()
            .map(|trace| (trace.body, trace.point));
        let origins = (0..mechanism.bodies.len()).map(|body| (body, DVec3::ZERO));
        let points = traces.chain(origins).map(|(body, point)| {
            let link = mechanism.joints.of_body[body];
            let world_from_link = mechanism.joints.world_from_link(link).pose(&arguments);
            let world_from_body = mechanism.bodies[body].world_from_body.pose(&arguments);
            let place = world_from_body.transform_point(point);
            (link, world_from_link.inverse().transform_point(place))
        });
        points
            .filter(|(link, place)| *link != 0 && place.is_finite())
            .collect()
    }

    /// Bodies without a frame of their own that several bars hold, such as the platform of a delta robot: a chain that ends on each,
    /// and the ends of the bars in its frame.
    pub fn free_bodies(&self) -> Vec<(&'m Chain, Vec<DVec3>)> {
        let arguments = self.trial_arguments(0);
        let mut bodies: Vec<(&Chain, Vec<DVec3>)> = Vec::new();
        let is_free = |end: &&BarEnd| self.guide_of(end).is_none() && self.link_of(end).is_none();
        let mut free: Vec<&BarEnd> = self.bars().flatten().filter(is_free).collect();
        // Those that turn first: the centre of a rotation is one of their points.
        sort_by_key(&mut free, |end| {
            std::cmp::Reverse(end.carrier.arguments().len())
        });
        for end in free {
            let place = end.carrier.pose(&arguments).translation;
            match bodies
                .iter_mut()
                .find(|(first, _)| self.is_point_of(&end.carrier, first))
            {
                Some((first, places)) => {
                    let place = first.pose(&arguments).inverse().transform_point(place);
                    if places
                        .iter()
                        .all(|p| p.distance(place) > AT_REST * self.mechanism.size)
                    {
                        places.push(place);
                    }
                }
                None => bodies.push((&end.carrier, vec![DVec3::ZERO])),
            }
        }
        bodies
    }

    /// Arguments at coordinates that mean nothing.
    fn trial_arguments(&self, trial: usize) -> Vec<ArgumentValue> {
        let mechanism = self.mechanism;
        let coordinates = (0..mechanism.coordinate_count()).map(|slot| {
            let scale = mechanism.natural_size(mechanism.kind_of(slot));
            scale * sin_cos(1.0 + (slot + 1) as f64 * (trial as f64 + 0.5)).0
        });
        mechanism.argument_values(&coordinates.collect::<Vec<f64>>())
    }

    /// Whether the place of the end of a chain rests in the frame at the end of another one, which no other arguments move.
    fn is_point_of(&self, carried: &Chain, carrier: &Chain) -> bool {
        let arguments = carrier.arguments();
        let mut own = carried.arguments().into_iter();
        let size = self.mechanism.size;
        own.all(|argument| arguments.contains(&argument))
            && self
                .seen_from(carried, carrier)
                .windows(2)
                .all(|pair| pair[0].translation.distance(pair[1].translation) <= AT_REST * size)
    }

    /// The end of a chain in the frame of another one's, at some coordinates.
    fn seen_from(&self, carried: &Chain, carrier: &Chain) -> Vec<Pose> {
        let seen = (0..TRIALS).map(|trial| {
            let arguments = self.trial_arguments(trial);
            carrier.pose(&arguments).inverse() * carried.pose(&arguments)
        });
        seen.collect()
    }

    /// Whether the end of a chain rests in the frame at the end of another one that is moved by the same arguments: chains may be
    /// written in other ways, with a shift along an axis before or behind the rotation about it.
    fn rests_on(&self, carried: &Chain, carrier: &Chain) -> bool {
        if carried.arguments() != carrier.arguments() {
            return false;
        }
        let size = self.mechanism.size;
        let seen = self.seen_from(carried, carrier);
        let apart = |a: &Pose, b: &Pose| {
            let turned = (0..3).map(|k| (a.rotation.col(k) - b.rotation.col(k)).length());
            (a.translation - b.translation).length() + size * turned.sum::<f64>()
        };
        seen.windows(2)
            .all(|pair| apart(&pair[0], &pair[1]) <= AT_REST * size)
    }
}

/// Places at which chains are compared.
const TRIALS: usize = 3;

/// What moves less, as a share of the mechanism's size, rests: the rest is rounding.
const AT_REST: f64 = 1e-9;

/// The steps of a chain up to the last moving one.
fn moving_steps(chain: &Chain) -> Vec<ChainStep> {
    let last = chain.steps.iter().rposition(|step| step.joint().is_some());
    chain.steps[..last.map_or(0, |last| last + 1)].to_vec()
}
