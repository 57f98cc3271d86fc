//! Bounds of the distance of a mesh and another element during a short motion.
//!
//! Triangles are convex, so that a plane between two of them bounds their distance to second order in the time. The same
//! plane bounds the distance of all triangles of two nodes, by their boxes or their support; only nodes that it does
//! not separate are split, down to pairs of triangles with their own planes.

use super::look::lower_of;
use super::meeting::Meeting;
use super::slab::Slab;
use crate::distance::boxes::OrientedBox;
use crate::distance::point::point_to;
use crate::distance::primitive::{Element, Primitive};
use crate::distance::triangle_tree::{Content, TriangleTree, corner_support, nearer_first};
use crate::math::Pose;
use glam::DVec3;

/// Maximum number of pairs of nodes that are split for one bound: the others count with the bound they have.
const MOST_SPLITS: usize = 4_000;

/// For nodes with fewer triangles the boxes are sufficient.
const WORTH_A_CLIMB: usize = 16;

/// A part of an element at its position in the middle of the time.
#[derive(Clone, Copy)]
enum MeetingPart<'e> {
    /// A core other than a mesh.
    Solid(&'e Primitive),
    /// The triangles of a node of a placed mesh.
    Node(&'e TriangleTree, &'e Pose, usize),
}

impl<'e> MeetingPart<'e> {
    fn new(core: &'e Primitive) -> Self {
        match core {
            Primitive::Mesh(mesh, pose) => Self::Node(&mesh.tree, pose, 0),
            solid => Self::Solid(solid),
        }
    }

    fn around(tree: &TriangleTree, node: usize) -> &OrientedBox {
        &tree.nodes[node].around
    }

    /// The largest n · p of its points.
    fn support(self, n: DVec3) -> Option<f64> {
        match self {
            Self::Solid(core) => core.support(n),
            Self::Node(tree, pose, node) => {
                let local = pose.rotation.transpose() * n;
                Some(n.dot(pose.translation) + Self::around(tree, node).support(local))
            }
        }
    }

    /// The same, from its corners.
    fn exact_support(self, n: DVec3) -> Option<f64> {
        match self {
            Self::Solid(core) => core.support(n),
            Self::Node(tree, pose, node) => {
                let local = pose.rotation.transpose() * n;
                Some(n.dot(pose.translation) + tree.highest(node, local).height)
            }
        }
    }

    fn ball(self) -> (DVec3, f64) {
        match self {
            Self::Solid(core) => core.bounds(),
            Self::Node(tree, pose, node) => {
                let around = Self::around(tree, node);
                (pose.transform_point(around.centre), around.radius)
            }
        }
    }

    /// Its two halves, if it is a node that has some.
    fn halves(self) -> Option<[Self; 2]> {
        match self {
            Self::Node(tree, pose, node) => match tree.nodes[node].content {
                Content::Fork(second) => {
                    Some([node + 1, second].map(|k| Self::Node(tree, pose, k)))
                }
                Content::Leaf(..) => None,
            },
            Self::Solid(_) => None,
        }
    }

    /// How many nodes lie below the first of its halves.
    fn weight(self) -> usize {
        match self {
            Self::Node(tree, _, node) => match tree.nodes[node].content {
                Content::Fork(second) => second - node,
                Content::Leaf(..) => 0,
            },
            Self::Solid(_) => 0,
        }
    }
}

/// The triangles of a leaf with where they are placed, or the one other core.
fn part_cores<'e>(
    part: MeetingPart<'e>,
    element: &'e Element,
) -> impl Iterator<Item = Primitive> + 'e {
    let (list, pose, solid): (&[[DVec3; 3]], _, _) = match (part, &element.core) {
        (MeetingPart::Node(tree, _, node), Primitive::Mesh(_, pose)) => {
            match tree.nodes[node].content {
                Content::Leaf(start, end) => (&tree.triangles[start..end], *pose, None),
                Content::Fork(_) => (&[], *pose, None),
            }
        }
        (_, core) => (&[], Pose::IDENTITY, Some(core.clone())),
    };
    let placed = list
        .iter()
        .map(move |t| Primitive::Triangle(t.map(|p| pose.transform_point(p))));
    placed.chain(solid)
}

struct MeetingSearch<'e> {
    meeting: &'e Meeting<'e>,
    slabs: [Option<Slab>; 3],
    goals: [f64; 2],
    lowest: f64,
    splits: usize,
}

/// Lower bound of the distance, as accurate as the goals require.
pub(super) fn lower_bound(meeting: &Meeting, goals: [f64; 2]) -> f64 {
    let parts = [
        MeetingPart::new(&meeting.a.core),
        MeetingPart::new(&meeting.b.core),
    ];
    let mut search = MeetingSearch {
        meeting,
        slabs: meeting.slabs(),
        goals,
        lowest: f64::INFINITY,
        splits: MOST_SPLITS,
    };
    let is_empty =
        |part: &MeetingPart| matches!(part, MeetingPart::Node(tree, ..) if tree.is_empty());
    if !parts.iter().any(is_empty) {
        let whole = search.bound(parts);
        search.visit(parts, whole);
    }
    search.lowest
}

