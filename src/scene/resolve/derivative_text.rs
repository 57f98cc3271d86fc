//! How derivatives are written in the curves of plots: where `d(…)` stands in a formula, and what its parts are.

use crate::diag::{Diagnostic, Diagnostics};
use crate::model::plot::MAX_ORDER;
use crate::scene::values::FormulaText;
use std::ops::Range;

/// Names of the time on an axis.
pub(super) const TIME: [&str; 2] = ["time", "t"];

/// Order of a derivative.
pub(super) fn derivative_order(text: &FormulaText, diagnostics: &mut Diagnostics) -> Option<usize> {
    let order = text.text.trim().parse::<usize>().ok();
    let order = order.filter(|k| (1..=MAX_ORDER).contains(k));
    if order.is_none() {
        let message = format!("the order of a derivative is a whole number from 1 to {MAX_ORDER}");
        diagnostics.push(moved_diagnostic(Diagnostic::error(message), text));
    }
    order
}

/// The first `d(…)` of a formula, its parentheses included.
pub(super) fn derivative_range(text: &str) -> Option<Range<usize>> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let mut from = 0;
    loop {
        let start = from + text[from..].find('d')?;
        from = start + 1;
        let is_name = text[..start].chars().next_back().is_some_and(is_word);
        let behind = &text[from..];
        let opens = behind.trim_start().starts_with('(');
        if is_name || !opens {
            continue;
        }
        let mut depth = 0_usize;
        for (k, character) in behind.char_indices() {
            match character {
                '(' => depth += 1,
                ')' if depth == 1 => return Some(start..from + k + 1),
                ')' => depth = depth.saturating_sub(1),
                _ => {}
            }
        }
        return None;
    }
}

/// A name of this length for a derivative of a formula.
pub(super) fn placeholder_name(length: usize, index: usize) -> String {
    let digits = index.to_string();
    let line = length.saturating_sub(1 + digits.len());
    format!("d{}{digits}", "_".repeat(line))
}

/// The formulas between the parentheses of `d(…)`; `None` for another formula.
pub(super) fn derivative_parts(text: &FormulaText) -> Option<Vec<FormulaText>> {
    let trimmed = text.text.trim_end();
    let start = trimmed.len() - trimmed.trim_start().len();
    let inside = trimmed[start..].strip_prefix('d')?.trim_start();
    let inside = inside.strip_prefix('(')?;
    let first = trimmed.len() - inside.len();
    let (mut depth, mut cuts) = (1_usize, vec![first]);
    for (k, character) in inside.char_indices() {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 1 => cuts.push(first + k + 1),
            _ => {}
        }
        if depth == 0 {
            // Something behind the parenthesis makes it a formula, in which `d` is not known.
            let is_end = first + k + 1 == trimmed.len();
            cuts.push(first + k + 1);
            let ranges = cuts.windows(2).map(|w| text_part(text, w[0]..w[1] - 1));
            return is_end.then(|| ranges.collect());
        }
    }
    None
}

/// A part of a text, with its place.
pub(super) fn text_part(text: &FormulaText, range: Range<usize>) -> FormulaText {
    // A text with escapes has no byte-for-byte place, and keeps that of the whole.
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

/// Puts a message at a part of a text.
pub(super) fn moved_diagnostic(diagnostic: Diagnostic, text: &FormulaText) -> Diagnostic {
    if text.is_outside() {
        let message = format!(
            "in `{}`, which is not from the file: {}",
            text.text, diagnostic.message
        );
        return Diagnostic {
            message,
            ..diagnostic
        };
    }
    let span = if text.offset == text.span.start {
        text.span.clone()
    } else {
        text.offset..text.offset + text.text.len()
    };
    diagnostic.at(span)
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
