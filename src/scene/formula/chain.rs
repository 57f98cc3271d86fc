//! Products of transforms as typed: `Tx(p) Rx(phi) T45 inv(T51)`, and their expansion to elementary motions.

use super::expression::{FormulaNode, Parser};
use super::lexer::{TokenKind, tokenize_text};
use crate::diag::{Diagnostic, Span};
use crate::model::chain::ElementaryMotion;
use crate::numbers::constant::Constant;
use std::collections::HashSet;

/// One factor as typed.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// An elementary transform and its arguments.
    Transform {
        /// Which one.
        transform: Transform,
        /// As many as it takes.
        arguments: Vec<FormulaNode>,
        /// Where.
        span: Span,
    },
    /// The name of another chain.
    Reference(String, Span),
    /// `inv(...)`.
    Inverse(Vec<Item>),
    /// `E`, the identity.
    Identity,
    /// A chain that could not be read, which is said already.
    Broken,
}

/// The transforms of the notation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transform {
    /// `Tx` … `Rz`.
    Elementary(ElementaryMotion, usize),
    /// `T(x, y, z)`.
    Translation,
    /// `R(ux, uy, uz, angle)`: rotation about a constant axis.
    AxisRotation,
    /// `Hx(pitch, angle)` …: screw about a coordinate axis, pitch is the advance of one turn.
    Screw(usize),
}

impl Transform {
    const NAMES: [(&'static str, Self); 11] = [
        ("Tx", Self::Elementary(ElementaryMotion::Translation, 0)),
        ("Ty", Self::Elementary(ElementaryMotion::Translation, 1)),
        ("Tz", Self::Elementary(ElementaryMotion::Translation, 2)),
        ("Rx", Self::Elementary(ElementaryMotion::Rotation, 0)),
        ("Ry", Self::Elementary(ElementaryMotion::Rotation, 1)),
        ("Rz", Self::Elementary(ElementaryMotion::Rotation, 2)),
        ("T", Self::Translation),
        ("R", Self::AxisRotation),
        ("Hx", Self::Screw(0)),
        ("Hy", Self::Screw(1)),
        ("Hz", Self::Screw(2)),
    ];

    fn from_name(name: &str) -> Option<Self> {
        Self::NAMES
            .iter()
            .find(|(n, _)| *n == name)
            .map(|(_, t)| *t)
    }

    fn argument_names(self) -> &'static [&'static str] {
        match self {
            Self::Elementary(ElementaryMotion::Translation, _) => &["length"],
            Self::Elementary(ElementaryMotion::Rotation, _) => &["angle"],
            Self::Translation => &["x", "y", "z"],
            Self::AxisRotation => &["ux", "uy", "uz", "angle"],
            Self::Screw(_) => &["pitch", "angle"],
        }
    }
}

/// Parses a chain that starts at byte `offset` of the file. Factors stand side by side or with `*` between.
pub fn parse_chain(text: &str, offset: usize) -> Result<Vec<Item>, Diagnostic> {
    let tokens = tokenize_text(text, offset)?;
    let mut parser = Parser::new(&tokens);
    let items = parse_product(&mut parser, 0)?;
    parser.expect_end()?;
    if items.is_empty() {
        return Err(Diagnostic::error("empty chain")
            .at(offset..offset + text.len())
            .hint("write `E` for the identity"));
    }
    Ok(items)
}

/// Deepest nesting of `inv(inv(...))`.
const MAX_NESTING: usize = 50;

fn parse_product(parser: &mut Parser, depth: usize) -> Result<Vec<Item>, Diagnostic> {
    let mut items = Vec::new();
    if depth > MAX_NESTING {
        return Err(parser.unexpected("fewer nested inverses"));
    }
    while let TokenKind::Name(name) = &parser.peek().kind {
        let span = parser.take().span.clone();
        let called = parser.take_sign('(');
        items.push(match (name.as_str(), called) {
            ("inv", true) => {
                let inner = parse_product(parser, depth + 1)?;
                parser.expect_sign(')')?;
                Item::Inverse(inner)
            }
            ("E", false) => Item::Identity,
            (_, true) => parse_transform(parser, name, span)?,
            (_, false) => Item::Reference(name.clone(), span),
        });
        if parser.take_sign('*') && !matches!(parser.peek().kind, TokenKind::Name(_)) {
            return Err(parser.unexpected("a transform after `*`"));
        }
    }
    Ok(items)
}

