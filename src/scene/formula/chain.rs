//! Products of transforms as typed: `Tx(p) Rx(phi) T45 inv(T51)`.

use super::expression::Parser;
use super::lexer::{TokenKind, tokenize_text};
use super::node::FormulaNode;
use crate::diag::{Diagnostic, Span, name_hint};
use crate::model::chain::ElementaryMotion;

/// One factor as typed.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// An elementary transform and its arguments.
    Transform {
        /// Which one.
        transform: Transform,
        /// Its arguments, as many as the transform has.
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
    /// A chain that could not be read, which has been reported.
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

/// Parses a chain that starts at byte `offset` of the file. Factors are separated by spaces or `*`.
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
        return Err(parser.unexpected_token("fewer nested inverses"));
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
            return Err(parser.unexpected_token("a transform after `*`"));
        }
    }
    Ok(items)
}

fn parse_transform(parser: &mut Parser, name: &str, span: Span) -> Result<Item, Diagnostic> {
    let Some(transform) = Transform::from_name(name) else {
        let names = Transform::NAMES.iter().map(|(name, _)| *name);
        return Err(Diagnostic::error(format!("unknown transform `{name}`"))
            .at(span)
            .hint(name_hint(name, names.chain(["inv"]))));
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
