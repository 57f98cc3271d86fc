//! Where the inputs of a motion rest, reverse and begin to move: what happens to everything there is no event of its own.

use crate::model::actuation::Actuation;
use crate::model::mechanism::Mechanism;

/// What the inputs do between two times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InputsBetween {
    /// The only one that moves reverses.
    Return,
    /// All that move reverse.
    AllReverse,
    /// At least one does not reverse.
    GoOn,
}

impl InputsBetween {
    /// From the rates at both times.
    pub fn of(actuation: &Actuation, times: [f64; 2]) -> Self {
        let [low, high] = times.map(|time| input_rates(actuation, time));
        let pairs = low.iter().zip(&high);
        let (mut moving, mut reversing) = (0, 0);
        for (a, b) in pairs.filter(|(a, b)| **a != 0.0 || **b != 0.0) {
            moving += 1;
            reversing += usize::from(a * b < 0.0);
        }
        match (moving, reversing) {
            (1, 1) => Self::Return,
            (moving, reversing) if moving == reversing && moving > 0 => Self::AllReverse,
            _ => Self::GoOn,
        }
    }
}

/// Whether an input rests at the first of two times and moves at the other.
pub(super) fn begins_to_move(actuation: &Actuation, times: [f64; 2]) -> bool {
    let [rests, moves] = times.map(|time| input_rates(actuation, time));
    let mut pairs = rests.iter().zip(&moves);
    pairs.any(|(rests, moves)| *rests == 0.0 && *moves != 0.0)
}

/// The largest rate of an input at a time, over its natural size.
pub(super) fn pace_at(mechanism: &Mechanism, actuation: &Actuation, time: f64) -> f64 {
    let inputs = input_rates(actuation, time).into_iter();
    let rates = inputs.zip(&mechanism.inputs);
    let paces = rates.map(|(rate, input)| rate.abs() / mechanism.natural_size(input.kind));
    paces.filter(|pace| pace.is_finite()).fold(0.0, f64::max)
}

fn input_rates(actuation: &Actuation, time: f64) -> Vec<f64> {
    let drives = actuation.drives.iter();
    drives.map(|d| d.series(time, 1).derivative(1)).collect()
}
