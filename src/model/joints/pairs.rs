//! Combines elementary motions between links into joints.

use super::joint::{EXACT, JointKind, LinkFrame};
use super::links::{Finished, LinkEdge, LoopCrossing};
use crate::model::chain::{Argument, ElementaryMotion};
use crate::model::mechanism::Mechanism;
use crate::sorting::sort_by_key;
use glam::DVec3;

/// Below this sine two intersecting axes are the same axis: no angle of a real joint is as small.
const PARALLEL: f64 = 1e-6;

/// Successive motions that form one joint.
pub struct MotionRun {
    pub kind: JointKind,
    /// Passed in this direction.
    pub crossings: Vec<LoopCrossing>,
}

/// The data from which joints are determined.
pub struct PairRows<'a> {
    graph: &'a Finished,
    /// The unit of lengths at every edge: the largest of its loops' units.
    sizes: Vec<f64>,
    /// Whether a link may be inside a joint.
    is_inner: Vec<bool>,
    /// Coordinates of every edge.
    coordinates: Vec<Vec<usize>>,
    /// Whether its argument is a coordinate scaled and shifted, or a sum of such.
    is_affine: Vec<bool>,
    /// The edges and equations in which every coordinate appears.
    uses: Vec<usize>,
    /// Coordinates from this one on are inputs.
    first_input: usize,
    /// Whether a loop of at most [`WITHIN_PLANE`] motions passes the edge.
    is_of_short_loop: Vec<bool>,
}

/// A loop of so many motions, three of which would be one planar joint, moves in the plane of that joint, which then guides nothing.
const WITHIN_PLANE: usize = 4;

/// For every edge the largest unit of the loops that pass it; the mechanism's if there is none.
fn link_sizes(mechanism: &Mechanism, graph: &Finished) -> Vec<f64> {
    let mut sizes = vec![0.0_f64; graph.edges.len()];
    for (item, path) in mechanism.loops.iter().zip(&graph.paths.loops) {
        for stride in path.iter().flatten() {
            let size = &mut sizes[stride.crossing.edge];
            *size = size.max(item.size);
        }
    }
    let known = sizes.into_iter();
    known
        .map(|size| if size > 0.0 { size } else { mechanism.size })
        .collect()
}

/// For every edge whether a loop of few motions passes it.
fn edges_of_short_loops(graph: &Finished) -> Vec<bool> {
    let mut is_of_short = vec![false; graph.edges.len()];
    for path in &graph.paths.loops {
        let edges: Vec<usize> = path.iter().flatten().map(|s| s.crossing.edge).collect();
        if edges.len() <= WITHIN_PLANE {
            edges.into_iter().for_each(|edge| is_of_short[edge] = true);
        }
    }
    is_of_short
}

impl<'a> PairRows<'a> {
    pub fn new(mechanism: &Mechanism, graph: &'a Finished) -> Self {
        let of_edge = |edge: &Option<LinkEdge>| {
            let argument = edge.as_ref().map(|e| &mechanism.arguments[e.argument]);
            argument.map_or_else(Vec::new, |argument| argument.coordinates())
        };
        let is_affine = |edge: &Option<LinkEdge>| {
            let argument = edge.as_ref().map(|e| &mechanism.arguments[e.argument]);
            matches!(argument, Some(Argument::Affine(_)))
        };
        let coordinates: Vec<Vec<usize>> = graph.edges.iter().map(of_edge).collect();
        // How often a coordinate is used, by edges and equations: joints may only combine those used once.
        let mut uses = vec![0; mechanism.coordinate_count()];
        let equations = mechanism.equations.iter().map(|e| e.expression.slots());
        for slot in coordinates.iter().cloned().chain(equations).flatten() {
            uses[slot] += 1;
        }
        // A link is inside a joint if just two motions meet there and no body or loop ends on it.
        let mut is_inner: Vec<bool> = graph.at.iter().map(|edges| edges.len() == 2).collect();
        let seen = graph.of_body.iter().chain(&graph.loop_ends).chain(&[0]);
        seen.for_each(|link| is_inner[*link] = false);
        Self {
            graph,
            sizes: link_sizes(mechanism, graph),
            is_inner,
            is_affine: graph.edges.iter().map(is_affine).collect(),
            coordinates,
            uses,
            first_input: mechanism.unknowns.len(),
            is_of_short_loop: edges_of_short_loops(graph),
        }
    }

    /// All joints, in the order of their first motions.
    pub fn runs(&self) -> Vec<MotionRun> {
        let mut taken = vec![false; self.graph.edges.len()];
        let mut runs = Vec::new();
        for (index, edge) in self.graph.edges.iter().enumerate() {
            if edge.is_none() || taken[index] {
                continue;
            }
            let row = self.row(index);
            row.iter().for_each(|crossing| taken[crossing.edge] = true);
            runs.extend(self.parted(&row));
        }
        sort_by_key(&mut runs, |run| run.crossings.iter().map(|c| c.edge).min());
        runs
    }

