//! Finds the positions of chains that lie on one link: chains as paths in a graph of links, folded.
//!
//! Links are the nodes, elementary motions the edges. A chain is a path: constant poses stay on a link, a motion leads
//! to the next. Two motions with the same coordinates about the same axis that start from the same link are the same
//! motion, and lead to the same link (Stallings' folding, with a pose for every node); a closed loop is a path that
//! returns to its start. Links are thus found from chains and loops alike, however they are written.
//!
//! The two frames of an edge have its axis as z: the motion is `before · M(value) · after⁻¹`. Frames that differ by a
//! factor that commutes with the motion (a rotation about the axis; for a rotation a translation along it; for a
//! translation any translation) are frames of the same motion.

use super::joint::{EXACT, LinkFrame, RoutePart};
use super::motions::{ChainMotion, FLIP, MotionKey, Motions};
use crate::math::Pose;
use crate::model::chain::{Chain, ChainStep, ElementaryMotion};
use crate::model::mechanism::Mechanism;
use glam::{DMat3, DVec3};
use std::collections::{BTreeMap, BTreeSet};

impl LinkEdge {
    /// The identity of its motion.
    pub fn motion_key(&self) -> MotionKey {
        (self.label, self.motion == ElementaryMotion::Rotation)
    }
}

impl LinkFrame {
    pub(super) const WORLD: Self = Self {
        link: 0,
        link_from_here: Pose::IDENTITY,
    };

    pub(super) fn moved(self, by: Pose) -> Self {
        Self {
            link_from_here: self.link_from_here * by,
            ..self
        }
    }
}

/// An elementary motion between two links.
#[derive(Clone, Debug)]
pub struct LinkEdge {
    pub motion: ElementaryMotion,
    /// The combination of coordinates that moves it.
    pub label: usize,
    /// One of the arguments that are this combination, with its coordinates.
    pub argument: usize,
    /// Frames on the link before and on the link behind whose z is the axis.
    pub ends: [LinkFrame; 2],
}

/// An edge as a path passes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopCrossing {
    pub edge: usize,
    pub is_inverse: bool,
}

impl LoopCrossing {
    /// The same in the other direction.
    pub fn inverse(self) -> Self {
        Self {
            is_inverse: !self.is_inverse,
            ..self
        }
    }
}

/// A motion of a chain as a step of its path.
#[derive(Clone, Copy, Debug)]
pub struct Stride {
    pub crossing: LoopCrossing,
    /// The chain's frame before and after the step.
    pub from: LinkFrame,
    pub to: LinkFrame,
}

/// A chain's steps; constant poses pass no edge.
pub type LinkPath = Vec<Option<Stride>>;

/// The chains as paths.
#[derive(Default)]
pub struct Paths {
    pub bodies: Vec<LinkPath>,
    /// From the world to the loops that are carried around.
    pub bases: Vec<LinkPath>,
    pub loops: Vec<LinkPath>,
}

/// The graph while it grows.
pub struct LinkGraph {
    /// The unit of lengths of the chain being followed.
    pub(super) size: f64,
    pub(super) motions: Motions,
    /// To every link from the one from which it was reached.
    routes: Vec<RoutePart>,
    /// The link with which a link was merged.
    merged_links: Vec<Option<LinkFrame>>,
    pub(super) edges: Vec<LinkEdge>,
    /// The edge with which an edge was merged.
    pub(super) merged_edges: Vec<Option<LoopCrossing>>,
    /// Edges by their motion, in order.
    pub(super) alike: BTreeMap<MotionKey, Vec<usize>>,
    /// Links and edges that were merged into others.
    merged: [i64; 2],
    /// Edges at every link.
    at: Vec<Vec<usize>>,
    pub(super) paths: Paths,
    body_ends: Vec<LinkFrame>,
    /// Where loops begin and end.
    pub(super) loop_ends: Vec<LinkFrame>,
    /// Where every loop begins.
    pub(super) loop_starts: Vec<LinkFrame>,
    pub(super) closes: Vec<bool>,
}

