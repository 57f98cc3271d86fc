//! Statistics of any number of random pieces in little memory: counts, exact sums, quantiles from a histogram, the
//! least and the greatest values. Merging two of them gives, bit by bit, the statistics of all their pieces, however
//! they were divided.

use super::tolerance::{MeasureScatter, PieceSummary, Pieces};
use crate::numbers::exact_sum::ExactSum;

/// Bins of a measure.
const BINS: usize = 4096;

/// Number of the least and of the greatest values that are stored.
const KEPT: usize = 64;

/// The histogram of a measure: bins of equal width from `low` on, fixed before anything is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistogramBins {
    /// The value from which deviations are counted.
    pub nominal: f64,
    low: f64,
    width: f64,
}

impl HistogramBins {
    /// Bins for values that deviate from `nominal` by up to twice the `worst` linear case; where that tells nothing, by as much
    /// as the value itself, or as `size`, which is neither large nor small.
    pub fn new(nominal: f64, worst: f64, size: f64) -> Self {
        let worst = match worst > 0.0 && worst.is_finite() {
            true => worst,
            false => nominal.abs().max(size),
        };
        Self {
            nominal,
            low: nominal - 2.0 * worst,
            width: 4.0 * worst / BINS as f64,
        }
    }

    /// The bin of a value: 0 below all bins, the last one above.
    fn place(&self, value: f64) -> usize {
        let steps = (value - self.low) / self.width;
        if steps < 0.0 {
            0
        } else if steps < BINS as f64 {
            1 + steps as usize
        } else {
            BINS + 1
        }
    }

    /// The ends of a bin.
    fn ends(&self, place: usize) -> [f64; 2] {
        let edge = |k: usize| self.low + self.width * k as f64;
        match place {
            0 => [f64::NEG_INFINITY, self.low],
            k if k <= BINS => [edge(k - 1), edge(k)],
            _ => [edge(BINS), f64::INFINITY],
        }
    }
}

/// The statistics of one measure.
#[derive(Clone, Debug, PartialEq)]
struct MeasureSums {
    deviations: ExactSum,
    squares: ExactSum,
    counts: Vec<u64>,
    /// Ascending.
    least: Vec<f64>,
    /// Descending.
    greatest: Vec<f64>,
}

/// The statistics of some pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct PieceSums {
    bins: Vec<HistogramBins>,
    /// Pieces made.
    pub made: u64,
    /// Pieces that cannot be assembled, or have a measure without a value.
    pub failed: u64,
    /// Pieces that satisfy all requirements.
    pub good: u64,
    /// A digest of all values.
    pub digest: u64,
    measures: Vec<MeasureSums>,
}

impl MeasureSums {
    const WIDTH: usize = 2 * ExactSum::WIDTH + BINS + 2 + 2 * KEPT;

    fn new() -> Self {
        Self {
            deviations: ExactSum::default(),
            squares: ExactSum::default(),
            counts: vec![0; BINS + 2],
            least: Vec::new(),
            greatest: Vec::new(),
        }
    }

    fn add(&mut self, bins: &HistogramBins, value: f64) {
        let deviation = value - bins.nominal;
        self.deviations.add(deviation);
        self.squares.add(deviation * deviation);
        self.counts[bins.place(value)] += 1;
        keep(&mut self.least, value, |a, b| a < b);
        keep(&mut self.greatest, value, |a, b| a > b);
    }

    fn join(&mut self, other: Self) {
        self.deviations.join(other.deviations);
        self.squares.join(other.squares);
        let counts = self.counts.iter_mut().zip(other.counts);
        counts.for_each(|(own, count)| *own += count);
        let each = other.least.into_iter();
        each.for_each(|value| keep(&mut self.least, value, |a, b| a < b));
        let each = other.greatest.into_iter();
        each.for_each(|value| keep(&mut self.greatest, value, |a, b| a > b));
    }

    fn record(&self, numbers: &mut Vec<f64>) {
        numbers.extend(self.deviations.record());
        numbers.extend(self.squares.record());
        numbers.extend(self.counts.iter().map(|count| *count as f64));
        for list in [&self.least, &self.greatest] {
            numbers.extend(list);
            numbers.resize(numbers.len() + KEPT - list.len(), f64::NAN);
        }
    }

    fn of_record(record: &[f64]) -> Option<Self> {
        let (deviations, rest) = record.split_at_checked(ExactSum::WIDTH)?;
        let (squares, rest) = rest.split_at_checked(ExactSum::WIDTH)?;
        let (counts, rest) = rest.split_at_checked(BINS + 2)?;
        let (least, greatest) = rest.split_at_checked(KEPT)?;
        let known = |list: &[f64]| list.iter().copied().filter(|v| !v.is_nan()).collect();
        Some(Self {
            deviations: ExactSum::of_record(deviations)?,
            squares: ExactSum::of_record(squares)?,
            counts: counts.iter().map(|count| *count as u64).collect(),
            least: known(least),
            greatest: known(greatest),
        })
    }

