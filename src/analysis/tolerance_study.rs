//! The tolerance analysis of a study, shared by program and library: linear rules, corners, proved bands, random
//! pieces.

use super::enclosure::{MOST_DIMENSIONS, MeasureBand, TolerancePlan, enclose_measures};
use super::extremes::found_extremes;
use super::piece_sums::HistogramBins;
use super::study::{
    Evaluator, FamilyError, LoadedStudy, Nominal, NominalStudy, ParametricMechanism,
};
use super::tolerance::{Linear, Pieces, SampleBatch, linear_tolerance, sample_pieces};
use std::sync::atomic::AtomicBool;

/// A study whose dimensions scatter.
pub struct ToleranceStudy<'a> {
    /// The study.
    pub study: &'a LoadedStudy,
    /// It at the file's own values.
    pub nominal: NominalStudy,
    /// Half the width of every variable's tolerance, in internal units.
    pub tolerances: Vec<f64>,
    /// The linear scatter of every measure.
    pub linear: Vec<Linear>,
    /// Extreme values of every measure at corners of the tolerances, once they are computed.
    corners: Vec<[f64; 2]>,
    /// Proved bounds over all pieces; empty if not proved or not computed yet.
    bands: Vec<MeasureBand>,
    batch: SampleBatch,
}

impl<'a> ToleranceStudy<'a> {
    /// Prepares the random pieces of `batch`. `general` is the tolerance of variables that have none of their own, in
    /// the file's units.
    ///
    /// # Errors
    /// A variable without a tolerance; poses or measures that do not exist with the file's values.
    pub fn new(
        study: &'a LoadedStudy,
        general: Option<f64>,
        batch: SampleBatch,
    ) -> Result<Self, FamilyError> {
        let tolerances = study.tolerances(general)?;
        let nominal = study.nominal_of_pieces()?;
        Ok(Self {
            linear: linear_tolerance(&nominal.gradients, &tolerances, batch.distribution),
            corners: Vec::new(),
            bands: Vec::new(),
            study,
            nominal,
            tolerances,
            batch,
        })
    }

    /// Adds the extremes at corners of the tolerances and the proved bands of all pieces, until `cancel` is raised.
    pub fn with_extremes(mut self, cancel: &AtomicBool) -> Self {
        let family = &self.study.family;
        let (poses, gradients) = (&self.nominal.poses, &self.nominal.gradients);
        let mut evaluator = Evaluator::new(family);
        self.corners = found_extremes(&mut evaluator, poses, gradients, &self.tolerances, cancel);
        self.bands = never_beyond(family, &self.nominal.drawn, &self.tolerances, cancel);
        self
    }

    /// Where the values of every measure are counted.
    pub fn bins(&self) -> Vec<HistogramBins> {
        let family = &self.study.family;
        let measures = family.measures.list.iter();
        let values = self.nominal.gradients.measures.iter().zip(&self.linear);
        measures
            .zip(values)
            .map(|(measure, (nominal, linear))| {
                let size = family.mechanism().natural_size(measure.kind);
                HistogramBins::new(*nominal, linear.linear_sum, size)
            })
            .collect()
    }

    /// How many pieces were asked for, and how they scatter.
    pub fn batch(&self) -> SampleBatch {
        self.batch
    }

    /// The random pieces; ends early when `cancel` is raised. `watch` is called now and then with their number.
    pub fn pieces(&self, cancel: &AtomicBool, watch: &dyn Fn(usize)) -> Pieces {
        self.pieces_of(self.batch, cancel, watch)
    }

    /// The pieces of another batch.
    pub fn pieces_of(
        &self,
        batch: SampleBatch,
        cancel: &AtomicBool,
        watch: &dyn Fn(usize),
    ) -> Pieces {
        let (family, poses) = (&self.study.family, &self.nominal.poses);
        sample_pieces(family, poses, &self.tolerances, batch, cancel, watch)
    }

    /// Extreme values of a measure among pieces, if they are known, and corners.
    pub fn found(&self, measure: usize, pieces: Option<[f64; 2]>) -> [f64; 2] {
        let corners = self.corners.get(measure).copied();
        let known = corners.into_iter().chain(pieces);
        known.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], [a, b]| {
            [lo.min(a), hi.max(b)]
        })
    }

    /// Proved lower and upper bounds of a measure; infinite if not proved.
    pub fn band(&self, measure: usize) -> [f64; 2] {
        let band = self.bands.get(measure);
        band.map_or([f64::NEG_INFINITY, f64::INFINITY], |b| [b.lo, b.hi])
    }
}

fn never_beyond(
    family: &ParametricMechanism,
    drawn: &Nominal,
    tolerances: &[f64],
    cancel: &AtomicBool,
) -> Vec<MeasureBand> {
    let variables = &family.study.variables;
    if !family.kept.is_empty() || variables.len() > MOST_DIMENSIONS {
        return Vec::new();
    }
    let named = variables.iter().map(|v| v.name.clone());
    let list: Vec<(String, f64)> = named.zip(tolerances.iter().copied()).collect();
    let plan = TolerancePlan::new(family, &list).until(cancel);
    enclose_measures(&plan, drawn).unwrap_or_default()
}
