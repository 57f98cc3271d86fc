//! The ends of bars: as chains, and as sums of displacements.

use super::super::super::bars::{END_HINT, EndFile};
use super::super::super::file::SceneFile;
use super::super::super::formula::chain::{Item, parse_chain};
use super::super::super::formula::expansion::Factor;
use super::super::super::formula::node::{FormulaNode, NodeKind};
use super::super::super::values::FormulaText;
use super::super::parsing::{NamedChains, note_diagnostic, parsed_expression};
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::model::chain::ElementaryMotion;
use crate::numbers::constant::Constant;

/// The position of an end in the file.
pub fn end_span(end: &EndFile) -> Span {
    match end {
        EndFile::Point(_, span) => span.clone(),
        EndFile::Chain(text) => text.span.clone(),
    }
}

/// From the world to an end.
pub fn end_factors(
    end: &EndFile,
    file: &SceneFile,
    chains: &NamedChains,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Factor>> {
    match end {
        EndFile::Point(coordinates, _) => shift_factors(coordinates, diagnostics),
        EndFile::Chain(text) => {
            let items = note_diagnostic(parse_chain, text, diagnostics)?;
            // A chain that is a single name may also be that of a traced point.
            let [Item::Reference(name, span)] = &items[..] else {
                return chains.expand(&items, diagnostics);
            };
            if chains.holds(name) {
                return chains.expand(&items, diagnostics);
            }
            let Some(trace) = file.traces.iter().find(|t| t.name.value == *name) else {
                let known = file.chains.iter().map(|(n, _)| n.value.as_str());
                let known = known.chain(file.traces.iter().map(|t| t.name.value.as_str()));
                let message = format!("there is no chain and no trace `{name}`");
                diagnostics.push(
                    Diagnostic::error(message)
                        .at(span.clone())
                        .suggest(name, known)
                        .hint(END_HINT),
                );
                return None;
            };
            // An unknown body is reported with the trace.
            let mut bodies = file.bodies.iter();
            let body = bodies.find(|b| b.name.value == trace.body.value)?;
            // The trace as a chain: the frame of its body, then its coordinates. Errors in both are reported elsewhere.
            let mut factors = match &body.frame {
                None => Vec::new(),
                Some(text) => {
                    let items = note_diagnostic(parse_chain, text, &mut Diagnostics::default())?;
                    chains.expand(&items, &mut Diagnostics::default())?
                }
            };
            let point = trace.point.iter().flatten().cloned();
            let point: Vec<FormulaText> = point.collect();
            factors.extend(shift_factors(&point, &mut Diagnostics::default())?);
            Some(factors)
        }
    }
}

fn shift_factors(
    coordinates: &[FormulaText],
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Factor>> {
    let motion = ElementaryMotion::Translation;
    let parse = |(axis, text)| {
        let node = parsed_expression(text, diagnostics)?;
        Some(Factor::Elementary(motion, axis, node))
    };
    let factors: Vec<Option<Factor>> = coordinates.iter().enumerate().map(parse).collect();
    factors.into_iter().collect()
}

/// A rotation about a point leaves the point where it is.
pub fn trimmed_factors(mut factors: Vec<Factor>) -> Vec<Factor> {
    while factors.last().is_some_and(|factor| !is_shift(factor)) {
        factors.pop();
    }
    factors
}

fn is_shift(factor: &Factor) -> bool {
    matches!(
        factor,
        Factor::Elementary(ElementaryMotion::Translation, ..)
    )
}

/// Whether both are written alike.
pub fn are_alike(a: &[Factor], b: &[Factor]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.is_alike(b))
}

/// The coordinates of a chain's end that are sums of displacements along their axes: all of them if nothing rotates,
/// otherwise the one along the axis of all rotations.
pub fn plain_axes(factors: &[Factor]) -> [bool; 3] {
    let mut plain = [true; 3];
    for factor in factors.iter().filter(|factor| !is_shift(factor)) {
        let about = match factor {
            Factor::Elementary(_, axis, _) => Some(*axis),
            Factor::Direction(..) => None,
        };
        (0..3).for_each(|axis| plain[axis] &= about == Some(axis));
    }
    plain
}

/// The sum of the displacements along an axis.
pub fn shift_along(factors: &[Factor], axis: usize, span: &Span) -> FormulaNode {
    let shifts = factors.iter().filter_map(|factor| match factor {
        Factor::Elementary(ElementaryMotion::Translation, along, node) if *along == axis => {
            Some(node.clone())
        }
        _ => None,
    });
    let sum = shifts.reduce(|a, b| FormulaNode {
        kind: NodeKind::Binary('+', Box::new(a), Box::new(b)),
        span: span.clone(),
    });
    sum.unwrap_or_else(|| FormulaNode::number(Constant::exact(0.0), span.clone()))
}
