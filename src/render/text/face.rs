//! The embedded face: metrics, which characters it has, and a cache of rasterised glyphs.

use super::mask::{Mask, missing_box, rasterise_glyph};
use ab_glyph::{Font, FontRef, GlyphId};
use std::collections::HashMap;

/// Noto Sans and the signs of Noto Sans Math and Symbols, 1000 units an em.
static FACE_FILE: &[u8] = include_bytes!("NotoSans-subset.ttf");

/// Height of the capitals in ems, from the face's OS/2 table (714 of 1000 units; a test measures an `H`).
const CAPITALS_PER_EM: f64 = 0.714;

/// Advance and width of the box that stands for a character the face lacks, in heights of the capitals.
const MISSING_ADVANCE: f64 = 0.86;

/// Subpixel positions at which a glyph is rasterised. A quarter of a pixel is invisible in the spacing of the letters,
/// and keeps the cache small.
pub const PHASES: u32 = 4;

/// Number of masks kept before the cache is cleared; far more than the labels of one animation need. It bounds the
/// memory of a caller who draws ever new sizes.
const CACHE_MASKS: usize = 4096;

/// Which mask: glyph, height of capitals in bits, phase in x.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct GlyphKey {
    /// Glyph in the face; `None` is the box of a missing one.
    glyph: Option<GlyphId>,
    /// `f64::to_bits` of the height of the capitals.
    size: u64,
    /// Phases to the right and down, 0 to `PHASES` - 1.
    phase: [u32; 2],
}

/// The face and the masks made of it so far.
pub struct FontFace {
    /// `None` only if the embedded file is damaged: then every character is a box.
    font: Option<FontRef<'static>>,
    masks: HashMap<GlyphKey, Mask>,
}

impl FontFace {
    /// Reads the embedded face.
    pub fn new() -> Self {
        Self {
            font: embedded_font(),
            masks: HashMap::new(),
        }
    }

    /// The glyph of a character; `None` when the face lacks it.
    pub fn glyph(&self, character: char) -> Option<GlyphId> {
        glyph_of(self.font.as_ref()?, character)
    }

    /// Advance of a glyph (`None`: the box of a missing one) in pixels, for capitals `size` pixels high.
    pub fn advance(&self, glyph: Option<GlyphId>, size: f64) -> f64 {
        let (Some(font), Some(glyph)) = (&self.font, glyph) else {
            return MISSING_ADVANCE * size;
        };
        f64::from(font.h_advance_unscaled(glyph)) * pixels_per_unit(font, size)
    }

    /// The mask of a glyph for capitals `size` pixels high, its origin `phase` / `PHASES` right of and below a pixel's
    /// upper left corner.
    pub fn mask(&mut self, glyph: Option<GlyphId>, size: f64, phase: [u32; 2]) -> &Mask {
        let key = GlyphKey {
            glyph,
            size: size.to_bits(),
            phase,
        };
        if self.masks.len() >= CACHE_MASKS && !self.masks.contains_key(&key) {
            self.masks.clear();
        }
        let font = self.font.as_ref();
        self.masks.entry(key).or_insert_with(|| {
            let shift = phase.map(|p| f64::from(p) / f64::from(PHASES));
            match (font, glyph) {
                (Some(font), Some(glyph)) => {
                    let em_height = pixels_per_unit(font, size) * f64::from(font.height_unscaled());
                    rasterise_glyph(font, glyph, em_height, shift)
                }
                _ => missing_box(size, MISSING_ADVANCE * size, shift),
            }
        })
    }
}

impl Default for FontFace {
    fn default() -> Self {
        Self::new()
    }
}

/// The characters of `text` the embedded face cannot draw, each once, in order of appearance.
///
/// Line breaks, tabs and carriage returns are layout and never missing.
pub fn missing_glyphs(text: &str) -> Vec<char> {
    let font = embedded_font();
    let mut missing = Vec::new();
    for character in text.chars().filter(|c| !is_layout(*c)) {
        let known = font.as_ref().and_then(|f| glyph_of(f, character)).is_some();
        if !known && !missing.contains(&character) {
            missing.push(character);
        }
    }
    missing
}

/// Characters that place others and have no glyph.
pub(super) fn is_layout(character: char) -> bool {
    matches!(character, '\n' | '\r' | '\t')
}

fn embedded_font() -> Option<FontRef<'static>> {
    FontRef::try_from_slice(FACE_FILE).ok()
}

fn glyph_of(font: &FontRef<'static>, character: char) -> Option<GlyphId> {
    let id = font.glyph_id(character);
    (id != GlyphId(0)).then_some(id)
}

fn pixels_per_unit(font: &FontRef<'static>, size: f64) -> f64 {
    let units_per_em = f64::from(font.units_per_em().unwrap_or(1000.0));
    size / (CAPITALS_PER_EM * units_per_em)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn capitals_have_the_asked_height() {
        let mut face = FontFace::new();
        let h = face.glyph('H');
        for size in [8.0, 20.0, 100.0] {
            let mask = face.mask(h, size, [0, 0]);
            assert_eq!(
                mask.top + mask.height as i32,
                0,
                "an H stands on the baseline"
            );
            // The mask's box is rounded outwards to whole pixels.
            assert!(
                (f64::from(mask.height) - size).abs() <= 1.0,
                "{} for {size}",
                mask.height
            );
        }
    }

    #[test]
    fn digits_share_one_advance() {
        let face = FontFace::new();
        let zero = face.advance(face.glyph('0'), 10.0);
        assert!(zero > 5.0 && zero < 12.0);
        for digit in '1'..='9' {
            assert_eq!(face.advance(face.glyph(digit), 10.0), zero, "{digit}");
        }
    }

    #[test]
    fn engineers_signs_are_there() {
        let text = "äöüßÄÖÜ čěščřžýáíéúůťďň ľĺŕô ąćęłńóśźż αβγδεζηθικλμνξοπρστυφχψω ΔΦΓΣΩ \
                    °±×·−≤≥≠≈√∞∑∫∂∥⊥∠⌀→←↑↓↔ ₀₁₂₃ ⁰¹²³⁴ µ ′ ″ … – — • € ‰ ½ ● ▲";
        assert_eq!(missing_glyphs(text), Vec::<char>::new());
    }

    #[test]
    fn missing_characters_are_named_once() {
        assert_eq!(
            missing_glyphs("a\n漢b字漢\u{7}\t"),
            vec!['漢', '字', '\u{7}']
        );
    }

    #[test]
    fn a_missing_character_is_drawn_as_a_box() {
        let mut face = FontFace::new();
        let glyph = face.glyph('漢');
        assert!(glyph.is_none());
        let mask = face.mask(glyph, 20.0, [0, 0]);
        let covered = mask.coverage.iter().filter(|c| **c > 127).count();
        assert!(covered > 40, "a visible outline");
        assert!(mask.at(mask.width / 2, mask.height / 2) == 0, "hollow");
    }

    #[test]
    fn cache_does_not_change_a_mask() {
        let mut face = FontFace::new();
        let glyph = face.glyph('ř');
        let first = face.mask(glyph, 13.0, [1, 0]).clone();
        for k in 0..CACHE_MASKS {
            face.mask(glyph, 1.0 + k as f64 * 1e-3, [0, 0]);
        }
        assert_eq!(*face.mask(glyph, 13.0, [1, 0]), first);
        assert!(face.masks.len() <= CACHE_MASKS);
    }
}
