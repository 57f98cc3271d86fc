//! The texts of curves: substrings with their positions, and the labels of derivatives on an axis.

use super::rates::TIME;
use crate::scene::values::FormulaText;
use std::ops::Range;

/// A substring with its position.
pub(super) fn text_part(text: &FormulaText, range: Range<usize>) -> FormulaText {
    // A text with escapes has no byte-for-byte positions; the position of the whole is used.
    let has_places = text.offset != text.span.start && !text.is_outside();
    let skipped = text.text[range.clone()].len() - text.text[range.clone()].trim_start().len();
    let offset = if has_places {
        text.offset + range.start + skipped
    } else {
        text.offset
    };
    FormulaText {
        text: text.text[range].trim().to_owned(),
        offset,
        span: text.span.clone(),
        is_unread: false,
    }
}

/// `d²h/dphi²`.
pub(super) fn rate_label(quantity: &str, per: &str, order: usize) -> String {
    let is_name = quantity
        .chars()
        .all(|c| c.is_alphanumeric() || "._'".contains(c));
    let quantity = if is_name {
        quantity.to_owned()
    } else {
        format!("({quantity})")
    };
    let per = if TIME.contains(&per) { "t" } else { per };
    let power = ["", "²", "³", "⁴"]
        .get(order - 1)
        .map_or_else(|| format!("^{order}"), |p| (*p).to_owned());
    format!("d{power}{quantity}/d{per}{power}")
}
