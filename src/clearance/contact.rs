//! Bodies that are meant to touch: how far apart, or how deep in each other, they can come between the samples.

use super::branch_and_bound::split_piece;
use super::look::{BoundGoal, NearElements, Segment, lower_of};
use super::meeting::Meeting;
use super::motion::ProvedMotion;
use super::relative::RelativeMove;
use super::sweep::PairSweep;
use crate::distance::bodies::sphere_separation;

/// Bodies in contact are looked at on this scale, in radii of the smaller one's ball; a mechanism that is smaller has its own, but none
/// below the radius: where formulas give its lengths, its size tells nothing of them.
const CONTACT_SCALE: f64 = 10.0;

/// How near to touching two bodies in contact should be proved to stay between the samples, on that scale. At the samples
/// they are known to rounding.
///
/// The proof of solids that slide along each other is near to the second power of the time looked at: this is what
/// a few thousand looks reach. Bodies that provably are farther from touching are not in contact.
pub const BETWEEN_SAMPLES: f64 = 1e-6;

/// How near they must be proved to stay. Of meshes, and next to the axis of a torus, the proof is near to the first power of
/// the time only; this is no more than a joint's usual play.
pub const AT_LEAST: f64 = 1e-4;

/// Initial number of parts of an interval for bodies in contact.
const PIECES: u32 = 2;

/// How often a piece is halved whose bounds are not near enough.
const HALVINGS: u32 = 9;

/// The same if they are as near as they must be.
const MORE_HALVINGS: u32 = 7;

/// Stretches of this share of the motion and shorter ones are halved as often as the constants above say, longer ones once
/// more for each time that they are twice as long: how near the bounds come does not depend on the samples.
const SHORT: f64 = 1.0 / 128.0;

/// If the bounds of the motion exceed this fraction of the allowance, narrower ones are proved.
const BLURRED: f64 = 0.25;

/// Maximum number of parts examined for one pair; beyond it bounds are not refined.
const MOST_LOOKS: usize = 100_000;

/// What is known of two bodies in contact between the samples.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Lower bound of the distance.
    pub low: f64,
    /// Upper bound of the distance.
    pub high: f64,
    /// Both are proved, not estimated.
    pub is_certified: bool,
    /// A stretch, and a place of it at which the bodies are farther from touching than `allowed`.
    pub broken: Option<(usize, f64)>,
}

impl Contact {
    /// Whether the distance is proved to stay within `allowed` of zero.
    pub fn is_within(&self, allowed: f64) -> bool {
        self.low >= -allowed && self.high <= allowed
    }
}

/// How often a stretch is halved until it is short.
fn halvings_of_long(motion: &ProvedMotion, root: usize) -> u32 {
    let [start, end] = motion.span();
    let [from, to] = motion.times(root, [-1.0, 1.0]);
    let short = (to - from) / (SHORT * (end - start));
    if short > 1.0 {
        libm::log2(short).ceil() as u32
    } else {
        0
    }
}

