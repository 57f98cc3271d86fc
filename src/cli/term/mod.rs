//! Messages on standard error: scene diagnostics with excerpt and caret, failures, warnings, notes.

pub mod clock;
mod excerpt;
pub mod outcome;
pub mod progress;

use super::args::values::ColourChoice;
use crate::diag::{
    Diagnostic, Diagnostics, MOST_QUOTED, Severity, Source, cut_text, shorten_text, shown_text,
};
use crate::import::ImportError;
use crate::limits::{Resource, current_limits};
use crate::parts::PartsError;
use codespan_reporting::term::termcolor::{
    Buffer, BufferWriter, Color, ColorChoice, ColorSpec, WriteColor,
};
use codespan_reporting::term::{self, Config};
use excerpt::ExcerptLines;
use outcome::Failure;
use std::collections::HashSet;
use std::io::{IsTerminal, Write};
use std::sync::{Mutex, PoisonError};

/// Maximum number of errors, and of warnings, that are shown in full; the rest are counted.
const MOST_SHOWN: usize = 20;

/// Destination and style of messages.
pub struct Term {
    colour: ColorChoice,
    quiet: bool,
    /// The stored messages, if they are not printed at once.
    kept: Option<Mutex<Vec<Buffer>>>,
}

impl Term {
    /// Decides about colour: only on a terminal, unless requested otherwise; NO_COLOR wins over `auto`.
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
        Self {
            colour,
            quiet,
            kept: None,
        }
    }

    /// The same, but messages are stored until [`pass_on`](Self::pass_on), so that those of several runs are not
    /// interleaved.
    pub fn kept_back(&self) -> Self {
        Self {
            colour: self.colour,
            quiet: self.quiet,
            kept: Some(Mutex::default()),
        }
    }

    /// Prints the stored messages through `other`.
    pub fn pass_on(&self, other: &Self) {
        let Some(kept) = &self.kept else { return };
        let kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.iter().for_each(|said| other.say(said.clone()));
    }

    /// Whether progress may be shown: it is never stored.
    pub fn shows_progress(&self) -> bool {
        !self.quiet && self.kept.is_none()
    }

    /// Whether only errors are printed.
    pub fn quiet(&self) -> bool {
        self.quiet
    }

    /// A line of information.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            self.note_always(&shown_text(&shorten_text(text)));
        }
    }

    /// A warning line.
    pub fn warning(&self, text: &str) {
        if !self.quiet {
            self.print_headed("warning", Color::Yellow, text);
        }
    }

    /// A failure with its hints.
    pub fn failure(&self, failure: &Failure) {
        if let Failure::Scene(error) = failure {
            return self.diagnostics(&error.source_text, &error.diagnostics);
        }
        if let Failure::Parts(PartsError::Faulty(faults)) = failure {
            let each = faults.iter();
            return each.for_each(|fault| self.print_headed("error", Color::Red, fault));
        }
        self.print_headed("error", Color::Red, &failure.to_string());
        let (one_hint, of_structure);
        let hints: &[String] = match failure {
            Failure::Usage { hints, .. }
            | Failure::NeverClosed { hints, .. }
            | Failure::Undecided { hints, .. } => hints,
            Failure::Structure(error) => {
                of_structure = Vec::from_iter(error.hint().map(str::to_owned));
                &of_structure
            }
            Failure::Import(ImportError::Transparent { .. }) => {
                one_hint =
                    ["put them on a colour with --background #rrggbb, or write .apng".to_owned()];
                &one_hint
            }
            _ => &[],
        };
        for hint in hints {
            self.print_headed("  hint", Color::Cyan, hint);
        }
    }

    /// Prints the diagnostics of a scene, the first of them in full (warnings only unless quiet).
    pub fn diagnostics(&self, source: &Source, diagnostics: &Diagnostics) {
        let lines = ExcerptLines::new(&source.name, &source.text);
        let config = Config::default();
        // Buffered: one system call per character takes minutes for a scene full of errors.
        let writer = BufferWriter::stderr(self.colour);
        let mut all = writer.buffer();
        let most = current_limits().most(Resource::Message);
        let (mut shown, mut left): ([usize; 2], [Vec<&Diagnostic>; 2]) = Default::default();
        let mut is_cut = false;
        for diagnostic in diagnostics.sorted() {
            let kind = usize::from(diagnostic.severity == Severity::Warning);
            if self.quiet && kind == 1 {
                continue;
            }
            if shown[kind] == MOST_SHOWN {
                left[kind].push(diagnostic);
                continue;
            }
            let (file, excerpt) = lines.excerpt(diagnostic);
            let mut one = writer.buffer();
            let _ = term::emit_to_write_style(&mut one, &config, &file, &excerpt);
            if (all.len() + one.len()) as f64 > most {
                is_cut = true;
                left[kind].push(diagnostic);
                continue;
            }
            shown[kind] += 1;
            let _ = all.write_all(one.as_slice());
        }
        self.say(all);
        // If the limit is exceeded, the message is printed without its line.
        for (kind, head, colour) in [(0, "error", Color::Red), (1, "warning", Color::Yellow)] {
            if shown == [0, 0] && !left[kind].is_empty() {
                let first = left[kind].remove(0);
                shown[kind] += 1;
                self.print_headed(head, colour, &cut_text(&first.message, MOST_QUOTED));
            }
        }
        for (left, word) in left.iter().zip(["error", "warning"]) {
            if !left.is_empty() {
                let kinds: HashSet<String> = left.iter().map(|d| kind_of(&d.message)).collect();
                let (s, kinds) = (if left.len() == 1 { "" } else { "s" }, kinds.len());
                let of = if kinds == 1 { "kind" } else { "kinds" };
                self.note_always(&format!(
                    "and {} more {word}{s} of {kinds} {of}",
                    left.len()
                ));
            }
        }
        if is_cut {
            let most = Resource::Message.shown(most);
            self.note_always(&format!(
                "the limit `message` is {most}, and all messages about {} need more (--limits message=…)",
                shown_text(&source.name)
            ));
        }
    }

    fn note_always(&self, text: &str) {
        let mut line = self.new_buffer();
        let _ = writeln!(line, "{text}");
        self.say(line);
    }

    fn print_headed(&self, head: &str, colour: Color, text: &str) {
        let mut line = self.new_buffer();
        let _ = line.set_color(ColorSpec::new().set_fg(Some(colour)).set_bold(true));
        let _ = write!(line, "{head}");
        let _ = line.reset();
        let _ = writeln!(line, ": {}", shown_text(&shorten_text(text)));
        self.say(line);
    }

    fn new_buffer(&self) -> Buffer {
        BufferWriter::stderr(self.colour).buffer()
    }

    /// Prints at once, or stores for later.
    fn say(&self, said: Buffer) {
        match &self.kept {
            Some(kept) => kept
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .push(said),
            // If the stream is closed, nobody can be told.
            None => drop(BufferWriter::stderr(self.colour).print(&said)),
        }
    }
}

/// The part of a message outside of quotes.
fn kind_of(message: &str) -> String {
    message.split('`').step_by(2).collect()
}
