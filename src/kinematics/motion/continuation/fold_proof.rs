//! Proof of a fold: the motion driven by one of its unknowns instead of its input.
//!
//! With the two exchanged, the mechanism is regular at the fold, and tubes follow the path from before the fold to
//! after it. If the input at the fold is beyond its values at both ends, by more than the error bounds, it has an
//! extremum on that path.

use super::proved_stretch::{bare_mechanism, proved_samples, proved_value};
use crate::kinematics::motion::tracker::arc_length::Fold;
use crate::kinematics::results::trajectory::Sample;
use crate::kinematics::structure::block::block_of;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::chain::Argument;
use crate::model::expression::{Expression, Op};
use crate::model::mechanism::Kind;
use crate::numbers::rounding::DECIMAL;
use crate::sorting::sort_by_key;
use std::sync::Arc;

/// Most unknowns: all blocks are proved as one.
const MOST_UNKNOWNS: usize = 60;

/// Distance of the tubes' ends from the fold, in scaled unknowns: large enough for the input to change visibly, small
/// enough for the tubes.
const REACHES: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

/// A mechanism in which an unknown and an input have been exchanged.
struct Exchanged {
    system: System,
    unknown: usize,
    input: usize,
}

/// Whether the only moving input reverses at the fold; `sense` is 1 if it was rising in time and -1 if it was falling.
pub(super) fn is_proved(system: &System, actuation: &Actuation, fold: &Fold, sense: f64) -> bool {
    let mechanism = system.mechanism();
    let mut moving = actuation.drives.iter().enumerate();
    let mut moving = moving.by_ref().filter(|(_, drive)| !drive.is_constant());
    let (Some((input, drive)), None) = (moving.next(), moving.next()) else {
        return false;
    };
    let rate = drive.series(fold.at.time, 1).derivative(1) * sense;
    let most = mechanism.unknowns.len() <= MOST_UNKNOWNS;
    let Some(unknown) =
        fastest_unknown(system, fold).filter(|_| most && rate.is_finite() && rate != 0.0)
    else {
        return false;
    };
    // The fastest unknown drives, and the input is solved for: regular at the fold.
    let exchanged = Exchanged::new(system, unknown, input);
    let mut reaches = REACHES.iter();
    reaches.any(|reach| exchanged.turns_back(fold, *reach, rate.signum()) == Some(true))
}

/// The unknown that moves most from one side of the fold to the other.
fn fastest_unknown(system: &System, fold: &Fold) -> Option<usize> {
    let mechanism = system.mechanism();
    let [before, behind] = &fold.beside;
    let moved = |k: usize| (behind[k] - before[k]).abs() / mechanism.scale_of(k);
    let unknowns = system.blocks().iter().flat_map(|b| &b.unknowns).copied();
    unknowns.max_by(|a, b| moved(*a).total_cmp(&moved(*b)))
}

impl Exchanged {
    fn new(system: &System, unknown: usize, input: usize) -> Self {
        let old = system.mechanism();
        let slots = [unknown, old.unknowns.len() + input];
        let mut mechanism = bare_mechanism(old);
        // Unknown and input are exchanged, in the chains and in the equations.
        std::mem::swap(
            &mut mechanism.unknowns[unknown],
            &mut mechanism.inputs[input],
        );
        mechanism.scales.swap(slots[0], slots[1]);
        for argument in &mut mechanism.arguments {
            match argument {
                Argument::Affine(affine) => {
                    let terms = affine.terms.iter_mut();
                    terms.for_each(|term| term.0 = exchange_slot(term.0, slots));
                    sort_by_key(&mut affine.terms, |term| term.0);
                }
                Argument::Formula(expression) => *expression = rename_slots(expression, slots),
            }
        }
        for equation in &mut mechanism.equations {
            equation.expression = rename_slots(&equation.expression, slots);
        }
        // One block of everything: at a fold of one block the others move as well.
        let blocks = system.blocks();
        let loops = blocks.iter().flat_map(|b| b.loops.clone()).collect();
        let equations = blocks.iter().flat_map(|b| b.equations.clone()).collect();
        let unknowns = blocks.iter().flat_map(|b| b.unknowns.clone()).collect();
        let mut structure = system.structure().clone();
        structure.blocks = vec![block_of(&mechanism, loops, equations, unknowns)];
        Self {
            system: System::bare(Arc::new(mechanism), structure),
            unknown,
            input,
        }
    }

