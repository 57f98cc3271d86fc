//! Bars given as bars in the scene: the coordinates that only place their ends, and the links of the ends.

use super::chain::{Chain, ChainStep};
use super::joints::Joint;
use super::mechanism::{BarEnd, Mechanism};
use std::collections::BTreeSet;

/// The ends of all bars of a mechanism.
#[derive(Clone, Debug)]
pub struct BarEnds<'m> {
    mechanism: &'m Mechanism,
    /// Unknowns that are coordinates of ends.
    slots: BTreeSet<usize>,
}

impl<'m> BarEnds<'m> {
    /// Of all bars.
    pub fn new(mechanism: &'m Mechanism) -> Self {
        let mut ends = Self {
            mechanism,
            slots: BTreeSet::new(),
        };
        let all = mechanism.bars.iter().flat_map(|bar| &bar.ends);
        ends.slots = all.flat_map(|end| ends.unknowns_of(end)).collect();
        ends
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
        let joints = &self.mechanism.joints;
        let own = moving_steps(&end.carrier);
        if own.is_empty() {
            return Some(0);
        }
        let mut links = 1..joints.links.len();
        links.find(|link| {
            !self.place_link(*link) && moving_steps(&joints.world_from_link(*link)) == own
        })
    }
}

/// The steps of a chain up to the last moving one.
fn moving_steps(chain: &Chain) -> Vec<ChainStep> {
    let last = chain.steps.iter().rposition(|step| step.joint().is_some());
    chain.steps[..last.map_or(0, |last| last + 1)].to_vec()
}
