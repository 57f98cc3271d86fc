//! Messages about a user's text: the error, its position, and a hint. Several are collected; the command line prints them.

use super::names::{MOST_LISTED, name_hint, nearest_name};
use super::shown::{MOST_SAID, cut_text};
use crate::sorting::sort_by_key;
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

/// Byte range in the source text.
pub type Span = Range<usize>;

/// Severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The scene cannot be used.
    Error,
    /// The scene can be used, but probably differs from what was intended.
    Warning,
}

/// One diagnostic.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Its severity.
    pub severity: Severity,
    /// The message, in one line.
    pub message: String,
    /// Its position, if it has one in the text.
    pub span: Option<Span>,
    /// A few words under the caret.
    pub label: String,
    /// Related positions, each with a short text.
    pub related: Vec<(Span, String)>,
    /// A suggested remedy.
    pub hints: Vec<String>,
    /// A consequence of another error, which is reported: never stored.
    pub inherited: bool,
}

impl Diagnostic {
    /// An error without a position.
    pub fn error(message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            message: message.into(),
            span: None,
            label: String::new(),
            related: Vec::new(),
            hints: Vec::new(),
            inherited: false,
        }
    }

    /// A placeholder for an error that is a consequence of another one. It stops the caller, and is not shown.
    pub fn inherited() -> Self {
        Self {
            inherited: true,
            ..Self::error("follows from another mistake")
        }
    }

    /// A warning without a position.
    pub fn warning(message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(message)
        }
    }

    /// Sets its position.
    pub fn at(mut self, span: Span) -> Self {
        self.span = Some(span);
        self
    }

    /// Sets the text under the caret.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Adds another position that explains it.
    pub fn with_related(mut self, span: Span, label: impl Into<String>) -> Self {
        self.related.push((span, label.into()));
        self
    }

    /// Adds a hint.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        let hint = hint.into();
        if !self.hints.contains(&hint) {
            self.hints.push(hint);
        }
        self
    }

    /// Adds "did you mean" if one of `known` is close to `word`; otherwise all of them, if they are few.
    pub fn suggest<'a>(self, word: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        if known.is_empty() || known.len() > MOST_LISTED {
            return self.did_you_mean(word, known);
        }
        self.hint(name_hint(word, known))
    }

    /// Adds "did you mean" if one of `known` is close to `word`.
    pub fn did_you_mean<'a>(self, word: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        match nearest_name(word, known) {
            Some(name) => self.hint(format!("did you mean `{name}`?")),
            None => self,
        }
    }
}

/// Most mistakes of a scene in a report.
const MOST_TOLD: usize = 20;

/// Messages in the order they were found, none of them twice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics {
    items: Vec<Diagnostic>,
    /// Hashes of messages with their positions: a faulty text is found once for each reference to it.
    known: HashSet<u64>,
}

impl Diagnostics {
    /// A value, or nothing and the message why.
    pub fn taken<T>(&mut self, value: Result<T, Diagnostic>) -> Option<T> {
        value.map_err(|diagnostic| self.push(diagnostic)).ok()
    }

    /// Adds one, unless it is only a consequence of another, or already present.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        let mut hasher = DefaultHasher::new();
        (&diagnostic.message, &diagnostic.span).hash(&mut hasher);
        if !diagnostic.inherited && self.known.insert(hasher.finish()) {
            self.items.push(diagnostic);
        }
    }

    /// Number of diagnostics.
    pub fn count(&self) -> usize {
        self.items.len()
    }

    /// Whether at least one is an error.
    pub fn has_errors(&self) -> bool {
        self.items.iter().any(|d| d.severity == Severity::Error)
    }

    /// All of them, ordered by position, those without a position last.
    pub fn sorted(&self) -> Vec<&Diagnostic> {
        let mut all: Vec<_> = self.items.iter().collect();
        sort_by_key(&mut all, |d| {
            d.span.as_ref().map_or(usize::MAX, |s| s.start)
        });
        all
    }

    /// Moves the messages of `other` to the end.
    pub fn append(&mut self, other: Diagnostics) {
        other.items.into_iter().for_each(|item| self.push(item));
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }
}

/// A text with its name in messages.
#[derive(Clone, Debug)]
pub struct Source {
    /// Path, built-in name or `<stdin>`.
    pub name: String,
    /// The whole text.
    pub text: String,
}

impl Source {
    /// Line and column of a byte, both from 1; columns count characters.
    pub fn line_and_column(&self, byte: usize) -> [usize; 2] {
        let before = self.text.get(..byte).unwrap_or(&self.text);
        let line = before.rfind('\n').map_or(0, |end| end + 1);
        let lines = before.bytes().filter(|b| *b == b'\n').count();
        [lines + 1, before[line..].chars().count() + 1]
    }
}

/// The errors found in a scene that cannot be used.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{} is not a usable scene", source_text.name)]
pub struct SceneError {
    /// The text the spans refer to.
    pub source_text: Source,
    /// What is wrong.
    pub diagnostics: Diagnostics,
}

impl SceneError {
    /// The mistakes with their lines and columns, in one line of text: those that fit.
    pub fn told(&self) -> String {
        let source = &self.source_text;
        let mistakes = self.diagnostics.sorted().into_iter();
        let mistakes = mistakes.filter(|d| d.severity == Severity::Error);
        // Places are counted from the beginning of the text: those of thousands would take long.
        let mistakes = mistakes.take(MOST_TOLD);
        let lines = mistakes.map(|mistake| match &mistake.span {
            Some(span) => {
                let [line, column] = source.line_and_column(span.start);
                format!("{}:{line}:{column}: {}", source.name, mistake.message)
            }
            None => mistake.message.clone(),
        });
        let text = lines.collect::<Vec<_>>().join("; ");
        cut_text(&text, MOST_SAID).into_owned()
    }

    /// Line of the first mistake that has one, from 1.
    pub fn line(&self) -> Option<usize> {
        let first = self.diagnostics.sorted().into_iter();
        let mut spans = first.filter_map(|d| d.span.clone());
        let span = spans.next()?;
        Some(self.source_text.line_and_column(span.start)[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_lines_and_characters() {
        let text = "a\nü b".to_owned();
        let name = String::new();
        let source = Source { name, text };
        assert_eq!(source.line_and_column(0), [1, 1]);
        assert_eq!(source.line_and_column(5), [2, 3]);
        assert_eq!(source.line_and_column(99), [2, 4]);
    }

    #[test]
    fn what_only_follows_from_another_mistake_is_not_kept() {
        let mut diagnostics = Diagnostics::default();
        diagnostics.push(Diagnostic::inherited());
        assert!(diagnostics.is_empty());
        diagnostics.push(Diagnostic::error("a"));
        assert!(diagnostics.has_errors());
    }

    #[test]
    fn nothing_is_said_twice() {
        let mut diagnostics = Diagnostics::default();
        for place in [0..1, 0..1, 2..3] {
            diagnostics.push(Diagnostic::error("a").at(place));
        }
        let mut more = diagnostics.clone();
        more.push(Diagnostic::error("b").at(0..1));
        diagnostics.append(more);
        assert_eq!(diagnostics.count(), 3);
    }
}
