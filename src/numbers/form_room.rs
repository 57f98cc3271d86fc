//! Storage of the forms' coefficients: lists that live as long as the storage, so that copying forms is cheap.

use std::cell::{Cell, OnceCell};

/// Lists of coefficients for this many δ. They are freed together.
#[derive(Debug)]
pub struct FormRoom {
    count: usize,
    shelves: Vec<OnceCell<Vec<OnceCell<Vec<f64>>>>>,
    kept: Cell<usize>,
}

/// Lists on a shelf.
const ON_SHELF: usize = 256;

/// Most values in all lists together: 2 GB. Coefficients beyond that are bounded instead of stored.
const MOST_VALUES: usize = 1 << 28;

impl FormRoom {
    /// Storage for forms that depend on `count` numbers.
    pub fn new(count: usize) -> Self {
        let lists = MOST_VALUES / (count * (count + 1) / 2).max(1);
        let shelves = (lists / ON_SHELF).clamp(1, 1 << 14);
        Self {
            count,
            shelves: vec![OnceCell::new(); shelves],
            kept: Cell::new(0),
        }
    }

    /// How many numbers forms change with.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Number of pairs of them, including each with itself.
    pub fn bends(&self) -> usize {
        self.count * (self.count + 1) / 2
    }

    /// Index of the pair (k, l), k ≤ l, in a packed list.
    pub fn place(&self, k: usize, l: usize) -> usize {
        k * (2 * self.count + 1 - k) / 2 + l - k
    }

    /// Stores a list; `None` if there is no more space.
    pub fn keep(&self, list: Vec<f64>) -> Option<&[f64]> {
        let index = self.kept.get();
        let shelf = self.shelves.get(index / ON_SHELF)?;
        let shelf = shelf.get_or_init(|| vec![OnceCell::new(); ON_SHELF]);
        let place = shelf.get(index % ON_SHELF)?;
        self.kept.set(index + 1);
        Some(place.get_or_init(|| list))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_stay_where_they_are() {
        let room = FormRoom::new(2);
        let kept: Vec<&[f64]> = (0..3 * ON_SHELF)
            .filter_map(|k| room.keep(vec![k as f64; room.bends()]))
            .collect();
        assert_eq!(kept.len(), 3 * ON_SHELF);
        for (k, list) in kept.iter().enumerate() {
            assert_eq!(*list, [k as f64; 3]);
        }
        let places = [(0, 0), (0, 1), (1, 1)].map(|(k, l)| room.place(k, l));
        assert_eq!(places, [0, 1, 2]);
    }
}
