//! Splits the text of a formula into tokens with their positions, without regard to their meaning.

use crate::diag::{Diagnostic, Span};
use crate::numbers::constant::Constant;

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub enum TokenKind {
    /// A decimal number.
    Number(Constant),
    /// An identifier; may hold letters of any alphabet, digits, `_` and inner dots (`M.x`).
    Name(String),
    /// One of `+ - * / ^ ( ) ,`.
    Sign(char),
    /// End of the text.
    End,
}

/// A token and its position in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// Where it is.
    pub span: Span,
}

/// Longest formula accepted, in bytes: longer than any hand-written one, and a bound on the parser's work.
const MAX_FORMULA_BYTES: usize = 100_000;

/// Tokens of `text`, which starts at byte `offset` of the file; the last one is `End`.
pub fn tokenize_text(text: &str, offset: usize) -> Result<Vec<Token>, Diagnostic> {
    if text.len() > MAX_FORMULA_BYTES {
        return Err(
            Diagnostic::error(format!("formula is longer than {MAX_FORMULA_BYTES} bytes"))
                .at(offset..offset + text.chars().next().map_or(1, char::len_utf8)),
        );
    }
    let mut tokens = Vec::new();
    let mut rest = text;
    loop {
        rest = rest.trim_start();
        let at = text.len() - rest.len();
        let Some(first) = rest.chars().next() else {
            tokens.push(Token {
                kind: TokenKind::End,
                span: offset + at..offset + at,
            });
            return Ok(tokens);
        };
        let (kind, length) = read_token(first, rest).map_err(|(message, length)| {
            let diagnostic = Diagnostic::error(message).at(offset + at..offset + at + length);
            match character_hint(first) {
                Some(hint) => diagnostic.hint(hint),
                None => diagnostic,
            }
        })?;
        tokens.push(Token {
            kind,
            span: offset + at..offset + at + length,
        });
        rest = &rest[length..];
    }
}

/// The token at the start of `rest` and its length in bytes, or a message and the length of the invalid text.
fn read_token(first: char, rest: &str) -> Result<(TokenKind, usize), (String, usize)> {
    match first {
        '0'..='9' | '.' => read_number(rest),
        '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' => Ok((TokenKind::Sign(first), 1)),
        '·' | '×' => Ok((TokenKind::Sign('*'), first.len_utf8())),
        '−' => Ok((TokenKind::Sign('-'), first.len_utf8())),
        c if c.is_alphabetic() || c == '_' => Ok(read_name(rest)),
        c => Err((
            format!("unexpected character `{c}` in a formula"),
            c.len_utf8(),
        )),
    }
}

/// What stands for a character that formulas do not have.
fn character_hint(character: char) -> Option<&'static str> {
    match character {
        '°' => Some("an angle in degrees is written `90deg`"),
        '²' | '³' => Some("a power is written with `^`: `a^2`"),
        '√' => Some("a root is written `sqrt(a)`"),
        '÷' | ':' => Some("a quotient is written with `/`"),
        '[' | ']' | '{' | '}' => Some("formulas have round parentheses only"),
        '"' | '\'' => Some("one pair of quotes encloses the whole formula"),
        _ => None,
    }
}

fn read_name(rest: &str) -> (TokenKind, usize) {
    let end = rest
        .find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.' || c == '\''))
        .unwrap_or(rest.len());
    let name = rest[..end].trim_end_matches('.');
    (TokenKind::Name(name.to_owned()), name.len())
}

fn read_number(rest: &str) -> Result<(TokenKind, usize), (String, usize)> {
    let bytes = rest.as_bytes();
    let digits = |mut i: usize| {
        while bytes
            .get(i)
            .is_some_and(|b| b.is_ascii_digit() || *b == b'.')
        {
            i += 1;
        }
        i
    };
    let mut end = digits(0);
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = matches!(bytes.get(end + 1), Some(b'+' | b'-')) as usize;
        if bytes.get(end + 1 + sign).is_some_and(u8::is_ascii_digit) {
            end = digits(end + 1 + sign);
        }
    }
    match Constant::decimal(&rest[..end]) {
        Some(value) => Ok((TokenKind::Number(value), end)),
        None => Err((format!("`{}` is not a finite number", &rest[..end]), end)),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn numbers_names_and_signs_keep_their_places() {
        let tokens = tokenize_text("Tx(-1.5e-3*R_1) M.x", 10).unwrap();
        let kinds: Vec<_> = tokens.iter().map(|t| t.kind.clone()).collect();
        assert_eq!(kinds[0], TokenKind::Name("Tx".into()));
        assert_eq!(
            kinds[3],
            TokenKind::Number(Constant::decimal("1.5e-3").unwrap())
        );
        assert_eq!(kinds[5], TokenKind::Name("R_1".into()));
        assert_eq!(kinds[7], TokenKind::Name("M.x".into()));
        assert_eq!(tokens[3].span, 14..20);
    }

    #[test]
    fn bad_characters_and_numbers_are_named() {
        assert_eq!(tokenize_text("a $ b", 0).unwrap_err().span, Some(2..3));
        assert!(
            tokenize_text("1.2.3", 0)
                .unwrap_err()
                .message
                .contains("1.2.3")
        );
        assert!(
            tokenize_text("1e999", 0)
                .unwrap_err()
                .message
                .contains("finite")
        );
    }
}
