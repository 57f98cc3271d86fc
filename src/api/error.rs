//! The error type of the library.

use crate::analysis::study::FamilyError;
use crate::diag::{Diagnostic, SceneError, Severity, Source, Span, name_hint};
use crate::export::ExportError;
use crate::export::error::PipelineError;
use crate::kinematics::results::columns::ValueColumn;
use crate::kinematics::structure::block::StructureError;
use crate::limits::LimitExceeded;
use crate::model::asked_ranges::range_words;
use crate::model::mechanism::Mechanism;
use crate::render::RenderError;
use crate::scene::source::SourceError;
use std::fmt;
use std::ops::RangeInclusive;

/// Kinds of errors that a program can distinguish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The scene does not exist, or its file cannot be read.
    Source,
    /// The scene has errors; the message lists all of them with their positions.
    Scene,
    /// The mechanism is ill-posed: under-constrained or contradictory.
    Mechanism,
    /// A name, time or number that does not fit the scene.
    Argument,
    /// A picture or a file could not be made.
    File,
    /// The motion needs more memory or more numbers than the limits allow.
    Limit,
}

/// An error: its kind, a message, and hints on how to fix it.
///
/// ```
/// let error = mechanim::Scene::builtin("gearshfit").unwrap_err();
/// assert_eq!(error.kind(), mechanim::ErrorKind::Source);
/// assert!(error.hints()[0].contains("gearshift"));
/// ```
#[derive(Clone, Debug)]
pub struct Error {
    kind: ErrorKind,
    message: String,
    hints: Vec<String>,
}

impl Error {
    pub(super) fn new(kind: ErrorKind, message: impl Into<String>, hints: Vec<String>) -> Self {
        Self {
            kind,
            message: message.into(),
            hints,
        }
    }

    /// A name that does not occur in the scene.
    pub(super) fn unknown_name<'a>(
        what: &str,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let message = format!("the scene has no {what} `{name}`");
        Self::new(ErrorKind::Argument, message, vec![name_hint(name, known)])
    }

    /// Refuses a number outside its range.
    pub(super) fn unless_in(
        range: &RangeInclusive<f64>,
        what: &str,
        value: f64,
    ) -> Result<(), Self> {
        if range.contains(&value) {
            return Ok(());
        }
        let message = format!("`{what}` is {value}, but must be {}", range_words(range));
        Err(Self::new(ErrorKind::Argument, message, Vec::new()))
    }

    /// The kind of the error.
    ///
    /// ```
    /// let scene = mechanim::Scene::builtin("four-bar").unwrap();
    /// let error = scene.solve(mechanim::Samples::At(vec![-1.0])).unwrap_err();
    /// assert_eq!(error.kind(), mechanim::ErrorKind::Argument);
    /// ```
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// Hints on how to fix it, the best first.
    ///
    /// ```
    /// let error = mechanim::Scene::open("nowhere.toml").unwrap_err();
    /// assert!(error.hints().is_empty() && error.to_string().contains("nowhere.toml"));
    /// ```
    pub fn hints(&self) -> &[String] {
        &self.hints
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

impl From<SourceError> for Error {
    fn from(error: SourceError) -> Self {
        Self::new(ErrorKind::Source, error.message, error.hints)
    }
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Self {
        let source = &error.source_text;
        let sorted = error.diagnostics.sorted();
        let wrong = sorted.iter().filter(|d| d.severity == Severity::Error);
        let lines: Vec<String> = wrong.clone().map(|d| line(source, d)).collect();
        // Without a position, what is wrong is not in the text: it was put in its place.
        let kind = match wrong.clone().all(|d| d.span.is_none()) {
            true => ErrorKind::Argument,
            false => ErrorKind::Scene,
        };
        let hints = wrong.flat_map(|d| d.hints.iter().cloned()).collect();
        Self::new(kind, lines.join("\n"), hints)
    }
}

impl From<StructureError> for Error {
    fn from(error: StructureError) -> Self {
        match error {
            StructureError::Limit(limit) => limit.into(),
            other => {
                let hints = other.hint().map(str::to_owned);
                Self::new(
                    ErrorKind::Mechanism,
                    other.to_string(),
                    Vec::from_iter(hints),
                )
            }
        }
    }
}

impl From<FamilyError> for Error {
    fn from(error: FamilyError) -> Self {
        let hints = Vec::from_iter(error.hint());
        let message = error.to_string();
        match error {
            FamilyError::Scene(error) => (*error).into(),
            FamilyError::Structure(error) => error.into(),
            FamilyError::Track { .. } => Self::new(ErrorKind::Mechanism, message, hints),
            _ => Self::new(ErrorKind::Argument, message, hints),
        }
    }
}

impl From<LimitExceeded> for Error {
    fn from(error: LimitExceeded) -> Self {
        Self::new(ErrorKind::Limit, error.to_string(), Vec::new())
    }
}

impl From<ExportError> for Error {
    fn from(error: ExportError) -> Self {
        Self::new(ErrorKind::File, error.to_string(), Vec::new())
    }
}

impl From<RenderError> for Error {
    fn from(error: RenderError) -> Self {
        Self::new(ErrorKind::File, error.to_string(), Vec::new())
    }
}

impl From<PipelineError<RenderError>> for Error {
    fn from(error: PipelineError<RenderError>) -> Self {
        Self::new(ErrorKind::File, error.to_string(), Vec::new())
    }
}

/// A message with its position, `file:line:column: message`.
pub(super) fn line(source: &Source, diagnostic: &Diagnostic) -> String {
    // A replaced value has no position in the text.
    let inside = |span: &&Span| span.start < source.text.len();
    let place = diagnostic.span.as_ref().filter(inside).map(|span| {
        let [line, column] = source.line_and_column(span.start);
        format!("{line}:{column}: ")
    });
    let place = place.unwrap_or_else(|| " ".to_owned());
    format!("{}:{place}{}", source.name, diagnostic.message)
}

/// The column of a named value.
///
/// Errors: no quantity of the mechanism has that name.
pub(super) fn find_column(mechanism: &Mechanism, name: &str) -> Result<ValueColumn, Error> {
    let unknown = |names: Vec<String>| {
        let names = names.iter().map(String::as_str);
        Error::unknown_name("value", name, names)
    };
    ValueColumn::find(mechanism, name).map_err(unknown)
}
