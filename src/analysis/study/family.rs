//! A mechanism with variables, and its poses along the tracks of its study.

use super::family_error::FamilyError;
use super::reshaped::{self, Reading};
use crate::diag::Source;
use crate::kinematics::measures::{driven_along, motion_along};
use crate::kinematics::motion::continuation::{solve_motion, solve_whole};
use crate::kinematics::motion::sampling::{end_apart, measured_times};
use crate::kinematics::results::certificate::Certificate;
use crate::kinematics::results::trajectory::Sample;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::carried::CarriedShape;
use crate::model::drive::Drive;
use crate::model::measure::{Measure, MeasureSource, Measures};
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::study::{Study, Variable};
use crate::scene::{KeptParameter, Overrides, load_scene};
use glam::DVec3;
use std::sync::Arc;

/// Number of poses along the drive at which a study evaluates measures.
pub const DRIVE_SAMPLES: usize = 180;

/// A mechanism whose last inputs are the variables of its study.
#[derive(Clone, Debug)]
pub struct ParametricMechanism {
    /// In its mechanism traced points have frames of their own; bodies are as in the file.
    system: Arc<System>,
    /// The scene's drives; the variables rest.
    pub actuation: Actuation,
    /// What is measured.
    pub measures: Measures,
    /// The variables, objective and limits.
    pub study: Study,
    /// Variables whose file values are still used somewhere.
    pub kept: Vec<KeptParameter>,
    /// Solids as functions of the variables, if the overrides request them.
    pub carried: Vec<CarriedShape>,
    /// Number of poses of every track, and last of the drive if a measure refers to it.
    counts: Vec<usize>,
    /// The last pose of the drive is its end, which only some measures take.
    ends_apart: bool,
    /// Times of further poses along the drive.
    more_times: Vec<f64>,
}

/// The poses of a study with the file's values, and their proofs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Nominal {
    /// Unknowns, then inputs, of every pose, track after track.
    pub poses: Vec<Vec<f64>>,
    /// Largest certified error of a coordinate, in the scene's unit as certificates have it.
    pub error_bound: f64,
    /// Poses without a certificate.
    pub unproved: usize,
    /// Where it first comes to a singular pose.
    pub singular: Option<SingularPassage>,
}

/// A singular pose on the way of the poses with the file's values. A piece near them may go on from there in another assembly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingularPassage {
    /// Seconds; along a track, steps.
    pub time: f64,
    /// The first pose behind it, of all.
    pub behind: usize,
}

impl Nominal {
    fn add(&mut self, pose: Vec<f64>, certificate: Certificate) {
        self.poses.push(pose);
        match certificate {
            Certificate::Certified { error_bound, .. }
            | Certificate::Consistent { error_bound, .. } => {
                self.error_bound = self.error_bound.max(error_bound)
            }
            Certificate::Locked { .. } | Certificate::Refused { .. } => self.unproved += 1,
        }
    }
}

impl ParametricMechanism {
    /// Reads the scene with the parameters called `vary` as variables, or with those of its `[study]`.
    ///
    /// # Errors
    /// Mistakes in the scene; nothing to vary or to measure; a variable in a place that it cannot be followed to; a mechanism
    /// that is not determined.
    pub fn load(
        source: &Source,
        overrides: &Overrides,
        vary: &[String],
    ) -> Result<Self, FamilyError> {
        let overrides = &Overrides {
            derives_measures: true,
            ..overrides.clone()
        };
        // A first reading gives the names of the variables and the size; a second one makes them inputs.
        let nominal = load_scene(source, overrides).map_err(Box::new)?;
        let own = nominal.study.iter().flat_map(|s| &s.variables);
        let names: Vec<String> = if vary.is_empty() {
            own.map(|v| v.name.clone()).collect()
        } else {
            vary.to_vec()
        };
        if names.is_empty() {
            return Err(FamilyError::nothing_to_vary(&nominal.dimensions));
        }
        let mut family = Self::of(source, overrides, names, nominal.mechanism.size)?;
        if family.measures.list.is_empty() {
            let message = "the scene has no `[measures]`: a study evaluates them";
            return Err(FamilyError::Lacks(message.to_owned()));
        }
        match family.kept.pop() {
            Some(kept) => Err(FamilyError::Kept(kept)),
            None => Ok(family),
        }
    }

