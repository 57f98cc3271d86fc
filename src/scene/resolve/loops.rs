//! Suspicious but usable loops: duplicates, and loops without unknowns.

use super::parsed::Parsed;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::math::Pose;
use crate::model::chain::{Chain, ChainStep};
use crate::model::mechanism::Mechanism;

/// Fixed poses that agree to this accuracy are equal: the rounding error of folded constants, relative to the size.
const SAME: f64 = 1e-12;

/// Warns about loops that repeat another one and about loops without unknowns.
pub fn warn_of_loops(mechanism: &Mechanism, parsed: &Parsed, diagnostics: &mut Diagnostics) {
    let place = |name: &str| -> Span {
        let mut loops = parsed.loops.iter();
        let found = loops.find(|(n, _)| n.value == name);
        found.map_or(0..0, |(n, _)| n.span.clone())
    };
    for (k, item) in mechanism.loops.iter().enumerate() {
        let span = place(&item.name);
        // A loop and its inverse have the same equations.
        let same = |other: &Chain| is_same(&item.chain, other, mechanism.size);
        let earlier = &mechanism.loops[..k];
        let first = earlier
            .iter()
            .find(|e| same(&e.chain) || same(&inverse_chain(&e.chain)));
        if let Some(first) = first {
            let message = format!("loop `{}` is the same as loop `{}`", item.name, first.name);
            diagnostics.push(
                Diagnostic::warning(message)
                    .at(span)
                    .with_related(place(&first.name), "first here")
                    .hint("its equations are redundant: remove one of them"),
            );
            continue;
        }
        // A loop that no unknown can change is either always closed or never.
        let used = item.chain.arguments();
        let slots = used
            .iter()
            .flat_map(|a| mechanism.arguments[*a].coordinates());
        let slots: Vec<usize> = slots.collect();
        if slots.is_empty() {
            let message = format!(
                "nothing moves in loop `{}`: it contains only constants",
                item.name
            );
            let hint = "it is checked once and determines nothing";
            diagnostics.push(Diagnostic::warning(message).at(span).hint(hint));
        } else if slots.iter().all(|slot| *slot >= mechanism.unknowns.len()) {
            let message = format!("loop `{}` contains no unknown, only inputs", item.name);
            let hint = "it determines nothing, and closes only if the inputs are consistent";
            diagnostics.push(Diagnostic::warning(message).at(span).hint(hint));
        }
    }
}

/// The chain of the inverse product.
fn inverse_chain(chain: &Chain) -> Chain {
    Chain {
        steps: chain.steps.iter().rev().map(ChainStep::inverse).collect(),
    }
}

fn is_same(a: &Chain, b: &Chain, size: f64) -> bool {
    let near = |a: &Pose, b: &Pose| {
        let turn = (a.rotation - b.rotation).to_cols_array();
        let shift = (a.translation - b.translation).length();
        turn.iter().all(|v| v.abs() <= SAME) && shift <= SAME * size
    };
    a.steps.len() == b.steps.len()
        && a.steps.iter().zip(&b.steps).all(|pair| match pair {
            (ChainStep::Fixed(a), ChainStep::Fixed(b)) => near(a, b),
            (a, b) => a == b,
        })
}
