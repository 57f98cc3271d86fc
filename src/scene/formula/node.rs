//! Expression trees as typed: numbers, names, operations, calls. They have neither values nor kinds yet.

use crate::diag::Span;
use crate::model::expression::Function;
use crate::model::mechanism::Kind;
use crate::numbers::constant::Constant;

/// A node and its position in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct FormulaNode {
    /// What it is.
    pub kind: NodeKind,
    /// Where it is.
    pub span: Span,
}

/// The kinds of nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum NodeKind {
    /// A literal.
    Number(Constant),
    /// A literal with an explicit angle unit, already in radians.
    Radians(Constant),
    /// A part whose kind, or that it has none, does not depend on what surrounds it.
    Of(Option<Kind>, Box<FormulaNode>),
    /// A name, to be looked up.
    Name(String),
    /// Sign change.
    Negate(Box<FormulaNode>),
    /// One of `+ - * / ^`.
    Binary(char, Box<FormulaNode>, Box<FormulaNode>),
    /// A function and its arguments.
    Call(Function, Vec<FormulaNode>),
    /// `d(formula, input)` or `d(formula, input, order)`.
    Derivative(Box<DerivativeNode>),
}

/// The parts of a derivative.
#[derive(Clone, Debug, PartialEq)]
pub struct DerivativeNode {
    /// What is derived.
    pub of: FormulaNode,
    /// The variable: an input, or the time.
    pub by: String,
    /// Where that stands.
    pub by_span: Span,
    /// The order, one or more.
    pub order: usize,
}

impl FormulaNode {
    /// A literal without a position of its own.
    pub fn number(value: Constant, span: Span) -> Self {
        Self {
            kind: NodeKind::Number(value),
            span,
        }
    }

    /// The negative of this node.
    pub fn negated(self) -> Self {
        let span = self.span.clone();
        match self.kind {
            NodeKind::Number(v) => Self {
                kind: NodeKind::Number(-v),
                span,
            },
            NodeKind::Negate(inner) => *inner,
            kind => Self {
                kind: NodeKind::Negate(Box::new(Self {
                    kind,
                    span: span.clone(),
                })),
                span,
            },
        }
    }

    /// Whether both are written alike, wherever they are written.
    pub fn is_alike(&self, other: &Self) -> bool {
        use NodeKind::{Binary, Call, Derivative, Name, Negate, Number, Of, Radians};
        match (&self.kind, &other.kind) {
            (Number(a), Number(b)) | (Radians(a), Radians(b)) => a == b,
            (Name(a), Name(b)) => a == b,
            (Negate(a), Negate(b)) => a.is_alike(b),
            (Of(kind, a), Of(other, b)) => kind == other && a.is_alike(b),
            (Binary(sign, a, b), Binary(other, c, d)) => {
                sign == other && a.is_alike(c) && b.is_alike(d)
            }
            (Call(function, a), Call(other, b)) => {
                function == other
                    && a.len() == b.len()
                    && a.iter().zip(b).all(|(a, b)| a.is_alike(b))
            }
            (Derivative(a), Derivative(b)) => {
                a.of.is_alike(&b.of) && (&a.by, a.order) == (&b.by, b.order)
            }
            _ => false,
        }
    }

    /// Calls `visit` on every name below this node.
    pub fn visit_names(&self, visit: &mut dyn FnMut(&str, &Span)) {
        match &self.kind {
            NodeKind::Number(_) | NodeKind::Radians(_) => {}
            NodeKind::Name(name) => visit(name, &self.span),
            NodeKind::Negate(inner) | NodeKind::Of(_, inner) => inner.visit_names(visit),
            NodeKind::Binary(_, a, b) => {
                a.visit_names(visit);
                b.visit_names(visit);
            }
            NodeKind::Call(_, args) => args.iter().for_each(|a| a.visit_names(visit)),
            NodeKind::Derivative(parts) => parts.of.visit_names(visit),
        }
    }
}