impl<'e> MeetingSearch<'e> {
    /// Nothing above this needs a closer look.
    fn enough(&self) -> f64 {
        self.goals[1].min(self.lowest)
    }

    fn slab(&self, goal: f64, supports: impl Fn([DVec3; 2]) -> Option<f64> + Copy) -> f64 {
        let gaps = self.slabs.iter().flatten();
        let gaps = gaps.filter_map(|slab| slab.gap(goal, supports));
        gaps.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Lower bound for two parts: their boxes along the plane, or the distance in the middle minus the displacement.
    fn bound(&self, [a, b]: [MeetingPart<'e>; 2]) -> f64 {
        // Boxes are too rough for a refinement.
        let supports = |[n, back]: [DVec3; 2]| Some(a.support(n)? + b.support(back)?);
        let flat = self.slab(f64::INFINITY, supports);
        if flat >= self.enough() {
            return flat;
        }
        let way = match (b, &self.meeting.mine.core) {
            (MeetingPart::Node(tree, _, node), Primitive::Mesh(_, pose)) => {
                let around = MeetingPart::around(tree, node);
                let centre = pose.transform_point(around.centre);
                self.meeting.moved.distance((centre, around.radius))
            }
            _ => self.meeting.moved.distance(self.meeting.mine.bounds()),
        };
        flat.max(self.apart([a, b]) - way)
    }

    /// The same in the middle of the time.
    fn apart(&self, [a, b]: [MeetingPart<'e>; 2]) -> f64 {
        let [(p, r), (q, s)] = [a.ball(), b.ball()];
        let seen = |core: &Primitive, centre: DVec3, radius: f64| match point_to(core, centre) {
            Some(hit) => (hit.normal, hit.distance - radius),
            None => (DVec3::ZERO, f64::NEG_INFINITY),
        };
        let (n, of_balls) = match (a, b) {
            (MeetingPart::Solid(core), _) => seen(core, q, s),
            (_, MeetingPart::Solid(core)) => {
                let (n, apart) = seen(core, p, r);
                (-n, apart)
            }
            _ => {
                let span = q - p;
                (span.normalize_or_zero(), span.length() - r - s)
            }
        };
        let supports = a.support(n).zip(b.support(-n)).filter(|_| n != DVec3::ZERO);
        // The plane between the two, or their balls: the better bound counts.
        let flat = supports.map_or(f64::NEG_INFINITY, |(a, b)| -a - b);
        of_balls.max(flat) - self.meeting.radii()
    }

    fn lower(&mut self, bound: f64) {
        self.lowest = lower_of(self.lowest, bound);
    }

    /// Lowers the bound to that of two parts, as far as needed.
    fn visit(&mut self, parts: [MeetingPart<'e>; 2], bound: f64) {
        if bound >= self.enough() {
            self.lower(bound);
            return;
        }
        let [a, b] = parts;
        let halves = [a.halves(), b.halves()];
        if halves.iter().all(Option::is_none) {
            return self.leaves(parts);
        }
        if a.weight().max(b.weight()) > WORTH_A_CLIMB {
            let supports =
                |[n, back]: [DVec3; 2]| Some(a.exact_support(n)? + b.exact_support(back)?);
            let exact = self.slab(self.enough(), supports);
            if exact >= self.enough() {
                self.lower(exact);
                return;
            }
        }
        if self.splits == 0 {
            self.lower(bound);
            return;
        }
        self.splits -= 1;
        // The larger part is split.
        let next = match halves {
            [Some(mine), None] => mine.map(|a| [a, b]),
            [Some(mine), Some(_)] if a.ball().1 >= b.ball().1 => mine.map(|a| [a, b]),
            [_, Some(theirs)] => theirs.map(|b| [a, b]),
            [None, None] => return,
        };
        for (parts, bound) in nearer_first(next.map(|parts| (parts, self.bound(parts)))) {
            self.visit(parts, bound);
        }
    }

    /// Every triangle against every one of another leaf, or against the other core.
    fn leaves(&mut self, [a, b]: [MeetingPart<'e>; 2]) {
        let Meeting {
            a: first,
            b: second,
            mine,
            moved,
            ..
        } = *self.meeting;
        let of = |core: Primitive, element: &Element| Element { core, ..*element };
        for (theirs, own) in part_cores(b, second).zip(part_cores(b, mine)) {
            for core in part_cores(a, first) {
                let flat = self.slab(self.enough(), |[n, back]| {
                    Some(core_reach(&core, n)? + core_reach(&theirs, back)?)
                });
                let low = if flat >= self.enough() {
                    flat
                } else {
                    let (a, b) = (of(core, first), of(theirs.clone(), second));
                    let own = of(own.clone(), mine);
                    let near = Meeting::new(&a, &b, &own, moved);
                    flat.max(near.below(self.goals))
                };
                self.lower(low);
                if self.lowest < self.goals[0] {
                    // The time is too long: the rest need not be known well.
                    self.splits = 0;
                }
            }
        }
    }
}

fn core_reach(core: &Primitive, n: DVec3) -> Option<f64> {
    match core {
        Primitive::Triangle(corners) => Some(corner_support(corners, n)),
        core => core.support(n),
    }
}
