//! The `[clearance]` section resolved to indices of bodies.

use super::super::clearance::{ClearanceFile, DistanceFile, IgnoredFile, PairFile};
use super::super::reader::Spanned;
use super::super::values::FormulaText;
use super::bodies::body_index;
use super::body_constants::BodyConstants;
use crate::diag::{Diagnostic, Diagnostics, Span, shown_number};
use crate::distance::solids::Rigid;
use crate::model::clearance::{ClearanceRules, Ignored, PairMinimum};
use crate::model::distance::{Distance, SolidPair};
use crate::model::mechanism::Body;
use crate::sorting::sort_by_key;
use std::sync::Arc;

/// Looks up the bodies and checks the distances.
pub fn resolve_clearance(
    file: &ClearanceFile,
    constants: &BodyConstants,
    bodies: &[Body],
    diagnostics: &mut Diagnostics,
) -> ClearanceRules {
    let mut rules = ClearanceRules::default();
    if let Some(text) = &file.minimum {
        rules.minimum = minimum_distance(text, constants, diagnostics).unwrap_or(0.0);
    }
    let mut seen: Vec<([usize; 2], Span)> = Vec::new();
    for (pair, text) in &file.pairs {
        let minimum = minimum_distance(text, constants, diagnostics);
        let pairs = resolve_pairs(pair, bodies, &mut seen, diagnostics);
        let Some(minimum) = minimum else { continue };
        rules
            .pairs
            .extend(pairs.list.into_iter().map(|pair| PairMinimum {
                pair,
                minimum,
                is_one_of_many: pairs.is_pattern,
            }));
    }
    // A minimum given for a named pair precedes one given for a pattern.
    sort_by_key(&mut rules.pairs, |p| p.is_one_of_many);
    for ignored in &file.ignored {
        resolve_ignored(
            ignored,
            constants,
            (bodies, &mut seen),
            &mut rules,
            diagnostics,
        );
    }
    // The same precedence as for minima.
    sort_by_key(&mut rules.ignored, |i| i.is_one_of_many);
    for pair in &file.touching {
        rules
            .touching
            .extend(pairs_once(pair, bodies, &mut seen, diagnostics));
    }
    rules
}

/// The pairs of one entry.
struct Pairs {
    list: Vec<[usize; 2]>,
    /// In the order in which the entry names them.
    is_turned: Vec<bool>,
    is_pattern: bool,
}

/// All pairs of a pattern, or the named pair, which must not be listed twice.
fn resolve_pairs(
    pair: &PairFile,
    bodies: &[Body],
    seen: &mut Vec<([usize; 2], Span)>,
    diagnostics: &mut Diagnostics,
) -> Pairs {
    // A pattern may repeat a pair that is listed elsewhere, a named pair may not.
    let many = all_bodies(pair, bodies, diagnostics);
    let is_pattern = many.is_some();
    let list = many.unwrap_or_else(|| {
        pairs_once(pair, bodies, seen, diagnostics)
            .into_iter()
            .collect()
    });
    // Pairs have ascending indices; `is_turned` keeps the order of the names.
    let is_first = |body: usize| {
        let name = pair.names.first().map_or("", |name| name.value.as_str());
        let own = bodies[body].name.as_str();
        name.strip_suffix('*')
            .map_or(own == name, |start| own.starts_with(start))
    };
    Pairs {
        is_turned: list.iter().map(|[a, _]| !is_first(*a)).collect(),
        list,
        is_pattern,
    }
}

/// An entry of `ignore`.
fn resolve_ignored(
    file: &IgnoredFile,
    constants: &BodyConstants,
    (bodies, seen): (&[Body], &mut Vec<([usize; 2], Span)>),
    rules: &mut ClearanceRules,
    diagnostics: &mut Diagnostics,
) {
    let reason = &file.reason;
    // Nothing is ignored without a reason, ...
    if reason.value.trim().is_empty() {
        diagnostics.push(
            Diagnostic::error("an ignored pair needs a reason")
                .at(reason.span.clone())
                .hint("say why these bodies may touch; the report shows it"),
        );
    }
    // ... and, where a depth is given, only down to it.
    let down_to = file
        .down_to
        .as_ref()
        .and_then(|text| ignored_depth(text, constants, diagnostics));
    let pairs = resolve_pairs(&file.pair, bodies, seen, diagnostics);
    for (pair, is_turned) in pairs.list.into_iter().zip(pairs.is_turned) {
        // Shapes are named in the order of the bodies in the entry, and kept in that of their indices.
        let named = if is_turned { [pair[1], pair[0]] } else { pair };
        let named = named.map(|k| &bodies[k]);
        let shapes = named_shapes(file.shapes.as_ref(), named, constants, diagnostics);
        let own = shapes
            .into_iter()
            .map(|[i, j]| if is_turned { [j, i] } else { [i, j] });
        rules.ignored.push(Ignored {
            pair,
            reason: reason.value.clone(),
            shapes: own.collect(),
            down_to,
            is_one_of_many: pairs.is_pattern,
        });
    }
}

