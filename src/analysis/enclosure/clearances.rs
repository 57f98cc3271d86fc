//! Clearances of all pieces: a lower bound on the distance of every pair of bodies, over the whole motion, for
//! dimensions anywhere in their intervals.
//!
//! The time between two samples is an interval like those of the dimensions: the inputs are further dimensions over it.
//! Where the bound of a pair is far below the nearest piece found, the time interval is halved.

use super::between::stretch_tolerances;
use super::motion::{NominalPose, samples_at};
use super::plan::TolerancePlan;
use super::pose_bands::{BandObstacle, EnclosureSpace, pose_enclosure};
use crate::clearance::part::{JudgedPart, Missing, PieceClearance, PieceRefusal};
use crate::clearance::piece_gap::{PartWays, PieceView};
use crate::jobs::share_work;
use crate::kinematics::enclosure::observer::Observer;
use crate::kinematics::enclosure::pose::{Encloser, PoseEnclosure, Rooms};
use crate::kinematics::enclosure::region::ToleranceInterval;
use crate::kinematics::motion::sampling::knot_times;
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::model::drive::Drive;

/// Maximum number of halvings of a time interval.
const MOST_HALVINGS: u32 = 12;

/// Fewest time intervals at first: results must not depend on the number of samples.
const FIRST_STRETCHES: f64 = 64.0;

/// Maximum number of time intervals that are examined; later results are not refined.
const MOST_STRETCHES: usize = 4000;

/// A bound is close enough to the nearest piece found if it is below it by at most this fraction of the loss due to the
/// tolerances.
const NEAR: f64 = 0.02;

/// Halves that gain less than this fraction of the missing amount are not halved again: the rest is due to the
/// tolerances.
const STALLED: f64 = 0.1;

/// Below the minimum they are, so many times.
const MOST_STALLS: u32 = 3;

/// A time interval and the pairs that are undecided in it.
#[derive(Clone, Debug)]
struct TimeSpan {
    ends: [f64; 2],
    /// A nominal pose near its middle.
    near: NominalPose,
    /// The pairs, and what is known about them.
    open: Vec<OpenPart>,
}

/// A pair that is undecided in a time interval.
#[derive(Clone, Copy, Debug)]
struct OpenPart {
    /// Its index.
    part: usize,
    /// What is known of its bound.
    known: f64,
    /// How many halvings in a row have gained little.
    stalls: u32,
}

/// The result for an undecided pair in one time interval: a bound, and the nearest piece with its time.
type PartBound = (f64, Option<[f64; 2]>);

/// The problem, for all time intervals.
struct ClearanceSearch<'s> {
    plan: &'s TolerancePlan<'s>,
    encloser: Encloser<'s>,
    ways: Vec<PartWays<'s>>,
    /// Arguments of all ways.
    used: Vec<usize>,
}

/// The clearances of `parts` for every piece, from the first to the last of `times`. `tolerance` is the requested
/// distance of the bound from the nearest piece, relative to the minimum or the distance.
pub fn enclose_clearances(
    plan: &TolerancePlan,
    parts: &[JudgedPart],
    times: &[f64],
    tolerance: f64,
    threads: usize,
) -> Vec<PieceClearance> {
    let family = plan.family;
    let mechanism = family.mechanism();
    // The chains to the points of the solids of every pair, and the arguments that any of them uses.
    let ways: Vec<PartWays> = parts
        .iter()
        .map(|part| PartWays::new(part, mechanism, &family.carried))
        .collect();
    let mut used: Vec<usize> = ways.iter().flat_map(PartWays::arguments).collect();
    used.sort_unstable();
    used.dedup();
    let search = ClearanceSearch {
        plan,
        encloser: Encloser::new(family.system()),
        ways,
        used,
    };
    // Branch and bound: every bound starts at the nominal distance and only falls.
    let mut found: Vec<PieceClearance> = parts.iter().map(unknown_clearance).collect();
    let mut open = first_stretches(plan, parts, times, &mut found);
    let mut looked = 0;
    // Breadth first: a round examines all open intervals, and halves those that leave a pair undecided.
    for halvings in 0..=MOST_HALVINGS {
        looked += open.len();
        // The last round keeps the bounds as they are.
        let is_last = halvings == MOST_HALVINGS || looked + 2 * open.len() > MOST_STRETCHES;
        open = search.round(open, &mut found, tolerance, threads, is_last);
        if open.is_empty() {
            break;
        }
    }
    found
}

