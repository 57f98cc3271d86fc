//! The notation of symbols: plain text, LaTeX, MathML.

use super::symbol::{AngleSum, Symbol, SymbolSum};
use crate::diag::xml_text;
use crate::model::notation::WrittenTerm;
use crate::numbers::decimal::{trimmed, with_minus};
use crate::staging::quantity_names::{greek_word, split_symbol, written_symbol};

/// A way of writing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatrixStyle {
    /// Names as in the scene.
    Text,
    /// For a document.
    Latex,
    /// For a page.
    MathMl,
}

impl MatrixStyle {
    /// A sum of products.
    pub fn sum(self, sum: &SymbolSum) -> String {
        let mut out = String::new();
        for (symbols, coefficient) in sum.terms() {
            let is_first = out.is_empty();
            let sign = match (coefficient < 0.0, is_first) {
                (true, _) => self.signed_operator('-', is_first),
                (false, true) => String::new(),
                (false, false) => self.signed_operator('+', false),
            };
            out.push_str(&sign);
            out.push_str(&self.product(symbols, coefficient.abs()));
        }
        if out.is_empty() {
            self.number(0.0)
        } else {
            out
        }
    }

    fn signed_operator(self, sign: char, is_first: bool) -> String {
        match self {
            Self::MathMl if sign == '-' => "<mo>−</mo>".to_owned(),
            Self::MathMl => "<mo>+</mo>".to_owned(),
            _ if is_first => sign.to_string(),
            _ => format!(" {sign} "),
        }
    }

    fn product(self, symbols: &[Symbol], coefficient: f64) -> String {
        let mut parts: Vec<String> = Vec::new();
        if coefficient != 1.0 || symbols.is_empty() {
            parts.push(self.number(coefficient));
        }
        parts.extend(symbols.iter().map(|symbol| self.symbol_text(symbol)));
        match self {
            Self::Text => parts.join("*"),
            Self::Latex => parts.join("\\,"),
            Self::MathMl => parts.join("<mo>&#x2062;</mo>"),
        }
    }

    /// The sum in a factor's parentheses; a text that is no sum of names as it is.
    pub fn terms(self, terms: &[WrittenTerm], text: &str) -> String {
        if terms.is_empty() {
            return self.name(text);
        }
        let mut out = String::new();
        for term in terms {
            if term.is_negative || !out.is_empty() {
                let sign = if term.is_negative { '-' } else { '+' };
                out.push_str(&self.signed_operator(sign, out.is_empty()));
            }
            out.push_str(&match term.text.parse::<f64>() {
                Ok(value) => self.number(value),
                Err(_) => self.name(&term.text),
            });
        }
        out
    }

    /// A number with at most six decimals.
    pub fn number(self, value: f64) -> String {
        let short = trimmed(value, 6);
        match self {
            Self::MathMl => format!("<mn>{}</mn>", with_minus(&short)),
            _ => short,
        }
    }

    fn symbol_text(self, symbol: &Symbol) -> String {
        match symbol {
            Symbol::Length(name) => self.name(&name.text),
            Symbol::Cos(angle) => self.function("cos", angle),
            Symbol::Sin(angle) => self.function("sin", angle),
        }
    }

    fn function(self, name: &str, angle: &AngleSum) -> String {
        let sum = self.angle(angle);
        let is_single = angle.0.len() == 1;
        match self {
            Self::Text => format!("{name}({sum})"),
            Self::Latex if is_single => format!("\\{name}{{{sum}}}"),
            Self::Latex => format!("\\{name}\\left({sum}\\right)"),
            Self::MathMl if is_single => format!("<mi>{name}</mi><mo>&#x2061;</mo>{sum}"),
            Self::MathMl => format!("<mi>{name}</mi><mo>(</mo>{sum}<mo>)</mo>"),
        }
    }

    fn angle(self, angle: &AngleSum) -> String {
        let mut out = String::new();
        for name in &angle.0 {
            let is_first = out.is_empty();
            if name.count < 0 || !is_first {
                out.push_str(
                    &self.signed_operator(if name.count < 0 { '-' } else { '+' }, is_first),
                );
            }
            if name.count.abs() != 1 {
                out.push_str(&self.number(name.count.unsigned_abs() as f64));
            }
            out.push_str(&self.name(&name.text));
        }
        out
    }

    /// A name, or a formula that is taken as one.
    pub fn name(self, text: &str) -> String {
        let is_name = text.chars().all(|c| c.is_alphanumeric() || c == '_');
        match self {
            Self::Text if is_name => text.to_owned(),
            Self::Text => format!("({text})"),
            Self::Latex if is_name => latex_name(text),
            Self::Latex => format!("\\left(\\text{{{text}}}\\right)"),
            Self::MathMl if is_name => mathml_name(text),
            Self::MathMl => format!(
                "<mrow><mo>(</mo><mtext>{}</mtext><mo>)</mo></mrow>",
                xml_text(text)
            ),
        }
    }
}

/// `\varphi_{1}`
fn latex_name(name: &str) -> String {
    let (stem, below) = split_symbol(name);
    let letter = match greek_word(stem) {
        Some("phi") => "\\varphi".to_owned(),
        Some("epsilon") => "\\varepsilon".to_owned(),
        Some(word) => format!("\\{word}"),
        None if stem.chars().count() == 1 => stem.to_owned(),
        None => format!("\\mathit{{{}}}", stem.replace('_', "\\_")),
    };
    match below {
        "" => letter,
        below => format!("{letter}_{{{}}}", below.replace('_', "\\_")),
    }
}

fn mathml_name(name: &str) -> String {
    let (stem, below) = split_symbol(name);
    let letter = format!("<mi>{}</mi>", written_symbol(stem));
    match below {
        "" => letter,
        below => format!("<msub>{letter}<mtext>{below}</mtext></msub>"),
    }
}
