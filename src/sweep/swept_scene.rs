//! A scene whose parameters are swept: the values requested for every design, and their computation for a posed design.

use super::design::Design;
use super::posing::{FirstPose, Proved};
use super::row::{Row, RowStatus};
use crate::analysis::study::{FamilyError, ParametricMechanism};
use crate::diag::Source;
use crate::kinematics::measures::{DriveSamples, measure_watched};
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::motion::sampling::{end_apart, even_times, measured_times};
use crate::kinematics::results::certificate::{Certificate, Reason};
use crate::kinematics::results::columns::ValueColumn;
use crate::kinematics::results::trajectory::{ClosedPose, EventKind, Sample, Trajectory};
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::measure::{Measure, MeasureSource, Measures};
use crate::model::mechanism::Mechanism;
use crate::scene::Overrides;
use crate::scene::columns::DESIGN_CHECK;
use crate::scene::text::SceneText;

/// The values requested for every design.
#[derive(Clone, Debug, PartialEq)]
pub enum RequestedValues {
    /// The measures of the scene, with this number of samples along the drive.
    Measures {
        /// Poses along the drive, if a measure needs them.
        samples: usize,
        /// Whether every pose has a certificate.
        is_proved: bool,
    },
    /// Named values at instants of the drive.
    Outputs {
        /// Names of inputs, unknowns, coordinates of traced points, or outputs.
        names: Vec<String>,
        /// The instants.
        at: Instants,
        /// Whether every pose has a certificate.
        is_proved: bool,
    },
    /// Everything that `mechanim check` tests.
    Check,
}

/// Instants of a drive.
#[derive(Clone, Debug, PartialEq)]
pub enum Instants {
    /// This number of instants, evenly spaced.
    Even(usize),
    /// These, in seconds, ascending.
    At(Vec<f64>),
}

impl RequestedValues {
    /// Whether every pose is to have a certificate.
    pub fn is_proved(&self) -> bool {
        match self {
            Self::Measures { is_proved, .. } | Self::Outputs { is_proved, .. } => *is_proved,
            Self::Check => true,
        }
    }
}

impl Instants {
    fn times(&self, mechanism: &Mechanism, actuation: &Actuation) -> Vec<f64> {
        match self {
            Self::At(times) => times.clone(),
            Self::Even(count) => even_times(mechanism, actuation, *count),
        }
    }
}

/// A scene whose parameters are swept.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The designs.
    pub design: Design,
    /// The values requested for each.
    pub asked: RequestedValues,
    /// Names of the values of a row, with their units.
    pub columns: Vec<(String, String)>,
    pub(super) family: ParametricMechanism,
    pub(super) text: SceneText,
    pub(super) overrides: Overrides,
    pub(super) origin: FirstPose,
    /// Indices of the family's parameters among those of the design.
    order: Vec<usize>,
    pub(super) shown: Vec<ValueColumn>,
}

impl Sweep {
    /// Reads the scene with the design's parameters as inputs of its mechanism, and poses it with the file's values.
    ///
    /// # Errors
    ///
    /// Mistakes in the scene; no pose with the file's values; a value that the scene does not have.
    pub fn new(
        source: Source,
        overrides: Overrides,
        design: Design,
        asked: RequestedValues,
    ) -> Result<Self, FamilyError> {
        let names = design.names();
        let family = ParametricMechanism::varying(&source, &overrides, &names)?;
        let variables = family.study.variables.iter();
        let place = |name: &String| names.iter().position(|other| other == name);
        let order = variables.filter_map(|v| place(&v.name)).collect();
        let shown = shown_columns(&family, &asked)?;
        if matches!(asked, RequestedValues::Measures { .. }) && family.measures.list.is_empty() {
            let message =
                "the scene has no `[measures]`: ask for values with --outputs, or for --check";
            return Err(FamilyError::Lacks(message.to_owned()));
        }
        Ok(Self {
            origin: FirstPose::new(&family)?,
            columns: value_names(&family, &asked, &shown),
            family,
            design,
            asked,
            text: SceneText::read(source),
            overrides,
            order,
            shown,
        })
    }

    /// Title of the scene.
    pub fn title(&self) -> &str {
        &self.family.mechanism().title
    }

