//! The cost of showing one palette colour instead of another.

use crate::sorting::sort_by_key;
/// Number of colours considered instead of the nearest one, including itself.
pub(super) const NEIGHBOURS: usize = 12;

/// Marks an index that may not be used for a pixel.
pub(super) const NEVER: i32 = i32::MAX;

/// A channel far from any colour, whose squared distances still fit an `i32`.
const FAR: i32 = 20_000;

/// The error that may be traded for size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Loss {
    /// Squared sRGB error that covering one more pixel with a code is worth.
    pub(super) price: i32,
    /// Maximum squared sRGB error that may be added to one pixel.
    pub(super) limit: i32,
}

impl Loss {
    /// Every pixel shows its nearest colour.
    pub(super) const NONE: Self = Self { price: 0, limit: 0 };
}

/// Relation of a pixel to the previous frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PixelChange {
    /// Its colour changed, or there is no previous frame.
    Changed,
    /// Its colour is the same.
    Same,
    /// As `Same`, inside a long run of such pixels, where only the transparent index is tried.
    Stretch,
}

/// One pixel to code; aligned to be copied as one word.
#[derive(Clone, Copy, Debug)]
#[repr(align(8))]
pub(super) struct Pixel {
    /// Red, green, blue, and the index of the nearest palette colour; inside a run, where it ends.
    pub(super) wanted: [u8; 4],
    /// Index shown there now; the transparent index if nothing is.
    pub(super) shown: u8,
    /// Relation to the frame before.
    pub(super) change: PixelChange,
}

impl Pixel {
    /// A pixel of a run that ends before the pixel number `end` of its list.
    pub(super) fn of_run_to(end: usize) -> Self {
        Self {
            wanted: (end as u32).to_le_bytes(),
            shown: 0,
            change: PixelChange::Stretch,
        }
    }

    /// Where the run of a pixel ends.
    #[inline]
    pub(super) fn run_end(&self) -> usize {
        u32::from_le_bytes(self.wanted) as usize
    }
}

/// A changed pixel with the cost of its nearest colour.
pub(super) struct ColourWish {
    colour: [i32; 3],
    least: i32,
    /// What the transparent index shows.
    shown: [i32; 3],
}

/// Colours of the indices and their neighbourhoods.
pub(super) struct Costs {
    colours: [[i32; 3]; 256],
    /// The nearest colours of each colour with their squared distances, nearest first.
    neighbours: Vec<[(u8, i32); NEIGHBOURS]>,
    transparent: u8,
    limit: i32,
}

impl Costs {
    pub(super) fn new(palette: &[[u8; 3]], transparent: u8, limit: i32) -> Self {
        let mut colours = [[FAR; 3]; 256];
        for (place, colour) in colours.iter_mut().zip(palette) {
            *place = colour.map(i32::from);
        }
        let neighbours = colours
            .iter()
            .map(|&c| colour_neighbours(c, &colours))
            .collect();
        Self {
            colours,
            neighbours,
            transparent,
            limit,
        }
    }

    /// Prepares the evaluation of a changed pixel.
    #[inline]
    pub(super) fn wish(&self, pixel: &Pixel) -> ColourWish {
        let [r, g, b, nearest] = pixel.wanted;
        let colour = [r, g, b].map(i32::from);
        ColourWish {
            colour,
            least: squared_distance(colour, self.colours[usize::from(nearest)]),
            shown: self.colours[usize::from(pixel.shown)],
        }
    }

    /// Error added by sending `index` instead of the nearest colour, or `NEVER` if that is too large.
    #[inline]
    pub(super) fn added(&self, wish: &ColourWish, index: u8) -> i32 {
        let colour = if index == self.transparent {
            wish.shown
        } else {
            self.colours[usize::from(index)]
        };
        // Most indices are far off, which one channel already shows.
        let off = wish.colour[1] - colour[1];
        if off * off > wish.least + self.limit {
            return NEVER;
        }
        let added = squared_distance(wish.colour, colour) - wish.least;
        if added <= self.limit { added } else { NEVER }
    }

    /// Calls `offer` with every index that may be sent for `pixel` and the error it adds: the transparent one, the
    /// nearest, and its neighbours.
    #[inline]
    pub(super) fn for_each(&self, pixel: &Pixel, mut offer: impl FnMut(u8, i32)) {
        if pixel.change != PixelChange::Changed {
            offer(self.transparent, 0);
            offer(pixel.shown, 0);
            return;
        }
        let wish = self.wish(pixel);
        let leave = self.added(&wish, self.transparent);
        if leave != NEVER {
            offer(self.transparent, leave);
        }
        let nearest = pixel.wanted[3];
        offer(nearest, 0);
        if self.limit == 0 {
            return;
        }
        // Distances a (wanted to nearest) and b (wanted to an index that may be sent) reach (a + b)^2 from the
        // nearest colour at most, which is no more than 2 a^2 + 2 b^2.
        let reach = 4 * wish.least + 2 * self.limit;
        for &(index, distance) in &self.neighbours[usize::from(nearest)] {
            if distance > reach {
                break;
            }
            let added = self.added(&wish, index);
            if added != NEVER && index != nearest {
                offer(index, added);
            }
        }
    }
}

/// The colours nearest to `colour`, with squared distances, nearest first.
fn colour_neighbours(colour: [i32; 3], colours: &[[i32; 3]; 256]) -> [(u8, i32); NEIGHBOURS] {
    let mut all: [(u8, i32); 256] =
        std::array::from_fn(|i| (i as u8, squared_distance(colour, colours[i])));
    sort_by_key(&mut all, |n| n.1);
    std::array::from_fn(|i| all[i])
}

#[inline]
fn squared_distance(a: [i32; 3], b: [i32; 3]) -> i32 {
    let d: [i32; 3] = std::array::from_fn(|i| a[i] - b[i]);
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}
