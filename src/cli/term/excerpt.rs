//! Diagnostics of a scene beside the lines they refer to: lines are cut around the highlighted text, and control
//! characters are spelt out.

use crate::diag::{Diagnostic, Severity, Span, shorten_text, shown_char, shown_text};
use crate::sorting::sort_by_key;
use codespan_reporting::diagnostic::{Diagnostic as Excerpt, Label};
use codespan_reporting::files::{Error, Files};
use std::ops::Range;

/// Characters shown before and after the highlighted text.
const AROUND: usize = 80;

/// Maximum number of highlighted characters.
const MOST_POINTED_AT: usize = 120;

/// Replaces the text that is cut off.
const CUT: char = '…';

/// A text and where its lines start.
pub struct ExcerptLines<'s> {
    name: String,
    text: &'s str,
    starts: Vec<usize>,
}

impl<'s> ExcerptLines<'s> {
    /// The lines of a text; `name` is made printable.
    pub fn new(name: &str, text: &'s str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
        Self {
            name: shown_text(name).into_owned(),
            text,
            starts: [0].into_iter().chain(breaks.map(|(k, _)| k + 1)).collect(),
        }
    }

    /// The message with its lines.
    pub fn excerpt(&self, diagnostic: &Diagnostic) -> (ExcerptLine, Excerpt<()>) {
        let own = diagnostic.span.iter().map(|s| (s, &diagnostic.label, true));
        let related = diagnostic.related.iter().map(|(s, t)| (s, t, false));
        let inside = |s: &Span| {
            let is_place = |at| self.text.is_char_boundary(at);
            s.start <= s.end && is_place(s.start) && is_place(s.end)
        };
        let mut places: Vec<_> = own.chain(related).filter(|(s, ..)| inside(s)).collect();
        sort_by_key(&mut places, |(span, ..)| span.start);
        let mut shown = ExcerptLine::new(self.name.clone());
        let mut labels = Vec::new();
        let mut rest = &places[..];
        while let Some((first, ..)) = rest.first() {
            let line = self.line_of(first.start);
            let whole = self.range(line);
            let count = rest
                .iter()
                .take_while(|(s, ..)| s.start <= whole.end)
                .count();
            let (here, later) = rest.split_at(count);
            let main = here.iter().find(|(_, _, is_own)| *is_own);
            let window = self.window(&whole, main.map_or(first, |(span, ..)| span));
            shown.push(self, line, &window, whole);
            for (span, text, is_own) in here {
                let Some(range) = shown.place(self.text, &window, span) else {
                    continue;
                };
                let label = match is_own {
                    true => Label::primary((), range),
                    false => Label::secondary((), range),
                };
                labels.push(label.with_message(said_text(text)));
            }
            rest = later;
        }
        let base = match diagnostic.severity {
            Severity::Error => Excerpt::error(),
            Severity::Warning => Excerpt::warning(),
        };
        let hints = diagnostic.hints.iter();
        let excerpt = base
            .with_message(said_text(&diagnostic.message))
            .with_labels(labels)
            .with_notes(
                hints
                    .map(|hint| format!("hint: {}", said_text(hint)))
                    .collect(),
            );
        (shown, excerpt)
    }

    fn line_of(&self, byte: usize) -> usize {
        self.starts.partition_point(|start| *start <= byte) - 1
    }

    /// A line without its end.
    fn range(&self, line: usize) -> Range<usize> {
        let start = self.starts[line];
        let end = self
            .starts
            .get(line + 1)
            .map_or(self.text.len(), |next| next - 1);
        start..end
    }

    /// The part of a line that is shown: the highlighted text, and some context around it.
    fn window(&self, line: &Range<usize>, span: &Span) -> Range<usize> {
        let before = self.text[line.start..span.start].char_indices().rev();
        let start = before
            .take(AROUND)
            .last()
            .map_or(span.start, |(k, _)| line.start + k);
        let pointed = pointed_width(self.text, span, line.end);
        let mut behind = self.text[pointed..line.end].char_indices();
        let end = behind.nth(AROUND).map_or(line.end, |(k, _)| pointed + k);
        start..end
    }
}

