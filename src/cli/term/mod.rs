//! Messages on standard error: scene diagnostics with excerpt and caret, failures, warnings, notes.

pub mod clock;
pub mod outcome;
pub mod progress;

use super::args::values::ColourChoice;
use crate::diag::{Diagnostic, Diagnostics, Severity, Source};
use crate::import::ImportError;
use crate::kinematics::structure::block::StructureError;
use codespan_reporting::diagnostic::{Diagnostic as Excerpt, Label};
use codespan_reporting::files::SimpleFile;
use codespan_reporting::term::termcolor::{
    Color, ColorChoice, ColorSpec, StandardStream, WriteColor,
};
use codespan_reporting::term::{self, Config};
use outcome::Failure;
use std::io::{IsTerminal, Write};

/// Where and how messages are written.
pub struct Term {
    colour: ColorChoice,
    quiet: bool,
}

impl Term {
    /// Decides about colour: only on a terminal, unless told otherwise; NO_COLOR wins over `auto`.
    pub fn new(choice: ColourChoice, quiet: bool) -> Self {
        let wanted = match choice {
            ColourChoice::Always => true,
            ColourChoice::Never => false,
            ColourChoice::Auto => {
                let refused = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
                std::io::stderr().is_terminal() && !refused
            }
        };
        let colour = if wanted {
            ColorChoice::Always
        } else {
            ColorChoice::Never
        };
        Self { colour, quiet }
    }

    /// Whether only errors are to be said.
    pub fn quiet(&self) -> bool {
        self.quiet
    }

    /// A line of information.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            let _ = writeln!(self.stream(), "{text}");
        }
    }

    /// A warning line.
    pub fn warning(&self, text: &str) {
        if !self.quiet {
            self.headed("warning", Color::Yellow, text);
        }
    }

    /// A failure with its hints.
    pub fn failure(&self, failure: &Failure) {
        if let Failure::Scene(error) = failure {
            return self.diagnostics(&error.source_text, &error.diagnostics);
        }
        self.headed("error", Color::Red, &failure.to_string());
        let one_hint;
        let hints: &[String] = match failure {
            Failure::Usage { hints, .. } | Failure::NeverClosed { hints, .. } => hints,
            Failure::Structure(error) => {
                one_hint = [hint_of(error)];
                &one_hint
            }
            Failure::Import(ImportError::Transparent { .. }) => {
                one_hint = [
                    "lay them over a colour with --background #rrggbb, or write .apng".to_owned(),
                ];
                &one_hint
            }
            _ => &[],
        };
        for hint in hints {
            self.headed("  hint", Color::Cyan, hint);
        }
    }

    /// All diagnostics of a scene (warnings only unless quiet).
    pub fn diagnostics(&self, source: &Source, diagnostics: &Diagnostics) {
        let file = SimpleFile::new(source.name.as_str(), source.text.as_str());
        let config = Config::default();
        for diagnostic in diagnostics.sorted() {
            if self.quiet && diagnostic.severity == Severity::Warning {
                continue;
            }
            // The stream going away leaves nobody to tell.
            let _ = term::emit_to_write_style(
                &mut self.stream(),
                &config,
                &file,
                &excerpt(diagnostic, source),
            );
        }
    }

    fn headed(&self, head: &str, colour: Color, text: &str) {
        let mut stream = self.stream();
        let _ = stream.set_color(ColorSpec::new().set_fg(Some(colour)).set_bold(true));
        let _ = write!(stream, "{head}");
        let _ = stream.reset();
        let _ = writeln!(stream, ": {text}");
    }

    fn stream(&self) -> StandardStream {
        StandardStream::stderr(self.colour)
    }
}

fn hint_of(error: &StructureError) -> String {
    match error {
        StructureError::Impossible { .. } => "check the constant offsets of this loop: they must cancel".to_owned(),
        StructureError::UnderDetermined { .. } => {
            "drive them as inputs, add a loop or an equation, or look for a misspelt parameter: an undefined name \
             is an unknown"
                .to_owned()
        }
        StructureError::Unheld { .. } => {
            "give it a loop or an equation that changes with it, drive it as an input, or take it out".to_owned()
        }
    }
}

fn excerpt(diagnostic: &Diagnostic, source: &Source) -> Excerpt<()> {
    let inside =
        |span: &std::ops::Range<usize>| span.end <= source.text.len() && span.start <= span.end;
    let mut labels = Vec::new();
    if let Some(span) = diagnostic.span.as_ref().filter(|s| inside(s)) {
        labels.push(Label::primary((), span.clone()).with_message(&diagnostic.label));
    }
    for (span, text) in diagnostic.related.iter().filter(|(s, _)| inside(s)) {
        labels.push(Label::secondary((), span.clone()).with_message(text));
    }
    let base = match diagnostic.severity {
        Severity::Error => Excerpt::error(),
        Severity::Warning => Excerpt::warning(),
    };
    let hints = diagnostic
        .hints
        .iter()
        .map(|hint| format!("hint: {hint}"))
        .collect();
    base.with_message(&diagnostic.message)
        .with_labels(labels)
        .with_notes(hints)
}
