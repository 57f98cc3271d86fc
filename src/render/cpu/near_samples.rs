//! Which samples of neighbouring pixels are so near to each other that one line covers both.

use super::samples::{MOST_SAMPLES, SUBPIXELS, SamplePattern};

/// A pixel near another.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearPixel {
    /// Columns and rows from the other pixel to this one.
    pub(super) away: [i32; 2],
    /// For each of its samples those of the other pixel that are near, a bit each.
    pub(super) reached: [u16; MOST_SAMPLES],
    /// Those of the other pixel that are near any of its samples.
    pub(super) by_any: u16,
}

/// All pixels, at most `reach` columns and rows away, with samples within `radius` pixels of those of a pixel; itself
/// among them.
pub(super) fn near_pixels<const G: usize>(
    pattern: &SamplePattern<G>,
    reach: i32,
    radius: f64,
) -> Vec<NearPixel> {
    let unit = f64::from(SUBPIXELS);
    let place = |s: usize| {
        let (x, y) = (pattern.x.as_flattened()[s], pattern.y.as_flattened()[s]);
        [f64::from(x) / unit, f64::from(y) / unit]
    };
    let is_near = |away: [i32; 2], other: usize, own: usize| {
        let (there, here) = (place(other), place(own));
        let x = f64::from(away[0]) + there[0] - here[0];
        let y = f64::from(away[1]) + there[1] - here[1];
        (away != [0, 0] || other != own) && x * x + y * y <= radius * radius
    };
    let pixel = |away: [i32; 2]| {
        let mut reached = [0; MOST_SAMPLES];
        for (other, bits) in reached.iter_mut().enumerate().take(pattern.samples) {
            for own in 0..pattern.samples {
                *bits |= u16::from(is_near(away, other, own)) << own;
            }
        }
        NearPixel {
            away,
            reached,
            by_any: reached.iter().fold(0, |all, bits| all | bits),
        }
    };
    let rows = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| [x, y]));
    rows.map(pixel).filter(|pixel| pixel.by_any != 0).collect()
}