impl PairSweep<'_> {
    /// The length that the allowances of a contact are shares of: that of the bodies, wherever else the mechanism has parts.
    pub(super) fn contact_scale(&self, motion: &ProvedMotion) -> f64 {
        let size = motion.system.mechanism().size;
        match self.smaller_radius() {
            radius if radius > 0.0 && radius.is_finite() => {
                size.clamp(radius, CONTACT_SCALE * radius)
            }
            _ => size,
        }
    }

    /// Between which distances two bodies stay that touch at the samples: of their nearest points at many instants, how
    /// far apart or how deep they can come until the next. Pieces of time are halved until that is near enough, if it is to be
    /// known `finely`.
    pub fn contact_over(&self, motion: &mut ProvedMotion, finely: bool) -> Contact {
        let size = self.contact_scale(motion);
        let (allowed, slack) = (BETWEEN_SAMPLES * size, self.pose_slack());
        let (cuts, shift) = (self.mesh_cuts(), self.parting_shift(motion));
        let deep = cuts.as_ref().map(|cuts| cuts.beyond(shift));
        let mut contact = Contact {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
            is_certified: motion.gaps.is_empty() && motion.roots > 0,
            broken: None,
        };
        let back = self.chain.back();
        let half = 1.0 / f64::from(PIECES);
        let mut looks = 0;
        for root in 0..motion.roots {
            contact.is_certified &= motion.stretches[root].is_certified;
            let longer = halvings_of_long(motion, root);
            let middle = |k: u32| -1.0 + (2.0 * f64::from(k) + 1.0) * half;
            let first = (0..PIECES).map(|k| (Segment::part(root, middle(k), half), 0));
            let mut open: Vec<(Segment, u32)> = first.collect();
            while let Some((piece, depth)) = open.pop() {
                looks += 1;
                let is_late = motion.is_late();
                let arguments = &motion.stretches[piece.stretch].arguments;
                let moved = self.chain.around(arguments, piece.middle, piece.half);
                let back = || back.around(arguments, piece.middle, piece.half);
                let [below, above] = self.contact_around(&moved, back, slack - allowed);
                let is_met = cuts.as_ref().is_some_and(|cuts| cuts.are_met(&moved.pose));
                // A mesh has no depth: what the distance does not tell is less than a length by which the bodies can be parted.
                let sunk = match &deep {
                    Some(deep) if is_met && deep.are_cut(&moved.pose) => f64::INFINITY,
                    Some(_) if is_met => shift,
                    _ => 0.0,
                };
                let [low, high] = [below - slack - sunk, above + slack];
                let is_apart = low.is_finite() && low > allowed;
                if is_apart || high < -allowed || sunk == f64::INFINITY {
                    contact.broken = Some((piece.stretch, piece.middle));
                }
                let is_within = |allowed: f64| low >= -allowed && high <= allowed;
                let most = if is_within(AT_LEAST * size) {
                    MORE_HALVINGS
                } else {
                    HALVINGS
                };
                // Within the requested limits, or halved often enough.
                let is_broken = contact.broken.is_some();
                let ends = looks >= MOST_LOOKS || is_broken || is_late || !finely;
                let is_settled = is_within(allowed) || depth >= most + longer || ends;
                let look = BoundGoal {
                    asked: low,
                    lowest: low,
                    middle: high,
                    at_best: low,
                    is_blurred: self.chain.blur(arguments, piece.middle, self.hulls[1].ball)
                        > BLURRED * allowed,
                    near: NearElements::ALL,
                };
                let halves = (!is_settled)
                    .then(|| split_piece(motion, &piece, &look))
                    .flatten();
                match halves {
                    Some(halves) => open.extend(halves.map(|half| (half, depth + 1))),
                    None => {
                        contact.low = lower_of(contact.low, low);
                        contact.high = -lower_of(-contact.high, -high);
                    }
                }
            }
        }
        contact
    }

    /// Bounds of the distance of the nearest elements during a motion; a lower bound of `enough` need not be
    /// improved. `back` is the motion of the first body relative to the second.
    fn contact_around(
        &self,
        moved: &RelativeMove,
        back: impl Fn() -> RelativeMove,
        enough: f64,
    ) -> [f64; 2] {
        let (mut low, mut high) = (f64::INFINITY, f64::INFINITY);
        let mut seen_back = None;
        let way = moved.distance(self.hulls[1].ball);
        for mine in &self.hulls[1].elements {
            let second = mine.moved(&moved.pose);
            for first in &self.hulls[0].elements {
                if sphere_separation(first, &second, high.min(low) + way) - way >= high.min(low) {
                    continue;
                }
                let meeting = Meeting::new(first, &second, mine, moved);
                let mut least = meeting.below_in_contact(enough);
                if least < enough {
                    // Of which body the points are followed matters: those of a solid lie anywhere on it.
                    let back = seen_back.get_or_insert_with(&back);
                    let b = first.moved(&back.pose);
                    least = least.max(Meeting::new(mine, &b, first, back).below_in_contact(enough));
                }
                low = lower_of(low, least);
                // An upper bound is one however many others are none.
                high = high.min(meeting.above());
            }
        }
        [low, high]
    }
}