    /// The values between which the one of this rank, from 0 of `all`, lies.
    fn at_rank(&self, bins: &HistogramBins, rank: u64, all: u64) -> [f64; 2] {
        let from_above = all - 1 - rank;
        let known = match (
            self.least.get(rank as usize),
            self.greatest.get(from_above as usize),
        ) {
            (Some(value), _) | (None, Some(value)) => Some(*value),
            _ => None,
        };
        if let Some(value) = known {
            return [value; 2];
        }
        let mut before = 0;
        for (place, count) in self.counts.iter().enumerate() {
            before += count;
            if rank < before {
                return bins.ends(place);
            }
        }
        [f64::NEG_INFINITY, f64::INFINITY]
    }
}

/// Inserts a value into a sorted list of the first values.
fn keep(list: &mut Vec<f64>, value: f64, comes_before: impl Fn(f64, f64) -> bool) {
    let is_out = |last: &f64| list.len() == KEPT && !comes_before(value, *last);
    if list.last().is_some_and(is_out) {
        return;
    }
    let place = list.partition_point(|other| !comes_before(value, *other));
    list.insert(place, value);
    list.truncate(KEPT);
}

/// Numbers before those of the measures: counts, and the two halves of the digest.
const HEAD: usize = 5;

impl PieceSums {
    /// Empty statistics of measures with these histograms.
    pub fn new(bins: &[HistogramBins]) -> Self {
        Self {
            bins: bins.to_vec(),
            made: 0,
            failed: 0,
            good: 0,
            digest: 0,
            measures: vec![MeasureSums::new(); bins.len()],
        }
    }

    /// Length of the statistics of this many measures as numbers.
    pub const fn width(measures: usize) -> usize {
        HEAD + measures * MeasureSums::WIDTH
    }

    /// Adds pieces.
    pub fn add(&mut self, pieces: &Pieces) {
        self.made += pieces.made as u64;
        self.failed += pieces.failed as u64;
        self.good += pieces.good as u64;
        self.digest = self.digest.wrapping_add(pieces.digest);
        for piece in pieces.values.chunks_exact(self.bins.len().max(1)) {
            // A failed piece is counted, but contributes to no measure.
            if piece.iter().any(|v| v.is_nan()) {
                continue;
            }
            let measures = self.measures.iter_mut().zip(&self.bins);
            for ((sums, bins), value) in measures.zip(piece) {
                sums.add(bins, *value);
            }
        }
    }

    /// Adds the sums of other pieces.
    pub fn join(&mut self, other: Self) {
        self.made += other.made;
        self.failed += other.failed;
        self.good += other.good;
        self.digest = self.digest.wrapping_add(other.digest);
        let pairs = self.measures.iter_mut().zip(other.measures);
        pairs.for_each(|(own, sums)| own.join(sums));
    }

    /// As numbers, as stored in a part.
    pub fn record(&self) -> Vec<f64> {
        let counts = [self.made, self.failed, self.good];
        let halves = [self.digest >> 32, self.digest & u64::from(u32::MAX)];
        let head = counts.into_iter().chain(halves);
        let mut numbers: Vec<f64> = head.map(|n| n as f64).collect();
        for sums in &self.measures {
            sums.record(&mut numbers);
        }
        numbers
    }

    /// The statistics from such numbers; `None` if they are invalid.
    pub fn of_record(bins: &[HistogramBins], record: &[f64]) -> Option<Self> {
        let (head, rest) = record.split_first_chunk::<HEAD>()?;
        let [made, failed, good, high, low] = head.map(|n| n as u64);
        let measures = rest.chunks_exact(MeasureSums::WIDTH);
        let measures: Vec<MeasureSums> = measures
            .map(MeasureSums::of_record)
            .collect::<Option<_>>()?;
        (record.len() == Self::width(bins.len())).then(|| Self {
            bins: bins.to_vec(),
            made,
            failed,
            good,
            digest: high << 32 | low,
            measures,
        })
    }

    /// The results, with quantiles at `shares` (0 to 1).
    pub fn summary(&self, shares: &[f64]) -> PieceSummary {
        let measures = (0..self.measures.len()).map(|index| self.scatter(index, shares));
        PieceSummary {
            made: self.made,
            failed: self.failed,
            good: self.good,
            digest: self.digest,
            measures: measures.collect(),
        }
    }