    /// The scene with the parameters called `names` as variables, whether it has measures or not.
    ///
    /// # Errors
    /// Mistakes in the scene; a mechanism that is not determined.
    pub fn varying(
        source: &Source,
        overrides: &Overrides,
        names: &[String],
    ) -> Result<Self, FamilyError> {
        let nominal = load_scene(source, overrides).map_err(Box::new)?;
        Self::of(source, overrides, names.to_vec(), nominal.mechanism.size)
    }

    /// The same for a scene that has been read: its mechanism has this size.
    ///
    /// # Errors
    /// As for [`varying`](Self::varying).
    pub fn of(
        source: &Source,
        overrides: &Overrides,
        names: Vec<String>,
        size: f64,
    ) -> Result<Self, FamilyError> {
        let plain = overrides.clone();
        let overrides = Overrides {
            vary: names,
            // Fixed offsets become joints of this mechanism; the scale of its residuals is kept.
            size: Some(size),
            ..overrides.clone()
        };
        let scene = load_scene(source, &overrides).map_err(Box::new)?;
        let mut study = scene
            .study
            .map_or_else(Study::default, Arc::unwrap_or_clone);
        if overrides.vary.is_empty() {
            study.variables.clear();
        }
        let mut mechanism = scene.mechanism;
        let own = Arc::make_mut(&mut mechanism);
        let unit = |v: &Variable| (v.clone(), own.file_units(v.kind));
        let reading = Reading {
            source: source.clone(),
            overrides: plain,
            first: own.coordinate_count() - study.variables.len(),
            variables: study.variables.iter().map(unit).collect(),
        };
        reshaped::follow(own, &reading, &scene.shaped_by);
        let system = System::new(mechanism, &scene.actuation)?;
        let mut measures = Arc::unwrap_or_clone(scene.measures);
        study.limit(&mut measures);
        let mut counts: Vec<usize> = measures.tracks.iter().map(|t| t.samples).collect();
        let along_drive = |m: &Measure| matches!(m.source, MeasureSource::Over { track: None, .. });
        let end = end_apart(system.mechanism(), &scene.actuation, &measures);
        if measures.list.iter().any(along_drive) {
            counts.push(DRIVE_SAMPLES + usize::from(end.is_some()));
        }
        Ok(Self {
            system: Arc::new(system),
            actuation: scene.actuation,
            measures,
            study,
            kept: scene.kept,
            carried: scene.carried,
            counts,
            ends_apart: end.is_some(),
            more_times: Vec::new(),
        })
    }

    /// The mechanism with its variables as inputs, ready to be solved.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// The mechanism with its variables as inputs.
    pub fn mechanism(&self) -> &Mechanism {
        self.system.mechanism()
    }

    /// Number of the scene's own inputs; the variables follow them.
    pub fn own_inputs(&self) -> usize {
        self.mechanism().inputs.len() - self.study.variables.len()
    }

    /// A value as a scene writes it.
    pub fn file_text(&self, kind: Kind, value: f64) -> String {
        format!("{:?}", self.mechanism().file_value(kind, value))
    }

    /// The value of a variable as a scene writes it.
    pub fn variable_text(&self, variable: &Variable, value: f64) -> String {
        self.file_text(variable.kind, value) + variable.suffix
    }

    /// Factor from internal values to the file's units.
    pub fn units(&self, kind: Kind) -> f64 {
        self.mechanism().file_units(kind)
    }

    /// A measure's value in the file's unit.
    pub fn shown(&self, measure: &Measure, value: f64) -> f64 {
        value * self.units(measure.kind)
    }

    /// The objective.
    pub fn objective(&self) -> Option<&Measure> {
        self.measures.list.get(self.study.objective?)
    }