/// Initially only the nominal motion of a pair is known.
fn unknown_clearance(part: &JudgedPart) -> PieceClearance {
    let [a, b] = part.bodies;
    let [nominal, time] = part.nominal;
    PieceClearance {
        pair: [a.min(b), a.max(b)],
        minimum: part.minimum,
        slack: part.slack,
        nominal,
        bound: nominal,
        found: nominal,
        time,
        refusal: None,
    }
}

/// The time intervals between the samples and the knots of the drives.
fn first_stretches(
    plan: &TolerancePlan,
    parts: &[JudgedPart],
    times: &[f64],
    found: &mut [PieceClearance],
) -> Vec<TimeSpan> {
    let all = knot_times(plan.family.mechanism(), &plan.family.actuation, times);
    // An instant at which a drive jumps has a pose of its own; so has a motion without duration.
    let has_instants = plan.family.actuation.drives.iter().any(Drive::may_jump) || all.len() < 2;
    let longest = (all.last().unwrap_or(&0.0) - all.first().unwrap_or(&0.0)) / FIRST_STRETCHES;
    let mut ends: Vec<[f64; 2]> = Vec::new();
    for (k, time) in all.iter().enumerate() {
        ends.extend(has_instants.then_some([*time; 2]));
        let next = all.get(k + 1);
        ends.extend(
            next.into_iter()
                .flat_map(|next| parts_of(*time, *next, longest)),
        );
    }
    let middles: Vec<f64> = ends.iter().map(|[a, b]| 0.5 * a + 0.5 * b).collect();
    // An interval with a singular pose is refused itself, so that no bound of the whole motion rests on those behind it.
    let samples = samples_at(plan, &middles).samples;
    let mut list = Vec::new();
    for (ends, sample) in ends.into_iter().zip(samples) {
        match NominalPose::of(&sample) {
            Some(near) => list.push(TimeSpan {
                ends,
                near,
                open: (0..parts.len()).map(unknown_part).collect(),
            }),
            None => {
                let obstacle = match plan.is_cancelled() {
                    true => BandObstacle::Interrupted,
                    false => BandObstacle::NoPose,
                };
                found
                    .iter_mut()
                    .for_each(|pair| refuse(pair, plan, ends, obstacle));
            }
        }
    }
    list
}

/// Nothing is known of a pair.
fn unknown_part(part: usize) -> OpenPart {
    OpenPart {
        part,
        known: f64::NEG_INFINITY,
        stalls: 0,
    }
}

/// Equal parts of an interval, none much longer than `longest`.
fn parts_of(from: f64, until: f64, longest: f64) -> impl Iterator<Item = [f64; 2]> {
    let count = ((until - from) / longest).round().max(1.0);
    let at = move |k: f64| match k < count {
        true => from + (until - from) * (k / count),
        false => until,
    };
    (0..count as usize).map(move |k| [at(k as f64), at(k as f64 + 1.0)])
}

/// Records that nothing is proved about a pair over a time interval.
fn refuse(
    pair: &mut PieceClearance,
    plan: &TolerancePlan,
    [from, until]: [f64; 2],
    obstacle: BandObstacle,
) {
    pair.bound = f64::NEG_INFINITY;
    let (missing, dimension) = match obstacle {
        BandObstacle::NoPose | BandObstacle::BehindSingularPose { .. } => (Missing::Pose, None),
        BandObstacle::Interrupted => (Missing::Time, None),
        BandObstacle::Test { reason, dimension } => (Missing::Proof(reason), dimension),
    };
    let name = dimension.and_then(|k| plan.dimensions.get(k));
    pair.refusal.get_or_insert(PieceRefusal {
        from,
        until,
        missing,
        dimension: name.map(|d| d.name.clone()),
    });
}

