//! Two bodies over a motion: their distances at its poses, and what counts as near enough. What lies between the poses is
//! found by `branch_and_bound`.

use super::motion::ProvedMotion;
use super::relative::RelativeChain;
use super::track::PairTrack;
use crate::distance::bodies::{BodyElements, BodyProximity, LeftOut, enclosed_shell};
use crate::distance::mesh;
use crate::distance::pair::is_inside;
use crate::distance::primitive::{Element, Primitive};
use crate::math::Pose;
use crate::model::joints::EXACT;
use crate::numbers::rounding::CHAIN_FACTOR;
use glam::DVec3;

/// A distance and its bound are as many operations as so many steps of a chain: each of them rounds once.
const STEPS: usize = 16;

/// By how much the search along a circle may miss the nearest point, as a fraction of the circle's radius and of the other
/// curve's length.
const SEARCHED: f64 = 2e-11;

/// A pair passes where the bound is no farther below the minimum than this, in radii of the smaller body's ball: bodies that
/// keep exactly their minimum cannot be proved to more. How far they are from their origins, or from each other, is of no
/// account: what that costs is taken off the bound.
pub const JUDGED: f64 = 1e-9;

/// A minimum, in radii of the smaller body's ball, below which the bound need not be finer than its share.
const SMALLEST_SCALE: f64 = 1e-4;

/// The least distance of two bodies over the motion.
#[derive(Clone, Debug)]
pub struct Least {
    /// Signed distance, as [`signed_distance`](crate::distance::pair::signed_distance) defines it.
    pub distance: f64,
    /// When, seconds.
    pub time: f64,
    /// The points, in the world.
    pub points: [DVec3; 2],
    /// The shapes, as indices into the bodies' lists.
    pub shapes: [usize; 2],
    /// One lies wholly in the other: the first, the second.
    pub inside: [bool; 2],
    /// One lies in the other, a mesh among them: how deep is not known, and the distance is zero.
    pub is_enclosed: bool,
    /// Lower bound of the distance; negative infinity if unknown.
    pub bound: f64,
    /// The bound is proved, not estimated.
    pub is_certified: bool,
    /// Whether the bound is as close to the distance as requested.
    pub is_refined: bool,
}

/// Two bodies over a motion.
pub struct PairSweep<'a> {
    pub(super) bodies: [usize; 2],
    pub(super) hulls: [&'a BodyElements; 2],
    pub(super) chain: RelativeChain,
    /// How the first body moves as seen from the second: for elements of the second one that have no end.
    pub(super) back: Option<RelativeChain>,
    tolerance: f64,
    minimum: f64,
    /// No bound need be finer than this share of it.
    least_scale: f64,
    /// Length of the chain between the bodies by their frames, with their own.
    pub(super) extent: f64,
    /// What poses and the search for a distance may be off.
    off: f64,
    /// Pairs of elements that do not count.
    pub(super) left_out: LeftOut,
    is_swapped: bool,
}

/// The least distance so far, at an exact pose.
pub(super) struct NearestPose {
    pub(super) found: BodyProximity,
    pub(super) instant: usize,
    /// At none of the poses looked at anything is nearer than this below the distance found there.
    pub(super) missed: f64,
    /// A mesh encloses the other body, or is enclosed: the distance is zero then.
    pub(super) is_enclosed: bool,
}

/// No point that a chain of this length carries is farther from its exact place at a sampled time: for rounding, and for what the
/// unknowns are off.
pub(super) fn slack_of_poses(motion: &ProvedMotion, chain: &RelativeChain, extent: f64) -> f64 {
    let sizes = (extent / motion.system.mechanism().size).max(1.0);
    let rounding = CHAIN_FACTOR * (STEPS + chain.steps().len()) as f64 * extent;
    rounding + motion.pose_error * sizes * chain.joints() as f64
}

