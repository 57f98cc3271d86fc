//! The bands at a pose. If the derivatives show at which corner of the tolerances a quantity has its extreme, that
//! piece is solved and proved, and the band ends there, however loose the enclosure of all other pieces is.

use super::found_pieces::FoundPieces;
use super::plan::TolerancePlan;
use crate::kinematics::abreast::anchor::AnchorPose;
use crate::kinematics::abreast::closing::LaneSolver;
use crate::kinematics::enclosure::block::Unbounded;
use crate::kinematics::enclosure::pose::{Encloser, PoseEnclosure, REFINING, Rooms, Sought};
use crate::kinematics::enclosure::quadratic::{BoxFace, QuadraticBound};
use crate::kinematics::enclosure::region::ToleranceInterval;
use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::results::certificate::Reason;
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::kinematics::structure::system::System;
use crate::numbers::form_room::FormRoom;
use crate::numbers::interval::Interval;
use crate::numbers::octet::{LANES, LaneMask, Octet};
use crate::numbers::scalar::Scalar;

/// The range of one number over all pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueBand {
    /// With the file's dimensions.
    pub nominal: f64,
    /// No piece is lower.
    pub lo: f64,
    /// No piece is higher.
    pub hi: f64,
    /// The least and the greatest value of the pieces found.
    pub found: [f64; 2],
}

/// The bands at one sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    /// Unknowns, x, y, z of the traced points, outputs.
    pub list: Vec<ValueBand>,
}

impl Bands {
    /// The same without the values that pieces attain.
    pub(super) fn without_search(mut self) -> Self {
        for band in &mut self.list {
            band.found = [band.nominal; 2];
        }
        self
    }
}

/// Why a sample has no bands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BandObstacle {
    /// There is no pose with the file's dimensions.
    NoPose,
    /// The motion with the file's dimensions has passed a singular pose near `time`: pieces may have gone on from there in another
    /// assembly.
    BehindSingularPose {
        /// Seconds; along a track, steps.
        time: f64,
    },
    /// The caller did not want to wait.
    Interrupted,
    /// The box is not proved.
    Test {
        /// In the words of certificates.
        reason: Reason,
        /// The dimension that brings the mechanism closest to the failure.
        dimension: Option<usize>,
    },
}

impl From<Unbounded> for BandObstacle {
    fn from(unbounded: Unbounded) -> Self {
        Self::Test {
            reason: unbounded.reason,
            dimension: unbounded.dimension,
        }
    }
}

/// Bands whose width exceeds that of the pieces by at most this fraction are sharp enough.
const SHARP: f64 = 1e-2;

/// So are bands that are narrower than this, relative to the value and the mechanism: quantities that hardly vary.
const NARROW: f64 = 1e-9;

/// The enclosure of all pieces near a closed pose, with individual tolerances.
pub(super) fn pose_enclosure<'r>(
    plan: &TolerancePlan,
    encloser: &Encloser,
    (solver, rooms): (&mut PoseSolver, Rooms<'_, 'r>),
    pose: &[f64],
    tolerances: &[ToleranceInterval],
) -> Result<PoseEnclosure<'r>, BandObstacle> {
    if plan.is_cancelled() {
        return Err(BandObstacle::Interrupted);
    }
    let sought = Sought {
        pose,
        input_open: &plan.input_open(pose),
        tolerances,
        bases: &solver.best_rows(pose),
    };
    Ok(encloser.enclose(sought, rooms)?)
}

/// Whether a band is hardly wider than the values of the pieces, so that another enclosure would gain nothing. `size`
/// is the scale below which a width is negligible.
pub(super) fn is_sharp([lo, hi]: [f64; 2], found: [f64; 2], size: f64) -> bool {
    hi - lo <= (1.0 + SHARP) * (found[1] - found[0]) + NARROW * size
}

/// What a thread needs to enclose poses.
pub(super) struct EnclosureSpace<'s> {
    pub solver: PoseSolver<'s>,
    /// Forms on the way to an enclosure, and those of the enclosure.
    pub rooms: [FormRoom; 2],
}

impl<'s> EnclosureSpace<'s> {
    /// For poses of this system.
    pub fn new(system: &'s System) -> Self {
        Self {
            solver: PoseSolver::new(system),
            rooms: Default::default(),
        }
    }
}

/// Finds pieces and their bands; one per thread.
pub(super) struct PieceFinder<'f> {
    plan: &'f TolerancePlan<'f>,
    encloser: &'f Encloser<'f>,
    space: EnclosureSpace<'f>,
    lanes: LaneSolver<'f>,
}

impl<'f> PieceFinder<'f> {
    /// Buffers for one thread.
    pub fn new(plan: &'f TolerancePlan<'f>, encloser: &'f Encloser<'f>) -> Self {
        let system = plan.family.system();
        Self {
            plan,
            encloser,
            space: EnclosureSpace::new(system),
            lanes: LaneSolver::new(system),
        }
    }