    /// All successive motions around this one, with inner links between them.
    fn row(&self, edge: usize) -> Vec<LoopCrossing> {
        let forward = LoopCrossing {
            edge,
            is_inverse: false,
        };
        let mut row: Vec<LoopCrossing> = self.onward(forward.inverse(), edge);
        row.iter_mut().for_each(|c| *c = c.inverse());
        row.reverse();
        let met: Vec<usize> = row.iter().map(|c| c.edge).collect();
        row.push(forward);
        let ahead = self.onward(forward, edge);
        row.extend(ahead.into_iter().filter(|c| !met.contains(&c.edge)));
        row
    }

    /// The motions that follow over inner links, up to the first one again.
    fn onward(&self, mut last: LoopCrossing, first: usize) -> Vec<LoopCrossing> {
        let mut list = Vec::new();
        while let Some(next) = self.next(last).filter(|next| next.edge != first) {
            list.push(next);
            last = next;
        }
        list
    }

    /// The only motion after the inner link that a motion leads to.
    fn next(&self, last: LoopCrossing) -> Option<LoopCrossing> {
        let link = self.ends(last)?[1].link;
        if !self.is_inner[link] {
            return None;
        }
        let edge = *self.graph.at[link]
            .iter()
            .find(|edge| **edge != last.edge)?;
        let ends = &self.graph.edges[edge].as_ref()?.ends;
        let is_inverse = ends[0].link != link;
        Some(LoopCrossing { edge, is_inverse })
    }

    fn ends(&self, crossing: LoopCrossing) -> Option<[LinkFrame; 2]> {
        let [before, after] = self.graph.edges[crossing.edge].as_ref()?.ends;
        Some(if crossing.is_inverse {
            [after, before]
        } else {
            [before, after]
        })
    }

    /// Links within joints.
    pub fn within(&self, runs: &[MotionRun]) -> Vec<bool> {
        let mut is_within = vec![false; self.graph.at.len()];
        for run in runs {
            let ends = run.crossings.iter().filter_map(|c| self.ends(*c));
            let behind: Vec<usize> = ends.map(|ends| ends[1].link).collect();
            let inner = behind.len().saturating_sub(1);
            behind[..inner]
                .iter()
                .for_each(|link| is_within[*link] = true);
        }
        is_within
    }

    /// Divides successive motions into joints: first three unknown angles about perpendicular axes (they reach every
    /// rotation), then any three motions, two, one.
    fn parted(&self, row: &[LoopCrossing]) -> Vec<MotionRun> {
        let is_full = |part: &[LoopCrossing]| {
            let mut slots = part.iter().flat_map(|c| &self.coordinates[c.edge]);
            let mut corners = part.windows(2).map(|c| self.corner(c));
            slots.all(|slot| *slot < self.first_input)
                && corners.all(|corner| corner.is_some_and(|c| c.is_right()))
        };
        let mut runs: Vec<MotionRun> = Vec::new();
        let mut free = vec![true; row.len()];
        // The longest runs first, so that a universal joint is not taken out of a spherical one.
        for (length, full_only) in [(3, true), (3, false), (2, false), (1, false)] {
            let mut first = 0;
            while first + length <= row.len() {
                let part = first..first + length;
                let crossings = &row[part.clone()];
                let fits = free[part.clone()].iter().all(|free| *free)
                    && (!full_only || is_full(crossings));
                match fits.then(|| self.kind(crossings)).flatten() {
                    Some(kind) => {
                        let crossings = crossings.to_vec();
                        runs.push(MotionRun { kind, crossings });
                        free[part.clone()].iter_mut().for_each(|free| *free = false);
                        first = part.end;
                    }
                    None => first += 1,
                }
            }
        }
        runs
    }

