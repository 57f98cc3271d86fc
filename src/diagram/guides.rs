//! Ends of bars that slide along lines of the frame: a block on a guide for each, where no joint of the mechanism has its coordinate.

use super::scheme::{QuantitySource, SchemeJoint, SchemeLength, SchemeLink};
use super::walk::ChainWalker;
use crate::math::Pose;
use crate::model::chain::{ArgumentValue, Chain};
use crate::model::joints::JointKind;
use glam::{DMat3, DVec3};

/// The block that carries an end.
pub(super) struct EndBlock {
    /// The argument of its motion.
    argument: usize,
    /// Its link in the scheme.
    link: usize,
}

impl ChainWalker<'_> {
    /// Notes a link and a sliding joint for every guide, and the length along it; the links are numbered from `number`.
    pub(super) fn note_guides(&mut self, own: &[ArgumentValue], number: usize) -> Vec<EndBlock> {
        let mut blocks: Vec<EndBlock> = Vec::new();
        for (end, before, joint) in self.ends.guides() {
            // The line of the end is as far beside the step as the end is behind it.
            let steps = &end.carrier.steps;
            let before = Chain {
                steps: before.to_vec(),
            };
            let behind = Chain {
                steps: steps[before.steps.len() + 1..].to_vec(),
            };
            let world_from_guide = before.pose(own);
            let from = world_from_guide.transform_point(behind.pose(own).translation);
            let at = end.point.pose(own).translation;
            let axis = world_from_guide.rotation.col(joint.axis);
            let link = self.scheme.links.len();
            self.scheme.links.push(SchemeLink {
                number: number + blocks.len(),
                names: Vec::new(),
                paths: Vec::new(),
                frame: Pose {
                    rotation: DMat3::IDENTITY,
                    translation: at,
                },
                is_shown: true,
            });
            self.scheme.joints.push(SchemeJoint {
                kind: JointKind::Prismatic,
                at,
                from,
                axes: vec![axis],
                links: [0, link],
                names: Vec::new(),
                is_driven: false,
            });
            self.note_way(joint.argument, [from, at], axis);
            blocks.push(EndBlock {
                argument: joint.argument,
                link,
            });
        }
        blocks
    }

    /// Directions of the guides of ends.
    pub(super) fn guide_axes(&self, own: &[ArgumentValue]) -> Vec<DVec3> {
        let ends = self.mechanism.bars.iter().flat_map(|bar| &bar.ends);
        let guides = ends.filter_map(|end| self.ends.guide_of(end));
        let axes = guides.map(|(before, joint)| {
            let before = Chain {
                steps: before.to_vec(),
            };
            before.pose(own).rotation.col(joint.axis)
        });
        axes.collect()
    }

    /// The block that carries an end, of those noted.
    pub(super) fn block_of(&self, blocks: &[EndBlock], bar: usize, side: usize) -> Option<usize> {
        let (_, joint) = self.ends.guide_of(&self.mechanism.bars[bar].ends[side])?;
        let block = blocks.iter().find(|b| b.argument == joint.argument)?;
        Some(block.link)
    }

    /// The coordinate of a guide as a length, if it is one.
    fn note_way(&mut self, argument: usize, [from, to]: [DVec3; 2], axis: DVec3) {
        let mechanism = self.mechanism;
        let slots = mechanism.arguments[argument].coordinates();
        let [slot] = slots[..] else {
            return;
        };
        let unknowns = mechanism.unknowns.len();
        let (coordinate, source) = match slot.checked_sub(unknowns) {
            Some(input) => (&mechanism.inputs[input], QuantitySource::Input),
            None => (&mechanism.unknowns[slot], QuantitySource::Unknown),
        };
        let across = axis.any_orthonormal_vector();
        self.scheme.lengths.push(SchemeLength {
            name: coordinate.name.clone(),
            value: (to - from).dot(axis),
            from,
            to,
            aside: [across, axis.cross(across)],
            source,
            in_loop: true,
        });
    }
}
