//! Expands chains: references and inverses become elementary motions.

use super::chain::{Item, Transform};
use super::node::FormulaNode;
use crate::diag::{Diagnostic, Span};
use crate::model::chain::ElementaryMotion;
use crate::model::mechanism::Kind;
use crate::numbers::constant::Constant;
use std::collections::HashSet;

/// An elementary motion after expansion.
#[derive(Clone, Debug, PartialEq)]
pub enum Factor {
    /// About or along a coordinate axis.
    Elementary(ElementaryMotion, usize, FormulaNode),
    /// Rotates z to the constant direction (or back): the frame of a general axis.
    Direction([FormulaNode; 3], bool),
}

impl Factor {
    /// The inverse motion.
    pub fn inverse(self) -> Self {
        match self {
            Self::Elementary(motion, axis, node) => Self::Elementary(motion, axis, node.negated()),
            Self::Direction(direction, back) => Self::Direction(direction, !back),
        }
    }

    /// The position of its argument, or of its direction, in the file.
    pub fn place(&self) -> Span {
        match self {
            Self::Elementary(_, _, node) => node.span.clone(),
            Self::Direction([x, _, z], _) => x.span.start..z.span.end,
        }
    }

    /// Whether both are written alike, wherever they are written.
    pub fn is_alike(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Elementary(motion, axis, node), Self::Elementary(m, a, n)) => {
                motion == m && axis == a && node.is_alike(n)
            }
            (Self::Direction(direction, back), Self::Direction(d, b)) => {
                back == b && direction.iter().zip(d).all(|(a, b)| a.is_alike(b))
            }
            _ => false,
        }
    }

    /// Whether two adjacent factors cancel.
    pub fn undoes_factor(&self, other: &Self) -> bool {
        self.clone().inverse().is_alike(other) || self.is_alike(&other.clone().inverse())
    }
}

/// Longest chain after expansion; without a limit, references to references could fill the memory.
pub const MAX_FACTORS: usize = 20_000;

/// Longest sequence of chains that refer to each other: each level takes half a kilobyte of the stack.
const MAX_REFERENCES: usize = 1000;

/// Expands references and inverses. `find` gives the items of a named chain.
pub fn expand_chain<'a>(
    items: &'a [Item],
    find: &dyn Fn(&str) -> Option<&'a [Item]>,
    names: &[&str],
) -> Result<Vec<Factor>, Diagnostic> {
    let mut expansion = Expansion {
        find,
        names,
        open: Vec::new(),
        is_open: HashSet::new(),
        factors: Vec::new(),
    };
    expansion.items(items, false)?;
    Ok(expansion.factors)
}

struct Expansion<'a, 'b> {
    find: &'b dyn Fn(&str) -> Option<&'a [Item]>,
    names: &'b [&'b str],
    /// Names being expanded, each with the position of the reference to it.
    open: Vec<(&'a str, Span)>,
    /// The same names as a set, for fast lookup.
    is_open: HashSet<&'a str>,
    factors: Vec<Factor>,
}

impl<'a> Expansion<'a, '_> {
    fn items(&mut self, items: &'a [Item], inverted: bool) -> Result<(), Diagnostic> {
        if inverted {
            items
                .iter()
                .rev()
                .try_for_each(|item| self.item(item, true))
        } else {
            items.iter().try_for_each(|item| self.item(item, false))
        }
    }

    fn item(&mut self, item: &'a Item, inverted: bool) -> Result<(), Diagnostic> {
        match item {
            Item::Identity => Ok(()),
            Item::Broken => Err(Diagnostic::inherited()),
            Item::Inverse(inner) => self.items(inner, !inverted),
            Item::Reference(name, span) => self.reference(name, span, inverted),
            Item::Transform {
                transform,
                arguments,
                span,
            } => {
                let mut factors = elementary_factors(*transform, arguments);
                if inverted {
                    factors = factors.into_iter().rev().map(Factor::inverse).collect();
                }
                self.factors.extend(factors);
                if self.factors.len() > MAX_FACTORS {
                    return Err(Diagnostic::error(format!(
                        "chain has more than {MAX_FACTORS} transforms"
                    ))
                    .at(span.clone()));
                }
                Ok(())
            }
        }
    }

    fn reference(&mut self, name: &'a str, span: &Span, inverted: bool) -> Result<(), Diagnostic> {
        let Some(items) = (self.find)(name) else {
            let others = self.names.iter().copied();
            let others = others.filter(|other| self.open.iter().all(|(open, _)| open != other));
            return Err(Diagnostic::error(format!("there is no chain `{name}`"))
                .at(span.clone())
                .suggest(name, others)
                .hint("a transform has parentheses: `Rx(phi)`; a name alone is a chain"));
        };
        if self.is_open.contains(name)
            && let Some(first) = self.open.iter().position(|(open, _)| *open == name)
        {
            return Err(self.circular_reference(first, span));
        }
        if self.open.len() >= MAX_REFERENCES {
            let message = format!("chains that refer to chains more than {MAX_REFERENCES} deep");
            return Err(Diagnostic::error(message).at(span.clone()));
        }
        self.open.push((name, span.clone()));
        self.is_open.insert(name);
        self.items(items, inverted)?;
        self.open.pop();
        self.is_open.remove(name);
        Ok(())
    }
}

