//! Scalars of a whole motion: tracks of poses beside the drive, and what is measured over them.

use super::expression::Expression;
use super::mechanism::Kind;

/// Poses beside the drive: the inputs go from one set of values to another in equal steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Name in the scene.
    pub name: String,
    /// Number of poses, at least two.
    pub samples: usize,
    /// Inputs at the first pose.
    pub from: Vec<f64>,
    /// Inputs at the last pose.
    pub to: Vec<f64>,
}

/// How one number is made of a row of values.
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
    /// The arithmetic mean.
    Mean,
    /// Distance from the first to the last point of a path in the plane.
    Chord,
    /// Signed distance from the chord of that point of a path which is farthest from it, positive to the left of the way.
    Bow,
}

impl Taking {
    /// Names in scene files.
    pub const NAMES: [(&'static str, Self); 10] = [
        ("first", Self::First),
        ("last", Self::Last),
        ("change", Self::Change),
        ("min", Self::Min),
        ("max", Self::Max),
        ("range", Self::Range),
        ("largest", Self::Largest),
        ("mean", Self::Mean),
        ("chord", Self::Chord),
        ("bow", Self::Bow),
    ];

    /// How many values a pose gives: a path has two coordinates.
    pub const fn width(self) -> usize {
        match self {
            Self::Chord | Self::Bow => 2,
            _ => 1,
        }
    }
}

/// Where a measure comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum MeasureSource {
    /// A formula whose slots are the earlier measures.
    Formula(Expression),
    /// Values over the poses of a track, or of the drive.
    Over {
        /// Index of the track; the drive if there is none.
        track: Option<usize>,
        /// As many as `taking` is wide. Slots: coordinates, then x, y, z of every trace, then outputs.
        of: Vec<Expression>,
        /// What is made of them.
        taking: Taking,
    },
}

/// A scalar of a whole motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Name in the scene.
    pub name: String,
    /// What it measures.
    pub kind: Kind,
    /// Where it comes from.
    pub source: MeasureSource,
    /// Smallest allowed value.
    pub min: Option<f64>,
    /// Largest allowed value.
    pub max: Option<f64>,
    /// What a broken limit means, in the words of the scene.
    pub why: Option<String>,
}

impl Measure {
    /// Whether `value` keeps the limits.
    pub fn allows(&self, value: f64) -> bool {
        self.min.is_none_or(|min| value >= min) && self.max.is_none_or(|max| value <= max)
    }
}
