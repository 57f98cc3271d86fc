//! Storage of the forms' coefficients: lists that live as long as the storage, so that copying forms is cheap.

use std::cell::{Cell, OnceCell, RefCell};

/// Lists of coefficients for this many δ. They are given up together, and their memory is used again.
#[derive(Debug, Default)]
pub struct FormRoom {
    count: usize,
    slopes: CoefficientLists,
    bends: CoefficientLists,
}

/// Lists up to one length.
#[derive(Debug, Default)]
pub struct CoefficientLists {
    length: usize,
    /// Each shelf is twice as long as the one before.
    shelves: [OnceCell<Vec<OnceCell<Vec<f64>>>>; SHELVES],
    kept: Cell<usize>,
    /// Lists that hold nothing any more.
    spare: RefCell<Vec<Vec<f64>>>,
}

/// Shelves, more than [`MOST_VALUES`] needs.
const SHELVES: usize = 24;

/// Lists on the first shelf.
const ON_FIRST: usize = 256;

/// Most values in all lists of one length: 2 GB. Coefficients beyond that are bounded instead of stored.
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
        self.count = count;
        self.slopes.empty(count);
        self.bends.empty(pair_count(count));
    }

    /// How many numbers forms change with.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Lists of first order.
    pub fn slopes(&self) -> &CoefficientLists {
        &self.slopes
    }

    /// Lists of second order: one value for every pair, each number with itself among them.
    pub fn bends(&self) -> &CoefficientLists {
        &self.bends
    }

    /// Index of the pair (k, l), k ≤ l, in a packed list.
    pub fn place(k: usize, l: usize) -> usize {
        pair_count(l) + k
    }
}

/// Number of pairs of so many numbers, each with itself among them: the length of a packed list.
pub fn pair_count(numbers: usize) -> usize {
    numbers * (numbers + 1) / 2
}

impl CoefficientLists {
    fn empty(&mut self, length: usize) {
        self.length = length;
        let spare = self.spare.get_mut();
        let mut left = self.kept.take();
        for shelf in &mut self.shelves {
            let lists = shelf.get_mut().into_iter().flatten().take(left);
            let before = spare.len();
            spare.extend(lists.filter_map(OnceCell::take));
            left -= spare.len() - before;
        }
    }

    /// A list without values, with space for all.
    pub fn blank(&self) -> Vec<f64> {
        let mut list = self.spare.borrow_mut().pop().unwrap_or_default();
        list.clear();
        list.reserve_exact(self.length);
        list
    }

    /// Takes back a list that is not needed.
    pub fn give_back(&self, list: Vec<f64>) {
        if list.capacity() > 0 {
            self.spare.borrow_mut().push(list);
        }
    }

    /// Stores a list; `None` if there is no more space.
    pub fn keep(&self, list: Vec<f64>) -> Option<&[f64]> {
        let index = self.kept.get();
        if index * self.length > MOST_VALUES {
            return None;
        }
        // Shelf s holds 256 2ˢ lists, and those before it 256 (2ˢ - 1).
        let shelf = (index / ON_FIRST + 1).ilog2();
        let size = ON_FIRST << shelf;
        let lists = self.shelves.get(shelf as usize)?;
        let lists = lists.get_or_init(|| vec![OnceCell::new(); size]);
        let place = lists.get(index + ON_FIRST - size)?;
        self.kept.set(index + 1);
        Some(place.get_or_init(|| list))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More lists than the first three shelves hold.
    const MANY: usize = 8 * ON_FIRST;

    #[test]
    fn lists_stay_where_they_are() {
        let room = FormRoom::new(2);
        let kept: Vec<&[f64]> = (0..MANY)
            .filter_map(|k| room.bends().keep(vec![k as f64; 3]))
            .collect();
        assert_eq!(kept.len(), MANY);
        for (k, list) in kept.iter().enumerate() {
            assert_eq!(*list, [k as f64; 3]);
        }
        let pairs = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
        let places = pairs.map(|(k, l)| FormRoom::place(k, l));
        assert_eq!(places, [0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn lists_given_up_are_used_again_as_if_they_were_new() {
        let mut room = FormRoom::new(3);
        let addresses = |room: &FormRoom, value: f64| {
            let lists = [
                (room.bends(), room.count() * (room.count() + 1) / 2),
                (room.slopes(), room.count()),
            ];
            let kept = (0..MANY).flat_map(|_| lists).filter_map(|(lists, length)| {
                let mut list = lists.blank();
                assert!(list.is_empty());
                list.resize(length, value);
                lists.keep(list)
            });
            let mut all: Vec<usize> = kept.map(|list| list.as_ptr().addr()).collect();
            all.sort_unstable();
            all
        };
        let first = addresses(&room, 7.0);
        assert_eq!(first.len(), 2 * MANY);
        room.empty(3);
        assert_eq!(addresses(&room, 8.0), first);
        // Fewer numbers fit into the same lists, more do not.
        for count in [2, 5] {
            room.empty(count);
            assert_eq!(addresses(&room, 9.0).len(), first.len());
        }
    }
}
