//! Conversion of sRGB to linear light and back, with the same bits on every machine, and the greying of pictures
//! without a pose.
//!
//! Transfer curve of IEC 61966-2-1, computed with `+ - * /` only.

use std::sync::LazyLock;

use super::look::{LUMINANCE, Rgb};
use image::RgbaImage;

/// Cells of the first guess when encoding, a power of two. Above 255 · 12.92 (the steepest part of the curve has one code
/// per 1/3295), so that no cell holds two thresholds and one comparison settles the code.
const GUESS_CELLS: usize = 4096;

/// How much colour a picture without a pose loses, in 256ths.
const NO_POSE_GREY: u32 = 208;
/// How far a picture without a pose is blended towards the background, in 256ths.
const NO_POSE_FADE: u32 = 112;
/// Tables of the sRGB transfer curve.
pub struct ToneCurve {
    linear: [f32; 256],
    /// `thresholds[k]` is the least linear value whose code is k + 1; the last is above 1.
    thresholds: [f32; 256],
    guess: Box<[u8; 2 * GUESS_CELLS]>,
}

static CURVE: LazyLock<ToneCurve> = LazyLock::new(ToneCurve::new);

impl ToneCurve {
    /// The shared tables.
    pub fn shared() -> &'static Self {
        &CURVE
    }

    fn new() -> Self {
        let mut linear = [0.0; 256];
        let mut thresholds = [2.0; 256];
        for code in 0..256 {
            linear[code] = decode_exact(code as f64 / 255.0) as f32;
            if code < 255 {
                thresholds[code] = decode_exact((code as f64 + 0.5) / 255.0) as f32;
            }
        }
        let mut guess = Box::new([0u8; 2 * GUESS_CELLS]);
        let mut code = 0;
        for (cell, entry) in guess.iter_mut().enumerate() {
            // A cell surrounds its number, as values are rounded to the nearest.
            let start = (cell as f32 - 0.5) / GUESS_CELLS as f32;
            while code < 255 && thresholds[code] <= start {
                code += 1;
            }
            *entry = code as u8;
        }
        Self {
            linear,
            thresholds,
            guess,
        }
    }

    /// Linear value of an sRGB code.
    #[inline]
    pub fn decode(&self, code: u8) -> f32 {
        self.linear[code as usize]
    }

    /// Linear colour of an sRGB colour.
    #[inline]
    pub fn decode_rgb(&self, colour: [u8; 3]) -> Rgb {
        colour.map(|code| self.decode(code))
    }

    /// Nearest sRGB code of a linear value; values outside 0..=1 are clamped, not a number becomes 0.
    #[inline]
    pub fn encode(&self, value: f32) -> u8 {
        self.encode_all([value])[0]
    }

    /// The same for several values.
    // One index for several arrays: what the compiler turns into vector code.
    #[allow(clippy::needless_range_loop)]
    #[inline(always)]
    pub fn encode_all<const N: usize>(&self, values: [f32; N]) -> [u8; N] {
        let (mut clamped, mut cells, mut codes) = ([0.0; N], [0; N], [0; N]);
        for k in 0..N {
            clamped[k] = super::look::clamp_unit(values[k]);
            // At 2^23 the last bit of a number is worth 1: the low bits are the rounded value.
            cells[k] = (clamped[k] * GUESS_CELLS as f32 + 8_388_608.0).to_bits();
        }
        for k in 0..N {
            let guess = self.guess[cells[k] as usize % (2 * GUESS_CELLS)];
            codes[k] = guess + u8::from(clamped[k] >= self.thresholds[guess as usize]);
        }
        codes
    }
}

/// The transfer curve from code (0..=1) to linear light, error below 1e-15.
fn decode_exact(code: f64) -> f64 {
    if code <= 0.040_45 {
        return code / 12.92;
    }
    // x^2.4 = x² (x²)^(1/5)
    let x = (code + 0.055) / 1.055;
    x * x * fifth_root(x * x)
}

/// Fifth root of a number in 0..=1 by Newton's method from above, which converges monotonically.
fn fifth_root(value: f64) -> f64 {
    let mut root = 1.0;
    // From 1 to the root of 0.001 it takes 8 steps, to that of 1e-6 about 20; 40 are certainly enough.
    for _ in 0..40 {
        let fourth = root * root * root * root;
        root = (4.0 * root + value / fourth) / 5.0;
    }
    root
}

/// Greys a finished picture to show that there is no pose.
///
/// Works on the sRGB codes with integers, so that both renderers give the same bytes. Border and labels are drawn over
/// it later.
pub fn mark_no_pose(image: &mut RgbaImage, background: [u8; 3]) {
    let weights = LUMINANCE.map(|w| (w * 256.0 + 0.5) as u32);
    for pixel in image.pixels_mut() {
        let [r, g, b, _] = pixel.0.map(u32::from);
        let grey = (weights[0] * r + weights[1] * g + weights[2] * b + 128) >> 8;
        for (code, below) in pixel.0.iter_mut().zip(background) {
            let faded = blend_channels(u32::from(*code), grey, NO_POSE_GREY);
            *code = blend_channels(faded, u32::from(below), NO_POSE_FADE) as u8;
        }
    }
}

/// Mix of two codes, `share` in 256ths of the second.
fn blend_channels(first: u32, second: u32, share: u32) -> u32 {
    ((256 - share) * first + share * second + 128) >> 8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_the_round_trip() {
        let curve = ToneCurve::shared();
        for code in 0..=255 {
            assert_eq!(curve.encode(curve.decode(code)), code);
        }
    }

    #[test]
    fn decode_agrees_with_the_standard_formula() {
        for code in 0..=255u8 {
            let x = f64::from(code) / 255.0;
            let expected = if x <= 0.040_45 {
                x / 12.92
            } else {
                libm::pow((x + 0.055) / 1.055, 2.4)
            };
            assert!((decode_exact(x) - expected).abs() < 1e-15, "{code}");
        }
    }

    #[test]
    fn encode_is_the_nearest_code_everywhere() {
        let curve = ToneCurve::shared();
        for step in 0..=1_000_000 {
            let value = step as f32 / 1e6;
            let code = curve.encode(value) as usize;
            assert!(code == 0 || value >= curve.thresholds[code - 1], "{value}");
            assert!(value < curve.thresholds[code], "{value}");
        }
        assert_eq!(curve.encode(f32::NAN), 0);
        assert_eq!(curve.encode(-3.0), 0);
        assert_eq!(curve.encode(7.0), 255);
    }

    #[test]
    fn a_picture_without_pose_is_grey_and_pale() {
        let background = [245, 246, 248];
        let mut image = RgbaImage::from_pixel(1, 1, image::Rgba([200, 40, 40, 255]));
        mark_no_pose(&mut image, background);
        let [r, g, b, a] = image.get_pixel(0, 0).0;
        assert!(r - g < 40 && r > g && g.abs_diff(b) < 4 && a == 255);
        let mut empty = RgbaImage::from_pixel(1, 1, image::Rgba([245, 246, 248, 255]));
        mark_no_pose(&mut empty, background);
        let kept = empty.get_pixel(0, 0).0;
        assert!((0..3).all(|k| kept[k].abs_diff(background[k]) <= 2));
    }
}