/// The chain by the one joint between two bodies that a loop closes: what only carries both of them along has no part in how
/// they move as seen from each other.
fn by_joint(motion: &ProvedMotion, [a, b]: [usize; 2]) -> Option<RelativeChain> {
    let joints = &motion.system.mechanism().joints;
    let joint = joints.between(a, b)?;
    let first = *motion.samples.first()?;
    let arguments = &motion.instants[first].arguments;
    let is_inverse = joints.of_body[a] != joint.before.link;
    let [from, to] = if is_inverse { [b, a] } else { [a, b] };
    let link_from = |body: usize| {
        let world_from_link = joints.world_from_link(joints.of_body[body]).pose(arguments);
        world_from_link.inverse() * motion.body_pose(first, body)
    };
    let before = link_from(from).inverse() * joint.before.link_from_here;
    let after = joint.after.link_from_here.inverse() * link_from(to);
    let chain = RelativeChain::of_joint(&joint.steps, [before, after]);
    Some(if is_inverse { chain.back() } else { chain })
}

/// The radius of the smaller ball around two bodies, zero if both have no end.
fn smaller_radius(hulls: [&BodyElements; 2]) -> f64 {
    let radius = hulls[0].ball.1.min(hulls[1].ball.1);
    if radius.is_finite() { radius } else { 0.0 }
}

/// The longest curve of two hulls along which a distance is searched: circles, and the elements compared with them.
fn searched_length(hulls: [&BodyElements; 2]) -> f64 {
    let all = || hulls.into_iter().flat_map(|hull| &hull.elements);
    let has_ring = all().any(|e| e.core.circle().is_some());
    let length = |e: &Element| match &e.core {
        Primitive::Circle(circle) => circle.radius,
        Primitive::Frustum(f) => f.radii[0].max(f.radii[1]),
        Primitive::Segment([a, b]) if has_ring => a.distance(*b),
        _ => 0.0,
    };
    all().map(length).fold(0.0, f64::max)
}

