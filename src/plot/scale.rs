//! The map from values to pixels along one axis, linear or logarithmic.

/// Kind of a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ScaleKind {
    /// Equal steps for equal differences.
    #[default]
    Linear,
    /// Equal steps for equal ratios; values of zero and below are not shown.
    Log,
}

/// Margin around the values as a share of their range.
const MARGIN: f64 = 0.05;

/// The same in decades.
const LOG_MARGIN: f64 = 0.08;

/// Values that differ by less than this fraction of their size differ by rounding only; their noise is not magnified to
/// the whole height.
const SAME: f64 = 1e-10;

/// Maps values between `low` and `high` to pixels between `start` and `end` (which may be the smaller one).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Kind.
    pub kind: ScaleKind,
    /// Value at `start`.
    pub low: f64,
    /// Value at `end`.
    pub high: f64,
    /// Pixel of `low`.
    pub start: f64,
    /// Pixel of `high`.
    pub end: f64,
}

impl Scale {
    /// The pixel of `value`; `None` if it has none.
    pub fn pixel(&self, value: f64) -> Option<f64> {
        let share = (self.axis_coordinate(value)? - self.axis_coordinate(self.low)?)
            / (self.axis_coordinate(self.high)? - self.axis_coordinate(self.low)?);
        let pixel = self.start + share * (self.end - self.start);
        pixel.is_finite().then_some(pixel)
    }

    /// The value at a pixel.
    pub fn value(&self, pixel: f64) -> f64 {
        let share = (pixel - self.start) / (self.end - self.start);
        match self.kind {
            ScaleKind::Linear => self.low + share * (self.high - self.low),
            ScaleKind::Log => self.low * libm::pow(self.high / self.low, share),
        }
    }

    fn axis_coordinate(&self, value: f64) -> Option<f64> {
        match self.kind {
            ScaleKind::Linear => value.is_finite().then_some(value),
            ScaleKind::Log => (value > 0.0 && value.is_finite()).then(|| libm::log10(value)),
        }
    }

    /// Whether a value lies on the axis, ends included.
    pub fn holds(&self, value: f64) -> bool {
        value >= self.low && value <= self.high
    }
}

/// Ends of an axis for the given values: finite, the first below the second, positive for a logarithmic one.
pub fn value_limits(kind: ScaleKind, values: impl Iterator<Item = f64>, tight: bool) -> [f64; 2] {
    let usable = values.filter(|v| v.is_finite() && (kind == ScaleKind::Linear || *v > 0.0));
    let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    if low > high {
        return match kind {
            ScaleKind::Linear => [0.0, 1.0],
            ScaleKind::Log => [0.1, 1.0],
        };
    }
    match kind {
        ScaleKind::Log => {
            // Whole decades, because readers orient themselves by their lines. Points do not lie on the frame.
            let margin = if tight { 0.0 } else { LOG_MARGIN };
            let first = libm::floor(libm::log10(low) - margin + SAME);
            let last = libm::ceil(libm::log10(high) + margin - SAME).max(first + 1.0);
            [libm::pow(10.0, first), libm::pow(10.0, last)]
        }
        ScaleKind::Linear => {
            let range = high - low;
            let size = low.abs().max(high.abs());
            if range <= SAME * size || range == 0.0 {
                let half = if size > 0.0 { 0.1 * size } else { 1.0 };
                let middle = 0.5 * (low + high);
                return [middle - half, middle + half];
            }
            let margin = if tight { 0.0 } else { MARGIN * range };
            [low - margin, high + margin]
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn pixels_lead_back_to_the_value(
            low in -1e6f64..1e6, range in 1e-3f64..1e6, share in 0.0f64..1.0, log in any::<bool>()
        ) {
            let kind = if log { ScaleKind::Log } else { ScaleKind::Linear };
            let low = if log { low.abs() + 1e-3 } else { low };
            let scale = Scale { kind, low, high: low + range, start: 420.0, end: 13.0 };
            let value = low + share * range;
            let pixel = scale.pixel(value).unwrap();
            prop_assert!((13.0 - 1e-6..=420.0 + 1e-6).contains(&pixel));
            prop_assert!((scale.value(pixel) - value).abs() <= 1e-9 * (low.abs() + range));
        }

        #[test]
        fn limits_hold_all_values(values in proptest::collection::vec(-1e9f64..1e9, 1..20), tight in any::<bool>()) {
            let [low, high] = value_limits(ScaleKind::Linear, values.iter().copied(), tight);
            prop_assert!(low < high && values.iter().all(|v| (low..=high).contains(v)));
            let positive = values.iter().map(|v| v.abs() + 1e-12);
            let [low, high] = value_limits(ScaleKind::Log, positive.clone(), tight);
            prop_assert!(0.0 < low && low < high);
            prop_assert!(positive.into_iter().all(|v| (low * 0.999..=high * 1.001).contains(&v)));
        }
    }

    #[test]
    fn values_without_a_place_have_none() {
        let scale = |kind| Scale {
            kind,
            low: 1.0,
            high: 10.0,
            start: 0.0,
            end: 100.0,
        };
        assert_eq!(scale(ScaleKind::Linear).pixel(f64::NAN), None);
        assert_eq!(scale(ScaleKind::Linear).pixel(f64::INFINITY), None);
        assert_eq!(scale(ScaleKind::Log).pixel(0.0), None);
        assert_eq!(scale(ScaleKind::Log).pixel(-1.0), None);
        assert_eq!(scale(ScaleKind::Log).pixel(10.0), Some(100.0));
    }

    #[test]
    fn rounding_noise_is_a_flat_line() {
        let noise = [880.0, 880.0 + 1e-12, 880.0 - 2e-12];
        let [low, high] = value_limits(ScaleKind::Linear, noise.into_iter(), false);
        assert!(high - low > 100.0);
        assert_eq!(
            value_limits(ScaleKind::Linear, [0.0].into_iter(), false),
            [-1.0, 1.0]
        );
        assert_eq!(
            value_limits(ScaleKind::Linear, [f64::NAN].into_iter(), false),
            [0.0, 1.0]
        );
    }
}
