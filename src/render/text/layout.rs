//! A text as glyphs at places: lines, advances, tabs. Left aligned, no kerning and no shaping.

use super::face::{FontFace, PHASES};
use ab_glyph::GlyphId;

/// From baseline to baseline in heights of the capitals: 1.3 em of a face with capitals of 0.714 em.
const LINE_ADVANCE: f64 = 1.82;

/// Spaces a tab is worth.
const TAB_SPACES: f64 = 4.0;

/// Lines and columns beyond this are not set: no picture shows them, and positions stay far inside `i32`.
const FARTHEST_PIXEL: f64 = 1e6;

/// One glyph of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glyph {
    /// Glyph in the face; `None` is the box of a missing one.
    pub id: Option<GlyphId>,
    /// Whole pixels from the left edge of the setting.
    pub column: i32,
    /// Fraction of a pixel added to `column`, in units of 1 / `PHASES`.
    pub phase: u32,
    /// Baseline, whole pixels below the setting's top edge.
    pub baseline: i32,
}

/// A text set in lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setting {
    /// Height of the capitals in pixels the glyphs are meant for.
    pub size: f64,
    /// Width of the longest line in pixels.
    pub width: f64,
    /// From the top of the first line's capitals to the last line's baseline, in pixels.
    pub height: f64,
    /// The glyphs, in reading order.
    pub glyphs: Vec<Glyph>,
}

/// Sets `text` with capitals `size` pixels high; `\n` starts a line, a tab is four spaces, `\r` is nothing.
pub fn set_text(face: &FontFace, text: &str, size: f64) -> Setting {
    let mut setting = Setting {
        size,
        ..Setting::default()
    };
    let mut baseline = size.round();
    for (number, line) in text.split('\n').enumerate() {
        if number > 0 {
            baseline = (size + number as f64 * LINE_ADVANCE * size).round();
        }
        if baseline > FARTHEST_PIXEL {
            break;
        }
        let width = set_line(face, line, baseline as i32, &mut setting);
        setting.width = setting.width.max(width);
    }
    setting.height = baseline;
    setting
}

/// Appends one line's glyphs; returns its width in pixels.
fn set_line(face: &FontFace, line: &str, baseline: i32, setting: &mut Setting) -> f64 {
    let mut pen = 0.0;
    for character in line.chars() {
        match character {
            '\r' => continue,
            '\t' => {
                pen += TAB_SPACES * face.advance(face.glyph(' '), setting.size);
                continue;
            }
            _ => {}
        }
        if pen > FARTHEST_PIXEL {
            break;
        }
        let id = face.glyph(character);
        let quarters = (pen * f64::from(PHASES)).round() as i32;
        setting.glyphs.push(Glyph {
            id,
            column: quarters.div_euclid(PHASES as i32),
            phase: quarters.rem_euclid(PHASES as i32) as u32,
            baseline,
        });
        pen += face.advance(id, setting.size);
    }
    pen
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn width_grows_with_size_and_text() {
        let face = FontFace::new();
        let short = set_text(&face, "Hub", 12.0);
        let twice = set_text(&face, "HubHub", 12.0);
        let large = set_text(&face, "Hub", 24.0);
        assert!((twice.width - 2.0 * short.width).abs() < 1e-9);
        assert!((large.width - 2.0 * short.width).abs() < 1e-9);
    }

    #[test]
    fn lines_step_down_evenly() {
        let face = FontFace::new();
        let setting = set_text(&face, "a\nb\r\nc", 10.0);
        let baselines: Vec<i32> = setting.glyphs.iter().map(|g| g.baseline).collect();
        assert_eq!(baselines, [10, 28, 46]);
        assert_eq!(setting.height, 46.0);
    }

    #[test]
    fn empty_text_has_no_width() {
        let setting = set_text(&FontFace::new(), "", 10.0);
        assert_eq!((setting.width, setting.glyphs.len()), (0.0, 0));
    }
}
