//! From the chains as written, and a pose, to the scheme: every chain is walked once, and what it passes is noted.

use super::scheme::{
    QuantitySource, Scheme, SchemeAngle, SchemeJoint, SchemeLength, SchemeLink, SchemeLoop,
    SchemeSurface,
};
use crate::math::Pose;
use crate::model::chain::{ArgumentValue, ElementaryMotion};
use crate::model::joints::{JointKind, Joints, Passage};
use crate::model::mechanism::Mechanism;
use crate::model::notation::{Notation, WrittenChain, WrittenFactor};
use glam::DVec3;

/// Lengths below this share of the mechanism's size have no line.
const NOTHING: f64 = 1e-9;

/// The scheme of a mechanism at the given coordinates (unknowns, then inputs).
pub fn scheme_at(mechanism: &Mechanism, notation: &Notation, coordinates: &[f64]) -> Scheme {
    let values = notation.values(coordinates);
    let own = mechanism.argument_values(coordinates);
    let joints = &mechanism.joints;
    let mut walker = Walker::new(mechanism, notation, &values, &own);
    for (k, chain) in notation.loops.iter().enumerate() {
        let (Some(start), Some(passages)) = (joints.loop_starts.get(k), joints.along_loops.get(k))
        else {
            continue;
        };
        let before = chain.factors[..chain.before].iter();
        let before = before.fold(Pose::IDENTITY, |pose, f| pose * f.pose(&values));
        let start_pose = joints.world_from(start).pose(&own) * before.inverse();
        walker.walk(chain, passages, start_pose, start.link, true);
    }
    for (k, chain) in notation.bodies.iter().enumerate() {
        let end = walker.walk(chain, &joints.along_bodies[k], Pose::IDENTITY, 0, false);
        let link = joints.of_body[k];
        walker.frame(link, k, end);
        for (trace, point) in mechanism.traces.iter().zip(&notation.points) {
            if trace.body == k && trace.radius != Some(0.0) {
                walker.point(point, end, link);
            }
        }
    }
    walker.surfaces();
    walker.finished()
}

/// Walks chains and gathers what they pass.
struct Walker<'a> {
    mechanism: &'a Mechanism,
    notation: &'a Notation,
    values: &'a [ArgumentValue],
    joints: &'a Joints,
    scheme: Scheme,
    /// Where in the scheme a joint of the table stands.
    known: Vec<Option<usize>>,
}

/// Where a walk is.
struct Here {
    frame: Pose,
    link: usize,
    /// Corners on the link since its last joint.
    path: Vec<DVec3>,
    /// The passage that the walk is in.
    passage: Option<usize>,
    loop_points: Vec<DVec3>,
}

impl<'a> Walker<'a> {
    fn new(
        mechanism: &'a Mechanism,
        notation: &'a Notation,
        values: &'a [ArgumentValue],
        own: &[ArgumentValue],
    ) -> Self {
        let joints = &mechanism.joints;
        let numbers = link_numbers(joints);
        let links = joints
            .links
            .iter()
            .zip(numbers)
            .enumerate()
            .map(|(index, (link, number))| SchemeLink {
                number,
                names: link
                    .bodies
                    .iter()
                    .map(|b| mechanism.bodies[*b].name.clone())
                    .collect(),
                paths: Vec::new(),
                frame: joints.world_from_link(index).pose(own),
            });
        Self {
            mechanism,
            notation,
            values,
            joints,
            scheme: Scheme {
                links: links.collect(),
                size: mechanism.size,
                ..Scheme::default()
            },
            known: vec![None; joints.list.len()],
        }
    }

    /// Follows a chain; where it ends.
    fn walk(
        &mut self,
        chain: &WrittenChain,
        passages: &[Passage],
        start: Pose,
        link: usize,
        is_loop: bool,
    ) -> Pose {
        let mut here = Here {
            frame: start,
            link,
            path: vec![start.translation],
            passage: None,
            loop_points: Vec::new(),
        };
        for (index, factor) in chain.factors.iter().enumerate() {
            let passage = factor
                .place
                .and_then(|step| passages.iter().position(|p| p.steps.contains(&step)));
            if let Some(met) = passage {
                if here.passage != Some(met) {
                    self.leave(&mut here, passages);
                    self.enter(&mut here, &passages[met], met);
                }
            } else {
                self.leave(&mut here, passages);
            }
            self.note(
                chain,
                index,
                &here.frame,
                passage.map(|p| passages[p].joint),
                is_loop,
            );
            let next = here.frame * factor.pose(self.values);
            if passage.is_none() {
                here.path.push(next.translation);
            }
            self.pass(
                &here,
                factor,
                next.translation,
                passage.map(|p| &passages[p]),
            );
            here.frame = next;
        }
        self.leave(&mut here, passages);
        if is_loop {
            self.keep_path(&here);
            self.scheme.loops.push(SchemeLoop {
                name: chain.name.clone(),
                points: here.loop_points,
            });
        }
        here.frame
    }

