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
use std::collections::BTreeMap;

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
    pub(super) merged_links: Vec<Option<LinkFrame>>,
    pub(super) edges: Vec<LinkEdge>,
    /// The edge with which an edge was merged.
    pub(super) merged_edges: Vec<Option<LoopCrossing>>,
    /// Edges by their motion, in order.
    pub(super) alike: BTreeMap<MotionKey, Vec<usize>>,
    /// Links and edges that were merged into others.
    pub(super) merged: [i64; 2],
    /// Edges at every link.
    pub(super) at: Vec<Vec<usize>>,
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

    pub(super) fn resolved(&self, mut position: LinkFrame) -> LinkFrame {
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
            // A constant step stays on the link; a motion crosses an edge, a known one if it is the same motion from
            // here.
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
        // Compared on the link: the axis as seen from its frame.
        let here = self.resolved(here);
        let axis = here.link_from_here * met.to_axis;
        self.at[here.link].iter().find_map(|index| {
            let edge = &self.edges[*index];
            let is_alike = edge.label == met.label && edge.motion == met.motion;
            if !is_alike || !self.may_commute(edge, here.link, &axis) {
                return None;
            }
            // The motion along the edge or against it; both frames must agree up to a pose that commutes with the
            // motion.
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
        // The edge leads to a link of its own, in whose frame it ends at the origin.
        let here = self.resolved(here);
        let (link, edge) = (self.at.len(), self.edges.len());
        let behind = LinkFrame {
            link,
            link_from_here: Pose::IDENTITY,
        };
        // The route to the new link: as to this one, then the fixed displacement, then the step.
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
    pub(super) fn commutes_with(&self, motion: ElementaryMotion, apart: &Pose) -> bool {
        let tilted = (apart.rotation.z_axis - DVec3::Z).length();
        let aside = match motion {
            ElementaryMotion::Rotation => apart.translation.truncate().length() / self.size,
            ElementaryMotion::Translation => 0.0,
        };
        tilted <= EXACT && aside <= EXACT
    }

    pub(super) fn is_identity(&self, pose: &Pose) -> bool {
        let turned = (pose.rotation - DMat3::IDENTITY).to_cols_array();
        let moved = pose.translation.length() / self.size;
        turned.iter().fold(moved, |m, v| m.max(v.abs())) <= EXACT
    }
}
