//! Messages about a user's text: the error, its position, and a hint. Several are collected; the command line prints them.

use std::borrow::Cow;
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

/// Maximum number of known names that a hint lists when none resembles the unknown one.
const MOST_LISTED: usize = 6;

/// Smallest similarity (Jaro-Winkler, 0 to 1) at which another name is suggested.
const SIMILAR: f64 = 0.75;

/// A hint for an unknown name: the known name that resembles it, or else all known names.
pub fn name_hint<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    match nearest_name(word, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if known.is_empty() => "there are none".to_owned(),
        None => format!("known names: `{}`", known.join("`, `")),
    }
}

/// The known name most similar to `word`, if any is.
pub fn nearest_name<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|name| {
            (
                strsim::jaro_winkler(&word.to_lowercase(), &name.to_lowercase()),
                name,
            )
        })
        .filter(|(score, _)| *score >= SIMILAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

/// A text for attributes and contents of XML and HTML.
pub fn xml_text(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' => out.push_str("&#10;"),
            // XML 1.0 cannot represent other control characters, nor the last two code points of the basic plane.
            c if c.is_control() => out.push(' '),
            '\u{fffe}' | '\u{ffff}' => out.push(char::REPLACEMENT_CHARACTER),
            c => out.push(c),
        }
    }
    out
}

/// A number as messages show it: in full if it is short.
pub fn shown_number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() || (1e-6..1e9).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// Maximum digits before the point of a decimal number, and digits kept after its leading zeros.
const MOST_WHOLE_DIGITS: i32 = 9;
const LEAST_DIGITS: i32 = 3;

/// A number with this many decimals, as messages show it: in scientific notation where decimals would show only zeros,
/// or hundreds of digits.
pub fn decimals_of(value: f64, decimals: usize) -> String {
    let size = value.abs();
    let least = 10_f64.powi(LEAST_DIGITS - 1 - decimals as i32);
    if size == 0.0 || !size.is_finite() || (least..10_f64.powi(MOST_WHOLE_DIGITS)).contains(&size) {
        format!("{value:.decimals$}")
    } else {
        format!("{value:.*e}", LEAST_DIGITS as usize)
    }
}

/// Maximum length of one quoted value, which may be megabytes in a file.
pub const MOST_QUOTED: usize = 120;

/// The same for a whole message.
const MOST_SAID: usize = 4000;

/// Most mistakes of a scene in a report.
const MOST_TOLD: usize = 20;

/// Whether a character has an effect instead of being visible: controls and escapes, marks that change the writing
/// direction, line and paragraph separators of Unicode, tags.
fn is_unseen(character: char) -> bool {
    character.is_control()
        || matches!(character,
            '\u{61c}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// A character in printable form: one with an effect is spelled out, as `\u{1b}`.
pub fn shown_char(character: char) -> String {
    match is_unseen(character) {
        true => character.escape_default().to_string(),
        false => character.to_string(),
    }
}

/// A text of a file, a name or a path in printable form on one line: see [`shown_char`].
pub fn shown_text(text: &str) -> Cow<'_, str> {
    shown_but(text, |_| false)
}

/// The same for a text that may have several lines.
pub fn shown_lines(text: &str) -> Cow<'_, str> {
    shown_but(text, |c| matches!(c, '\n' | '\t'))
}

fn shown_but(text: &str, stays: impl Fn(char) -> bool) -> Cow<'_, str> {
    let may_command = text.contains("::") || text.contains("##");
    if !may_command && !text.chars().any(|c| is_unseen(c) && !stays(c)) {
        return Cow::Borrowed(text);
    }
    let (mut shown, mut begins) = (String::with_capacity(text.len()), true);
    for (at, c) in text.char_indices() {
        if begins_command(&text[at..], begins) {
            shown.extend(c.escape_unicode());
        } else if stays(c) {
            shown.push(c);
        } else {
            shown += &shown_char(c);
        }
        begins = c == '\n' || (begins && c.is_whitespace());
    }
    Cow::Owned(shown)
}

/// Whether a CI service would interpret the following text in a log as a command: `::error::` at the beginning of a
/// line, `##[error]`, `##vso[…]`, `##teamcity[…]` anywhere.
fn begins_command(rest: &str, is_line: bool) -> bool {
    let word = |rest: &str| {
        rest.trim_start_matches(|c: char| c.is_ascii_alphabetic())
            .starts_with('[')
    };
    (is_line && rest.starts_with("::")) || rest.strip_prefix("##").is_some_and(word)
}