    /// The family of mechanisms that contains all designs.
    pub fn family(&self) -> &ParametricMechanism {
        &self.family
    }

    /// Numbers that a partial result stores per row.
    pub fn width(&self) -> usize {
        Row::width(self.columns.len())
    }

    /// Whether the scene is read again for every row: for a check, whose bodies follow the design, and if parameters
    /// appear in drives, in tracks, or in measures through another parameter.
    pub fn reads_anew(&self) -> bool {
        self.asked == RequestedValues::Check || !self.family.kept.is_empty()
    }

    /// A row without numbers.
    pub(super) fn empty_row(&self, status: RowStatus) -> Row {
        Row {
            status,
            is_feasible: false,
            values: vec![f64::NAN; self.columns.len()],
            closure_error: f64::NAN,
            error_bound: f64::NAN,
            unproved: f64::NAN,
        }
    }

    /// Values requested besides a check, of a mechanism that is driven along `posed`.
    pub(super) fn answer(&self, posed: &Posed, start: RowStatus) -> Row {
        let mut proved = Proved::default();
        let times = self.instants(posed.actuation, posed.measures);
        // The motion begins where the drive does; that pose counts only if it is asked for.
        let lead: &[f64] = match times.first() {
            Some(first) if *first > 0.0 => &[0.0],
            _ => &[],
        };
        let all = [lead, &times].concat();
        let mut motion = solve_motion(posed.system, posed.actuation, &all);
        let mut status = motion_status(&motion, start);
        motion.samples.drain(..lead.len());
        proved.add(posed.system.mechanism(), motion.poses());
        let values = match &self.asked {
            // Behind the end of a motion nothing is known of its assembly.
            RequestedValues::Outputs { .. } => self.outputs(posed, &motion.of_one_motion()),
            _ => {
                let mut seen = |track: &Trajectory| {
                    proved.add(posed.system.mechanism(), track.poses());
                    status = status.worse(motion_status(track, start));
                };
                let end = end_apart(self.family.mechanism(), posed.actuation, posed.measures);
                let along = DriveSamples::with_end(&motion.samples, end.is_some());
                let found = measure_watched(
                    posed.system,
                    posed.actuation,
                    posed.measures,
                    along,
                    &mut seen,
                );
                // A measure of a motion with a gap would mix what lies before and behind it.
                let is_whole = !matches!(status, RowStatus::NotClosed | RowStatus::Undecided);
                let known = |value: Option<f64>| value.filter(|_| is_whole).unwrap_or(f64::NAN);
                found.into_iter().map(known).collect()
            }
        };
        if status == RowStatus::Ok && values.iter().any(|v: &f64| !v.is_finite()) {
            status = RowStatus::Refused;
        }
        let is_feasible = status == RowStatus::Ok && self.keeps_limits(posed.measures, &values);
        Row {
            status,
            is_feasible,
            values: self.in_file_units(values),
            closure_error: proved.closure_error,
            error_bound: proved.error_bound,
            unproved: proved.unproved,
        }
    }

    /// The instants of values along a drive.
    pub(super) fn instants(&self, actuation: &Actuation, measures: &Measures) -> Vec<f64> {
        let mechanism = self.family.mechanism();
        match &self.asked {
            RequestedValues::Outputs { at, .. } => at.times(mechanism, actuation),
            RequestedValues::Measures { samples, .. } if looks_along_drive(measures) => {
                measured_times(mechanism, actuation, measures, *samples)
            }
            // Only the start of the drive is needed.
            _ => vec![0.0],
        }
    }

    /// The values at every instant in turn, in the file's units.
    fn outputs(&self, posed: &Posed, samples: &[Sample]) -> Vec<f64> {
        let mechanism = posed.system.mechanism();
        let at = |column: &ValueColumn, sample: &Sample| match &sample.pose {
            Some(pose) => column.value(mechanism, sample, pose),
            None => f64::NAN,
        };
        let columns = self.shown.iter();
        columns
            .flat_map(|column| samples.iter().map(|sample| at(column, sample)))
            .collect()
    }

    /// Whether measures meet their own limits and those of the study.
    pub(super) fn keeps_limits(&self, measures: &Measures, values: &[f64]) -> bool {
        match self.asked {
            RequestedValues::Measures { .. } => {
                let mut pairs = measures.list.iter().zip(values);
                pairs.all(|(measure, value)| measure.allows(*value))
            }
            _ => true,
        }
    }

