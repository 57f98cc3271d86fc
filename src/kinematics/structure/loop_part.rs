//! The equations of a loop: their numbers, their names, and the part that a block solves.

use crate::model::mechanism::{Closes, Mechanism};
use std::ops::Range;

/// The part of a loop that a block solves.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopPart {
    /// Index of the loop.
    pub index: usize,
    /// Its equations that are not empty: 0 to 2 rotation about x, y, z; 3 to 5 translation.
    pub components: Vec<usize>,
}

/// The equations of a loop: all six, or the translations if it closes in a point.
pub fn components_of(mechanism: &Mechanism, index: usize) -> Range<usize> {
    match mechanism.loops[index].closes {
        Closes::Frame => 0..6,
        Closes::Point => 3..6,
    }
}

/// An equation of a loop in words.
pub fn component_name(component: usize) -> &'static str {
    [
        "the rotation about x",
        "the rotation about y",
        "the rotation about z",
        "the translation along x",
        "the translation along y",
        "the translation along z",
    ][component]
}