    /// Whether a search looks at a measure: the objective, and what is limited.
    pub fn is_sought(&self, measure: usize) -> bool {
        let limited = |m: &Measure| m.min.is_some() || m.max.is_some();
        self.study.objective == Some(measure) || limited(&self.measures.list[measure])
    }

    /// Derivatives of the inputs by the variables, which are the last inputs: a row each.
    pub(super) fn input_rows(&self) -> Vec<Vec<f64>> {
        let (own, count) = (self.own_inputs(), self.study.variables.len());
        let mut rows = vec![vec![0.0; count]; own + count];
        (0..count).for_each(|k| rows[own + k][k] = 1.0);
        rows
    }

    /// The file's values of the variables.
    pub fn start(&self) -> Vec<f64> {
        self.study.variables.iter().map(|v| v.start).collect()
    }

    /// The same family with other values as its own; bodies stay as in the file.
    pub fn with_start(&self, values: &[f64]) -> Self {
        let mut family = self.clone();
        let first = self.own_inputs();
        for (k, value) in values.iter().enumerate() {
            family.actuation.drives[first + k] = Drive::constant(*value);
            family.study.variables[k].start = *value;
            for track in &mut family.measures.tracks {
                (track.from[first + k], track.to[first + k]) = (*value, *value);
            }
        }
        family
    }

    /// Frees every variable within this fraction of its value, replacing its range; one with value zero keeps its
    /// range.
    pub fn free_within(&mut self, share: f64) {
        for variable in &mut self.study.variables {
            let half = share * variable.start.abs();
            if half > 0.0 {
                (variable.lower, variable.upper) = (variable.start - half, variable.start + half);
            }
        }
    }

    /// The same family with its tracks divided this many times as finely.
    pub fn with_finer_tracks(&self, times: usize) -> Self {
        let mut family = self.clone();
        let tracks = family.measures.tracks.iter_mut();
        for (track, count) in tracks.zip(&mut family.counts) {
            *count = times * (*count - 1) + 1;
            track.samples = *count;
        }
        family
    }

    /// Every pose of every track with the file's values, followed from the start of the drive.
    ///
    /// # Errors
    /// The first pose that does not exist.
    pub fn nominal(&self) -> Result<Nominal, FamilyError> {
        let mut nominal = Nominal::default();
        for row in 0..self.counts.len() {
            // The way to a track does not belong to it.
            let (motion, skipped) = match self.measures.tracks.get(row) {
                Some(track) => (motion_along(&self.system, &self.actuation, track), 1),
                None => {
                    let times = self.drive_times();
                    (solve_motion(&self.system, &self.actuation, &times), 0)
                }
            };
            let singular = motion.first_singular();
            let samples = &motion.of_one_motion()[skipped..];
            if let (None, Some(time)) = (nominal.singular, singular) {
                let before = samples.iter().take_while(|s| s.time <= time).count();
                let behind = nominal.poses.len() + before;
                nominal.singular = Some(SingularPassage { time, behind });
            }
            self.add_samples(row, samples, &mut nominal)?;
        }
        Ok(nominal)
    }

    /// The times of the poses along the drive.
    pub(super) fn drive_times(&self) -> Vec<f64> {
        let (mechanism, actuation) = (self.mechanism(), &self.actuation);
        let mut times = measured_times(mechanism, actuation, &self.measures, DRIVE_SAMPLES);
        times.extend(&self.more_times);
        times.sort_by(f64::total_cmp);
        times
    }

    /// The same family with poses of the drive at further times, between its first pose and its last.
    pub(super) fn at_more_times(mut self, times: Vec<f64>) -> Self {
        if let Some(count) = self.counts.get_mut(self.measures.tracks.len()) {
            *count += times.len();
            self.more_times.extend(times);
        }
        self
    }

    /// The same family with the pose at the start of its drive as start values; `None` where there is none.
    pub fn assembled(mut self) -> Option<Self> {
        let start = solve_whole(&self.system, &self.actuation, &[0.0])?;
        self.actuation.guess = start.samples.into_iter().next()?.pose?.unknowns;
        Some(self)
    }