impl TimeSpan {
    /// Both halves, if anything is undecided in them.
    fn halves(&self, rest: Vec<OpenPart>) -> Vec<TimeSpan> {
        if rest.is_empty() {
            return Vec::new();
        }
        let [from, until] = self.ends;
        let middle = 0.5 * from + 0.5 * until;
        let half = |ends| TimeSpan {
            ends,
            near: self.near.clone(),
            open: rest.clone(),
        };
        vec![half([from, middle]), half([middle, until])]
    }
}

/// Takes over the pieces that are nearer than those known so far.
fn note_nearest<'l>(
    open: &[OpenPart],
    looks: impl Iterator<Item = &'l PartBound>,
    found: &mut [PieceClearance],
) {
    for (OpenPart { part, .. }, (_, piece)) in open.iter().zip(looks) {
        let pair = &mut found[*part];
        if let Some([distance, time]) = piece
            && *distance < pair.found
        {
            (pair.found, pair.time) = (*distance, *time);
        }
    }
}

/// Keeps the bounds that are close enough or gain too little by halving; returns the pairs that stay undecided.
fn settle(
    open: &[OpenPart],
    looks: &[PartBound],
    found: &mut [PieceClearance],
    tolerance: f64,
    is_last: bool,
) -> Vec<OpenPart> {
    let mut rest = Vec::new();
    for (open, (lowest, _)) in open.iter().zip(looks) {
        let (pair, lowest) = (&mut found[open.part], lowest.max(open.known));
        let missing = wanted_bound(pair, tolerance) - lowest;
        let stalls = match lowest - open.known < STALLED * missing {
            true => open.stalls + 1,
            false => 0,
        };
        // Where the verdict is open a single halving that gains little is no reason to stop.
        let most = match lowest < pair.minimum {
            true => MOST_STALLS,
            false => 0,
        };
        if missing <= 0.0 || is_last || stalls > most {
            pair.bound = pair.bound.min(lowest);
        } else {
            rest.push(OpenPart {
                known: lowest,
                stalls,
                ..*open
            });
        }
    }
    rest
}

