//! Of which coordinates a whole turn changes something.

use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use crate::model::mechanism::{Coordinate, Kind, Mechanism};
use std::f64::consts::TAU;

/// By coordinate: whether a whole turn of it changes anything, because it drives a translation, a gear or an equation.
pub(crate) struct WholeTurns(Vec<bool>);

impl WholeTurns {
    /// Looks through all chains, arguments and equations once.
    pub fn of(mechanism: &Mechanism) -> Self {
        let mut list = vec![false; mechanism.coordinate_count()];
        let mut note = |slot: usize| {
            if let Some(matters) = list.get_mut(slot) {
                *matters = true;
            }
        };
        for step in mechanism.chains().flat_map(|chain| &chain.steps) {
            if let ChainStep::Joint {
                motion: ElementaryMotion::Translation,
                argument,
                ..
            } = step
            {
                let moved = mechanism.arguments[*argument].coordinates();
                moved.into_iter().for_each(&mut note);
            }
        }
        for argument in &mechanism.arguments {
            match argument {
                // A whole turn changes an angle that is geared by no whole number.
                Argument::Affine(affine) => {
                    let geared = affine.terms.iter();
                    let geared = geared.filter(|(_, c)| c.number().fract() != 0.0);
                    geared.for_each(|(slot, _)| note(*slot));
                }
                Argument::Formula(expression) => expression.slots().into_iter().for_each(&mut note),
            }
        }
        for equation in &mechanism.equations {
            equation.expression.slots().into_iter().for_each(&mut note);
        }
        Self(list)
    }

    /// The whole turns, in radians, by which the unknowns of a pose differ from those of one nearby without changing anything.
    pub fn between(mechanism: &Mechanism, near: &[f64], coordinates: &[f64]) -> Vec<f64> {
        let whole = Self::of(mechanism);
        let turns = |(slot, unknown): (usize, &Coordinate)| match unknown.kind {
            Kind::Angle if !whole.matter(slot) => {
                TAU * ((coordinates[slot] - near[slot]) / TAU).round()
            }
            _ => 0.0,
        };
        mechanism.unknowns.iter().enumerate().map(turns).collect()
    }

    /// Whether a whole turn of the coordinate changes anything.
    pub fn matter(&self, slot: usize) -> bool {
        self.0.get(slot).copied().unwrap_or(false)
    }
}
