//! The product of a chain with symbols for its names. Successive rotations about one axis are combined to the sum of
//! their angles, whatever translations are in between, so that planar chains stay as short as on a board.

use super::symbol::{AngleSum, SignedName, SymbolSum};
use crate::model::chain::ElementaryMotion;
use crate::model::notation::{WrittenChain, WrittenFactor};

/// Entries with more products than this are not written out.
const MOST_TERMS: usize = 48;

/// Rows of a product: rotation, and translation in the last column; the fourth row is 0 0 0 1.
#[derive(Clone, Debug, PartialEq)]
pub struct SymbolMatrix {
    /// `entries[row][column]`
    pub entries: [[SymbolSum; 4]; 3],
}

/// The product of the chain; `None` if an entry would be too long to read.
pub fn symbolic_product(chain: &WrittenChain) -> Option<SymbolMatrix> {
    let mut product = GrowingProduct::new();
    for factor in &chain.factors {
        product.take_factor(factor);
        if product.is_too_long() {
            return None;
        }
    }
    product.settle_turn();
    (!product.is_too_long()).then_some(SymbolMatrix {
        entries: product.entries,
    })
}

struct GrowingProduct {
    entries: [[SymbolSum; 4]; 3],
    /// A rotation about an axis that is not multiplied out yet.
    pending: Option<(usize, AngleSum)>,
}

impl GrowingProduct {
    fn new() -> Self {
        let unit =
            |row: usize| [0, 1, 2, 3].map(|k| SymbolSum::number(if k == row { 1.0 } else { 0.0 }));
        Self {
            entries: [0, 1, 2].map(unit),
            pending: None,
        }
    }

    fn is_too_long(&self) -> bool {
        self.entries
            .iter()
            .flatten()
            .any(|sum| sum.terms().len() > MOST_TERMS)
    }

    fn take_factor(&mut self, factor: &WrittenFactor) {
        match factor.motion {
            Some((ElementaryMotion::Rotation, axis)) if !factor.is_number() => {
                if self
                    .pending
                    .as_ref()
                    .is_some_and(|(known, _)| *known != axis)
                {
                    self.settle_turn();
                }
                let (_, angle) = self
                    .pending
                    .get_or_insert_with(|| (axis, AngleSum::default()));
                signed_names(factor).for_each(|name| angle.add(name));
            }
            Some((ElementaryMotion::Translation, axis)) => self.shift_by(axis, &length_of(factor)),
            // A rotation by a number, or to the direction of an axis.
            _ => self.turn_by_numbers(factor),
        }
    }

    /// Columns of the pending rotation, in terms of those of the product.
    fn turned_columns(&self) -> [[SymbolSum; 3]; 3] {
        let column = |k: usize| [0, 1, 2].map(|row| self.entries[row][k].clone());
        let mut columns = [0, 1, 2].map(column);
        if let Some((axis, angle)) = &self.pending {
            let [cos, sin] = SymbolSum::turn(angle);
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let minus = sin.scaled(-1.0);
            let mix = |a: &SymbolSum, x: &SymbolSum, b: &SymbolSum, y: &SymbolSum| {
                a.times(x).plus(&b.times(y))
            };
            let (a, b) = (columns[i].clone(), columns[j].clone());
            columns[i] = [0, 1, 2].map(|row| mix(&a[row], &cos, &b[row], &sin));
            columns[j] = [0, 1, 2].map(|row| mix(&a[row], &minus, &b[row], &cos));
        }
        columns
    }

    /// Multiplies out the pending rotation.
    fn settle_turn(&mut self) {
        let columns = self.turned_columns();
        self.pending = None;
        for (k, column) in columns.into_iter().enumerate() {
            for (row, entry) in column.into_iter().enumerate() {
                self.entries[row][k] = entry;
            }
        }
    }

    fn shift_by(&mut self, axis: usize, by: &SymbolSum) {
        let columns = self.turned_columns();
        for (row, entry) in self.entries.iter_mut().zip(&columns[axis]) {
            let own = std::mem::take(&mut row[3]);
            row[3] = own.plus(&entry.times(by));
        }
    }

    fn turn_by_numbers(&mut self, factor: &WrittenFactor) {
        self.settle_turn();
        let rotation = factor.pose(&[]).rotation;
        let old = self.turned_columns();
        for k in 0..3 {
            let by = rotation.col(k).to_array();
            for (row, entries) in self.entries.iter_mut().enumerate().take(3) {
                let parts = old
                    .iter()
                    .zip(by)
                    .map(|(column, share)| column[row].scaled(share));
                entries[k] = parts.fold(SymbolSum::default(), |sum, part| sum.plus(&part));
            }
        }
    }
}

fn signed_names(factor: &WrittenFactor) -> impl Iterator<Item = SignedName> + '_ {
    factor.terms.iter().map(|term| SignedName {
        text: term.text.clone(),
        argument: term.argument,
        count: if term.is_negative { -1 } else { 1 },
    })
}

/// A length as the sum of its names; a number if it has none.
fn length_of(factor: &WrittenFactor) -> SymbolSum {
    if factor.is_number() {
        return SymbolSum::number(factor.value(&[]));
    }
    signed_names(factor).fold(SymbolSum::default(), |sum, name| {
        sum.plus(&SymbolSum::length(name))
    })
}
