//! Where the samples of a pixel are: the standard patterns of Vulkan and Direct3D.
//!
//! The same places as a GPU's, so that both renderers' edges fall on the same pixels.

use super::RenderError;

/// Bits of a pixel's fraction in screen coordinates, as graphics interfaces ask for.
pub(super) const SUBPIXEL_BITS: u32 = 8;
/// Screen units in a pixel.
pub(super) const SUBPIXELS: i32 = 1 << SUBPIXEL_BITS;

/// Places in 16ths of a pixel from its top left corner.
const ONE: [[i32; 2]; 1] = [[8, 8]];
const TWO: [[i32; 2]; 2] = [[12, 12], [4, 4]];
const FOUR: [[i32; 2]; 4] = [[6, 2], [14, 6], [2, 10], [10, 14]];
const EIGHT: [[i32; 2]; 8] = [
    [9, 5],
    [7, 11],
    [13, 9],
    [5, 3],
    [3, 13],
    [1, 7],
    [11, 15],
    [15, 1],
];
const SIXTEEN: [[i32; 2]; 16] = [
    [9, 9],
    [7, 5],
    [5, 10],
    [12, 7],
    [3, 6],
    [10, 13],
    [13, 11],
    [11, 3],
    [6, 14],
    [8, 1],
    [4, 2],
    [2, 12],
    [0, 8],
    [15, 4],
    [14, 15],
    [1, 0],
];

/// The sample places of a pixel in screen units, for a number of samples fixed at compile time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pattern<const S: usize> {
    pub(super) x: [i32; S],
    pub(super) y: [i32; S],
    /// Least and greatest place along either axis: samples fill both axes alike.
    pub(super) least: i32,
    pub(super) greatest: i32,
    /// Distance of neighbouring places along an axis.
    pub(super) pitch_bits: u32,
}

impl<const S: usize> Pattern<S> {
    /// The pattern of `S` samples; `S` other than 1, 2, 4, 8 and 16 repeats the pixel's middle.
    pub(super) fn new() -> Self {
        let places: &[[i32; 2]] = match S {
            2 => &TWO,
            4 => &FOUR,
            8 => &EIGHT,
            16 => &SIXTEEN,
            _ => &ONE,
        };
        let along = |axis: usize| -> [i32; S] {
            std::array::from_fn(|s| places[s % places.len()][axis] * (SUBPIXELS / 16))
        };
        let x = along(0);
        Self {
            x,
            y: along(1),
            least: x.iter().copied().min().unwrap_or(0),
            greatest: x.iter().copied().max().unwrap_or(0),
            pitch_bits: SUBPIXEL_BITS - S.ilog2(),
        }
    }

    /// Whether any sample column (or row) of the picture lies within `low..=high` screen units.
    #[inline(always)]
    pub(super) fn meets(&self, low: i32, high: i32) -> bool {
        let cell = |place: i32| (place - self.least) >> self.pitch_bits;
        cell(low - 1) != cell(high)
    }
}

/// Checks that a stage's sample count is one the renderer knows.
pub(super) fn check(samples: u32) -> Result<(), RenderError> {
    match samples {
        1 | 2 | 4 | 8 | 16 => Ok(()),
        other => Err(RenderError::Size(format!(
            "{other} samples a pixel are not offered; choose 1, 2, 4, 8 or 16"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each pattern has one sample in each row and each column of its own fine grid.
    fn is_latin<const S: usize>() {
        let pattern = Pattern::<S>::new();
        for places in [pattern.x, pattern.y] {
            let mut sorted = places;
            sorted.sort_unstable();
            for (k, place) in sorted.iter().enumerate() {
                assert_eq!(*place, pattern.least + ((k as i32) << pattern.pitch_bits));
            }
            assert_eq!(sorted[S - 1], pattern.greatest);
        }
    }

    #[test]
    fn patterns_fill_rows_and_columns_evenly() {
        is_latin::<1>();
        is_latin::<2>();
        is_latin::<4>();
        is_latin::<8>();
        is_latin::<16>();
    }

    #[test]
    fn meets_finds_exactly_the_sample_columns() {
        let pattern = Pattern::<4>::new();
        for low in -300..300 {
            for high in low..low + 90 {
                let truth = (low..=high).any(|x: i32| pattern.x.contains(&x.rem_euclid(256)));
                assert_eq!(pattern.meets(low, high), truth, "{low} {high}");
            }
        }
    }
}
