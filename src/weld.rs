//! Finds equal items among many with one flat hash table, which needs little memory for meshes with millions of
//! corners.

use glam::DVec3;
use std::hash::{BuildHasher, Hash, RandomState};

/// Marks a free place of the table.
const NONE: u32 = u32::MAX;

/// Hash table of items, numbers below 2^32 - 1, whose keys are recomputed whenever they are compared. Its capacity is
/// fixed.
///
/// The hash is seeded differently in every run, so that no file can provoke collisions; the result does not depend on
/// it.
pub struct FlatTable {
    hasher: RandomState,
    mask: usize,
    table: Vec<u32>,
    /// A bit for the hash of every key, at most one in eight set: most absent keys are recognised without a look at the
    /// items.
    seen: Vec<u8>,
}

impl FlatTable {
    /// A table for this number of items.
    pub fn with_room(count: usize) -> Self {
        let mask = (count + count / 3 + 1).next_power_of_two() - 1;
        Self {
            hasher: RandomState::new(),
            mask,
            table: vec![NONE; mask + 1],
            seen: vec![0; mask + 1],
        }
    }

    /// The item with a key.
    pub fn get<K: Eq + Hash>(&self, own: &K, key: impl Fn(usize) -> K) -> Option<usize> {
        let hash = self.hasher.hash_one(own);
        if !self.is_seen(hash) {
            return None;
        }
        let item = self.table[self.place(hash, |k| key(k) == *own)];
        (item != NONE).then_some(item as usize)
    }

    /// The item with a key; else `item`, which is stored for it.
    pub fn get_or_insert<K: Eq + Hash>(
        &mut self,
        own: &K,
        item: usize,
        key: impl Fn(usize) -> K,
    ) -> usize {
        let hash = self.hasher.hash_one(own);
        let may_be_known = self.is_seen(hash);
        let place = self.place(hash, |k| may_be_known && key(k) == *own);
        if self.table[place] == NONE {
            self.table[place] = item as u32;
            let (byte, bit) = self.bit(hash);
            self.seen[byte] |= bit;
        }
        self.table[place] as usize
    }

    /// The first place, from that of a hash, that is free or holds a matching item.
    fn place(&self, hash: u64, is_it: impl Fn(usize) -> bool) -> usize {
        let mut place = hash as usize & self.mask;
        while self.table[place] != NONE && !is_it(self.table[place] as usize) {
            place = (place + 1) & self.mask;
        }
        place
    }

    /// Place of a hash's bit: taken from other bits than the place in the table.
    fn bit(&self, hash: u64) -> (usize, u8) {
        let other = hash.rotate_left(32) as usize;
        (other >> 3 & self.mask, 1 << (other & 7))
    }

    fn is_seen(&self, hash: u64) -> bool {
        let (byte, bit) = self.bit(hash);
        self.seen[byte] & bit != 0
    }
}

/// For each of `count` items the first one with an equal key.
pub fn first_equal<K: Eq + Hash>(count: usize, key: impl Fn(usize) -> K) -> Vec<u32> {
    let mut table = FlatTable::with_room(count);
    (0..count)
        .map(|item| table.get_or_insert(&key(item), item, &key) as u32)
        .collect()
}

/// The bits of a point, equal for equal points.
pub fn point_bits(point: DVec3) -> [u64; 3] {
    // Adding zero makes -0 into 0.
    (point + 0.0).to_array().map(f64::to_bits)
}

/// Numbers the first ones in their order, so that the result of [`first_equal`] becomes indices without gaps. Returns
/// their number.
pub fn number_first(first: &mut [u32]) -> usize {
    let mut count = 0;
    for item in 0..first.len() {
        let other = first[item] as usize;
        // The first of equal items comes before the others, so it already has its number.
        first[item] = if other == item { count } else { first[other] };
        count += u32::from(other == item);
    }
    count as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_equal_items_is_found_and_numbered() {
        let items = [7, 3, 7, 7, 1, 3, 9];
        let mut first = first_equal(items.len(), |k| items[k]);
        assert_eq!(first, [0, 1, 0, 0, 4, 1, 6]);
        assert_eq!(number_first(&mut first), 4);
        assert_eq!(first, [0, 1, 0, 0, 2, 1, 3]);
        assert!(first_equal(0, |k| k).is_empty());
        assert_eq!(
            point_bits(DVec3::new(-0.0, 1.0, 0.0)),
            point_bits(DVec3::new(0.0, 1.0, -0.0))
        );
    }

    /// Many equal items and many different ones: the table is neither full nor slow.
    #[test]
    fn many_items_are_told_apart() {
        for modulus in [1, 2, 1000, 100_000] {
            let first = first_equal(100_000, |k| k % modulus);
            assert!((0..100_000).all(|k| first[k] as usize == k % modulus));
        }
    }
}
