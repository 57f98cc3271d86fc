//! Tracks and measures as typed: poses apart from the drive, and scalars of a whole motion.

use super::reader::{NamedFormula, Spanned, TableReader, required_value};
use super::values::FormulaText;

/// One entry of `[tracks]`.
#[derive(Clone, Debug)]
pub struct TrackFile {
    /// Its name.
    pub name: Spanned<String>,
    /// `samples`
    pub samples: Option<FormulaText>,
    /// `inputs`: a value for each, or its start and end.
    pub inputs: Vec<(Spanned<String>, [FormulaText; 2])>,
}

/// One entry of `[measures]`.
#[derive(Clone, Debug)]
pub struct MeasureFile {
    /// Its name.
    pub name: Spanned<String>,
    /// Its definition; `None` if it could not be read, which has been reported.
    pub source: Option<MeasureSourceFile>,
    /// `min` and `max`
    pub limits: [Option<FormulaText>; 2],
    /// `why`: text that is printed if a limit is violated.
    pub why: Option<String>,
}

/// The definition of a measure.
#[derive(Clone, Debug)]
pub enum MeasureSourceFile {
    /// A formula of earlier measures.
    Formula(FormulaText),
    /// `of`, taken over the poses of a track or of the drive.
    Over {
        /// `track`
        track: Option<Spanned<String>>,
        /// `of`
        of: Vec<FormulaText>,
        /// `per`: the input that `of` is differentiated by
        per: Option<Spanned<String>>,
        /// `take`
        take: Spanned<String>,
        /// `power` of a norm
        power: Option<FormulaText>,
    },
}

impl MeasureFile {
    /// The formulas it consists of.
    pub fn formulas(&self) -> &[FormulaText] {
        match &self.source {
            None => &[],
            Some(MeasureSourceFile::Formula(text)) => std::slice::from_ref(text),
            Some(MeasureSourceFile::Over { of, .. }) => of,
        }
    }
}

/// Reads an entry of `[tracks]`.
pub fn read_track(r: &mut TableReader, name: Spanned<String>) -> TrackFile {
    let samples = required_value(r, "samples", |r, k| r.formula(k));
    TrackFile {
        name,
        samples,
        inputs: r.named_ranges("inputs"),
    }
}

/// Reads an entry of `[measures]` that is a table.
pub fn read_measure(r: &mut TableReader, name: Spanned<String>) -> MeasureFile {
    let track = r.string("track");
    let of = required_value(r, "of", |r, k| r.formula_or_formulas(k));
    let take = required_value(r, "take", |r, k| r.string(k));
    let (per, power) = (r.string("per"), r.formula("power"));
    let limits = [r.formula("min"), r.formula("max")];
    let why = r.string("why").map(|s| s.value);
    let source = of.zip(take).map(|(of, take)| MeasureSourceFile::Over {
        track,
        of,
        per,
        take,
        power,
    });
    MeasureFile {
        name,
        source,
        limits,
        why,
    }
}

/// An entry of `[measures]` that is a formula.
pub fn measure_formula((name, text): NamedFormula) -> MeasureFile {
    MeasureFile {
        name,
        source: (!text.is_unread).then_some(MeasureSourceFile::Formula(text)),
        limits: [None, None],
        why: None,
    }
}