    /// The scatter of measure `index`, with quantiles at `shares` (0 to 1); `None` if no piece can be assembled.
    fn scatter(&self, index: usize, shares: &[f64]) -> Option<MeasureScatter> {
        let count = self.made - self.failed;
        let last = count.checked_sub(1)?;
        let (sums, bins) = (&self.measures[index], &self.bins[index]);
        let (shift, squares) = (sums.deviations.value(), sums.squares.value());
        let all = count as f64;
        // Sum of squared deviations from the mean, from sums about the nominal value.
        let square = (squares - shift * (shift / all)).max(0.0);
        let quantile = |share: &f64| {
            // A quantile lies between two ranks, each known exactly or up to a bin.
            let place = share * last as f64;
            let (rank, part) = (place.floor(), place.fract());
            let low = sums.at_rank(bins, rank as u64, count);
            let high = sums.at_rank(bins, (rank as u64 + 1).min(last), count);
            [0, 1].map(|end| match part == 0.0 {
                true => low[end],
                false => low[end] + part * (high[end] - low[end]),
            })
        };
        Some(MeasureScatter {
            mean: bins.nominal + shift / all,
            deviation: (square / last.max(1) as f64).sqrt(),
            quantiles: shares.iter().map(quantile).collect(),
            found: [*sums.least.first()?, *sums.greatest.first()?],
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::analysis::random::Random;

    fn pieces(count: u64) -> Pieces {
        let mut values = Vec::new();
        let mut failed = 0;
        for item in 0..count {
            let mut random = Random::new(3, 0, item);
            let is_failed = item % 97 == 5;
            failed += usize::from(is_failed);
            for measure in 0..2 {
                let value = 100.0 + 0.1 * random.normal() + f64::from(measure);
                values.push(if is_failed { f64::NAN } else { value });
            }
        }
        Pieces {
            made: count as usize,
            measures: 2,
            failed,
            good: 1,
            digest: u64::MAX - 5,
            values,
        }
    }

    fn cut(all: &Pieces, parts: usize) -> Vec<Pieces> {
        let size = all.made.div_ceil(parts) * 2;
        let chunks = all.values.chunks(size).enumerate();
        let part = |(k, values): (usize, &[f64])| Pieces {
            made: values.len() / 2,
            failed: values.iter().filter(|v| v.is_nan()).count() / 2,
            good: usize::from(k == 0),
            digest: if k == 0 { all.digest } else { 0 },
            measures: 2,
            values: values.to_vec(),
        };
        chunks.map(part).collect()
    }

    fn bins() -> [HistogramBins; 2] {
        [
            HistogramBins::new(100.0, 0.3, 1.0),
            HistogramBins::new(101.0, 0.3, 1.0),
        ]
    }

    /// Bins are measured in what is neither large nor small, so that the unit of length does not matter.
    #[test]
    fn bins_without_a_linear_rule_have_the_size_of_the_mechanism() {
        for size in [1e-9, 1.0, 1e6] {
            for worst in [0.0, f64::NAN, f64::INFINITY] {
                let bins = HistogramBins::new(0.0, worst, size);
                assert_eq!(bins.low, -2.0 * size);
                assert_eq!(bins.width, 4.0 * size / BINS as f64);
            }
        }
    }

    #[test]
    fn joined_sums_are_those_of_all_pieces_whatever_the_cut() {
        let all = pieces(5000);
        let mut whole = PieceSums::new(&bins());
        whole.add(&all);
        for parts in [1, 2, 7, 64] {
            let mut joined = PieceSums::new(&bins());
            for part in cut(&all, parts).iter().rev() {
                let mut sums = PieceSums::new(&bins());
                sums.add(part);
                let record = sums.record();
                assert_eq!(record.len(), PieceSums::width(2));
                joined.join(PieceSums::of_record(&bins(), &record).unwrap());
            }
            let bits = |sums: &PieceSums| {
                sums.record()
                    .iter()
                    .map(|v| v.to_bits())
                    .collect::<Vec<_>>()
            };
            assert_eq!(bits(&joined), bits(&whole), "{parts}");
        }
        assert!(PieceSums::of_record(&bins(), &whole.record()[1..]).is_none());
    }

    #[test]
    fn moments_and_quantiles_are_those_of_the_values() {
        let all = pieces(5000);
        let mut sums = PieceSums::new(&bins());
        sums.add(&all);
        let shares = [0.0, 0.001, 0.05, 0.5, 0.95, 0.999, 1.0];
        for measure in 0..2 {
            let (found, right) = (
                sums.scatter(measure, &shares).unwrap(),
                all.scatter(measure, &shares).unwrap(),
            );
            assert!((found.mean - right.mean).abs() < 1e-12);
            assert!((found.deviation / right.deviation - 1.0).abs() < 1e-9);
            for (share, ([low, high], [value, _])) in shares
                .iter()
                .zip(found.quantiles.iter().zip(&right.quantiles))
            {
                assert!(
                    low <= value && value <= high,
                    "{share}: {low} {value} {high}"
                );
                // A bin is 0.0003 wide; the 64 last ones on either side are known.
                let is_end = *share <= 0.001 || *share >= 0.999;
                assert!(high - low < if is_end { 1e-13 } else { 7e-4 }, "{share}");
            }
            assert_eq!(found.found, right.found);
        }
    }
}
