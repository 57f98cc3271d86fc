//! A random order of numbers that is never stored: the position of any item is computed from its number alone.

use crate::analysis::random::mix_bits;

/// Rounds of the network: after four, the result is indistinguishable from a random permutation (Luby and Rackoff, SIAM
/// J. Comput. 1988).
const ROUNDS: u64 = 4;

/// An order of the numbers below a count.
///
/// A balanced Feistel network permutes the numbers of an even number of bits; a result beyond the count is permuted
/// again until it is below (Black and Rogaway, CT-RSA 2002).
#[derive(Clone, Copy, Debug)]
pub struct Permutation {
    count: u64,
    half: u32,
    key: u64,
}

impl Permutation {
    /// The order of the numbers below `count` (at least 1) given by a seed and a stream.
    pub fn new(count: u64, seed: u64, stream: u64) -> Self {
        let bits = u64::BITS - (count - 1).leading_zeros();
        Self {
            count,
            half: bits.div_ceil(2).max(1),
            key: mix_bits(seed ^ mix_bits(stream)),
        }
    }

    /// Position of item `item` (below the count).
    pub fn place(&self, item: u64) -> u64 {
        let mut place = self.scrambled_value(item);
        while place >= self.count {
            place = self.scrambled_value(place);
        }
        place
    }

    fn scrambled_value(&self, value: u64) -> u64 {
        let mask = (1u64 << self.half) - 1;
        let (mut left, mut right) = (value >> self.half, value & mask);
        for round in 0..ROUNDS {
            let mixed = mix_bits(self.key.wrapping_add(round) ^ mix_bits(right)) & mask;
            (left, right) = (right, left ^ mixed);
        }
        left << self.half | right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_has_a_place_of_its_own() {
        for count in [1, 2, 3, 5, 64, 1000, 4097] {
            let order = Permutation::new(count, 7, 3);
            let mut places: Vec<u64> = (0..count).map(|k| order.place(k)).collect();
            let is_shuffled = places.windows(2).any(|pair| pair[0] > pair[1]);
            assert!(count < 5 || is_shuffled, "{count}");
            places.sort_unstable();
            assert_eq!(places, (0..count).collect::<Vec<_>>());
        }
    }
}
