//! The result of a clearance check: pairs with their distances and judgements, and a summary of all others.

use super::part::{JudgedPart, PieceClearance, PieceReport};
use super::sweep::{Least, PairSweep};
use super::touching::{Moment, MustTouch};
pub use super::violations::{Violation, Violations};

/// How a pair was judged.
#[derive(Clone, Debug, PartialEq)]
pub enum Judgement {
    /// Never nearer than its minimum, and the bound says so too.
    Passed,
    /// Nearer than its minimum.
    Failed,
    /// The same, but the bound is an estimate: nothing is proved.
    Estimated,
    /// The distances found pass, but the bound below them does not, and could not be made finer.
    Undecided,
    /// Joined by this joint: not judged.
    Neighbours(&'static str),
    /// Left out by the scene for this reason.
    Ignored(String),
}

impl Judgement {
    /// Of a pair that passes, with a proof of that or without.
    pub(super) const fn kept(is_certified: bool) -> Self {
        match is_certified {
            true => Self::Passed,
            false => Self::Estimated,
        }
    }

    /// Whether the minimum holds, as far as is known.
    pub const fn is_kept(&self) -> bool {
        matches!(self, Self::Passed | Self::Estimated)
    }
}

/// What a pair is to a designer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClearanceClass {
    /// Nearer than its minimum.
    Below,
    /// It must touch, and does not always; it never overlaps by more than is allowed.
    Separated,
    /// Perhaps: the bound is below the minimum, or an estimate.
    NotProved,
    /// It keeps its minimum, but not by much.
    Near,
    /// It keeps its minimum with a band above.
    Clear,
    /// Not judged.
    Excluded,
}

impl ClearanceClass {
    /// As in reports.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Below => "below",
            Self::Separated => "separated",
            Self::NotProved => "not proved",
            Self::Near => "near",
            Self::Clear => "clear",
            Self::Excluded => "excluded",
        }
    }
}

impl PairReport {
    /// The report of a pair with this least distance; the rest is added by whoever looks for it.
    pub(super) fn of(sweep: &PairSweep, minimum: f64, least: Least, judgement: Judgement) -> Self {
        Self {
            pair: sweep.bodies(),
            minimum,
            least,
            judgement,
            distances: Vec::new(),
            touching: None,
            seconds: 0.0,
            slack: sweep.slack(),
            violations: None,
            left_out: Vec::new(),
        }
    }

    /// For a pair that may overlap down to its minimum: whether it may be deeper. Depths have no certificate.
    pub(super) fn is_deeper(&self) -> bool {
        matches!(self.judgement, Judgement::Failed | Judgement::Undecided)
    }

    /// The lower bound of its distance; nothing if it is unknown, or if the bodies overlap: a depth is a
    /// measure of an overlap, not a bound. Bodies in contact may be that deep between the samples.
    pub fn known_bound(&self) -> Option<f64> {
        let is_apart = self.touching.is_some() || self.least.distance >= -self.slack;
        Some(self.least.bound).filter(|bound| is_apart && bound.is_finite())
    }

    /// Its class: near if it comes within `band` of the minimum, without a band within the minimum once more. Bodies in contact
    /// are meant to be.
    pub fn class(&self, band: Option<f64>) -> ClearanceClass {
        let edge = self.minimum + band.unwrap_or(self.minimum);
        match self.judgement {
            Judgement::Failed if self.parted().is_some() && !self.is_pressed() => {
                ClearanceClass::Separated
            }
            Judgement::Failed => ClearanceClass::Below,
            Judgement::Undecided | Judgement::Estimated => ClearanceClass::NotProved,
            Judgement::Passed if self.touching.is_none() && self.least.distance < edge => {
                ClearanceClass::Near
            }
            Judgement::Passed => ClearanceClass::Clear,
            Judgement::Neighbours(_) | Judgement::Ignored(_) => ClearanceClass::Excluded,
        }
    }
}

/// A pair of bodies over the motion.
#[derive(Clone, Debug)]
pub struct PairReport {
    /// Indices of the bodies, ascending.
    pub pair: [usize; 2],
    /// Least distance that passes.
    pub minimum: f64,
    /// Where they are nearest.
    pub least: Least,
    /// What that means.
    pub judgement: Judgement,
    /// Distances at the sampled times; empty for excluded pairs.
    pub distances: Vec<f64>,
    /// Of pairs that must touch: how far apart they come.
    pub touching: Option<MustTouch>,
    /// Seconds that looking at it took.
    pub seconds: f64,
    /// By how much its bound may stay below the minimum of a pair that passes: rounding of the poses.
    pub slack: f64,
    /// Times below the minimum, or possibly below it: for pairs that fail or are undecided, if requested.
    pub violations: Option<Violations>,
    /// Of neighbours: the pairs of shapes that are left out around the joint.
    pub left_out: Vec<[usize; 2]>,
}

impl PairReport {
    /// Where bodies that must touch are too far apart, if they are.
    pub fn parted(&self) -> Option<Moment> {
        let touching = self.touching.as_ref()?;
        Some(touching.apart).filter(|apart| apart.distance > touching.allowed)
    }

