//! The parser of formulas: from tokens to expression trees.

use super::advice;
use super::lexer::{Token, TokenKind, tokenize_text};
use super::node::{DerivativeNode, FormulaNode, NodeKind};
use crate::diag::{Diagnostic, Span};
use crate::model::expression::Function;
use crate::model::mechanism::AngleUnit;
use crate::model::rate::MAX_ORDER;
use crate::numbers::constant::Constant;

/// Parses a whole expression that starts at byte `offset` of the file.
pub fn parse_expression(text: &str, offset: usize) -> Result<FormulaNode, Diagnostic> {
    let tokens = tokenize_text(text, offset)?;
    let mut parser = Parser::new(&tokens);
    let node = parser.expression()?;
    parser.expect_end()?;
    Ok(node)
}

/// Deepest nesting of parentheses and signs; keeps hostile input off the call stack.
const MAX_DEPTH: usize = 100;

/// Most operations in one expression. The tree of a long sum is as deep as the sum is long, and tree traversals are
/// recursive.
const MAX_OPERATIONS: usize = 2000;

/// Reads tokens one after the other; shared with the chain parser.
pub struct Parser<'a> {
    tokens: &'a [Token],
    next: usize,
    depth: usize,
    operations: usize,
}

impl<'a> Parser<'a> {
    /// Starts at the first of `tokens`; the last token is `End`.
    pub fn new(tokens: &'a [Token]) -> Self {
        Self {
            tokens,
            next: 0,
            depth: 0,
            operations: 0,
        }
    }

    /// The next token.
    pub fn peek(&self) -> &'a Token {
        &self.tokens[self.next.min(self.tokens.len() - 1)]
    }

    /// Consumes one token.
    pub fn take(&mut self) -> &'a Token {
        let token = self.peek();
        self.next += 1;
        token
    }

    /// Consumes `sign` if it is next.
    pub fn take_sign(&mut self, sign: char) -> bool {
        let found = self.peek().kind == TokenKind::Sign(sign);
        self.next += found as usize;
        found
    }

    /// Consumes `sign`, or reports that it is missing.
    pub fn expect_sign(&mut self, sign: char) -> Result<(), Diagnostic> {
        if self.take_sign(sign) {
            Ok(())
        } else {
            Err(self.unexpected_token(&format!("`{sign}`")))
        }
    }

    /// Reports tokens that are left over.
    pub fn expect_end(&self) -> Result<(), Diagnostic> {
        if self.peek().kind == TokenKind::End {
            Ok(())
        } else {
            Err(self.unexpected_token("the end of the formula"))
        }
    }

    /// The message that something other than `wanted` was found.
    pub fn unexpected_token(&self, wanted: &str) -> Diagnostic {
        let token = self.peek();
        let found = match &token.kind {
            TokenKind::Number(v) => format!("the number {}", v.number()),
            TokenKind::Name(name) => format!("`{name}`"),
            TokenKind::Sign(c) => format!("`{c}`"),
            TokenKind::End => "the end of the formula".to_owned(),
        };
        let diagnostic = Diagnostic::error(format!("expected {wanted}, found {found}"));
        let diagnostic = diagnostic.at(token.span.clone());
        let before = self.next.checked_sub(1).and_then(|k| self.tokens.get(k));
        match before.and_then(|before| advice::of_neighbours(before, token)) {
            Some(hint) => diagnostic.hint(hint),
            None => diagnostic,
        }
    }

    /// Counts one level and one operation against the limits.
    fn enter_nesting(&mut self) -> Result<(), Diagnostic> {
        self.depth += 1;
        self.operations += 1;
        if self.depth > MAX_DEPTH || self.operations > MAX_OPERATIONS {
            let what = if self.depth > MAX_DEPTH {
                "nested too deeply"
            } else {
                "too long"
            };
            return Err(
                Diagnostic::error(format!("formula is {what}")).at(self.peek().span.clone())
            );
        }
        Ok(())
    }

    /// Resets the count of operations for a new expression; a chain contains many short ones.
    pub fn restart_count(&mut self) {
        self.operations = 0;
    }

    /// sum := term (('+'|'-') term)*
    pub fn expression(&mut self) -> Result<FormulaNode, Diagnostic> {
        self.enter_nesting()?;
        let mut left = self.term()?;
        while let TokenKind::Sign(sign @ ('+' | '-')) = self.peek().kind {
            self.take();
            left = binary_node(sign, left, self.term()?);
        }
        self.depth -= 1;
        Ok(left)
    }

    /// term := factor (('*'|'/') factor)*
    fn term(&mut self) -> Result<FormulaNode, Diagnostic> {
        let mut left = self.factor()?;
        while let TokenKind::Sign(sign @ ('*' | '/')) = self.peek().kind {
            self.take();
            left = binary_node(sign, left, self.factor()?);
        }
        Ok(left)
    }

    /// factor := ('-'|'+') factor | atom ('^' factor)?
    fn factor(&mut self) -> Result<FormulaNode, Diagnostic> {
        self.enter_nesting()?;
        let start = self.peek().span.start;
        let node = if self.take_sign('-') {
            let inner = self.factor()?;
            let end = inner.span.end;
            let mut node = inner.negated();
            node.span = start..end;
            node
        } else if self.take_sign('+') {
            self.factor()?
        } else {
            let base = self.parse_atom()?;
            if self.take_sign('^') {
                binary_node('^', base, self.factor()?)
            } else {
                base
            }
        };
        self.depth -= 1;
        Ok(node)
    }

    fn parse_atom(&mut self) -> Result<FormulaNode, Diagnostic> {
        let token = self.peek();
        match &token.kind {
            TokenKind::Number(value) => {
                self.take();
                Ok(self.with_unit(*value, token.span.clone()))
            }
            TokenKind::Name(name) => {
                self.take();
                if self.take_sign('(') {
                    self.parse_call(name, token)
                } else {
                    named_constant(name, token)
                }
            }
            TokenKind::Sign('(') => {
                self.take();
                let inner = self.expression()?;
                self.expect_sign(')')?;
                Ok(inner)
            }
            _ => Err(self.unexpected_token("a number, a name or `(`")),
        }
    }

    /// `30deg` and `0.5rad`: a unit that directly follows a number belongs to it.
    fn with_unit(&mut self, value: Constant, span: Span) -> FormulaNode {
        let unit = self.peek();
        let factor = match &unit.kind {
            TokenKind::Name(name) if unit.span.start == span.end => AngleUnit::from_name(name),
            _ => None,
        };
        match factor {
            Some(unit) => {
                let end = self.take().span.end;
                FormulaNode {
                    kind: NodeKind::Radians(value * unit.radians),
                    span: span.start..end,
                }
            }
            None => FormulaNode::number(value, span),
        }
    }

    /// The parts of `d(…)` after its opening parenthesis.
    fn parse_derivative(&mut self, token: &Token) -> Result<FormulaNode, Diagnostic> {
        let start = token.span.start;
        let of = self.expression()?;
        if !self.take_sign(',') {
            return Err(misread_derivative(start..self.peek().span.end));
        }
        let by = self.peek();
        let TokenKind::Name(name) = &by.kind else {
            return Err(misread_derivative(start..by.span.end));
        };
        self.take();
        let order = match self.take_sign(',') {
            true => self.derivative_order()?,
            false => 1,
        };
        if self.peek().kind == TokenKind::Sign(',') {
            return Err(misread_derivative(start..self.peek().span.end));
        }
        let span = start..self.peek().span.end;
        self.expect_sign(')')?;
        let parts = DerivativeNode {
            of,
            by: name.clone(),
            by_span: by.span.clone(),
            order,
        };
        Ok(FormulaNode {
            kind: NodeKind::Derivative(Box::new(parts)),
            span,
        })
    }

    fn derivative_order(&mut self) -> Result<usize, Diagnostic> {
        let token = self.take();
        let given = match token.kind {
            TokenKind::Number(value) => Some(value.number()),
            _ => None,
        };
        let known = |order: &f64| order.fract() == 0.0 && (1.0..=MAX_ORDER as f64).contains(order);
        given
            .filter(known)
            .map(|order| order as usize)
            .ok_or_else(|| {
                let message =
                    format!("the order of a derivative is a whole number from 1 to {MAX_ORDER}");
                Diagnostic::error(message).at(token.span.clone())
            })
    }

    fn parse_call(&mut self, name: &str, token: &Token) -> Result<FormulaNode, Diagnostic> {
        if name == "d" {
            return self.parse_derivative(token);
        }
        let Some(function) = Function::from_name(name) else {
            return Err(Diagnostic::error(format!("unknown function `{name}`"))
                .at(token.span.clone())
                .suggest(name, Function::ALL.iter().map(|f| f.name()))
                .hint("a product is written with `*`: a name before `(` is always a function"));
        };
        let mut args = vec![self.expression()?];
        while self.take_sign(',') {
            args.push(self.expression()?);
        }
        let span = token.span.start..self.peek().span.end;
        self.expect_sign(')')?;
        if !function.accepts(args.len()) {
            return Err(Diagnostic::error(format!(
                "`{name}` takes {}, found {}",
                function.arity_text(),
                args.len()
            ))
            .at(span));
        }
        Ok(FormulaNode {
            kind: NodeKind::Call(function, args),
            span,
        })
    }
}

