//! How a large picture is divided into strips of rows, which are drawn one by one in bounded memory.
//!
//! Every pixel is the one of the whole picture: shadows, labels and the grid of tiles are those of the whole picture, and
//! a strip draws as many rows around it as its lines depend on.

use super::BYTES_OF_DRAWN_PIXEL;

/// Bytes that the strips of all workers take together, about.
const BYTES_OF_STRIPS: f64 = 160e6;

/// Fewest rows of a strip: a strip repeats what all pixels have in common, and the lines of a poster reach 8 pixels
/// beyond it.
const LEAST_ROWS: u32 = 64;

/// A picture in strips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strips {
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// Rows of every strip, at least one; the last strip may have fewer.
    pub rows: u32,
}

impl Strips {
    /// Strips for at most so many workers, and the number of workers whose strips fit into memory. Every pixel is drawn
    /// `layers` times.
    pub fn plan(size: [u32; 2], layers: usize, workers: usize) -> (Self, usize) {
        let bytes_of_row = f64::from(size[0]) * BYTES_OF_DRAWN_PIXEL * layers as f64;
        let all_rows = BYTES_OF_STRIPS / bytes_of_row;
        let workers = workers.clamp(1, (all_rows / f64::from(LEAST_ROWS)).max(1.0) as usize);
        let rows = (all_rows / workers as f64) as u32;
        let rows = rows.max(LEAST_ROWS).min(size[1].max(1));
        (Self { size, rows }, workers)
    }

    /// Number of strips.
    pub fn count(&self) -> usize {
        self.size[1].div_ceil(self.rows) as usize
    }

    /// First row of a strip.
    pub fn first_row(&self, strip: usize) -> u32 {
        (strip as u32).saturating_mul(self.rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_cover_the_picture_in_bounded_memory() {
        for size in [
            [1, 1],
            [9933, 14043],
            [15360, 15360],
            [15360, 3],
            [7, 15360],
        ] {
            for workers in [1, 2, 16, 256] {
                for layers in [1, 2] {
                    let (strips, workers) = Strips::plan(size, layers, workers);
                    let last = strips.first_row(strips.count() - 1);
                    assert!(
                        last < size[1] && last + strips.rows >= size[1],
                        "{strips:?}"
                    );
                    let pixels = f64::from(size[0]) * f64::from(strips.rows) * workers as f64;
                    let bytes = pixels * BYTES_OF_DRAWN_PIXEL * layers as f64;
                    assert!(bytes <= BYTES_OF_STRIPS, "{strips:?}, {workers}");
                }
            }
        }
    }
}
