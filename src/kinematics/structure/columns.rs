//! Assigns columns of a matrix to coordinates.

/// Columns by coordinate. Its size is that of the block, so that many blocks take no more memory than their sum.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnMap(Vec<(usize, usize)>);

impl ColumnMap {
    /// Coordinates in the order of their columns.
    pub fn new(slots: &[usize]) -> Self {
        let mut list: Vec<(usize, usize)> = slots.iter().copied().zip(0..).collect();
        list.sort_unstable();
        Self(list)
    }

    /// The column of a coordinate, if it has one.
    pub fn of(&self, slot: usize) -> Option<usize> {
        let place = self.0.binary_search_by_key(&slot, |entry| entry.0);
        place.ok().map(|place| self.0[place].1)
    }
}
