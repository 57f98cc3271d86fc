//! A measure as a minimax search sees it: a formula of measures with `abs`, `min` or `max` is several functions, of which the
//! greatest counts where the formula is convex.

use super::family::ParametricMechanism;
use super::gradient::chain_rule;
use super::rows::Listed;
use crate::kinematics::loops::observed::dependencies;
use crate::model::expression::{Expression, Op};
use crate::model::measure::{MeasureSource, Taking};
use crate::model::mechanism::OutputSource;

/// Most kinks of a formula that are taken apart: six make 64 functions, as many as a track of poses. What has more is left whole, and
/// the search looks around where it ends.
const MOST_KINKS: usize = 6;

/// A measure, multiplied and shifted.
pub(super) struct BranchedMeasure {
    /// Its place among inputs and measures.
    slot: usize,
    factor: f64,
    shift: f64,
    /// Its branches as formulas of inputs and of measures over poses.
    branches: Vec<Expression>,
}

impl BranchedMeasure {
    /// The measure times `factor`, and then more by `shift`.
    pub fn new(family: &ParametricMechanism, measure: usize, factor: f64, shift: f64) -> Self {
        let whole = flat_formula(family, measure).filter(Expression::has_kinks);
        let branches = whole.and_then(|whole| whole.branches(MOST_KINKS));
        Self {
            slot: family.mechanism().inputs.len() + measure,
            factor,
            shift,
            branches: branches.unwrap_or_default(),
        }
    }

    /// Its value and those of its branches, `numbers` being inputs and measures and `rows` their derivatives, if known. A branch above
    /// the value, as a concave kink has them, counts as the value itself: the greatest of the list is always the value.
    pub fn listed(&self, numbers: &[f64], rows: &[Vec<f64>]) -> Listed {
        let own = self.factor * numbers[self.slot];
        let mut listed = Listed::default();
        listed.values.push(own + self.shift);
        let scaled = |row: &[f64]| row.iter().map(|d| self.factor * d).collect::<Vec<f64>>();
        listed
            .slopes
            .extend(rows.get(self.slot).map(|row| scaled(row)));
        for branch in &self.branches {
            let value = self.factor * branch.value(numbers);
            let mut slope = vec![0.0; rows.get(self.slot).map_or(0, Vec::len)];
            if !rows.is_empty() {
                chain_rule(branch, numbers, rows, &mut slope);
            }
            let counts = value <= own && slope.iter().all(|d| d.is_finite());
            listed
                .values
                .push(self.shift + if counts { value } else { own });
            if let Some(row) = rows.get(self.slot) {
                listed
                    .slopes
                    .push(scaled(if counts { &slope } else { row }));
            }
        }
        listed
    }
}

/// The formula of a measure by inputs and measures over poses; `None` of what would be too long.
fn flat_formula(family: &ParametricMechanism, measure: usize) -> Option<Expression> {
    let inputs = family.mechanism().inputs.len();
    let mut flat: Vec<Expression> = (0..inputs)
        .map(|k| Expression::new(vec![Op::Slot(k)]))
        .collect();
    for earlier in &family.measures.list[..=measure] {
        let own = match &earlier.source {
            MeasureSource::Formula(formula) => formula.with_formulas(|slot| flat.get(slot))?,
            MeasureSource::Over { .. } => Expression::new(vec![Op::Slot(flat.len())]),
        };
        flat.push(own);
    }
    flat.pop()
}

/// Whether a measure may have kinks that its derivatives and those of its branches do not tell: extremes that pass from one pose to
/// another, kinks of formulas at a pose, and those of too many branches. `by_pose` says whether every pose of an extreme is seen.
pub(super) fn hides_kinks(family: &ParametricMechanism, measure: usize, by_pose: bool) -> bool {
    match &family.measures.list[measure].source {
        MeasureSource::Over { of, taking, .. } => {
            let passes = match taking {
                Taking::Min | Taking::Max | Taking::Largest => !by_pose,
                Taking::Range | Taking::Positive | Taking::Bow => true,
                _ => false,
            };
            passes || of.iter().any(|formula| has_kinks(family, formula))
        }
        MeasureSource::Formula(_) => {
            let Some(whole) = flat_formula(family, measure) else {
                return true;
            };
            let inputs = family.mechanism().inputs.len();
            let slots = whole.slots().into_iter();
            let mut measures = slots.filter_map(|slot| slot.checked_sub(inputs));
            let is_told = whole
                .branches(MOST_KINKS)
                .is_some_and(|branches| !branches.iter().any(Expression::has_kinks));
            !is_told || measures.any(|index| hides_kinks(family, index, false))
        }
    }
}

/// Whether a formula of a pose, or an output that it depends on, has kinks.
fn has_kinks(family: &ParametricMechanism, formula: &Expression) -> bool {
    let mechanism = family.mechanism();
    let needed = dependencies(mechanism, &formula.slots());
    let first = needed.len() - mechanism.outputs.len();
    let mut outputs = mechanism.outputs.iter().zip(&needed[first..]);
    let is_kinked = |source: &OutputSource| match source {
        OutputSource::Formula(own) => own.has_kinks(),
        // Distances of bodies have kinks where other points become the nearest ones.
        OutputSource::Distance(_) | OutputSource::Rated(_) => true,
    };
    formula.has_kinks()
        || outputs.any(|(output, is_needed)| *is_needed && is_kinked(&output.source))
}
