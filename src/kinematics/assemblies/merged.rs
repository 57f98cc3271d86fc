//! Copies of one singular solution: near a root of higher order rounding hides where the root is, and starts end around it.
//!
//! Two poses are copies if every pose on the straight way between them closes as well as they do.

use super::sets::lost_rank;
use crate::kinematics::solve::closure::{all_hold_beside_terms, closes};
use crate::kinematics::solve::turns::WholeTurns;
use crate::kinematics::structure::system::System;

/// Places on the way that are looked at: next to both ends, where nothing is hidden if the ends are roots of their own, and between.
const PLACES: [f64; 5] = [0.03, 0.25, 0.5, 0.75, 0.97];

/// Whether a pose cannot be told from any neighbour by its closure.
pub fn is_blurred(system: &System, pose: &[f64]) -> bool {
    lost_rank(system, pose) > 0
}

/// Whether a blurred pose is a copy of another.
pub fn are_copies(system: &System, a: &[f64], b: &[f64]) -> bool {
    let mechanism = system.mechanism();
    let turns = WholeTurns::between(mechanism, a, b);
    PLACES.iter().all(|share| {
        let mut between = a.to_vec();
        for (slot, turn) in turns.iter().enumerate() {
            between[slot] += share * (b[slot] - turn - a[slot]);
        }
        closes(mechanism, &between) && all_hold_beside_terms(mechanism, &between)
    })
}
