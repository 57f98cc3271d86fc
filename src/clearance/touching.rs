//! Pairs that must touch all the time: how far apart and how deep in each other they are found, and what follows from that.

use super::contact::AT_LEAST;
use super::found::{Judgement, PairReport};
use super::motion::ProvedMotion;
use super::sweep::{Least, PairSweep};
use glam::DVec3;

/// Bodies in contact may be this far apart or overlap by this at the sampled times, on the scale of the contact and besides
/// what poses are off: much more than rounding.
const CONTACT: f64 = 1e-10;

/// Two bodies at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Signed distance.
    pub distance: f64,
    /// When, seconds.
    pub time: f64,
    /// The nearest points, in the world; none where two half-spaces overlap without end.
    pub points: Option<[DVec3; 2]>,
    /// The shapes that come nearest.
    pub shapes: [usize; 2],
}

/// How far apart two bodies come that must touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touching {
    /// Where they were found farthest apart.
    pub apart: Moment,
    /// They are nowhere farther apart; infinite if unknown. How deep they may be in each other is the bound of the pair's
    /// least distance.
    pub farthest: f64,
    /// A gap and an overlap of this much still count as touching.
    pub allowed: f64,
}

impl Least {
    /// Whether the bodies are apart, or overlap down to some depth: half-spaces whose planes intersect have none.
    pub fn has_end(&self) -> bool {
        self.distance > f64::NEG_INFINITY
    }

    /// The moment of the least distance.
    pub fn moment(&self) -> Moment {
        Moment {
            distance: self.distance,
            time: self.time,
            points: self.has_end().then_some(self.points),
            shapes: self.shapes,
        }
    }
}

impl PairReport {
    /// Where bodies that must touch are too far apart, if they are.
    pub fn parted(&self) -> Option<Moment> {
        let touching = self.touching.as_ref()?;
        Some(touching.apart).filter(|apart| apart.distance > touching.allowed)
    }

    /// Whether bodies that must touch overlap by more than is allowed, or lie one in the other.
    pub fn is_pressed(&self) -> bool {
        let is_deep = |t: &Touching| self.least.distance < -t.allowed || self.least.is_enclosed;
        self.touching.as_ref().is_some_and(is_deep)
    }

    /// The upper bound of the distance of bodies that must touch; nothing if it is unknown.
    pub fn known_farthest(&self) -> Option<f64> {
        let farthest = self.touching.as_ref().map(|t| t.farthest);
        farthest.filter(|farthest| farthest.is_finite())
    }

    /// What to look at: the nearest pose, or the one at which bodies that must touch are farther apart than they overlap.
    pub fn worst_moment(&self) -> Moment {
        let farther = |apart: &Moment| apart.distance > -self.least.distance;
        let parted = self.parted().filter(farther);
        parted.unwrap_or_else(|| self.least.moment())
    }

    /// By how much it keeps what is asked of it, as found; negative if it does not. Bodies that must touch are never better than
    /// zero.
    pub fn margin(&self) -> f64 {
        match &self.touching {
            Some(touching) => -f64::max(touching.apart.distance, -self.least.distance),
            None => self.least.distance - self.minimum,
        }
    }

    /// The same, as far as it is proved.
    pub fn proved_margin(&self) -> Option<f64> {
        let bound = self.known_bound().filter(|_| self.least.is_certified)?;
        match &self.touching {
            Some(_) => Some(-f64::max(self.known_farthest()?, -bound)),
            None => Some(bound - self.minimum),
        }
    }

    /// Whether the pair does not have what is asked of it at this distance.
    pub fn is_broken_at(&self, distance: f64) -> bool {
        match &self.touching {
            Some(touching) => distance.abs() > touching.allowed,
            None => distance < self.minimum,
        }
    }
}

/// A pair that must touch all the time: at the sampled times to rounding, between them as near as can be proved.
pub(super) fn judge_touching(motion: &mut ProvedMotion, sweep: &PairSweep) -> Option<PairReport> {
    let scale = sweep.contact_scale(motion);
    let allowed = CONTACT * scale + sweep.pose_slack();
    // At the samples: contact means a distance of 0 to within the tolerance of poses.
    let mut distances = Vec::new();
    let samples = motion.samples.clone();
    let mut least = sweep.sampled(motion, &samples, Some(&mut distances))?;
    let far = (0..distances.len()).max_by(|j, k| distances[*j].total_cmp(&distances[*k]))?;
    let mut apart = sweep.sampled(motion, &samples[far..=far], None)?.moment();
    let is_parted = apart.distance > allowed;
    let mut is_broken = is_parted || least.distance < -allowed || least.is_enclosed;
    // Between them: the distance is enclosed over the proved motion, finely unless that changes nothing.
    let contact = sweep.contact_over(motion, !is_broken);
    if let Some((stretch, s)) = contact.broken
        && let Some(instant) = motion.pose_at(stretch, s)
        && let Some(between) = sweep.sampled(motion, &[instant], None)
    {
        is_broken = true;
        if between.distance > apart.distance {
            apart = between.moment();
        }
        if between.distance < least.distance || between.is_enclosed {
            least = between;
        }
    }
    if is_broken && !least.is_enclosed {
        // How deep they come is of interest now; the samples may miss that.
        let searched = sweep.searched(motion);
        least = searched
            .filter(|s| s.distance < least.distance)
            .unwrap_or(least);
    }
    let judgement = match contact.is_within(AT_LEAST * scale) {
        _ if is_broken => Judgement::Failed,
        true => Judgement::kept(contact.is_certified),
        false => Judgement::Undecided,
    };
    let lowest = contact.low.min(sweep.lowest_alone(motion));
    least.bound = sweep.told(lowest.min(least.distance));
    least.is_certified = contact.is_certified;
    Some(PairReport {
        touching: Some(Touching {
            apart,
            farthest: contact.high.max(apart.distance),
            allowed,
        }),
        distances,
        ..PairReport::of(sweep, 0.0, least, judgement)
    })
}