    /// The poses of [`nominal`](Self::nominal) without certificates; `None` at the first gap of a motion.
    pub fn whole_motion(&self) -> Option<Vec<Vec<f64>>> {
        let mut poses = Vec::new();
        for row in 0..self.counts.len() {
            let (samples, skipped) = match self.measures.tracks.get(row) {
                Some(track) => {
                    // The drive leads to the start of the track first; that pose does not belong to the track.
                    let (moved, times) = driven_along(&self.actuation, track);
                    (solve_whole(&self.system, &moved, &times)?.samples, 1)
                }
                None => {
                    let times = self.drive_times();
                    let motion = solve_whole(&self.system, &self.actuation, &times)?;
                    (motion.samples, 0)
                }
            };
            for sample in samples.into_iter().skip(skipped) {
                poses.push([sample.pose?.unknowns, sample.inputs].concat());
            }
        }
        Some(poses)
    }

    fn add_samples(
        &self,
        row: usize,
        samples: &[Sample],
        nominal: &mut Nominal,
    ) -> Result<(), FamilyError> {
        for (k, sample) in samples.iter().enumerate() {
            let Some(pose) = &sample.pose else {
                return Err(FamilyError::Track {
                    track: self.row_name(row),
                    message: format!(
                        "no motion was found that leads to pose {} with the file's values",
                        k + 1
                    ),
                });
            };
            let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
            nominal.add(coordinates, pose.certificate);
        }
        Ok(())
    }

    /// The range of poses of every track, and last of the drive if a measure refers to it.
    pub fn rows(&self) -> Vec<(String, std::ops::Range<usize>)> {
        let mut start = 0;
        let rows = self.counts.iter().enumerate().map(|(row, count)| {
            start += count;
            (self.row_name(row), start - count..start)
        });
        rows.collect()
    }

    /// The positions of traced point `trace` at `poses`, in world coordinates.
    pub fn path(&self, poses: &[Vec<f64>], trace: usize) -> Vec<DVec3> {
        let trace = &self.mechanism().traces[trace];
        let chain = &self.mechanism().bodies[trace.body].world_from_body;
        let place = |pose: &Vec<f64>| {
            let arguments = self.mechanism().argument_values(pose);
            chain.pose(&arguments).transform_point(trace.point)
        };
        poses.iter().map(place).collect()
    }

    /// Name of a track, or of the drive, which is last.
    fn row_name(&self, row: usize) -> String {
        let track = self.measures.tracks.get(row);
        track.map_or_else(|| "the drive".to_owned(), |t| t.name.clone())
    }

    /// The range of poses of a track or of the drive.
    pub(super) fn poses_of(&self, track: Option<usize>) -> std::ops::Range<usize> {
        let row = track.unwrap_or(self.measures.tracks.len());
        self.ranges().nth(row).unwrap_or_default()
    }

    /// The range of poses that a measure is reduced from.
    pub fn poses_taken(&self, source: &MeasureSource) -> std::ops::Range<usize> {
        let track = source.track();
        let poses = self.poses_of(track);
        let is_left_out = self.ends_apart && track.is_none() && !source.reaches_end();
        poses.start..poses.end - usize::from(is_left_out)
    }

    /// Whether the last pose of the drive is its end, which only some measures take.
    pub fn ends_apart(&self) -> bool {
        self.ends_apart
    }

    /// The poses of every track, and last of the drive if a measure refers to it.
    pub(super) fn ranges(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let mut end = 0;
        self.counts.iter().map(move |count| {
            let start = end;
            end += count;
            start..end
        })
    }

    /// Name of the track of pose `index` of all, and its number there from 1.
    pub fn place_of(&self, index: usize) -> (String, usize) {
        let mut rest = index;
        for (row, count) in self.counts.iter().enumerate() {
            if rest < *count {
                return (self.row_name(row), rest + 1);
            }
            rest -= count;
        }
        (String::new(), 0)
    }
}
