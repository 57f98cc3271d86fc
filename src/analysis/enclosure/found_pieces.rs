//! Pieces that were solved at a pose: several quantities have their extremes at the same one, and so have they in each enclosure of
//! the pose.

use crate::kinematics::enclosure::pose::{Encloser, PoseEnclosure};
use crate::kinematics::loops::observed::observed_slots;
use crate::model::mechanism::Mechanism;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;
use std::cell::OnceCell;

/// Pieces that close within an enclosure of the pose.
#[derive(Debug, Default)]
pub(super) struct FoundPieces {
    list: Vec<FoundPiece>,
}

/// The piece at δ.
#[derive(Debug)]
pub(super) struct FoundPiece {
    place: Vec<f64>,
    plain: AllSlots<f64>,
    proved: OnceCell<Option<AllSlots<Interval>>>,
}

/// Coordinates, and all slots when they are needed.
#[derive(Debug)]
struct AllSlots<S> {
    coordinates: Vec<S>,
    observed: OnceCell<Vec<S>>,
}

impl<S: Scalar> AllSlots<S> {
    fn new(coordinates: Vec<S>) -> Self {
        Self {
            coordinates,
            observed: OnceCell::new(),
        }
    }

    fn value(&self, mechanism: &Mechanism, slot: usize) -> Option<S> {
        let known = self.coordinates.get(slot);
        let all = || {
            self.observed
                .get_or_init(|| observed_slots(mechanism, &self.coordinates))
        };
        known.or_else(|| all().get(slot)).copied()
    }
}

impl FoundPieces {
    /// The places among these at which none is known.
    pub fn unknown<'p>(&self, places: &[&'p [f64]]) -> Vec<&'p [f64]> {
        let is_unknown = |place: &&&[f64]| self.at(place).is_none();
        places.iter().filter(is_unknown).copied().collect()
    }

    /// Adds the coordinates of the pieces that were found at some places.
    pub fn add(&mut self, places: &[&[f64]], pieces: Vec<Option<Vec<f64>>>) {
        let found = places.iter().zip(pieces).filter_map(|(place, piece)| {
            Some(FoundPiece {
                place: place.to_vec(),
                plain: AllSlots::new(piece?),
                proved: OnceCell::new(),
            })
        });
        self.list.extend(found);
    }

    /// The piece at δ.
    pub fn at(&self, place: &[f64]) -> Option<&FoundPiece> {
        self.list.iter().find(|known| known.place == place)
    }
}

impl FoundPiece {
    /// The value of a slot.
    pub fn value(&self, mechanism: &Mechanism, slot: usize) -> Option<f64> {
        self.plain.value(mechanism, slot)
    }

    /// The proved value of a slot. All enclosures of a pose have the same boxes, from which the proof follows.
    pub fn proved_value(
        &self,
        mechanism: &Mechanism,
        (encloser, enclosure): (&Encloser, &PoseEnclosure),
        slot: usize,
    ) -> Option<Interval> {
        let proof = || {
            let piece = encloser.piece(enclosure, &self.place, &self.plain.coordinates)?;
            Some(AllSlots::new(piece))
        };
        let proved = self.proved.get_or_init(proof).as_ref()?;
        proved.value(mechanism, slot)
    }
}
