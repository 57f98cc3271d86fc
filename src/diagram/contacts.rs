//! Surfaces in contact: their places, the offsets that lead to them, and their sizes.

use super::scheme::{QuantitySource, SchemeJoint, SchemeLength, SchemeSurface};
use super::walk::{ChainWalker, SAME, WalkPosition};
use crate::math::Pose;
use crate::model::notation::WrittenChain;

impl ChainWalker<'_> {
    /// The offset from the last joint before a surface to the surface, and the named lengths on it.
    fn note_approach(&mut self, chain: &WrittenChain) {
        // Along the chain: named lengths are noted, and at every joint the path begins again.
        let (mut frame, mut path, mut last) = (Pose::IDENTITY, Vec::new(), None);
        for index in 0..chain.factors.len() {
            let factor = &chain.factors[index];
            self.note_factor(chain, index, &frame, None, true);
            if let (Some(_), Some((_, axis))) = (factor.step.joint(), factor.motion) {
                last = Some(frame.rotation.col(axis));
                path.clear();
            }
            frame = frame * factor.pose(self.values);
            path.push(frame.translation);
        }
        let least = SAME * self.scheme.size;
        let (Some(axis), Some(begin)) = (last, path.first()) else {
            return;
        };
        // The joint that is drawn on the last axis, where the path begins, ...
        let is_it = |joint: &&SchemeJoint| {
            let along = joint
                .axes
                .last()
                .is_some_and(|a| a.cross(axis).length() < SAME);
            along && joint.at.distance(*begin) <= least
        };
        let Some(link) = self
            .scheme
            .joints
            .iter()
            .find(is_it)
            .map(|joint| joint.links[1])
        else {
            return;
        };
        // ... carries the link that the path belongs to.
        let here = WalkPosition {
            frame,
            link,
            path,
            passage: None,
            loop_points: Vec::new(),
        };
        self.keep_path(&here);
    }

    /// Surfaces in contact, with their sizes as lengths along the x axis of their frames.
    pub(super) fn note_surfaces(&mut self) {
        let notation = self.notation;
        let chains = notation.contacts.iter().flat_map(|c| &c.sides);
        chains.for_each(|side| self.note_approach(&side.frame));
        let sides = notation.contacts.iter().flat_map(|contact| &contact.sides);
        let surfaces = sides.map(|side| SchemeSurface {
            word: side.word,
            sizes: side.sizes.clone(),
            frame: side.frame.pose(self.values),
        });
        self.scheme.surfaces = surfaces.collect();
        for surface in self.scheme.surfaces.clone() {
            let mut at = surface.frame.translation;
            for (text, value) in &surface.sizes {
                let to = at + surface.frame.rotation.x_axis * *value;
                let is_name = text.chars().any(char::is_alphabetic);
                if is_name && self.scheme.lengths.iter().all(|l| l.name != *text) {
                    self.scheme.lengths.push(SchemeLength {
                        name: text.clone(),
                        value: *value,
                        from: at,
                        to,
                        aside: [surface.frame.rotation.y_axis, surface.frame.rotation.z_axis],
                        source: QuantitySource::Constant,
                        in_loop: false,
                    });
                }
                at = to;
            }
        }
    }
}
