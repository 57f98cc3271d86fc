//! The effect of tolerances on the measures of a study: linear sums, and random pieces whose values do not depend on
//! how the work is divided.

use super::random::Random;
use super::study::{
    AT_A_TIME, Evaluator, Gradients, LaneEvaluator, ParametricMechanism, PoseAnchors, TrackPoses,
};
use crate::jobs::share_watched;
use std::sync::atomic::{AtomicBool, Ordering};

/// The distribution of a dimension within its tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// All values are equally likely.
    Uniform,
    /// Normal; the tolerance is three standard deviations.
    Normal,
}

/// Number of standard deviations in a tolerance with a normal distribution.
const DEVIATIONS: f64 = 3.0;

impl Distribution {
    /// Standard deviation of a dimension of this tolerance.
    pub(crate) fn deviation(self, tolerance: f64) -> f64 {
        match self {
            Self::Uniform => tolerance / 3.0_f64.sqrt(),
            Self::Normal => tolerance / DEVIATIONS,
        }
    }

    fn draw(self, random: &mut Random, tolerance: f64) -> f64 {
        match self {
            Self::Uniform => tolerance * random.symmetric(),
            Self::Normal => tolerance / DEVIATIONS * random.normal(),
        }
    }
}

/// A measure's scatter by the linear rules.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// Root of the sum of squares of slope times tolerance.
    pub root_sum_square: f64,
    /// Sum of their magnitudes: all dimensions at their worst at once, to first order. Pieces can exceed it.
    pub linear_sum: f64,
    /// Standard deviation for the given [`Distribution`].
    pub deviation: f64,
}

/// The linear scatter of every measure.
pub fn linear_tolerance(
    gradients: &Gradients,
    tolerances: &[f64],
    distribution: Distribution,
) -> Vec<Linear> {
    let square = |sum: f64, v: f64| sum + v * v;
    gradients
        .rows
        .iter()
        .map(|row| {
            let parts = || row.iter().zip(tolerances);
            Linear {
                root_sum_square: parts().map(|(d, t)| d * t).fold(0.0, square).sqrt(),
                linear_sum: parts().map(|(d, t)| (d * t).abs()).sum(),
                deviation: parts()
                    .map(|(d, t)| d * distribution.deviation(*t))
                    .fold(0.0, square)
                    .sqrt(),
            }
        })
        .collect()
}

/// The random pieces of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Pieces {
    /// Measures of piece n at `n · measures`; NaN for a piece that does not assemble.
    pub values: Vec<f64>,
    /// Measures of one piece.
    pub measures: usize,
    /// Number of pieces made: all, or fewer after a cancellation.
    pub made: usize,
    /// Pieces that cannot be assembled, or have a measure without a value.
    pub failed: usize,
    /// Pieces that keep all requirements.
    pub good: usize,
    /// A digest of all values, the same for any division of the work.
    pub digest: u64,
}

/// How many pieces, and how they scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleBatch {
    /// Number of pieces.
    pub samples: usize,
    /// Number of the first piece: several runs can share the work.
    pub first: usize,
    /// Where random numbers start.
    pub seed: u64,
    /// Within the tolerances.
    pub distribution: Distribution,
    /// Worker threads, at least one.
    pub threads: usize,
}

/// Number of pieces per unit of work.
const PORTION: usize = 64;

/// Makes and measures random pieces around `nominal`; ends early when `cancel` is raised.
///
/// `watch` is called now and then on this thread with the number of pieces made.
pub fn sample_pieces(
    family: &ParametricMechanism,
    nominal: &TrackPoses,
    tolerances: &[f64],
    batch: SampleBatch,
    cancel: &AtomicBool,
    watch: &dyn Fn(usize),
) -> Pieces {
    let measures = family.measures.list.len();
    let anchors = PoseAnchors::new(&Evaluator::new(family), nominal);
    let portion = |evaluator: &mut LaneEvaluator, index: usize| {
        if cancel.load(Ordering::Relaxed) {
            return None;
        }
        let start = PORTION * index;
        let end = batch.samples.min(start + PORTION);
        let mut values = Vec::with_capacity(PORTION * measures);
        for first in (start..end).step_by(AT_A_TIME) {
            let items = first..end.min(first + AT_A_TIME);
            let drawn = items.map(|item| values_of(nominal, tolerances, batch, item));
            for piece in evaluator.measure(&drawn.collect::<Vec<_>>()) {
                match piece {
                    Ok(found) => values.extend(found.measures),
                    Err(_) => values.resize(values.len() + measures, f64::NAN),
                }
            }
        }
        Some(values)
    };
    let portions = share_watched(
        batch.samples.div_ceil(PORTION),
        batch.threads,
        || LaneEvaluator::new(Evaluator::new(family), &anchors),
        portion,
        &|portions| watch((PORTION * portions).min(batch.samples)),
    );
    let mut values = Vec::with_capacity(batch.samples * measures);
    for (index, portion) in portions {
        // Work that was cut short may lack a portion; pieces after it are not counted.
        if PORTION * index * measures != values.len() {
            break;
        }
        values.extend(portion);
    }
    summarise_pieces(family, values, measures, batch.first)
}

