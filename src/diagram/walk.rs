//! From the chains as written and a pose to the scheme: every chain is walked once, and what lies on it is recorded.

use super::scheme::{Scheme, SchemeJoint, SchemeLink, SchemeLoop};
use super::shown_links::{link_numbers, rides_on_joints, shown_links};
use crate::math::Pose;
use crate::model::bar_ends::BarEnds;
use crate::model::chain::{ArgumentValue, Chain, ElementaryMotion};
use crate::model::joints::{Joint, JointKind, Joints, Passage};
use crate::model::mechanism::Mechanism;
use crate::model::notation::{Notation, WrittenChain, WrittenFactor, unsigned_text};
use glam::DVec3;
use std::collections::{HashMap, HashSet};

/// Lengths below this share of the mechanism's size have no line.
pub(super) const NOTHING: f64 = 1e-9;

/// So many lines of a link are compared with a new one: a drawing with more of them is black, and a repeated line changes nothing.
const COMPARED: usize = 1000;

/// A mechanism whose parts lie within this share of its size has that size from its distance to the origin.
const FAR: f64 = 1e-2;

/// The scheme of a mechanism at the given coordinates (unknowns, then inputs).
pub fn scheme_at(mechanism: &Mechanism, notation: &Notation, coordinates: &[f64]) -> Scheme {
    let size = mechanism.size;
    let scheme = scheme_of_size(mechanism, notation, coordinates, size);
    let extent = scheme.extent();
    match NOTHING * size < extent && extent < FAR * size {
        true => scheme_of_size(mechanism, notation, coordinates, extent),
        false => scheme,
    }
}

fn scheme_of_size(
    mechanism: &Mechanism,
    notation: &Notation,
    coordinates: &[f64],
    size: f64,
) -> Scheme {
    let values = notation.values(coordinates);
    let own = mechanism.argument_values(coordinates);
    let joints = &mechanism.joints;
    let mut walker = ChainWalker::new(mechanism, notation, &values, &own);
    walker.scheme.size = size;
    for (k, chain) in notation.loops.iter().enumerate() {
        let (Some(start), Some(passages)) = (joints.loop_starts.get(k), joints.along_loops.get(k))
        else {
            continue;
        };
        let before = chain.factors[..chain.before].iter();
        let before = before.fold(Pose::IDENTITY, |pose, f| pose * f.pose(&values));
        let start_pose = joints.world_from(start).pose(&own) * before.inverse();
        walker.follow_chain(chain, passages, start_pose, start.link, true);
    }
    for (k, chain) in notation.bodies.iter().enumerate() {
        if !rides_on_joints(joints, &walker.ends, k) {
            continue;
        }
        let end = walker.follow_chain(chain, &joints.along_bodies[k], Pose::IDENTITY, 0, false);
        let link = joints.of_body[k];
        walker.note_frame(link, k, end);
        for (trace, point) in mechanism.traces.iter().zip(&notation.points) {
            if trace.body == k && trace.radius != Some(0.0) {
                walker.note_point(point, end, link);
            }
        }
    }
    walker.note_rest(&own);
    walker.note_bars(&own);
    walker.note_surfaces();
    walker.scheme
}

/// Walks the chains and collects what lies on them.
pub(super) struct ChainWalker<'a> {
    pub(super) mechanism: &'a Mechanism,
    pub(super) notation: &'a Notation,
    pub(super) values: &'a [ArgumentValue],
    pub(super) joints: &'a Joints,
    pub(super) ends: BarEnds<'a>,
    pub(super) scheme: Scheme,
    /// Where in the scheme a joint of the table is placed.
    known: Vec<Option<usize>>,
    /// The joints of the scheme on every link.
    joints_of_link: Vec<Vec<usize>>,
    /// Where in the scheme lengths and angles of a name are.
    pub(super) lengths: HashMap<String, usize>,
    pub(super) angles: HashSet<String>,
}

/// Where a walk is.
pub(super) struct WalkPosition {
    pub(super) frame: Pose,
    pub(super) link: usize,
    /// Corners on the link since its last joint.
    pub(super) path: Vec<DVec3>,
    /// The passage that the walk is in.
    pub(super) passage: Option<usize>,
    pub(super) loop_points: Vec<DVec3>,
}

