//! sRGB bytes to Oklab, where equal distances look about equal.
//!
//! Matrices: Björn Ottosson, "A perceptual color space for image processing", 2020. Powers and roots come from
//! portable code, so that a palette is the same on every platform.

/// Table of linear light for every sRGB byte, and the transform that uses it.
pub struct Oklab {
    linear: [f64; 256],
}

impl Oklab {
    /// Builds the table.
    pub fn new() -> Self {
        Self {
            linear: std::array::from_fn(|byte| {
                let c = byte as f64 / 255.0;
                if c <= 0.04045 {
                    c / 12.92
                } else {
                    libm::pow((c + 0.055) / 1.055, 2.4)
                }
            }),
        }
    }

    /// Lightness 0 to 1 and the two colour axes of an sRGB colour whose channels are 0 to 255, also between
    /// whole numbers.
    pub fn from_srgb(&self, rgb: [f32; 3]) -> [f32; 3] {
        let [r, g, b] = rgb.map(|c| self.linear_of(c));
        let l = libm::cbrt(0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b);
        let m = libm::cbrt(0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b);
        let s = libm::cbrt(0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b);
        [
            (0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s) as f32,
            (1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s) as f32,
            (0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s) as f32,
        ]
    }

    /// Linear light by interpolation in the table: its curvature over one step is below 1e-5.
    fn linear_of(&self, channel: f32) -> f64 {
        let channel = channel.clamp(0.0, 255.0);
        let low = channel as usize;
        let high = (low + 1).min(255);
        let t = f64::from(channel) - low as f64;
        self.linear[low] + t * (self.linear[high] - self.linear[low])
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    /// Reference values of the author's page for XYZ pairs, and the definition's white and grey axis.
    #[test]
    fn white_grey_and_red_have_their_known_places() {
        let lab = Oklab::new();
        let near = |got: [f32; 3], want: [f32; 3]| {
            assert!(
                got.iter().zip(want).all(|(g, w)| (g - w).abs() < 2e-4),
                "{got:?} {want:?}"
            );
        };
        near(lab.from_srgb([255.0; 3]), [1.0, 0.0, 0.0]);
        near(lab.from_srgb([0.0; 3]), [0.0, 0.0, 0.0]);
        near(
            lab.from_srgb([255.0, 0.0, 0.0]),
            [0.627_96, 0.224_86, 0.125_85],
        );
        near(
            lab.from_srgb([0.0, 0.0, 255.0]),
            [0.452_01, -0.032_46, -0.311_53],
        );
        let grey = lab.from_srgb([127.5; 3]);
        assert!(grey[1].abs() < 1e-6 && grey[2].abs() < 1e-6 && (grey[0] - 0.598).abs() < 2e-3);
    }
}
