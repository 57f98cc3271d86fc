//! Single formulas and chains parsed; what is wrong with them is noted at its place in the file.

use super::super::formula::chain::{Factor, Item, expand_chain};
use super::super::formula::expression::{FormulaNode, parse_expression};
use super::super::reader::Spanned;
use super::super::values::FormulaText;
use crate::diag::{Diagnostic, Diagnostics};

/// A name and what was parsed for it.
pub type Named<T> = (Spanned<String>, T);

/// Parses an expression, noting what is wrong with it.
pub fn parsed_expression(text: &FormulaText, diagnostics: &mut Diagnostics) -> Option<FormulaNode> {
    note_diagnostic(parse_expression, text, diagnostics)
}

/// The factors of a chain, in which references to `chains` are followed.
pub fn expand_items(
    items: &[Item],
    chains: &[Named<Vec<Item>>],
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Factor>> {
    let names: Vec<&str> = chains.iter().map(|(name, _)| name.value.as_str()).collect();
    let find = |wanted: &str| {
        chains
            .iter()
            .find(|(name, _)| name.value == wanted)
            .map(|(_, items)| items.as_slice())
    };
    match expand_chain(items, &find, &names) {
        Ok(factors) => Some(factors),
        Err(diagnostic) => {
            diagnostics.push(diagnostic);
            None
        }
    }
}

/// Parses a text: its value, or the message with its place inside the file.
pub fn note_diagnostic<T>(
    parse: impl Fn(&str, usize) -> Result<T, Diagnostic>,
    text: &FormulaText,
    diagnostics: &mut Diagnostics,
) -> Option<T> {
    if text.is_unread {
        return None;
    }
    match parse(&text.text, text.offset) {
        Ok(value) => Some(value),
        Err(mut diagnostic) => {
            // A text with escapes has no byte-for-byte place; the message then covers the whole value.
            if text.offset == text.span.start
                && !text.is_outside()
                && text.span.len() != text.text.len()
            {
                diagnostic.span = Some(text.span.clone());
            }
            if text.is_outside() {
                diagnostic.message = format!(
                    "in `{}`, which is not from the file: {}",
                    text.text, diagnostic.message
                );
            }
            diagnostics.push(diagnostic);
            None
        }
    }
}
