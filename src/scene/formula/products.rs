//! The one length in a product that must be a length: in `Tx(R*phi)` with a known angle `phi` it can only be `R`. In `Tx(20*i*phi)`
//! it is the number.

use super::kinds::{DimensionOfName, dimension_of, visit_terms};
use super::node::{FormulaNode, NodeKind};
use crate::diag::Span;
use crate::model::dimension::PhysicalDimension;

/// Reports to `note` every name of which nothing is known and that must be a length, since `node` is one: the only such name in
/// its term, and nothing else there has a dimension but angles.
pub fn lengths_in_products(
    node: &FormulaNode,
    of_name: DimensionOfName,
    note: &mut dyn FnMut(&str, &Span),
) {
    visit_terms(node, &mut |term| {
        let mut product = Product {
            unknown: Vec::new(),
            is_clear: true,
            others: PhysicalDimension::NUMBER,
        };
        product.take(term, true, of_name);
        if let [name] = product.unknown[..]
            && product.is_clear
            && product.others.is_without_length()
            && let NodeKind::Name(text) = &name.kind
        {
            note(text, &name.span);
        }
    });
}

/// The factors of a term.
struct Product<'n> {
    /// Names above the fraction bar of which nothing is known.
    unknown: Vec<&'n FormulaNode>,
    /// Nothing unknown stands elsewhere, and no number above the fraction bar that may be the length.
    is_clear: bool,
    /// The dimension of all other factors.
    others: PhysicalDimension,
}

impl<'n> Product<'n> {
    fn take(&mut self, node: &'n FormulaNode, is_above: bool, of_name: DimensionOfName) {
        match &node.kind {
            NodeKind::Negate(inner) => self.take(inner, is_above, of_name),
            NodeKind::Binary('*', a, b) => {
                self.take(a, is_above, of_name);
                self.take(b, is_above, of_name);
            }
            NodeKind::Binary('/', a, b) => {
                self.take(a, is_above, of_name);
                self.take(b, !is_above, of_name);
            }
            NodeKind::Number(_) => self.is_clear &= !is_above,
            NodeKind::Name(name) if of_name(name).is_none() => match is_above {
                true => self.unknown.push(node),
                false => self.is_clear = false,
            },
            _ => {
                node.visit_names(&mut |name, _| self.is_clear &= of_name(name).is_some());
                let dimension = dimension_of(node, of_name);
                self.others = match is_above {
                    true => self.others + dimension,
                    false => self.others - dimension,
                };
            }
        }
    }
}
