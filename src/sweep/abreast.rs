//! Rows of eight designs at once, without certificates: from the file's values to the designs, then along the drive and
//! the tracks, in steps that are trusted under the usual conditions. Designs that violate them take shorter steps, and are
//! solved in the ordinary way if these do not help.

use super::row::{Row, RowStatus};
use super::swept_scene::{RequestedValues, Sweep, looks_along_drive};
use crate::analysis::study::LaneMeasures;
use crate::kinematics::abreast::following::LaneFollower;
use crate::kinematics::loops::observed::fill_slots;
use crate::kinematics::results::columns::ValueColumn;
use crate::model::drive::Drive;
use crate::model::measure::MeasuredTrack;
use crate::numbers::octet::{LANES, LaneMask, Octet};

/// Designs of a group.
pub(super) const GROUP: u64 = LANES as u64;

/// Steps from the file's values to those of a design, and from the start of the drive to that of a track.
const STEPS: usize = 16;

/// Parts of every step: of the first attempt, and of those for designs in which steps were not trusted. More than the last
/// cost as much as an ordinary row.
const PARTS: [usize; 3] = [1, 4, 16];

/// Inputs of the scene, and the share of the way from the file's parameters to those of the designs.
struct Target {
    own: Vec<f64>,
    share: f64,
}

/// Poses of eight designs along a way, one after the other.
type LanePoses = Vec<Vec<Octet>>;

/// What is asked of the poses of a row.
enum Asked<'s> {
    /// Slots of a pose, and their units.
    Columns(Vec<(usize, f64)>),
    Measures(LaneMeasures<'s>),
}

/// A way from the pose at the start of the drive.
struct Way {
    targets: Vec<Target>,
    /// The targets before this one lead to the poses that are asked for.
    first: usize,
}

/// Follows eight designs from target to target.
struct LaneRoute<'s> {
    sweep: &'s Sweep,
    follower: LaneFollower<'s>,
}

/// Makes rows of eight designs; one for each thread.
pub(super) struct RowGroup<'s> {
    route: LaneRoute<'s>,
    /// From the file's values to those of the designs.
    approach: Vec<Target>,
    /// Along every track, and last along the drive.
    ways: Vec<Way>,
    asked: Asked<'s>,
    /// The poses reached on every way, as slots of formulas.
    slots: Vec<LanePoses>,
    /// The poses of one way, with its lead.
    reached: LanePoses,
}

impl<'s> RowGroup<'s> {
    /// `None` if rows are to be proved, or contain what is not computed side by side.
    pub fn new(sweep: &'s Sweep) -> Option<Self> {
        let (family, mechanism) = (sweep.family(), sweep.family().mechanism());
        if sweep.asked.is_proved() || !mechanism.has_plain_outputs() || sweep.reads_anew() {
            return None;
        }
        // A drive that may turn back between two instants is followed in the ordinary way.
        let along_drive = match &sweep.asked {
            RequestedValues::Measures { .. } => looks_along_drive(&family.measures),
            _ => true,
        };
        if along_drive
            && !family.actuation.drives[..family.own_inputs()]
                .iter()
                .all(is_straight)
        {
            return None;
        }
        let place = |c: &ValueColumn| (c.slot(mechanism), mechanism.file_units(c.kind(mechanism)));
        let asked = match &sweep.asked {
            RequestedValues::Outputs { .. } => {
                Asked::Columns(sweep.shown.iter().map(place).collect())
            }
            RequestedValues::Measures { .. } => Asked::Measures(LaneMeasures::new(family)?),
            RequestedValues::Check => return None,
        };
        let own = family.own_inputs();
        let cut = |mut inputs: Vec<f64>| {
            inputs.truncate(own);
            inputs
        };
        let start = cut(family.actuation.inputs_at(0.0));
        let along = |track: &'s MeasuredTrack| {
            let pose = move |k| (0..own).map(|input| track.input_at(input, k)).collect();
            (0..track.samples).map(pose)
        };
        let tracks = family.measures.tracks.iter();
        let tracks: Vec<Way> = match &asked {
            Asked::Columns(_) => Vec::new(),
            Asked::Measures(_) => tracks.map(|t| Way::new(&start, along(t))).collect(),
        };
        let instants = sweep.instants(&family.actuation, &family.measures);
        let drive = instants.into_iter();
        let drive = drive.map(|time| cut(family.actuation.inputs_at(time)));
        let drive = Way::new(&start, drive);
        Some(Self {
            route: LaneRoute {
                follower: LaneFollower::new(family.system())?,
                sweep,
            },
            approach: parts_of(STEPS)
                .map(|share| Target::new(&start, share))
                .collect(),
            ways: tracks.into_iter().chain([drive]).collect(),
            asked,
            slots: Vec::new(),
            reached: LanePoses::default(),
        })
    }

    /// The rows of at most eight designs with these parameters; `None` for those left to the ordinary method.
    pub fn rows(&mut self, designs: &[Vec<f64>]) -> Vec<Option<Row>> {
        let sweep = self.route.sweep;
        let route = &mut self.route;
        let origin: Vec<Octet> = sweep.origin.coordinates().map(Octet::splat).collect();
        let mut lanes = LaneMask::first(designs.len());
        let reached = &mut self.reached;
        lanes = route.follow(&origin, &self.approach, designs, lanes, reached);
        let Some(start) = reached.last().cloned() else {
            return vec![None; designs.len()];
        };
        // The poses of every way, and how well they close.
        let (mechanism, mut closure) = (sweep.family().mechanism(), Octet::ZERO);
        self.slots.resize_with(self.ways.len(), Vec::new);
        for (way, slots) in self.ways.iter().zip(&mut self.slots) {
            lanes = route.follow(&start, &way.targets, designs, lanes, reached);
            let asked = reached.get(way.first..).unwrap_or_default();
            slots.resize_with(asked.len(), Vec::new);
            for (pose, slots) in asked.iter().zip(slots) {
                closure = closure.larger_magnitude(route.follower.closure_error(pose));
                fill_slots(mechanism, pose, |_| true, slots);
            }
        }
        let values = self.values(&self.slots, designs);
        let poses: usize = self.slots.iter().map(Vec::len).sum();
        let row = |(lane, values): (usize, Vec<f64>)| {
            let is_whole = closure.lane(lane).is_finite() && values.iter().all(|v| v.is_finite());
            (lanes.has(lane) && is_whole).then(|| Row {
                status: RowStatus::Ok,
                is_feasible: sweep.keeps_limits(&sweep.family().measures, &values),
                values: sweep.in_file_units(values),
                closure_error: closure.lane(lane),
                error_bound: f64::NAN,
                unproved: poses as f64,
            })
        };
        values.into_iter().enumerate().map(row).collect()
    }

    /// What is asked of each design.
    fn values(&self, slots: &[LanePoses], designs: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let columns = match &self.asked {
            Asked::Measures(measures) => {
                let slots: Vec<&[Vec<Octet>]> = slots.iter().map(Vec::as_slice).collect();
                return measures.of(&slots, designs);
            }
            Asked::Columns(columns) => columns,
        };
        let of_lane = |lane: usize| {
            let cells = columns.iter().flat_map(|(slot, unit)| {
                let poses = slots.iter().flatten();
                poses.map(move |slots| (slots[*slot] * *unit).lane(lane))
            });
            cells.collect()
        };
        (0..designs.len()).map(of_lane).collect()
    }
}