/// End of the highlighted text on its first line.
fn pointed_width(text: &str, span: &Span, line_end: usize) -> usize {
    let end = span.end.min(line_end).max(span.start);
    let mut characters = text[span.start..end].char_indices();
    characters
        .nth(MOST_POINTED_AT)
        .map_or(end, |(k, _)| span.start + k)
}

fn said_text(text: &str) -> String {
    shown_text(&shorten_text(text)).into_owned()
}

/// One line as it is shown.
struct ShownLine {
    number: usize,
    /// Bytes of the shown text.
    range: Range<usize>,
    /// Start of the window, in the shown text and in the file.
    window: usize,
    column: usize,
}

/// The lines of one message, in the form that codespan needs.
pub struct ExcerptLine {
    name: String,
    text: String,
    lines: Vec<ShownLine>,
    /// Positions of labels in the shown text, and their columns in the file.
    columns: Vec<(usize, usize)>,
}

impl ExcerptLine {
    fn new(name: String) -> Self {
        Self {
            name,
            text: String::new(),
            lines: Vec::new(),
            columns: Vec::new(),
        }
    }

    /// Adds a line; where lines are left out, codespan learns this from an invisible one.
    fn push(
        &mut self,
        file: &ExcerptLines,
        line: usize,
        window: &Range<usize>,
        whole: Range<usize>,
    ) {
        if let Some(last) = self.lines.last().map(|l| l.number)
            && last < line
        {
            for _ in 0..2 {
                self.add(last + 1, 0, "", [false; 2]);
            }
        }
        let column = file.text[whole.start..window.start].chars().count();
        let is_cut = [window.start > whole.start, window.end < whole.end];
        self.add(line + 1, column, &file.text[window.clone()], is_cut);
    }

    fn add(&mut self, number: usize, column: usize, text: &str, is_cut: [bool; 2]) {
        let start = self.text.len();
        self.text.extend(is_cut[0].then_some(CUT));
        let window = self.text.len();
        for character in text.chars() {
            self.text.push_str(&shown_in_line(character));
        }
        self.text.extend(is_cut[1].then_some(CUT));
        self.lines.push(ShownLine {
            number,
            range: start..self.text.len(),
            window,
            column,
        });
        self.text.push('\n');
    }

    /// The text that a label highlights in the last line.
    fn place(&mut self, text: &str, window: &Range<usize>, span: &Span) -> Option<Range<usize>> {
        let line = self.lines.last()?;
        if span.start < window.start || span.start > window.end {
            return None;
        }
        let length = |part: &str| part.chars().map(|c| shown_in_line(c).len()).sum::<usize>();
        let start = line.window + length(&text[window.start..span.start]);
        let end = start + length(&text[span.start..pointed_width(text, span, window.end)]);
        let column = line.column + text[window.start..span.start].chars().count();
        self.columns.push((start, column));
        Some(start..end)
    }
}

/// A tab stays one: codespan lines its columns up.
fn shown_in_line(character: char) -> String {
    match character {
        '\t' => character.to_string(),
        _ => shown_char(character),
    }
}

impl<'a> Files<'a> for ExcerptLine {
    type FileId = ();
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, (): ()) -> Result<&'a str, Error> {
        Ok(&self.name)
    }

    fn source(&'a self, (): ()) -> Result<&'a str, Error> {
        Ok(&self.text)
    }

    fn line_index(&'a self, (): (), byte: usize) -> Result<usize, Error> {
        let after = self.lines.partition_point(|line| line.range.start <= byte);
        Ok(after.saturating_sub(1))
    }

    fn line_number(&'a self, (): (), index: usize) -> Result<usize, Error> {
        let line = self.lines.get(index);
        Ok(line.map_or(index + 1, |line| line.number))
    }

    fn column_number(&'a self, (): (), _: usize, byte: usize) -> Result<usize, Error> {
        let known = self.columns.iter().find(|(place, _)| *place == byte);
        Ok(known.map_or(0, |(_, column)| *column) + 1)
    }

    fn line_range(&'a self, (): (), index: usize) -> Result<Range<usize>, Error> {
        let line = self.lines.get(index).ok_or(Error::LineTooLarge {
            given: index,
            max: self.lines.len(),
        })?;
        Ok(line.range.start..line.range.end + 1)
    }
}
