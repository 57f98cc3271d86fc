//! The `[clearance]` section resolved to indices of bodies.

use super::super::clearance::{ClearanceFile, PairFile};
use super::super::reader::Spanned;
use super::super::values::FormulaText;
use super::bodies::{Constants, body_index};
use crate::diag::{Diagnostic, Diagnostics, Span, shown};
use crate::model::clearance::{ClearanceRules, Ignored, PairMinimum};
use crate::model::mechanism::Body;

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
        let pairs = all(pair, bodies, diagnostics);
        let is_one_of_many = pairs.is_some();
        let pairs = pairs.unwrap_or_else(|| {
            let one = once(pair, bodies, &mut seen, diagnostics);
            one.into_iter().collect()
        });
        rules.ignored.extend(pairs.into_iter().map(|pair| Ignored {
            pair,
            reason: reason.value.clone(),
            is_one_of_many,
        }));
    }
    for pair in &file.touching {
        rules
            .touching
            .extend(once(pair, bodies, &mut seen, diagnostics));
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

/// All pairs of a pattern: a name that ends in `*` stands for all bodies that begin so. `None` if neither does.
fn all(pair: &PairFile, bodies: &[Body], diagnostics: &mut Diagnostics) -> Option<Vec<[usize; 2]>> {
    let [first, second] = pair.names.as_slice() else {
        return None;
    };
    if !first.value.ends_with('*') && !second.value.ends_with('*') {
        return None;
    }
    let mut of = |name: &Spanned<String>| -> Vec<usize> {
        let Some(start) = name.value.strip_suffix('*') else {
            return body_index(&name.value, &name.span, bodies, diagnostics)
                .into_iter()
                .collect();
        };
        let all = 0..bodies.len();
        let found: Vec<usize> = all.filter(|k| bodies[*k].name.starts_with(start)).collect();
        if found.is_empty() {
            let message = format!("no body's name begins with `{start}`");
            diagnostics.push(Diagnostic::error(message).at(name.span.clone()));
        }
        found
    };
    let (first, second) = (of(first), of(second));
    let both = first
        .iter()
        .flat_map(|a| second.iter().map(|b| [*a.min(b), *a.max(b)]));
    let mut pairs: Vec<[usize; 2]> = both.filter(|[a, b]| a != b).collect();
    pairs.sort_unstable();
    pairs.dedup();
    Some(pairs)
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
