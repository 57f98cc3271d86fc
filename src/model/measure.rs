//! Scalars of a whole motion: tracks of poses apart from the drive, and what is measured over them.

use super::dimension::PhysicalDimension;
use super::expression::Expression;
use super::mechanism::Kind;
use super::rate::RateOrder;

/// Poses apart from the drive: the inputs move from one set of values to another in equal steps.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredTrack {
    /// Name in the scene.
    pub name: String,
    /// Number of poses, at least two.
    pub samples: usize,
    /// Inputs at the first pose.
    pub from: Vec<f64>,
    /// Inputs at the last pose.
    pub to: Vec<f64>,
}

impl MeasuredTrack {
    /// An input at pose `pose`, counted from zero.
    pub fn input_at(&self, input: usize, pose: usize) -> f64 {
        let (from, to) = (self.from[input], self.to[input]);
        from + (to - from) * pose as f64 / (self.samples - 1) as f64
    }
}

/// Everything that is measured of a motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measures {
    /// Poses beside the drive.
    pub tracks: Vec<MeasuredTrack>,
    /// Scalars of the whole motion, in the order of the scene.
    pub list: Vec<Measure>,
}

/// The reduction of a sequence of values to one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taking {
    /// The first.
    First,
    /// The last.
    Last,
    /// The last less the first.
    Change,
    /// The smallest.
    Min,
    /// The largest.
    Max,
    /// The largest less the smallest.
    Range,
    /// The largest of the absolute values.
    Largest,
    /// The sum.
    Sum,
    /// The arithmetic mean.
    Mean,
    /// The sum of the absolute values' powers, to the inverse of the power.
    Norm,
    /// The fraction of the way on which the values are positive, with linear interpolation between the poses.
    Positive,
    /// Distance from the first to the last point of a path in the plane.
    Chord,
    /// Signed distance from the chord of the farthest point of a path, positive to the left of its direction.
    Bow,
}

impl Taking {
    /// Names in scene files.
    pub const NAMES: [(&'static str, Self); 13] = [
        ("first", Self::First),
        ("last", Self::Last),
        ("change", Self::Change),
        ("min", Self::Min),
        ("max", Self::Max),
        ("range", Self::Range),
        ("largest", Self::Largest),
        ("sum", Self::Sum),
        ("mean", Self::Mean),
        ("norm", Self::Norm),
        ("positive", Self::Positive),
        ("chord", Self::Chord),
        ("bow", Self::Bow),
    ];

    /// Whether only the first and the last pose count.
    pub const fn is_of_ends(self) -> bool {
        matches!(self, Self::First | Self::Last | Self::Change | Self::Chord)
    }

    /// Whether it does not matter how often a value is taken.
    pub const fn is_extreme(self) -> bool {
        matches!(self, Self::Min | Self::Max | Self::Range | Self::Largest)
    }

    /// Whether the end counts even if it is where the motion began, whatever the values are.
    const fn reaches_end(self) -> bool {
        let is_of_way = matches!(self, Self::Positive | Self::Bow);
        is_of_way || matches!(self, Self::Last | Self::Change | Self::Chord)
    }

    /// The sides on which an extreme value may lie: the greatest (1), the least (-1); none for what is no extreme.
    pub const fn sides(self) -> &'static [f64] {
        match self {
            Self::Max => &[1.0],
            Self::Min => &[-1.0],
            Self::Range | Self::Largest => &[1.0, -1.0],
            _ => &[],
        }
    }

    /// How many values a pose gives: a path has two coordinates.
    pub const fn width(self) -> usize {
        match self {
            Self::Chord | Self::Bow => 2,
            _ => 1,
        }
    }
}

/// The definition of a measure.
#[derive(Clone, Debug, PartialEq)]
pub enum MeasureSource {
    /// A formula whose slots are the mechanism's inputs at the start of the drive (parameters that a study varies are
    /// inputs), then the earlier measures.
    Formula(Expression),
    /// Values over the poses of a track, or of the drive.
    Over {
        /// Index of the track; the drive if there is none.
        track: Option<usize>,
        /// As many as `taking` is wide. Slots: coordinates, then x, y, z of every trace, then outputs.
        of: Vec<Expression>,
        /// Formulas of slots whose rates are slots, too, behind all others.
        rates: Vec<(Expression, RateOrder)>,
        /// Input by which the values are derived; the values themselves if there is none.
        per: Option<usize>,
        /// What is made of them.
        taking: Taking,
        /// For [`Taking::Norm`].
        power: f64,
        /// Whether the values contain an angle, which may have turned where a cyclic motion ends as it began.
        winds: bool,
    },
}

