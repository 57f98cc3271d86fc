//! The `[clearance]` section: as typed, and resolved to indices of bodies.

use super::file::required;
use super::reader::{FormulaText, Spanned, TableReader};
use super::resolve::bodies::{Constants, body_index};
use crate::diag::{Diagnostic, Diagnostics, Span, shown};
use crate::model::clearance::{ClearanceRules, Ignored, PairMinimum};
use crate::model::mechanism::Body;

/// The section as typed.
#[derive(Clone, Debug, Default)]
pub struct ClearanceFile {
    minimum: Option<FormulaText>,
    pairs: Vec<(PairFile, FormulaText)>,
    ignored: Vec<(PairFile, Spanned<String>)>,
}

/// Two names.
#[derive(Clone, Debug)]
struct PairFile {
    names: Vec<Spanned<String>>,
    span: Span,
}

/// Reads the section.
pub fn read(r: &mut TableReader) -> ClearanceFile {
    let minimum = r.formula("minimum");
    let pairs = r.tables("pairs", |p| {
        let pair = pair(p);
        let minimum = required(p, "minimum", |p, k| p.formula(k));
        Some((pair?, minimum?))
    });
    let ignored = r.tables("ignore", |p| {
        let pair = pair(p);
        let reason = required(p, "reason", |p, k| p.string(k));
        Some((pair?, reason?))
    });
    ClearanceFile {
        minimum,
        pairs: pairs.into_iter().flatten().collect(),
        ignored: ignored.into_iter().flatten().collect(),
    }
}

fn pair(r: &mut TableReader) -> Option<PairFile> {
    let span = r.span.clone();
    let names = required(r, "pair", |r, k| r.strings(k))?;
    Some(PairFile { names, span })
}

/// Looks up the bodies and checks the distances.
pub fn resolve(
    file: &ClearanceFile,
    constants: &Constants,
    bodies: &[Body],
    diagnostics: &mut Diagnostics,
) -> ClearanceRules {
    let mut rules = ClearanceRules::default();
    if let Some(text) = &file.minimum {
        rules.minimum = distance(text, constants, diagnostics).unwrap_or(0.0);
    }
    let mut seen: Vec<([usize; 2], Span)> = Vec::new();
    for (pair, text) in &file.pairs {
        let minimum = distance(text, constants, diagnostics);
        if let (Some(pair), Some(minimum)) = (once(pair, bodies, &mut seen, diagnostics), minimum) {
            rules.pairs.push(PairMinimum { pair, minimum });
        }
    }
    for (pair, reason) in &file.ignored {
        if reason.value.trim().is_empty() {
            diagnostics.push(
                Diagnostic::error("an ignored pair needs a reason")
                    .at(reason.span.clone())
                    .hint("say why these bodies may touch; the report shows it"),
            );
        }
        if let Some(pair) = once(pair, bodies, &mut seen, diagnostics) {
            let reason = reason.value.clone();
            rules.ignored.push(Ignored { pair, reason });
        }
    }
    rules
}

fn distance(
    text: &FormulaText,
    constants: &Constants,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let value = constants.value(text, diagnostics)?;
    if value >= 0.0 && value.is_finite() {
        return Some(value);
    }
    let message = format!("a clearance must not be negative, found {}", shown(value));
    diagnostics.push(
        Diagnostic::error(message).at(text.span.clone()).hint(
            "0 lets bodies touch but not overlap; bodies that may overlap belong into `ignore`",
        ),
    );
    None
}

/// Ascending indices of a pair that stands in the section only once.
fn once(
    pair: &PairFile,
    bodies: &[Body],
    seen: &mut Vec<([usize; 2], Span)>,
    diagnostics: &mut Diagnostics,
) -> Option<[usize; 2]> {
    let [first, second] = pair.names.as_slice() else {
        let message = format!("`pair` must name two bodies, found {}", pair.names.len());
        diagnostics.push(Diagnostic::error(message).at(pair.span.clone()));
        return None;
    };
    let a = body_index(&first.value, &first.span, bodies, diagnostics);
    let b = body_index(&second.value, &second.span, bodies, diagnostics);
    let (a, b) = (a?, b?);
    if a == b {
        let message = format!("`{}` is paired with itself", first.value);
        diagnostics.push(Diagnostic::error(message).at(second.span.clone()));
        return None;
    }
    let key = [a.min(b), a.max(b)];
    if let Some((_, other)) = seen.iter().find(|(k, _)| *k == key) {
        let message = format!(
            "the pair `{}`, `{}` stands twice",
            first.value, second.value
        );
        diagnostics.push(
            Diagnostic::error(message)
                .at(pair.span.clone())
                .related(other.clone(), "first here"),
        );
        return None;
    }
    seen.push((key, pair.span.clone()));
    Some(key)
}
