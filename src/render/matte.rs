//! Pictures without background, computed from the same picture on white and on black.
//!
//! The two differ by the fraction of the background that is visible. Codes are compared as they are, since viewers
//! blend codes: composited over white or black, the result is the picture that was drawn there. A shadow becomes
//! translucent black. Both renderers and all overlays work unchanged.

use image::RgbaImage;

/// Colours of the two backgrounds.
pub const WHITE: [u8; 3] = [255; 3];
/// See [`WHITE`].
pub const BLACK: [u8; 3] = [0; 3];

/// Replaces `on_white` by the picture without background.
pub fn extract_alpha(on_white: &mut RgbaImage, on_black: &RgbaImage) {
    for (white, black) in on_white.pixels_mut().zip(on_black.pixels()) {
        let through = (0..3)
            .map(|c| white.0[c].saturating_sub(black.0[c]))
            .max()
            .unwrap_or(0);
        let alpha = 255 - through;
        let code = |c: usize| match alpha {
            0 => 0,
            _ => {
                let own = u32::from(black.0[c]) * 255 + u32::from(alpha) / 2;
                (own / u32::from(alpha)).min(255) as u8
            }
        };
        white.0 = [code(0), code(1), code(2), alpha];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    #[test]
    fn layers_are_found_again() {
        for (colour, alpha) in [
            ([200u8, 30, 90], 255u32),
            ([0, 0, 0], 60),
            ([120, 250, 4], 128),
        ] {
            let over = |below: u32| {
                let code =
                    |c: u8| ((u32::from(c) * alpha + below * (255 - alpha) + 127) / 255) as u8;
                let [r, g, b] = colour.map(code);
                RgbaImage::from_pixel(1, 1, Rgba([r, g, b, 255]))
            };
            let mut found = over(255);
            extract_alpha(&mut found, &over(0));
            let [r, g, b, a] = found.get_pixel(0, 0).0;
            assert!(u32::from(a).abs_diff(alpha) <= 1, "{a} {alpha}");
            for (own, expected) in [r, g, b].into_iter().zip(colour) {
                assert!(own.abs_diff(expected) <= 2, "{own} {expected}");
            }
        }
        let mut nothing = RgbaImage::from_pixel(1, 1, Rgba([255; 4]));
        extract_alpha(
            &mut nothing,
            &RgbaImage::from_pixel(1, 1, Rgba([0, 0, 0, 255])),
        );
        assert_eq!(nothing.get_pixel(0, 0).0, [0; 4]);
    }
}
