//! Converts single TOML values to formulas, colours and descriptions for messages.

use crate::diag::Span;
use toml::de::DeValue;

/// Offset of formulas that are not in the file, so that their positions are never shown.
const OUTSIDE: usize = usize::MAX / 2;

/// A number or formula as typed, to be parsed later.
#[derive(Clone, Debug, PartialEq)]
pub struct FormulaText {
    /// The text without quotes.
    pub text: String,
    /// Byte in the file at which the text starts.
    pub offset: usize,
    /// The whole value with its quotes.
    pub span: Span,
    /// The value is neither a number nor a text, which has been reported.
    pub is_unread: bool,
}

impl FormulaText {
    /// A formula that is not in the file.
    pub fn outside(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            offset: OUTSIDE,
            span: OUTSIDE..OUTSIDE + text.len(),
            is_unread: false,
        }
    }

    /// Whether it comes from no file, so that it has no position to show.
    pub const fn is_outside(&self) -> bool {
        self.offset >= OUTSIDE
    }
}

/// The texts of a list of numbers or strings.
pub fn formulas_of(value: &DeValue, text: &str) -> Option<Vec<FormulaText>> {
    value
        .as_array()?
        .iter()
        .map(|item| formula_of(item.get_ref(), item.span(), text))
        .collect()
}

/// The text of a number or string value, with the position at which it starts.
pub fn formula_of(value: &DeValue, span: Span, text: &str) -> Option<FormulaText> {
    match value {
        DeValue::Integer(_) | DeValue::Float(_) => {
            // Underscores are allowed in TOML only; signs and exponents have the same notation in both languages.
            let literal = text[span.clone()].replace('_', "");
            Some(FormulaText {
                text: literal,
                offset: span.start,
                span,
                is_unread: false,
            })
        }
        DeValue::String(s) => {
            // Escapes would shift the positions; in that case every message points at the whole text.
            let raw = &text[span.clone()];
            let offset = raw
                .find(s.as_ref())
                .filter(|o| *o > 0 && !s.is_empty())
                .map_or(span.start, |o| span.start + o);
            Some(FormulaText {
                text: s.to_string(),
                offset,
                span,
                is_unread: false,
            })
        }
        _ => None,
    }
}

/// A colour written `#rrggbb`.
pub fn parse_colour(text: &str) -> Option<[u8; 3]> {
    let hex = text
        .strip_prefix('#')
        .filter(|h| h.len() == 6 && h.is_ascii())?;
    let channel = |i: usize| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).ok();
    Some([channel(0)?, channel(1)?, channel(2)?])
}

/// The type of a value, in words.
pub fn kind_of(value: &DeValue) -> &'static str {
    match value {
        DeValue::String(_) => "a text",
        DeValue::Integer(_) => "an integer",
        DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}
