//! Bands between the samples: over a time interval the inputs are dimensions like the others, so that one box contains
//! the poses of all pieces at all times of the interval. Intervals that are too long are halved.

use super::motion::{NominalPose, SpanBands, samples_at};
use super::plan::TolerancePlan;
use super::pose_bands::{BandObstacle, EnclosureSpace, pose_enclosure};
use super::whole_measures::extreme_ranges;
use crate::jobs::share_work;
use crate::kinematics::certificate::tube::input_range;
use crate::kinematics::enclosure::pose::{Encloser, Rooms};
use crate::kinematics::enclosure::region::ToleranceInterval;
use crate::kinematics::motion::sampling::knot_times;
use crate::kinematics::results::certificate::Reason;
use crate::model::expression::continuity::Jumps;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::Scalar;

/// Maximum number of halvings of a time interval.
const MOST_HALVINGS: u32 = 6;

/// Bands between adjacent `times`, and between the times at which an input has a key, a kink or a jump.
pub fn enclose_between(plan: &TolerancePlan, times: &[f64], threads: usize) -> Vec<SpanBands> {
    let family = plan.family;
    // The samples and all times at which a drive changes its formula: between them drives are smooth.
    let all = knot_times(family.mechanism(), &family.actuation, times);
    let ends = spans_of(plan, &all);
    let middles: Vec<f64> = ends.iter().map(|[a, b]| 0.5 * a + 0.5 * b).collect();
    let nominal = samples_at(plan, &middles);
    let encloser = Encloser::new(family.system());
    let work = |space: &mut EnclosureSpace, index: usize| {
        let [from, until] = ends[index];
        // Bands of an interval are proved around the pose in its middle.
        let bands = match nominal.on_first_branch(index) {
            Err(obstacle) => Err(obstacle),
            Ok(pose) => {
                let place = PoseBetween {
                    plan,
                    encloser: &encloser,
                    pose,
                };
                let halvings = if from < until { MOST_HALVINGS } else { 0 };
                place.bands(space, [from, until], halvings)
            }
        };
        Some(SpanBands { from, until, bands })
    };
    let make = || EnclosureSpace::new(family.system());
    let list = share_work(ends.len(), threads, make, work);
    list.into_iter().map(|(_, stretch)| stretch).collect()
}

/// The intervals between adjacent times, and among them the instants whose poses belong to neither side: where drives jump from the
/// pose before, and to the pose after.
fn spans_of(plan: &TolerancePlan, times: &[f64]) -> Vec<[f64; 2]> {
    let actuation = &plan.family.actuation;
    let pairs = times.windows(2);
    let jumps: Vec<Jumps> = pairs
        .map(|pair| actuation.jumps_between(pair[0], pair[1]))
        .collect();
    let mut spans = Vec::new();
    for (k, time) in times.iter().enumerate() {
        let before = k.checked_sub(1).is_none_or(|k| jumps[k].at_end);
        let after = jumps.get(k).is_none_or(|jumps| jumps.at_start);
        if before && after {
            spans.push([*time; 2]);
        }
        spans.extend(times.get(k + 1).map(|next| [*time, *next]));
    }
    spans
}

/// A pose in the middle of an interval.
struct PoseBetween<'p> {
    plan: &'p TolerancePlan<'p>,
    encloser: &'p Encloser<'p>,
    pose: NominalPose,
}

impl PoseBetween<'_> {
    /// The bands over an interval, by halves if necessary.
    fn bands(
        &self,
        space: &mut EnclosureSpace,
        [from, until]: [f64; 2],
        halvings: u32,
    ) -> Result<Vec<[f64; 2]>, BandObstacle> {
        // One enclosure over the whole interval, if its test succeeds.
        let refusal = match self.whole(space, [from, until]) {
            Ok(bands) => return Ok(bands),
            Err(refusal) if halvings == 0 => return Err(refusal),
            Err(refusal) => refusal,
        };
        // Else by halves, in which the inputs vary less: each around a pose in its own middle.
        let middle = 0.5 * from + 0.5 * until;
        let mut all: Option<Vec<[f64; 2]>> = None;
        for half in [[from, middle], [middle, until]] {
            let middle = 0.5 * half[0] + 0.5 * half[1];
            let pose = self.pose.followed_to(&mut space.solver, self.plan, middle);
            let pose = pose.ok_or(refusal)?;
            let place = PoseBetween { pose, ..*self };
            let bands = place.bands(space, half, halvings - 1)?;
            // The hull of both halves holds for the whole; if one half has no proof, the whole has none.
            all = Some(match all {
                None => bands,
                Some(before) => before
                    .iter()
                    .zip(&bands)
                    .map(|(a, b)| [a[0].min(b[0]), a[1].max(b[1])])
                    .collect(),
            });
        }
        all.ok_or(refusal)
    }

    fn whole(
        &self,
        space: &mut EnclosureSpace,
        stretch: [f64; 2],
    ) -> Result<Vec<[f64; 2]>, BandObstacle> {
        let pose = &self.pose.coordinates;
        let tolerances = stretch_tolerances(self.plan, pose, stretch)?;
        // All coordinates and derived values over the whole interval, for every piece.
        let EnclosureSpace { solver, rooms } = space;
        let [work, kept] = rooms;
        kept.empty(self.plan.room_for(tolerances.len()));
        let rooms = Rooms { work, kept };
        let enclosure =
            pose_enclosure(self.plan, self.encloser, (solver, rooms), pose, &tolerances)?;
        let mechanism = self.plan.family.mechanism();
        let unknowns = 0..mechanism.unknowns.len();
        let shown = unknowns.chain(mechanism.coordinate_count()..enclosure.len());
        let ends = shown.map(|slot| {
            let range = enclosure.slot(slot).range();
            [range.lo, range.hi]
        });
        // The bands of the quantities, then those of the measures' extremes.
        let extremes = extreme_ranges(self.plan, &enclosure);
        Ok(ends.chain(extremes).collect())
    }
}

/// The dimensions of a plan at the pose in the middle of an interval, then the inputs that move during it; an obstacle
/// where an input has no bound.
pub(super) fn stretch_tolerances(
    plan: &TolerancePlan,
    pose: &[f64],
    [from, until]: [f64; 2],
) -> Result<Vec<ToleranceInterval>, BandObstacle> {
    let family = plan.family;
    let mut list = plan.tolerances(pose);
    let first = family.mechanism().unknowns.len();
    let middle = 0.5 * from + 0.5 * until;
    let drives = family.actuation.drives.iter().enumerate();
    for (k, drive) in drives.take(family.own_inputs()) {
        let range = match from == until {
            true => drive.range_at(from),
            false => drive.value_beside(Interval::new(from, until), middle),
        };
        // Kinks and jumps at its ends are no part of it.
        let range = match range.is_finite() {
            true => range,
            false => input_range(drive, from, until),
        };
        if !range.is_finite() {
            return Err(BandObstacle::Test {
                reason: Reason::Formula,
                dimension: None,
            });
        }
        let half_width = range.distance(pose[first + k]) * GROW;
        match list.iter_mut().find(|t| t.slot == first + k) {
            Some(known) => known.half_width = (known.half_width + half_width) * GROW,
            None if half_width > 0.0 => list.push(ToleranceInterval {
                slot: first + k,
                half_width,
            }),
            None => {}
        }
    }
    Ok(list)
}
