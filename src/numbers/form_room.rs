//! Storage of the forms' coefficients: lists that live as long as the storage, so that copying forms is cheap.

use std::cell::{Cell, OnceCell, RefCell};

/// Coefficients that are processed together.
pub const LANES: usize = 8;

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
        self.bends.empty(packed_length(count));
    }

    /// How many numbers forms change with.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Lists of first order.
    pub fn slopes(&self) -> &CoefficientLists {
        &self.slopes
    }

    /// Lists of second order: one value for every pair, each number with itself among them, column after column down to the
    /// diagonal. Columns begin at multiples of [`LANES`]; what fills them up is zero.
    pub fn bends(&self) -> &CoefficientLists {
        &self.bends
    }

    /// Index of the pair (k, l), k ≤ l, in a packed list.
    pub fn place(k: usize, l: usize) -> usize {
        packed_length(l) + k
    }
}

/// Length of the list of all pairs of so many numbers: where the column of the next number begins.
pub fn packed_length(numbers: usize) -> usize {
    // Groups of columns are equally long: 1, 2, 3 … times the lanes.
    let (groups, more) = (numbers / LANES, numbers % LANES);
    LANES * (groups + 1) * (LANES / 2 * groups + more)
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

    /// A list of so many values, which mean nothing yet.
    pub fn unset(&self, length: usize) -> Vec<f64> {
        let mut list = self.spare.borrow_mut().pop().unwrap_or_default();
        list.reserve_exact(self.length.saturating_sub(list.len()));
        list.resize(length, 0.0);
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
            .filter_map(|k| room.bends().keep(vec![k as f64; 24]))
            .collect();
        assert_eq!(kept.len(), MANY);
        for (k, list) in kept.iter().enumerate() {
            assert_eq!(*list, [k as f64; 24]);
        }
        let mut next = 0;
        for l in 0..4 * LANES {
            for k in 0..=l {
                assert_eq!(FormRoom::place(k, l), next + k);
            }
            // A column with its diagonal, filled up.
            next += (l + 1).next_multiple_of(LANES);
        }
    }

    #[test]
    fn lists_given_up_are_used_again_as_if_they_were_new() {
        let mut room = FormRoom::new(3);
        let addresses = |room: &FormRoom, value: f64| {
            let lists = [
                (room.bends(), packed_length(room.count())),
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
