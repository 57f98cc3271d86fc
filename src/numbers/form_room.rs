//! Storage of the forms' coefficients: lists that live as long as the storage, so that copying forms is cheap.

use std::cell::{Cell, OnceCell, RefCell};

/// Lists of coefficients for this many δ. They are given up together, and their memory is used again.
#[derive(Debug, Default)]
pub struct FormRoom {
    count: usize,
    shelves: Vec<OnceCell<Vec<OnceCell<Vec<f64>>>>>,
    kept: Cell<usize>,
    /// Lists that hold nothing any more.
    spare: RefCell<Vec<Vec<f64>>>,
}

/// Lists on a shelf.
const ON_SHELF: usize = 256;

/// Most values in all lists together: 2 GB. Coefficients beyond that are bounded instead of stored.
const MOST_VALUES: usize = 1 << 28;

impl FormRoom {
    /// Storage for forms that depend on `count` numbers.
    pub fn new(count: usize) -> Self {
        let mut room = Self::default();
        room.empty(count);
        room
    }

    /// Gives up all lists; forms then depend on `count` numbers.
    pub fn empty(&mut self, count: usize) {
        let spare = self.spare.get_mut();
        for index in 0..self.kept.take() {
            let shelf = self.shelves[index / ON_SHELF].get_mut();
            spare.extend(shelf.and_then(|shelf| shelf[index % ON_SHELF].take()));
        }
        if self.count != count || self.shelves.is_empty() {
            let lists = MOST_VALUES / (count * (count + 1) / 2).max(1);
            let shelves = (lists / ON_SHELF).clamp(1, 1 << 14);
            self.shelves.resize(shelves, OnceCell::new());
            self.count = count;
        }
    }

    /// A list without values, with space for all pairs.
    pub fn blank(&self) -> Vec<f64> {
        let mut list = self.spare.borrow_mut().pop().unwrap_or_default();
        list.clear();
        list.reserve_exact(self.bends());
        list
    }

    /// A list of zeros.
    pub fn zeros(&self) -> Vec<f64> {
        let mut list = self.blank();
        list.resize(self.bends(), 0.0);
        list
    }

    /// Takes back a list that is not needed.
    pub fn give_back(&self, list: Vec<f64>) {
        if list.capacity() > 0 {
            self.spare.borrow_mut().push(list);
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

    #[test]
    fn lists_given_up_are_used_again_as_if_they_were_new() {
        let mut room = FormRoom::new(3);
        let addresses = |room: &FormRoom, value: f64| {
            let kept = (0..2 * ON_SHELF).filter_map(|_| {
                let mut list = room.zeros();
                assert_eq!(list, vec![0.0; room.bends()]);
                list.fill(value);
                room.keep(list)
            });
            let mut all: Vec<usize> = kept.map(|list| list.as_ptr().addr()).collect();
            all.sort_unstable();
            all
        };
        let first = addresses(&room, 7.0);
        room.empty(3);
        assert_eq!(addresses(&room, 8.0), first);
        // Fewer numbers fit into the same lists, more do not.
        for count in [2, 5] {
            room.empty(count);
            assert_eq!(addresses(&room, 9.0).len(), first.len());
        }
    }
}