/// The folded graph: merged links have no edges.
pub struct Finished {
    /// All edges; merged ones are `None`.
    pub edges: Vec<Option<LinkEdge>>,
    /// Edges at every link.
    pub at: Vec<Vec<usize>>,
    pub paths: Paths,
    /// To every link from the one from which it was reached.
    pub routes: Vec<RoutePart>,
    /// Link of every body.
    pub of_body: Vec<usize>,
    /// Links on which loops begin or end.
    pub loop_ends: Vec<usize>,
    /// Where every loop begins.
    pub loop_starts: Vec<LinkFrame>,
    /// Whether every loop added a condition.
    pub closes: Vec<bool>,
}

impl LinkGraph {
    /// The frame alone.
    pub fn new(mechanism: &Mechanism) -> Self {
        Self {
            size: mechanism.size,
            motions: Motions::new(&mechanism.arguments),
            routes: vec![RoutePart::default()],
            merged_links: vec![None],
            edges: Vec::new(),
            merged_edges: Vec::new(),
            alike: BTreeMap::new(),
            merged: [0, 0],
            at: vec![Vec::new()],
            paths: Paths::default(),
            body_ends: Vec::new(),
            loop_ends: Vec::new(),
            loop_starts: Vec::new(),
            closes: Vec::new(),
        }
    }

    /// Follows a body's chain from the world.
    pub fn add_body(&mut self, chain: &Chain) {
        let (end, path) = self.follow(LinkFrame::WORLD, &chain.steps);
        self.body_ends.push(end);
        self.paths.bodies.push(path);
    }

    /// The graph with all positions on the remaining links.
    pub fn finished(mut self) -> Finished {
        // In place: paths fill most of the memory of long chains.
        let mut paths = std::mem::take(&mut self.paths);
        for list in [&mut paths.bodies, &mut paths.bases, &mut paths.loops] {
            for stride in list.iter_mut().flatten().flatten() {
                *stride = Stride {
                    crossing: self.resolved_edge(stride.crossing),
                    from: self.resolved(stride.from),
                    to: self.resolved(stride.to),
                };
            }
        }
        let edges = self.edges.iter().zip(&self.merged_edges);
        let edges = edges.map(|(edge, merged)| {
            let ends = edge.ends.map(|end| self.resolved(end));
            merged.is_none().then(|| LinkEdge {
                ends,
                ..edge.clone()
            })
        });
        let links = |list: &[LinkFrame]| list.iter().map(|p| self.resolved(*p).link).collect();
        Finished {
            edges: edges.collect(),
            paths,
            of_body: links(&self.body_ends),
            loop_ends: links(&self.loop_ends),
            loop_starts: self.loop_starts.iter().map(|p| self.resolved(*p)).collect(),
            closes: self.closes,
            at: self.at,
            routes: self.routes,
        }
    }

    /// Independent cycles of the graph, which is connected.
    pub(super) fn independent_cycles(&self) -> i64 {
        let [links, edges] = [self.at.len(), self.edges.len()].map(|count| count as i64);
        (edges - self.merged[1]) - (links - self.merged[0]) + 1
    }

    fn resolved(&self, mut position: LinkFrame) -> LinkFrame {
        while let Some(into) = self.merged_links[position.link] {
            position = into.moved(position.link_from_here);
        }
        position
    }

    fn resolved_edge(&self, mut crossing: LoopCrossing) -> LoopCrossing {
        while let Some(into) = self.merged_edges[crossing.edge] {
            crossing = LoopCrossing {
                edge: into.edge,
                is_inverse: into.is_inverse != crossing.is_inverse,
            };
        }
        crossing
    }

    /// Follows steps from a position, on known edges if there are any.
    pub(super) fn follow(
        &mut self,
        start: LinkFrame,
        steps: &[ChainStep],
    ) -> (LinkFrame, LinkPath) {
        let mut here = start;
        let mut path = Vec::with_capacity(steps.len());
        for step in steps {
            match self.motions.met(step) {
                Err(pose) => {
                    here = here.moved(pose);
                    path.push(None);
                }
                Ok(met) => {
                    let known = self.known(here, &met);
                    let (to, crossing) = known.unwrap_or_else(|| self.grow(here, &met, step));
                    path.push(Some(Stride {
                        crossing,
                        from: here,
                        to,
                    }));
                    here = to;
                }
            }
        }
        (here, path)
    }