impl Measures {
    /// Which of them depend on the number of poses: sums, means and norms, and formulas of them. The slots of formulas begin
    /// with so many inputs.
    pub fn depend_on_count(&self, inputs: usize) -> Vec<bool> {
        let mut list: Vec<bool> = Vec::with_capacity(self.list.len());
        for measure in &self.list {
            let depends = match &measure.source {
                MeasureSource::Over { taking, .. } => {
                    matches!(taking, Taking::Sum | Taking::Mean | Taking::Norm)
                }
                MeasureSource::Formula(formula) => {
                    let earlier = formula.slots().into_iter();
                    let earlier = earlier.filter_map(|slot| slot.checked_sub(inputs));
                    earlier.into_iter().any(|index| list[index])
                }
            };
            list.push(depends);
        }
        list
    }

    /// Whether some depend on the pose at the end of the drive.
    pub fn look_at_end(&self) -> bool {
        self.list.iter().any(|measure| {
            let source = &measure.source;
            matches!(source, MeasureSource::Over { track: None, .. }) && source.reaches_end()
        })
    }
}

impl MeasureSource {
    /// Whether the end of a drive counts even if it is where the motion began.
    pub fn reaches_end(&self) -> bool {
        match self {
            Self::Formula(_) => false,
            Self::Over { taking, winds, .. } => {
                taking.reaches_end() || (*winds && taking.is_extreme())
            }
        }
    }

    /// Whether it is an extreme value.
    pub fn is_extreme(&self) -> bool {
        matches!(self, Self::Over { taking, .. } if taking.is_extreme())
    }

    /// Whether it is made of the values at both ends, or at one of them.
    pub fn is_of_ends(&self) -> bool {
        matches!(self, Self::Over { taking, .. } if taking.is_of_ends())
    }

    /// Index of its track.
    pub fn track(&self) -> Option<usize> {
        match self {
            Self::Formula(_) => None,
            Self::Over { track, .. } => *track,
        }
    }
}

/// A scalar of a whole motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Name in the scene.
    pub name: String,
    /// What it measures.
    pub kind: Kind,
    /// The same in powers of the units.
    pub dimension: PhysicalDimension,
    /// Where it comes from.
    pub source: MeasureSource,
    /// Smallest allowed value.
    pub min: Option<f64>,
    /// Largest allowed value.
    pub max: Option<f64>,
    /// The meaning of a violated limit, in the words of the scene.
    pub why: Option<String>,
    /// What rounding is measured by beside the value: the mechanism's size for a length, a radian, nothing for a number.
    pub size: f64,
}

/// A limit holds to within this fraction of the mechanism's size, of a radian or of the value, like minimum distances: a stroke of
/// exactly 24 may be limited to 24.
const SLACK: f64 = 1e-9;

impl Measure {
    /// By how much `value` violates the limits, as a fraction of the limit; zero or less inside. NaN propagates.
    pub fn violation(&self, value: f64) -> f64 {
        let share = |over: f64, limit: f64| over / self.scale_of(limit);
        let above = self.max.map(|limit| share(value - limit, limit));
        let below = self.min.map(|limit| share(limit - value, limit));
        let parts = [above, below].into_iter().flatten();
        let worse = |worst: f64, v: f64| if v > worst || v.is_nan() { v } else { worst };
        parts.fold(f64::NEG_INFINITY, worse)
    }

    /// What a violation of a limit is a fraction of.
    pub fn scale_of(&self, limit: f64) -> f64 {
        match (limit, self.size) {
            (0.0, 0.0) => 1.0,
            (0.0, size) => size,
            (limit, _) => limit.abs(),
        }
    }

    /// How far `value` may exceed a limit that holds.
    pub fn slack(&self, value: f64) -> f64 {
        match value.is_finite() {
            true => SLACK * value.abs().max(self.size),
            false => 0.0,
        }
    }

    /// Whether `value` keeps the limits, to within the slack.
    pub fn allows(&self, value: f64) -> bool {
        let slack = self.slack(value);
        let above = self.min.is_none_or(|min| value >= min - slack);
        above && self.max.is_none_or(|max| value <= max + slack)
    }
}
