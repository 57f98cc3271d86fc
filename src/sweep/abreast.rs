//! Rows of eight designs at once, without certificates: from the file's values to the designs, then along the drive, in
//! steps that are trusted under the usual conditions. A design that violates them is solved in the ordinary way.

use super::row::{Row, RowStatus};
use super::swept_scene::{RequestedValues, Sweep};
use crate::kinematics::abreast::following::LaneFollower;
use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::results::columns::ValueColumn;
use crate::model::mechanism::OutputSource;
use crate::numbers::octet::{LANES, LaneMask, Octet};

/// Designs of a group.
pub(super) const GROUP: u64 = LANES as u64;

/// Steps from the file's values to those of a design. Few ranges are too wide for this number of trusted steps.
const STEPS: usize = 16;

/// Makes rows of eight designs; one for each thread.
pub(super) struct RowGroup<'s> {
    sweep: &'s Sweep,
    follower: LaneFollower<'s>,
    /// The scene's own inputs at the start of the drive, then at every instant.
    drive: Vec<Vec<f64>>,
    /// Columns of the values among the slots of a pose, and their units.
    columns: Vec<(usize, f64)>,
}

impl<'s> RowGroup<'s> {
    /// `None` if rows are to be proved, or contain more than named values of the motion.
    pub fn new(sweep: &'s Sweep) -> Option<Self> {
        let (family, mechanism) = (sweep.family(), sweep.family().mechanism());
        let is_asked = matches!(
            sweep.asked,
            RequestedValues::Outputs {
                is_proved: false,
                ..
            }
        );
        let mut outputs = mechanism.outputs.iter();
        let are_formulas = outputs.all(|o| matches!(o.source, OutputSource::Formula(_)));
        if !is_asked || !are_formulas || sweep.reads_anew() {
            return None;
        }
        let own = family.own_inputs();
        let instants = std::iter::once(0.0).chain(sweep.instants(&family.actuation));
        let at = |time| {
            let mut inputs = family.actuation.inputs_at(time);
            inputs.truncate(own);
            inputs
        };
        let columns = sweep.shown.iter();
        let place = |c: &ValueColumn| (c.slot(mechanism), mechanism.file_units(c.kind(mechanism)));
        Some(Self {
            follower: LaneFollower::new(family.system())?,
            drive: instants.map(at).collect(),
            columns: columns.map(place).collect(),
            sweep,
        })
    }

    /// The rows of at most eight designs with these parameters; `None` for those left to the ordinary method.
    pub fn rows(&mut self, designs: &[Vec<f64>]) -> Vec<Option<Row>> {
        let origin = &self.sweep.origin;
        let mut pose: Vec<Octet> = origin.coordinates().map(Octet::splat).collect();
        let mut lanes = LaneMask::first(designs.len());
        lanes = self.follower.begin(&pose, lanes);
        let known = &origin.inputs[self.sweep.family().own_inputs()..];
        for step in 1..=STEPS {
            let inputs = self.inputs(0, designs, known, step as f64 / STEPS as f64);
            lanes = self.follower.step(&mut pose, &inputs, lanes);
        }
        let (instants, mechanism) = (self.drive.len() - 1, self.sweep.family().mechanism());
        let mut values = vec![Octet::ZERO; self.columns.len() * instants];
        let mut closure = Octet::ZERO;
        for instant in 0..instants {
            if !lanes.any() {
                break;
            }
            let inputs = self.inputs(instant + 1, designs, known, 1.0);
            lanes = self.follower.step(&mut pose, &inputs, lanes);
            closure = closure.larger_magnitude(self.follower.closure_error(&pose));
            let slots = observed_slots(mechanism, &pose);
            for (k, (slot, unit)) in self.columns.iter().enumerate() {
                values[k * instants + instant] = slots[*slot] * *unit;
            }
        }
        let row = |lane: usize| {
            let values: Vec<f64> = values.iter().map(|v| v.lane(lane)).collect();
            let is_whole = closure.lane(lane).is_finite() && values.iter().all(|v| v.is_finite());
            (lanes.has(lane) && is_whole).then_some(Row {
                status: RowStatus::Ok,
                is_feasible: true,
                values,
                closure_error: closure.lane(lane),
                error_bound: f64::NAN,
                unproved: instants as f64,
            })
        };
        (0..designs.len()).map(row).collect()
    }

    /// Inputs at an instant, with the parameters at the fraction `share` between the file's and the designs' values.
    fn inputs(
        &self,
        instant: usize,
        designs: &[Vec<f64>],
        known: &[f64],
        share: f64,
    ) -> Vec<Octet> {
        let parameter = |k: usize| {
            let of_lane = |lane: usize| {
                let wanted = designs.get(lane).map_or(known[k], |design| design[k]);
                match share == 1.0 {
                    true => wanted,
                    false => known[k] + (wanted - known[k]) * share,
                }
            };
            Octet::new(std::array::from_fn(of_lane))
        };
        let own = self.drive[instant].iter().map(|v| Octet::splat(*v));
        own.chain((0..known.len()).map(parameter)).collect()
    }
}