impl Expansion<'_, '_> {
    /// The message about a cycle of references from the open chain `first`, closed at `span`. It starts at the chain
    /// that is defined first, so that every cycle is reported once, wherever it is entered.
    fn circular_reference(&self, first: usize, span: &Span) -> Diagnostic {
        let mut circle = self.open[first..].to_vec();
        circle[0].1 = span.clone();
        let defined = |name: &str| self.names.iter().position(|n| *n == name);
        let start = (0..circle.len()).min_by_key(|k| defined(circle[*k].0));
        circle.rotate_left(start.unwrap_or(0));
        let (name, place) = circle[0].clone();
        let mut message = format!("chain `{name}` contains itself");
        if circle.len() > 1 {
            let through: Vec<&str> = circle[1..].iter().map(|(name, _)| *name).collect();
            message.push_str(&format!(", through {}", through.join(", ")));
        }
        Diagnostic::error(message).at(place)
    }
}

fn elementary_factors(transform: Transform, arguments: &[FormulaNode]) -> Vec<Factor> {
    let arg = |i: usize| arguments[i].clone();
    match transform {
        Transform::Elementary(motion, axis) => vec![Factor::Elementary(motion, axis, arg(0))],
        Transform::Translation => (0..3)
            .map(|axis| Factor::Elementary(ElementaryMotion::Translation, axis, arg(axis)))
            .collect(),
        Transform::AxisRotation => {
            let direction = [arg(0), arg(1), arg(2)];
            vec![
                Factor::Direction(direction.clone(), false),
                Factor::Elementary(ElementaryMotion::Rotation, 2, arg(3)),
                Factor::Direction(direction, true),
            ]
        }
        Transform::Screw(axis) => vec![
            Factor::Elementary(ElementaryMotion::Rotation, axis, arg(1)),
            Factor::Elementary(
                ElementaryMotion::Translation,
                axis,
                screw_advance(arg(0), arg(1)),
            ),
        ],
    }
}

/// pitch·angle/2π.
fn screw_advance(pitch: FormulaNode, angle: FormulaNode) -> FormulaNode {
    use super::node::NodeKind::{Binary, Of, Radians};
    let span = pitch.span.start..angle.span.end;
    let turn = FormulaNode {
        kind: Radians(Constant::PI * Constant::exact(2.0)),
        span: span.clone(),
    };
    let angle = FormulaNode {
        kind: Of(Some(Kind::Angle), Box::new(angle)),
        span: span.clone(),
    };
    let turns = FormulaNode {
        kind: Binary('/', Box::new(angle), Box::new(turn)),
        span: span.clone(),
    };
    FormulaNode {
        kind: Binary('*', Box::new(pitch), Box::new(turns)),
        span,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::chain::parse_chain;
    use super::*;

    fn expand_text(text: &str) -> Result<Vec<Factor>, Diagnostic> {
        let chains = [
            ("A", parse_chain("Tx(1) Rz(a)", 0).unwrap()),
            ("B", parse_chain("A Ty(2)", 0).unwrap()),
            ("C", parse_chain("C A", 0).unwrap()),
        ];
        let items = parse_chain(text, 0)?;
        let find = |name: &str| {
            chains
                .iter()
                .find(|(n, _)| *n == name)
                .map(|(_, i)| i.as_slice())
        };
        expand_chain(&items, &find, &["A", "B", "C"])
    }

    #[test]
    fn inverse_reverses_and_negates() {
        let factors = expand_text("inv(B)").unwrap();
        let shapes: Vec<_> = factors
            .iter()
            .map(|f| match f {
                Factor::Elementary(m, axis, node) => (*m, *axis, node.kind.clone()),
                Factor::Direction(..) => unreachable!(),
            })
            .collect();
        use super::super::node::NodeKind;
        assert_eq!(
            shapes[0],
            (
                ElementaryMotion::Translation,
                1,
                NodeKind::Number(Constant::exact(-2.0))
            )
        );
        assert!(matches!(
            shapes[1],
            (ElementaryMotion::Rotation, 2, NodeKind::Negate(_))
        ));
        assert_eq!(
            shapes[2],
            (
                ElementaryMotion::Translation,
                0,
                NodeKind::Number(Constant::exact(-1.0))
            )
        );
        assert_eq!(expand_text("inv(inv(B))"), expand_text("B"));
    }

    #[test]
    fn mistakes_are_named() {
        assert!(
            expand_text("D")
                .unwrap_err()
                .message
                .contains("no chain `D`")
        );
        assert!(
            expand_text("C")
                .unwrap_err()
                .message
                .contains("contains itself")
        );
        assert!(
            expand_text("Rq(1)")
                .unwrap_err()
                .message
                .contains("unknown transform")
        );
        assert!(
            expand_text("Tx(1, 2)")
                .unwrap_err()
                .message
                .contains("takes (length)")
        );
        assert!(
            expand_text("Tx(1) +")
                .unwrap_err()
                .message
                .contains("expected the end")
        );
        assert!(expand_text("").unwrap_err().message.contains("empty chain"));
    }
}
