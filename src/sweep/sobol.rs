//! Points of Sobol's sequence, each computed from its number alone.
//!
//! Direction numbers: S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections",
//! SIAM J. Sci. Comput. 30 (2008).

/// Degree of the primitive polynomial of a dimension, its inner coefficients, and the first direction numbers.
type Generator = (u32, u64, &'static [u64]);

/// Dimensions after the first, which is van der Corput's sequence.
const GENERATORS: [Generator; 20] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
    (6, 16, &[1, 3, 1, 13, 27, 49]),
    (6, 19, &[1, 1, 1, 15, 7, 5]),
    (6, 22, &[1, 3, 1, 15, 13, 25]),
    (6, 25, &[1, 1, 5, 5, 19, 61]),
    (7, 1, &[1, 3, 7, 11, 23, 15, 103]),
    (7, 4, &[1, 3, 7, 13, 13, 15, 69]),
];

/// Most dimensions of a design.
pub const MOST_DIMENSIONS: usize = GENERATORS.len() + 1;

/// Bits of a coordinate: all that a number between 0 and 1 can hold.
const BITS: u32 = 53;

/// Coordinate `dimension` of point `item`, in [0, 1); item and dimension are counted from 0, and item 0 is the corner.
pub fn coordinate(dimension: usize, item: u64) -> f64 {
    // In Gray code order, one direction number changes from one point to the next.
    let gray = item ^ (item >> 1);
    let directions = direction_numbers(dimension);
    let set = (0..BITS).filter(|bit| gray >> bit & 1 == 1);
    let bits = set.fold(0, |sum, bit| sum ^ directions[bit as usize]);
    bits as f64 / (1u64 << BITS) as f64
}

fn direction_numbers(dimension: usize) -> [u64; BITS as usize] {
    let mut numbers = [1u64; BITS as usize];
    if let Some(generator) = dimension.checked_sub(1).and_then(|k| GENERATORS.get(k)) {
        extend_numbers(&mut numbers, *generator);
    }
    for (place, number) in (1..).zip(&mut numbers) {
        *number <<= BITS - place;
    }
    numbers
}

/// Direction numbers after the initial ones, by the recurrence of the primitive polynomial.
fn extend_numbers(numbers: &mut [u64], (degree, inner, first): Generator) {
    let s = degree as usize;
    numbers[..s].copy_from_slice(first);
    for k in s..numbers.len() {
        let mut next = numbers[k - s] ^ numbers[k - s] << degree;
        for j in 1..s {
            if inner >> (s - 1 - j) & 1 == 1 {
                next ^= numbers[k - j] << j;
            }
        }
        numbers[k] = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In every dimension, the first 2ᵏ points have one in each of 2ᵏ equal intervals.
    #[test]
    fn every_projection_is_even() {
        for dimension in 0..MOST_DIMENSIONS {
            let mut seen = [false; 256];
            for item in 0..256 {
                let place = (coordinate(dimension, item) * 256.0) as usize;
                assert!(!std::mem::replace(&mut seen[place], true), "{dimension}");
            }
        }
    }

    /// Points 1, 2, 5 and 1000 of dimensions 0, 1, 6, 20, from SciPy 1.17 without scrambling.
    #[test]
    fn points_are_those_of_another_program() {
        let known = [
            (0, 1, 0.5),
            (1, 1, 0.5),
            (6, 1, 0.5),
            (20, 1, 0.5),
            (0, 2, 0.75),
            (1, 2, 0.25),
            (6, 2, 0.25),
            (20, 2, 0.25),
            (0, 5, 0.875),
            (1, 5, 0.875),
            (6, 5, 0.875),
            (20, 5, 0.625),
            (0, 1000, 0.2197265625),
            (1, 1000, 0.0966796875),
            (6, 1000, 0.0458984375),
            (20, 1000, 0.5224609375),
        ];
        for (dimension, item, value) in known {
            assert_eq!(coordinate(dimension, item), value, "{dimension} {item}");
        }
    }
}
