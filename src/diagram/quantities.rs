//! Lengths and angles that a walk along a chain passes: each once, with its name.

use super::scheme::{QuantitySource, SchemeAngle, SchemeLength};
use super::walk::{ChainWalker, NOTHING, has_point};
use crate::math::{Pose, sin_cos};
use crate::model::chain::ElementaryMotion;
use crate::model::notation::{WrittenChain, WrittenFactor, unsigned_text};
use glam::DVec3;

impl ChainWalker<'_> {
    /// Notes a factor that has a name: a length or an angle.
    pub(super) fn note_factor(
        &mut self,
        chain: &WrittenChain,
        index: usize,
        frame: &Pose,
        joint: Option<usize>,
        in_loop: bool,
    ) {
        let factor = &chain.factors[index];
        let Some((motion, axis)) = factor.motion else {
            return;
        };
        let source = self.source_of(factor);
        if source == QuantitySource::Constant && !factor.is_dimension {
            return;
        }
        let name = unsigned_text(&factor.text);
        // A quantity outside of all loops is placed by a formula, and has no coordinate of its own.
        let is_name = name
            .chars()
            .all(|c| c.is_alphanumeric() || "._".contains(c));
        if source != QuantitySource::Constant && !in_loop && !is_name {
            return;
        }
        match motion {
            ElementaryMotion::Translation => {
                self.note_length(name, factor, frame, axis, source, in_loop)
            }
            ElementaryMotion::Rotation => {
                let is_of_point = joint.is_some_and(|k| has_point(self.joints.list[k].kind));
                if !is_of_point {
                    self.note_angle(name, (chain, index), frame, axis, source);
                }
            }
        }
    }

    fn note_length(
        &mut self,
        name: &str,
        factor: &WrittenFactor,
        frame: &Pose,
        axis: usize,
        source: QuantitySource,
        in_loop: bool,
    ) {
        let value = factor.value(self.values);
        let direction = frame.rotation.col(axis);
        let to = frame.translation + direction * value;
        let others = [
            frame.rotation.col((axis + 1) % 3),
            frame.rotation.col((axis + 2) % 3),
        ];
        let length = SchemeLength {
            name: name.to_owned(),
            value: if name == factor.text { value } else { -value },
            from: frame.translation,
            to,
            aside: others,
            source,
            in_loop,
        };
        let least = NOTHING * self.scheme.size;
        match self.lengths.get(name).map(|k| &mut self.scheme.lengths[*k]) {
            // A length that is zero at this pose may be drawn elsewhere.
            Some(known) if known.from.distance(known.to) <= least => *known = length,
            Some(_) => {}
            None => {
                self.lengths
                    .insert(name.to_owned(), self.scheme.lengths.len());
                self.scheme.lengths.push(length);
            }
        }
    }

    fn note_angle(
        &mut self,
        name: &str,
        place: (&WrittenChain, usize),
        frame: &Pose,
        axis: usize,
        source: QuantitySource,
    ) {
        if !self.angles.insert(name.to_owned()) {
            return;
        }
        let (chain, index) = place;
        let value = chain.factors[index].value(self.values);
        let zero = self.zero_direction(chain, index, frame, axis);
        let direction = frame.rotation.col(axis);
        let is_reversed = name != chain.factors[index].text;
        // An inverse motion is measured from where it leads to.
        let from = turned_vector(zero, direction, if is_reversed { value } else { 0.0 });
        self.scheme.angles.push(SchemeAngle {
            name: name.to_owned(),
            at: frame.translation,
            axis: direction,
            zero: from,
            value: if is_reversed { -value } else { value },
            source,
        });
    }

    /// The zero direction of an angle: the axis along which the chain continues after it, or leads to it.
    fn zero_direction(
        &self,
        chain: &WrittenChain,
        index: usize,
        frame: &Pose,
        axis: usize,
    ) -> DVec3 {
        let leads = |factor: &WrittenFactor| match factor.motion {
            Some((ElementaryMotion::Translation, along)) if along != axis => {
                let value = factor.value(self.values);
                (value != 0.0).then_some((along, value.signum()))
            }
            _ => None,
        };
        let turns = |factor: &&WrittenFactor| {
            matches!(factor.motion, Some((ElementaryMotion::Translation, _)))
        };
        let behind = chain.factors[index + 1..]
            .iter()
            .take_while(turns)
            .find_map(leads);
        let before = chain.factors[..index]
            .iter()
            .rev()
            .take_while(turns)
            .find_map(leads);
        match behind.or(before) {
            Some((along, sign)) => frame.rotation.col(along) * sign,
            None => frame.rotation.col((axis + 1) % 3),
        }
    }

    fn source_of(&self, factor: &WrittenFactor) -> QuantitySource {
        let Some(joint) = factor.step.joint() else {
            return QuantitySource::Constant;
        };
        let slots = self.notation.arguments[joint.argument].coordinates();
        let first_input = self.mechanism.unknowns.len();
        match slots.iter().all(|slot| *slot >= first_input) {
            true => QuantitySource::Input,
            false => QuantitySource::Unknown,
        }
    }
}

fn turned_vector(v: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    let (sin, cos) = sin_cos(angle);
    v * cos + axis.cross(v) * sin + axis * axis.dot(v) * (1.0 - cos)
}
