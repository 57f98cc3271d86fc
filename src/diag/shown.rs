//! Texts of files and numbers in printable form: short, without effect on terminals, logs and markup.

use std::borrow::Cow;

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
pub(super) const MOST_SAID: usize = 4000;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_break_a_document() {
        let text = xml_text("a<b & \"c\"'\u{0}\n>\u{fffe}");
        assert_eq!(text, "a&lt;b &amp; &quot;c&quot;&#39; &#10;&gt;\u{fffd}");
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
}