/// The distance requested by an output; `None` after an error.
pub fn asked_distance(
    file: &DistanceFile,
    constants: &BodyConstants,
    bodies: &[Body],
    diagnostics: &mut Diagnostics,
) -> Option<Distance> {
    let pairs = resolve_pairs(&file.pair, bodies, &mut Vec::new(), diagnostics);
    let mut gaps = Vec::new();
    for ([a, b], is_turned) in pairs.list.into_iter().zip(pairs.is_turned) {
        let order = if is_turned { [b, a] } else { [a, b] };
        let named = order.map(|k| &bodies[k]);
        let only = named_shapes(file.shapes.as_ref(), named, constants, diagnostics);
        match Rigid::new(named, &only) {
            Some(solids) => gaps.push(SolidPair {
                bodies: order,
                shapes: only,
                solids: Arc::new(solids),
            }),
            // In a group of bodies, some may have no shapes.
            None if pairs.is_pattern => {}
            None => {
                let message = format!("`{}` and `{}` have no shapes", named[0].name, named[1].name);
                let place = file.pair.span.clone();
                diagnostics.push(
                    Diagnostic::error(message)
                        .at(place)
                        .hint("a distance is measured between solids"),
                );
            }
        }
    }
    (!gaps.is_empty()).then_some(Distance { gaps })
}

/// Indices of the shapes that an entry names.
fn named_shapes(
    rows: Option<&Spanned<Vec<[FormulaText; 2]>>>,
    bodies: [&Body; 2],
    constants: &BodyConstants,
    diagnostics: &mut Diagnostics,
) -> Vec<[usize; 2]> {
    let mut list = Vec::new();
    let Some(rows) = rows else {
        return list;
    };
    for row in &rows.value {
        // Shapes are counted from 1 in the file, from 0 in the model.
        let number = |k: usize, diagnostics: &mut Diagnostics| {
            let value = constants.value(&row[k], diagnostics)?;
            let count = bodies[k].shapes.len();
            let index = (1..=count).find(|n| *n as f64 == value);
            if index.is_none() {
                let message = format!(
                    "`{}` has no shape {}: it has {count}",
                    bodies[k].name,
                    shown_number(value)
                );
                diagnostics.push(
                    Diagnostic::error(message)
                        .at(row[k].span.clone())
                        .hint("shapes are counted from 1, as in reports"),
                );
            }
            index.map(|n| n - 1)
        };
        // Both are read, so that both errors are reported; a row with an error is left out.
        let (first, second) = (number(0, diagnostics), number(1, diagnostics));
        list.extend(first.zip(second).map(<[usize; 2]>::from));
    }
    // No rows mean all shapes, which an empty list cannot mean.
    if rows.value.is_empty() {
        diagnostics.push(Diagnostic::error("`shapes` is empty").at(rows.span.clone()));
    }
    list
}

/// A depth as a distance: not positive.
fn ignored_depth(
    text: &FormulaText,
    constants: &BodyConstants,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let value = constants.value(text, diagnostics)?;
    if value <= 0.0 && value.is_finite() {
        return Some(value);
    }
    let message = format!(
        "`down_to` must not be positive, found {}",
        shown_number(value)
    );
    diagnostics.push(
        Diagnostic::error(message)
            .at(text.span.clone())
            .hint("-1.5 allows a penetration of 1.5; a distance belongs in `pairs`"),
    );
    None
}

fn minimum_distance(
    text: &FormulaText,
    constants: &BodyConstants,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let value = constants.value(text, diagnostics)?;
    if value >= 0.0 && value.is_finite() {
        return Some(value);
    }
    let message = format!(
        "a clearance must not be negative, found {}",
        shown_number(value)
    );
    diagnostics.push(
        Diagnostic::error(message).at(text.span.clone()).hint(
            "0 lets bodies touch but not overlap; bodies that may overlap belong in `ignore`",
        ),
    );
    None
}

/// All pairs of a pattern: a name that ends in `*` stands for all bodies that begin with it. `None` if neither name
/// does.
fn all_bodies(
    pair: &PairFile,
    bodies: &[Body],
    diagnostics: &mut Diagnostics,
) -> Option<Vec<[usize; 2]>> {
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
    // Every pair once, whichever pattern its bodies match; no body with itself.
    let both = first
        .iter()
        .flat_map(|a| second.iter().map(|b| [*a.min(b), *a.max(b)]));
    let mut pairs: Vec<[usize; 2]> = both.filter(|[a, b]| a != b).collect();
    pairs.sort_unstable();
    pairs.dedup();
    Some(pairs)
}

/// Indices, in ascending order, of a pair that the section lists only once.
fn pairs_once(
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
    // Both names are looked up, so that both errors are reported.
    let a = body_index(&first.value, &first.span, bodies, diagnostics);
    let b = body_index(&second.value, &second.span, bodies, diagnostics);
    let (a, b) = (a?, b?);
    if a == b {
        let message = format!("`{}` is paired with itself", first.value);
        diagnostics.push(Diagnostic::error(message).at(second.span.clone()));
        return None;
    }
    // The order of the names does not matter.
    let key = [a.min(b), a.max(b)];
    if let Some((_, other)) = seen.iter().find(|(k, _)| *k == key) {
        let message = format!(
            "the pair `{}`, `{}` is listed twice",
            first.value, second.value
        );
        diagnostics.push(
            Diagnostic::error(message)
                .at(pair.span.clone())
                .with_related(other.clone(), "first here"),
        );
        return None;
    }
    seen.push((key, pair.span.clone()));
    Some(key)
}