/// Values of the variables of piece `item` of a batch.
pub fn values_of(
    nominal: &TrackPoses,
    tolerances: &[f64],
    batch: SampleBatch,
    item: usize,
) -> Vec<f64> {
    let mut random = Random::new(batch.seed, 0, (batch.first + item) as u64);
    let drawn = nominal.values.iter().zip(tolerances);
    drawn
        .map(|(v, t)| v + batch.distribution.draw(&mut random, *t))
        .collect()
}

fn summarise_pieces(
    family: &ParametricMechanism,
    values: Vec<f64>,
    measures: usize,
    first: usize,
) -> Pieces {
    let list = &family.measures.list;
    let (mut failed, mut good, mut digest) = (0, 0, 0u64);
    for (item, piece) in values.chunks_exact(measures.max(1)).enumerate() {
        if piece.iter().any(|v| v.is_nan()) {
            failed += 1;
        } else {
            let pairs = list.iter().zip(piece);
            good += usize::from(pairs.into_iter().all(|(m, v)| m.allows(*v)));
        }
        // A sum with one term per piece does not depend on the order or on the division of the work.
        let mut hash = (first + item) as u64 ^ 0xcbf2_9ce4_8422_2325;
        for value in piece {
            hash = (hash ^ value.to_bits()).wrapping_mul(0x0000_0100_0000_01b3);
            hash ^= hash >> 32;
        }
        digest = digest.wrapping_add(hash);
    }
    Pieces {
        made: values.len() / measures.max(1),
        values,
        measures,
        failed,
        good,
        digest,
    }
}

/// The value below which `share` (0 to 1) of ascending `values` lies, interpolated; NaN if there are none.
pub fn sorted_quantile(values: &[f64], share: f64) -> f64 {
    let place = share * values.len().saturating_sub(1) as f64;
    let (low, part) = (place.floor() as usize, place.fract());
    let high = (low + 1).min(values.len().saturating_sub(1));
    match (values.get(low), values.get(high)) {
        (Some(low), Some(high)) => low + part * (high - low),
        _ => f64::NAN,
    }
}

/// The statistics of one measure.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureScatter {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
    /// The two numbers between which the value at each share lies; equal if every value is known.
    pub quantiles: Vec<[f64; 2]>,
    /// Least and greatest value.
    pub found: [f64; 2],
}

/// What pieces tell.
#[derive(Clone, Debug, PartialEq)]
pub struct PieceSummary {
    /// Pieces made.
    pub made: u64,
    /// Pieces that cannot be assembled, or have a measure without a value.
    pub failed: u64,
    /// Pieces that keep all requirements.
    pub good: u64,
    /// A number made of all values.
    pub digest: u64,
    /// Every measure over the pieces that assemble; `None` if there are none.
    pub measures: Vec<Option<MeasureScatter>>,
}

impl Pieces {
    /// The statistics, with quantiles at `shares` (0 to 1).
    pub fn summary(&self, shares: &[f64]) -> PieceSummary {
        let measures = (0..self.measures).map(|index| self.scatter(index, shares));
        PieceSummary {
            made: self.made as u64,
            failed: self.failed as u64,
            good: self.good as u64,
            digest: self.digest,
            measures: measures.collect(),
        }
    }

    /// The scatter of measure `index`, with quantiles at `shares` (0 to 1).
    pub fn scatter(&self, index: usize, shares: &[f64]) -> Option<MeasureScatter> {
        let column = self.values.iter().skip(index).step_by(self.measures.max(1));
        let mut values: Vec<f64> = column.copied().filter(|v| !v.is_nan()).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let square: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        values.sort_unstable_by(f64::total_cmp);
        let at = |share: &f64| [sorted_quantile(&values, *share); 2];
        Some(MeasureScatter {
            mean,
            deviation: (square / (count - 1.0).max(1.0)).sqrt(),
            quantiles: shares.iter().map(at).collect(),
            found: [*values.first()?, *values.last()?],
        })
    }
}
