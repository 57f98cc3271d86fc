//! Parses single formulas and chains; errors are reported with their positions in the file.

use super::super::formula::chain::Item;
use super::super::formula::expansion::{Factor, expand_chain};
use super::super::formula::expression::parse_expression;
use super::super::formula::node::FormulaNode;
use super::super::reader::Spanned;
use super::super::values::FormulaText;
use crate::diag::{Diagnostic, Diagnostics};
use std::cell::Cell;
use std::collections::{HashMap, HashSet};

/// A name and its parsed value.
pub type Named<T> = (Spanned<String>, T);

/// Parses an expression and reports errors.
pub fn parsed_expression(text: &FormulaText, diagnostics: &mut Diagnostics) -> Option<FormulaNode> {
    note_diagnostic(parse_expression, text, diagnostics)
}

/// Most transforms of all chains of a scene together, counted as often as they are referred to: more than a text of the
/// largest size contains, fewer than would fill the memory.
const ALL_FACTORS: usize = 1_000_000;

/// The chains that can be referred to.
pub struct NamedChains {
    list: Vec<Named<Vec<Item>>>,
    places: HashMap<String, usize>,
    /// How many more transforms may be created.
    left: Cell<usize>,
}

impl NamedChains {
    /// Of two chains with the same name the first is used.
    pub fn new(list: Vec<Named<Vec<Item>>>) -> Self {
        let mut places = HashMap::new();
        for (place, (name, _)) in list.iter().enumerate() {
            places.entry(name.value.clone()).or_insert(place);
        }
        Self {
            list,
            places,
            left: Cell::new(ALL_FACTORS),
        }
    }

    /// Whether there is a chain of that name.
    pub fn holds(&self, name: &str) -> bool {
        self.places.contains_key(name)
    }

    fn find(&self, name: &str) -> Option<&[Item]> {
        let place = self.places.get(name)?;
        Some(&self.list[*place].1)
    }

    /// The factors of a chain, with references expanded.
    pub fn expand(&self, items: &[Item], diagnostics: &mut Diagnostics) -> Option<Vec<Factor>> {
        let factors = note_error(self.expanded(items), diagnostics)?;
        match self.left.get().checked_sub(factors.len()) {
            Some(left) => self.left.set(left),
            None => {
                diagnostics.push(Diagnostic::error(format!(
                    "the chains of the scene have more than {ALL_FACTORS} transforms together"
                )));
                return None;
            }
        }
        Some(factors)
    }

    fn expanded(&self, items: &[Item]) -> Result<Vec<Factor>, Diagnostic> {
        let names: Vec<&str> = self.list.iter().map(|(n, _)| n.value.as_str()).collect();
        expand_chain(items, &|name| self.find(name), &names)
    }

    /// Reports errors of chains that nothing refers to. The parts of a valid chain are valid.
    pub fn judge_all(&self, diagnostics: &mut Diagnostics) {
        let mut is_sound = vec![false; self.list.len()];
        let referred: HashSet<usize> = (0..self.list.len())
            .flat_map(|k| self.referred_by(k))
            .collect();
        for place in (0..self.list.len()).filter(|k| !referred.contains(k)) {
            if self.expanded(&self.list[place].1).is_ok() {
                self.mark(place, &mut is_sound);
            }
        }
        let left = (0..self.list.len()).filter(|k| !is_sound[*k]);
        for place in left.collect::<Vec<_>>() {
            let name = &self.list[place].0;
            let items = [Item::Reference(name.value.clone(), name.span.clone())];
            note_error(self.expanded(&items), diagnostics);
        }
    }

    /// Marks a chain and all chains that it refers to.
    fn mark(&self, place: usize, is_sound: &mut [bool]) {
        let mut open = vec![place];
        while let Some(place) = open.pop() {
            if !std::mem::replace(&mut is_sound[place], true) {
                open.extend(self.referred_by(place));
            }
        }
    }

    /// The chains that a chain refers to directly.
    fn referred_by(&self, place: usize) -> Vec<usize> {
        let mut names = Vec::new();
        self.list[place]
            .1
            .iter()
            .for_each(|item| item.add_references(&mut names));
        let places = names.into_iter().filter_map(|name| self.places.get(name));
        places.copied().collect()
    }
}

fn note_error<T>(result: Result<T, Diagnostic>, diagnostics: &mut Diagnostics) -> Option<T> {
    result
        .map_err(|diagnostic| diagnostics.push(diagnostic))
        .ok()
}

/// Parses a text: its value, or a message with its position in the file.
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
            // A text with escapes has no byte-for-byte positions; the message then covers the whole value.
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