    /// Comes to a joint: the path on the link ends, and the joint is noted if it is new.
    fn enter(&mut self, here: &mut Here, passage: &Passage, index: usize) {
        let at = here.frame.translation;
        self.keep_path(here);
        here.passage = Some(index);
        here.loop_points.push(at);
        if self.known[passage.joint].is_some() {
            return;
        }
        let joint = &self.joints.list[passage.joint];
        let ends = [joint.before.link, joint.after.link];
        self.known[passage.joint] = Some(self.scheme.joints.len());
        self.scheme.joints.push(SchemeJoint {
            kind: joint.kind,
            at,
            from: at,
            axes: Vec::new(),
            links: if passage.is_inverse {
                [ends[1], ends[0]]
            } else {
                ends
            },
            names: Vec::new(),
        });
    }

    /// Leaves the joint that the walk is in: a new path begins on the link behind it.
    fn leave(&mut self, here: &mut Here, passages: &[Passage]) {
        let Some(passage) = here.passage.take().map(|p| &passages[p]) else {
            return;
        };
        let joint = &self.joints.list[passage.joint];
        let behind = if passage.is_inverse {
            &joint.before
        } else {
            &joint.after
        };
        here.link = behind.link;
        here.path = vec![here.frame.translation];
        here.loop_points.push(here.frame.translation);
    }

    /// Notes a motion of the joint that is being passed.
    fn pass(&mut self, here: &Here, factor: &WrittenFactor, to: DVec3, passage: Option<&Passage>) {
        let (Some(passage), Some((motion, axis))) = (passage, factor.motion) else {
            return;
        };
        let Some(joint) = self.known[passage.joint].and_then(|k| self.scheme.joints.get_mut(k))
        else {
            return;
        };
        let all = self.joints.list[passage.joint].arguments().count();
        if joint.axes.len() >= all {
            return;
        }
        joint.axes.push(here.frame.rotation.col(axis));
        if motion == ElementaryMotion::Translation {
            // The sign of a sliding joint stands on the link that slides; the frame holds the guide.
            match joint.links[1] {
                0 => joint.from = to,
                _ => joint.at = to,
            }
        }
        if has_point(joint.kind) {
            joint.names.push(unsigned(&factor.text).to_owned());
        }
    }

    fn keep_path(&mut self, here: &Here) {
        let path = distinct(&here.path, NOTHING * self.scheme.size);
        let is_new = |paths: &[Vec<DVec3>]| {
            let reversed: Vec<DVec3> = path.iter().rev().copied().collect();
            paths.iter().all(|known| {
                !is_near(known, &path, self.scheme.size)
                    && !is_near(known, &reversed, self.scheme.size)
            })
        };
        if path.len() > 1 && is_new(&self.scheme.links[here.link].paths) {
            self.scheme.links[here.link].paths.push(path);
        }
    }

    /// Notes a factor that has a name: a length or an angle.
    fn note(
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
        let source = self.source(factor);
        if source == QuantitySource::Constant && !factor.is_dimension {
            return;
        }
        let name = unsigned(&factor.text);
        // What stands in no loop is placed by a formula, and has no coordinate of its own.
        let is_name = name
            .chars()
            .all(|c| c.is_alphanumeric() || "._".contains(c));
        if source != QuantitySource::Constant && !in_loop && !is_name {
            return;
        }
        match motion {
            ElementaryMotion::Translation => {
                self.length(name, factor, frame, axis, source, in_loop)
            }
            ElementaryMotion::Rotation => {
                let is_of_point = joint.is_some_and(|k| has_point(self.joints.list[k].kind));
                if !is_of_point {
                    self.angle(name, (chain, index), frame, axis, source);
                }
            }
        }
    }

    fn length(
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
        match self.scheme.lengths.iter_mut().find(|l| l.name == name) {
            // A length that is zero at this pose may be drawn elsewhere.
            Some(known) if known.from.distance(known.to) <= least => *known = length,
            Some(_) => {}
            None => self.scheme.lengths.push(length),
        }
    }

    fn angle(
        &mut self,
        name: &str,
        place: (&WrittenChain, usize),
        frame: &Pose,
        axis: usize,
        source: QuantitySource,
    ) {
        if self.scheme.angles.iter().any(|a| a.name == name) {
            return;
        }
        let (chain, index) = place;
        let value = chain.factors[index].value(self.values);
        let zero = self.zero_direction(chain, index, frame, axis);
        let direction = frame.rotation.col(axis);
        let is_reversed = name != chain.factors[index].text;
        // An inverse motion is measured from where it leads to.
        let from = turned(zero, direction, if is_reversed { value } else { 0.0 });
        self.scheme.angles.push(SchemeAngle {
            name: name.to_owned(),
            at: frame.translation,
            axis: direction,
            zero: from,
            value: if is_reversed { -value } else { value },
            source,
        });
    }