    /// Whether the input is proved to be beyond its values `reach` before and after the fold; `None` if the proof
    /// fails.
    fn turns_back(&self, fold: &Fold, reach: f64, sense: f64) -> Option<bool> {
        let mechanism = self.system.mechanism();
        let n = mechanism.unknowns.len();
        let mut guess = fold.at.coordinates[..n].to_vec();
        let mut inputs = fold.at.coordinates[n..].to_vec();
        std::mem::swap(&mut guess[self.unknown], &mut inputs[self.input]);
        let scale = match mechanism.inputs[self.input].kind {
            Kind::Length => mechanism.scale_of(n + self.input),
            Kind::Angle | Kind::Number => 1.0,
        };
        let [mut from, mut to] = [inputs.clone(), inputs];
        from[self.input] -= reach * scale;
        to[self.input] += reach * scale;
        let actuation = Actuation::straight(&from, &to, guess);
        let samples = proved_samples(&self.system, &actuation, &[0.0, 0.5, 1.0])?;
        // The input that became an unknown.
        let known = |sample: &Sample| proved_value(mechanism, sample, self.unknown);
        let known: Option<Vec<[f64; 2]>> = samples.iter().map(known).collect();
        let [[before, e0], [at, e1], [behind, e2]] = known?[..] else {
            return None;
        };
        let rounding = DECIMAL * at.abs();
        let beyond = |other: f64, error: f64| (at - other) * sense > e1 + error + rounding;
        Some(beyond(before, e0) && beyond(behind, e2))
    }
}

fn exchange_slot(slot: usize, [a, b]: [usize; 2]) -> usize {
    match slot {
        _ if slot == a => b,
        _ if slot == b => a,
        _ => slot,
    }
}

fn rename_slots(expression: &Expression, slots: [usize; 2]) -> Expression {
    let ops = expression.ops().iter().map(|op| match *op {
        Op::Slot(slot) => Op::Slot(exchange_slot(slot, slots)),
        other => other,
    });
    Expression::new(ops.collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::diag::Source;
    use crate::kinematics::motion::tracker::path_tracker::PathPoint;
    use crate::kinematics::solve::branch::BranchState;
    use crate::scene::{Overrides, load_scene};

    /// Whether the point x of an equation in x and phi is proved to be a fold, with the largest or smallest phi.
    fn is_fold(equation: &str, x: f64, phi: f64, sense: f64) -> bool {
        let text = format!(
            "duration = 1\n[inputs]\nphi = \"{phi} + t\"\n[equations]\ne = \"{equation}\"\n[guess]\nx = {x}\n"
        );
        let name = "test".to_owned();
        let scene = load_scene(&Source { name, text }, &Overrides::default()).unwrap();
        let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation).unwrap();
        let fold = Fold {
            at: PathPoint {
                time: 0.0,
                coordinates: [x, phi].into(),
                branch: BranchState::default(),
            },
            beside: [vec![x - 0.1, phi], vec![x + 0.1, phi]],
        };
        is_proved(&system, &scene.actuation, &fold, sense)
    }

    #[test]
    fn only_a_fold_is_proved_to_be_one() {
        assert!(is_fold("x^2 + phi", 0.0, 0.0, 1.0));
        assert!(is_fold("x^2 - phi", 0.0, 0.0, -1.0));
        // The wrong way round, an inflection, a regular pose, the sharp end of a cusp's branch.
        assert!(!is_fold("x^2 + phi", 0.0, 0.0, -1.0));
        assert!(!is_fold("x^3 - phi", 0.0, 0.0, 1.0));
        assert!(!is_fold("x - phi", 0.0, 0.0, 1.0));
        assert!(!is_fold("x^2 + phi", 0.3, -0.09, 1.0));
        assert!(!is_fold("abs(x) + phi", 0.0, 0.0, 1.0));
    }
}
