//! Equal things among many, found by one flat table: what a mesh of millions of corners has memory for.

use glam::DVec3;
use std::hash::{BuildHasher, Hash, RandomState};

/// No item in this place of the table.
const NONE: u32 = u32::MAX;

/// For each of `count` items (fewer than 2³²) the first one with an equal key.
///
/// The hash is another one in every run, so that no file can make all items meet; what is found does not depend on it.
pub fn first_equal<K: Eq + Hash>(count: usize, key: impl Fn(usize) -> K) -> Vec<u32> {
    let hasher = RandomState::new();
    let mask = (count + count / 3 + 1).next_power_of_two() - 1;
    let mut table = vec![NONE; mask + 1];
    let mut first = Vec::with_capacity(count);
    for item in 0..count {
        let own = key(item);
        let mut place = hasher.hash_one(&own) as usize & mask;
        let found = loop {
            match table[place] {
                NONE => break item as u32,
                other if key(other as usize) == own => break other,
                _ => place = (place + 1) & mask,
            }
        };
        table[place] = found;
        first.push(found);
    }
    first
}

/// The bits of a point, equal for equal points.
pub fn point_bits(point: DVec3) -> [u64; 3] {
    // Adding zero makes -0 into 0.
    (point + 0.0).to_array().map(f64::to_bits)
}

/// Numbers the first ones in their order: what [`first_equal`] gives becomes indices without gaps. How many there are.
pub fn number_first(first: &mut [u32]) -> usize {
    let mut count = 0;
    for item in 0..first.len() {
        let other = first[item] as usize;
        // The first of equal items stands before the others and has its number already.
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

    /// Many equal ones and many different ones: the table is neither full nor slow.
    #[test]
    fn many_items_are_told_apart() {
        for modulus in [1, 2, 1000, 100_000] {
            let first = first_equal(100_000, |k| k % modulus);
            assert!((0..100_000).all(|k| first[k] as usize == k % modulus));
        }
    }
}