impl<'a> ChainWalker<'a> {
    fn new(
        mechanism: &'a Mechanism,
        notation: &'a Notation,
        values: &'a [ArgumentValue],
        own: &[ArgumentValue],
    ) -> Self {
        let joints = &mechanism.joints;
        let ends = BarEnds::new(mechanism);
        let shown = shown_links(mechanism, &ends);
        let numbers = link_numbers(joints, &shown, mechanism.bars.len());
        let links = joints
            .links
            .iter()
            .zip(numbers.into_iter().zip(shown))
            .zip(joints.link_poses(own))
            .map(|((link, (number, is_shown)), frame)| SchemeLink {
                number,
                names: link
                    .bodies
                    .iter()
                    .map(|b| mechanism.bodies[*b].name.clone())
                    .collect(),
                paths: Vec::new(),
                frame,
                is_shown,
            });
        Self {
            mechanism,
            notation,
            values,
            joints,
            ends,
            scheme: Scheme {
                links: links.collect(),
                ..Scheme::default()
            },
            known: vec![None; joints.list.len()],
            joints_of_link: vec![Vec::new(); joints.links.len()],
            lengths: HashMap::new(),
            angles: HashSet::new(),
        }
    }

    /// Follows a chain; where it ends.
    fn follow_chain(
        &mut self,
        chain: &WrittenChain,
        passages: &[Passage],
        start: Pose,
        link: usize,
        is_loop: bool,
    ) -> Pose {
        let mut here = WalkPosition {
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
                    self.leave_joint(&mut here, passages);
                    self.enter_joint(&mut here, &passages[met], met);
                }
            } else {
                self.leave_joint(&mut here, passages);
            }
            let joint = passage.map(|p| passages[p].joint);
            if !joint.is_some_and(|joint| self.is_of_end(joint)) {
                self.note_factor(chain, index, &here.frame, joint, is_loop);
            }
            let next = here.frame * factor.pose(self.values);
            if passage.is_none() {
                here.path.push(next.translation);
            }
            self.pass_motion(
                &here,
                factor,
                next.translation,
                passage.map(|p| &passages[p]),
            );
            here.frame = next;
        }
        self.leave_joint(&mut here, passages);
        if is_loop {
            self.keep_path(&here);
        }
        // The loop of a bar's end only computes its coordinates.
        if is_loop && !passages.iter().any(|p| self.is_of_end(p.joint)) {
            self.scheme.loops.push(SchemeLoop {
                name: chain.name.clone(),
                points: here.loop_points,
            });
        }
        here.frame
    }

    /// Comes to a joint: the path on the link ends, and the joint is noted if it is new.
    fn enter_joint(&mut self, here: &mut WalkPosition, passage: &Passage, index: usize) {
        let at = here.frame.translation;
        self.keep_path(here);
        here.passage = Some(index);
        here.loop_points.push(at);
        if self.known[passage.joint].is_some() || self.is_of_end(passage.joint) {
            return;
        }
        let joint = &self.joints.list[passage.joint];
        let ends = [joint.before.link, joint.after.link];
        let index = self.scheme.joints.len();
        self.known[passage.joint] = Some(index);
        self.joints_of_link[ends[0]].push(index);
        if ends[1] != ends[0] {
            self.joints_of_link[ends[1]].push(index);
        }
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
            is_driven: self.is_driven(joint),
        });
    }

    /// The joints that no written loop or body passes: those that carry whole loops around, such as the slewing of a crane.
    fn note_rest(&mut self, own: &[ArgumentValue]) {
        for (k, joint) in self.joints.list.iter().enumerate() {
            if self.known[k].is_some() || joint.is_placed || self.is_of_end(k) {
                continue;
            }
            let mut here = self.joints.world_from(&joint.before).pose(own);
            let at = here.translation;
            let mut axes = Vec::new();
            for step in &joint.steps {
                if let Some(motion) = step.joint() {
                    axes.push(here.rotation.col(motion.axis));
                }
                here = here * Chain { steps: vec![*step] }.pose(own);
            }
            // One that stands on the frame itself and carries what is drawn.
            let links = [joint.before.link, joint.after.link];
            let carried = links[1];
            if links[0] != 0 || self.joints_of_link[carried].is_empty() {
                continue;
            }
            // A line leads to the nearest joint of that link, if none of its lines begins here.
            let size = self.scheme.size;
            let mut lines = self.scheme.links[carried].paths.iter().take(COMPARED);
            if !lines.any(|line| is_on(line, at, size)) {
                let others = self.joints_of_link[carried].iter();
                let others = others.map(|index| self.scheme.joints[*index].at);
                let nearest = others.min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)));
                if let Some(other) = nearest.filter(|other| other.distance(at) > NOTHING * size) {
                    self.scheme.links[carried].paths.push(vec![at, other]);
                }
            }
            let index = self.scheme.joints.len();
            self.known[k] = Some(index);
            links
                .iter()
                .for_each(|link| self.joints_of_link[*link].push(index));
            self.scheme.joints.push(SchemeJoint {
                kind: joint.kind,
                at: here.translation,
                from: at,
                axes,
                links,
                names: Vec::new(),
                is_driven: self.is_driven(joint),
            });
        }
    }

    /// Whether all coordinates of a joint are driven.
    fn is_driven(&self, joint: &Joint) -> bool {
        let inputs = self.mechanism.unknowns.len()..;
        joint.coordinates.iter().all(|slot| inputs.contains(slot))
    }

    /// Whether a joint only places the end of a bar.
    fn is_of_end(&self, joint: usize) -> bool {
        self.ends.place_joint(&self.joints.list[joint])
    }

    /// Leaves the current joint: a new path begins on the link behind it.
    fn leave_joint(&mut self, here: &mut WalkPosition, passages: &[Passage]) {
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

    /// Records a motion of the current joint.
    fn pass_motion(
        &mut self,
        here: &WalkPosition,
        factor: &WrittenFactor,
        to: DVec3,
        passage: Option<&Passage>,
    ) {
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
            // The symbol of a sliding joint belongs to the sliding link; the guide belongs to the frame.
            match joint.links[1] {
                0 => joint.from = to,
                _ => joint.at = to,
            }
        }
        if has_point(joint.kind) {
            joint.names.push(unsigned_text(&factor.text).to_owned());
        }
    }

    pub(super) fn keep_path(&mut self, here: &WalkPosition) {
        let path = distinct_points(&here.path, NOTHING * self.scheme.size);
        let is_new = |paths: &[Vec<DVec3>]| {
            let reversed: Vec<DVec3> = path.iter().rev().copied().collect();
            paths.iter().take(COMPARED).all(|known| {
                !is_near(known, &path, self.scheme.size)
                    && !is_near(known, &reversed, self.scheme.size)
            })
        };
        let is_shown = self.scheme.links[here.link].is_shown;
        if path.len() > 1 && is_shown && is_new(&self.scheme.links[here.link].paths) {
            self.scheme.links[here.link].paths.push(path);
        }
    }

    /// The frame of a body, which is its link's where it is the first.
    fn note_frame(&mut self, link: usize, body: usize, pose: Pose) {
        if link != 0 && self.joints.links[link].bodies.first() == Some(&body) {
            self.scheme.links[link].frame = pose;
        }
    }

    /// A traced point of a link, with a line to it.
    fn note_point(&mut self, chain: &WrittenChain, body: Pose, link: usize) {
        let mut frame = body;
        for index in 0..chain.factors.len() {
            self.note_factor(chain, index, &frame, None, false);
            frame = frame * chain.factors[index].pose(self.values);
        }
        let at = frame.translation;
        self.scheme
            .points
            .push((chain.name.clone(), at, self.scheme.links[link].number));
        let ends = self.joints_of_link[link].iter();
        let nearest = ends
            .map(|joint| self.scheme.joints[*joint].at)
            .min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)));
        if let Some(end) = nearest.filter(|end| end.distance(at) > NOTHING * self.scheme.size) {
            let on_line = self.scheme.links[link]
                .paths
                .iter()
                .take(COMPARED)
                .any(|path| is_on(path, at, self.scheme.size));
            if !on_line && link != 0 {
                self.scheme.links[link].paths.push(vec![end, at]);
            }
        }
    }
}

/// Joints about a point, whose coordinates are listed beside it.
pub(super) fn has_point(kind: JointKind) -> bool {
    matches!(
        kind,
        JointKind::Spherical | JointKind::Universal | JointKind::Planar
    )
}

fn distinct_points(path: &[DVec3], least: f64) -> Vec<DVec3> {
    let mut kept: Vec<DVec3> = Vec::new();
    for point in path {
        if kept.last().is_none_or(|last| last.distance(*point) > least) {
            kept.push(*point);
        }
    }
    kept
}

/// Places that differ by less than this share of the size are one.
pub(super) const SAME: f64 = 1e-6;

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