    /// The enclosure of all pieces near a closed pose.
    pub fn enclosed<'r>(
        &mut self,
        pose: &[f64],
        kept: &'r FormRoom,
    ) -> Result<PoseEnclosure<'r>, BandObstacle> {
        let tolerances = self.plan.tolerances(pose);
        let [work, _] = &mut self.space.rooms;
        let rooms = Rooms { work, kept };
        pose_enclosure(
            self.plan,
            self.encloser,
            (&mut self.space.solver, rooms),
            pose,
            &tolerances,
        )
    }

    /// A first-order enclosure that keeps terms of second order, in so many rounds.
    pub fn refined<'r>(
        &mut self,
        plain: &PoseEnclosure,
        kept: &'r FormRoom,
        rounds: usize,
    ) -> PoseEnclosure<'r> {
        let [work, _] = &mut self.space.rooms;
        self.encloser.refined(plain, Rooms { work, kept }, rounds)
    }

    /// The same with first-order forms only; also returns whether second-order forms would be tried.
    pub fn enclosed_plainly<'r>(
        &mut self,
        pose: &[f64],
        kept: &'r FormRoom,
    ) -> Result<(PoseEnclosure<'r>, bool), BandObstacle> {
        if self.plan.is_cancelled() {
            return Err(BandObstacle::Interrupted);
        }
        let sought = Sought {
            pose,
            input_open: &self.plan.input_open(pose),
            tolerances: &self.plan.tolerances(pose),
            bases: &self.space.solver.best_rows(pose),
        };
        let [work, _] = &mut self.space.rooms;
        Ok(self
            .encloser
            .enclose_plainly(sought, Rooms { work, kept })?)
    }

    /// The bands of all pieces near a closed pose.
    pub fn bands(&mut self, pose: &[f64]) -> Result<Bands, BandObstacle> {
        let mut room = std::mem::take(&mut self.space.rooms[1]);
        room.empty(self.plan.room_for(self.plan.dimensions.len()));
        let bands = self.bands_in(&room, pose);
        self.space.rooms[1] = room;
        bands
    }

    /// The same, with all forms in a room.
    fn bands_in(&mut self, room: &FormRoom, pose: &[f64]) -> Result<Bands, BandObstacle> {
        let anchor = AnchorPose::new(self.plan.family.system(), pose);
        let anchor = anchor.as_ref();
        let mut found = FoundPieces::default();
        // The plain enclosure first; the refined one costs several times as much.
        let Ok((plain, is_rough)) = self.enclosed_plainly(pose, room) else {
            let enclosure = self.enclosed(pose, room)?;
            return Ok(self.bands_within(&enclosure, anchor, &mut found));
        };
        let mut bands = self.bands_within(&plain, anchor, &mut found);
        let size = self.plan.family.mechanism().size;
        let sharp =
            |band: &ValueBand| is_sharp([band.lo, band.hi], band.found, band.nominal.abs() + size);
        for rounds in REFINING {
            if !is_rough || bands.list.iter().all(sharp) {
                break;
            }
            // All of them enclose all pieces, so that their intersection does.
            let enclosure = self.refined(&plain, room, rounds);
            let refined = self.bands_within(&enclosure, anchor, &mut found);
            for (band, other) in bands.list.iter_mut().zip(&refined.list) {
                *band = band.narrowed(other);
            }
        }
        Ok(bands)
    }

    /// Bands from an enclosure and the pieces at their ends, among which are those `found` in other enclosures of the pose.
    fn bands_within(
        &mut self,
        enclosure: &PoseEnclosure,
        anchor: Option<&AnchorPose>,
        found: &mut FoundPieces,
    ) -> Bands {
        let mechanism = self.plan.family.mechanism();
        let unknowns = 0..mechanism.unknowns.len();
        let shown = unknowns.chain(mechanism.coordinate_count()..enclosure.len());
        let functions: Vec<(usize, QuadraticBound)> =
            shown.map(|slot| (slot, enclosure.slot(slot))).collect();
        // Least and greatest of every number.
        let faces: Vec<[BoxFace; 2]> = functions
            .iter()
            .map(|(_, function)| [-1.0, 1.0].map(|sign| function.face(sign)))
            .collect();
        let mut places: Vec<&[f64]> = Vec::new();
        for place in faces.iter().flatten().flat_map(|f| [&f.middle, &f.best]) {
            if !places.contains(&&place[..]) {
                places.push(place);
            }
        }
        let places = found.unknown(&places);
        let pieces = self.pieces(enclosure, &places, anchor);
        found.add(&places, pieces);
        let found = &*found;
        // What has no bound at δ = 0, at a jump say, has a value there.
        let middle = enclosure.middle();
        let band = |((slot, function), faces): (&(usize, QuadraticBound), &[BoxFace; 2])| {
            let nominal = match function.open.is_finite() {
                true => function.value,
                false => self.shown(&middle, *slot).unwrap_or(f64::NAN),
            };
            let (mut reached, mut ends) = ([nominal; 2], [None; 2]);
            for ((face, sign), end) in faces.iter().zip([-1.0, 1.0]).zip(&mut ends) {
                let best = found.at(&face.best);
                let best = best.and_then(|piece| piece.value(mechanism, *slot));
                if let Some(value) = best.filter(|v| v.is_finite()) {
                    reached = [reached[0].min(value), reached[1].max(value)];
                }
                let within = (self.encloser, enclosure);
                let middle = found.at(&face.middle);
                let middle = middle.and_then(|piece| piece.proved_value(mechanism, within, *slot));
                let beyond = Interval::around_zero(face.beyond);
                *end = middle
                    .map(|value| value + beyond)
                    .map(|reach| match sign < 0.0 {
                        true => reach.lo,
                        false => reach.hi,
                    });
            }
            let [lo, hi] = match ends {
                [Some(lo), Some(hi)] if lo.is_finite() && hi.is_finite() => [lo, hi],
                _ => {
                    let range = function.range();
                    [range.lo, range.hi]
                }
            };
            ValueBand {
                nominal,
                lo: lo.min(reached[0]),
                hi: hi.max(reached[1]),
                found: reached,
            }
        };
        Bands {
            list: functions.iter().zip(&faces).map(band).collect(),
        }
    }

    /// The value of a slot at a pose.
    fn shown<S: Scalar>(&self, piece: &[S], slot: usize) -> Option<S> {
        match piece.get(slot) {
            Some(value) => Some(*value),
            None => observed_slots(self.plan.family.mechanism(), piece)
                .get(slot)
                .copied(),
        }
    }

    /// Coordinates of the pieces at δ, eight at a time; none for pieces that do not close within the enclosure.
    pub fn pieces(
        &mut self,
        enclosure: &PoseEnclosure,
        places: &[&[f64]],
        anchor: Option<&AnchorPose>,
    ) -> Vec<Option<Vec<f64>>> {
        let mut all = Vec::with_capacity(places.len());
        for eight in places.chunks(LANES) {
            let mut coordinates = self.predicted(enclosure, eight);
            let lanes = LaneMask::first(eight.len());
            // Eight pieces at once, where an anchor exists.
            let closed = match anchor {
                Some(anchor) => self.lanes.close(anchor, &mut coordinates, lanes).lanes,
                None => LaneMask::NONE,
            };
            for (lane, place) in eight.iter().enumerate() {
                let mut piece: Vec<f64> = coordinates.iter().map(|c| c.lane(lane)).collect();
                // A lane that failed starts again from the enclosure's own prediction.
                if !closed.has(lane) {
                    let inputs = piece.split_off(self.plan.family.mechanism().unknowns.len());
                    piece = enclosure.coordinates_at(place);
                    piece.truncate(piece.len() - inputs.len());
                    piece.extend(inputs);
                }
                let closes = closed.has(lane) || self.space.solver.closed(&mut piece, Pace::Brisk);
                // A closed pose outside the enclosure is another assembly.
                all.push((closes && enclosure.holds(&piece)).then_some(piece));
            }
        }
        all
    }

    /// Predicted positions along the tangent; the dimensions are exactly those of the requested pieces.
    fn predicted(&self, enclosure: &PoseEnclosure, places: &[&[f64]]) -> Vec<Octet> {
        let along = |k: usize| {
            let of_lane = |lane: usize| places.get(lane).map_or(0.0, |place| place[k]);
            Octet::new(std::array::from_fn(of_lane))
        };
        let along: Vec<Octet> = (0..self.plan.dimensions.len()).map(along).collect();
        let mechanism = self.plan.family.mechanism();
        let of = |slot: usize| {
            // The linear part of the enclosure: the nominal value plus the slopes times δ.
            let start = Octet::splat(enclosure.form(slot).value);
            if slot >= mechanism.unknowns.len() {
                return start;
            }
            let tangent = enclosure.rates(slot).iter().zip(&along);
            tangent.fold(start, |sum, (rate, d)| sum + *d * rate.value)
        };
        let mut coordinates: Vec<Octet> = (0..mechanism.coordinate_count()).map(of).collect();
        for (dimension, d) in self.plan.dimensions.iter().zip(&along) {
            let drawn = coordinates[dimension.slot];
            coordinates[dimension.slot] = drawn + *d * dimension.tolerance;
        }
        coordinates
    }
}

impl ValueBand {
    /// The intersection of two bands of one quantity.
    fn narrowed(&self, other: &Self) -> Self {
        Self {
            nominal: self.nominal,
            lo: self.lo.max(other.lo),
            hi: self.hi.min(other.hi),
            found: [
                self.found[0].min(other.found[0]),
                self.found[1].max(other.found[1]),
            ],
        }
    }
}