    /// Whether measures with limits are among what is asked for, each of which is judged at its samples.
    pub(super) fn has_limits(&self) -> bool {
        let mut measures = self.family.measures.list.iter();
        matches!(self.asked, RequestedValues::Measures { .. })
            && measures.any(|measure| measure.min.is_some() || measure.max.is_some())
    }

    /// Measures are computed in radians; outputs are already in the file's units.
    pub(super) fn in_file_units(&self, mut values: Vec<f64>) -> Vec<f64> {
        if let RequestedValues::Measures { .. } = self.asked {
            let measures = self.family.measures.list.iter();
            for (value, measure) in values.iter_mut().zip(measures) {
                *value = self.family.shown(measure, *value);
            }
        }
        values
    }

    /// The parameters of a design in internal units, in the order of the family.
    pub(super) fn internal(&self, design: &[f64]) -> Vec<f64> {
        let variables = self.family.study.variables.iter().zip(&self.order);
        variables
            .map(|(v, place)| design[*place] / self.family.units(v.kind))
            .collect()
    }
}

/// A driven mechanism, and the values measured on it.
pub(super) struct Posed<'p> {
    pub system: &'p System,
    pub actuation: &'p Actuation,
    pub measures: &'p Measures,
}

/// Outcome of a motion that began as `start` states.
pub(super) fn motion_status(motion: &Trajectory, start: RowStatus) -> RowStatus {
    let is_open = |pose: &ClosedPose| {
        let reason = Reason::Open;
        pose.certificate == Certificate::Refused { reason }
    };
    if motion.poses().any(is_open) {
        return match motion.is_whole() || motion.is_undecided() {
            true => RowStatus::Open,
            false => RowStatus::NotClosed,
        };
    }
    let jumped = |kind: &EventKind| matches!(kind, EventKind::OtherStart);
    if motion.is_undecided() {
        return RowStatus::Undecided;
    }
    if !motion.is_whole() {
        return RowStatus::NotClosed;
    }
    match motion.events.iter().any(|event| jumped(&event.kind)) {
        true => RowStatus::OtherBranch,
        false => start,
    }
}

pub(super) fn looks_along_drive(measures: &Measures) -> bool {
    let along = |m: &Measure| matches!(m.source, MeasureSource::Over { track: None, .. });
    measures.list.iter().any(along)
}

fn shown_columns(
    family: &ParametricMechanism,
    asked: &RequestedValues,
) -> Result<Vec<ValueColumn>, FamilyError> {
    let RequestedValues::Outputs { names, .. } = asked else {
        return Ok(Vec::new());
    };
    let find = |name: &String| {
        let unknown = |known| FamilyError::Unknown {
            what: "value",
            name: name.clone(),
            known,
        };
        ValueColumn::find(family.mechanism(), name).map_err(unknown)
    };
    names.iter().map(find).collect()
}

/// Names and units of the values of a row.
fn value_names(
    family: &ParametricMechanism,
    asked: &RequestedValues,
    shown: &[ValueColumn],
) -> Vec<(String, String)> {
    let mechanism = family.mechanism();
    match asked {
        RequestedValues::Measures { .. } => {
            let measures = family.measures.list.iter();
            measures
                .map(|m| (m.name.clone(), mechanism.table_unit(m.kind, m.dimension)))
                .collect()
        }
        RequestedValues::Outputs { names, at, .. } => {
            let times = at.times(mechanism, &family.actuation);
            let columns = names.iter().zip(shown);
            let cells = columns.flat_map(|(name, column)| {
                let unit = mechanism.unit_name(column.kind(mechanism));
                times.iter().map(move |time| (name, *time, unit))
            });
            cells
                .map(|(name, time, unit)| (format!("{name}@{time}"), unit.to_owned()))
                .collect()
        }
        RequestedValues::Check => {
            let length = mechanism.length_unit.as_str();
            let columns = DESIGN_CHECK.map(str::to_owned).into_iter();
            let units = ["", length, length].map(str::to_owned);
            columns.zip(units).collect()
        }
    }
}
