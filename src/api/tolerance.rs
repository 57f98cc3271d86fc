//! Tolerance analysis of measures.

use super::error::Error;
use crate::analysis::study::LoadedStudy;
use crate::analysis::tolerance::{Distribution, SampleBatch};
use crate::analysis::tolerance_study::ToleranceStudy;
use crate::jobs::Stopwatch;
use crate::jobs::core_count;
use crate::model::asked_ranges::TOLERANCE;
use crate::report::tolerance::{SHARES, ToleranceReport};
use std::sync::atomic::AtomicBool;

/// Options of a tolerance analysis: distribution and number of random pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct ToleranceOptions {
    /// Half the width of the tolerance, in the dimension's unit, for every dimension without one in the study.
    pub tolerance: Option<f64>,
    /// Number of random pieces.
    pub pieces: usize,
    /// Distribution of a dimension within its tolerance.
    pub distribution: Distribution,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for ToleranceOptions {
    fn default() -> Self {
        Self {
            tolerance: None,
            pieces: 10_000,
            distribution: Distribution::Uniform,
            seed: 1,
        }
    }
}

/// The scatter of a measure, in the scene's units.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeasureScatter {
    /// The name of the measure.
    pub name: String,
    /// Value for the nominal dimensions.
    pub nominal: f64,
    /// Root sum square of derivative times tolerance.
    pub root_sum_square: f64,
    /// Sum of the magnitudes of derivative times tolerance; pieces can exceed this linear estimate.
    pub linear_sum: f64,
    /// Mean over the random pieces that can be assembled; NaN if there are none.
    pub mean: f64,
    /// Standard deviation over them.
    pub deviation: f64,
    /// Smallest and largest value found among random pieces and corners of the tolerance box.
    pub found: [f64; 2],
    /// Proved band for all pieces within their tolerances; `None` if it is not proved.
    pub band: Option<[f64; 2]>,
}

/// Result of a tolerance analysis. Returned by [`Study::tolerance`](crate::Study::tolerance).
pub struct Tolerance {
    measures: Vec<MeasureScatter>,
    good: f64,
    text: String,
    json: String,
}

impl Tolerance {
    pub(super) fn of(
        loaded: &LoadedStudy,
        options: &ToleranceOptions,
        cancel: &AtomicBool,
    ) -> Result<Self, Error> {
        if let Some(tolerance) = options.tolerance {
            Error::unless_in(&TOLERANCE, "tolerance", tolerance)?;
        }
        let batch = SampleBatch {
            samples: options.pieces.max(1),
            first: 0,
            seed: options.seed,
            distribution: options.distribution,
            threads: core_count(),
        };
        let begun = Stopwatch::start();
        let study = ToleranceStudy::new(loaded, options.tolerance, batch)?.with_extremes(cancel);
        let pieces = study.pieces(cancel, &|_| {}).summary(&SHARES);
        let report = ToleranceReport {
            study: &study,
            pieces: &pieces,
            first: 0,
            seconds: Some(begun.seconds()),
        };
        let list = loaded.family.measures.list.iter().enumerate();
        Ok(Self {
            measures: list.map(|(k, _)| scatter(&report, k)).collect(),
            good: pieces.good as f64 / pieces.made as f64,
            text: report.text(),
            json: format!("{:#}\n", report.document()),
        })
    }

    /// All measures with their scatter.
    ///
    /// ```
    /// # use mechanim::{Scene, study::ToleranceOptions};
    /// let study = Scene::builtin("gearshift")?.study().vary(&["L4"]);
    /// let options = ToleranceOptions { tolerance: Some(0.01), pieces: 64, ..Default::default() };
    /// for measure in study.tolerance(&options)?.measures() {
    ///     let [low, high] = measure.band.expect("proved for one small tolerance");
    ///     assert!(low <= measure.found[0] && measure.found[1] <= high);
    /// }
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn measures(&self) -> &[MeasureScatter] {
        &self.measures
    }

    /// The share of random pieces that can be assembled and keep the limits of all measures, from 0 to 1.
    ///
    /// ```
    /// # use mechanim::{Scene, study::ToleranceOptions};
    /// let study = Scene::builtin("gearshift")?.study().vary(&["L4"]);
    /// let options = ToleranceOptions { tolerance: Some(0.01), pieces: 64, ..Default::default() };
    /// assert!((0.0..=1.0).contains(&study.tolerance(&options)?.yield_share()));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn yield_share(&self) -> f64 {
        self.good
    }

    /// The table that `mechanim tolerance` prints.
    ///
    /// ```
    /// # use mechanim::{Scene, study::ToleranceOptions};
    /// let study = Scene::builtin("gearshift")?.study().vary(&["L4"]);
    /// let options = ToleranceOptions { tolerance: Some(0.01), pieces: 64, ..Default::default() };
    /// assert!(study.tolerance(&options)?.text().contains("64 pieces"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The same as a JSON document.
    ///
    /// ```
    /// # use mechanim::{Scene, study::ToleranceOptions};
    /// let study = Scene::builtin("gearshift")?.study().vary(&["L4"]);
    /// let options = ToleranceOptions { tolerance: Some(0.01), pieces: 64, ..Default::default() };
    /// assert!(study.tolerance(&options)?.to_json().contains("mechanim-tolerance/1"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn to_json(&self) -> &str {
        &self.json
    }
}

fn scatter(report: &ToleranceReport, index: usize) -> MeasureScatter {
    let (study, pieces) = (report.study, report.pieces);
    let family = &study.study.family;
    let measure = &family.measures.list[index];
    let shown = |value: f64| family.shown(measure, value);
    let linear = &study.linear[index];
    let found = pieces.measures.get(index).and_then(Option::as_ref);
    let [mean, deviation] = found.map_or([f64::NAN; 2], |s| [s.mean, s.deviation]);
    MeasureScatter {
        name: measure.name.clone(),
        nominal: shown(study.nominal.gradients.measures[index]),
        root_sum_square: shown(linear.root_sum_square),
        linear_sum: shown(linear.linear_sum),
        mean: shown(mean),
        deviation: shown(deviation),
        found: study.found(index, found.map(|s| s.found)).map(shown),
        band: report.proved_ends(index, measure.kind),
    }
}
