//! Single TOML values as formulas, colours and words for messages.

use crate::diag::Span;
use toml::de::DeValue;

/// Offset given to formulas that are not in the file, so that their places are never shown.
const OUTSIDE: usize = usize::MAX / 2;

/// A number or formula as typed, to be parsed later.
#[derive(Clone, Debug, PartialEq)]
pub struct FormulaText {
    /// The text without quotes.
    pub text: String,
    /// Byte in the file where the text starts.
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

    /// Whether it is in no file, so that it has no place to be shown.
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

/// The text of a number or string value, with the place where it starts.
pub fn formula_of(value: &DeValue, span: Span, text: &str) -> Option<FormulaText> {
    match value {
        DeValue::Integer(_) | DeValue::Float(_) => {
            // Underscores are TOML's; signs and exponents are the same in both notations.
            let literal = text[span.clone()].replace('_', "");
            Some(FormulaText {
                text: literal,
                offset: span.start,
                span,
                is_unread: false,
            })
        }
        DeValue::String(s) => {
            // Escapes would shift the places; then every message points at the whole text.
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

/// What a value is, in words.
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
