//! Rates of quantities as written in formulas: `d(h, phi)`, `d(h, t, 2)`.

use super::expression::Expression;
use crate::numbers::series::HIGHEST_ORDER;

/// Highest order of a derivative that is supported; the cost grows with the third power.
pub const MAX_ORDER: usize = HIGHEST_ORDER;

/// The order and variable of a rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RateOrder {
    /// By what.
    pub per: Per,
    /// Order, one or more.
    pub order: usize,
}

/// The variable of a rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Seconds of the drive.
    Time,
    /// An input, with the others constant.
    Input(usize),
}

/// A formula that contains rates.
#[derive(Clone, Debug, PartialEq)]
pub struct RatedFormula {
    /// Its slots: coordinates, then x, y, z of every trace, the outputs that are known to it, and its rates.
    pub expression: Expression,
    /// The slot of the first rate.
    pub first: usize,
    /// Formulas of the earlier slots whose rates it contains.
    pub rates: Vec<(Expression, RateOrder)>,
}

impl RatedFormula {
    /// Slots that it uses directly or in rates, ascending.
    pub fn slots(&self) -> Vec<usize> {
        let own = self.expression.slots().into_iter();
        let own = own.filter(|slot| *slot < self.first);
        let rates = self.rates.iter().flat_map(|(formula, _)| formula.slots());
        let mut slots: Vec<usize> = own.chain(rates).collect();
        slots.sort_unstable();
        slots.dedup();
        slots
    }
}