impl LaneRoute<'_> {
    /// Follows the designs from closed poses to all targets; fills `reached` with the poses there and returns the lanes
    /// whose steps were trusted.
    fn follow(
        &mut self,
        from: &[Octet],
        targets: &[Target],
        designs: &[Vec<f64>],
        lanes: LaneMask,
        reached: &mut LanePoses,
    ) -> LaneMask {
        reached.resize_with(targets.len(), Vec::new);
        for pose in reached.iter_mut() {
            pose.clear();
            pose.extend_from_slice(from);
        }
        let mut left = lanes;
        for parts in PARTS {
            if !left.any() {
                break;
            }
            let mut pose = from.to_vec();
            let mut trusted = self.follower.begin(&pose, left);
            for (target, reached) in targets.iter().zip(reached.iter_mut()) {
                let inputs = self.inputs(target, designs);
                let before = pose[pose.len() - inputs.len()..].to_vec();
                for share in parts_of(parts).take(parts - 1) {
                    let way = before.iter().zip(&inputs);
                    let between: Vec<Octet> = way
                        .map(|(from, to)| *from + (*to - *from) * share)
                        .collect();
                    trusted = self.follower.step(&mut pose, &between, trusted);
                }
                trusted = self.follower.step(&mut pose, &inputs, trusted);
                if !trusted.any() {
                    break;
                }
                let new = reached.iter_mut().zip(&pose);
                new.for_each(|(old, new)| *old = left.choose(*new, *old));
            }
            left = left.without(trusted);
        }
        lanes.without(left)
    }

    /// The inputs of a target, one design a lane.
    fn inputs(&self, target: &Target, designs: &[Vec<f64>]) -> Vec<Octet> {
        let known = &self.sweep.origin.inputs[self.sweep.family().own_inputs()..];
        let parameter = |k: usize| {
            let of_lane = |lane: usize| {
                let wanted = designs.get(lane).map_or(known[k], |design| design[k]);
                match target.share == 1.0 {
                    true => wanted,
                    false => known[k] + (wanted - known[k]) * target.share,
                }
            };
            Octet::new(std::array::from_fn(of_lane))
        };
        let own = target.own.iter().map(|v| Octet::splat(*v));
        own.chain((0..known.len()).map(parameter)).collect()
    }
}

impl Target {
    fn new(own: &[f64], share: f64) -> Self {
        let own = own.to_vec();
        Self { own, share }
    }
}

impl Way {
    /// Through the `poses`, given by the scene's own inputs. If the first one is not the start, steps lead there.
    fn new(start: &[f64], poses: impl Iterator<Item = Vec<f64>>) -> Self {
        let poses: Vec<Vec<f64>> = poses.collect();
        let lead = poses.first().filter(|first| *first != start);
        let between = |share: f64| {
            let pairs = start.iter().zip(lead.into_iter().flatten());
            pairs
                .map(|(a, b)| a + (b - a) * share)
                .collect::<Vec<f64>>()
        };
        let shares = parts_of(STEPS).filter(|share| lead.is_some() && *share < 1.0);
        let leading: Vec<Target> = shares
            .map(|share| Target::new(&between(share), 1.0))
            .collect();
        let first = leading.len();
        let poses = poses.iter().map(|pose| Target::new(pose, 1.0));
        Self {
            targets: leading.into_iter().chain(poses).collect(),
            first,
        }
    }
}

/// Whether a drive changes steadily with the time.
fn is_straight(drive: &Drive) -> bool {
    match drive {
        Drive::Formula(formula) => formula.affine().is_some(),
        Drive::Keys { .. } => false,
    }
}

/// The ends of so many equal parts of a way.
fn parts_of(count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(move |k| k as f64 / count as f64)
}
