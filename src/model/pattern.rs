//! The entries of a pose that are zero whatever its numbers are: a rotation about z, for example, has no part outside
//! the plane.
//!
//! The pattern of a product follows from those of its factors. An equation of a loop that vanishes identically is thus
//! recognised by the axes of the chain, not by numbers at some poses.

use crate::math::Pose;
use std::ops::Mul;

/// What is known about a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PatternEntry {
    Zero,
    One,
    MinusOne,
    Any,
}

impl PatternEntry {
    fn of(value: f64) -> Self {
        match value {
            0.0 => Self::Zero,
            1.0 => Self::One,
            -1.0 => Self::MinusOne,
            _ => Self::Any,
        }
    }

    fn times(self, other: Self) -> Self {
        match (self, other) {
            (Self::Zero, _) | (_, Self::Zero) => Self::Zero,
            (Self::One, Self::One) | (Self::MinusOne, Self::MinusOne) => Self::One,
            (Self::One, Self::MinusOne) | (Self::MinusOne, Self::One) => Self::MinusOne,
            _ => Self::Any,
        }
    }

    fn plus(self, other: Self) -> Self {
        match (self, other) {
            (Self::Zero, sum) | (sum, Self::Zero) => sum,
            _ => Self::Any,
        }
    }
}

/// What is known about the entries of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowPattern {
    /// Column by column.
    rotation: [[PatternEntry; 3]; 3],
    translation: [PatternEntry; 3],
}

impl RowPattern {
    /// Of the identity.
    pub const IDENTITY: Self = Self {
        rotation: [
            [PatternEntry::One, PatternEntry::Zero, PatternEntry::Zero],
            [PatternEntry::Zero, PatternEntry::One, PatternEntry::Zero],
            [PatternEntry::Zero, PatternEntry::Zero, PatternEntry::One],
        ],
        translation: [PatternEntry::Zero; 3],
    };

    /// Of a translation along a coordinate axis.
    pub const fn of_shift(axis: usize) -> Self {
        let mut pattern = Self::IDENTITY;
        pattern.translation[axis] = PatternEntry::Any;
        pattern
    }

    /// Of a rotation about a coordinate axis.
    pub const fn of_turn(axis: usize) -> Self {
        let mut pattern = Self::IDENTITY;
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        pattern.rotation[b][b] = PatternEntry::Any;
        pattern.rotation[b][c] = PatternEntry::Any;
        pattern.rotation[c][b] = PatternEntry::Any;
        pattern.rotation[c][c] = PatternEntry::Any;
        pattern
    }

    /// Of any rotation.
    pub const fn of_any_rotation() -> Self {
        Self {
            rotation: [[PatternEntry::Any; 3]; 3],
            ..Self::IDENTITY
        }
    }

    /// Of a pose whose numbers are exact.
    pub fn of_exact(pose: &Pose) -> Self {
        let entries = |column: glam::DVec3| column.to_array().map(PatternEntry::of);
        Self {
            rotation: [0, 1, 2].map(|k| entries(pose.rotation.col(k))),
            translation: entries(pose.translation),
        }
    }

    /// Of the inverse pose.
    pub fn inverse(&self) -> Self {
        let back = Self {
            rotation: [0, 1, 2].map(|k| self.rotation.map(|column| column[k])),
            ..Self::IDENTITY
        };
        Self {
            // Of a translation only its zeros are used.
            translation: back.turned(&self.translation),
            ..back
        }
    }

    /// Whether equation `component` of a loop holds at every pose: 0 to 2 skew part of the rotation, 3 to 5 translation.
    pub fn always_holds(&self, component: usize) -> bool {
        if component >= 3 {
            return self.translation[component - 3] == PatternEntry::Zero;
        }
        let (b, c) = ((component + 1) % 3, (component + 2) % 3);
        [self.rotation[b][c], self.rotation[c][b]] == [PatternEntry::Zero; 2]
    }

    /// Whether it is the pattern of a translation.
    pub fn turns_nothing(&self) -> bool {
        self.rotation == Self::IDENTITY.rotation
    }

    fn turned(&self, vector: &[PatternEntry; 3]) -> [PatternEntry; 3] {
        [0, 1, 2].map(|row| {
            let terms = (0..3).map(|k| self.rotation[k][row].times(vector[k]));
            terms.fold(PatternEntry::Zero, PatternEntry::plus)
        })
    }
}

impl Mul for RowPattern {
    type Output = Self;
    fn mul(self, right: Self) -> Self {
        let moved = self.turned(&right.translation);
        Self {
            rotation: right.rotation.map(|column| self.turned(&column)),
            translation: [0, 1, 2].map(|k| self.translation[k].plus(moved[k])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Planar chains leave their plane in no equation, spherical ones their point, and a single motion out of the plane
    /// is detected.
    #[test]
    fn equations_that_always_hold_are_those_of_the_axes() {
        let [t, r] = [RowPattern::of_shift, RowPattern::of_turn];
        for (motions, always) in [
            (&[r(2), t(0), r(2), t(1)][..], vec![0, 1, 5]),
            (&[r(1), t(0), r(1), t(2)], vec![0, 2, 4]),
            (&[r(2), r(0), r(1)], vec![3, 4, 5]),
            (&[t(0), t(1)], vec![0, 1, 2, 5]),
            (&[r(2), t(0), t(2)], vec![0, 1]),
            (&[r(2), t(0), r(0), r(2)], vec![5]),
            (&[r(2), r(0), t(1), r(2)], vec![]),
        ] {
            let pattern = motions.iter().copied().fold(RowPattern::IDENTITY, Mul::mul);
            let found: Vec<usize> = (0..6).filter(|k| pattern.always_holds(*k)).collect();
            assert_eq!(found, always, "{motions:?}");
            // The inverse moves in the same group wherever the group is a whole one.
            let inverse = pattern.inverse();
            let holds = |p: &RowPattern| (0..6).map(|k| p.always_holds(k)).collect::<Vec<_>>();
            if always.len() == 3 {
                assert_eq!(holds(&inverse), holds(&pattern));
            }
        }
    }
}
