//! Positions of the samples of a pixel: the standard patterns of Vulkan and Direct3D.
//!
//! They are those of a GPU, so that edges fall on the same pixels in both renderers.

use crate::render::RenderError;
use wide::f32x4;

/// Fractional bits of screen coordinates, as required by graphics interfaces.
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

/// Places of `samples` in a pixel from its top left corner, in pixels.
#[cfg(feature = "gpu")]
pub(super) fn sample_places(samples: u32) -> Vec<[f32; 2]> {
    let places = places(samples).iter();
    places
        .map(|place| place.map(|sixteenths| sixteenths as f32 / 16.0))
        .collect()
}

fn places(samples: u32) -> &'static [[i32; 2]] {
    match samples {
        2 => &TWO,
        4 => &FOUR,
        8 => &EIGHT,
        16 => &SIXTEEN,
        _ => &ONE,
    }
}

/// Most samples of a pixel.
pub(super) const MOST_SAMPLES: usize = 16;

/// Lanes of a vector.
pub(super) const LANES: usize = 4;

/// The sample places of a cell: the pixels whose samples fill `G` vectors of four lanes.
///
/// With four samples or more a cell is one pixel; with two it is two and with one four pixels of a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct SamplePattern<const G: usize> {
    /// Samples of a pixel.
    pub(super) samples: usize,
    /// Places of the lanes from the cell's top left corner in screen units.
    pub(super) x: [[i32; LANES]; G],
    pub(super) y: [[i32; LANES]; G],
    /// The same as numbers to multiply with.
    pub(super) places_x: [f32x4; G],
    pub(super) places_y: [f32x4; G],
    /// The pixels of a cell are 2 to this power.
    pub(super) cell_bits: u32,
    /// Least and greatest place along either axis of a pixel: samples fill both axes alike.
    pub(super) least: i32,
    pub(super) greatest: i32,
    /// Distance of neighbouring places along an axis, as a power of two.
    pub(super) pitch_bits: u32,
}

impl<const G: usize> SamplePattern<G> {
    /// The pattern of `samples` a pixel, which must fill `G` vectors or divide one.
    pub(super) fn new(samples: u32) -> Self {
        let places = places(samples);
        let unit = SUBPIXELS / 16;
        // Where samples of one pixel do not fill the lanes, a vector covers adjacent pixels.
        let lane = |axis: usize, lane: usize| {
            let pixel = (lane / places.len()) as i32 * SUBPIXELS;
            places[lane % places.len()][axis] * unit + if axis == 0 { pixel } else { 0 }
        };
        let along = |axis: usize| -> [[i32; LANES]; G] {
            std::array::from_fn(|g| std::array::from_fn(|k| lane(axis, g * LANES + k)))
        };
        let column = places.iter().map(|place| place[0] * unit);
        let numbers = |places: [[i32; LANES]; G]| places.map(|p| f32x4::from(p.map(|v| v as f32)));
        Self {
            samples: places.len(),
            x: along(0),
            y: along(1),
            places_x: numbers(along(0)),
            places_y: numbers(along(1)),
            cell_bits: (G * LANES / places.len()).ilog2(),
            least: column.clone().min().unwrap_or(0),
            greatest: column.max().unwrap_or(0),
            pitch_bits: SUBPIXEL_BITS - places.len().ilog2(),
        }
    }

    /// Whether any sample column (or row) of the picture lies within `low..=high` screen units.
    #[inline(always)]
    pub(super) fn meets(&self, low: i32, high: i32) -> bool {
        let cell = |place: i32| (place - self.least) >> self.pitch_bits;
        cell(low - 1) != cell(high)
    }

    /// First and last pixel that can have a sample within `low..=high` screen units.
    #[inline(always)]
    pub(super) fn pixels(&self, low: i32, high: i32) -> [i32; 2] {
        [
            (low - self.greatest + SUBPIXELS - 1) >> SUBPIXEL_BITS,
            (high - self.least) >> SUBPIXEL_BITS,
        ]
    }
}

/// What can be chosen, in words.
#[cfg(feature = "fine-samples")]
const OFFERED: &str = "1, 2, 4, 8 or 16";
#[cfg(not(feature = "fine-samples"))]
const OFFERED: &str = "1, 2 or 4";

/// Checks that a stage's sample count is one the renderer knows.
pub(super) fn check_samples(samples: u32) -> Result<(), RenderError> {
    match samples {
        1 | 2 | 4 => Ok(()),
        #[cfg(feature = "fine-samples")]
        8 | 16 => Ok(()),
        other => Err(RenderError::Size(format!(
            "{other} samples a pixel are not offered; choose {OFFERED}"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each pattern has one sample in each row and each column of its own fine grid.
    fn is_latin<const G: usize>(samples: usize) {
        let pattern = SamplePattern::<G>::new(samples as u32);
        assert_eq!(pattern.samples, samples);
        assert_eq!(samples << pattern.cell_bits, G * LANES);
        for places in [&pattern.x, &pattern.y] {
            let mut sorted = places.as_flattened()[..samples].to_vec();
            sorted.sort_unstable();
            for (k, place) in sorted.iter().enumerate() {
                assert_eq!(*place, pattern.least + ((k as i32) << pattern.pitch_bits));
            }
            assert_eq!(sorted[samples - 1], pattern.greatest);
        }
    }

    #[test]
    fn patterns_fill_rows_and_columns_evenly() {
        is_latin::<1>(1);
        is_latin::<1>(2);
        is_latin::<1>(4);
        is_latin::<2>(8);
        is_latin::<4>(16);
    }

    #[test]
    fn meets_finds_exactly_the_sample_columns() {
        let pattern = SamplePattern::<1>::new(4);
        for low in -300..300 {
            for high in low..low + 90 {
                let truth = (low..=high).any(|x: i32| pattern.x[0].contains(&x.rem_euclid(256)));
                assert_eq!(pattern.meets(low, high), truth, "{low} {high}");
            }
        }
    }
}