impl<'a> PairSweep<'a> {
    /// Bodies by index with their hulls, and the least distance that passes. `tolerance` is relative to that, or to the
    /// distance where it is zero.
    pub fn new(
        motion: &ProvedMotion,
        bodies: [usize; 2],
        hulls: [&'a BodyElements; 2],
        tolerance: f64,
        minimum: f64,
    ) -> Self {
        // The smaller body is the one that is seen to move: turning carries its points less far.
        let swap = hulls[0].ball.1 < hulls[1].ball.1;
        let order = |pair: [usize; 2]| if swap { [pair[1], pair[0]] } else { pair };
        let bodies = order(bodies);
        let hulls = if swap { [hulls[1], hulls[0]] } else { hulls };
        let chain = |k: usize| &motion.system.mechanism().bodies[bodies[k]].world_from_body;
        let is_endless = |e: &Element| matches!(e.core, Primitive::HalfSpace(_));
        let back = hulls[1].elements.iter().any(is_endless);
        let own = RelativeChain::new(chain(0), chain(1));
        let reach = |(centre, radius): (DVec3, f64)| centre.length() + radius;
        let reaches = hulls.map(|hull| reach(hull.ball));
        let finite = reaches.into_iter().filter(|reach| reach.is_finite());
        let extent = own.longest(motion.poses()) + finite.sum::<f64>();
        let mut off = slack_of_poses(motion, &own, extent) + SEARCHED * searched_length(hulls);
        let joints = own.joints();
        let shorter = (joints > 1).then(|| by_joint(motion, bodies)).flatten();
        let shorter = shorter.filter(|c| c.joints() < joints);
        if shorter.is_some() {
            // Frames of one link agree to this.
            off += 2.0 * EXACT * motion.system.mechanism().size;
        }
        let own = shorter.unwrap_or(own);
        Self {
            bodies,
            hulls,
            back: back.then(|| own.back()),
            chain: own,
            tolerance,
            minimum,
            least_scale: SMALLEST_SCALE * smaller_radius(hulls),
            extent,
            off,
            left_out: LeftOut::default(),
            is_swapped: swap,
        }
    }

    /// Without these pairs of elements, of the first and the second body as they were given.
    pub fn without(mut self, pairs: &[[usize; 2]]) -> Self {
        let swap = self.is_swapped;
        let own = pairs
            .iter()
            .map(|[i, j]| if swap { [*j, *i] } else { [*i, *j] });
        self.left_out = own.collect();
        self
    }

    /// With nothing but the pairs of elements that it leaves out.
    pub fn complement(self) -> Self {
        let pairs = self.complement_pairs();
        self.without(&pairs)
    }

    /// Pairs of elements that are not left out, of the first and the second body as they were given.
    pub fn complement_pairs(&self) -> Vec<[usize; 2]> {
        let [m, n] = self.hulls.map(|hull| hull.elements.len());
        let all = (0..m).flat_map(|i| (0..n).map(move |j| [i, j]));
        let other = all.filter(|pair| !self.left_out.contains(pair));
        let own = |[i, j]: [usize; 2]| if self.is_swapped { [j, i] } else { [i, j] };
        other.map(own).collect()
    }

    /// The same with another least distance that passes.
    pub fn with_minimum(self, minimum: f64) -> Self {
        Self { minimum, ..self }
    }

    /// How far the bound of a pair that passes may be below its minimum.
    pub fn slack(&self) -> f64 {
        JUDGED * smaller_radius(self.hulls).max(self.minimum.abs())
    }

    /// The radius of the smaller ball around a body; zero if both have no end.
    pub(super) fn smaller_radius(&self) -> f64 {
        smaller_radius(self.hulls)
    }

    /// The smallest bound that passes: a bound of exactly the minimum cannot be proved because of rounding.
    pub(super) fn enough(&self) -> f64 {
        self.minimum - self.slack()
    }

    /// Whether two elements meet and one is a mesh: meshes have no depth, so that only the contact itself is known.
    pub(super) fn meets(&self, [i, j]: [usize; 2], distance: f64) -> bool {
        let elements = [&self.hulls[0].elements[i], &self.hulls[1].elements[j]];
        distance <= 0.0 && mesh::is_any(elements)
    }

    /// Replaces the depth of a mesh, which has none: lower than all informative distances.
    pub(super) fn deepest(&self) -> f64 {
        -self.extent
    }

    /// A lower bound, limited to informative values. No depth exceeds the sum of the radii of the balls around both bodies,
    /// wherever they are: at that distance the balls are apart.
    pub(super) fn told(&self, bound: f64) -> f64 {
        let deepest = -self.hulls.iter().map(|hull| hull.ball.1).sum::<f64>();
        // A mesh has no depth.
        let is_solid = !self.hulls.iter().any(|hull| hull.has_mesh());
        if bound > deepest && bound > self.deepest() {
            bound
        } else if is_solid && deepest >= self.enough() {
            deepest
        } else {
            f64::NEG_INFINITY
        }
    }

    /// The least distance that passes.
    pub(super) fn minimum(&self) -> f64 {
        self.minimum
    }

    /// No point of a sampled pose is farther from its exact place, as seen from the other body.
    pub(super) const fn pose_slack(&self) -> f64 {
        self.off
    }

    /// The value that the bound must reach to be as close to the smallest distance as requested, and as known.
    pub(super) fn target(&self, best: &NearestPose) -> f64 {
        let near = best.found.proximity.distance;
        let scale = if self.minimum == 0.0 {
            near.abs()
        } else {
            self.minimum.abs()
        };
        near - best.missed - self.tolerance * scale.max(self.least_scale)
    }

    pub(super) fn relative(&self, motion: &ProvedMotion, instant: usize) -> Pose {
        self.chain.pose(&motion.instants[instant].arguments)
    }

    /// The least distance of the given poses, without a bound; fills `distances` with all of them, and
    /// is quicker if they are not asked for.
    pub fn sampled(
        &self,
        motion: &mut ProvedMotion,
        instants: &[usize],
        distances: Option<&mut Vec<f64>>,
    ) -> Option<Least> {
        let best = self.best_of(motion, instants, distances)?;
        let bound = best.found.proximity.distance - best.missed;
        Some(self.least(motion, &best, bound, [false; 2]))
    }

    /// No pose that stands alone, and belongs to no stretch, is nearer.
    pub(super) fn lowest_alone(&self, motion: &ProvedMotion) -> f64 {
        // All of their distances, since those that are not the least may be known less well.
        let best = self.best_of(motion, &motion.alone(), Some(&mut Vec::new()));
        best.map_or(f64::INFINITY, |best| {
            best.found.proximity.distance - best.missed
        })
    }

    pub(super) fn best_of(
        &self,
        motion: &ProvedMotion,
        instants: &[usize],
        mut distances: Option<&mut Vec<f64>>,
    ) -> Option<NearestPose> {
        let mut best: Option<NearestPose> = None;
        let mut track = PairTrack::new(self.hulls, &self.left_out);
        // Pairs whose bound is above the least distance so far are left out.
        for &instant in instants {
            let least = best.as_ref().map(|b| b.found.proximity.distance);
            let limit = match (&distances, least) {
                (None, Some(least)) => least - self.pose_slack(),
                _ => f64::INFINITY,
            };
            let found = track.at(&self.relative(motion, instant), limit);
            // One for each instant: bodies that are beyond all numbers are infinitely far apart.
            let distance = found.as_ref().map(|found| found.proximity.distance);
            if let Some(list) = &mut distances {
                list.push(distance.unwrap_or(f64::INFINITY));
            }
            let (Some(found), Some(distance)) = (found, distance) else {
                continue;
            };
            let missed = best.as_ref().map_or(0.0, |best| best.missed);
            let missed = missed.max(found.proximity.missed);
            match &mut best {
                Some(best) if least.is_some_and(|least| distance >= least) => best.missed = missed,
                _ => {
                    best = Some(NearestPose {
                        found,
                        instant,
                        missed,
                        is_enclosed: false,
                    });
                }
            }
        }
        // Surfaces that never touch stay inside or outside of each other over a continuous motion: one pose decides.
        let first = instants.first();
        let anew = instants.iter().skip(1).filter(|k| motion.begins_anew(**k));
        for &instant in first.into_iter().chain(anew) {
            if let Some(best) = &mut best
                && (best.found.proximity.distance > 0.0 || self.minimum < 0.0)
                && let Some(elements) = enclosed_shell(
                    self.hulls[0],
                    self.hulls[1],
                    &self.relative(motion, instant),
                    &self.left_out,
                )
            {
                best.is_enclosed = true;
                // Of other elements that are in each other the depth is known.
                if best.found.proximity.distance > 0.0 {
                    best.found.elements = elements;
                    best.found.proximity.distance = 0.0;
                    best.instant = instant;
                }
            }
        }
        best
    }

    /// The report of the least distance.
    pub(super) fn least(
        &self,
        motion: &ProvedMotion,
        best: &NearestPose,
        bound: f64,
        [is_certified, is_refined]: [bool; 2],
    ) -> Least {
        let found = best.found;
        let a_from_b = self.relative(motion, best.instant);
        let instant = &motion.instants[best.instant];
        let world_from_a = motion.body_pose(best.instant, self.bodies[0]);
        // The two elements as the first body sees them.
        let [i, j] = found.elements;
        let (first, second) = (
            &self.hulls[0].elements[i],
            self.hulls[1].elements[j].moved(&a_from_b),
        );
        let distance = found.proximity.distance;
        let mut inside = [false; 2];
        if distance < 0.0 {
            inside = [is_inside(first, &second), is_inside(&second, first)];
        }
        let points = found
            .proximity
            .points
            .map(|p| world_from_a.transform_point(p));
        let mut least = Least {
            distance,
            time: instant.time,
            points,
            shapes: [first.shape, second.shape],
            inside,
            is_enclosed: best.is_enclosed,
            bound,
            // What lies in an open mesh is not noticed.
            is_certified: is_certified && !self.hulls.iter().any(|hull| hull.is_open()),
            is_refined,
        };
        if self.bodies[0] > self.bodies[1] {
            least.points.swap(0, 1);
            least.shapes.swap(0, 1);
            least.inside.swap(0, 1);
        }
        least
    }

    /// Both bodies go on for ever.
    pub fn is_endless(&self) -> bool {
        self.hulls.iter().all(|hull| hull.ball.1 == f64::INFINITY)
    }

    /// The bodies in the order of the report.
    pub fn bodies(&self) -> [usize; 2] {
        let [a, b] = self.bodies;
        [a.min(b), a.max(b)]
    }
}
