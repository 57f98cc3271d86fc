//! Counter-based random numbers: item n of a stream is the same on any number of threads and for any split of the
//! items. The mixing function is that of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).

use std::f64::consts::TAU;

/// The numbers of one item.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A hash of all bits of `z`.
pub(crate) fn mix_bits(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Random {
    /// The numbers of item `item` of stream `stream`.
    pub fn new(seed: u64, stream: u64, item: u64) -> Self {
        let keyed = mix_bits(seed.wrapping_add(GOLDEN))
            ^ mix_bits(stream.wrapping_mul(GOLDEN).wrapping_add(1));
        Self {
            state: mix_bits(keyed ^ mix_bits(item.wrapping_add(GOLDEN.rotate_left(32)))),
        }
    }

    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN);
        mix_bits(self.state)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [-1, 1).
    pub fn symmetric(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(1.0 - self.unit())).sqrt();
        radius * libm::cos(TAU * self.unit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_distributions() {
        let count = 200_000;
        let (mut sum, mut square, mut mean) = (0.0, 0.0, 0.0);
        for item in 0..count {
            let mut random = Random::new(7, 0, item);
            let (u, n) = (random.unit(), random.normal());
            assert!((0.0..1.0).contains(&u));
            mean += u / count as f64;
            sum += n / count as f64;
            square += n * n / count as f64;
        }
        assert!((mean - 0.5).abs() < 3e-3 && sum.abs() < 8e-3 && (square - 1.0).abs() < 1.5e-2);
    }

    #[test]
    fn items_and_streams_differ_and_repeat() {
        let first = |seed, stream, item| Random::new(seed, stream, item).unit();
        assert_eq!(first(1, 2, 3), first(1, 2, 3));
        let all = [
            first(1, 2, 3),
            first(2, 2, 3),
            first(1, 3, 3),
            first(1, 2, 4),
            first(1, 3, 2),
        ];
        for (k, a) in all.iter().enumerate() {
            assert!(all[..k].iter().all(|b| a != b));
        }
    }
}
