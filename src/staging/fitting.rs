//! Fits texts into the picture: first smaller, then in several lines, never truncated.

use crate::render::text::{FontFace, set_text};
use std::sync::LazyLock;

/// Smallest size of a text, relative to its usual size, before it is broken into lines.
const SMALLEST: f64 = 0.8;

/// Measures texts; the glyphs that it rasterises are not drawn.
static FACE: LazyLock<FontFace> = LazyLock::new(FontFace::new);

/// The arrangement of pieces of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// Height of the capitals in pixels.
    pub size: f64,
    gap: &'static str,
    /// Pieces that begin a line.
    starts: Vec<usize>,
}

impl Fitted {
    /// The pieces with their gaps and line breaks.
    pub fn text(&self, pieces: &[String]) -> String {
        let mut text = String::new();
        for (index, piece) in pieces.iter().enumerate() {
            if index > 0 {
                let breaks = self.starts.contains(&index);
                text.push_str(if breaks { "\n" } else { self.gap });
            }
            text.push_str(piece);
        }
        text
    }
}

/// Width and height of a text with capitals `size` pixels high.
pub fn text_extent(text: &str, size: f64) -> [f64; 2] {
    let setting = set_text(&FACE, text, size);
    [setting.width, setting.height]
}

/// `pieces` next to each other with `gap` between them, in a width of `room` pixels: at `size` if they fit, otherwise
/// smaller, otherwise in several lines.
pub fn fit_pieces(pieces: &[String], gap: &'static str, size: f64, room: f64) -> Fitted {
    let fitted = |size: f64, starts: Vec<usize>| Fitted { size, gap, starts };
    let width = text_extent(&pieces.join(gap), size)[0];
    if width <= room || pieces.is_empty() {
        return fitted(size, Vec::new());
    }
    if SMALLEST * width <= room {
        return fitted(size * room / width, Vec::new());
    }
    let widest = pieces.iter().map(|piece| text_extent(piece, 1.0)[0]);
    let widest = widest.fold(0.0, f64::max);
    let size = (SMALLEST * size).min(room / widest.max(f64::MIN_POSITIVE));
    let mut starts = Vec::new();
    let mut line = String::new();
    for (index, piece) in pieces.iter().enumerate() {
        let longer = format!("{line}{gap}{piece}");
        if index > 0 && text_extent(&longer, size)[0] <= room {
            line = longer;
        } else {
            starts.push(index);
            line.clone_from(piece);
        }
    }
    fitted(size, starts)
}

/// The words of a text, to be fitted with single blanks between them.
pub fn split_words(text: &str) -> Vec<String> {
    text.split_whitespace().map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_wider_than_its_room() {
        let title = split_words("Truck gearshift, original dimensions, seen from the left");
        for room in [40.0, 90.0, 200.0, 400.0, 900.0] {
            let fitted = fit_pieces(&title, " ", 17.0, room);
            let text = fitted.text(&title);
            let [width, _] = text_extent(&text, fitted.size);
            assert!(width <= room + 1e-9, "{room}: {width} {fitted:?}");
            assert_eq!(split_words(&text), title);
        }
        assert_eq!(fit_pieces(&title, " ", 17.0, 900.0).size, 17.0);
    }
}