/// The message about a `d(…)` that is not a derivative.
fn misread_derivative(span: Span) -> Diagnostic {
    Diagnostic::error("a derivative is written `d(quantity, input)`")
        .at(span)
        .hint("or `d(quantity, input, order)`; `t` in place of an input is the time")
}

fn named_constant(name: &str, token: &Token) -> Result<FormulaNode, Diagnostic> {
    // TOML reads these words as numbers, so they can appear in a formula.
    if ["nan", "inf"].contains(&name) {
        let message = format!("`{name}` is not a finite number");
        return Err(Diagnostic::error(message).at(token.span.clone()));
    }
    let kind = if name == "pi" || name == "π" {
        NodeKind::Radians(Constant::PI)
    } else {
        NodeKind::Name(name.to_owned())
    };
    Ok(FormulaNode {
        kind,
        span: token.span.clone(),
    })
}

fn binary_node(sign: char, left: FormulaNode, right: FormulaNode) -> FormulaNode {
    let span = left.span.start..right.span.end;
    FormulaNode {
        kind: NodeKind::Binary(sign, Box::new(left), Box::new(right)),
        span,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn errors_point_at_the_place() {
        for (text, place) in [
            ("2*", 2..2),
            ("(1+2", 4..4),
            ("sin()", 4..5),
            ("foo(1)", 0..3),
            ("a b", 2..3),
        ] {
            assert_eq!(
                parse_expression(text, 0).unwrap_err().span,
                Some(place),
                "{text}"
            );
        }
    }

    #[test]
    fn hostile_nesting_is_refused() {
        assert!(parse_expression(&"(".repeat(50_000), 0).is_err());
        assert!(parse_expression(&"-".repeat(50_000), 0).is_err());
        assert!(parse_expression(&"2^".repeat(40_000), 0).is_err());
        assert!(parse_expression(&format!("1{}", "+1".repeat(40_000)), 0).is_err());
    }
}