/// A message and its quoted values (`` `so` ``), cut to a readable length.
pub fn shorten_text(text: &str) -> Cow<'_, str> {
    if text.len() <= MOST_QUOTED {
        return Cow::Borrowed(text);
    }
    let parts = text.split('`').enumerate();
    let parts: Vec<Cow<str>> = parts
        .map(|(k, part)| match k % 2 {
            1 => cut_text(part, MOST_QUOTED),
            _ => Cow::Borrowed(part),
        })
        .collect();
    Cow::Owned(cut_text(&parts.join("`"), MOST_SAID).into_owned())
}

/// The beginning of a text that is longer than this many characters.
pub fn cut_text(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
        None => Cow::Borrowed(text),
    }
}

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
        all.sort_by_key(|d| d.span.as_ref().map_or(usize::MAX, |s| s.start));
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
    fn texts_cannot_break_a_document() {
        let text = xml_text("a<b & \"c\"'\u{0}\n>\u{fffe}");
        assert_eq!(text, "a&lt;b &amp; &quot;c&quot;&#39; &#10;&gt;\u{fffd}");
    }

    #[test]
    fn nearest_name_is_offered_only_when_near() {
        let known = ["gearshift", "slider-crank", "seven-r"];
        assert_eq!(nearest_name("gearshfit", known), Some("gearshift"));
        assert_eq!(nearest_name("slidercrank", known), Some("slider-crank"));
        assert_eq!(nearest_name("quux", known), None);
    }

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
    fn numbers_in_messages_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-2.5, "-2.5"),
            (1e300, "1e300"),
            (-1e-9, "-1e-9"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(shown_number(value), text);
        }
    }

    #[test]
    fn decimals_show_what_a_number_is() {
        for (value, decimals, text) in [
            (0.0, 6, "0.000000"),
            (1e-9, 6, "1.000e-9"),
            (-1.148e-7, 6, "-1.148e-7"),
            (1.5e-4, 6, "0.000150"),
            (-17.0, 9, "-17.000000000"),
            (1.23e-8, 9, "1.230e-8"),
            (999_999_999.5, 3, "999999999.500"),
            (-1e300, 9, "-1.000e300"),
            (f64::NAN, 6, "NaN"),
            (f64::NEG_INFINITY, 6, "-inf"),
            (0.004, 3, "4.000e-3"),
        ] {
            assert_eq!(decimals_of(value, decimals), text);
        }
    }

    #[test]
    fn what_would_act_on_a_terminal_is_spelt_out() {
        for (text, shown, lines) in [
            (
                "plain Käfig µ 齿轮",
                "plain Käfig µ 齿轮",
                "plain Käfig µ 齿轮",
            ),
            ("\u{1b}[32mok", "\\u{1b}[32mok", "\\u{1b}[32mok"),
            ("\u{9b}31m", "\\u{9b}31m", "\\u{9b}31m"),
            ("a\nb\tc\r", "a\\nb\\tc\\r", "a\nb\tc\\r"),
            (
                "a\u{202e}b\u{2066}",
                "a\\u{202e}b\\u{2066}",
                "a\\u{202e}b\\u{2066}",
            ),
            (
                "\u{feff}\u{7f}\u{7}",
                "\\u{feff}\\u{7f}\\u{7}",
                "\\u{feff}\\u{7f}\\u{7}",
            ),
        ] {
            assert_eq!(shown_text(text), shown);
            assert_eq!(shown_lines(text), lines);
        }
    }

    #[test]
    fn nothing_is_a_command_of_a_log() {
        for (text, shown) in [
            ("::error::x", "\\u{3a}:error::x"),
            ("a\n  ::stop-commands::x", "a\n  \\u{3a}:stop-commands::x"),
            ("a ::error::x", "a ::error::x"),
            ("a ##[error]x", "a \\u{23}#[error]x"),
            ("##vso[task.complete]", "\\u{23}#vso[task.complete]"),
            ("###[x] ## x # [y]", "#\\u{23}#[x] ## x # [y]"),
        ] {
            assert_eq!(shown_lines(text), shown);
        }
        let long = ":#".repeat(500_000) + &":".repeat(500_000);
        assert!(shown_lines(&long).len() >= long.len());
    }

    #[test]
    fn long_values_and_messages_are_cut() {
        let value = "ä".repeat(1_000_000);
        let message = format!("t.csv:2: `{value}` is not a value for `phi`");
        let said = shorten_text(&message);
        assert!(said.chars().count() < 200, "{said}");
        assert!(said.ends_with("is not a value for `phi`"), "{said}");
        assert_eq!(shorten_text(&value).chars().count(), MOST_SAID + 1);
        assert_eq!(shorten_text("`short`"), "`short`");
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
