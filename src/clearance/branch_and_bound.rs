//! Branch and bound over time intervals: a lower bound of the distance of two bodies over the whole motion.
//!
//! In a short interval the distance cannot fall below that in the middle by more than the largest displacement. Between convex
//! elements only the motion normal to the separating plane counts, point by point: then the error of the bound is quadratic
//! in the time, also for solids that slide along each other.
//!
//! First the minimum is proved everywhere, which decides the verdict; then the bound is brought as close to the
//! distance as requested. An interrupted search keeps what was proved so far.

use super::broad_phase::Sweeper;
use super::excluded::places_of;
use super::look::{BoundGoal, LookGoal, LookMemory, Missed, Segment};
use super::motion::ProvedMotion;
use super::sweep::{Least, NearestPose, PairSweep};
use crate::distance::bodies::nearest_bodies;
use crate::sorting::sort_by;

/// Maximum number of time intervals examined for one pair.
const MAX_LOOKS: usize = 40_000;

/// So many parts that nothing else bounds are bounded by boxes around what the bodies sweep, some microseconds each.
const MOST_AT_END: usize = 100_000;

/// Where nothing can be proved, only a smaller distance is searched: for bodies that overlap, and for those so large that
/// the rounding of their poses exceeds their margin above the minimum.
const LOOKS_WITHOUT_PROOF: usize = 400;

/// The place at which bodies overlap most, where they must not, is sought in so many looks: the times at which they overlap
/// are found by a search of their own.
const LOOKS_FOR_DEPTH: usize = 10_000;

/// Where motions are too fast for any bound, parts are halved until there is one, or there were so many looks.
const LOOKS_WITHOUT_BOUND: usize = 4_000;

/// Shortest part of an interval that is examined, as a fraction of it.
const SHORTEST: f64 = 1.0 / 65_536.0;

/// A pose is solved for a smaller distance only if the gain is this fraction of what the bound may miss.
const WORTH_A_POSE: f64 = 0.25;

/// What is to be proved.
#[derive(Clone, Copy)]
enum Goal {
    /// That the pair passes.
    Minimum,
    /// That the distance found is the least, to the tolerance.
    Tolerance,
}

/// Parts still to be examined, and those that are settled.
struct SegmentSearch {
    open: Vec<Segment>,
    settled: Vec<(Segment, BoundGoal)>,
    looks: usize,
    memory: LookMemory,
}

