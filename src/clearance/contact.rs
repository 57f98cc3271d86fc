//! Bodies that are meant to touch: how far apart, or how deep in each other, they can come between the samples.

use super::bodies::apart;
use super::gap::{above, below};
use super::motion::Motion;
use super::pair::distance;
use super::relative::RelativeMove;
use super::sweep::{POSE_SLACK, PairSweep};

/// Pieces of a stretch at which bodies in contact are looked at.
const CONTACT_PIECES: u32 = 16;

impl PairSweep<'_> {
    /// Between which distances two bodies provably stay that touch at the samples: of their nearest points at many
    /// instants, how far apart or how deep they can come until the next. The third says whether that is proved.
    pub fn contact_over(&self, motion: &Motion) -> (f64, f64, bool) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let half = 1.0 / f64::from(CONTACT_PIECES);
        let pieces = (0..CONTACT_PIECES).map(|k| -1.0 + (2.0 * f64::from(k) + 1.0) * half);
        let pieces: Vec<f64> = pieces.collect();
        let mut is_certified = motion.gaps.is_empty() && motion.roots > 0;
        for stretch in &motion.stretches[..motion.roots] {
            is_certified &= stretch.is_certified;
            for s in &pieces {
                let moved = self.chain.around(&stretch.arguments, *s, half);
                let [below, above] = self.contact_around(&moved);
                (low, high) = (low.min(below), high.max(above));
            }
        }
        let slack = POSE_SLACK * motion.mechanism.size;
        (low - slack, high + slack, is_certified)
    }

    /// Bounds of the distance of the nearest elements during a move.
    fn contact_around(&self, moved: &RelativeMove) -> [f64; 2] {
        let (mut low, mut high) = (f64::INFINITY, f64::INFINITY);
        let way = moved.distance(self.hulls[1].ball);
        for mine in &self.hulls[1].elements {
            let second = mine.moved(&moved.pose);
            for first in &self.hulls[0].elements {
                if apart(first, &second) - way >= high.min(low) {
                    continue;
                }
                let found = distance(first, &second);
                low = low.min(below(first, &second, mine, &found, moved));
                high = high.min(above(first, &second, mine, &found, moved));
            }
        }
        [low, high]
    }
}