    /// A known edge with this motion, and where it leads.
    pub(super) fn known(
        &self,
        here: LinkFrame,
        met: &ChainMotion,
    ) -> Option<(LinkFrame, LoopCrossing)> {
        let here = self.resolved(here);
        let axis = here.link_from_here * met.to_axis;
        self.at[here.link].iter().find_map(|index| {
            let edge = &self.edges[*index];
            let is_alike = edge.label == met.label && edge.motion == met.motion;
            if !is_alike || !self.may_commute(edge, here.link, &axis) {
                return None;
            }
            [false, true].into_iter().find_map(|is_inverse| {
                let [from, to] = self.ends(edge, is_inverse);
                let apart = from.link_from_here.inverse() * axis;
                let is_it = from.link == here.link && self.commutes_with(met.motion, &apart);
                let crossing = LoopCrossing {
                    edge: *index,
                    is_inverse,
                };
                is_it.then(|| (to.moved(apart * met.from_axis), crossing))
            })
        })
    }

    /// Frames of an edge as passed forwards or backwards: if both are flipped, the motion is along z again.
    pub(super) fn ends(&self, edge: &LinkEdge, is_inverse: bool) -> [LinkFrame; 2] {
        let [before, after] = edge.ends.map(|end| self.resolved(end));
        if is_inverse {
            [after.moved(FLIP), before.moved(FLIP)]
        } else {
            [before, after]
        }
    }

    /// A new edge to a new link, whose frame is the one after the step.
    fn grow(
        &mut self,
        here: LinkFrame,
        met: &ChainMotion,
        step: &ChainStep,
    ) -> (LinkFrame, LoopCrossing) {
        let here = self.resolved(here);
        let (link, edge) = (self.at.len(), self.edges.len());
        let behind = LinkFrame {
            link,
            link_from_here: Pose::IDENTITY,
        };
        let moved = here.link_from_here != Pose::IDENTITY;
        let fixed = moved.then(|| ChainStep::Fixed(here.link_from_here.into()));
        self.routes.push(RoutePart {
            before: here.link,
            steps: fixed.into_iter().chain([*step]).collect(),
        });
        self.edges.push(LinkEdge {
            motion: met.motion,
            label: met.label,
            argument: met.argument,
            ends: [
                here.moved(met.to_axis),
                behind.moved(met.from_axis.inverse()),
            ],
        });
        let alike = self.alike.entry(met.motion_key()).or_default();
        alike.push(edge);
        self.merged_edges.push(None);
        self.merged_links.push(None);
        self.at.push(vec![edge]);
        self.at[here.link].push(edge);
        let crossing = LoopCrossing {
            edge,
            is_inverse: false,
        };
        (behind, crossing)
    }

    /// Whether one of an edge's frames on a link may have the axis of a frame, in either direction: a quick test that
    /// excludes most of the edges that meet at a link.
    fn may_commute(&self, edge: &LinkEdge, link: usize, axis: &Pose) -> bool {
        edge.ends.iter().map(|end| self.resolved(*end)).any(|end| {
            let (own, z) = (&end.link_from_here, axis.rotation.z_axis);
            let aside = match edge.motion {
                ElementaryMotion::Rotation => (own.translation - axis.translation).cross(z),
                ElementaryMotion::Translation => DVec3::ZERO,
            };
            let tilted = own.rotation.z_axis.cross(z);
            end.link == link
                && tilted.length() <= 4.0 * EXACT
                && aside.length() <= 4.0 * EXACT * self.size
        })
    }