impl PairSweep<'_> {
    /// The least distance over the whole motion with its bound; fills `distances` with those of the samples.
    pub fn least_over(&self, motion: &mut ProvedMotion, distances: &mut Vec<f64>) -> Option<Least> {
        let (search, best) = self.search_all(motion, distances)?;
        Some(self.concluded(motion, &search, &best))
    }

    /// The same with the least distance near the place where it was found to nearly all digits, and not only to the tolerance.
    pub fn settled_least(&self, motion: &mut ProvedMotion) -> Option<Least> {
        let (search, mut best) = self.search_all(motion, &mut Vec::new())?;
        for place in places_of(motion, best.instant) {
            self.descend_finely(motion, place, &mut best);
        }
        Some(self.concluded(motion, &search, &best))
    }

    /// Looks at all parts of the motion.
    fn search_all(
        &self,
        motion: &mut ProvedMotion,
        distances: &mut Vec<f64>,
    ) -> Option<(SegmentSearch, NearestPose)> {
        let samples = motion.samples.clone();
        let mut best = self.best_of(motion, &samples, Some(distances))?;
        let mut search = SegmentSearch {
            open: self.roots(motion, (distances, best.missed)),
            settled: Vec::new(),
            looks: 0,
            memory: self.look_memory(),
        };
        for goal in [Goal::Minimum, Goal::Tolerance] {
            let value = self.value_of(goal, &best);
            search.reopen(motion, value);
            self.settle(motion, &mut search, goal, &mut best);
        }
        self.decide(motion, &search, &mut best);
        Some((search, best))
    }

    /// The nearest pose with what is proved by a search.
    fn concluded(
        &self,
        motion: &ProvedMotion,
        search: &SegmentSearch,
        best: &NearestPose,
    ) -> Least {
        let all = || search.settled.iter();
        let lowest = all().map(|(_, look)| look.lowest);
        let near = best.found.proximity.distance;
        let bound = match self.is_cut(best) && near >= 0.0 {
            // A mesh has no depth.
            true => self.deepest(),
            false => lowest.fold(near.min(self.lowest_alone(motion)), f64::min),
        };
        let is_proved = all().all(|(piece, _)| motion.stretches[piece.stretch].is_certified);
        // A depth is not a distance: only the overlap of the bodies is proved.
        let is_certified = is_proved && near >= -self.slack() && motion.gaps.is_empty();
        let is_refined = bound >= self.target(best) + best.missed;
        let bound = self.told(bound - self.pose_slack());
        self.least(motion, best, bound, [is_certified, is_refined])
    }

    /// Where neither passes nor fails what is known, the least distance may be just below the minimum: it is looked for where
    /// the bound is lowest.
    fn decide(&self, motion: &mut ProvedMotion, search: &SegmentSearch, best: &mut NearestPose) {
        let lowest = search
            .settled
            .iter()
            .filter(|(_, look)| look.lowest > self.deepest());
        let lowest = lowest.min_by(|(_, p), (_, q)| p.lowest.total_cmp(&q.lowest));
        if let Some((piece, look)) = lowest
            && look.lowest < self.enough()
            && best.found.proximity.distance >= self.enough()
        {
            self.descend_finely(motion, (piece.stretch, piece.middle), best);
        }
    }

    /// Whether the bodies are known to be in each other, or a mesh meets the other one.
    fn is_cut(&self, best: &NearestPose) -> bool {
        let distance = best.found.proximity.distance;
        distance < 0.0 || best.is_enclosed || self.meets(best.found.elements, distance)
    }

    /// What the bound of a piece must reach.
    fn value_of(&self, goal: Goal, best: &NearestPose) -> f64 {
        match goal {
            Goal::Minimum if best.found.proximity.distance >= self.enough() => {
                self.enough() + self.pose_slack()
            }
            _ => self.target(best),
        }
    }

    /// All stretches of the motion, each as one piece, the one with the lowest distances at its ends last.
    fn roots(&self, motion: &ProvedMotion, (distances, missed): (&[f64], f64)) -> Vec<Segment> {
        let has_mesh = self.hulls.iter().any(|hull| hull.has_mesh());
        // A mesh that is met at a sample may be in the other body as deep as may be.
        let value = |place: Option<usize>| match place.map(|place| distances[place]) {
            Some(distance) if distance.is_finite() && (distance > 0.0 || !has_mesh) => {
                distance - missed
            }
            _ => f64::NEG_INFINITY,
        };
        let whole = |root: usize| {
            let ends = motion.stretches[root].ends;
            Segment {
                ends: value(ends[0]).min(value(ends[1])),
                ..Segment::whole(root)
            }
        };
        let mut open: Vec<Segment> = (0..motion.roots).map(whole).collect();
        sort_by(&mut open, |p, q| q.ends.total_cmp(&p.ends));
        open
    }

    /// Looks at the open pieces, and at their halves, until each reaches the goal or cannot be halved.
    fn settle(
        &self,
        motion: &mut ProvedMotion,
        search: &mut SegmentSearch,
        goal: Goal,
        best: &mut NearestPose,
    ) {
        while let Some(piece) = search.open.pop() {
            // A depth that is allowed is to be proved.
            let is_deep_enough = search.looks >= LOOKS_FOR_DEPTH
                && best.found.proximity.distance < self.enough().min(0.0);
            if is_deep_enough || motion.is_late() {
                search.cut_off(piece);
                break;
            }
            // Depth first; the bound of a part is compared with the present goal.
            search.looks += 1;
            // A whole interval is examined once, for both goals.
            let [asked, target] = [self.value_of(goal, best), self.target(best)];
            let goals = LookGoal {
                asked: match piece.half == 1.0 {
                    true => asked.max(target),
                    false => asked,
                },
                kept: target,
                missed: Missed::Bound,
            };
            let mut look = self.look(motion, &piece, goals, &mut search.memory);
            // A look for a higher goal may tell less.
            look.lowest = look.lowest.max(piece.known);
            self.measure(motion, &piece, &look, best);
            let is_beyond_proof = asked > best.found.proximity.distance
                || (self.is_cut(best) && self.minimum() >= 0.0);
            let most = match is_beyond_proof {
                true => LOOKS_WITHOUT_PROOF,
                false => MAX_LOOKS,
            };
            let is_bounded = look.lowest > f64::NEG_INFINITY;
            let is_open = look.falls_short_of(self.value_of(goal, best))
                && (is_bounded || search.looks < LOOKS_WITHOUT_BOUND)
                && search.looks < most;
            // Halved while the halves may be bounded better.
            match is_open
                .then(|| split_piece(motion, &piece, &look))
                .flatten()
            {
                Some(parts) => search.open.extend(parts),
                None => search.settled.push((piece, look)),
            }
        }
        if let Goal::Minimum = goal {
            self.bound_by_boxes(motion, &mut search.settled);
        }
    }

    /// Bounds what is settled without a proof of the minimum by boxes around what both bodies sweep: fast motions have no other
    /// bound, however far apart the bodies are.
    fn bound_by_boxes(&self, motion: &ProvedMotion, settled: &mut [(Segment, BoundGoal)]) {
        let enough = self.enough() + self.pose_slack();
        let open = settled.iter_mut().filter(|(_, look)| look.lowest < enough);
        let mut bodies = None;
        for (piece, look) in open.take(MOST_AT_END) {
            let bodies = bodies.get_or_insert_with(|| {
                [0, 1].map(|k| Sweeper::new(motion, self.bodies[k], self.hulls[k]))
            });
            let place = [piece.middle, piece.half];
            let apart = self.minimum().max(0.0);
            let [a, b] = bodies
                .each_ref()
                .map(|body| body.over(motion, piece.stretch, place, apart));
            // Boxes that meet tell nothing: the bodies in them may overlap.
            let apart = a.apart(&b);
            if apart > 0.0 {
                look.lowest = look.lowest.max(apart);
            }
        }
    }

    /// A lower distance counts once it is that of an exact pose.
    fn measure(
        &self,
        motion: &mut ProvedMotion,
        piece: &Segment,
        look: &BoundGoal,
        best: &mut NearestPose,
    ) {
        let near = best.found.proximity.distance;
        // However little lower: a pose below the minimum decides.
        let decides = near >= self.enough() && look.middle < self.enough();
        if !decides && look.middle >= near - WORTH_A_POSE * (near - self.target(best)) {
            return;
        }
        // A pose in the middle that may come nearer than the least so far.
        let Some(instant) = motion.pose_at(piece.stretch, piece.middle) else {
            return;
        };
        let pose = self.relative(motion, instant);
        let found = nearest_bodies(self.hulls[0], self.hulls[1], &pose, &self.left_out);
        if let Some(found) = found.filter(|f| f.proximity.distance < near) {
            *best = NearestPose {
                found,
                instant,
                ..*best
            };
        }
    }
}