    /// Whether bodies that must touch overlap by more than is allowed, or lie one in the other.
    pub fn is_pressed(&self) -> bool {
        let is_deep = |t: &MustTouch| {
            self.least.distance < -t.allowed || self.least.is_enclosed || t.cut.is_some()
        };
        self.touching.as_ref().is_some_and(is_deep)
    }

    /// The upper bound of the distance of bodies that must touch; nothing if it is unknown.
    pub fn known_farthest(&self) -> Option<f64> {
        let farthest = self.touching.as_ref().map(|t| t.farthest);
        farthest.filter(|farthest| farthest.is_finite())
    }

    /// What to look at: the nearest pose, or the one at which bodies that must touch are farther apart than they overlap.
    pub fn worst_moment(&self) -> Moment {
        let is_cut = self.touching.as_ref().is_some_and(|t| t.cut.is_some());
        let farther = |apart: &Moment| !is_cut && apart.distance > -self.least.distance;
        let parted = self.parted().filter(farther);
        parted.unwrap_or_else(|| self.least.moment())
    }

    /// By how much it keeps what is asked of it, as found; negative if it does not. Bodies that must touch are never better than
    /// zero.
    pub fn margin(&self) -> f64 {
        match &self.touching {
            Some(touching) => {
                let depth = touching.cut.unwrap_or(0.0).max(-self.least.distance);
                -f64::max(touching.apart.distance, depth)
            }
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

/// Pairs of bodies that were not examined one by one, since their swept volumes stay apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarPairs {
    /// How many.
    pub count: usize,
    /// None of them is ever nearer; more than the scene's minimum.
    pub apart: f64,
    /// That is proved, not estimated.
    pub is_certified: bool,
}

impl FarPairs {
    /// How they were judged.
    pub const fn judgement(&self) -> Judgement {
        Judgement::kept(self.is_certified)
    }
}

/// What was found.
#[derive(Clone, Debug)]
pub struct ClearanceReport {
    /// Judged pairs: failed, undecided and estimated ones first, then by distance above their minimum.
    pub judged: Vec<PairReport>,
    /// Excluded pairs, those of the scene first.
    pub excluded: Vec<PairReport>,
    /// Number of further judged pairs, which are far apart.
    pub far: Option<FarPairs>,
    /// Excluded pairs beside these, and how many of them there are: parts of one rigid body, far pairs of a pattern.
    pub counted: Vec<(Judgement, usize)>,
    /// Sampled times, seconds.
    pub times: Vec<f64>,
    /// Stretches of time that could not be checked.
    pub gaps: Vec<[f64; 2]>,
    /// What is odd: exclusions that are not needed, meshes that are inside out or have no inside.
    pub warnings: Vec<String>,
    /// Judged bodies with a mesh that should have an inside and has none, and what is wrong: no check passes with one.
    pub without_inside: Vec<(usize, String)>,
    /// Asked nearness of distance and bound, relative.
    pub tolerance: f64,
    /// What was judged: bodies and the shapes of theirs that count.
    pub parts: Vec<JudgedPart>,
    /// The same for all pieces within their tolerances, if requested.
    pub pieces: Option<PieceReport>,
}

impl ClearanceReport {
    /// Whether every judged pair keeps its minimum, as far as is known.
    pub fn is_kept(&self) -> bool {
        let mut pieces = self.pieces.iter().flat_map(|pieces| &pieces.list);
        self.without_inside.is_empty()
            && self.judged.iter().all(|p| p.judgement.is_kept())
            && pieces.all(PieceClearance::is_kept)
    }

    /// Why a check has examined nothing, if so.
    pub fn nothing_judged(&self) -> Option<String> {
        let why = match self.excluded_count() {
            0 => "fewer than two bodies have shapes".to_owned(),
            1 => "the only one is excluded".to_owned(),
            all => format!("all {all} are excluded"),
        };
        (self.judged_count() == 0 && self.gaps.is_empty())
            .then(|| format!("no pair of bodies was judged: {why}"))
    }

    /// How many pairs were judged, the far ones with them.
    pub fn judged_count(&self) -> usize {
        self.judged.len() + self.far.map_or(0, |far| far.count)
    }

    /// How many pairs were excluded.
    pub fn excluded_count(&self) -> usize {
        let counted = self.counted.iter().map(|(_, count)| count);
        self.excluded.len() + counted.sum::<usize>()
    }

    /// The pair to look at first.
    pub fn worst(&self) -> Option<&PairReport> {
        self.judged.first()
    }

    /// Bodies that are nearer to another one than their minimum, or do not touch it although they must, at the sampled time nearest to `time`.
    pub fn offenders(&self, time: f64) -> Vec<usize> {
        let off = |k: &usize| (self.times[*k] - time).abs();
        let sample = (0..self.times.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
        let is_near = |p: &&PairReport| {
            let distance = sample.and_then(|k| p.distances.get(k));
            distance.is_some_and(|d| p.is_broken_at(*d)) && !p.judgement.is_kept()
        };
        let near = self.judged.iter().filter(is_near);
        let mut list: Vec<usize> = near.flat_map(|p| p.pair).collect();
        list.sort_unstable();
        list.dedup();
        list
    }
}