    /// The kind of joint of successive motions; `None` if they are not one joint.
    fn kind(&self, crossings: &[LoopCrossing]) -> Option<JointKind> {
        use ElementaryMotion::{Rotation, Translation};
        let motions: Vec<ElementaryMotion> = crossings
            .iter()
            .filter_map(|c| Some(self.graph.edges[c.edge].as_ref()?.motion))
            .collect();
        match motions[..] {
            [Rotation] => return Some(JointKind::Revolute),
            [Translation] => return Some(JointKind::Prismatic),
            _ => {}
        }
        // The lead of a screw is the same at every angle; a formula of an angle is a cam.
        let is_coupled = crossings.windows(2).all(|pair| {
            let [a, b] = [&pair[0], &pair[1]].map(|c| &self.coordinates[c.edge]);
            a == b && a.len() == 1 && pair.iter().all(|c| self.is_affine[c.edge])
        });
        if !self.are_alone(crossings, is_coupled) {
            return None;
        }
        let corners: Option<Vec<PairCorner>> =
            crossings.windows(2).map(|c| self.corner(c)).collect();
        match (&motions[..], &corners?[..]) {
            ([Rotation, Rotation], [corner]) if !is_coupled && corner.meets() => {
                Some(JointKind::Universal)
            }
            ([Rotation, Translation] | [Translation, Rotation], [corner])
                if corner.is_parallel() =>
            {
                Some(if is_coupled {
                    JointKind::Helical
                } else {
                    JointKind::Cylindrical
                })
            }
            ([Rotation, Rotation, Rotation], [one, other])
                if one.meets()
                    && other.meets()
                    && (one.behind - other.before).abs() <= EXACT * one.size.max(other.size) =>
            {
                Some(JointKind::Spherical)
            }
            ([a, b, c], [one, other]) if is_planar([*a, *b, *c], [one, other]) => {
                let is_idle = crossings.iter().any(|c| self.is_of_short_loop[c.edge]);
                (!is_idle).then_some(JointKind::Planar)
            }
            _ => None,
        }
    }

    /// Whether the coordinates of successive motions appear nowhere else, and each in only one of them (for coupled
    /// motions all in all).
    fn are_alone(&self, crossings: &[LoopCrossing], is_coupled: bool) -> bool {
        let own = if is_coupled { crossings.len() } else { 1 };
        let mut slots = crossings.iter().flat_map(|c| &self.coordinates[c.edge]);
        (!is_coupled || crossings.len() == 2) && slots.all(|slot| self.uses[*slot] == own)
    }

    pub fn coordinates_of(&self, crossings: &[LoopCrossing]) -> Vec<usize> {
        let slots = crossings.iter().flat_map(|c| &self.coordinates[c.edge]);
        let mut slots: Vec<usize> = slots.copied().collect();
        slots.sort_unstable();
        slots.dedup();
        slots
    }

    /// The relative position of the axes of two motions on the link between them.
    fn corner(&self, pair: &[LoopCrossing]) -> Option<PairCorner> {
        let before = self.ends(*pair.first()?)?[1].link_from_here;
        let behind = self.ends(*pair.last()?)?[0].link_from_here;
        let (u, v) = (before.rotation.z_axis, behind.rotation.z_axis);
        let way = behind.translation - before.translation;
        let normal = u.cross(v);
        let sine = normal.length();
        // Feet of the common normal along both axes; of parallel axes there is none.
        let square = sine * sine;
        let along = |axis: DVec3| way.cross(axis).dot(normal) / square;
        let size = pair.iter().fold(0.0_f64, |m, c| m.max(self.sizes[c.edge]));
        Some(PairCorner {
            size,
            sine,
            cosine: u.dot(v),
            apart: way.dot(normal).abs() / (sine * size),
            before: along(v),
            behind: along(u),
            first: behind.rotation.transpose() * u,
            second: before.rotation.transpose() * v,
        })
    }
}

/// Two axes on a link.
struct PairCorner {
    /// The unit of lengths.
    size: f64,
    sine: f64,
    cosine: f64,
    /// Their distance over the size, if they are not parallel.
    apart: f64,
    /// Where their common normal meets the first, and the second, from the origins of their frames.
    before: f64,
    behind: f64,
    /// Direction of the first in the frame of the second, and of the second in the frame of the first.
    first: DVec3,
    second: DVec3,
}

impl PairCorner {
    fn meets(&self) -> bool {
        self.sine > PARALLEL && self.apart <= EXACT
    }

    fn is_parallel(&self) -> bool {
        self.sine <= EXACT
    }

    fn is_right(&self) -> bool {
        self.cosine.abs() <= EXACT
    }
}

/// Whether motions are two translations and a rotation about the normal of their plane.
fn is_planar(motions: [ElementaryMotion; 3], [one, other]: [&PairCorner; 2]) -> bool {
    use ElementaryMotion::{Rotation, Translation};
    // A translation in the middle turns nothing: the outer axes keep their angle.
    let outer_are_right = one.first.dot(other.second).abs() <= EXACT;
    match motions {
        // With the rotation between them the translations are parallel now and then only.
        [Translation, Rotation, Translation] => one.is_right() && other.is_right(),
        [Translation, Translation, Rotation] => {
            one.sine > PARALLEL && other.is_right() && outer_are_right
        }
        [Rotation, Translation, Translation] => {
            one.is_right() && other.sine > PARALLEL && outer_are_right
        }
        _ => false,
    }
}