    /// From where an angle is measured: the axis along which the chain goes on behind it, or comes to it.
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

    fn source(&self, factor: &WrittenFactor) -> QuantitySource {
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

    /// The frame of a body, which is its link's where it is the first.
    fn frame(&mut self, link: usize, body: usize, pose: Pose) {
        if link != 0 && self.joints.links[link].bodies.first() == Some(&body) {
            self.scheme.links[link].frame = pose;
        }
    }

    /// A traced point of a link, with a line to it.
    fn point(&mut self, chain: &WrittenChain, body: Pose, link: usize) {
        let mut frame = body;
        for index in 0..chain.factors.len() {
            self.note(chain, index, &frame, None, false);
            frame = frame * chain.factors[index].pose(self.values);
        }
        let at = frame.translation;
        self.scheme
            .points
            .push((chain.name.clone(), at, self.scheme.links[link].number));
        let ends = self
            .scheme
            .joints
            .iter()
            .filter(|j| j.links.contains(&link));
        let nearest = ends
            .map(|j| j.at)
            .min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)));
        if let Some(end) = nearest.filter(|end| end.distance(at) > NOTHING * self.scheme.size) {
            let on_line = self.scheme.links[link]
                .paths
                .iter()
                .any(|path| is_on(path, at, self.scheme.size));
            if !on_line && link != 0 {
                self.scheme.links[link].paths.push(vec![end, at]);
            }
        }
    }

    /// The way to a surface from the last joint before it, and the named lengths on it.
    fn approach(&mut self, chain: &WrittenChain) {
        let (mut frame, mut path, mut last) = (Pose::IDENTITY, Vec::new(), None);
        for index in 0..chain.factors.len() {
            let factor = &chain.factors[index];
            self.note(chain, index, &frame, None, true);
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
        let here = Here {
            frame,
            link,
            path,
            passage: None,
            loop_points: Vec::new(),
        };
        self.keep_path(&here);
    }

    /// Surfaces in contact, with their sizes as lengths along the x axis of their frames.
    fn surfaces(&mut self) {
        let notation = self.notation;
        let chains = notation.contacts.iter().flat_map(|c| &c.sides);
        chains.for_each(|side| self.approach(&side.frame));
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

    fn finished(self) -> Scheme {
        self.scheme
    }
}

/// Joints about a point, whose coordinates are listed beside it.
fn has_point(kind: JointKind) -> bool {
    matches!(
        kind,
        JointKind::Spherical | JointKind::Universal | JointKind::Planar
    )
}

/// Numbers of links as lectures count: the frame is 1, then in the order of bodies, then the rest.
fn link_numbers(joints: &Joints) -> Vec<usize> {
    let mut order: Vec<usize> = (0..joints.links.len()).collect();
    let first = |link: usize| {
        joints.links[link]
            .bodies
            .iter()
            .min()
            .copied()
            .unwrap_or(usize::MAX)
    };
    order.sort_by_key(|link| (*link != 0, first(*link), *link));
    let mut numbers = vec![0; order.len()];
    order
        .iter()
        .enumerate()
        .for_each(|(k, link)| numbers[*link] = k + 1);
    numbers
}

/// A text without the sign in front, where that belongs to the whole.
pub fn unsigned(text: &str) -> &str {
    let Some(rest) = text.strip_prefix('-') else {
        return text;
    };
    let inner = rest.strip_prefix('(').and_then(|r| r.strip_suffix(')'));
    match inner {
        Some(inner) if !inner.contains(['(', ')']) => inner,
        _ if rest.contains(" + ") || rest.contains(" - ") => text,
        _ => rest,
    }
}

fn turned(v: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    let (sin, cos) = crate::math::sin_cos(angle);
    v * cos + axis.cross(v) * sin + axis * axis.dot(v) * (1.0 - cos)
}

fn distinct(path: &[DVec3], least: f64) -> Vec<DVec3> {
    let mut kept: Vec<DVec3> = Vec::new();
    for point in path {
        if kept.last().is_none_or(|last| last.distance(*point) > least) {
            kept.push(*point);
        }
    }
    kept
}

/// Places that differ by less than this share of the size are one.
const SAME: f64 = 1e-6;

fn is_near(a: &[DVec3], b: &[DVec3], size: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.distance(*b) <= SAME * size)
}

/// Whether a point lies on a path.
fn is_on(path: &[DVec3], at: DVec3, size: f64) -> bool {
    path.windows(2).any(|ends| {
        let along = ends[1] - ends[0];
        let share = ((at - ends[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (ends[0] + along * share).distance(at) <= SAME * size
    })
}