impl SegmentSearch {
    /// Ends with the bounds that are known of this part and of all open ones.
    fn cut_off(&mut self, piece: Segment) {
        let rest = std::iter::once(piece).chain(self.open.drain(..));
        let unlooked = rest.map(|piece| {
            let look = BoundGoal::known_of(&piece);
            (piece, look)
        });
        self.settled.extend(unlooked);
    }

    /// Opens what is settled below the goal: a look goes no farther than what was asked of it. Where that was as much, the halves
    /// tell more.
    fn reopen(&mut self, motion: &mut ProvedMotion, goal: f64) {
        let mut kept = Vec::new();
        // The lowest bound first.
        sort_by(&mut self.settled, |(_, p), (_, q)| {
            q.lowest.total_cmp(&p.lowest)
        });
        for (piece, look) in self.settled.drain(..) {
            let is_low = look.falls_short_of(goal) && look.lowest > f64::NEG_INFINITY;
            if !is_low || self.looks + self.open.len() >= MAX_LOOKS {
                kept.push((piece, look));
            } else if look.asked < goal {
                self.open.push(Segment {
                    known: look.lowest,
                    near: look.near,
                    ..piece
                });
            } else {
                match split_piece(motion, &piece, &look) {
                    Some(parts) => self.open.extend(parts),
                    None => kept.push((piece, look)),
                }
            }
        }
        self.settled = kept;
    }
}

/// The two halves of a piece; of a stretch with narrower bounds where that is what is missing.
pub(super) fn split_piece(
    motion: &mut ProvedMotion,
    piece: &Segment,
    look: &BoundGoal,
) -> Option<[Segment; 2]> {
    let part = |stretch: usize, middle: f64, half: f64| Segment {
        stretch,
        middle,
        half,
        ends: f64::NEG_INFINITY,
        known: look.lowest,
        near: look.near.clone(),
    };
    let is_certified = motion.stretches[piece.stretch].is_certified;
    let half = 0.5 * piece.half;
    // Of a piece as short as may be the rest of a longer stretch is what may still be lost.
    let is_left_to_stretch = half < SHORTEST && motion.may_be_halved(piece.stretch);
    if (look.is_blurred || is_left_to_stretch || !is_certified)
        && let Some([first, second]) = motion.halves(piece.stretch)
    {
        // The same times as seen from the halves.
        let (from, to) = (piece.middle - piece.half, piece.middle + piece.half);
        let (low, high) = (2.0 * from + 1.0, 2.0 * to + 1.0);
        let over = |stretch: usize, low: f64, high: f64| {
            part(stretch, 0.5 * (low + high), 0.5 * (high - low))
        };
        return Some(if to <= 0.0 {
            let middle = 0.5 * (low + high);
            [over(first, low, middle), over(first, middle, high)]
        } else if from >= 0.0 {
            let (low, high) = (low - 2.0, high - 2.0);
            let middle = 0.5 * (low + high);
            [over(second, low, middle), over(second, middle, high)]
        } else {
            [over(first, low, 1.0), over(second, -1.0, high - 2.0)]
        });
    }
    (is_certified && half >= SHORTEST).then(|| {
        [
            part(piece.stretch, piece.middle - half, half),
            part(piece.stretch, piece.middle + half, half),
        ]
    })
}