fn parse_transform(parser: &mut Parser, name: &str, span: Span) -> Result<Item, Diagnostic> {
    let Some(transform) = Transform::from_name(name) else {
        return Err(Diagnostic::error(format!("unknown transform `{name}`"))
            .at(span)
            .suggest(name, Transform::NAMES.iter().map(|(n, _)| *n))
            .hint("known: Tx Ty Tz Rx Ry Rz T(x,y,z) R(ux,uy,uz,angle) Hx Hy Hz(pitch,angle) inv(chain)"));
    };
    parser.restart_count();
    let mut arguments = vec![parser.expression()?];
    while parser.take_sign(',') {
        arguments.push(parser.expression()?);
    }
    let span = span.start..parser.peek().span.end;
    parser.expect_sign(')')?;
    let wanted = transform.argument_names();
    if arguments.len() != wanted.len() {
        return Err(Diagnostic::error(format!(
            "`{name}` takes ({}), found {} arguments",
            wanted.join(", "),
            arguments.len()
        ))
        .at(span));
    }
    Ok(Item::Transform {
        transform,
        arguments,
        span,
    })
}

/// An elementary motion after expansion.
#[derive(Clone, Debug, PartialEq)]
pub enum Factor {
    /// About or along a coordinate axis.
    Elementary(ElementaryMotion, usize, FormulaNode),
    /// Turns z to the constant direction (or back): the frame of a general axis.
    Direction([FormulaNode; 3], bool),
}

impl Factor {
    /// The motion backwards.
    pub fn inverse(self) -> Self {
        match self {
            Self::Elementary(motion, axis, node) => Self::Elementary(motion, axis, node.negated()),
            Self::Direction(direction, back) => Self::Direction(direction, !back),
        }
    }

    /// Where its value, or its direction, stands in the file.
    pub fn place(&self) -> Span {
        match self {
            Self::Elementary(_, _, node) => node.span.clone(),
            Self::Direction([x, _, z], _) => x.span.start..z.span.end,
        }
    }

    /// Whether the same is written, wherever it stands.
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

    /// Whether the factors cancel side by side.
    pub fn undoes(&self, other: &Self) -> bool {
        self.clone().inverse().is_alike(other) || self.is_alike(&other.clone().inverse())
    }
}

impl Item {
    /// Adds the names of the chains that the item refers to.
    pub fn add_references<'a>(&'a self, names: &mut Vec<&'a str>) {
        match self {
            Self::Reference(name, _) => names.push(name),
            Self::Inverse(inner) => inner.iter().for_each(|item| item.add_references(names)),
            Self::Identity | Self::Broken | Self::Transform { .. } => {}
        }
    }
}

/// Longest chain after expansion; references that multiply each other would otherwise fill the memory.
pub const MAX_FACTORS: usize = 20_000;

/// Most chains of which each refers to the next: every one takes half a kilobyte of the stack.
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
    /// Names being expanded, each with the place of the reference to it.
    open: Vec<(&'a str, Span)>,
    /// The same names, found without a walk.
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
            return Err(self.circle(first, span));
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
    /// The message about a circle of references from the open chain `first` on, closed at `span`. It starts at the
    /// chain that is defined first, so that the circle gives one message wherever it is entered.
    fn circle(&self, first: usize, span: &Span) -> Diagnostic {
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
    use super::expression::NodeKind::{Angle, Binary, Radians};
    let span = pitch.span.start..angle.span.end;
    let turn = FormulaNode {
        kind: Radians(Constant::PI * Constant::exact(2.0)),
        span: span.clone(),
    };
    let angle = FormulaNode {
        kind: Angle(Box::new(angle)),
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
        use super::super::expression::NodeKind;
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