impl ClearanceSearch<'_> {
    /// Examines all open time intervals; returns those to be halved.
    fn round(
        &self,
        open: Vec<TimeSpan>,
        found: &mut [PieceClearance],
        tolerance: f64,
        threads: usize,
        is_last: bool,
    ) -> Vec<TimeSpan> {
        let goals: Vec<f64> = found.iter().map(|pair| pair.found).collect();
        let make = || EnclosureSpace::new(self.plan.family.system());
        let work = |space: &mut EnclosureSpace, index: usize| {
            Some(self.examine(space, &open[index], &goals))
        };
        let results = share_work(open.len(), threads, make, work);
        // The nearest pieces of all intervals come first: they determine which bounds are close enough.
        for (index, result) in &results {
            let looks = result.iter().flatten();
            note_nearest(&open[*index].open, looks, found);
        }
        let mut halves = Vec::new();
        for (index, result) in results {
            let stretch = &open[index];
            let rest = match result {
                Err(BandObstacle::Interrupted) => {
                    self.keep_interrupted(stretch, found);
                    continue;
                }
                Err(obstacle) if is_last => {
                    for OpenPart { part, .. } in &stretch.open {
                        refuse(&mut found[*part], self.plan, stretch.ends, obstacle);
                    }
                    continue;
                }
                Err(_) => stretch.open.clone(),
                Ok(looks) => settle(&stretch.open, &looks, found, tolerance, is_last),
            };
            halves.extend(stretch.halves(rest));
        }
        halves
    }

    /// What was proved of a whole interval holds for its halves, even if they are not examined any more.
    fn keep_interrupted(&self, stretch: &TimeSpan, found: &mut [PieceClearance]) {
        for OpenPart { part, known, .. } in &stretch.open {
            let pair = &mut found[*part];
            match known.is_finite() {
                true => pair.bound = pair.bound.min(*known),
                false => refuse(pair, self.plan, stretch.ends, BandObstacle::Interrupted),
            }
        }
    }

    fn examine(
        &self,
        space: &mut EnclosureSpace,
        stretch: &TimeSpan,
        goals: &[f64],
    ) -> Result<Vec<PartBound>, BandObstacle> {
        let EnclosureSpace { solver, rooms } = space;
        let [work, kept] = rooms;
        let [from, until] = stretch.ends;
        // The pose in the middle of the interval, followed from a near one.
        let middle = 0.5 * from + 0.5 * until;
        let pose = stretch.near.followed_to(solver, self.plan, middle);
        let pose = pose.ok_or(BandObstacle::NoPose)?.coordinates;
        let tolerances = stretch_tolerances(self.plan, &pose, stretch.ends)?;
        kept.empty(self.plan.room_for(tolerances.len()));
        let rooms = Rooms { work, kept };
        let enclosure = pose_enclosure(
            self.plan,
            &self.encloser,
            (&mut *solver, rooms),
            &pose,
            &tolerances,
        )?;
        Ok(self.examine_parts(solver, stretch, goals, &enclosure, &tolerances))
    }

    fn examine_parts(
        &self,
        solver: &mut PoseSolver,
        stretch: &TimeSpan,
        goals: &[f64],
        enclosure: &PoseEnclosure,
        tolerances: &[ToleranceInterval],
    ) -> Vec<PartBound> {
        let mechanism = self.plan.family.mechanism();
        let observer = Observer::new(enclosure, mechanism, &self.used);
        let view = PieceView::new(observer, mechanism, &self.used);
        let one = |OpenPart { part, known, .. }: &OpenPart| {
            let (ways, goal) = (&self.ways[*part], goals[*part]);
            let look = ways.look(&view, goal);
            // Where the bound is too low, the piece that determines it is solved, at both ends and in the middle.
            let place = look.place.filter(|_| look.lowest.max(*known) < goal);
            let nearest = place.and_then(|place| {
                let [from, until] = stretch.ends;
                let times = [from, 0.5 * from + 0.5 * until, until];
                let pieces = times.into_iter().filter_map(|time| {
                    let coordinates = self.piece(solver, enclosure, tolerances, (&place, time))?;
                    let arguments = mechanism.argument_values(&coordinates);
                    Some([ways.distance(&view, &arguments)?, time])
                });
                pieces.min_by(|p, q| p[0].total_cmp(&q[0]))
            });
            (look.lowest, nearest)
        };
        stretch.open.iter().map(one).collect()
    }

    /// The pose at a time of the piece whose dimensions are at δ; `None` if it does not close within the box.
    fn piece(
        &self,
        solver: &mut PoseSolver,
        enclosure: &PoseEnclosure,
        tolerances: &[ToleranceInterval],
        (place, time): (&[f64], f64),
    ) -> Option<Vec<f64>> {
        let family = self.plan.family;
        let first = family.mechanism().unknowns.len();
        let inputs = family.actuation.inputs_at(time);
        let middle = enclosure.middle();
        // The inputs at that time, and the dimensions of one of the requested pieces.
        let value = |(k, tolerance): (usize, &ToleranceInterval)| {
            let drawn = inputs[tolerance.slot - first];
            let by = self.plan.dimensions.get(k).map_or(0.0, |d| d.tolerance);
            drawn + place[k] * by
        };
        let values: Vec<f64> = tolerances.iter().enumerate().map(value).collect();
        let pairs = values.iter().zip(tolerances);
        let at: Vec<f64> = pairs
            .clone()
            .map(|(v, t)| ((v - middle[t.slot]) / t.half_width).clamp(-1.0, 1.0))
            .collect();
        let mut coordinates = enclosure.coordinates_at(&at);
        for (value, tolerance) in pairs {
            coordinates[tolerance.slot] = *value;
        }
        let closed = solver.closed(&mut coordinates, Pace::Brisk) && enclosure.holds(&coordinates);
        closed.then_some(coordinates)
    }
}

/// The bound that is close enough to the nearest piece found.
fn wanted_bound(pair: &PieceClearance, tolerance: f64) -> f64 {
    let scale = pair.minimum.abs().max(pair.found.abs());
    pair.found - NEAR * (pair.nominal - pair.found) - tolerance * scale
}