    /// Whether a pose between two frames of an axis along z does not affect the motion.
    fn commutes_with(&self, motion: ElementaryMotion, apart: &Pose) -> bool {
        let tilted = (apart.rotation.z_axis - DVec3::Z).length();
        let aside = match motion {
            ElementaryMotion::Rotation => apart.translation.truncate().length() / self.size,
            ElementaryMotion::Translation => 0.0,
        };
        tilted <= EXACT && aside <= EXACT
    }

    fn is_identity(&self, pose: &Pose) -> bool {
        let turned = (pose.rotation - DMat3::IDENTITY).to_cols_array();
        let moved = pose.translation.length() / self.size;
        turned.iter().fold(moved, |m, v| m.max(v.abs())) <= EXACT
    }

    /// Identifies two positions, and folds the consequences.
    pub(super) fn join(&mut self, a: LinkFrame, b: LinkFrame) {
        let mut same = vec![[a, b]];
        while let Some([a, b]) = same.pop() {
            let [a, b] = [self.resolved(a), self.resolved(b)];
            // Frames on one link either agree already, or the loops contradict each other, which the solver will
            // report.
            if a.link == b.link {
                continue;
            }
            // The older link stays, so that the world is always itself.
            let [a, b] = if a.link < b.link { [a, b] } else { [b, a] };
            self.merged_links[b.link] = Some(a.moved(b.link_from_here.inverse()));
            self.merged[0] += 1;
            let edges = std::mem::take(&mut self.at[b.link]);
            let known: BTreeSet<usize> = self.at[a.link].iter().copied().collect();
            let new = edges.iter().filter(|edge| !known.contains(edge));
            self.at[a.link].extend(new);
            self.fold(a.link, &edges.into_iter().collect(), &mut same);
        }
    }

    /// Merges edges at a link that are the same motion, and the links they lead to. Only `new` edges at the link can
    /// equal others.
    fn fold(&mut self, link: usize, new: &BTreeSet<usize>, same: &mut Vec<[LinkFrame; 2]>) {
        let (mut k, mut is_new_before) = (0, false);
        while k < self.at[link].len() {
            let index = self.at[link][k];
            let is_new = new.contains(&index);
            if !is_new && !is_new_before {
                k += 1;
                continue;
            }
            let before = self.at[link][..k].iter();
            let mut others = before.filter(|other| {
                self.edges[**other].motion_key() == self.edges[index].motion_key()
                    && (is_new || new.contains(other))
            });
            let twin = others.find_map(|other| self.twin(link, *other, index));
            match twin {
                Some((crossing, ends)) => {
                    self.merged_edges[index] = Some(crossing);
                    self.merged[1] += 1;
                    let [before, after] = self.edges[index].ends.map(|e| self.resolved(e).link);
                    self.at[before].retain(|edge| *edge != index);
                    self.at[after].retain(|edge| *edge != index);
                    same.push(ends);
                }
                None => (k, is_new_before) = (k + 1, is_new_before || is_new),
            }
        }
    }

    /// Edge `other` as a passage of edge `known`, which has the same combination of coordinates, if it is the same
    /// motion from the link; and two positions that are the same frame after it.
    fn twin(
        &self,
        link: usize,
        known: usize,
        other: usize,
    ) -> Option<(LoopCrossing, [LinkFrame; 2])> {
        let (one, two) = (&self.edges[known], &self.edges[other]);
        let ways = [[false, false], [false, true], [true, false], [true, true]];
        ways.into_iter().find_map(|[first, second]| {
            let ([from, to], [from_other, to_other]) =
                (self.ends(one, first), self.ends(two, second));
            if from.link != link || from_other.link != link {
                return None;
            }
            let apart = from.link_from_here.inverse() * from_other.link_from_here;
            if !self.commutes_with(one.motion, &apart) {
                return None;
            }
            let behind = to.moved(apart);
            let gap = behind.link_from_here * to_other.link_from_here.inverse();
            if behind.link == to_other.link && !self.is_identity(&gap) {
                return None;
            }
            let crossing = LoopCrossing {
                edge: known,
                is_inverse: first != second,
            };
            Some((crossing, [behind, to_other]))
        })
    }
}
