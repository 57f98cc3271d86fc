//! Joints, links and the passages of chains through them, as values.

use crate::math::Pose;
use crate::model::chain::{ArgumentValue, Chain, ChainStep};
use crate::model::walk::walk_chain;
use std::ops::Range;

/// Axes intersect or are parallel, and frames agree, if they do so within this (radians, sizes): the rounding of a few
/// folded constants. Anything that is meant to be apart is farther apart, and a ball joint whose axes miss each other
/// by more cannot be solved as a rotation to the last digits.
pub const EXACT: f64 = 1e-12;

/// The kinds of joints: the lower pairs, and the universal joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JointKind {
    /// One rotation.
    Revolute,
    /// One translation.
    Prismatic,
    /// A rotation about and a translation along one axis.
    Cylindrical,
    /// The same, coupled: a screw.
    Helical,
    /// Two rotations about axes that meet.
    Universal,
    /// Three rotations about axes that meet in one point.
    Spherical,
    /// Two translations, and a rotation about the normal of their plane.
    Planar,
}

impl JointKind {
    /// As in reports.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Revolute => "revolute joint",
            Self::Prismatic => "prismatic joint",
            Self::Cylindrical => "cylindrical joint",
            Self::Helical => "helical joint",
            Self::Universal => "universal joint",
            Self::Spherical => "spherical joint",
            Self::Planar => "planar joint",
        }
    }

    /// Degrees of freedom.
    pub const fn freedoms(self) -> usize {
        match self {
            Self::Revolute | Self::Prismatic | Self::Helical => 1,
            Self::Cylindrical | Self::Universal => 2,
            Self::Spherical | Self::Planar => 3,
        }
    }
}

/// A joint between two links.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// What it lets move.
    pub kind: JointKind,
    /// From the frame before it to the frame after it: its motions with their axes and arguments, and the constant
    /// poses between them, as written in the first chain that passes it.
    pub steps: Vec<ChainStep>,
    /// Coordinates that move it, ascending.
    pub coordinates: Vec<usize>,
    /// Where its steps begin.
    pub before: LinkFrame,
    /// Where they end.
    pub after: LinkFrame,
    /// No loop passes it, and a formula with kinks moves it: a piece of rope on its drum, for example, is only placed
    /// by its formula, and nothing is joined there.
    pub is_placed: bool,
}

impl Joint {
    /// Arguments of its motions, in their order.
    pub fn arguments(&self) -> impl Iterator<Item = usize> + '_ {
        self.steps.iter().filter_map(|step| match step {
            ChainStep::Joint { argument, .. } => Some(*argument),
            ChainStep::Fixed(_) => None,
        })
    }

    /// Whether it connects the two links.
    fn connects_links(&self, a: usize, b: usize) -> bool {
        let own = [self.before.link, self.after.link];
        own == [a, b] || own == [b, a]
    }
}

/// A frame that moves with a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkFrame {
    /// Index of the link.
    pub link: usize,
    /// Where it is on the link.
    pub link_from_here: Pose,
}

/// A rigid part. Number 0 is the frame of the mechanism.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Link {
    /// Bodies that belong to it.
    pub bodies: Vec<usize>,
    /// The last part of a path to it, along the chains and closed loops.
    pub(super) route: usize,
}

/// A part of the paths to links: stored once, however many links it leads to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoutePart {
    /// The part before it; number 0 is the frame of the mechanism.
    pub(super) before: usize,
    /// From there on.
    pub(super) steps: Vec<ChainStep>,
}

/// The passage of a chain through a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    /// Index of the joint.
    pub joint: usize,
    /// Steps of the chain, from the joint's first motion to its last.
    pub steps: Range<usize>,
    /// Whether the chain goes from the link after the joint to the link before it.
    pub is_inverse: bool,
}

/// All joints and links of a mechanism.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Joints {
    /// In the order in which the chains of bodies, then loops, pass them first.
    pub list: Vec<Joint>,
    /// The frame first.
    pub links: Vec<Link>,
    /// Parts of the paths to the links.
    pub(super) routes: Vec<RoutePart>,
    /// Link of every body.
    pub of_body: Vec<usize>,
    /// Passages of every body's chain, in its order.
    pub along_bodies: Vec<Vec<Passage>>,
    /// Passages of every loop, in its order.
    pub along_loops: Vec<Vec<Passage>>,
    /// The start of every loop, relative to its first link.
    pub loop_starts: Vec<LinkFrame>,
    /// Whether a loop adds a condition to the loops before it.
    pub closes: Vec<bool>,
}

impl Joints {
    /// World from every link. Each part of the paths is evaluated once: in a long chain of links, individual chains
    /// would have as many steps as there are links.
    pub fn link_poses(&self, arguments: &[ArgumentValue]) -> Vec<Pose> {
        let mut ends: Vec<Pose> = Vec::with_capacity(self.routes.len());
        for part in &self.routes {
            // Parts come after those they continue; the first one is the frame.
            let mut here = ends.get(part.before).copied().unwrap_or(Pose::IDENTITY);
            walk_chain(&part.steps, &mut here, arguments, |_, _| {});
            ends.push(here);
        }
        let routes = self.links.iter().map(|link| link.route);
        routes
            .map(|part| ends.get(part).copied().unwrap_or(Pose::IDENTITY))
            .collect()
    }

    /// Chain from the world to a link.
    pub fn world_from_link(&self, link: usize) -> Chain {
        let mut parts = Vec::new();
        let mut part = self.links[link].route;
        while part != 0 {
            parts.push(&self.routes[part].steps);
            part = self.routes[part].before;
        }
        let steps = parts.into_iter().rev().flatten();
        Chain {
            steps: steps.copied().collect(),
        }
    }

    /// Chain from the world to a frame of a link.
    pub fn world_from(&self, frame: &LinkFrame) -> Chain {
        let mut chain = self.world_from_link(frame.link);
        if frame.link_from_here != Pose::IDENTITY {
            chain
                .steps
                .push(ChainStep::Fixed(frame.link_from_here.into()));
        }
        chain
    }

    /// Whether two bodies are one rigid part.
    pub fn are_rigid(&self, a: usize, b: usize) -> bool {
        self.of_body[a] == self.of_body[b]
    }

    /// The joint that directly connects two bodies.
    pub fn between(&self, a: usize, b: usize) -> Option<&Joint> {
        let [a, b] = [a, b].map(|body| self.of_body[body]);
        self.list.iter().find(|joint| joint.connects_links(a, b))
    }
}
